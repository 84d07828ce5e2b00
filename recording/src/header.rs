//! The recording file as a whole: its top-level keys.
//!
//! In: the tree of the file and the machine's equations. Out: a [`Header`], which knows what every column means and
//! reads the data ([`Header::read_data`]); or findings E0601 to E0621, E0628 to
//! E0631.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::fields::{self, Fields};
use model_dsl::kind::another_kind;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::Spanned;
use model_dsl::yaml::Node;

use super::channel::{Channel, Channels, read_channels, warn_shared_columns};
use super::date::{Moment, check_date, date_of};
use super::form::{Form, read_data};
use super::place::check_runs;
use super::setup::{Kind, read_setup};
use super::suited::check_suited;
use super::words::{FORM, first_key, keys, near_or_all, word};
use super::{Instrument, PartDatum};

const KEYS: [&str; 12] = [
    "recording",
    "title",
    "date",
    "machine",
    "calibration",
    "constants",
    "instrument",
    "data",
    "channels",
    "setup",
    "holdout",
    "extra",
];

/// What a recording file says of its data.
#[derive(Clone, Debug)]
pub struct Header {
    /// Its title.
    pub title: Option<String>,
    /// When it was made.
    pub date: Option<Moment>,
    /// The machine as the file names it: a shipped machine's name, a path, or a topology word.
    pub machine: Spanned<String>,
    /// The calibration file that the file names, a path from its own folder.
    pub calibration: Option<Spanned<String>>,
    /// Constants of the machine that had other values, mm, each with its number.
    pub constants: Vec<(usize, f64)>,
    /// What measured, and how it was set up.
    pub instrument: Instrument,
    /// What is said of how the part lies where it was measured.
    pub datum: PartDatum,
    /// The direction of all readings of a probe, where the set-up gives it in place of channels: a unit vector.
    pub normal: Option<[f64; 3]>,
    /// The file of the data, a path from the recording's own folder.
    pub data: Spanned<String>,
    /// How the table is written, where the file itself does not tell.
    pub form: Form,
    /// The columns and their meanings, in the file's order.
    pub channels: Vec<Channel>,
    /// The runs that are held out, in ascending order, each where the file first names it.
    pub holdout: Option<Vec<Spanned<i64>>>,
    /// Columns that are kept for people and not used.
    pub extra: Vec<Extra>,
    /// The letters of the machine's axes, in its order.
    pub axes: Vec<String>,
    /// Of each of them, where it is a motor, the axes that it follows, by their numbers, each with how far the motor goes for each mm of
    /// it; empty for an axis that a program moves.
    pub follows: Vec<Vec<(usize, f64)>>,
}

/// A column that is kept for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Extra {
    /// What the file calls it.
    pub name: Spanned<String>,
    /// The column's name in the data.
    pub column: Spanned<String>,
}

/// Reads the name of the machine that was recorded, and nothing else.
///
/// Findings: E0601 there is none, E0602 this is another kind of file, E0604 it is not a name, or the file is no mapping.
/// [`read_header`] does not repeat them.
pub fn machine_of(root: &Node, diagnostics: &mut Diagnostics) -> Option<Spanned<String>> {
    if let Some(kind) = another_kind(root, "recording") {
        let message = format!("this is {kind}, not a recording file");
        let mistake = Diagnostic::error("E0602", first_key(root), message);
        diagnostics.push(mistake.help("begin with `recording: 1`, and name the machine and the data"));
        return None;
    }
    if root.entries().is_none() {
        let message = format!("a recording must be a mapping of keys, found {}", root.kind_name());
        let mistake = Diagnostic::error(FORM, root.span, message);
        diagnostics.push(mistake.help("begin with `recording: 1` and `machine: ...`"));
        return None;
    }
    let Some(node) = root.get("machine") else {
        let mistake = Diagnostic::error("E0601", first_key(root), "a recording needs the key `machine`");
        let help = "add `machine: ...`, the name of a machine, the path of its file, or a topology word";
        diagnostics.push(mistake.help(help));
        return None;
    };
    word(node, "`machine`", diagnostics)
}

/// The calibration file that a recording names; what is wrong with it is told by [`read_header`].
pub fn calibration_of(root: &Node) -> Option<Spanned<String>> {
    word(root.get("calibration")?, "", &mut Diagnostics::new())
}

/// Reads everything that the recording file says, for a machine whose equations are known.
///
/// Every finding is reported: the codes are listed in [`super`]. Nothing is returned where one is an error.
pub fn read_header(root: &Node, equations: &Equations, diagnostics: &mut Diagnostics) -> Option<Header> {
    root.entries()?;
    let mut own = Diagnostics::new();
    let header = read_all(root, equations, &mut own);
    let failed = own.has_errors();
    diagnostics.extend(own);
    if failed { None } else { header }
}

fn read_all(root: &Node, equations: &Equations, diagnostics: &mut Diagnostics) -> Option<Header> {
    let wording = keys("a recording");
    let fields = Fields::open(root, first_key(root), wording, &KEYS, diagnostics)?;
    if let Some(version) = fields.need("recording", wording, diagnostics) {
        check_version(version, diagnostics);
    }
    let title = fields.get("title").and_then(|node| read_title(node, diagnostics));
    if let Some(node) = fields.get("date") {
        check_date(node, diagnostics);
    }
    let calibration = fields.get("calibration").and_then(|node| word(node, "`calibration`", diagnostics));
    let constants =
        fields.get("constants").map(|node| read_constants(node, equations, diagnostics)).unwrap_or_default();
    let data = fields.need("data", wording, diagnostics);
    let data = data.and_then(|node| read_data(node, fields.key_span("data"), diagnostics));
    let instrument = fields.need("instrument", wording, diagnostics);
    let instrument = instrument.and_then(|node| read_instrument(node, diagnostics));
    let channels = fields.need("channels", wording, diagnostics);
    let channels = channels.map(|node| {
        let angular = instrument.is_some_and(|kind| kind.value == Kind::Angular);
        read_channels(node, fields.key_span("channels"), angular, equations, diagnostics)
    });
    let setup = match (instrument, &channels) {
        (Some(kind), Some(channels)) => {
            check_suited(kind, fields.key_span("channels"), channels, diagnostics);
            read_setup(&fields, kind, equations, channels, diagnostics)
        }
        _ => None,
    };
    let channels = channels?;
    warn_shared_columns(&channels.known, diagnostics);
    check_runs(&channels.known, diagnostics);
    let holdout =
        fields.entry("holdout").and_then(|(_, node)| read_holdout(node, &fields, &channels, diagnostics));
    let extra = fields.get("extra").map(|node| read_extra(node, diagnostics));
    let machine = word(root.get("machine")?, "`machine`", &mut Diagnostics::new())?;
    let setup = setup?;
    let (data, form) = data?;
    Some(Header {
        title,
        date: date_of(root),
        machine,
        calibration,
        constants,
        instrument: setup.instrument,
        datum: setup.datum,
        normal: setup.normal,
        data,
        form,
        channels: channels.known,
        holdout,
        extra: extra.unwrap_or_default(),
        axes: equations.axes.iter().map(|axis| axis.letter.clone()).collect(),
        follows: equations.names().axes.into_iter().map(|axis| axis.follows).collect(),
    })
}

/// Constants that had other values while it was recorded: E0628 what is no constant of the machine.
fn read_constants(node: &Node, equations: &Equations, diagnostics: &mut Diagnostics) -> Vec<(usize, f64)> {
    let Some(entries) = node.entries() else {
        let message =
            format!("`constants` must be a mapping of names to lengths, found {}", node.kind_name());
        diagnostics.push(Diagnostic::error(FORM, node.span, message).help("write `{Zt: 150 mm}`"));
        return Vec::new();
    };
    // Offsets stand before the parts of the tool's direction, which a recording does not change.
    let known: Vec<&str> = equations.offsets().map(|(_, constant)| &*constant.name).collect();
    let mut constants = Vec::new();
    for (name, node) in entries {
        let Some(number) = known.iter().position(|known| *known == name.value) else {
            let message = format!("{} has no constant `{}`", equations.machine, name.value);
            let mistake = Diagnostic::error(UNKNOWN_CONSTANT, name.span, message);
            diagnostics.push(near_or_all(mistake, &name.value, "its constants are", &known));
            continue;
        };
        let what = format!("the constant {}", name.value);
        let value = quantity::read(node, Dimension::LENGTH, &what, diagnostics);
        constants.extend(value.map(|value| (number, value.value)));
    }
    constants
}

/// The code for a constant that the machine does not have.
const UNKNOWN_CONSTANT: &str = "E0628";

fn check_version(node: &Node, diagnostics: &mut Diagnostics) {
    if node.text() == Some("1") {
        return;
    }
    let message = match node.text() {
        Some(text) => format!("version `{text}` of the recording format is unknown"),
        None => format!("`recording` must be the version of the format, found {}", node.kind_name()),
    };
    diagnostics.push(Diagnostic::error("E0602", node.span, message).help("write `recording: 1`"));
}

/// A line for people, as it was written: blanks in quotes are part of it, the end of the line of a block is not.
fn read_title(node: &Node, diagnostics: &mut Diagnostics) -> Option<String> {
    word(node, "`title`", diagnostics)?;
    node.text().map(|text| text.trim_matches('\n').to_owned())
}

fn read_instrument(node: &Node, diagnostics: &mut Diagnostics) -> Option<Spanned<Kind>> {
    let written = word(node, "`instrument`", diagnostics)?;
    let found = Kind::ALL.into_iter().find(|kind| kind.name() == written.value);
    if found.is_none() {
        let message = format!("unknown instrument `{}`", written.value);
        let mistake = Diagnostic::error("E0605", written.span, message);
        let names = Kind::ALL.map(Kind::name);
        diagnostics.push(near_or_all(mistake, &written.value, "instruments are", &names));
    }
    found.map(|kind| Spanned::new(kind, written.span))
}

/// The code for runs that cannot be held out.
pub(super) const HELD_OUT: &str = "E0620";

fn read_holdout(
    node: &Node,
    recording: &Fields<'_>,
    channels: &Channels,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Spanned<i64>>> {
    let wording = keys("`holdout`");
    let name = recording.key_span("holdout");
    let fields = Fields::open(node, name, wording, &["runs"], diagnostics)?;
    let runs = fields.need("runs", wording, diagnostics)?;
    let items = fields::list(runs, "`runs`", FORM, diagnostics)?;
    if !channels.names.iter().any(|name| name == "run") && !channels.known.iter().any(Channel::is_wide) {
        let message = "runs are held out, but no channel says which row belongs to which run";
        let mistake = Diagnostic::error("E0619", fields.key_span("runs"), message);
        let help =
            "add `run: {column: ...}` to `channels`, or leave `holdout` out to hold out blocks of time";
        diagnostics.push(mistake.help(help));
    }
    if items.is_empty() {
        let mistake = Diagnostic::error(HELD_OUT, runs.span, "`runs` names no run");
        diagnostics.push(mistake.help("write `runs: [3]`, or leave `holdout` out"));
        return None;
    }
    let mut runs: Vec<Spanned<i64>> = items.iter().filter_map(|item| read_run(item, diagnostics)).collect();
    runs.sort_by_key(|run| run.value);
    runs.dedup_by_key(|run| run.value);
    Some(runs)
}

fn read_run(node: &Node, diagnostics: &mut Diagnostics) -> Option<Spanned<i64>> {
    let number = node.text().and_then(|text| text.trim().parse().ok());
    if number.is_none() {
        let found = node.text().map_or_else(|| node.kind_name().to_owned(), |text| format!("`{text}`"));
        let message = format!("a run must be a whole number, found {found}");
        diagnostics.push(Diagnostic::error(HELD_OUT, node.span, message).help("write `runs: [3]`"));
    }
    number.map(|number| Spanned::new(number, node.span))
}

fn read_extra(node: &Node, diagnostics: &mut Diagnostics) -> Vec<Extra> {
    let Some(entries) = node.entries() else {
        let message = format!("`extra` must be a mapping of names to columns, found {}", node.kind_name());
        let mistake = Diagnostic::error(FORM, node.span, message);
        diagnostics
            .push(mistake.help("write one line such as `counter.x: {column: c, unit: mm}` for each column"));
        return Vec::new();
    };
    let extra = entries.iter().filter_map(|(name, node)| {
        let what = format!("`{}` of `extra`", name.value);
        let wording = keys(&what);
        let fields = Fields::open(node, name.span, wording, &["column", "unit"], diagnostics)?;
        if let Some(unit) = fields.get("unit") {
            quantity::read_unit(unit, &format!("the unit of {what}"), diagnostics);
        }
        let column = fields.need("column", wording, diagnostics)?;
        let column = word(column, &format!("`column` of {what}"), diagnostics)?;
        Some(Extra { name: name.clone(), column })
    });
    extra.collect()
}
