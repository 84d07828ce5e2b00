//! The fleet file. In: its text. Out: the machines of a fleet, and where their recordings and the results are; or every mistake, located.

use std::path::{Path, PathBuf};

use glob::Pattern as Glob;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::fields::{self, Fields, Wording};
use model_dsl::kind::another_kind;
use model_dsl::source::{SourceFile, Span, Spanned};
use model_dsl::yaml::{self, Node};
use workshop::failure::Failure;
use workshop::load;
use workshop::told::{Listener, Words};

use crate::time::Pattern;

/// A fleet.
#[derive(Clone, Debug)]
pub struct Fleet {
    /// The folder of its file, from which all paths are counted.
    pub folder: PathBuf,
    /// The folder of the results.
    pub results: PathBuf,
    /// Its machines, in the order of the file.
    pub machines: Vec<Machine>,
}

/// A machine of the fleet.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Its name in the fleet.
    pub name: String,
    /// What kind it is: machines of one kind are compared.
    pub kind: Option<String>,
    /// Which files are its recordings: paths from the fleet's folder, in which `*` stands for any letters and `**` for any folders.
    pub recordings: Vec<String>,
    /// How file names tell when a recording was made.
    pub time: Option<Pattern>,
}

const KEYS: [&str; 3] = ["fleet", "results", "machines"];
const OF_MACHINE: [&str; 3] = ["kind", "recordings", "time"];

/// The code for a value of the wrong form.
const FORM: &str = "E1004";

/// Where the results are, if the file does not say.
const RESULTS: &str = "results";

/// The longest name of a machine, since file systems take 255 bytes for a folder and each may become three in its name.
const LONGEST_NAME: usize = 80;

/// Reads a fleet file.
pub fn read(path: &Path, listener: &dyn Listener) -> Result<Fleet, Failure> {
    let source = load::read(path)?;
    let mut diagnostics = Diagnostics::new();
    match of(&source, path.parent().unwrap_or(Path::new("")), &mut diagnostics) {
        Some(fleet) => {
            listener.hear(&Words::marked(&source, &diagnostics));
            Ok(fleet)
        }
        None => Err(Failure::marked(&source, &diagnostics)),
    }
}

/// Reads the text of a fleet file that is in a folder; nothing where there is an error among what is found.
pub fn of(source: &SourceFile, folder: &Path, diagnostics: &mut Diagnostics) -> Option<Fleet> {
    let root = yaml::read(source, diagnostics)?;
    read_all(&root, folder, diagnostics).filter(|_| !diagnostics.has_errors())
}

fn keys(what: &str) -> Wording<'_> {
    Wording { what, noun: "key", unknown: "E1003", missing: "E1001", form: FORM }
}

fn read_all(root: &Node, folder: &Path, diagnostics: &mut Diagnostics) -> Option<Fleet> {
    let first = root.entries().and_then(<[_]>::first).map_or(root.span, |(key, _)| key.span);
    if let Some(kind) = another_kind(root, "fleet") {
        let mistake = Diagnostic::error("E1002", first, format!("this is {kind}, not a fleet file"));
        let help = "begin with `fleet: 1`, and say where the recordings of each machine are";
        diagnostics.push(mistake.help(help));
        return None;
    }
    let wording = keys("a fleet");
    let fields = Fields::open(root, first, wording, &KEYS, diagnostics)?;
    if let Some(version) = fields.need("fleet", wording, diagnostics).filter(|node| node.text() != Some("1"))
    {
        let message = format!(
            "version {} of the fleet format is unknown",
            version.text().unwrap_or(version.kind_name())
        );
        diagnostics.push(Diagnostic::error("E1002", version.span, message).help("write `fleet: 1`"));
    }
    let results = fields.get("results").and_then(|node| fields::word(node, "`results`", FORM, diagnostics));
    let results = folder.join(results.map_or(RESULTS, |name| name.value));
    let machines = fields.need("machines", wording, diagnostics)?;
    let Some(entries) = machines.entries().filter(|entries| !entries.is_empty()) else {
        let message = match machines.entries() {
            Some(_) => "`machines` names no machine".to_owned(),
            None => {
                format!("`machines` must be a mapping of names to machines, found {}", machines.kind_name())
            }
        };
        let help = "write one line such as `mill-07: {recordings: \"mill-07/*.yaml\"}` for each machine";
        diagnostics.push(Diagnostic::error(FORM, machines.span, message).help(help));
        return None;
    };
    let machines = entries.iter().filter_map(|(name, node)| machine(name, node, diagnostics)).collect();
    Some(Fleet { folder: folder.to_owned(), results, machines })
}

fn machine(name: &Spanned<String>, node: &Node, diagnostics: &mut Diagnostics) -> Option<Machine> {
    let what = format!("the machine `{}`", name.value);
    if name.value.trim().is_empty()
        || name.value.len() > LONGEST_NAME
        || name.value.chars().any(char::is_control)
    {
        let message = format!("the name of a machine must have 1 to {LONGEST_NAME} characters on one line");
        diagnostics.push(
            Diagnostic::error("E1005", name.span, message)
                .help("write the name used in the shop, such as `mill-07`"),
        );
    }
    let wording = keys(&what);
    let fields = Fields::open(node, name.span, wording, &OF_MACHINE, diagnostics)?;
    let kind = fields.get("kind").and_then(|node| fields::word(node, "`kind`", FORM, diagnostics));
    let recordings = fields.need("recordings", wording, diagnostics)?;
    let globs = match recordings.items() {
        Some([]) => {
            let mistake = Diagnostic::error(FORM, recordings.span, "`recordings` names no file");
            diagnostics.push(mistake.help("write `recordings: \"mill-07/*.yaml\"`"));
            Vec::new()
        }
        Some(items) => items.iter().filter_map(|item| glob(item, diagnostics)).collect(),
        None => glob(recordings, diagnostics).into_iter().collect(),
    };
    let time = fields.get("time").and_then(|node| {
        let text = fields::word(node, "`time`", FORM, diagnostics)?;
        Pattern::read(text.value).map_err(|why| diagnostics.push(no_pattern(text.span, &why))).ok()
    });
    Some(Machine {
        name: name.value.clone(),
        kind: kind.map(|kind| kind.value.to_owned()),
        recordings: globs,
        time,
    })
}

fn no_pattern(span: Span, why: &str) -> Diagnostic {
    let mistake = Diagnostic::error("E1006", span, format!("`time` is not a pattern of a date: {why}"));
    mistake.help("write `YYYY-MM-DD` or `YYYY-MM-DD_hhmmss`, as in the names of the files")
}

fn glob(node: &Node, diagnostics: &mut Diagnostics) -> Option<String> {
    let text = fields::word(node, "a path in `recordings`", FORM, diagnostics)?;
    if let Err(error) = Glob::new(text.value) {
        let message = format!("`{}` is not a pattern of files: {}", text.value, error.msg);
        let help = "use `*` for any characters of a name, and `**` alone between slashes for any folders";
        diagnostics.push(Diagnostic::error("E1007", text.span, message).help(help));
        return None;
    }
    Some(text.value.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fleet(text: &str) -> Result<Fleet, Vec<(&'static str, String)>> {
        let source = SourceFile::new("fleet.yaml", text);
        let mut diagnostics = Diagnostics::new();
        let fleet = of(&source, Path::new("shop"), &mut diagnostics);
        let marked =
            |one: &Diagnostic| (one.code, text.get(one.span.start..one.span.end).unwrap_or("").to_owned());
        let mistakes: Vec<_> = diagnostics.iter().map(marked).collect();
        fleet.filter(|_| mistakes.is_empty()).ok_or(mistakes)
    }

    #[test]
    fn a_fleet_says_where_everything_is() {
        let text = "fleet: 1\nmachines:\n  a: {recordings: \"a/*.yaml\"}\n  b: {kind: XYFZ, recordings: [x.yaml, \"**/y.yaml\"], time: YYYY-MM-DD}\n";
        let fleet = fleet(text).unwrap();
        assert_eq!(fleet.results, Path::new("shop/results"));
        let names: Vec<_> = fleet.machines.iter().map(|machine| machine.name.as_str()).collect();
        assert_eq!(names, ["a", "b"]);
        assert_eq!(fleet.machines[1].recordings, ["x.yaml", "**/y.yaml"]);
        assert_eq!(
            (fleet.machines[0].kind.as_deref(), fleet.machines[1].kind.as_deref()),
            (None, Some("XYFZ"))
        );
    }

    #[test]
    fn mistakes_are_located() {
        let refused = [
            ("fleet: 1\n", "E1001", "fleet"),
            ("fleet: 2\nmachines: {a: {recordings: x}}\n", "E1002", "2"),
            ("recording: 1\n", "E1002", "recording"),
            ("fleet: 1\nmachine: {}\nmachines: {a: {recordings: x}}\n", "E1003", "machine"),
            ("fleet: 1\nmachines: {}\n", "E1004", "{}"),
            ("fleet: 1\nmachines: {a: {}}\n", "E1001", "a"),
            ("fleet: 1\nmachines: {a: {recordings: []}}\n", "E1004", "[]"),
            ("fleet: 1\nmachines: {\" \": {recordings: x}}\n", "E1005", "\" \""),
            ("fleet: 1\nmachines: {a: {recordings: x, time: YYYY}}\n", "E1006", "YYYY"),
            ("fleet: 1\nmachines: {a: {recordings: \"a**b\"}}\n", "E1007", "\"a**b\""),
        ];
        for (text, code, at) in refused {
            assert_eq!(fleet(text).unwrap_err(), [(code, at.to_owned())], "{text}");
        }
    }

    #[test]
    fn files_that_are_cut_or_broken_end_in_findings_within_them() {
        let whole = "fleet: 1\nresults: out\nmachines:\n  a: {kind: k, recordings: [\"a/*.yaml\", '[x]/**/b'], time: YYYY-MM-DD}\n";
        let letters = ["", "\0", "\u{e9}", "[", "*", "**", ":", "{", "\"", "\n", "\t", "YYYY"];
        for (place, _) in whole.char_indices() {
            for letter in letters {
                let (before, after) = whole.split_at(place);
                let after = after.get(1..).unwrap_or_default();
                for text in [format!("{before}{letter}"), format!("{before}{letter}{after}")] {
                    let source = SourceFile::new("fleet.yaml", &text);
                    let mut diagnostics = Diagnostics::new();
                    let fleet = of(&source, Path::new(""), &mut diagnostics);
                    assert!(fleet.is_some() || diagnostics.has_errors(), "{text}");
                    let within = |one: &Diagnostic| text.get(one.span.start..one.span.end).is_some();
                    assert!(diagnostics.iter().all(within), "{text}");
                }
            }
        }
    }
}
