//! RepRapFirmware's `heightmap.csv`, which `G29` writes and `G29 S1` loads. In: the file. Out: the mesh.
//!
//! Facts: RepRapFirmware, `src/Movement/BedProbing/Grid.cpp`: rows go along the first axis, the first at the least place of the
//! second; the places are the least one and whole steps, whatever the greatest; `Move::BedTransform` adds the height to Z. A point
//! that was not probed is `0` without a decimal point; the firmware puts the plane through the probed points there, and so does
//! this reader. The taper (`M376`) is no part of the machine.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::SourceFile;
use nalgebra::{Matrix3, Vector3};

use super::Saved;
use super::mesh::{Mesh, stepped};
use crate::controller::lines::{Line, lines};

/// How such a file begins.
pub(in crate::controller) const BEGIN: &str = "RepRapFirmware height map file";

/// The form of a file, for findings.
const FORM: &str = "write a height map as a line with its name, a line of labels, a line with the grid, and a row of heights for each position of the second axis";

/// Whether a text is such a file.
pub(super) fn is_here(text: &str) -> bool {
    text.trim_start().starts_with(BEGIN)
}

/// Reads the mesh.
pub(super) fn read(source: &SourceFile, diagnostics: &mut Diagnostics) -> Saved {
    Saved { mesh: mesh(source, diagnostics), ..Saved::default() }
}

fn mesh(source: &SourceFile, diagnostics: &mut Diagnostics) -> Option<Mesh> {
    let all: Vec<Line<'_>> = lines(source, "//").collect();
    let [_, labels, numbers, rows @ ..] = all.as_slice() else {
        malformed(all.last(), "the height map ends before its grid", diagnostics);
        return None;
    };
    let grid = HeightGrid::read(*labels, *numbers, diagnostics)?;
    let mut points = Vec::new();
    for row in rows {
        let before = points.len();
        points.extend(row.cells(',').map(|cell| (cell.text != "0").then(|| cell.number(diagnostics))));
        if points.len() - before != grid.counts[0] {
            malformed(Some(row), &format!("this row does not have {} heights", grid.counts[0]), diagnostics);
            return None;
        }
    }
    let heights: Vec<Option<f64>> = points
        .into_iter()
        .map(|point| point.map_or(Some(None), |number| number.map(Some)))
        .collect::<Option<_>>()?;
    let places: [Vec<f64>; 2] =
        std::array::from_fn(|axis| stepped(grid.least[axis], grid.steps[axis], grid.counts[axis]));
    let unprobed = heights.iter().filter(|height| height.is_none()).count();
    let mesh = filled(&heights, &places).and_then(|heights| Mesh::new(grid.axes, places, heights));
    if mesh.is_none() {
        malformed(
            Some(numbers),
            "the rows are not those of this grid, or too few points were probed",
            diagnostics,
        );
    } else if unprobed > 0 {
        let message = format!("{unprobed} of {} points were not probed", heights.len());
        let help = "the plane through the other points is used there, as in RepRapFirmware";
        diagnostics.push(Diagnostic::warning("W0801", numbers.span, message).help(help));
    }
    mesh
}

fn malformed(line: Option<&Line<'_>>, message: &str, diagnostics: &mut Diagnostics) {
    let span = line.map(|line| line.span).unwrap_or_default();
    diagnostics.push(Diagnostic::error("E0803", span, message).help(FORM));
}

/// The grid that the second and the third line tell.
struct HeightGrid {
    axes: [char; 2],
    least: [f64; 2],
    steps: [f64; 2],
    counts: [usize; 2],
}

impl HeightGrid {
    fn read(labels: Line<'_>, numbers: Line<'_>, diagnostics: &mut Diagnostics) -> Option<Self> {
        let (names, cells): (Vec<Line<'_>>, Vec<Line<'_>>) =
            (labels.cells(',').collect(), numbers.cells(',').collect());
        let cell = |known: [&str; 3]| {
            let number = names.iter().position(|name| known.contains(&name.text))?;
            cells.get(number).copied()
        };
        let mut number = |known: [&str; 3]| {
            let found = cell(known);
            if found.is_none() {
                malformed(
                    Some(&labels),
                    &format!("the labels have no `{}`, or there is nothing below it", known[0]),
                    diagnostics,
                );
            }
            found?.number(diagnostics)
        };
        let least = [number(["min0", "xmin", ""])?, number(["min1", "ymin", ""])?];
        let steps =
            [number(["spacing0", "xspacing", "spacing"])?, number(["spacing1", "yspacing", "spacing"])?];
        let counts = [number(["num0", "xnum", ""])?, number(["num1", "ynum", ""])?];
        // Labels before version 3.3 name no axes: they are X and Y.
        let letter = |label: &str, usual: char| {
            cell([label, label, label]).and_then(|cell| cell.text.chars().next()).unwrap_or(usual)
        };
        let counts =
            counts.map(|count| (2..=1_000_u16).find(|whole| f64::from(*whole) == count).map(usize::from));
        let [Some(columns), Some(rows)] = counts else {
            malformed(Some(&numbers), "a grid has 2 to 1000 points in either direction", diagnostics);
            return None;
        };
        Some(Self {
            axes: [letter("axis0", 'X'), letter("axis1", 'Y')],
            least,
            steps,
            counts: [columns, rows],
        })
    }
}

/// Heights row by row, the least-squares plane through those that are known in place of the others. Nothing where they are not
/// those of the grid, or determine no plane.
fn filled(heights: &[Option<f64>], [along, across]: &[Vec<f64>; 2]) -> Option<Vec<f64>> {
    let places = across.iter().flat_map(|y| along.iter().map(move |x| Vector3::new(*x, *y, 1.0)));
    if heights.iter().all(Option::is_some) {
        return heights.iter().copied().collect();
    }
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (place, height) in places.clone().zip(heights) {
        if let Some(height) = height {
            normal += place * place.transpose();
            right += place * *height;
        }
    }
    let plane = normal.try_inverse()? * right;
    (heights.len() == along.len() * across.len()).then(|| {
        places.zip(heights).map(|(place, height)| height.unwrap_or_else(|| plane.dot(&place))).collect()
    })
}
