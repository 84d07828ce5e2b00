//! What a topology word means. In: a word such as XYFZ. Out: its page: which axis stands on which, and what the machine is.

use std::fmt::Write;

use model_dsl::compile_word;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::machine::Branch;
use textwrap::fill;

use super::page::WIDTH;

/// The letter of the bed.
const BED: char = 'F';

/// The page of a topology word; nothing for a word that is none.
pub(super) fn page(name: &str) -> Option<String> {
    let word = name.to_ascii_uppercase();
    let (part, tool) = word.split_once(BED)?;
    let equations = compile_word(&word, &mut Diagnostics::new())?.equations;
    let letters = |axes: &str| axes.chars().map(String::from).collect::<Vec<_>>();
    let (part, tool) = (letters(part), letters(tool));
    let motions: Vec<&str> = equations.motions.iter().map(|motion| motion.name.as_str()).collect();
    let mut text = format!("{word}: a topology word\n\n");
    let mut paragraph = |words: &str| {
        // A page is text: writing to it cannot fail.
        let _ = writeln!(text, "{}", fill(words, WIDTH));
    };
    paragraph("It names the axes in order from the part to the tool. F is the bed.");
    paragraph(&format!("{} {}", carried(&part, Branch::Workpiece), carried(&tool, Branch::Tool)));
    paragraph("");
    paragraph(&format!("    {}", chain(&part, &tool)));
    paragraph("");
    paragraph(&format!("Its {} error motions: {}.", motions.len(), motions.join(", ")));
    paragraph("");
    paragraph(&format!(
        "`abbe new {word}` writes a machine file with this chain, `abbe derive {word}` prints its error equations."
    ));
    Some(text)
}

/// What carries the part, or the tool: the axes in the order of the word.
fn carried(axes: &[String], branch: Branch) -> String {
    let carried = match branch {
        Branch::Workpiece => "part",
        Branch::Tool => "tool",
    };
    // From what is carried to the bed.
    let mut outwards: Vec<&str> = axes.iter().map(String::as_str).collect();
    if branch == Branch::Tool {
        outwards.reverse();
    }
    let pairs = outwards.iter().zip(outwards.iter().skip(1));
    let stands: String = pairs.map(|(upper, lower)| format!(", {lower} carries {upper}")).collect();
    match outwards.as_slice() {
        [] => format!("No axis carries the {carried}: it is fixed to the bed."),
        [first, ..] => {
            let last = outwards.last().unwrap_or(first);
            format!("{first} carries the {carried}{stands}, the bed carries {last}.")
        }
    }
}

/// `part - X - Y - bed - Z - tool`.
fn chain(part: &[String], tool: &[String]) -> String {
    let words = |text: &str| vec![text.to_owned()];
    [words("part"), part.to_vec(), words("bed"), tool.to_vec(), words("tool")].concat().join(" - ")
}
