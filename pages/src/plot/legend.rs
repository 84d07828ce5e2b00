//! Legends. In: names and looks. Out: entries in rows, each with a piece of its line and its mark.

use super::look::Look;
use super::series::Draw;
use super::words;
use crate::svg::Drawing;

/// One entry.
pub(super) struct Entry<'n> {
    pub(super) name: &'n str,
    pub(super) look: Look,
    pub(super) draw: Draw,
}

/// How high a row is.
const ROW: f64 = 17.0;
/// How long the piece of a line is, with the room behind it.
const PIECE: f64 = 30.0;

/// Entries put into rows: for each its x and row.
fn laid_out(entries: &[Entry<'_>], room: f64) -> Vec<(f64, f64)> {
    let (mut x, mut row) = (0.0, 0.0);
    entries
        .iter()
        .map(|entry| {
            let width = PIECE + words::width(entry.name) + 14.0;
            if x > 0.0 && x + width > room {
                (x, row) = (0.0, row + 1.0);
            }
            let at = (x, row);
            x += width;
            at
        })
        .collect()
}

/// How high the legend will be.
pub(super) fn height(entries: &[Entry<'_>], room: f64) -> f64 {
    laid_out(entries, room).last().map_or(0.0, |(_, row)| (row + 1.0) * ROW)
}

/// Draws the legend with its upper left corner at a point.
pub(super) fn paint(drawing: &mut Drawing, entries: &[Entry<'_>], (left, top): (f64, f64), room: f64) {
    for (entry, (x, row)) in entries.iter().zip(laid_out(entries, room)) {
        let (x, y) = (left + x, top + row * ROW + ROW / 2.0);
        let piece = [Some((x, y)), Some((x + 12.0, y)), Some((x + 24.0, y))];
        match entry.draw {
            Draw::Line => entry.look.paint(drawing, Draw::Line, &piece),
            Draw::MarkedLine => {
                entry.look.paint(drawing, Draw::Line, &piece);
                entry.look.paint(drawing, Draw::Marks, &piece[1..2]);
            }
            marks => entry.look.paint(drawing, marks, &piece[1..2]),
        }
        drawing.text((x + PIECE, y + 4.0), "", &words::cut(entry.name, room - PIECE));
    }
}
