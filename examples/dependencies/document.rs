//! `docs/dependencies.md`. In: its text, the tables as they are today, and the crates that the manifests name. Out: what must
//! be changed in it, or the text with the tables of today.

use std::collections::BTreeSet;

const BEGIN: &str = "<!-- crates -->\n";
const END: &str = "<!-- end -->\n";

/// The text with the tables of today.
///
/// # Errors
///
/// It has no place for them.
pub(crate) fn renewed(document: &str, tables: &str) -> Result<String, String> {
    let (before, _, after) = parts(document)?;
    Ok(format!("{before}{BEGIN}{tables}{END}{after}"))
}

/// What must be changed in the document; nothing where it is as it should be.
///
/// # Errors
///
/// It has no place for the tables.
pub(crate) fn differences(
    document: &str,
    tables: &str,
    direct: &BTreeSet<String>,
) -> Result<Vec<String>, String> {
    let (before, shown, _) = parts(document)?;
    let lacking = tables.lines().filter(|line| !shown.lines().any(|other| other == *line));
    let outdated = shown.lines().filter(|line| !tables.lines().any(|other| other == *line));
    let mut wrong: Vec<String> = lacking.map(|line| format!("it lacks: {line}")).collect();
    wrong.extend(outdated.map(|line| format!("it has, and it is not so: {line}")));
    if wrong.is_empty() && shown != tables {
        wrong.push("its tables are in another order".to_owned());
    }
    let unnamed = direct.iter().filter(|name| !before.contains(&format!("| `{name}` |")));
    wrong.extend(unnamed.map(|name| format!("it does not say what `{name}` is for")));
    Ok(wrong)
}

/// What stands before the tables, the tables, and what stands after them.
fn parts(document: &str) -> Result<(&str, &str, &str), String> {
    let cut = document
        .split_once(BEGIN)
        .and_then(|(before, rest)| rest.split_once(END).map(|(tables, after)| (before, tables, after)));
    cut.ok_or_else(|| format!("there is no place for the tables, which is\n{BEGIN}{END}"))
}
