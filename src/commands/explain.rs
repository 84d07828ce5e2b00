//! `abbe explain`: what a diagnostic, a term or an error motion means. In: its name, or none. Out: its page, or the list of all.

use workshop::explain;
use workshop::failure::Failure;

use crate::arguments::Explain;
use crate::output;

/// Runs the command.
pub(crate) fn run(command: &Explain) -> Result<(), Failure> {
    let Some(name) = &command.name else { return output::print(&explain::overview()) };
    match explain::page(name) {
        Ok(page) => output::print(&page),
        Err(near) => Err(Failure::wrong(unknown(name, &near))),
    }
}

fn unknown(name: &str, near: &[&str]) -> String {
    let named: Vec<String> = near.iter().map(|name| format!("`{name}`")).collect();
    let help = match named.as_slice() {
        [] => "`abbe explain` alone lists all codes and terms".to_owned(),
        [one] => format!("did you mean {one}?"),
        [others @ .., last] => format!("did you mean {} or {last}?", others.join(", ")),
    };
    format!("error: `{}` is no diagnostic, no term and no error motion\nhelp: {help}", name.escape_debug())
}
