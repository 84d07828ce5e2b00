//! Names as letters with subscripts. In: the name of a position, constant or error motion. Out: how it is
//! typeset: `X1` as X with subscript 1, `beta` as the Greek letter, `dxz` of a displacement as in the sources.

use crate::algebra::Axis;
use crate::equations::{Motion, Names};

/// A Greek letter: its English name, its LaTeX command without the backslash, its character.
#[derive(Debug, PartialEq, Eq)]
pub struct Greek {
    name: &'static str,
    /// The command of LaTeX.
    pub command: &'static str,
    /// The character itself.
    pub character: char,
}

const fn greek(name: &'static str, command: &'static str, character: char) -> Greek {
    Greek { name, command, character }
}

static GREEK: [Greek; 21] = [
    greek("delta", "delta", 'δ'),
    greek("epsilon", "varepsilon", 'ε'),
    greek("alpha", "alpha", 'α'),
    greek("beta", "beta", 'β'),
    greek("gamma", "gamma", 'γ'),
    greek("zeta", "zeta", 'ζ'),
    greek("eta", "eta", 'η'),
    greek("theta", "theta", 'θ'),
    greek("iota", "iota", 'ι'),
    greek("kappa", "kappa", 'κ'),
    greek("lambda", "lambda", 'λ'),
    greek("mu", "mu", 'μ'),
    greek("nu", "nu", 'ν'),
    greek("xi", "xi", 'ξ'),
    greek("pi", "pi", 'π'),
    greek("rho", "rho", 'ρ'),
    greek("sigma", "sigma", 'σ'),
    greek("tau", "tau", 'τ'),
    greek("phi", "varphi", 'φ'),
    greek("psi", "psi", 'ψ'),
    greek("omega", "omega", 'ω'),
];

/// What a name is built on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Base {
    /// One Latin letter.
    Letter(char),
    /// A longer name, kept whole.
    Word(String),
    /// A Greek letter.
    Greek(&'static Greek),
}

/// A name as it is typeset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Letter {
    /// The name as the machine file and plain text have it.
    pub plain: String,
    /// Whether a capital delta stands before it: the error of a position.
    pub difference: bool,
    /// What the subscript hangs on.
    pub base: Base,
    /// The subscript.
    pub subscript: Option<String>,
}

impl Letter {
    /// The name of a position, travel or constant.
    pub fn named(plain: &str) -> Self {
        let (base, subscript) = split(plain);
        Self { plain: plain.to_owned(), difference: false, base, subscript }
    }

    /// The name in a language that keeps some words for itself: such a word gets an underscore behind it.
    pub fn unless_reserved(&self, reserved: &[&str]) -> String {
        let underscore = if reserved.contains(&self.plain.as_str()) { "_" } else { "" };
        format!("{}{underscore}", self.plain)
    }

    /// An error motion by the chosen name: E with a subscript for a name of ISO 230-1, delta or epsilon
    /// with a subscript for the sources' `dxz` and `eyz`, otherwise as any name.
    pub fn motion(motion: &Motion, names: Names) -> Self {
        let plain = motion.printed(names);
        let (base, subscript) = if plain == motion.name && plain.starts_with('E') {
            (Base::Letter('E'), plain.get(1..).map(str::to_owned))
        } else {
            source_motion(plain, motion.angular).unwrap_or_else(|| split(plain))
        };
        Self { plain: plain.to_owned(), difference: false, base, subscript }
    }

    /// A bracket: L with a subscript.
    pub fn bracket(subscript: String) -> Self {
        let plain = format!("L{subscript}");
        Self { plain, difference: false, base: Base::Letter('L'), subscript: Some(subscript) }
    }

    /// A part of the direction of the tool, `I`, or its error.
    pub fn of_tool(direction: Axis, difference: bool) -> Self {
        let letter = direction.direction_letter();
        let plain = if difference { format!("d{letter}") } else { letter.to_string() };
        Self { plain, difference, base: Base::Letter(letter), subscript: None }
    }

    /// The position `P` of a direction, or its error; `plain` is its name in plain text.
    pub fn position(plain: String, direction: Axis, difference: bool) -> Self {
        let subscript = Some(direction.letter().to_ascii_lowercase().to_string());
        Self { plain, difference, base: Base::Letter('P'), subscript }
    }
}

/// The sources' way: d for a displacement, e for an angle, then the direction, then the link.
fn source_motion(plain: &str, angular: bool) -> Option<(Base, Option<String>)> {
    let (first, name) = if angular { ('e', "epsilon") } else { ('d', "delta") };
    let rest = plain.strip_prefix(first)?;
    let shaped = rest.len() == 2
        && rest.starts_with(['x', 'y', 'z'])
        && rest.bytes().all(|byte| byte.is_ascii_lowercase());
    let base = GREEK.iter().find(|greek| greek.name == name)?;
    shaped.then(|| (Base::Greek(base), Some(rest.to_owned())))
}

fn split(plain: &str) -> (Base, Option<String>) {
    if let Some((head, tail)) = plain.split_once('_')
        && !tail.is_empty()
    {
        return (base(head), Some(tail.replace('_', ",")));
    }
    let head = plain.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = &plain[head.len()..];
    if let Base::Greek(letter) = base(head) {
        return (Base::Greek(letter), (!digits.is_empty()).then(|| digits.to_owned()));
    }
    let mut letters = plain.chars();
    match letters.next() {
        Some(first) if plain.len() <= 4 => {
            let rest = letters.as_str();
            (Base::Letter(first), (!rest.is_empty()).then(|| rest.to_owned()))
        }
        _ => (Base::Word(plain.to_owned()), None),
    }
}

fn base(head: &str) -> Base {
    let greek = GREEK.iter().find(|greek| greek.name == head);
    let mut letters = head.chars();
    match (greek, letters.next(), letters.next()) {
        (Some(greek), _, _) => Base::Greek(greek),
        (None, Some(only), None) => Base::Letter(only),
        _ => Base::Word(head.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_split_as_people_read_them() {
        let shown = |name| match split(name) {
            (Base::Letter(letter), subscript) => format!("{letter}|{}", subscript.unwrap_or_default()),
            (Base::Word(word), subscript) => format!("{word}|{}", subscript.unwrap_or_default()),
            (Base::Greek(greek), subscript) => {
                format!("{}|{}", greek.character, subscript.unwrap_or_default())
            }
        };
        let cases = [
            ("x", "x|"),
            ("X1", "X|1"),
            ("Xt", "X|t"),
            ("beta", "β|"),
            ("alpha2", "α|2"),
            ("gauge_line", "gauge|line"),
            ("offset", "offset|"),
            ("a_", "a|_"),
        ];
        for (name, expected) in cases {
            assert_eq!(shown(name), expected);
        }
    }

    #[test]
    fn the_sources_symbols_need_their_kind() {
        assert!(source_motion("dxz", false).is_some());
        assert!(source_motion("dxz", true).is_none());
        assert!(source_motion("eyz", true).is_some());
        assert!(source_motion("exp", false).is_none());
        assert!(source_motion("dz", false).is_none());
    }
}
