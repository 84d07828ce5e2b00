//! JSON of schema `abbe-equations/1`. In: equations. Out: one object whose expressions are plain infix text.
//!
//! An arm is that of the motion under its ISO name. A term holds `"symbol_sign": -1` where the symbol is counted against the
//! ISO sense: its arm is the opposite one.

use super::infix;
use crate::equations::{Equations, Row, Term};

/// The whole object, with a line end after it.
pub(super) fn object(equations: &Equations) -> String {
    let rows: Vec<String> = equations.rows.iter().map(|one| row(one, equations)).collect();
    format!(
        "{{\n  \"schema\": \"abbe-equations/1\",\n  \"machine\": {},\n  \"directions\": [{}]\n}}\n",
        string(&equations.machine),
        rows.join(", ")
    )
}

fn row(row: &Row, equations: &Equations) -> String {
    let terms: Vec<String> = row.terms.iter().filter_map(|one| term(one, equations)).collect();
    format!(
        "{{\n    \"direction\": {},\n    \"nominal\": {},\n    \"terms\": [{}]\n  }}",
        string(&row.direction.to_string()),
        string(&infix(&row.nominal)),
        terms.join(",")
    )
}

fn term(term: &Term, equations: &Equations) -> Option<String> {
    let motion = equations.motions.get(term.motion)?;
    let sign = if motion.symbol_against_iso { ", \"symbol_sign\": -1" } else { "" };
    Some(format!(
        "\n      {{\"motion\": {}, \"symbol\": {}, \"arm\": {}{sign}}}",
        string(&motion.name),
        string(&motion.symbol),
        string(&infix(&term.arm))
    ))
}

/// A JSON string with its quotation marks.
fn string(text: &str) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        match character {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            control if u32::from(control) < 0x20 => {
                quoted.push_str(&format!("\\u{:04x}", u32::from(control)))
            }
            other => quoted.push(other),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::string;

    #[test]
    fn strings_are_escaped() {
        assert_eq!(string("a\"b\\c\nµ"), "\"a\\\"b\\\\c\\u000aµ\"");
    }
}
