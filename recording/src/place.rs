//! Where the numbers of a channel stand, and what one of them is.
//!
//! In: the keys of a channel. Out: a [`ChannelPlace`], and a unit with its multiple; or findings E0604, E0629.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::fields::{self, Fields};
use model_dsl::quantity::{self, Dimension, Unit};
use model_dsl::source::Spanned;
use model_dsl::yaml::Node;

use super::channel::{Channel, ChannelKind, ChannelPlace};
use super::words::{FORM, keys, word};

/// What stands for the unit of times that are dates.
pub(super) const DATE: &str = "date";

/// The unit of a time that was a date.
pub(super) const SECOND: Unit = Unit { factor: 1.0, offset: 0.0, dimension: Dimension::TIME };

/// The code for places that do not go together.
const APART: &str = "E0629";

/// Whether a unit says that times are dates.
pub(super) fn is_date(unit: &str) -> bool {
    unit.trim() == DATE
}

/// Reads `column`, or `columns` and `back`.
pub(super) fn read_place(
    name: &Spanned<String>,
    fields: &Fields<'_>,
    dates: bool,
    diagnostics: &mut Diagnostics,
) -> Option<ChannelPlace> {
    let what = format!("`{}`", name.value);
    if let Some((key, node)) = fields.entry("columns") {
        if let Some((other, _)) = fields.entry("column") {
            let message = format!("{what} has both a `column` and `columns`");
            let mistake =
                Diagnostic::error(APART, other.span, message).also(key.span, "one column for each run here");
            diagnostics.push(mistake.help("leave one of them out"));
        }
        let columns = read_names(node, &format!("`columns` of {what}"), diagnostics)?;
        let back = match fields.get("back") {
            Some(back) => read_names(back, &format!("`back` of {what}"), diagnostics)?,
            None => Vec::new(),
        };
        if !back.is_empty() && back.len() != columns.len() {
            let (there, again) = (columns.len(), back.len());
            let message = format!("{what} has {there} columns, but {again} for the way back");
            let mistake = Diagnostic::error(APART, fields.key_span("back"), message);
            diagnostics.push(mistake.help("give each run one column in `columns` and one in `back`"));
            return None;
        }
        return Some(ChannelPlace::Runs { columns, back });
    }
    if let Some((key, _)) = fields.entry("back") {
        let mistake = Diagnostic::error(APART, key.span, format!("{what} has `back` but no `columns`"));
        diagnostics.push(mistake.help("write `columns: [run 1, run 2], back: [run 1 back, run 2 back]`"));
    }
    let node = fields.need("column", keys(&what), diagnostics)?;
    let named = format!("`column` of {what}");
    if dates && let Some(items) = node.items() {
        let columns = read_names(node, &named, diagnostics)?;
        if items.len() != 2 {
            let message = format!("a date and a time of day must be in two columns, found {}", items.len());
            let help = "write `column: [date, time]`, or the one column that contains both";
            diagnostics.push(Diagnostic::error(FORM, node.span, message).help(help));
            return None;
        }
        return Some(ChannelPlace::Dates(columns));
    }
    let column = word(node, &named, diagnostics)?;
    Some(if dates { ChannelPlace::Dates(vec![column]) } else { ChannelPlace::Column(column) })
}

/// A list of names, at least one.
fn read_names(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<Vec<Spanned<String>>> {
    let items = fields::list(node, what, FORM, diagnostics)?;
    if items.is_empty() {
        let mistake = Diagnostic::error(FORM, node.span, format!("{what} names no column"));
        diagnostics.push(mistake.help("write the names of the columns, `[run 1, run 2]`"));
        return None;
    }
    let names: Vec<_> = items.iter().filter_map(|item| word(item, "a column", diagnostics)).collect();
    (names.len() == items.len()).then_some(names)
}

/// Reads times that no column tells: `every: 1 ms`.
pub(super) fn read_every(
    name: &Spanned<String>,
    kind: ChannelKind,
    fields: &Fields<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Channel> {
    let (key, node) = fields.entry("every")?;
    let other = ["column", "columns", "unit"].into_iter().find_map(|key| fields.entry(key));
    if let Some((other, _)) = other {
        let message = "time has both `every` and a column";
        let mistake =
            Diagnostic::error(APART, other.span, message).also(key.span, "the time from row to row");
        diagnostics
            .push(mistake.help("leave one of them out; give `every` its own unit, as in `every: 1 ms`"));
        return None;
    }
    let every = quantity::read(node, Dimension::TIME, "`every`", diagnostics)?;
    if every.value <= 0.0 {
        let mistake = Diagnostic::error(APART, every.span, "`every` must be greater than zero");
        diagnostics.push(mistake.help("write the time the time from row to row, `every: 1 ms`"));
        return None;
    }
    let unit = Some(Spanned::new(SECOND, node.span));
    let (place, scale) = (ChannelPlace::Every, every.value);
    Some(Channel { name: name.clone(), kind, place, unit, scale, written_unit: "s".to_owned() })
}

/// A unit and how many of it a number in the column is: `mm`, or `0.1 um` for the counts of an encoder.
pub(super) fn scaled_unit(
    node: &Node,
    name: &Spanned<String>,
    diagnostics: &mut Diagnostics,
) -> Option<(Spanned<Unit>, f64)> {
    let what = format!("the unit of `{}`", name.value);
    let text = node.text().unwrap_or_default();
    let scaled = quantity::parse_quantity(text).ok().filter(|quantity| !quantity.is_bare());
    let Some(scaled) = scaled else {
        if is_date(text) {
            let message = format!("`{}` is not a time, but `date` is a form of time", name.value);
            let mistake = Diagnostic::error("E0609", node.span, message);
            diagnostics.push(mistake.help("write the unit of the numbers in the column"));
            return None;
        }
        return quantity::read_unit(node, &what, diagnostics).map(|unit| (unit, 1.0));
    };
    let number = quantity::parse_number(scaled.written_number()).ok()?;
    let unit = quantity::parse_unit(scaled.written_unit()).ok()?;
    // Not `<=`: zero is not the size of a count, nor is what lies below all numbers.
    if number <= 0.0 {
        let message = format!("{what} must be greater than zero");
        let mistake = Diagnostic::error(APART, node.span, message);
        diagnostics.push(mistake.help("write the size of one count, such as `0.1 um`"));
        return None;
    }
    Some((Spanned::new(unit, node.span), number))
}

/// Reports channels with a column for each run that do not go together with the others (E0629).
pub(super) fn check_runs(channels: &[Channel], diagnostics: &mut Diagnostics) {
    let mut wide = channels.iter().filter(|channel| channel.is_wide());
    let Some(first) = wide.next() else { return };
    let runs = |channel: &Channel| match &channel.place {
        ChannelPlace::Runs { columns, back } => (columns.len(), back.len()),
        _ => (0, 0),
    };
    for channel in wide.filter(|channel| runs(channel) != runs(first)) {
        let message = format!("`{}` and `{}` have different runs", channel.name.value, first.name.value);
        let mistake =
            Diagnostic::error(APART, channel.name.span, message).also(first.name.span, "these runs");
        diagnostics.push(mistake.help("give both one column for each run here, and a way back or none"));
    }
    for channel in channels {
        let (message, help) = match (&channel.kind, &channel.place) {
            (ChannelKind::Run, _) => (
                "the columns are the runs, so a channel `run` is not allowed",
                "leave the channel `run` out; the first of `columns` is run 1",
            ),
            (ChannelKind::Time, ChannelPlace::Every) => continue,
            (ChannelKind::Time, _) => (
                "every run reads each row, so a column of times cannot apply to all of them",
                "write the time from row to row, such as `time: {every: 10 s}`",
            ),
            _ => continue,
        };
        let mistake = Diagnostic::error(APART, channel.name.span, message)
            .also(first.name.span, "one column for each run here");
        diagnostics.push(mistake.help(help));
    }
}
