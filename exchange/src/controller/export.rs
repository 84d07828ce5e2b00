//! From a geometry to files, and from files to what they are worth. In: a format and its options. Out: files with what they
//! lose; or, of files that are there, what the controller takes from them.

use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::SourceFile;

use super::effects::LEAST;
use super::geometry::Geometry;
use super::job::{Controller, File, Job, Written};
use super::lost::{Lost, Target};
use super::options::{Format, Options};
use super::printer::{self, Firmware};
use super::refused::Refused;
use super::space::Space;
use super::{etalon, heidenhain, isg, linuxcnc, pmac, sinumerik};

/// Files and what they are worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// The files.
    pub files: Vec<File>,
    /// How they are loaded, line by line.
    pub loading: Vec<String>,
    /// What was not written that might have been, and how to have it.
    pub left_out: Vec<String>,
    /// What they lose.
    pub lost: Lost,
}

/// What a controller takes from files.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// What it takes otherwise than somebody might think.
    pub findings: Vec<String>,
    /// What they lose.
    pub lost: Lost,
}

/// Refuses a machine whose motors no table of the format corrects.
fn refuse_motors(geometry: &Geometry<'_>, format: Format) -> Result<(), Refused> {
    refuse_beam(geometry)?;
    match format {
        Format::LinuxCnc | Format::Sinumerik | Format::Heidenhain | Format::Pmac => refuse_crossed(geometry),
        // Such controllers correct the tip, and find the positions of motors behind that.
        Format::Isg | Format::Etalon | Format::Marlin | Format::Klipper | Format::RepRap => Ok(()),
    }
}

/// Refuses crossed drives: a table of one axis alone corrects its drive, and no motor there moves one axis alone.
fn refuse_crossed(geometry: &Geometry<'_>) -> Result<(), Refused> {
    let mut motors = geometry.equations.axes.iter().filter(|axis| axis.follows.len() > 1);
    let Some(motor) = motors.next() else { return Ok(()) };
    Err(Refused::new(
        format!(
            "{} moves several axes together, but these tables correct a drive that moves one",
            motor.letter
        ),
        "use `abbe compensate`, the C interface or the component of LinuxCNC: each gives every motor its own command",
    ))
}

/// Refuses a machine whose motors turn their beam back: the tables of all formats correct an axis, which has one command.
fn refuse_beam(geometry: &Geometry<'_>) -> Result<(), Refused> {
    let mut motors = geometry.equations.axes.iter().filter(|axis| !axis.squares.is_empty());
    let Some(motor) = motors.next() else { return Ok(()) };
    Err(Refused::new(
        format!(
            "{} corrects the rotation of its beam and so needs its own command, but tables correct axes",
            motor.letter
        ),
        "write `corrects: false` beside its `drives` in the machine file, so that slides correct the effect of both drives at \
         the tool; to give each drive its own command, use `abbe compensate` or the C interface",
    ))
}

/// Writes the files of a format, reads them again, and measures what they lose.
///
/// # Errors
/// What the format cannot hold, what the user must say first, and a correction beyond the calibration's limit.
pub fn export(
    geometry: &Geometry<'_>,
    space: &Space,
    format: Format,
    options: &Options,
) -> Result<Export, Refused> {
    refuse_motors(geometry, format)?;
    let job = Job { geometry, space, options };
    let Written { files, loading, left_out } = match format {
        Format::LinuxCnc => linuxcnc::written(&job),
        Format::Isg => isg::written(&job),
        Format::Etalon => etalon::written(&job),
        Format::Sinumerik => sinumerik::written(&job),
        Format::Heidenhain => heidenhain::written(&job),
        Format::Pmac => pmac::written(&job),
        Format::Marlin => printer::written(&job, Firmware::Marlin),
        Format::Klipper => printer::written(&job, Firmware::Klipper),
        Format::RepRap => printer::written(&job, Firmware::RepRap),
    }?;
    let read = check(geometry, space, format, options, &sources(&files)).map_err(|error| match error {
        Unusable::Refused(refused) => refused,
        Unusable::File(text) => {
            Refused::new(format!("the written file could not be read back\n{text}"), "this is a bug in Abbe")
        }
    })?;
    if let Some(finding) = read.findings.first() {
        return Err(Refused::new(
            format!("the controller would ignore a part of it: {finding}"),
            "this is a bug in Abbe",
        ));
    }
    worth_it(&read.lost)?;
    let left_out = left_out.into_iter().chain(direction_lost(geometry)).collect();
    Ok(Export { files, loading, left_out, lost: read.lost })
}

/// What is told where Abbe's own compensation has rotary axes correct the direction of the tool.
fn direction_lost(geometry: &Geometry<'_>) -> Option<String> {
    (!geometry.equations.aiming().is_empty()).then(|| {
        "the direction of the tool: in these files, rotary axes correct only their own angles, and the errors below are those of the tip"
            .to_owned()
    })
}

/// Why files cannot be checked.
#[derive(Clone, Debug, PartialEq)]
pub enum Unusable {
    /// Not by this machine, or with these options.
    Refused(Refused),
    /// A file is wrong: the findings, rendered.
    File(String),
}

impl From<Refused> for Unusable {
    fn from(refused: Refused) -> Self {
        Self::Refused(refused)
    }
}

/// Reads files as the controller does, and measures what is lost with them.
///
/// # Errors
/// A file that the controller would refuse, and what [`export`] refuses.
pub fn check(
    geometry: &Geometry<'_>,
    space: &Space,
    format: Format,
    options: &Options,
    files: &[(SourceFile, Option<usize>)],
) -> Result<Checked, Unusable> {
    let job = Job { geometry, space, options };
    let mut controller: Box<dyn Controller + '_> = match format {
        Format::LinuxCnc => Box::new(linuxcnc::controller(&job)),
        Format::Isg => Box::new(isg::controller(&job)?),
        Format::Etalon => Box::new(etalon::controller(&job)?),
        Format::Sinumerik => Box::new(sinumerik::controller(&job)?),
        Format::Heidenhain => Box::new(heidenhain::controller(&job)?),
        Format::Pmac => Box::new(pmac::controller(&job)?),
        Format::Marlin => Box::new(printer::controller(&job, Firmware::Marlin)?),
        Format::Klipper => Box::new(printer::controller(&job, Firmware::Klipper)?),
        Format::RepRap => Box::new(printer::controller(&job, Firmware::RepRap)?),
    };
    for (source, axis) in files {
        let mut diagnostics = Diagnostics::new();
        controller.load(source, *axis, &mut diagnostics);
        if diagnostics.has_errors() {
            return Err(Unusable::File(render(source, &diagnostics, false)));
        }
    }
    within_limit(&job, controller.target())?;
    Ok(Checked { findings: controller.findings(), lost: Lost::new(geometry, space, controller.target())? })
}

fn sources(files: &[File]) -> Vec<(SourceFile, Option<usize>)> {
    files.iter().map(|file| (SourceFile::new(file.name.clone(), file.text.clone()), file.axis)).collect()
}

/// Refuses files that make the machine worse: on one whose part turns, a table of one axis may be right at one angle alone.
fn worth_it(lost: &Lost) -> Result<(), Refused> {
    if lost.with_files.rms <= lost.without.rms + LEAST {
        return Ok(());
    }
    let [with, without] = [lost.with_files.rms, lost.without.rms].map(|rms| rms * 1000.0);
    let what = format!(
        "the error at the tool would be {with:.2} um rms with these files and {without:.2} um without them"
    );
    let help = "choose another format, or the poses that matter with --at and --range; this format cannot express the errors of this machine";
    Err(Refused::new(what, help))
}

/// Refuses corrections that the calibration's own limit refuses.
fn within_limit(job: &Job<'_, '_>, target: &dyn Target) -> Result<(), Refused> {
    let Some(limit) = job.geometry.calibration.limits.compensation else { return Ok(()) };
    for pose in job.space.poses(job.geometry) {
        let correction = target.correction(&pose)?;
        let length = correction.iter().map(|part| part * part).sum::<f64>().sqrt();
        if length > limit.value {
            let what = format!(
                "a correction of {:.4} mm in the workspace exceeds the calibration's limit of {} mm",
                length, limit.value
            );
            return Err(Refused::new(what, "check the numbers before you raise `limits: compensation`"));
        }
    }
    Ok(())
}
