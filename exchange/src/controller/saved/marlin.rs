//! What Marlin and RepRapFirmware are told by commands, and meshes that Marlin prints. In: a file of commands, or what a terminal
//! captured (`M503`, `M420 V`). Out: the skew and the mesh.
//!
//! Facts: Marlin, `M852.cpp` (I or S is XY, J is XZ, K is YZ) and `planner.h`, `M421.cpp` and what `M503` answers
//! (`G29 W I J Z`): I counts the columns in X, J the rows in Y, and `z' = z + Z`. Where the points lie is compiled into the firmware:
//! the user says it. RepRapFirmware, `GCodes2.cpp`, case 556: X, Y, Z over S, 10 at least, are the tangents of XY, YZ, XZ; see
//! [`Skew::of_tangents`]. A later command takes the place of an earlier one, letter by letter.

use std::collections::BTreeMap;

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::{SourceFile, Span};

use super::codes::{Command, commands, is_mesh_point};
use super::mesh::{Mesh, spread};
use super::skew::Skew;
use super::{Saved, SavedWanted, printed};
use crate::controller::lines::Line;

/// The least height over which RepRapFirmware takes a deviation, mm.
const LEAST_HEIGHT: f64 = 10.0;

/// The form of a mesh point, for findings.
const FORM: &str = "a point of a mesh is `M421 I0 J0 Z0.08`, or `G29 W I0 J0 Z0.08`";

/// Reads all commands that are known, and the printed mesh.
pub(super) fn read(source: &SourceFile, wanted: &SavedWanted, diagnostics: &mut Diagnostics) -> Saved {
    let (mut factors, mut tangents) = (Factors::default(), Tangents::default());
    let mut points = Points::default();
    for command in commands(source) {
        match command.code {
            "M852" => factors.take(&command, diagnostics),
            "M556" => tangents.take(&command, diagnostics),
            "M421" => points.take(&command, diagnostics),
            _ if is_mesh_point(&command) => points.take(&command, diagnostics),
            _ => {}
        }
    }
    let skew = match (factors.first, tangents.first) {
        (Some(one), Some(other)) => {
            let message = "M852 and M556 are commands of two firmwares";
            let mistake = Diagnostic::error("E0803", other, message).also(one, "the other is here");
            diagnostics.push(mistake.help("keep only those of one printer"));
            None
        }
        (Some(_), None) => Some(Skew::of_factors(factors.values)),
        (None, Some(_)) => Some(Skew::of_tangents(tangents.values, tangents.to_y)),
        (None, None) => None,
    };
    Saved { skew, mesh: mesh(source, points, wanted, diagnostics), screw: None }
}

/// The skew factors of `M852`, and where the first command stands.
#[derive(Default)]
struct Factors {
    first: Option<Span>,
    values: [f64; 3],
}

impl Factors {
    fn take(&mut self, command: &Command<'_>, diagnostics: &mut Diagnostics) {
        for (letter, number) in [('S', 0), ('I', 0), ('J', 1), ('K', 2)] {
            let factor = command.after(letter).and_then(|line| line.number(diagnostics));
            if let (Some(factor), Some(slot)) = (factor, self.values.get_mut(number)) {
                *slot = factor;
                self.first.get_or_insert(command.line.span);
            }
        }
    }
}

/// The tangents of `M556`, and where the first command stands.
#[derive(Default)]
struct Tangents {
    first: Option<Span>,
    values: [f64; 3],
    to_y: bool,
}

impl Tangents {
    fn take(&mut self, command: &Command<'_>, diagnostics: &mut Diagnostics) {
        let mut number = |letter| command.after(letter).and_then(|line: Line<'_>| line.number(diagnostics));
        let deviations = [number('X'), number('Y'), number('Z')];
        let (height, to_y) = (number('S'), number('P'));
        if deviations.iter().any(Option::is_some) && height.is_none_or(|height| height < LEAST_HEIGHT) {
            let message = "`M556` takes X, Y and Z over a height S of 10 mm or more";
            let help = "write the height of the measurement, such as `M556 S100 X0.12`";
            diagnostics.push(Diagnostic::error("E0803", command.line.span, message).help(help));
            return;
        }
        for (slot, deviation) in self.values.iter_mut().zip(deviations) {
            if let (Some(deviation), Some(height)) = (deviation, height) {
                *slot = deviation / height;
                self.first.get_or_insert(command.line.span);
            }
        }
        self.to_y = to_y.map_or(self.to_y, |to_y| to_y > 0.0);
    }
}

/// The points of a mesh, by row and column.
#[derive(Default)]
struct Points {
    first: Option<Span>,
    heights: BTreeMap<(usize, usize), f64>,
}

impl Points {
    fn take(&mut self, command: &Command<'_>, diagnostics: &mut Diagnostics) {
        let index =
            |letter| command.after(letter).and_then(|line| line.text.parse::<u8>().ok()).map(usize::from);
        let (Some(column), Some(row), Some(height)) = (index('I'), index('J'), command.after('Z')) else {
            return command.line.malformed(FORM, diagnostics);
        };
        if let Some(height) = height.number(diagnostics) {
            self.heights.insert((row, column), height);
            self.first.get_or_insert(command.line.span);
        }
    }

    /// The rows, where no point of them is missing.
    fn rows(&self) -> Option<Vec<Vec<f64>>> {
        let count =
            |index: fn(&(usize, usize)) -> usize| self.heights.keys().map(index).max().map(|most| most + 1);
        let (rows, columns) = (count(|(row, _)| *row)?, count(|(_, column)| *column)?);
        let height = |row, column| self.heights.get(&(row, column)).copied();
        (0..rows).map(|row| (0..columns).map(|column| height(row, column)).collect()).collect()
    }
}

/// The mesh of points or of a print, over the places that the user says.
fn mesh(
    source: &SourceFile,
    points: Points,
    wanted: &SavedWanted,
    diagnostics: &mut Diagnostics,
) -> Option<Mesh> {
    let printed = printed::rows(source, diagnostics);
    let mut refuse = |code, span, message: &str, help: &str| {
        diagnostics.push(Diagnostic::error(code, span, message).help(help));
        None
    };
    let rows = match (points.first, printed) {
        (Some(span), Some(_)) => {
            return refuse(
                "E0803",
                span,
                "the file has a mesh both as points and as a printed table",
                "keep one of the two",
            );
        }
        (Some(span), None) => match points.rows() {
            Some(rows) => rows,
            None => return refuse("E0803", span, "points of the mesh are missing", FORM),
        },
        (None, Some(rows)) => rows,
        (None, None) => return None,
    };
    let [Some(x), Some(y)] = wanted.reach else {
        let message = "the file does not give the ends of the mesh";
        let help =
            "give the ends for which the firmware was built: `x: [10 mm, 210 mm]` and `y: [10 mm, 210 mm]`";
        return refuse("E0804", points.first.unwrap_or_default(), message, help);
    };
    let columns = rows.first().map_or(0, Vec::len);
    let places = [spread(x, columns), spread(y, rows.len())];
    let even = rows.iter().all(|row| row.len() == columns);
    let mesh = even.then(|| Mesh::new(['X', 'Y'], places, rows.concat())).flatten();
    mesh.or_else(|| {
        let message =
            "rows of the mesh differ in length, or the mesh has fewer than two points in one direction";
        refuse("E0803", points.first.unwrap_or_default(), message, FORM)
    })
}
