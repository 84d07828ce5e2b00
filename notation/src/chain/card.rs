//! One link as a card. In: a link and the equations. Out: its name, its joint, its frame and its error motions, each
//! with its meaning for a reader who points at it.

use pages::svg::{Drawing, number};
use pages::text::escape;

use super::glyph;
use super::{CARD, LINE, broken};
use model_dsl::equations::{Equations, Motion, Names};
use model_dsl::machine::{Link, LinkKind};
use model_dsl::sheet::{Base, Letter};

/// The height of the row of pictures.
const PICTURES: f64 = 56.0;
/// Where motions begin and end in a line.
const MOTIONS: (f64, f64) = (54.0, CARD - 5.0);
/// How many letters of a heading stand in a line.
const HEADING_LETTERS: usize = 24;

/// A card, laid out.
pub(super) struct Card<'e> {
    link: &'e Link,
    heading: Vec<String>,
    lines: Vec<Row<'e>>,
}

/// One line of error motions.
struct Row<'e> {
    what: &'static str,
    motions: Vec<(f64, Letter, &'e Motion)>,
}

impl<'e> Card<'e> {
    /// Lays out a link.
    pub(super) fn new(equations: &'e Equations, names: Names, link: &'e Link) -> Self {
        let is_here = |body: usize| equations.links.get(body).is_some_and(|known| known.id == link.id);
        // A motor is no body: its error stands with each link that it moves.
        let moves = |motion: &Motion| motion.by_motor.iter().any(|moved| is_here(moved.link));
        let own = || equations.motions.iter().filter(|motion| motion.link == link.id || moves(motion));
        let mut lines = lines("moves", own().filter(|motion| !motion.alignment && !motion.angular), names);
        lines.extend(self::lines("turns", own().filter(|motion| !motion.alignment && motion.angular), names));
        lines.extend(self::lines("aligned", own().filter(|motion| motion.alignment), names));
        Self { link, heading: broken(&heading(link), HEADING_LETTERS), lines }
    }

    /// The height of the card.
    pub(super) fn height(&self) -> f64 {
        let text = self.heading.len() + self.lines.len().max(1);
        (0..text).fold(PICTURES + 12.0, |height, _| height + LINE)
    }

    /// Draws the card with its upper left corner at a point.
    pub(super) fn draw(&self, drawing: &mut Drawing, left: f64, top: f64) {
        drawing.raw(&format!("<g class=\"link\" data-link=\"{}\">\n", escape(&self.link.id)));
        let (x, y) = (number(left + 1.0), number(top));
        let (width, height) = (number(CARD - 2.0), number(self.height()));
        drawing.element(
            "rect",
            &[("class", "card"), ("x", &x), ("y", &y), ("width", &width), ("height", &height), ("rx", "4")],
        );
        let mut line = top + LINE + 3.0;
        for heading in &self.heading {
            drawing.text((left + 8.0, line), "name", heading);
            line += LINE;
        }
        let middle = line - LINE + 4.0 + PICTURES / 2.0;
        glyph::frame(drawing, (left + 32.0, middle + 14.0));
        glyph::joint(drawing, self.link, (left + 118.0, middle));
        line += PICTURES;
        if self.lines.is_empty() {
            drawing.text((left + 8.0, line), "quiet", "no error motion enters here");
        }
        for row in &self.lines {
            drawing.text((left + 8.0, line), "quiet", row.what);
            for (at, letter, motion) in &row.motions {
                drawing.raw(&symbol((left + at, line), letter, motion));
            }
            line += LINE;
        }
        drawing.raw("</g>\n");
    }
}

fn heading(link: &Link) -> String {
    let sign = if link.along.sign < 0 { '\u{2212}' } else { '+' };
    let along = link.along.axis;
    let id = &link.id;
    let other = |letter: char| if *id == letter.to_string() { String::new() } else { format!(" ({id})") };
    match link.kind {
        LinkKind::Slide(letter) => format!("slide {letter}{} along {sign}{along}", other(letter)),
        LinkKind::Rotary(letter) => {
            format!("rotary {letter}{} about {sign}{along}{}", other(letter), turned(link, "leaning by"))
        }
        LinkKind::Spindle => format!("spindle {id} about {along}"),
        kind => format!("{} {id}{}", kind.word(), turned(link, "turned by")),
    }
}

/// The constant angles of a link, where it has such.
fn turned(link: &Link, how: &str) -> String {
    if link.turned.is_none() { String::new() } else { format!(" {how} {}", link.turned.words()) }
}

/// Motions of one kind in lines that fit; the kind stands before the first.
fn lines<'e>(what: &'static str, motions: impl Iterator<Item = &'e Motion>, names: Names) -> Vec<Row<'e>> {
    let (start, end) = MOTIONS;
    let mut lines: Vec<Row<'e>> = Vec::new();
    let mut at = end;
    for motion in motions {
        let letter = Letter::motion(motion, names);
        let width = width(&letter);
        if at + width > end {
            let what = if lines.is_empty() { what } else { "" };
            lines.push(Row { what, motions: Vec::new() });
            at = start;
        }
        if let Some(row) = lines.last_mut() {
            row.motions.push((at, letter, motion));
        }
        at += width + 7.0;
    }
    lines
}

/// About how wide a name is drawn.
fn width(letter: &Letter) -> f64 {
    let letters = |text: &str, each: f64| text.chars().fold(0.0, |width, _| width + each);
    letters(&base(letter), 7.0) + letters(letter.subscript.as_deref().unwrap_or_default(), 5.6)
}

fn base(letter: &Letter) -> String {
    match &letter.base {
        Base::Letter(one) => one.to_string(),
        Base::Word(word) => word.clone(),
        Base::Greek(greek) => greek.character.to_string(),
    }
}

/// The name of an error motion, with its subscript, and its meaning.
fn symbol((x, y): (f64, f64), letter: &Letter, motion: &Motion) -> String {
    let subscript = letter.subscript.as_deref().map(|text| {
        let text = escape(text);
        format!("<tspan class=\"sub\" dy=\"2.5\">{text}</tspan>")
    });
    let room = MOTIONS.1 - MOTIONS.0;
    // A name that is wider than its card is set narrower.
    let squeezed = if width(letter) > room {
        format!(" textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\"", number(room))
    } else {
        String::new()
    };
    format!(
        "<text x=\"{}\" y=\"{}\" class=\"motion\"{squeezed} data-motion=\"{}\"><title>{}: {}</title>{}{}</text>\n",
        number(x),
        number(y),
        escape(&motion.name),
        escape(&motion.name),
        escape(&motion.meaning),
        escape(&base(letter)),
        subscript.unwrap_or_default(),
    )
}
