//! From a geometry to files, and from files to what they are worth. In: a format and its options. Out: files with what they
//! lose; or, of files that are there, what the controller takes from them.

use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::SourceFile;

use super::geometry::Geometry;
use super::lost::{Lost, Target};
use super::refused::Refused;
use super::space::Space;
use super::{etalon, heidenhain, isg, linuxcnc, pmac, sinumerik};

/// Whose files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// LinuxCNC: `[JOINT_n] COMP_FILE`.
    LinuxCnc,
    /// ISG kernel and Beckhoff: volumetric compensation, ISG CSV.
    Isg,
    /// Etalon Exchange, variant Vendor, which the ISG kernel reads too.
    Etalon,
    /// Siemens SINUMERIK: `$AA_ENC_COMP` and `$AN_CEC`.
    Sinumerik,
    /// HEIDENHAIN: `.COM`, as a TNC 640 has it.
    Heidenhain,
    /// Delta Tau PMAC: `DEFINE COMP` and `DEFINE BLCOMP`.
    Pmac,
}

/// What a controller does with a number of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// It is the error, actual minus commanded: the controller moves the other way.
    Error,
    /// It is added to the command.
    Correction,
}

impl Sense {
    /// What a correction is multiplied by to be the number.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Error => -1.0,
            Self::Correction => 1.0,
        }
    }
}

/// What the user says of the controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The number of points of a table, evenly spaced.
    pub points: Option<usize>,
    /// LinuxCNC: the type of its files.
    pub kind: linuxcnc::Kind,
    /// LinuxCNC: its unit of length.
    pub unit: linuxcnc::Unit,
    /// What a number is, where no public document says it.
    pub sense: Option<Sense>,
    /// The number of cross tables that the controller has.
    pub tables: usize,
    /// The controller's name of an axis, or its motor's number, by axis letter.
    pub names: Vec<(String, String)>,
    /// PMAC: counts of a motor for a mm, by axis letter.
    pub counts: Vec<(String, f64)>,
}

impl Options {
    /// The controller's name of an axis, where the user says one.
    pub(super) fn name(&self, letter: &str) -> Option<&str> {
        self.names.iter().find(|(said, _)| said == letter).map(|(_, name)| name.as_str())
    }
}

/// One file.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// Its name.
    pub name: String,
    /// The axis whose it is alone, by number, where its text does not say it.
    pub axis: Option<usize>,
    /// What stands in it.
    pub text: String,
    /// What it is, in a few words.
    pub about: String,
}

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

/// What the writers of all formats get.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job<'j, 'c> {
    pub(super) geometry: &'j Geometry<'c>,
    pub(super) space: &'j Space,
    pub(super) options: &'j Options,
}

/// What the writers of all formats give.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Written {
    pub(super) files: Vec<File>,
    pub(super) loading: Vec<String>,
    pub(super) left_out: Vec<String>,
}

/// A controller that takes files.
pub(super) trait Controller: Target {
    /// Takes a file as the controller's maker documents it; `axis` is the axis whose it is, where its text does not say it.
    fn load(&mut self, source: &SourceFile, axis: Option<usize>, diagnostics: &mut Diagnostics);

    /// What it takes otherwise than somebody might think.
    fn findings(&self) -> Vec<String> {
        Vec::new()
    }

    /// The target that it is then.
    fn target(&self) -> &dyn Target;
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
    let job = Job { geometry, space, options };
    let Written { files, loading, left_out } = match format {
        Format::LinuxCnc => linuxcnc::written(&job),
        Format::Isg => isg::written(&job),
        Format::Etalon => etalon::written(&job),
        Format::Sinumerik => sinumerik::written(&job),
        Format::Heidenhain => heidenhain::written(&job),
        Format::Pmac => pmac::written(&job),
    }?;
    let read = check(geometry, space, format, options, &sources(&files)).map_err(|error| match error {
        Unusable::Refused(refused) => refused,
        Unusable::File(text) => Refused::new(
            format!("what was written could not be read again\n{text}"),
            "this is a fault of Abbe",
        ),
    })?;
    if let Some(finding) = read.findings.first() {
        return Err(Refused::new(
            format!("the controller would not take all of it: {finding}"),
            "this is a fault of Abbe",
        ));
    }
    Ok(Export { files, loading, left_out, lost: read.lost })
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
        Format::Sinumerik => Box::new(sinumerik::controller(&job)),
        Format::Heidenhain => Box::new(heidenhain::controller(&job)?),
        Format::Pmac => Box::new(pmac::controller(&job)?),
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

/// Refuses corrections that the calibration's own limit refuses.
fn within_limit(job: &Job<'_, '_>, target: &dyn Target) -> Result<(), Refused> {
    let Some(limit) = job.geometry.calibration.limits.compensation else { return Ok(()) };
    for pose in job.space.poses(job.geometry) {
        let correction = target.correction(&pose)?;
        let length = correction.iter().map(|part| part * part).sum::<f64>().sqrt();
        if length > limit.value {
            let what = format!(
                "a correction of {:.4} mm in the workspace is over the calibration's limit of {} mm",
                length, limit.value
            );
            return Err(Refused::new(
                what,
                "see that the numbers are right before you raise `limits: compensation`",
            ));
        }
    }
    Ok(())
}
