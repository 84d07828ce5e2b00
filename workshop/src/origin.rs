//! Where a page comes from. In: the recordings of a diagnosis. Out: the command that makes its page again.

use std::path::Path;

/// The command that diagnoses recordings, as a shell takes it.
pub fn diagnose<'p>(recordings: impl IntoIterator<Item = &'p Path>, held_out: Option<&Path>) -> String {
    let mut words = vec!["abbe".to_owned(), "diagnose".to_owned()];
    words.extend(recordings.into_iter().map(word));
    if let Some(path) = held_out {
        words.extend(["--holdout".to_owned(), word(path)]);
    }
    words.join(" ") + " --format html > diagnosis.html"
}

/// The command that evaluates a recording.
pub fn evaluate(recording: &Path) -> String {
    format!("abbe evaluate {} --format html > evaluation.html", word(recording))
}

/// A path as one word: in quotes where a shell would take it apart.
pub fn word(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |letter: char| letter.is_alphanumeric() || "/._-+=:,@%".contains(letter);
    if !text.is_empty() && text.chars().all(plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_takes_every_path_as_one_word() {
        let recordings = ["a/b.yaml", "my circle's.yaml"].map(Path::new);
        assert_eq!(
            diagnose(recordings, Some(Path::new("$(x).yaml"))),
            "abbe diagnose a/b.yaml 'my circle'\\''s.yaml' --holdout '$(x).yaml' --format html > diagnosis.html"
        );
    }
}
