//! Channels: the columns of the data and what each means for the machine.
//!
//! In: the mapping `channels` and the machine's equations. Out: [`Channel`]s, their units checked; or findings.

use model_dsl::algebra::Axis;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::fields::Fields;
use model_dsl::quantity::{Dimension, Unit};
use model_dsl::source::{Span, Spanned};
use model_dsl::suggest::nearest;
use model_dsl::yaml::Node;

use super::place::{DATE, SECOND, is_date, read_every, read_place, scaled_unit};
use super::words::{FORM, keys, near_or_all};

/// A column of the data and what it means.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Its name in the recording file: `command.x`.
    pub name: Spanned<String>,
    /// What it means.
    pub kind: ChannelKind,
    /// Where its numbers stand.
    pub place: ChannelPlace,
    /// The unit of its numbers; none for runs and normals. Dates are in s.
    pub unit: Option<Spanned<Unit>>,
    /// How many of that unit a number in the column is, or the time from row to row: 0.1 for `0.1 um`, else 1.
    pub scale: f64,
    /// That unit as it is written.
    pub written_unit: String,
}

/// Where the numbers of a channel stand.
#[derive(Clone, Debug, PartialEq)]
pub enum ChannelPlace {
    /// In a column with this name.
    Column(Spanned<String>),
    /// Times that are dates with a time of day, in one column or in two: the date and the time of day.
    Dates(Vec<Spanned<String>>),
    /// In a column for each run.
    Runs {
        /// The columns that are read from the first row to the last.
        columns: Vec<Spanned<String>>,
        /// Those that are read from the last row to the first, after the column of the same run; or none.
        back: Vec<Spanned<String>>,
    },
    /// Nowhere: times that are equally far apart from row to row, by one of the unit.
    Every,
}

impl Channel {
    /// The value in mm, rad, s, degC or the unit of a load of a number in the column.
    pub fn to_internal(&self, number: f64) -> f64 {
        self.unit.map_or(number, |unit| unit.value.to_internal(number * self.scale))
    }

    /// The names of its columns, in the order in which they are read.
    pub fn columns(&self) -> Vec<&Spanned<String>> {
        match &self.place {
            ChannelPlace::Column(column) => vec![column],
            ChannelPlace::Dates(columns) => columns.iter().collect(),
            ChannelPlace::Runs { columns, back } => columns.iter().chain(back).collect(),
            ChannelPlace::Every => Vec::new(),
        }
    }

    /// Whether it has a column for each run.
    pub fn is_wide(&self) -> bool {
        matches!(self.place, ChannelPlace::Runs { .. })
    }
}

/// What a channel means. An axis is a number in the machine's axes, a direction 0, 1 or 2 for X, Y or Z of the part's
/// frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChannelKind {
    /// When the row was taken.
    Time,
    /// Which repeat the row belongs to.
    Run,
    /// The programmed position of an axis.
    Command(usize),
    /// The drive's own feedback of an axis.
    Actual(usize),
    /// The tool tip relative to the part in a direction.
    Measured(usize),
    /// The angle of a rotary axis, in the sense of its command.
    MeasuredAngle(usize),
    /// The reading of every instrument but `position`.
    Deviation,
    /// The normal's component in a direction.
    Normal(usize),
    /// A temperature by name.
    Temperature(String),
    /// A load by name.
    Load(String),
}

/// The channels of a recording.
pub(super) struct Channels {
    /// Those that are understood.
    pub(super) known: Vec<Channel>,
    /// The names of all, also of those with a mistake: what is there wrongly is not missing.
    pub(super) names: Vec<String>,
}

/// The unit that a channel must have.
enum UnitRule {
    /// None at all.
    None,
    /// One of this kind.
    Kind(Dimension),
    /// One that loads have.
    Load,
}

/// The kinds of load.
const LOADS: [Dimension; 5] =
    [Dimension::FORCE, Dimension::VOLTAGE, Dimension::CURRENT, Dimension::PERCENT, Dimension::COUNT];

/// The first words of channels that have a second one.
const FAMILIES: [&str; 6] = ["command", "actual", "measured", "normal", "temperature", "load"];

/// Reads the mapping `channels`; `angular` tells that the instrument's deviation is an angle.
pub(super) fn read_channels(
    node: &Node,
    key: Span,
    angular: bool,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) -> Channels {
    let Some(entries) = node.entries() else {
        let message =
            format!("`channels` must be a mapping of channels to columns, found {}", node.kind_name());
        let mistake = Diagnostic::error(FORM, node.span, message);
        diagnostics
            .push(mistake.help("write one line such as `time: {column: t_s, unit: s}` for each channel"));
        return Channels { known: Vec::new(), names: vec!["time".to_owned()] };
    };
    let names: Vec<String> = entries.iter().map(|(name, _)| name.value.clone()).collect();
    if !names.iter().any(|name| name == "time") {
        let mistake = Diagnostic::error("E0601", key, "`channels` needs the channel `time`");
        diagnostics.push(mistake.help("add `time: {column: ..., unit: s}`"));
    }
    let known = entries.iter().filter_map(|(name, node)| {
        let kind = kind_of(name, equations).map_err(|mistake| diagnostics.push(*mistake)).ok();
        read_channel(name, kind, node, angular, equations, diagnostics)
    });
    Channels { known: known.collect(), names }
}

fn read_channel(
    name: &Spanned<String>,
    kind: Option<ChannelKind>,
    node: &Node,
    angular: bool,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) -> Option<Channel> {
    let what = format!("`{}`", name.value);
    let wording = keys(&what);
    let known: &[&str] = match name.value.as_str() {
        "time" => &["column", "unit", "every"],
        "run" => &["column", "unit"],
        _ => &["column", "unit", "columns", "back"],
    };
    let fields = Fields::open(node, name.span, wording, known, diagnostics)?;
    if fields.get("every").is_some() {
        return read_every(name, kind?, &fields, diagnostics);
    }
    let dates =
        kind == Some(ChannelKind::Time) && fields.get("unit").and_then(Node::text).is_some_and(is_date);
    let place = read_place(name, &fields, dates, diagnostics);
    let kind = kind?;
    if dates {
        let unit = fields.get("unit").map(|node| Spanned::new(SECOND, node.span));
        let written_unit = DATE.to_owned();
        return Some(Channel { name: name.clone(), kind, place: place?, unit, scale: 1.0, written_unit });
    }
    let rule = unit_rule(&kind, angular, equations);
    let (unit, scale) = read_unit(name, &fields, &rule, diagnostics)?;
    let written_unit = fields.get("unit").and_then(Node::text).unwrap_or("").trim().to_owned();
    Some(Channel { name: name.clone(), kind, place: place?, unit, scale, written_unit })
}

fn unit_rule(kind: &ChannelKind, angular: bool, equations: &Equations) -> UnitRule {
    let of_axis = |axis: usize| match equations.axes.get(axis) {
        Some(axis) if axis.rotary => UnitRule::Kind(Dimension::ANGLE),
        _ => UnitRule::Kind(Dimension::LENGTH),
    };
    match kind {
        ChannelKind::Time => UnitRule::Kind(Dimension::TIME),
        ChannelKind::Run | ChannelKind::Normal(_) => UnitRule::None,
        ChannelKind::Command(axis) | ChannelKind::Actual(axis) => of_axis(*axis),
        ChannelKind::Measured(_) => UnitRule::Kind(Dimension::LENGTH),
        ChannelKind::MeasuredAngle(_) => UnitRule::Kind(Dimension::ANGLE),
        ChannelKind::Deviation if angular => UnitRule::Kind(Dimension::ANGLE),
        ChannelKind::Deviation => UnitRule::Kind(Dimension::LENGTH),
        ChannelKind::Temperature(_) => UnitRule::Kind(Dimension::TEMPERATURE),
        ChannelKind::Load(_) => UnitRule::Load,
    }
}

/// The unit and how many of it a number is, no unit where none belongs; nothing where there is a finding.
fn read_unit(
    name: &Spanned<String>,
    fields: &Fields<'_>,
    rule: &UnitRule,
    diagnostics: &mut Diagnostics,
) -> Option<(Option<Spanned<Unit>>, f64)> {
    let (expected, usual) = match rule {
        UnitRule::None => return no_unit(name, fields, diagnostics).then_some((None, 1.0)),
        UnitRule::Kind(Dimension::ANGLE) => (Dimension::ANGLE.name(), "deg".to_owned()),
        UnitRule::Kind(kind) => (kind.name(), kind.usual_unit()),
        UnitRule::Load => {
            ("a force, a voltage, a current, a percentage or a count".to_owned(), "N".to_owned())
        }
    };
    let Some(node) = fields.get("unit") else {
        let message = format!("`{}` needs a unit: it is {expected}", name.value);
        let mistake = Diagnostic::error("E0610", name.span, message);
        diagnostics.push(mistake.help(format!("add `unit: {usual}` if that is the unit of the column")));
        return None;
    };
    let (unit, scale) = scaled_unit(node, name, diagnostics)?;
    let found = unit.value.dimension;
    let right = match rule {
        UnitRule::None => true,
        UnitRule::Kind(kind) => found == *kind,
        UnitRule::Load => LOADS.contains(&found),
    };
    if !right {
        let written = node.text().unwrap_or("").trim();
        let message = format!("`{}` must be {expected}, but `{written}` is {}", name.value, kind_name(found));
        let mistake = Diagnostic::error("E0609", node.span, message);
        diagnostics.push(mistake.label("wrong kind of unit").help(format!("use a unit such as `{usual}`")));
        return None;
    }
    Some((Some(unit), scale))
}

fn kind_name(dimension: Dimension) -> String {
    if dimension == Dimension::NONE { "a ratio".to_owned() } else { dimension.name() }
}

fn no_unit(name: &Spanned<String>, fields: &Fields<'_>, diagnostics: &mut Diagnostics) -> bool {
    let Some((key, _)) = fields.entry("unit") else { return true };
    let message = format!("`{}` is a plain number without a unit", name.value);
    diagnostics.push(Diagnostic::error("E0611", key.span, message).help("leave `unit` out"));
    false
}

/// What a channel's name means for this machine.
fn kind_of(name: &Spanned<String>, equations: &Equations) -> Result<ChannelKind, Box<Diagnostic>> {
    let unknown = || Err(Box::new(unknown_channel(name, equations)));
    let Some((family, rest)) = name.value.split_once('.') else {
        return match name.value.as_str() {
            "time" => Ok(ChannelKind::Time),
            "run" => Ok(ChannelKind::Run),
            "deviation" => Ok(ChannelKind::Deviation),
            _ => unknown(),
        };
    };
    match family {
        "temperature" if !rest.trim().is_empty() => Ok(ChannelKind::Temperature(rest.to_owned())),
        "load" if !rest.trim().is_empty() => Ok(ChannelKind::Load(rest.to_owned())),
        "normal" => direction(rest).map(ChannelKind::Normal).map_or_else(unknown, Ok),
        "command" => commanded(name, rest, equations).map(ChannelKind::Command),
        "actual" => axis_of(name, rest, equations).map(ChannelKind::Actual),
        "measured" => measured(name, rest, equations),
        _ => unknown(),
    }
}

/// The axis of a command; a motor has none of its own.
fn commanded(name: &Spanned<String>, rest: &str, equations: &Equations) -> Result<usize, Box<Diagnostic>> {
    let axis = axis_of(name, rest, equations)?;
    match equations.axes.get(axis) {
        Some(motor) if motor.is_motor() => {
            let message = format!("motor {} has no command of its own", motor.letter);
            Err(Box::new(
                Diagnostic::error("E0607", name.span, message)
                    .label("its axes determine its position")
                    .help("leave the column out; use `actual` for the reading of the motor's own encoder"),
            ))
        }
        _ => Ok(axis),
    }
}

fn measured(
    name: &Spanned<String>,
    rest: &str,
    equations: &Equations,
) -> Result<ChannelKind, Box<Diagnostic>> {
    let Some(direction) = direction(rest) else {
        let axis = axis_of(name, rest, equations)?;
        return match equations.axes.get(axis) {
            Some(axis_info) if axis_info.rotary => Ok(ChannelKind::MeasuredAngle(axis)),
            _ => Err(Box::new(unknown_channel(name, equations))),
        };
    };
    if equations.rows.iter().any(|row| row.direction.index() == direction) {
        return Ok(ChannelKind::Measured(direction));
    }
    Err(Box::new(insensitive(name.span, &rest.to_ascii_uppercase(), equations)))
}

/// The finding that a machine's equations have no row in a direction.
pub(super) fn insensitive(span: Span, direction: &str, equations: &Equations) -> Diagnostic {
    let message = format!("{} is not sensitive in {direction}", equations.machine);
    let sensitive: Vec<String> = equations.rows.iter().map(|row| row.direction.to_string()).collect();
    Diagnostic::error("E0608", span, message).help(format!(
        "its sensitive directions are {}; add any other one to `sensitive` in the machine file",
        sensitive.join(", ")
    ))
}

fn direction(letter: &str) -> Option<usize> {
    let all = [Axis::X, Axis::Y, Axis::Z];
    let found = all.iter().find(|axis| axis.letter().to_ascii_lowercase().to_string() == letter)?;
    Some(found.index())
}

fn axis_of(name: &Spanned<String>, letter: &str, equations: &Equations) -> Result<usize, Box<Diagnostic>> {
    let found = equations.axes.iter().position(|axis| &*axis.variable == letter);
    found.ok_or_else(|| {
        let is_axis = letter.len() == 1 && "xyzuvwabc".contains(letter);
        Box::new(if is_axis {
            no_axis(name.span, letter, false, equations)
        } else {
            unknown_channel(name, equations)
        })
    })
}

/// The finding that a machine lacks an axis; set-ups write axes in upper case, channels in lower case.
pub(super) fn no_axis(span: Span, letter: &str, upper: bool, equations: &Equations) -> Diagnostic {
    let message = format!("{} has no axis `{letter}`", equations.machine);
    let axes = equations.axes.iter();
    let known: Vec<&str> =
        axes.map(|axis| if upper { axis.letter.as_str() } else { &*axis.variable }).collect();
    near_or_all(Diagnostic::error("E0607", span, message), letter, "its axes are", &known)
}

fn unknown_channel(name: &Spanned<String>, equations: &Equations) -> Diagnostic {
    let message = format!("there is no channel `{}`", name.value);
    let mistake = Diagnostic::error("E0606", name.span, message);
    let possible = possible_names(equations);
    let near = nearest(&name.value, possible.iter().map(String::as_str));
    if near.is_some() {
        return mistake.suggest(near);
    }
    let (family, rest) = name.value.split_once('.').unwrap_or((&name.value, ""));
    match nearest(family, FAMILIES).filter(|_| !rest.is_empty()) {
        Some(near) if near != family => mistake.help(format!("did you mean `{near}.{rest}`?")),
        _ => {
            mistake.help(format!("the channels are {}, temperature.<name>, load.<name>", possible.join(", ")))
        }
    }
}

/// The channels that a recording of the machine may have, temperatures and loads aside.
fn possible_names(equations: &Equations) -> Vec<String> {
    let plain = ["time", "run", "deviation"].map(str::to_owned).into_iter();
    let axes = equations.axes.iter();
    let of_axes = axes.clone().flat_map(|axis| {
        let command = (!axis.is_motor()).then(|| format!("command.{}", axis.variable));
        command.into_iter().chain([format!("actual.{}", axis.variable)])
    });
    let lower = |direction: Axis| direction.letter().to_ascii_lowercase();
    let measured = equations.rows.iter().map(|row| format!("measured.{}", lower(row.direction)));
    let angles = axes.filter(|axis| axis.rotary).map(|axis| format!("measured.{}", axis.variable));
    let normals = [Axis::X, Axis::Y, Axis::Z].into_iter().map(|axis| format!("normal.{}", lower(axis)));
    plain.chain(of_axes).chain(measured).chain(angles).chain(normals).collect()
}

/// Warns of a column that stands for two things (W0601).
pub(super) fn warn_shared_columns(channels: &[Channel], diagnostics: &mut Diagnostics) {
    for (number, channel) in channels.iter().enumerate() {
        let other_kind = |earlier: &&Channel| {
            std::mem::discriminant(&earlier.kind) != std::mem::discriminant(&channel.kind)
        };
        let earlier = channels.iter().take(number).filter(other_kind);
        let own = channel.columns();
        let shared = earlier.flat_map(|first| first.columns().into_iter().map(move |column| (first, column)));
        let found = shared.filter_map(|(first, column)| {
            own.iter().find(|own| own.value == column.value).map(|own| (first, column, own.span))
        });
        if let Some((first, column, span)) = found.into_iter().next() {
            let message = format!("`{}` and `{}` are the same column", first.name.value, channel.name.value);
            let warning = Diagnostic::warning("W0601", span, message).also(column.span, "first used here");
            diagnostics.push(warning.help("give each channel its own column, or leave one of them out"));
        }
    }
}
