//! The one walk over the tree. In: an expression and a [`Writer`]. Out: its text in pieces, cut before every
//! sign inside a sum, where a line may be broken. All writers cut in the same places.

use super::letter::Letter;
use super::number::Number;
use super::tree::{Angle, Expression, Function};

/// The signs of a language.
pub struct Signs {
    /// Between two parts of a sum.
    pub plus: &'static str,
    /// Between two parts of a sum.
    pub minus: &'static str,
    /// Before the first part of a sum.
    pub leading_minus: &'static str,
    /// Between two factors.
    pub times: &'static str,
    /// Opens a bracket.
    pub open: &'static str,
    /// Closes a bracket.
    pub close: &'static str,
}

impl Signs {
    /// Those of plain text and of every language of programs.
    pub const PLAIN: Self =
        Self { plus: " + ", minus: " - ", leading_minus: "-", times: "*", open: "(", close: ")" };
}

/// How a language spells the parts of the tree. A writer spells; it does not choose.
pub trait Writer {
    /// Its signs.
    fn signs(&self) -> &'static Signs;
    /// A name.
    fn letter(&self, letter: &Letter) -> String;
    /// A number.
    fn number(&self, number: &Number) -> String;
    /// A power of something already written.
    fn power(&self, base: &str, exponent: u32) -> String;
    /// A sine or cosine of something already written.
    fn function(&self, function: Function, argument: &str) -> String;
    /// An angle that never changes, as the argument of a sine or cosine.
    fn angle(&self, angle: &Angle) -> String;
}

/// Text before which a line may be broken.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Piece {
    /// The text, with the sign that it begins with.
    pub text: String,
    /// Within how many brackets it begins.
    pub depth: usize,
}

/// The text of an expression, in pieces between which a line may be broken.
pub fn pieces(writer: &impl Writer, expression: &Expression) -> Vec<Piece> {
    let mut pieces = vec![Piece::default()];
    write(writer, expression, 0, &mut pieces);
    pieces
}

/// The text of an expression in one line.
pub fn line(writer: &impl Writer, expression: &Expression) -> String {
    pieces(writer, expression).into_iter().map(|piece| piece.text).collect()
}

fn write(writer: &impl Writer, expression: &Expression, depth: usize, pieces: &mut Vec<Piece>) {
    let signs = writer.signs();
    match expression {
        Expression::Sum(parts) => {
            for (number, part) in parts.iter().enumerate() {
                match (number, part.negative) {
                    (0, false) => {}
                    (0, true) => append(pieces, signs.leading_minus),
                    (_, negative) => {
                        let sign = if negative { signs.minus } else { signs.plus };
                        pieces.push(Piece { text: sign.to_owned(), depth });
                    }
                }
                write(writer, &part.value, depth, pieces);
            }
        }
        Expression::Product(factors) => {
            for (number, factor) in factors.iter().enumerate() {
                append(pieces, if number == 0 { "" } else { signs.times });
                write(writer, factor, depth, pieces);
            }
        }
        Expression::Group(inner) => {
            append(pieces, signs.open);
            write(writer, inner, depth + 1, pieces);
            append(pieces, signs.close);
        }
        Expression::Power(base, exponent) => {
            let base = line(writer, base);
            append(pieces, &writer.power(&base, *exponent));
        }
        Expression::Function(function, argument) => {
            append(pieces, &writer.function(*function, &writer.letter(argument)));
        }
        Expression::Fixed(function, angle) => {
            append(pieces, &writer.function(*function, &writer.angle(angle)));
        }
        Expression::Letter(letter) => append(pieces, &writer.letter(letter)),
        Expression::Number(number) => append(pieces, &writer.number(number)),
    }
}

fn append(pieces: &mut [Piece], text: &str) {
    if let Some(last) = pieces.last_mut() {
        last.text.push_str(text);
    }
}
