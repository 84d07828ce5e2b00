//! Where a page comes from. In: the arguments of a diagnosis. Out: the command that makes its page again.

use std::path::Path;

use crate::arguments::Diagnose;

/// The command, as a shell takes it.
pub(super) fn command(arguments: &Diagnose) -> String {
    let mut words = vec!["abbe".to_owned(), "diagnose".to_owned()];
    words.extend(arguments.recordings.iter().map(|path| word(path)));
    if let Some(path) = &arguments.holdout {
        words.extend(["--holdout".to_owned(), word(path)]);
    }
    words.join(" ") + " --format html > diagnosis.html"
}

/// A path as one word: in quotes where a shell would take it apart.
pub(in crate::commands) fn word(path: &Path) -> String {
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
    use std::path::PathBuf;

    use super::command;
    use crate::arguments::{Diagnose, ReportFormat};
    use crate::target::Target;

    #[test]
    fn a_shell_takes_every_path_as_one_word() {
        let arguments = Diagnose {
            recordings: ["a/b.yaml", "my circle's.yaml"].map(PathBuf::from).to_vec(),
            format: ReportFormat::Html,
            write_calibration: None,
            holdout: Some(PathBuf::from("$(x).yaml")),
            quiet: true,
            fail_on: Vec::new(),
            target: Target::default(),
        };
        assert_eq!(
            command(&arguments),
            "abbe diagnose a/b.yaml 'my circle'\\''s.yaml' --holdout '$(x).yaml' --format html > diagnosis.html"
        );
    }
}
