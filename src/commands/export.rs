//! `abbe export`: a calibration as the files of a controller. In: a calibration, and what the user says of the controller. Out:
//! files, how they are loaded, and what they cannot carry; or what the controller would take from files that are there.

use std::path::Path;

use exchange::controller::{self, Format, Geometry, Options, Sense, Space, Unusable, Wanted};
use exchange::controller::{Kind, Unit};
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use workshop::calibrated;
use workshop::exported::{self, TABLES, listed, refused};
use workshop::failure::Failure;
use workshop::load;
use workshop::tools;

use crate::arguments::{Export, ExportFormat, ExportValue, LinearUnit};
use crate::output::{Person, print};

/// Runs the command.
pub(crate) fn run(command: &Export) -> Result<(), Failure> {
    let mut calibrated = calibrated::read(&command.calibration, &Person::default())?;
    if let Some(name) = &command.tool {
        tools::mount(&mut calibrated.calibration, name)?;
    }
    let calibrated = calibrated;
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
    let export = exported::export(geometry, space, format(command), &options(command))?;
    let targets = exported::write(&export, &command.output, command.force)?;
    print(&exported::text(&export, &targets, geometry, space))
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

/// Refuses options of other formats.
fn check_options(command: &Export) -> Result<(), Failure> {
    let options = [
        ("type", command.kind.is_some()),
        ("unit", command.unit.is_some()),
        ("value", command.value.is_some()),
        ("tables", command.tables.is_some()),
        ("name", !command.name.is_empty()),
        ("counts", !command.counts.is_empty()),
    ];
    let given: Vec<&str> = options.iter().filter(|(_, given)| *given).map(|(name, _)| *name).collect();
    exported::check_options(format(command), &given, "--")
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
    check_once("--name", command.name.iter().map(|(axis, _)| axis))?;
    check_once("--counts", command.counts.iter().map(|(axis, _)| axis))?;
    check_once("--range", command.range.iter().map(|(axis, _)| axis))?;
    check_once("--at", command.at.iter().map(|(axis, _)| axis))?;
    match command.counts.iter().find(|(_, counts)| *counts <= 0.0) {
        Some((axis, _)) => {
            Err(Failure::wrong(format!("error: --counts {axis}=...: write a number above zero")))
        }
        None => Ok(()),
    }
}

/// Refuses an option that is given twice for one axis.
fn check_once<'o>(option: &str, axes: impl Iterator<Item = &'o String>) -> Result<(), Failure> {
    let mut known: Vec<&String> = Vec::new();
    for axis in axes {
        if known.contains(&axis) {
            let text = format!(
                "error: {option} {axis}=...: it is given twice for this axis\nhelp: keep one of the two"
            );
            return Err(Failure::wrong(text));
        }
        known.push(axis);
    }
    Ok(())
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
