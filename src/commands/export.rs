//! `abbe export`: a calibration as the files of a controller. In: a calibration, and what the user says of the controller. Out:
//! files, how they are loaded, and what they cannot carry; or what the controller would take from files that are there.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use exchange::controller::{self, Format, Geometry, Options, Refused, Sense, Space, Unusable, Wanted};
use exchange::controller::{Kind, Unit};
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use workshop::calibrated;
use workshop::failure::Failure;
use workshop::load;
use workshop::written;

use crate::arguments::{Export, ExportFormat, ExportValue, LinearUnit};
use crate::output::{Person, print};

/// The cross tables that a Sinumerik has where nothing else is said.
const TABLES: usize = 8;

/// Runs the command.
pub(crate) fn run(command: &Export) -> Result<(), Failure> {
    let calibrated = calibrated::read(&command.calibration, &Person::default())?;
    if !command.leave_out_uncompensable {
        calibrated.refuse_uncompensable()?;
    }
    let equations = &calibrated.equations;
    let geometry = Geometry::new(equations, &calibrated.calibration);
    let space =
        Space::new(equations, &calibrated.calibration, &wanted(command, equations)).map_err(refused)?;
    check_options(command)?;
    check_names(command, equations)?;
    if command.check.is_empty() {
        write(command, &geometry, &space)
    } else {
        check(command, &geometry, &space)
    }
}

fn write(command: &Export, geometry: &Geometry<'_>, space: &Space) -> Result<(), Failure> {
    let options = options(command);
    let export = controller::export(geometry, space, format(command), &options).map_err(refused)?;
    let targets: Vec<PathBuf> = export.files.iter().map(|file| command.output.join(&file.name)).collect();
    check_targets(command, &targets)?;
    let staged = targets.iter().zip(&export.files).map(|(target, file)| {
        written::staged(target, |out| std::io::Write::write_all(out, file.text.as_bytes()))
    });
    let staged = staged.collect::<Result<Vec<_>, Failure>>()?;
    for (staged, target) in staged.into_iter().zip(&targets) {
        staged.keep().map_err(|error| written::cannot_write(target, &error))?;
    }
    let files = targets
        .iter()
        .zip(&export.files)
        .map(|(target, file)| format!("{}: {}", target.display(), file.about));
    let mut text = listed("written", files);
    text += &listed("to load them", export.loading.iter().cloned());
    text += &listed("left out", export.left_out.iter().cloned());
    text += &controller::text(geometry, space, &export.lost);
    print(&text)
}

fn check(command: &Export, geometry: &Geometry<'_>, space: &Space) -> Result<(), Failure> {
    let files = command.check.iter().map(|named| named_file(named, geometry.equations));
    let files = files.collect::<Result<Vec<_>, Failure>>()?;
    let checked = controller::check(geometry, space, format(command), &options(command), &files);
    let checked = checked.map_err(|error| match error {
        Unusable::Refused(reason) => refused(reason),
        Unusable::File(text) => Failure::wrong(text),
    })?;
    let mut text = listed("what the controller leaves out", checked.findings.into_iter());
    text += &controller::text(geometry, space, &checked.lost);
    print(&text)
}

/// A heading and its lines; nothing where there are none.
fn listed(heading: &str, lines: impl Iterator<Item = String>) -> String {
    let lines: String = lines.map(|line| format!("  {line}\n")).collect();
    if lines.is_empty() { lines } else { format!("{heading}:\n{lines}") }
}

/// `X=x.comp`, or a file without an axis.
fn named_file(named: &str, equations: &Equations) -> Result<(SourceFile, Option<usize>), Failure> {
    let is_letter = |word: &str| word.len() == 1 && word.bytes().all(|letter| letter.is_ascii_uppercase());
    let Some((letter, path)) = named.split_once('=').filter(|(letter, _)| is_letter(letter)) else {
        return Ok((load::read(Path::new(named))?, None));
    };
    let axis = axis_of(letter, equations).ok_or_else(|| no_axis("--check", letter, equations))?;
    Ok((load::read(Path::new(path))?, Some(axis)))
}

fn axis_of(letter: &str, equations: &Equations) -> Option<usize> {
    equations.axes.iter().position(|axis| axis.letter == letter)
}

/// Refuses files that are there already, unless they are to be replaced, and a folder that is not there.
fn check_targets(command: &Export, targets: &[PathBuf]) -> Result<(), Failure> {
    for target in targets {
        if target.exists() && !command.force {
            return Err(Failure::wrong(format!(
                "error: {} is there already\nhelp: --output takes another folder, --force replaces the file",
                target.display()
            )));
        }
    }
    if command.output.is_dir() {
        return Ok(());
    }
    let folder = command.output.display();
    Err(Failure::wrong(format!(
        "error: there is no such folder {folder}\nhelp: --output takes a folder that is there"
    )))
}

/// Refuses options of other formats: whoever gives one means that it does something.
fn check_options(command: &Export) -> Result<(), Failure> {
    use ExportFormat::{Heidenhain, Linuxcnc, Pmac, Sinumerik};
    let options = [
        ("--type", command.kind.is_some(), &[Linuxcnc][..]),
        ("--unit", command.unit.is_some(), &[Linuxcnc]),
        ("--value", command.value.is_some(), &[Sinumerik, Heidenhain]),
        ("--tables", command.tables.is_some(), &[Sinumerik]),
        ("--name", !command.name.is_empty(), &[Sinumerik, Heidenhain, Pmac]),
        ("--counts", !command.counts.is_empty(), &[Pmac]),
    ];
    let stray = options.into_iter().find(|(_, given, formats)| *given && !formats.contains(&command.format));
    let Some((option, _, formats)) = stray else { return Ok(()) };
    let names: Vec<String> = formats.iter().map(|format| name(*format)).collect();
    Err(Failure::wrong(format!(
        "error: {option} says nothing to {}\nhelp: leave it out; it is an option of {}",
        name(command.format),
        names.join(", ")
    )))
}

/// What a format is called on the command line.
fn name(format: ExportFormat) -> String {
    format.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

/// Refuses options for axes that the machine lacks; those of the workspace are looked at with it.
fn check_names(command: &Export, equations: &Equations) -> Result<(), Failure> {
    let named = command.name.iter().map(|(axis, _)| ("--name", axis));
    let counted = command.counts.iter().map(|(axis, _)| ("--counts", axis));
    for (option, axis) in named.chain(counted) {
        if axis_of(axis, equations).is_none() {
            return Err(no_axis(option, axis, equations));
        }
    }
    match command.counts.iter().find(|(_, counts)| *counts <= 0.0) {
        Some((axis, _)) => {
            Err(Failure::wrong(format!("error: --counts {axis}=...: write a number above zero")))
        }
        None => Ok(()),
    }
}

fn no_axis(option: &str, axis: &str, equations: &Equations) -> Failure {
    let axes: Vec<&str> = equations.axes.iter().map(|axis| axis.letter.as_str()).collect();
    Failure::wrong(format!(
        "error: {option} {axis}=...: {} has no such axis\nhelp: its axes are {}",
        equations.machine,
        axes.join(", ")
    ))
}

/// What the user says of the workspace, in mm and rad.
fn wanted(command: &Export, equations: &Equations) -> Wanted {
    let internal = |letter: &String, place: f64| {
        let rotary = equations.axes.iter().any(|axis| axis.letter == *letter && axis.rotary);
        if rotary { place.to_radians() } else { place }
    };
    let range = |(letter, ends): &(String, [f64; 2])| (letter.clone(), ends.map(|end| internal(letter, end)));
    Wanted {
        ranges: command.range.iter().map(range).collect(),
        reference: command
            .at
            .iter()
            .map(|(letter, place)| (letter.clone(), internal(letter, *place)))
            .collect(),
    }
}

impl From<LinearUnit> for Unit {
    fn from(unit: LinearUnit) -> Self {
        match unit {
            LinearUnit::Mm => Self::MM,
            LinearUnit::In => Self::INCH,
        }
    }
}

fn options(command: &Export) -> Options {
    Options {
        points: command.points,
        kind: if command.kind == Some(0) { Kind::Actual } else { Kind::Trim },
        unit: command.unit.map_or(Unit::MM, Unit::from),
        sense: command.value.map(|value| match value {
            ExportValue::Error => Sense::Error,
            ExportValue::Correction => Sense::Correction,
        }),
        tables: command.tables.unwrap_or(TABLES),
        names: command.name.clone(),
        counts: command.counts.clone(),
    }
}

fn format(command: &Export) -> Format {
    match command.format {
        ExportFormat::Linuxcnc => Format::LinuxCnc,
        ExportFormat::Isg => Format::Isg,
        ExportFormat::Etalon => Format::Etalon,
        ExportFormat::Sinumerik => Format::Sinumerik,
        ExportFormat::Heidenhain => Format::Heidenhain,
        ExportFormat::Pmac => Format::Pmac,
        ExportFormat::Marlin => Format::Marlin,
        ExportFormat::Klipper => Format::Klipper,
        ExportFormat::Reprap => Format::RepRap,
    }
}

fn refused(reason: Refused) -> Failure {
    Failure::wrong(reason.to_string())
}
