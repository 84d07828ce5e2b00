//! How calibration files are spelled. In: numbers, words and parameters. Out: YAML that reads back to the same.

use crate::quoted;

/// The longest line that a term alone takes, in characters.
const LONG: usize = 160;

/// Where the lines of a list are broken, in characters.
const WIDE: usize = 110;

/// A parameter's value as it is written.
pub(super) enum Item {
    /// A word, or a number with its unit.
    One(String),
    /// A list of such.
    List(Vec<String>),
}

/// A number in the fewest digits that give the same bits back; zero has no sign. One with an exponent has a point and a sign of the
/// exponent too, as in `-4.0e-8`: readers of YAML 1.1 take `-4e-8` for text.
pub(super) fn number(value: f64) -> String {
    let plain = value == 0.0 || (1e-4..1e15).contains(&value.abs());
    match plain {
        true => format!("{}", value + 0.0),
        false => exponential(value),
    }
}

fn exponential(value: f64) -> String {
    let text = format!("{value:e}");
    let Some((digits, exponent)) = text.split_once('e') else { return text };
    let point = if digits.contains('.') { "" } else { ".0" };
    let sign = if exponent.starts_with('-') { "" } else { "+" };
    format!("{digits}{point}e{sign}{exponent}")
}

/// A number with its unit.
pub(super) fn quantity(value: f64, unit: &str) -> String {
    format!("{} {unit}", number(value))
}

/// A word, in quotes where a bracket or a comma could end it or YAML could take it for something else.
pub(super) fn word(text: &str) -> String {
    spelled(text, " _-+./()=")
}

/// A text that stands alone on its line, in quotes where YAML could take it for something else.
pub(super) fn sentence(text: &str) -> String {
    spelled(text, " _-+./()=,;")
}

fn spelled(text: &str, marks: &str) -> String {
    let harmless = |character: char| character.is_alphanumeric() || marks.contains(character);
    let begins = text.starts_with(char::is_alphanumeric);
    let plain = begins && text.chars().all(harmless) && text.trim() == text && text != "null";
    if plain { text.to_owned() } else { quoted(text) }
}

/// A mapping in braces.
pub(super) fn braces(entries: impl IntoIterator<Item = (String, String)>) -> String {
    let entries: Vec<String> = entries.into_iter().map(|(key, value)| format!("{key}: {value}")).collect();
    format!("{{{}}}", entries.join(", "))
}

/// A list in brackets.
pub(super) fn brackets(items: &[String]) -> String {
    format!("[{}]", items.join(", "))
}

/// A term as an item of its motion's list: one line, or where that is too long a line for each parameter.
pub(super) fn term(name: &str, parameters: &[(&str, Item)]) -> String {
    let short = parameters.iter().map(|(key, item)| ((*key).to_owned(), item.in_one_line()));
    let line = format!("    - {name}: {}\n", braces(short));
    if line.chars().count() <= LONG {
        return line;
    }
    let lines = parameters.iter().map(|(key, item)| match item {
        Item::One(text) => format!("        {key}: {text}\n"),
        Item::List(items) => format!("        {key}: [{}]\n", broken(items)),
    });
    format!("    - {name}:\n{}", lines.collect::<String>())
}

impl Item {
    fn in_one_line(&self) -> String {
        match self {
            Self::One(text) => text.clone(),
            Self::List(items) => brackets(items),
        }
    }
}

/// The items of a list, in lines of some width, each but the first further in than the list's key.
fn broken(items: &[String]) -> String {
    let mut written = String::new();
    let mut width = 0;
    for (number, item) in items.iter().enumerate() {
        if number > 0 {
            written.push(',');
            width += item.chars().count() + 2;
            let fits = width <= WIDE;
            written.push_str(if fits { " " } else { "\n          " });
            width = if fits { width } else { item.chars().count() };
        }
        written.push_str(item);
    }
    written
}
