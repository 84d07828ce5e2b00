//! Comments of a calibration that is written anew. In: the file as it was, its numbers as they are written, and those with what was found.
//! Out: the new text with the comments of the old file, since they say where its numbers come from.
//!
//! A comment belongs to the line below it, or to the line that it stands on. It is kept where that line is in the new text: a heading such
//! as `EXX:` by its place, a value only where it is the same as before. Comments above the first key are kept in any case.

use std::collections::BTreeMap;

/// The head of the old file, and the new text with the comments that stay.
pub(super) struct Kept {
    /// The comments above the first key, each a line.
    pub(super) head: String,
    /// The new text.
    pub(super) text: String,
}

/// Puts the comments of `old` into `new`; `before` is what `old` is when it is written anew.
pub(super) fn kept(old: &str, before: &str, new: &str) -> Kept {
    let (head, mut comments) = comments(old);
    let known: BTreeMap<Place, Vec<&str>> = blocks(before).into_iter().collect();
    let mut text = String::new();
    for (place, block) in blocks(new) {
        let stays = is_heading(&block) || known.get(&place) == Some(&block);
        let own = comments.remove(&place).filter(|_| stays).unwrap_or_default();
        let [first, further @ ..] = block.as_slice() else { continue };
        let indent: String = first.chars().take_while(|letter| *letter == ' ').collect();
        text.extend(own.above.iter().map(|line| format!("{indent}{line}\n")));
        let beside = own.beside.map(|comment| format!(" {comment}")).unwrap_or_default();
        text += &format!("{first}{beside}\n");
        text.extend(further.iter().map(|line| format!("{line}\n")));
    }
    Kept { head, text }
}

/// Where a line stands: the keys that it stands under and its own, each with how many of that name came before it there.
type Place = Vec<(String, usize)>;

/// The comments of a line.
#[derive(Default)]
struct Comments {
    above: Vec<String>,
    beside: Option<String>,
}

/// Whether a line begins what stands on lines of their own below it, or in other lists, and has no value itself.
fn is_heading(block: &[&str]) -> bool {
    let [first, ..] = block else { return false };
    first.trim_end().ends_with(':') && !first.trim_start().starts_with("- ")
}

/// The comments of a file: its head, and those of lines.
fn comments(text: &str) -> (String, BTreeMap<Place, Comments>) {
    let (mut head, mut found) = (String::new(), BTreeMap::new());
    let mut above: Vec<String> = Vec::new();
    let mut walk = Walk::default();
    let mut begun = false;
    for line in text.lines() {
        let trimmed = line.trim();
        if trimmed.starts_with('#') {
            // The path of a schema counts from the old file.
            let is_schema = trimmed.trim_start_matches(['#', ' ']).starts_with("yaml-language-server:");
            match begun {
                false if is_schema => {}
                false => head += &format!("{trimmed}\n"),
                true => above.push(trimmed.to_owned()),
            }
            continue;
        }
        if let Some(place) = walk.step(line) {
            begun = true;
            found.insert(place, Comments { above: std::mem::take(&mut above), beside: beside(line) });
        }
    }
    (head, found)
}

/// The comment at the end of a line.
fn beside(line: &str) -> Option<String> {
    let mut quote = None;
    let mut before = ' ';
    for (place, letter) in line.char_indices() {
        match (quote, letter) {
            (Some(open), _) if open == letter => quote = None,
            (None, '"' | '\'') => quote = Some(letter),
            (None, '#') if before == ' ' => return line.get(place..).map(|text| text.trim_end().to_owned()),
            _ => {}
        }
        before = letter;
    }
    None
}

/// The lines of a written text, each key with the lines that go on with it.
fn blocks(text: &str) -> Vec<(Place, Vec<&str>)> {
    let mut blocks: Vec<(Place, Vec<&str>)> = Vec::new();
    let mut walk = Walk::default();
    for line in text.lines() {
        match walk.step(line) {
            Some(place) => blocks.push((place, vec![line])),
            None => {
                if let Some((_, block)) = blocks.last_mut() {
                    block.push(line);
                }
            }
        }
    }
    blocks
}

/// A way through the lines of a file in block style.
#[derive(Default)]
struct Walk {
    /// The keys that the present line stands under, with their indents.
    open: Vec<(usize, (String, usize))>,
    counts: BTreeMap<Place, usize>,
}

impl Walk {
    /// The place of a line; nothing where it goes on with the one before: a parameter of a term, or further lines of a list.
    fn step(&mut self, line: &str) -> Option<Place> {
        /// Keys stand at most so deep: a section, a motion, its term.
        const DEEPEST: usize = 3;
        let inside = line.trim_start();
        let indent = line.len().saturating_sub(inside.len());
        let (item, named) = match inside.strip_prefix("- ") {
            Some(rest) => ("- ", rest),
            None => ("", inside),
        };
        let (key, _) = named.split_once(':')?;
        let word = |letter: char| letter.is_alphanumeric() || "_()\"-".contains(letter);
        if key.is_empty() || !key.chars().all(word) {
            return None;
        }
        self.open.retain(|(outer, _)| *outer < indent);
        if self.open.len() >= DEEPEST {
            return None;
        }
        let mut place: Place = self.open.iter().map(|(_, key)| key.clone()).collect();
        let key = format!("{item}{key}");
        let mut counted = place.clone();
        counted.push((key.clone(), 0));
        let count = self.counts.entry(counted).or_default();
        let own = (key, *count);
        *count = count.saturating_add(1);
        place.push(own.clone());
        self.open.push((indent, own));
        Some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OLD: &str = "# yaml-language-server: $schema=../x.json\n# By laser, in May.\ncalibration: 1 # first\n\
        # Offsets by gauge.\nconstants: {Xt: 0 mm} # \"Xt\" # too\nsource: \"a # b\"\nerrors:\n  # X by laser.\n  EXX:\n    \
        # Screw.\n    - table: {values: [1]}\n    - table: {values: [2]} # second\n  # Old.\n  EYX: 1 um # gone\n# The end.\n";

    #[test]
    fn comments_stay_with_their_lines() {
        let before = "calibration: 1\nconstants: {Xt: 0 mm}\nsource: \"a # b\"\nerrors:\n  EXX:\n    - table: {values: [0.001]}\n    - table: {values: [0.002]}\n  EYX: 0.001 mm\n";
        let new = before.replace("[0.002]}\n", "[0.002]}\n    - backlash: {lost_motion: 0.01 mm}\n");
        let new = new.replace("  EYX: 0.001 mm", "  EYX: 0.003 mm");
        let kept = kept(OLD, before, &new);
        assert_eq!(kept.head, "# By laser, in May.\n");
        assert_eq!(
            kept.text,
            "calibration: 1 # first\n# Offsets by gauge.\nconstants: {Xt: 0 mm} # \"Xt\" # too\nsource: \"a # b\"\nerrors:\n  \
             # X by laser.\n  EXX:\n    # Screw.\n    - table: {values: [0.001]}\n    - table: {values: [0.002]} # second\n    \
             - backlash: {lost_motion: 0.01 mm}\n  EYX: 0.003 mm\n",
            "what was said of a value that is another now is gone"
        );
    }

    #[test]
    fn lines_that_go_on_are_one_with_the_line_that_they_go_on_with() {
        let long = "errors:\n  EXX:\n    - table:\n        axis: X\n        values: [1, 2,\n          3]\n";
        let old = long.replace("- table:", "- table: # by laser");
        assert_eq!(kept(&old, long, long).text, old);
        let other = long.replace("3]", "4]");
        assert_eq!(kept(&old, long, &other).text, other);
    }
}
