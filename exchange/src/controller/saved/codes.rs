//! Commands of printers' firmware in a file or a captured answer: `M852`, `M556`, `M421`, `G29`. In: lines. Out: commands with
//! their letters.

use model_dsl::source::SourceFile;

use crate::controller::lines::{Line, lines};

/// A command and its letters, each with what stands behind it.
pub(in crate::controller) struct Command<'s> {
    /// The whole line.
    pub(in crate::controller) line: Line<'s>,
    /// The command: `M852`.
    pub(in crate::controller) code: &'s str,
    letters: Vec<(char, Line<'s>)>,
}

impl<'s> Command<'s> {
    /// What stands behind a letter.
    pub(super) fn after(&self, letter: char) -> Option<Line<'s>> {
        self.letters.iter().find(|(known, _)| *known == letter).map(|(_, line)| *line)
    }
}

/// Whether a text has a command with numbers of a correction.
pub(super) fn is_here(text: &str) -> bool {
    let source = SourceFile::new("", text);
    commands(&source).any(|command| match command.code {
        "M852" | "M556" | "M421" => true,
        _ => is_mesh_point(&command),
    })
}

/// `G29 W I J Z`, as `M503` of a bilinear mesh answers, or `G29 S3 I J Z`.
pub(super) fn is_mesh_point(command: &Command<'_>) -> bool {
    let sets = command.after('W').is_some() || command.after('S').is_some_and(|line| line.text == "3");
    command.code == "G29" && sets && command.after('Z').is_some()
}

/// The commands of a file. What a terminal puts before them (`Recv:`, `echo:`) is left out, and so are comments.
pub(in crate::controller) fn commands(source: &SourceFile) -> impl Iterator<Item = Command<'_>> {
    lines(source, ";").filter_map(|line| {
        let words: Vec<Line<'_>> = line.words().collect();
        let begin = words.iter().position(|word| is_code(code_of(word.text)))?;
        let (code, rest) = words.get(begin..)?.split_first()?;
        let letters = rest.iter().filter_map(|word| {
            let letter = word.text.chars().next().filter(char::is_ascii_uppercase)?;
            Some((letter, word.part(word.text.get(1..)?)))
        });
        Some(Command { line, code: code_of(code.text), letters: letters.collect() })
    })
}

/// A word without what a terminal puts before it.
fn code_of(word: &str) -> &str {
    word.rsplit(':').next().unwrap_or(word)
}

fn is_code(word: &str) -> bool {
    let number = word.strip_prefix(['G', 'M']);
    number.is_some_and(|number| !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit()))
}
