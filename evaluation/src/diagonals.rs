//! What the diagonals of one recording give together. In: lines. Out: the greatest figures of the body diagonals, or of the face
//! diagonals where there are no others, after ISO 230-6.

use crate::figure::{Figure, Given, Rests, Unit};
use crate::positioning::{Kind, Positioning};

/// The diagonals of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagonals {
    /// Body or face diagonals.
    pub kind: Kind,
    /// The signs of the axes along each: `+X+Y-Z`.
    pub names: Vec<String>,
    /// The greatest E and B of all of them.
    pub figures: Vec<Figure>,
}

/// How many body diagonals there are.
const BODY: usize = 4;

/// What the diagonals give together; nothing where there are none.
pub(crate) fn evaluate(lines: &[Positioning]) -> Option<Diagonals> {
    let of = |kind: Kind| lines.iter().filter(|line| line.kind == kind).collect::<Vec<&Positioning>>();
    let (body, face) = (of(Kind::BodyDiagonal), of(Kind::FaceDiagonal));
    let (kind, lines) = if body.is_empty() { (Kind::FaceDiagonal, face) } else { (Kind::BodyDiagonal, body) };
    if lines.is_empty() {
        return None;
    }
    let mut names: Vec<String> = lines.iter().map(|line| name(line)).collect();
    names.sort();
    names.dedup();
    let incomplete = kind == Kind::BodyDiagonal && names.len() < BODY;
    let greatest = |symbol: &'static str, name: &'static str, of: &str| {
        let figures: Vec<&Figure> =
            lines.iter().flat_map(|line| &line.figures).filter(|figure| figure.symbol == of).collect();
        let values: Vec<f64> = figures.iter().filter_map(|figure| figure.value.number()).collect();
        let value = if incomplete {
            Err(format!("it needs all {BODY} body diagonals, but there are {}", names.len()))
        } else if values.len() < lines.len() || values.is_empty() {
            Err(format!("a diagonal lacks {of}"))
        } else {
            Ok(values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
        };
        Figure {
            symbol,
            name,
            source: "ISO 230-6",
            value: Given::from(value),
            unit: Unit::Length,
            rests: rests(&figures),
        }
    };
    let figures = vec![
        greatest("E_d", "maximum bidirectional systematic deviation of the diagonals", "E"),
        greatest("B_d", "maximum reversal value of the diagonals", "B"),
    ];
    Some(Diagonals { kind, names, figures })
}

/// The signs of the axes, in their order: `+X+Y-Z`.
pub(crate) fn name(line: &Positioning) -> String {
    let sign = |part: &f64| if *part < 0.0 { "-" } else { "+" };
    line.direction.iter().zip(&line.axes).map(|(part, axis)| format!("{}{axis}", sign(part))).collect()
}

fn rests(figures: &[&Figure]) -> Rests {
    let all = || figures.iter().map(|figure| figure.rests);
    Rests {
        targets: Some(all().filter_map(|rests| rests.targets).sum()),
        readings: all().map(|rests| rests.readings).sum(),
        runs: [
            all().map(|rests| rests.runs[0]).min().unwrap_or(0),
            all().map(|rests| rests.runs[1]).max().unwrap_or(0),
        ],
    }
}
