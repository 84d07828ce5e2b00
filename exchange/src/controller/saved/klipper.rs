//! Klipper's configuration (`printer.cfg`). In: its sections `[bed_mesh NAME]` and `[skew_correction NAME]`, as `SAVE_CONFIG` writes
//! them behind `#*#` or as anybody includes them. Out: the mesh and the skew.
//!
//! Facts: Klipper, `klippy/extras/bed_mesh.py`: the rows of `points` go from `min_y` to `max_y`, each from `min_x` to `max_x`, and
//! `z' = z + height`; profiles before version 1 have the probe's place besides, `x_offset` and `y_offset`, which is added to
//! both ends. `skew_correction.py`: see [`Skew::of_factors`].
//!
//! Klipper puts points between the measured ones by Lagrange's polynomials or bicubically (`mesh_x_pps`, `algo`) and interpolates
//! bilinearly between those; here the measured points alone count. `fade_start` and `fade_end` are no part of the machine.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::SourceFile;

use super::choice::one_of;
use super::mesh::{Mesh, spread};
use super::skew::Skew;
use super::{Saved, SavedWanted};
use crate::controller::lines::Line;

/// What stands before each line that `SAVE_CONFIG` writes.
const SAVED: &str = "#*#";

/// The form of a mesh, for findings.
const FORM: &str = "a saved mesh has `min_x`, `max_x`, `min_y`, `max_y`, `x_count`, `y_count` and `points`, a row of heights on each line";

/// The form of a skew, for findings.
const SKEW_FORM: &str = "a saved skew has `xy_skew`, `xz_skew` and `yz_skew`";

/// Whether a text has such a section.
pub(super) fn is_here(text: &str) -> bool {
    text.lines().any(|line| {
        let line = line.strip_prefix(SAVED).unwrap_or(line).trim_start();
        line.starts_with("[bed_mesh ") || line.starts_with("[skew_correction ")
    })
}

/// Reads the mesh and the skew that are asked for.
pub(super) fn read(source: &SourceFile, wanted: &SavedWanted, diagnostics: &mut Diagnostics) -> Saved {
    let sections = sections(source);
    let of_kind = |kind: &str| -> Vec<(Line<'_>, &Section<'_>)> {
        let named = sections.iter().filter_map(|section| {
            let name = section.name.text.strip_prefix(kind)?.strip_prefix(' ')?.trim();
            Some((section.name.part(name), section))
        });
        named.collect()
    };
    let (meshes, skews) = (of_kind("bed_mesh"), of_kind("skew_correction"));
    let mesh = one_of(&meshes, wanted.mesh.as_deref(), ("mesh", "mesh"), diagnostics);
    let skew = one_of(&skews, wanted.skew.as_deref(), ("skew", "skew"), diagnostics);
    Saved {
        mesh: mesh.and_then(|section| mesh_of(section, diagnostics)),
        skew: skew.and_then(|section| skew_of(section, diagnostics)),
        screw: None,
    }
}

/// A section: its name and its entries, each with the lines of its value.
struct Section<'s> {
    name: Line<'s>,
    entries: Vec<(&'s str, Vec<Line<'s>>)>,
}

impl<'s> Section<'s> {
    fn lines(&self, key: &str) -> Option<&[Line<'s>]> {
        self.entries.iter().find(|(name, _)| *name == key).map(|(_, lines)| lines.as_slice())
    }

    /// The number of a key that may be left out.
    fn perhaps(&self, key: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
        self.lines(key)?.first()?.number(diagnostics)
    }

    fn number(&self, key: &str, form: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
        if self.lines(key).is_none_or(<[_]>::is_empty) {
            let message = format!("[{}] has no `{key}`", self.name.text);
            diagnostics.push(Diagnostic::error("E0802", self.name.span, message).help(form));
        }
        self.perhaps(key, diagnostics)
    }
}

fn sections(source: &SourceFile) -> Vec<Section<'_>> {
    let mut sections: Vec<Section<'_>> = Vec::new();
    for line in source.text().lines() {
        let line = match line.strip_prefix(SAVED) {
            Some(saved) => saved.strip_prefix(' ').unwrap_or(saved),
            None => line.split(['#', ';']).next().unwrap_or_default(),
        };
        let told = Line::of(source.text(), line.trim());
        if let Some(name) = told.text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            sections.push(Section { name: told.part(name.trim()), entries: Vec::new() });
        } else if let Some(section) = sections.last_mut().filter(|_| !told.text.is_empty()) {
            // A line that is indented, or that begins with a number, goes on with the value above it.
            let goes_on =
                line.starts_with(char::is_whitespace) || !told.text.starts_with(char::is_alphabetic);
            match (section.entries.last_mut(), told.text.split_once(['=', ':'])) {
                (Some((_, lines)), _) if goes_on => lines.push(told),
                (_, Some((key, value))) => {
                    let value = told.part(value.trim());
                    let lines = if value.text.is_empty() { Vec::new() } else { vec![value] };
                    section.entries.push((key.trim(), lines));
                }
                _ => {}
            }
        }
    }
    sections
}

fn mesh_of(section: &Section<'_>, diagnostics: &mut Diagnostics) -> Option<Mesh> {
    let mut end = |key: &str| section.number(key, FORM, diagnostics);
    let ends = [end("min_x"), end("max_x"), end("min_y"), end("max_y"), end("x_count"), end("y_count")];
    let mut offset = |key: &str| section.perhaps(key, diagnostics).unwrap_or(0.0);
    let (x_offset, y_offset) = (offset("x_offset"), offset("y_offset"));
    let [min_x, max_x, min_y, max_y, x_count, y_count] = ends;
    let rows = section.lines("points").unwrap_or_default();
    let mut heights = Vec::new();
    for row in rows {
        let cells = row.cells(',').filter(|cell| !cell.text.is_empty());
        let numbers = cells.map(|cell| cell.number(diagnostics)).collect::<Option<Vec<f64>>>()?;
        if Some(numbers.len()) != x_count.and_then(whole) {
            let message =
                format!("this row has {} heights, but `x_count` is a different number", numbers.len());
            diagnostics.push(Diagnostic::error("E0803", row.span, message).help(FORM));
            return None;
        }
        heights.extend(numbers);
    }
    let (columns, count) = (whole(x_count?)?, whole(y_count?)?);
    let along = spread([min_x? + x_offset, max_x? + x_offset], columns);
    let across = spread([min_y? + y_offset, max_y? + y_offset], count);
    let mesh = (rows.len() == count).then(|| Mesh::new(['X', 'Y'], [along, across], heights)).flatten();
    if mesh.is_none() {
        let message = format!(
            "the {} rows of [{}] do not match `y_count`, or its ends do not rise",
            rows.len(),
            section.name.text
        );
        diagnostics.push(Diagnostic::error("E0803", section.name.span, message).help(FORM));
    }
    mesh
}

/// A count that a file tells: a few hundred at most.
fn whole(number: f64) -> Option<usize> {
    (0..=1_000_u16).find(|count| f64::from(*count) == number).map(usize::from)
}

fn skew_of(section: &Section<'_>, diagnostics: &mut Diagnostics) -> Option<Skew> {
    let mut factor = |key: &str| section.number(key, SKEW_FORM, diagnostics);
    let [xy, xz, yz] = [factor("xy_skew"), factor("xz_skew"), factor("yz_skew")];
    Some(Skew::of_factors([xy?, xz?, yz?]))
}
