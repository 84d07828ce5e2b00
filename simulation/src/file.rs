//! Path files: what `abbe simulate` is to drive and how it is read.
//!
//! In: the tree of a path file and the machine that it is for. Out: a [`PathFile`], or findings at the places that are
//! wrong, all of them in one run.
//!
//! | code | finding |
//! | --- | --- |
//! | E0701 | a required key is missing |
//! | E0702 | a version that is not read, or another kind of file |
//! | E0703 | an unknown key |
//! | E0704 | a mapping, list or word is needed in place of what stands there |
//! | E0705 | an axis that the machine lacks |
//! | E0706 | no shape, or more than one |
//! | E0707 | no instrument, more than one, or an unknown one |
//! | E0708 | a number out of its range |
//! | E0709 | not a direction or a plane |
//! | E0710 | an axis with one end only |
//! | E0711 | an angle of an axis that does not turn |
//! | E0712 | a temperature or load that the calibration needs |
//! | E0714 | a term that no drive sees |
//! | E0715 | a held-out run that is not driven |
//! | E0716 | a word that is not among those possible here |
//! | E0717 | a path that cannot be driven |
//!
//! Quantities have their own codes, E0301 to E0309.

mod instruments;
mod noises;
mod section;
mod shapes;

use model_dsl::calibration::MachineNames;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::kind::another_kind;
use model_dsl::machine::Machine;
use model_dsl::quantity::Dimension;
use model_dsl::source::{Span, Spanned};
use model_dsl::yaml::Node;

use crate::datum::Datum;
use crate::instrument::Instrument;
use crate::noise::Noise;
use crate::path::{Path, PathError, Shape};
use crate::plant::Plant;
use crate::simulate::{Measurement, Scenario};
use section::{Context, Section, list, named, word};

/// A path file.
#[derive(Clone, Debug)]
pub struct PathFile {
    /// What is to be simulated.
    pub scenario: Scenario,
    /// The terms that the drives see: the name of a motion, and that of a term of it.
    pub drive_terms: Vec<(Spanned<String>, Spanned<String>)>,
    /// Where the shape stands, for findings about the whole path.
    pub shape: Span,
    /// Where the instrument stands.
    pub instrument: Span,
    /// Where the numbers stand that make a path long, of those that are given.
    pub lengthening: Vec<(Lengthening, Span)>,
}

/// What makes a path long, beside its shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lengthening {
    /// Many runs.
    Runs,
    /// A high rate.
    Rate,
    /// A low feed.
    Feed,
}

impl Lengthening {
    const ALL: [(&str, Self); 3] = [("runs", Self::Runs), ("rate", Self::Rate), ("feed", Self::Feed)];

    /// The path with a number that is usual in its place.
    fn usual(self, path: &Path) -> Path {
        let mut path = path.clone();
        match self {
            Self::Runs => path.runs = 1,
            Self::Rate => path.rate = 1.0,
            Self::Feed => path.feed = 10.0,
        }
        path
    }

    fn help(self) -> &'static str {
        match self {
            Self::Runs => "write fewer runs",
            Self::Rate => "write a lower rate, such as `100 Hz`",
            Self::Feed => "write a higher feed, such as `1000 mm/min`",
        }
    }
}

const KEYS: [&str; 19] = [
    "path",
    "title",
    "at",
    "feed",
    "acceleration",
    "rate",
    "runs",
    "pause",
    "instrument",
    "clock",
    "datum",
    "offset",
    "noise",
    "missing",
    "fixture",
    "drive",
    "temperatures",
    "loads",
    "holdout",
];

/// Reads a path file for a machine. Every finding is reported; nothing is returned where one is an error.
pub fn read(
    root: &Node,
    machine: &Machine,
    names: &MachineNames,
    diagnostics: &mut Diagnostics,
) -> Option<PathFile> {
    let mut own = Diagnostics::new();
    let file = read_all(root, &mut Context { machine, names, diagnostics: &mut own });
    let failed = own.has_errors();
    diagnostics.extend(own);
    file.filter(|_| !failed)
}

fn read_all(root: &Node, context: &mut Context<'_>) -> Option<PathFile> {
    let start = root.entries().and_then(<[_]>::first).map_or(root.span, |(key, _)| key.span);
    if let Some(kind) = another_kind(root, "path") {
        let mistake = Diagnostic::error("E0702", start, format!("this is {kind}, not a path file"));
        context.report(mistake.help("begin a path file with `path: 1`"));
        return None;
    }
    let known: Vec<&str> = KEYS.iter().chain(&shapes::SHAPES).copied().chain(["seed"]).collect();
    let section = Section::open(root, start, "a path", &known, context)?;
    version(&section, context);
    let title =
        section.part("title", |node, _| word(node, "`title`", context).map(|word| word.value.to_owned()));
    let shape = shape(&section, start, context);
    let path = path(&section, shape.as_ref().map(|(shape, _)| shape), context);
    let instrument = section
        .need("instrument", context)
        .and_then(|node| instruments::read(node, section.key_span("instrument"), context));
    let measurement = measurement(&section, instrument, context);
    let temperatures = section.part("temperatures", |node, _| noises::temperatures(node, context));
    let loads = section.part("loads", |node, _| noises::loads(node, context));
    let runs = path.as_ref().map(|path| path.runs);
    let holdout = section.part("holdout", |node, _| holdout(node, runs, context));
    let (measurement, drive_terms) = measurement?;
    let (_, shape) = shape?;
    let scenario = Scenario {
        title: title?,
        path: path?,
        temperatures: temperatures?.unwrap_or_default(),
        loads: loads?.unwrap_or_default(),
        measurement,
        holdout: holdout?.unwrap_or_default(),
    };
    let given = Lengthening::ALL.into_iter().filter_map(|(key, one)| Some((one, section.get(key)?.span)));
    let (lengthening, instrument) = (given.collect(), section.key_span("instrument"));
    Some(PathFile { scenario, drive_terms, shape, instrument, lengthening })
}

fn version(section: &Section<'_, '_>, context: &mut Context<'_>) {
    let Some(node) = section.need("path", context) else { return };
    if node.text() != Some("1") {
        let message = match node.text() {
            Some(text) => format!("version `{text}` of the path format is unknown"),
            None => format!("`path` must be the version of the format, found {}", node.kind_name()),
        };
        context.report(Diagnostic::error("E0702", node.span, message).help("write `path: 1`"));
    }
}

/// The one shape of the file.
fn shape(section: &Section<'_, '_>, start: Span, context: &mut Context<'_>) -> Option<(Shape, Span)> {
    let found: Vec<_> = shapes::SHAPES.iter().filter_map(|key| section.entry(key)).collect();
    match found.as_slice() {
        [(key, node)] => shapes::read(&key.value, node, key.span, context).map(|shape| (shape, key.span)),
        [] => {
            let mistake = Diagnostic::error("E0706", start, "this path has no shape");
            context.report(mistake.help(format!("add one of {}", shapes::SHAPES.join(", "))));
            None
        }
        [(first, _), (second, _), ..] => {
            let mistake = Diagnostic::error("E0706", second.span, "a path must have one shape");
            let mistake = mistake.also(first.span, format!("`{}` here", first.value));
            context.report(mistake.help("write one path file for each shape"));
            None
        }
    }
}

fn path(section: &Section<'_, '_>, shape: Option<&Shape>, context: &mut Context<'_>) -> Option<Path> {
    let at = at(section, context);
    let angular = shape.is_some_and(|shape| turning(shape, context));
    let way = if angular { Dimension::ANGLE } else { Dimension::LENGTH };
    let still = section.get("still").is_some();
    let stations = section.get("line").is_some_and(|line| line.get("stations").is_some());
    // Of a shape that could not be read, nobody knows what moves.
    let unknown = shape.is_none() && (section.get("line").is_some() || section.get("points").is_some());
    let speed = way.per(Dimension::TIME);
    let feed = match section.get("feed") {
        None if still => Some(1.0),
        Some(_) if unknown => None,
        _ => section.positive("feed", speed, context),
    };
    let acceleration = match section.get("acceleration") {
        Some(_) if unknown => None,
        Some(_) => section.positive("acceleration", speed.per(Dimension::TIME), context).map(Some),
        None => Some(None),
    };
    let rate = match section.get("rate") {
        None if stations => Some(1.0),
        _ => section.positive("rate", Dimension::FREQUENCY, context),
    };
    let runs = section.whole_or("runs", 1, 1, context);
    let pause = match section.get("pause") {
        Some(_) => section.positive("pause", Dimension::TIME, context),
        None => Some(1.0),
    };
    Some(Path {
        at: at?,
        shape: shape?.clone(),
        feed: feed?,
        acceleration: acceleration?,
        rate: rate?,
        runs: runs?,
        pause: pause?,
    })
}

/// Whether only rotary axes move.
fn turning(shape: &Shape, context: &Context<'_>) -> bool {
    let mut axes = match shape {
        Shape::Line { strokes, .. } => strokes.iter().map(|stroke| stroke.axis).collect::<Vec<_>>(),
        Shape::Points(points) => points.iter().flatten().map(|(axis, _)| *axis).collect(),
        _ => return false,
    }
    .into_iter();
    axes.all(|axis| context.rotary(axis))
}

/// Where the axes stand: a position, or a list with one for each run.
fn at(section: &Section<'_, '_>, context: &mut Context<'_>) -> Option<Vec<Vec<f64>>> {
    let mut places = vec![Vec::new(); context.names.axes.len()];
    let Some(node) = section.get("at") else { return Some(places) };
    let mut whole = true;
    for (letter, node) in named(node, "`at`", "{X: 275 mm, Z: -50 mm}", context)? {
        let Some(axis) = context.axis(&letter.value, letter.span) else {
            whole = false;
            continue;
        };
        let words = format!("the position of {}", letter.value);
        let nodes = node.items().unwrap_or(std::slice::from_ref(node));
        let read = nodes.iter().map(|node| context.size(node, context.dimension(axis), &words));
        let read: Vec<Option<f64>> = read.collect();
        whole &= read.iter().all(Option::is_some);
        if let Some(slot) = places.get_mut(axis) {
            slot.extend(read.into_iter().flatten());
        }
    }
    whole.then_some(places)
}

type DriveTerms = Vec<(Spanned<String>, Spanned<String>)>;

fn measurement(
    section: &Section<'_, '_>,
    instrument: Option<Instrument>,
    context: &mut Context<'_>,
) -> Option<(Measurement, DriveTerms)> {
    let angular = instrument.as_ref().is_some_and(Instrument::angular);
    let kind = if angular { Dimension::ANGLE } else { Dimension::LENGTH };
    let clock = section.quantity_or("clock", Dimension::TIME, 0.0, context);
    let datum = section.part("datum", |node, name| datum(node, name, instrument.as_ref(), context));
    let fixture = section.not_negative("fixture", Dimension::LENGTH, 0.0, context);
    let missing = section.part("missing", |node, name| noises::missing(node, name, context));
    let drive = section.part("drive", |node, name| drive(node, name, context));
    let seed = match section.get("seed") {
        Some(node) => context.whole(node, "`seed`", 0).map(u64::from),
        None => Some(0),
    };
    // Without the instrument nobody knows whether these are lengths or angles.
    let instrument = instrument?;
    let offset = section.quantity_or("offset", kind, 0.0, context);
    let noise = section.part("noise", |node, name| noises::noise(node, name, kind, context));
    let (drives, drive_noise, drive_terms) = drive?.unwrap_or_default();
    let measurement = Measurement {
        instrument,
        clock: clock?,
        datum: datum?,
        offset: offset?,
        noise: noise?.unwrap_or_default(),
        missing: missing?.unwrap_or_default(),
        fixture: fixture?,
        drives,
        drive_noise,
        sensor_noise: Vec::new(),
        seed: seed?,
    };
    Some((measurement, drive_terms))
}

/// How the part lies: `{x: 0.2 mm, c: 0.03 deg}`. Of instruments that measure no part it is refused (E0703).
fn datum(
    node: &Node,
    name: Span,
    instrument: Option<&Instrument>,
    context: &mut Context<'_>,
) -> Option<Datum> {
    if let Some(other) = instrument.filter(|instrument| !instrument.measures_parts()) {
        let message = format!("`datum` is for a part, but this `{}` measures none", other.name());
        let help = "leave `datum` out, or use `position` along x, y or z, or `probe`";
        context.report(Diagnostic::error("E0703", name, message).help(help));
        return None;
    }
    let section = Section::open(node, name, "`datum`", &["x", "y", "z", "a", "b", "c"], context)?;
    let [x, y, z] = ["x", "y", "z"].map(|key| section.quantity_or(key, Dimension::LENGTH, 0.0, context));
    let [a, b, c] = ["a", "b", "c"].map(|key| section.quantity_or(key, Dimension::ANGLE, 0.0, context));
    Some(Datum { displacement: [x?, y?, z?], rotation: [a?, b?, c?] })
}

type Drive = (Vec<usize>, Noise, DriveTerms);

fn drive(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Drive> {
    let section = Section::open(node, name, "`drive`", &["axes", "noise", "sees"], context)?;
    let items = list(section.need("axes", context)?, "`axes` of `drive`", context)?;
    let axes: Vec<Option<usize>> = items
        .iter()
        .map(|item| {
            let letter = word(item, "an axis of `drive`", context)?;
            context.axis(letter.value, letter.span)
        })
        .collect();
    let axes = axes.into_iter().collect::<Option<Vec<usize>>>();
    let angular = axes.iter().flatten().all(|axis| context.rotary(*axis));
    let kind = if angular { Dimension::ANGLE } else { Dimension::LENGTH };
    let noise = section.part("noise", |node, name| noises::noise(node, name, kind, context));
    let sees = section.part("sees", |node, _| sees(node, context));
    Some((axes?, noise?.unwrap_or_default(), sees?.unwrap_or_default()))
}

fn sees(node: &Node, context: &mut Context<'_>) -> Option<DriveTerms> {
    let mut terms = Vec::new();
    for (motion, node) in named(node, "`sees`", "{EXX: [backlash]}", context)? {
        for item in list(node, &format!("what the drive sees of {}", motion.value), context)? {
            let term = word(item, "a term", context)?;
            terms.push((motion.clone(), term.map(str::to_owned)));
        }
    }
    Some(terms)
}

/// `{runs: [3]}`, as in a recording.
fn holdout(node: &Node, driven: Option<u32>, context: &mut Context<'_>) -> Option<Vec<i64>> {
    let section = Section::open(node, node.span, "`holdout`", &["runs"], context)?;
    let items = list(section.need("runs", context)?, "`runs` of `holdout`", context)?;
    let runs: Vec<Option<u32>> = items
        .iter()
        .map(|item| {
            let run = context.whole(item, "a held-out run", 1)?;
            if driven.is_some_and(|driven| run > driven) {
                let mistake = Diagnostic::error("E0715", item.span, format!("run {run} is not driven"));
                context.report(mistake.help("name runs from 1 to `runs`"));
                return None;
            }
            Some(run)
        })
        .collect();
    runs.into_iter().map(|run| run.map(i64::from)).collect()
}

impl PathFile {
    /// Puts the terms that the drives see on their side of the plant, and checks that the path gives what the plant
    /// needs and can be driven. Findings are errors (E0712, E0714, E0717).
    pub fn fit(&self, machine: &Machine, plant: &mut Plant, diagnostics: &mut Diagnostics) {
        for (motion, term) in &self.drive_terms {
            if let Err(error) = plant.see_at_drive(machine, &motion.value, &term.value) {
                let mistake = Diagnostic::error("E0714", term.span, error.to_string());
                let help = "name a term of the calibration, in an axis's own motion such as EXX of X";
                diagnostics.push(mistake.also(motion.span, "of this motion").help(help));
            }
        }
        let missing = |kind: &str, name: &str, example: &str| {
            let message = format!("the calibration needs the {kind} `{name}`, but the path gives none");
            Diagnostic::error("E0712", self.shape, message)
                .help(format!("add `{kind}s: {{{name}: {example}}}`"))
        };
        for name in plant.temperatures() {
            if !self.scenario.temperatures.iter().any(|sensor| sensor.name == name) {
                diagnostics.push(missing("temperature", name, "{start: 20 degC}"));
            }
        }
        for name in plant.loads() {
            if !self.scenario.loads.iter().any(|load| load.name == *name) {
                diagnostics.push(missing("load", name, "{unit: N, base: 0 N}"));
            }
        }
        let rotary: Vec<bool> = plant.names().axes.iter().map(|axis| axis.rotary).collect();
        diagnostics.extend(self.cannot_be_driven(&rotary));
        let circle = self.scenario.path.circle(rotary.len()).is_some();
        if self.scenario.measurement.instrument.needs_circle() && !circle {
            let message = "this path has no circle that gives the instrument's centre";
            let mistake = Diagnostic::error("E0717", self.instrument, message);
            diagnostics.push(mistake.help("give the instrument its centre and radius, or drive a circle"));
        }
    }

    /// Why the path cannot be driven, at the number that is to blame, else at the shape (E0717).
    fn cannot_be_driven(&self, rotary: &[bool]) -> Option<Diagnostic> {
        let path = &self.scenario.path;
        let error = path.timeline(rotary).err()?;
        let would_do = |(one, _): &&(Lengthening, Span)| one.usual(path).timeline(rotary).is_ok();
        let to_blame = self.lengthening.iter().find(would_do).filter(|_| error == PathError::TooLong);
        let (place, help) = match (to_blame, &error) {
            (Some((one, place)), _) => (*place, one.help()),
            (None, PathError::TooLong) => (self.shape, "make the path shorter, or drive it less often"),
            (None, _) => (self.shape, "give the path points that are apart"),
        };
        Some(Diagnostic::error("E0717", place, error.to_string()).help(help))
    }
}
