//! Plain tables (CSV). In: a header row, a row `#unit,...` where there is one, and a row for each reading. Out: runs of
//! readings over targets.

use std::collections::BTreeMap;

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::quantity::{Unit, parse_unit, unit_in_name};
use model_dsl::source::{SourceFile, Span, Spanned};
use model_dsl::suggest::nearest;
use recording::cells::{self, BELOW_THE_NAMES, numbers_of_units};

use super::super::measured::{Measured, Reading, Run, Sense};
use super::cell::{Piece, lines, shown};

/// Which columns of a table are meant.
#[derive(Clone, Debug, Default)]
pub struct Columns<'s> {
    /// The column of the targets; else `target`, `position` or one of `targets_like`.
    pub target: Option<&'s str>,
    /// The column of the deviations; else `deviation` or one of `deviations_like`.
    pub deviation: Option<&'s str>,
    /// Names by which the set-up knows the targets: the axis's letter.
    pub targets_like: Vec<String>,
    /// Names by which the set-up knows the deviations: the error motion.
    pub deviations_like: Vec<String>,
}

/// Where the columns stand.
struct Layout {
    separator: u8,
    width: usize,
    target: usize,
    deviation: usize,
    /// The units behind the names of these two, as in `x [mm]`.
    target_unit: Option<Spanned<Unit>>,
    deviation_unit: Option<Spanned<Unit>>,
    run: Option<usize>,
    direction: Option<usize>,
}

/// Reads the whole table.
pub(super) fn read(
    source: SourceFile,
    columns: &Columns<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Measured> {
    let mut rows = lines(source.text()).filter(|line| !line.text.trim().is_empty()).peekable();
    let told = rows.next_if(|line| cells::told_separator(line.text.as_bytes()).is_some());
    let told = told.and_then(|line| cells::told_separator(line.text.as_bytes()));
    let mut above = Vec::new();
    while let Some(comment) = rows.next_if(|line| is_comment(*line)) {
        above.push(comment);
    }
    let Some(header) = rows.next() else {
        diagnostics.push(no_readings(Span::default()));
        return None;
    };
    let layout = read_header(header, told, columns, diagnostics)?;
    if let Some(line) = above.into_iter().find(|line| layout.units(*line).is_some()) {
        diagnostics.push(units_above(line));
        return None;
    }
    let mut units = None;
    while let Some(comment) =
        rows.next_if(|line| units.is_none() && (is_comment(*line) || layout.units(*line).is_some()))
    {
        units = layout.units(comment).map(|cells| read_units(comment, &cells, &layout, diagnostics));
    }
    let [target, deviation] = match units {
        Some(units) => units?,
        None => [None, None],
    };
    let target_unit = one_unit(layout.target_unit, target, diagnostics);
    let deviation_unit = one_unit(layout.deviation_unit, deviation, diagnostics);
    let (target_unit, deviation_unit) = (target_unit?, deviation_unit?);
    let mut gathered = Gathered::default();
    for line in rows {
        if layout.units(line).is_some() {
            diagnostics.push(late_units(line));
            return None;
        }
        if !is_comment(line) {
            gathered.take(line, &layout, diagnostics)?;
        }
    }
    let (targets, runs) = gathered.finish(header.span, diagnostics)?;
    Some(Measured { targets, runs, target_unit, deviation_unit, flagged: None, about: Vec::new(), source })
}

fn is_comment(line: Piece<'_>) -> bool {
    line.text.starts_with('#')
}

impl Layout {
    /// The mark and the units of a row of units. `None` if the line is another one.
    fn units<'t>(&self, line: Piece<'t>) -> Option<Vec<Piece<'t>>> {
        line.units(self.separator, self.width)
    }
}

fn units_above(line: Piece<'_>) -> Diagnostic {
    let message = "the row of units stands above the names of the columns";
    Diagnostic::error("E0924", line.trimmed().span, message).help(BELOW_THE_NAMES)
}

fn late_units(line: Piece<'_>) -> Diagnostic {
    let message = "a row of units stands below rows of numbers";
    let help = "write it directly below the names of the columns, once, or remove it";
    Diagnostic::error("E0924", line.trimmed().span, message).help(help)
}

/// Reads the names of the columns; `told` is the separator that a line above them tells.
fn read_header(
    header: Piece<'_>,
    told: Option<u8>,
    columns: &Columns<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Layout> {
    let separates = |one: &u8| header.cells(*one).len() > 1;
    let separator = told.unwrap_or_else(|| [b';', b'\t'].into_iter().find(separates).unwrap_or(b','));
    let cells = header.cells(separator);
    let axis: Vec<&str> = columns.targets_like.iter().map(String::as_str).collect();
    let motion: Vec<&str> = columns.deviations_like.iter().map(String::as_str).collect();
    let target = [&["target", "position"], axis.as_slice()].concat();
    let deviation = [&["deviation"], motion.as_slice()].concat();
    let lower = axis.first().map(|letter| format!("dir_{}", letter.to_ascii_lowercase()));
    let direction: Vec<&str> = ["direction"].into_iter().chain(lower.as_deref()).collect();
    let mut find = |given: Option<&str>, usual: &[&str], what: &str| {
        let wanted = given.map_or_else(|| usual.to_vec(), |name| vec![name]);
        let found = places(&cells, &wanted, diagnostics)?;
        if found.is_empty() && !what.is_empty() {
            diagnostics.push(no_column(header, &cells, &wanted, what));
        }
        if let ([first, second, ..], false) = (found.as_slice(), what.is_empty()) {
            diagnostics.push(two_columns((cells.get(*first)?, cells.get(*second)?), what));
            return None;
        }
        Some(found.first().copied())
    };
    let target = find(columns.target, &target, "targets");
    let deviation = find(columns.deviation, &deviation, "deviations");
    let run = find(None, &["run"], "")?;
    let direction = find(None, &direction, "")?;
    let (target, deviation) = (target??, deviation??);
    let unit = |place: usize| cells.get(place).and_then(|cell| Some(with_unit(*cell)?.1));
    let (target_unit, deviation_unit) = (unit(target), unit(deviation));
    let width = cells.len();
    Some(Layout { separator, width, target, deviation, target_unit, deviation_unit, run, direction })
}

/// Splits `x [mm]` into the name of the column and its unit. `None` if the brackets hold no unit.
fn with_unit(cell: Piece<'_>) -> Option<(&str, Spanned<Unit>)> {
    let (name, unit) = unit_in_name(cell.text)?;
    Some((name, Spanned::new(parse_unit(unit).ok()?, cell.span)))
}

/// The unit that stands behind a name or below it; both may give the same (E0909).
fn one_unit(
    beside: Option<Spanned<Unit>>,
    below: Option<Spanned<Unit>>,
    diagnostics: &mut Diagnostics,
) -> Option<Option<Unit>> {
    if let (Some(beside), Some(below)) = (beside, below)
        && beside != below
    {
        let message = "the column has two units, one behind its name and another below it";
        let mistake = Diagnostic::error("E0909", below.span, message).also(beside.span, "the other unit");
        diagnostics.push(mistake.help("remove one of the two"));
        return None;
    }
    Some(beside.or(below).map(|unit| unit.value))
}

/// The columns of some names, letter case aside and also with a unit behind them, each once; nothing at all where two columns have one
/// name.
fn places(cells: &[Piece<'_>], wanted: &[&str], diagnostics: &mut Diagnostics) -> Option<Vec<usize>> {
    let mut found: Vec<usize> = Vec::new();
    for name in wanted {
        let exact = |cell: &Piece<'_>| cell.text.eq_ignore_ascii_case(name);
        let bare =
            |cell: &Piece<'_>| with_unit(*cell).is_some_and(|(bare, _)| bare.eq_ignore_ascii_case(name));
        let any = cells.iter().any(exact);
        let mut alike =
            cells.iter().enumerate().filter(|(_, cell)| if any { exact(cell) } else { bare(cell) });
        let first = alike.next();
        if let (Some((_, first)), Some((_, again))) = (first, alike.next()) {
            let message = format!("column `{}` occurs twice", shown(again.text));
            let mistake =
                Diagnostic::error("E0929", again.span, message).also(first.span, "the first of them");
            diagnostics.push(mistake.help("give each column its own name"));
            return None;
        }
        found.extend(first.map(|(place, _)| place).filter(|place| !found.contains(place)));
    }
    Some(found)
}

/// Two columns under usual names: nobody knows which of them is meant.
fn two_columns((first, second): (&Piece<'_>, &Piece<'_>), what: &str) -> Diagnostic {
    let (one, other) = (shown(first.text), shown(second.text));
    let message = format!("the {what} may be in column `{one}` or in column `{other}`");
    let mistake = Diagnostic::error("E0929", second.span, message).also(first.span, "the other one");
    let bare = with_unit(*first).map_or_else(|| one.clone(), |(bare, _)| shown(bare));
    mistake.help(format!("name the right one in the set-up, for example `{what}: {{column: {bare}}}`"))
}

fn no_readings(span: Span) -> Diagnostic {
    let mistake = Diagnostic::error("E0923", span, "the table has no readings");
    mistake.help("write a row of names, then one row for each reading")
}

fn no_column(header: Piece<'_>, cells: &[Piece<'_>], wanted: &[&str], what: &str) -> Diagnostic {
    let message = format!("the table has no column of {what}: `{}`", wanted.join("` or `"));
    let mistake = Diagnostic::error("E0929", header.trimmed().span, message);
    let near = wanted.iter().find_map(|name| nearest(name, cells.iter().map(|cell| cell.text)));
    match near {
        Some(near) => {
            mistake.help(format!("if it is `{}`, rename that column, or name it in the set-up", shown(near)))
        }
        None => {
            let names: Vec<String> = cells.iter().map(|cell| format!("`{}`", shown(cell.text))).collect();
            mistake.help(format!(
                "begin with a row of names, or name the column in the set-up, `{what}: {{column: ...}}`; the columns are {}",
                names.join(", ")
            ))
        }
    }
}

/// The units of targets and deviations, in a row `#unit,` with one cell more than the header.
fn read_units(
    line: Piece<'_>,
    cells: &[Piece<'_>],
    layout: &Layout,
    diagnostics: &mut Diagnostics,
) -> Option<[Option<Spanned<Unit>>; 2]> {
    if cells.len() != layout.width + 1 {
        let counted = numbers_of_units(cells.len().saturating_sub(1), layout.width);
        let message = format!("the row of units has {counted}");
        let help = "write `#unit` and then one unit for each column, empty if it has none";
        diagnostics.push(Diagnostic::error("E0924", line.trimmed().span, message).help(help));
        return None;
    }
    let mut unit = |place: usize| match cells.get(place + 1).filter(|cell| !cell.text.is_empty()) {
        None => Some(None),
        Some(cell) => match parse_unit(cell.text) {
            Ok(unit) => Some(Some(Spanned::new(unit, cell.span))),
            Err(error) => {
                diagnostics.push(error.diagnostic(cell.span));
                None
            }
        },
    };
    let (target, deviation) = (unit(layout.target), unit(layout.deviation));
    Some([target?, deviation?])
}

/// Rows gathered to runs.
#[derive(Default)]
struct Gathered {
    targets: Vec<f64>,
    /// The index of each target, by its bits.
    places: BTreeMap<u64, usize>,
    runs: Vec<Run>,
    numbers: BTreeMap<(u32, Option<bool>), usize>,
    seen: BTreeMap<(usize, usize), Span>,
}

impl Gathered {
    fn take(&mut self, line: Piece<'_>, layout: &Layout, diagnostics: &mut Diagnostics) -> Option<()> {
        let cells = line.cells(layout.separator);
        if cells.len() != layout.width {
            let counted = cells::counted(cells.len(), "cell");
            let message = format!("the row has {counted}, but the header has {}", layout.width);
            let help = "write one cell for each column, empty if nothing was measured; a decimal comma splits a number into two cells";
            diagnostics.push(Diagnostic::error("E0924", line.trimmed().span, message).help(help));
            return None;
        }
        let at = |place: Option<usize>| place.and_then(|place| cells.get(place));
        let number = match at(layout.run) {
            Some(cell) => cell.ordinal("the run", diagnostics)?,
            None => 1,
        };
        let told = match at(layout.direction) {
            Some(cell) => Some(read_sense(*cell, diagnostics)?),
            None => None,
        };
        let target = at(Some(layout.target))?.number("the target", diagnostics)?;
        let deviation = at(Some(layout.deviation))?;
        let missing = deviation.text.is_empty()
            || ["nan", "null"].iter().any(|word| deviation.text.eq_ignore_ascii_case(word));
        // A place that was not read is a place all the same.
        let index = self.target(target);
        if missing {
            return Some(());
        }
        let empty = "write a number such as `-0.5` or `1e-3`; leave the cell empty if nothing was measured";
        let deviation = deviation.number_or("the deviation", empty, diagnostics)?;
        self.add(number, told, Reading { target: index, deviation }, line.trimmed().span, diagnostics)
    }

    fn target(&mut self, target: f64) -> usize {
        // Zero has two signs and is one place.
        let target = if target == 0.0 { 0.0 } else { target };
        let next = self.targets.len();
        let index = *self.places.entry(target.to_bits()).or_insert(next);
        if index == next {
            self.targets.push(target);
        }
        index
    }

    fn add(
        &mut self,
        number: u32,
        told: Option<Sense>,
        reading: Reading,
        span: Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<()> {
        let key = (number, told.map(|sense| sense == Sense::Ascending));
        let next = self.runs.len();
        let place = *self.numbers.entry(key).or_insert(next);
        if place == next {
            self.runs.push(Run { number, told, readings: Vec::new(), span });
        }
        if let Some(first) = self.seen.insert((place, reading.target), span) {
            let message = format!("run {number} has a second reading at this target");
            let mistake = Diagnostic::error("E0927", span, message).also(first, "the first of them");
            let help = "number the repeats in a column `run`; if one run goes both ways, give the direction in a column `direction`";
            diagnostics.push(mistake.help(help));
            return None;
        }
        self.runs.get_mut(place)?.readings.push(reading);
        Some(())
    }

    fn finish(self, header: Span, diagnostics: &mut Diagnostics) -> Option<(Vec<f64>, Vec<Run>)> {
        if self.runs.is_empty() {
            diagnostics.push(no_readings(header));
            return None;
        }
        for run in self.runs.iter().filter(|run| run.readings.len() < self.targets.len()) {
            let message =
                format!("run {} has {} of {} readings", run.number, run.readings.len(), self.targets.len());
            let help = "measure the run again if it matters; its missing targets have fewer readings";
            diagnostics.push(Diagnostic::warning("W0901", run.span, message).help(help));
        }
        Some((self.targets, self.runs))
    }
}

/// `+1`, `1`, `+` while the targets ascend, `-1`, `-` while they descend.
fn read_sense(cell: Piece<'_>, diagnostics: &mut Diagnostics) -> Option<Sense> {
    match cell.text {
        "1" | "+1" | "+" | "1.0" => Some(Sense::Ascending),
        "-1" | "-" | "-1.0" => Some(Sense::Descending),
        other => {
            let message = format!("a direction must be +1 or -1, found `{}`", shown(other));
            let help = "write +1 if the targets ascend, -1 if they descend";
            diagnostics.push(Diagnostic::error("E0926", cell.span, message).help(help));
            None
        }
    }
}
