//! Archives of a SINUMERIK, read. In: text. Out: tables, checked: every point there, and steps that reach from end to end.

use std::collections::BTreeMap;

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::{SourceFile, Span};

use super::super::even::Even;
use super::super::lines::{Line, lines};
use super::control::{Cross, Sinumerik};

/// The form of a line, for findings.
const FORM: &str = "a line is such as `$AA_ENC_COMP[0,3,X1]=0.012` or `$AN_CEC_STEP[0]=8.0`";

/// A turn of a rotary axis, after which a table of it repeats: deg.
const TURN: f64 = 360.0;

/// The most points of a table that are read.
const MOST: usize = 100_000;

/// What stands in an archive about one table.
#[derive(Default)]
struct Raw<'s> {
    place: Option<Span>,
    points: BTreeMap<usize, f64>,
    entries: BTreeMap<String, Line<'s>>,
}

/// Which table: of a screw by its axis's name, or a cross table by its index.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Screw(String),
    Cross(usize),
}

/// Reads an archive into the control.
pub(super) fn load(control: &mut Sinumerik, source: &SourceFile, diagnostics: &mut Diagnostics) {
    let mut tables: BTreeMap<Key, Raw<'_>> = BTreeMap::new();
    for line in lines(source, ";") {
        if is_frame(line.text) {
            continue;
        }
        if take(&mut tables, line, diagnostics).is_none() {
            line.malformed(FORM, diagnostics);
        }
    }
    for (key, raw) in tables {
        match key {
            Key::Screw(name) => {
                let axis = axis(control, &name, raw.place, diagnostics);
                let curve = raw.curve(diagnostics);
                control.screws.extend(axis.zip(curve));
            }
            Key::Cross(index) => {
                let cross = cross(control, &raw, diagnostics);
                control.crosses.extend(cross.map(|cross| (index, cross)));
            }
        }
    }
}

/// Lines that frame an archive and say nothing of a table.
fn is_frame(text: &str) -> bool {
    text.starts_with('%') || text.starts_with("CHANDATA") || matches!(text, "M0" | "M17" | "M30" | "NEWCONF")
}

/// Takes one assignment; nothing where it has another form.
fn take<'s>(
    tables: &mut BTreeMap<Key, Raw<'s>>,
    line: Line<'s>,
    diagnostics: &mut Diagnostics,
) -> Option<()> {
    let (left, right) = line.text.split_once('=')?;
    let (name, indices) = left.trim().strip_suffix(']')?.split_once('[')?;
    let indices: Vec<&str> = indices.split(',').map(str::trim).collect();
    let value = right.trim().trim_start_matches('(').trim_end_matches(')').trim();
    let start = line.span.start + (value.as_ptr().addr() - line.text.as_ptr().addr());
    let value = Line { text: value, span: Span::new(start, start + value.len()) };
    let (key, point, entry) = match (name, indices.as_slice()) {
        ("$AA_ENC_COMP", ["0", point, axis]) => (Key::Screw((*axis).to_owned()), Some(*point), ""),
        ("$AN_CEC", [table, point]) => (Key::Cross(table.parse().ok()?), Some(*point), ""),
        (name, ["0", axis]) => (Key::Screw((*axis).to_owned()), None, name.strip_prefix("$AA_ENC_COMP_")?),
        (name, [table]) => (Key::Cross(table.parse().ok()?), None, name.strip_prefix("$AN_CEC_")?),
        _ => return None,
    };
    let raw = tables.entry(key).or_default();
    raw.place.get_or_insert(line.span);
    match point {
        Some(point) => {
            let point: usize = point.parse().ok().filter(|point| *point < MOST)?;
            raw.points.extend(value.number(diagnostics).map(|value| (point, value)));
        }
        None => _ = raw.entries.insert(entry.to_owned(), value),
    }
    Some(())
}

impl Raw<'_> {
    /// The points, at the steps that the archive says.
    fn curve(&self, diagnostics: &mut Diagnostics) -> Option<Even> {
        let [step, first, last] = ["STEP", "MIN", "MAX"].map(|key| self.number(key, diagnostics));
        let (step, first, last) = (step?, first?, last?);
        let points = self.points.len();
        let intervals = f64::from(u32::try_from(points.checked_sub(1)?).ok()?);
        let all = self.points.keys().copied().eq(0..points);
        let whole = (step * intervals - (last - first)).abs() <= 1e-6 * intervals.max(1.0);
        let modulo = self.entries.get("IS_MODULO").is_some_and(|value| value.text != "0");
        let turns = !modulo || (last - first - TURN).abs() < 1e-6;
        if all && whole && turns && step > 0.0 && points > 1 {
            let values = self.points.values().copied().collect();
            return Some(Even { first, step, values, repeats: modulo });
        }
        let what = if turns {
            format!("{points} points at steps of {step} do not reach from {first} to {last}")
        } else {
            format!("a table that repeats (IS_MODULO) covers {TURN} deg, not from {first} to {last}")
        };
        let help =
            "number the points from 0 without gaps; STEP times their number minus one must be MAX - MIN";
        diagnostics.push(Diagnostic::error("E0803", self.place.unwrap_or_default(), what).help(help));
        None
    }

    fn number(&self, key: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
        self.entry(key, diagnostics)?.number(diagnostics)
    }

    fn entry(&self, key: &str, diagnostics: &mut Diagnostics) -> Option<Line<'_>> {
        let entry = self.entries.get(key).copied();
        if entry.is_none() {
            let message = format!("the table has no {key}");
            diagnostics.push(Diagnostic::error("E0803", self.place.unwrap_or_default(), message).help(FORM));
        }
        entry
    }
}

fn cross(control: &Sinumerik, raw: &Raw<'_>, diagnostics: &mut Diagnostics) -> Option<Cross> {
    let curve = raw.curve(diagnostics);
    let [input, output] = ["INPUT_AXIS", "OUTPUT_AXIS"].map(|key| {
        let entry = raw.entry(key, diagnostics)?;
        axis(control, entry.text, Some(entry.span), diagnostics)
    });
    let whole = |key: &str, diagnostics: &mut Diagnostics| match raw.entries.get(key) {
        None => Some(0),
        Some(entry) => {
            let number = entry.text.parse::<i64>().ok();
            if number.is_none() {
                entry.malformed("write a whole number", diagnostics);
            }
            number
        }
    };
    let direction = whole("DIRECTION", diagnostics)?;
    let by = whole("MULT_BY_TABLE", diagnostics)?;
    // A table's number is its index and one; 0 is none.
    let by = usize::try_from(by).ok().and_then(|number| number.checked_sub(1));
    let direction = i8::try_from(direction.signum()).unwrap_or_default();
    Some(Cross { input: input?, output: output?, curve: curve?, direction, by })
}

fn axis(
    control: &Sinumerik,
    name: &str,
    place: Option<Span>,
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    let axis = control.names.iter().position(|known| known == name);
    if axis.is_none() {
        let message = format!("the machine has no axis `{name}`");
        let help = format!(
            "its axes are {}; to give an axis this name, use --name X={name}",
            control.names.join(", ")
        );
        diagnostics.push(Diagnostic::error("E0804", place.unwrap_or_default(), message).help(help));
    }
    axis
}
