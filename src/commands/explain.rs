//! `abbe explain`: what a diagnostic, a term, an error motion, a topology word or a word of the glossary means. In: its name, or none. Out: its page, or the list of all.

use workshop::explain;
use workshop::failure::Failure;

use crate::arguments::Explain;

/// Runs the command.
pub(crate) fn run(command: &Explain) -> Result<(), Failure> {
    command.target.check(&[])?;
    let page = match &command.name {
        Some(name) => explain::page(name).map_err(|near| Failure::wrong(unknown(name, &near)))?,
        None => explain::overview(),
    };
    command.target.put(&page)
}

fn unknown(name: &str, near: &[&str]) -> String {
    let named: Vec<String> = near.iter().map(|name| format!("`{name}`")).collect();
    let help = match named.as_slice() {
        [] => "`abbe explain` without a name lists all codes and terms; it also explains error motions, topology words and the words of the guide's glossary".to_owned(),
        [one] => format!("did you mean {one}?"),
        [others @ .., last] => format!("did you mean {} or {last}?", others.join(", ")),
    };
    format!("error: `abbe explain` does not know `{}`\nhelp: {help}", name.escape_debug())
}
