//! What the command line asks for. In: its words. Out: options, or what is wrong with them.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use limits::injection::kind::Kind;

/// How the tables are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    Plain,
    Markdown,
    Json,
}

/// Injects known effects into recordings of real machines, and counts how many of them the diagnosis finds.
#[derive(Clone, Debug, PartialEq, clap::Parser)]
pub(crate) struct Options {
    /// Folder with one subfolder per recording, each with `recording.yaml` and its table
    #[arg(value_parser = folder)]
    pub(crate) folder: PathBuf,
    /// Seed of the cases: the same seed gives the same cases
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Sizes of the injected effects: peak over the residual of a straight line
    #[arg(long, value_delimiter = ',', default_value = "0.5,1,3")]
    pub(crate) sizes: Vec<f64>,
    /// Kinds of effect to inject; all by default
    #[arg(long, value_delimiter = ',', default_values = Kind::names(), hide_default_value = true,
        value_parser = PossibleValuesParser::new(Kind::names()))]
    pub(crate) kinds: Vec<String>,
    /// Use only recordings whose name contains this word
    #[arg(long, value_name = "WORD")]
    pub(crate) only: Option<String>,
    /// Run at most this number of cases, drawn at random
    #[arg(long, value_name = "CASES", default_value_t = usize::MAX, hide_default_value = true)]
    pub(crate) most: usize,
    /// Print tables in Markdown
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Options {
    /// How the tables are printed.
    pub(crate) fn form(&self) -> Form {
        match (self.markdown, self.json) {
            (_, true) => Form::Json,
            (true, _) => Form::Markdown,
            _ => Form::Plain,
        }
    }

    /// Whether a kind is injected.
    pub(crate) fn wants(&self, kind: &str) -> bool {
        self.kinds.iter().any(|own| own == kind)
    }
}

fn folder(name: &str) -> Result<PathBuf, String> {
    let folder = PathBuf::from(name);
    if folder.is_dir() { Ok(folder) } else { Err("not a folder".to_owned()) }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    fn read(words: &[&str]) -> Result<Options, clap::Error> {
        Options::try_parse_from(std::iter::once(&"injected").chain(words))
    }

    #[test]
    fn words_are_read_and_wrong_ones_are_told() {
        let options = read(&["recordings", "--sizes", "1,3", "--kinds", "lag,drift", "--json"]).unwrap();
        assert_eq!((options.sizes.as_slice(), options.form()), ([1.0, 3.0].as_slice(), Form::Json));
        assert!(options.wants("lag") && !options.wants("backlash"));
        for wrong in [
            &["recordings", "--kinds", "bump"][..],
            &["--seed"],
            &["recordings", "--what"],
            &[],
            &["nowhere"],
        ] {
            assert!(read(wrong).is_err(), "{wrong:?}");
        }
    }
}
