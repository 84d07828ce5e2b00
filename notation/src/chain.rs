//! The chain as a drawing. In: equations and the choice of names. Out: an SVG drawing: the bed below, the part's branch
//! to the left, the tool's to the right, each link a card with its joint, its frame and the error motions that enter
//! there, its offset on the connection below it, and above both the error between part and tool tip.
//!
//! One drawing of 360 units serves a telephone and a desk: it is legible at its own size and is scaled, never rearranged.

mod card;
mod glyph;

use pages::svg::{Drawing, number};

use self::card::Card;
use model_dsl::algebra::Polynomial;
use model_dsl::equations::{Equations, Names};
use model_dsl::machine::{Branch, Link, LinkKind};

/// The width of a card.
const CARD: f64 = 172.0;
/// The room between the two branches.
const GAP: f64 = 16.0;
/// The height of a line of text.
const LINE: f64 = 14.0;
/// The room above the branches, for the loop that closes between part and tip.
const TOP: f64 = 52.0;
/// The height of the bed.
const BED: f64 = 26.0;
/// The height of the part where no link of the machine file stands for it.
const PART: f64 = 26.0;
/// How many letters of an offset stand in a line.
const OFFSET_LETTERS: usize = 25;

/// The rules that the drawing needs on a page.
pub(super) const STYLE: &str = "\
.chain svg { width: 100%; max-width: 32rem; }
.chain figcaption { margin-top: .6rem; }
.chain .part { --branch: var(--one); }
.chain .tool { --branch: var(--two); }
.chain text { fill: var(--ink); font-size: 11px; }
.chain text.name { font-weight: 600; font-size: 12px; }
.chain text.quiet { fill: var(--quiet); }
.chain text.middle { text-anchor: middle; }
.chain text.end { text-anchor: end; }
.chain .sub { font-size: 9px; }
.chain .card { fill: var(--band); stroke: var(--branch); stroke-width: 1.5; }
.chain .part .card { stroke-dasharray: 5 2; }
.chain .ground { fill: var(--band); stroke: var(--ink); }
.chain .stem, .chain .joint { fill: none; stroke: var(--branch); stroke-width: 2; }
.chain .solid { fill: var(--branch); }
.chain .hollow { fill: var(--paper); stroke: var(--branch); stroke-width: 1.2; }
.chain .free { stroke-dasharray: 3 3; }
.chain .frame { fill: none; stroke: var(--ink); stroke-width: 1; }
.chain .loop { fill: none; stroke: var(--ink); stroke-width: 1.2; stroke-dasharray: 2 3; }
@media print { .chain svg { max-height: 23cm; } }
";

/// What stands in a branch, from the bed outwards.
enum Piece<'e> {
    /// The way from one body to the next, with the lines of its offset.
    Stem(Vec<String>),
    /// A link.
    Link(Card<'e>),
    /// The part, where no link stands for it.
    Part,
}

impl Piece<'_> {
    fn height(&self) -> f64 {
        match self {
            Self::Stem(lines) => lines.iter().fold(14.0, |height, _| height + LINE),
            Self::Link(card) => card.height(),
            Self::Part => PART,
        }
    }
}

/// The letters of the axes from the part to the tool, F the bed: `XYFZ`.
pub(super) fn word(equations: &Equations) -> String {
    let letters = |branch| {
        let links = equations.links.iter().filter(move |link| link.branch == branch);
        links.filter_map(|link| link.kind.letter())
    };
    let mut word: Vec<char> = letters(Branch::Workpiece).collect();
    word.reverse();
    word.push('F');
    word.extend(letters(Branch::Tool));
    word.into_iter().collect()
}

/// The drawing.
pub(super) fn drawing(equations: &Equations, names: Names) -> Drawing {
    let branches = [Branch::Workpiece, Branch::Tool].map(|branch| (branch, pieces(equations, names, branch)));
    let tallest = branches.iter().map(|(_, pieces)| height(pieces)).fold(0.0, f64::max);
    let ground = TOP + tallest;
    let width = 2.0 * CARD + GAP;
    let title = format!("The kinematic chain of {}", equations.machine);
    let mut drawing = Drawing::new(width, ground + BED, &title);
    bed(&mut drawing, ground, width);
    let mut ends = Vec::new();
    for (branch, pieces) in &branches {
        let left = if *branch == Branch::Workpiece { 0.0 } else { CARD + GAP };
        drawing.raw(&format!("<g class=\"{}\">\n", class(*branch)));
        let end = stacked(&mut drawing, pieces, left, ground);
        drawing.raw("</g>\n");
        ends.push((left + CARD / 2.0, end));
    }
    closed(&mut drawing, equations, &ends, width);
    drawing
}

fn class(branch: Branch) -> &'static str {
    match branch {
        Branch::Workpiece => "part",
        Branch::Tool => "tool",
    }
}

fn pieces<'e>(equations: &'e Equations, names: Names, branch: Branch) -> Vec<Piece<'e>> {
    let mut pieces = Vec::new();
    let links: Vec<&Link> = equations.links.iter().filter(|link| link.branch == branch).collect();
    for link in &links {
        pieces.push(Piece::Stem(offset(link)));
        pieces.push(Piece::Link(Card::new(equations, names, link)));
    }
    let ends_in_part = links.last().is_some_and(|link| link.kind == LinkKind::Part);
    if branch == Branch::Workpiece && !ends_in_part {
        pieces.push(Piece::Stem(Vec::new()));
        pieces.push(Piece::Part);
    }
    pieces
}

/// The offset of a link in lines that fit; none where its frame stands in that before it.
fn offset(link: &Link) -> Vec<String> {
    if link.origin.iter().all(Polynomial::is_zero) {
        return Vec::new();
    }
    let [x, y, z] = link.origin.each_ref().map(model_dsl::sheet::infix);
    broken(&format!("[{x}, {y}, {z}]"), OFFSET_LETTERS)
}

fn height(pieces: &[Piece<'_>]) -> f64 {
    pieces.iter().map(Piece::height).sum()
}

fn bed(drawing: &mut Drawing, ground: f64, width: f64) {
    let (y, high, wide) = (number(ground), number(BED - 1.0), number(width - 1.0));
    drawing.element(
        "rect",
        &[("class", "ground"), ("x", "0.5"), ("y", &y), ("width", &wide), ("height", &high)],
    );
    let line = ground + 17.0;
    drawing.text((8.0, line), "quiet", "\u{2191} carries the part");
    drawing.text((width / 2.0, line), "name middle", "F, bed");
    drawing.text((width - 8.0, line), "quiet end", "carries the tool \u{2191}");
}

/// Draws a branch upwards from the bed; gives where it ends.
fn stacked(drawing: &mut Drawing, pieces: &[Piece<'_>], left: f64, ground: f64) -> f64 {
    pieces.iter().fold(ground, |below, piece| {
        let top = below - piece.height();
        match piece {
            Piece::Stem(lines) => stem(drawing, lines, left, (top, below)),
            Piece::Link(card) => card.draw(drawing, left, top),
            Piece::Part => part(drawing, left, top),
        }
        top
    })
}

fn stem(drawing: &mut Drawing, lines: &[String], left: f64, (top, below): (f64, f64)) {
    let path = format!("M{} {}V{}", number(left + 14.0), number(below), number(top));
    drawing.element("path", &[("class", "stem"), ("d", &path)]);
    for (y, line) in rows(top + LINE + 3.0).zip(lines) {
        drawing.text((left + 22.0, y), "offset", line);
    }
}

/// The base lines of text below each other.
fn rows(first: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(first), |y| Some(y + LINE))
}

fn part(drawing: &mut Drawing, left: f64, top: f64) {
    let (x, y) = (number(left + 1.0), number(top));
    let (width, height) = (number(CARD - 2.0), number(PART));
    drawing.element(
        "rect",
        &[("class", "card"), ("x", &x), ("y", &y), ("width", &width), ("height", &height), ("rx", "4")],
    );
    drawing.text((left + CARD / 2.0, top + 17.0), "name middle", "part");
}

/// The loop that closes the chain: what the equations are about.
fn closed(drawing: &mut Drawing, equations: &Equations, ends: &[(f64, f64)], width: f64) {
    if let [(part, part_end), (tool, tool_end)] = ends {
        let bar = number(TOP - 14.0);
        let path =
            format!("M{} {}V{bar}H{}V{}", number(*part), number(*part_end), number(*tool), number(*tool_end));
        drawing.element("path", &[("class", "loop"), ("d", &path)]);
    }
    let directions: Vec<String> = equations.rows.iter().map(|row| row.direction.to_string()).collect();
    drawing.text((width / 2.0, 12.0), "name middle", "E, the error");
    let what = format!("of the tool tip relative to the part, in {}", directions.join(", "));
    drawing.text((width / 2.0, 27.0), "middle", &what);
}

/// Text in lines of at most so many letters: broken after a space, or anywhere in a word that is longer.
fn broken(text: &str, limit: usize) -> Vec<String> {
    let mut lines: Vec<String> = vec![String::new()];
    for word in text.split(' ') {
        let letters: Vec<char> = word.chars().collect();
        for (number, part) in letters.chunks(limit.max(1)).enumerate() {
            let part: String = part.iter().collect();
            let Some(line) = lines.last_mut() else { continue };
            let taken = line.chars().count();
            if taken == 0 {
                line.push_str(&part);
            } else if number == 0 && taken + 1 + part.chars().count() <= limit {
                line.push(' ');
                line.push_str(&part);
            } else {
                lines.push(part);
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests;
