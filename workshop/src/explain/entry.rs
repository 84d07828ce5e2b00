//! The form of the texts. In: a file of entries. Out: their parts.
//!
//! An entry begins with its name and its title, and ends before an empty line:
//!
//! ```text
//! E0106 a name that cannot be a machine's
//! What it means, in one line.
//! mend: What to do.
//! example: machine part
//! -name: my mill
//! +name: my-mill
//! ```
//!
//! A line `word: text` begins a part. Lines that begin with a space, `-` or `+` belong to the example: with `-` they stand in
//! the faulty file alone, with `+` in the mended one alone.

/// One code or one term.
#[derive(Debug)]
pub(super) struct Entry<'a> {
    /// The code or the term's name.
    pub(super) name: &'a str,
    /// What stands behind it on its line.
    pub(super) title: &'a str,
    /// The parts with their names, in order; that of the first line without a name is empty.
    parts: Vec<(&'a str, &'a str)>,
    /// The lines of the example with their marks.
    lines: Vec<(char, &'a str)>,
}

impl<'a> Entry<'a> {
    /// The text of a part.
    pub(super) fn part(&self, name: &str) -> Option<&'a str> {
        self.parts.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
    }

    /// The example without the lines of a mark.
    pub(super) fn example(&self, without: char) -> Vec<&'a str> {
        self.lines.iter().filter(|(mark, _)| *mark != without).map(|(_, line)| *line).collect()
    }
}

/// The names of parts.
const PARTS: [&str; 10] = [
    "mend",
    "example",
    "is",
    "value",
    "shows",
    "also",
    "measure",
    "remove",
    "form",
    "form of a simulated instrument",
];

/// Reads the entries of a file.
pub(super) fn read(text: &str) -> Vec<Entry<'_>> {
    text.split("\n\n").filter_map(entry).collect()
}

fn entry(text: &str) -> Option<Entry<'_>> {
    let mut lines = text.lines();
    let head = lines.next()?;
    let (name, title) = head.split_once(' ').unwrap_or((head, ""));
    let mut entry = Entry { name, title, parts: Vec::new(), lines: Vec::new() };
    for line in lines {
        if let Some(mark) = line.chars().next().filter(|mark| matches!(mark, ' ' | '-' | '+')) {
            entry.lines.push((mark, line.get(1..)?));
        } else {
            entry.parts.push(part(line));
        }
    }
    Some(entry)
}

fn part(line: &str) -> (&str, &str) {
    match line.split_once(':').filter(|(name, _)| PARTS.contains(name)) {
        Some((name, text)) => (name, text.trim()),
        None => ("", line),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_has_two_forms_of_its_example() {
        let entries =
            read("E1 a title\nMeaning: plain.\nmend: so\nexample: machine\n a: 1\n-b: 2\n+b: 3\n\nE2\n");
        assert_eq!(entries.len(), 2);
        let one = &entries[0];
        assert_eq!((one.name, one.title), ("E1", "a title"));
        assert_eq!((one.part(""), one.part("mend")), (Some("Meaning: plain."), Some("so")));
        assert_eq!((one.example('+'), one.example('-')), (vec!["a: 1", "b: 2"], vec!["a: 1", "b: 3"]));
        assert_eq!((entries[1].name, entries[1].part("mend")), ("E2", None));
    }
}
