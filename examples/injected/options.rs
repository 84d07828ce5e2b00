//! What the command line asks for. In: its words. Out: options, or what is wrong with them.

use std::path::PathBuf;
use std::str::FromStr;

use limits::injection::kind::Kind;

/// How the tables are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    Plain,
    Markdown,
    Json,
}

/// The options.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Options {
    /// Where the recordings are.
    pub(crate) folder: PathBuf,
    pub(crate) seed: u64,
    /// Largest values of effects over what a straight line leaves.
    pub(crate) sizes: Vec<f64>,
    /// The kinds that are injected.
    pub(crate) kinds: Vec<String>,
    /// A word in the names of the recordings that are taken.
    pub(crate) only: Option<String>,
    /// How many cases are drawn of all.
    pub(crate) most: usize,
    pub(crate) form: Form,
}

impl Options {
    /// Reads the words of the command line.
    pub(crate) fn read(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self {
            folder: PathBuf::new(),
            seed: 1,
            sizes: vec![0.5, 1.0, 3.0],
            kinds: Kind::names().map(str::to_owned).to_vec(),
            only: None,
            most: usize::MAX,
            form: Form::Plain,
        };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value"));
            match word.as_str() {
                "--markdown" => options.form = Form::Markdown,
                "--json" => options.form = Form::Json,
                "--seed" => options.seed = number(&word, &value()?)?,
                "--most" => options.most = number(&word, &value()?)?,
                "--only" => options.only = Some(value()?),
                "--sizes" => {
                    options.sizes =
                        value()?.split(',').map(|size| number(&word, size)).collect::<Result<_, _>>()?
                }
                "--kinds" => options.kinds = kinds(&value()?)?,
                _ if !word.starts_with('-') && options.folder.as_os_str().is_empty() => {
                    options.folder = PathBuf::from(word);
                }
                _ => return Err(format!("{word} is not understood; see the head of the example's main.rs")),
            }
        }
        match options.folder.is_dir() {
            true => Ok(options),
            false => Err("name a folder of recordings".to_owned()),
        }
    }

    /// Whether a kind is injected.
    pub(crate) fn wants(&self, kind: &str) -> bool {
        self.kinds.iter().any(|own| own == kind)
    }
}

fn number<T: FromStr>(word: &str, value: &str) -> Result<T, String>
where
    T::Err: std::fmt::Display,
{
    value.trim().parse().map_err(|error| format!("{word} {value}: {error}"))
}

fn kinds(list: &str) -> Result<Vec<String>, String> {
    let known = |kind: &str| match Kind::of_name(kind).is_some() {
        true => Ok(kind.to_owned()),
        false => Err(format!("no kind `{kind}`; there are {}", Kind::names().join(", "))),
    };
    list.split(',').map(str::trim).map(known).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(words: &[&str]) -> Result<Options, String> {
        Options::read(words.iter().map(|word| (*word).to_owned()))
    }

    #[test]
    fn words_are_read_and_wrong_ones_are_told() {
        let options = read(&["recordings", "--sizes", "1,3", "--kinds", "lag, drift", "--json"]).unwrap();
        assert_eq!((options.sizes.as_slice(), options.form), ([1.0, 3.0].as_slice(), Form::Json));
        assert!(options.wants("lag") && !options.wants("backlash"));
        for wrong in [&["recordings", "--kinds", "bump"][..], &["--seed"], &["recordings", "--what"], &[]] {
            assert!(read(wrong).is_err(), "{wrong:?}");
        }
    }
}
