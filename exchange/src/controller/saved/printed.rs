//! Meshes as Marlin prints them (`M420 V`, `G29 T`, the end of `G29`). In: a captured answer. Out: rows of heights, the least Y first.
//!
//! Facts: Marlin, `print_2d_array` (bilinear and mesh levelling): rows with their number before them, from 0 at the least Y on;
//! `unified_bed_leveling::display_map`: rows from the greatest Y down, with their number and a bar before them, or as a table
//! without. A number tells where a row is in either of them.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::SourceFile;

use crate::controller::lines::{Line, lines};

/// What stands above a mesh.
const HEADS: [&str; 4] =
    ["Bilinear Leveling Grid", "Bed Topography Report", "Mesh Bed Level data", "Measured points"];

/// The form of a mesh, for findings.
const FORM: &str =
    "write the rows of a printed mesh such as ` 0 +0.080 -0.040 -0.115`, with the number of the row first";

/// Whether a text has such a mesh.
pub(super) fn is_here(text: &str) -> bool {
    text.lines().any(is_head)
}

fn is_head(line: &str) -> bool {
    HEADS.iter().any(|head| line.contains(head))
}

/// The rows of the mesh, the least Y first.
pub(super) fn rows(source: &SourceFile, diagnostics: &mut Diagnostics) -> Option<Vec<Vec<f64>>> {
    let all: Vec<Line<'_>> = lines(source, ";").collect();
    let heads: Vec<usize> =
        all.iter().enumerate().filter(|(_, line)| is_head(line.text)).map(|(number, _)| number).collect();
    let (first, more) = heads.split_first()?;
    if let Some(second) = more.first().and_then(|second| all.get(*second)) {
        let message = "a second mesh begins here";
        diagnostics.push(Diagnostic::error("E0803", second.span, message).help("keep one of the two"));
        return None;
    }
    let mut rows: Vec<Row<'_>> = Vec::new();
    for line in all.get(first + 1..).unwrap_or_default() {
        match Row::of(*line) {
            Some(row) => rows.push(row),
            // What follows the mesh has no place in it.
            None if !rows.is_empty()
                && !line.text.trim_end_matches('|').trim().is_empty()
                && !is_between(line.text) =>
            {
                break;
            }
            None => {}
        }
    }
    ordered(rows, all.get(*first).copied(), diagnostics)
}

/// Whether a line stands between the rows of a mesh: a bar, with what a terminal puts before it.
fn is_between(line: &str) -> bool {
    line.split_whitespace().last() == Some("|") || line.ends_with(':')
}

/// A row of a printed mesh.
struct Row<'s> {
    line: Line<'s>,
    number: Option<usize>,
    heights: Vec<Line<'s>>,
}

impl<'s> Row<'s> {
    /// The row that a line is: heights with a decimal point, at most a whole number before them.
    fn of(line: Line<'s>) -> Option<Self> {
        let separates = |letter: char| letter.is_whitespace() || "|[],".contains(letter);
        let words = line.text.split(separates).filter(|word| !word.is_empty() && !word.ends_with(':'));
        let words: Vec<Line<'s>> = words.map(|word| line.part(word)).collect();
        let number = words.first().and_then(|word| word.text.parse().ok());
        let heights = words.get(usize::from(number.is_some())..)?.to_vec();
        let is_height = |word: &Line<'_>| {
            word.text.contains('.') && word.text.parse::<f64>().is_ok() || is_missing(word.text)
        };
        (heights.len() > 1 && heights.iter().all(is_height)).then_some(Self { line, number, heights })
    }
}

/// What Marlin prints for a point that was not probed.
fn is_missing(word: &str) -> bool {
    word == "."
        || word == "NAN"
        || word == "nan"
        || (word.len() > 1 && word.bytes().all(|letter| letter == b'='))
}

fn ordered(
    rows: Vec<Row<'_>>,
    head: Option<Line<'_>>,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Vec<f64>>> {
    let mut refuse = |line: Option<Line<'_>>, code, message: &str, help: &str| {
        let span = line.map(|line| line.span).unwrap_or_default();
        diagnostics.push(Diagnostic::error(code, span, message).help(help));
        None
    };
    let downwards = head.is_some_and(|head| head.text.contains("Bed Topography Report"));
    let mut slots: Vec<Option<Vec<f64>>> = vec![None; rows.len()];
    for (place, row) in rows.iter().enumerate() {
        let number = match row.number {
            Some(number) => number,
            None if downwards => rows.len() - 1 - place,
            None => return refuse(Some(row.line), "E0802", "this row has no number", FORM),
        };
        if let Some(missing) = row.heights.iter().find(|height| is_missing(height.text)) {
            let help = "fill the mesh on the printer first with G29 P3, or probe again";
            return refuse(Some(*missing), "E0801", "this point was not probed", help);
        }
        let heights = row.heights.iter().map(|height| height.text.parse().ok()).collect::<Option<Vec<f64>>>();
        match slots.get_mut(number) {
            Some(slot) if slot.is_none() => *slot = heights,
            _ => {
                return refuse(
                    Some(row.line),
                    "E0803",
                    "this row occurs twice, or rows before it are missing",
                    FORM,
                );
            }
        }
    }
    match slots.into_iter().collect::<Option<Vec<_>>>().filter(|rows| rows.len() > 1) {
        Some(rows) => Some(rows),
        None => refuse(head, "E0802", "fewer than two rows of heights follow", FORM),
    }
}
