//! `abbe explain`: every code and every term has a page, and what the pages say is so: the examples give their codes, the
//! mended ones do not, the forms of the terms are read, and the tables of the reference say the same.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use model_dsl::calibration::TERM_NAMES;
use model_dsl::calibration::factor::vocabulary::FACTORS;

use crate::cli::abbe;
use crate::machine_files::codes as codes_in;
use crate::shipped::root;
use crate::tidy::rust_files;

/// Settings of instruments that a diagnosis tells.
const SETTINGS: [&str; 6] = ["eccentricity", "radius", "cosine", "clock", "datum", "offset"];

/// Codes whose example would be too long for a page, or is no text.
const WITHOUT_EXAMPLE: [&str; 3] = ["E0003", "E0115", "E0921"];

fn page(name: &str) -> String {
    let run = abbe(&["explain", name], "");
    assert_eq!((run.status, run.err.as_str()), (0, ""), "{name}");
    run.out
}

/// The codes of the overview with their titles.
fn listed() -> BTreeMap<String, String> {
    let out = abbe(&["explain"], "").out;
    let rows = out.split("\nDiagnostics\n-----------\n\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let mut codes: Vec<(String, String)> = Vec::new();
    for row in rows.lines() {
        match row.split_once("  ").filter(|(code, _)| !code.is_empty()) {
            Some((code, title)) => codes.push((code.to_owned(), title.to_owned())),
            None => codes.last_mut().unwrap().1.push_str(&format!(" {}", row.trim())),
        }
    }
    codes.into_iter().collect()
}

/// The codes in the code of the program.
fn emitted() -> BTreeSet<String> {
    let mut codes = BTreeSet::new();
    for folder in [
        "model-dsl/src",
        "simulation/src",
        "recording/src",
        "diagnosis/src",
        "update/src",
        "exchange/src",
        "workshop/src",
        "fleet/src",
        "src",
    ] {
        for path in rust_files(&root().join(folder)) {
            let text = fs::read_to_string(&path).unwrap();
            // What stands in tests is no finding of the program.
            let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
            if path.components().any(|part| part.as_os_str() == "tests") || path.ends_with("tests.rs") {
                continue;
            }
            codes.extend(codes_in(text));
        }
    }
    codes
}

#[test]
fn every_code_that_can_be_given_is_explained_and_no_other() {
    let explained: BTreeSet<String> = listed().into_keys().collect();
    assert!(explained.len() > 100);
    assert_eq!(explained, emitted());
    for code in &explained {
        let text = page(code);
        let title = &listed()[code];
        assert!(text.starts_with(&format!("{code}: {title}\n\n")), "{text}");
        assert_eq!(text.contains("\nExample, as "), !WITHOUT_EXAMPLE.contains(&code.as_str()), "{text}");
        assert!(text.contains("\nCorrected\n---------\n\n"), "{text}");
        let meaning = text.lines().nth(2).unwrap();
        assert!(meaning.len() > 20, "{text}");
    }
}

#[test]
fn the_reference_lists_the_same_codes() {
    let reference = fs::read_to_string(root().join("docs/reference/diagnostics.md")).unwrap();
    let rows =
        reference.lines().filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |")?.split_once(" | "));
    let rows = rows.filter(|(code, _)| code.starts_with(['E', 'W']) && code.len() == 5);
    let table: BTreeMap<String, String> =
        rows.map(|(code, title)| (code.to_owned(), title.to_owned())).collect();
    assert_eq!(table, listed());
}

#[test]
fn every_term_has_a_page_with_the_words_of_the_reports() {
    let overview = abbe(&["explain"], "").out;
    for name in TERM_NAMES.into_iter().chain(SETTINGS) {
        assert!(overview.contains(&format!("\n{name} ")), "{name}: {overview}");
        let text = page(name);
        let plain = text.split_whitespace().collect::<Vec<_>>().join(" ");
        if let Some(meaning) = diagnosis::meaning(name) {
            assert!(plain.contains(meaning), "{text}");
        }
        let sections =
            ["Its value", "In a recording", "What looks the same", "How to measure it", "How to remove it"];
        for section in sections {
            let rest =
                text.split(&format!("\n{section}\n")).nth(1).unwrap_or_else(|| panic!("{section}: {text}"));
            assert!(rest.lines().nth(2).is_some_and(|line| !line.is_empty()), "{section}: {text}");
        }
        assert!(text.lines().all(|line| line.len() <= 100 || line.starts_with("    ")), "{text}");
    }
    let reference = fs::read_to_string(root().join("docs/reference/terms.md")).unwrap();
    let vocabulary: Vec<_> =
        reference.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`')).collect();
    assert!(TERM_NAMES.iter().all(|name| vocabulary.iter().any(|(known, _)| known == name)));
}

/// What a page names in backquotes as a term is one that has a page.
#[test]
fn pages_refer_to_pages() {
    for name in TERM_NAMES.into_iter().chain(SETTINGS) {
        let text = page(name);
        let also = text.split("What looks the same\n").nth(1).unwrap().split("\n\n").nth(1).unwrap();
        for word in also.split('`').skip(1).step_by(2) {
            let known = TERM_NAMES.contains(&word) || SETTINGS.contains(&word);
            assert!(known || ["actual", "wind_up", "inside_loop"].contains(&word), "{name} speaks of {word}");
        }
    }
}

#[test]
fn names_are_found_however_they_are_written() {
    assert_eq!(page("e0307"), page("E0307"));
    assert_eq!(page("Reversal_Spike"), page("reversal-spike"));
}

/// Every spelling of an error motion gives the page of the name that Abbe prints.
#[test]
fn error_motions_are_told_by_their_names() {
    for (names, title, unit) in [
        (["EX0C", "XOC", "EXOC", "x0c"], "EX0C: place of the axis of C in X", "a length, mm"),
        (["EA0C", "AOC", "EA(0Y)C", "EA(OZ)C"], "EA0C: tilt of the axis of C about X", "an angle, rad"),
        (
            ["EC0Y", "COY", "EC(0X)Y", "ecoy"],
            "EC0Y: alignment: line of motion of Y turned about Z",
            "an angle, rad",
        ),
        (["EXX", "exx", "EXX ", " EXX"], "EXX: positioning error of X", "a length, mm"),
    ] {
        for name in names {
            let page = page(name);
            assert!(page.starts_with(&format!("{title}\n")) && page.contains(unit), "{name}: {page}");
        }
    }
    assert!(
        page("EA(0Z)C").contains("EA(0Z)C, in the notation of ISO 230-1, is the same error counted from Z.")
    );
    for (name, told) in [
        ("EX0B", "EX(0C)B is the same place counted from C, if C carries B"),
        ("EX0C", "EX(0B)C is the same place counted from B, if B carries C"),
        ("EA(0X)C", "EA(0X)C is refused (E0146): X runs in that direction and cannot show it."),
        ("EX(0Y)C", "EX(0Y)C is refused (E0146): Y is a slide and has no place of its own."),
    ] {
        let page = page(name).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(page.contains(told), "{name}: {page}");
    }
    for name in ["EX0Y", "EQX", "EXQ", "EXX(0Y)", "E(0Y)C"] {
        assert_eq!(abbe(&["explain", name], "").status, 2, "{name}");
    }
}

#[test]
fn unknown_names_are_refused_with_those_nearby() {
    for (name, help) in [
        ("baklash", "did you mean `backlash`?"),
        ("E0199", "did you mean `E0109`, `E0119` or `E0129`?"),
        (
            "banana",
            "`abbe explain` without a name lists all codes and terms; it also explains error motions, topology words and the \
             words of the guide's glossary",
        ),
        ("squarness", "did you mean `Squareness`?"),
    ] {
        let run = abbe(&["explain", name], "");
        let told = format!("error: `abbe explain` does not know `{name}`\nhelp: {help}\n");
        assert_eq!((run.status, run.out.as_str(), run.err), (2, "", told));
    }
}

#[test]
fn every_word_of_the_glossary_is_explained_as_the_guide_has_it() {
    let glossary = fs::read_to_string(root().join("docs/guide/glossary.md")).unwrap();
    let plain = |text: &str| text.replace('*', "").split_whitespace().collect::<Vec<_>>().join(" ");
    let entries: Vec<&str> = glossary.split("\n\n").filter(|entry| entry.starts_with("**")).collect();
    assert!(entries.len() > 80);
    let overview = plain(abbe(&["explain"], "").out.split("\nWords of the glossary\n").nth(1).unwrap());
    for entry in entries {
        let (words, text) = entry.strip_prefix("**").unwrap().split_once("**: ").unwrap();
        assert!(overview.contains(words), "{words}");
        for word in words.split(", ") {
            for spelled in [word.to_owned(), word.to_lowercase().replace(' ', "-")] {
                assert!(plain(&page(&spelled)).contains(&plain(text)), "{spelled}");
            }
        }
    }
}

/// The order is that of a dictionary, in which a word is looked up.
#[test]
fn the_glossary_is_in_order() {
    let glossary = fs::read_to_string(root().join("docs/guide/glossary.md")).unwrap();
    let heads = glossary.split("\n\n").filter_map(|entry| entry.strip_prefix("**")?.split(['*', ',']).next());
    let words: Vec<String> = heads.map(|word| word.to_lowercase().replace('-', " ")).collect();
    assert!(words.is_sorted(), "{words:#?}");
}

#[test]
fn a_word_of_the_trade_is_known_in_its_plural_too() {
    for (word, title) in [
        ("gantry", "Gantry: a word of the glossary"),
        ("error motions", "Error motion: a word of the glossary"),
        ("rams", "Quill, ram: a word of the glossary"),
        ("racking", "Racking: a word of the glossary"),
        (
            "not-repeatable",
            "Verdict, undecided, adequate, left-out physics, unexplained, not repeatable: a word",
        ),
    ] {
        assert!(page(word).starts_with(title), "{word}");
    }
}

#[test]
fn topology_words_are_told_by_what_carries_what() {
    for (word, told) in [
        (
            "XYFZ",
            "X carries the part, Y carries X, the bed carries Y. Z carries the tool, the bed carries Z.",
        ),
        ("xyfz", "part - X - Y - bed - Z - tool"),
        (
            "FXYZ",
            "No axis carries the part: it is fixed to the bed. Z carries the tool, Y carries Z, X carries Y, the bed carries X.",
        ),
        ("FX", "Its 6 error motions: EXX, EYX, EZX, EAX, EBX, ECX."),
    ] {
        let page = page(word).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(page.contains(told), "{word}: {page}");
    }
    assert_eq!(abbe(&["explain", "XXFZ"], "").status, 2);
}

/// A folder of the test's own with the files that the examples speak of.
fn bench(code: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("explain").join(code);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("known.yaml", &complete("calibration", "errors: {EXX: 3 um}"));
    let warm = "errors: {EXX: [{backlash: {lost_motion: 5 um}}, {growth: {sensor: motor, coefficient: 1 um/K, reference: 20 degC}}]}";
    write("warm.yaml", &complete("calibration", warm));
    let rows = "t,n,xc,yc,xm,dev,T\n0,1,0,0,0,1,20\n1,1,1,0,1,2,20\n2,3,2,0,2,1,20\n3,3,1,1,1,0,20\n";
    write("data.csv", rows);
    // Measured once more, with a last row of its own.
    write("first.yaml", &complete("recording", "data: first.csv\n"));
    write("first.csv", &rows.replace("3,3,1,1,1,0", "3,3,1,1,1.001,0"));
    let table = |head: &str, unit: &str, rows: &str| format!("{head}\n{unit}{rows}");
    write("x.csv", &table("target,deviation,angle", "#unit,mm,um,urad\n", "0,1,0\n100,2,3\n200,4,1\n"));
    write("two.csv", &table("target,deviation", "#unit,mm,um\n", "0,1\n100,2\n"));
    write("bare.csv", &table("target,deviation", "", "0,1\n100,2\n200,4\n"));
    let sorted = "1,0,1\n1,100,2\n2,0,1\n2,100,2\n";
    write("sorted.csv", &table("run,target,deviation", "#unit,,mm,um\n", sorted));
    write("laser.yaml", &complete("set-up", "measurements: [{motion: EXX, data: x.rtl}]"));
    let saved = "setup: 1\nmachine: XYFZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\ncorrections: [{data: saved.txt, axis: X, type: 1}]\n";
    write("saved.yaml", saved);
    let tilting = "abbe: 1\nname: tilting\nsensitive: [X, Z]\nchain:\n  workpiece:\n    - {rotary: A, along: +A}\n  tool:\n    - {slide: X, along: +X}\n    - {slide: Z, along: +Z}\n    - {tool: tip}\n";
    write("tilting.yaml", tilting);
    let parallel = "abbe: 1\nname: parallel\nchain:\n  tool:\n    - {slide: X, along: +X}\n    - {slide: U, along: +X}\n    - {tool: tip}\n";
    write("parallel.yaml", parallel);
    let crossed = "abbe: 1\nname: crossed\ntopology: FXYZ\ntransmission: {A: X + Y, B: X - Y}\n";
    write("crossed.yaml", crossed);
    write("parallel-known.yaml", "calibration: 1\nmachine: parallel.yaml\n");
    folder
}

/// A part of a file with the rest that every such file has: the keys that the part does not give.
pub(crate) fn complete(kind: &str, part: &str) -> String {
    let rest: &[&str] = match kind {
        "machine" => &["abbe: 1", "name: mill", "topology: XYFZ"],
        "calibration" => &["calibration: 1", "machine: XYFZ", "constants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}"],
        "recording" => &[
            "recording: 1",
            "machine: XYFZ",
            "instrument: position",
            "data: data.csv",
            "channels: {time: {column: t, unit: s}, command.x: {column: xc, unit: mm}, measured.x: {column: xm, unit: mm}}",
        ],
        "path" => &[
            "path: 1",
            "line: {axis: X, from: 0 mm, to: 100 mm}",
            "feed: 600 mm/min",
            "rate: 20 Hz",
            "instrument: position",
            "temperatures: {motor: {start: 20 degC}}",
        ],
        "set-up" => &[
            "setup: 1",
            "machine: XYFZ",
            "constants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}",
            "measurements: [{motion: EXX, data: x.csv}]",
        ],
        "fleet" => &["fleet: 1", "machines: {mill-07: {recordings: \"*.yaml\"}}"],
        _ => &[],
    };
    let keys: BTreeSet<&str> =
        part.lines().filter_map(|line| line.split_once(':')).map(|(key, _)| key).collect();
    // A part with a shape or a chain of its own needs none of the usual.
    let given = |others: &[&str]| others.iter().any(|key| keys.contains(key));
    let needed = |line: &&&str| match line.split(':').next().unwrap() {
        "line" => !given(&["line", "circle", "diamond", "grid", "spiral", "still"]),
        "topology" => !given(&["topology", "chain"]),
        key => !keys.contains(key),
    };
    let mut text: String = rest.iter().filter(needed).map(|line| format!("{line}\n")).collect();
    text.push_str(part);
    text.push('\n');
    text
}

/// The kind of an example, whether it is a part, and its two forms.
pub(crate) struct Example {
    /// `machine`, `calibration`, ...
    pub(crate) kind: String,
    part: bool,
    more: String,
    wrong: String,
    mended: String,
}

impl Example {
    /// The faulty file and the mended one, whole.
    pub(crate) fn files(&self) -> [String; 2] {
        [&self.wrong, &self.mended]
            .map(|text| if self.part { complete(&self.kind, text) } else { text.clone() })
    }
}

/// The lines of the first indented block.
fn block(text: &str) -> String {
    let lines = text.lines().skip_while(|line| !line.starts_with("    "));
    let lines = lines.take_while(|line| line.starts_with("    "));
    lines.map(|line| format!("{}\n", &line[4..])).collect()
}

/// The example of a code, as its page shows it.
pub(crate) fn example(code: &str) -> Option<Example> {
    let text = page(code);
    let (_, rest) = text.split_once("\nExample, as ")?;
    let (wrong, mended) = rest.split_once("\nCorrected\n").unwrap();
    let heading = rest.lines().next().unwrap();
    let (heading, more) = heading.split_once(", ").unwrap_or((heading, ""));
    let (part, file) = match heading.strip_prefix("part of a ") {
        Some(file) => (true, file),
        None => (false, heading.strip_prefix("a whole ").unwrap()),
    };
    Some(Example {
        kind: file.split(' ').next().unwrap().to_owned(),
        part,
        more: more.to_owned(),
        wrong: block(wrong),
        mended: block(mended),
    })
}

/// Every code that has an example, with it.
pub(crate) fn examples() -> Vec<(String, Example)> {
    listed().into_keys().filter_map(|code| example(&code).map(|example| (code, example))).collect()
}

/// What the program says of an example on standard error.
fn said(code: &str, folder: &Path, example: &Example, text: &str) -> String {
    let path = folder.join("example.yaml");
    fs::write(&path, text).unwrap();
    let (path, at) = (path.to_str().unwrap(), |name: &str| folder.join(name).to_str().unwrap().to_owned());
    let (first, warm, parallel, output) =
        (at("first.yaml"), at("warm.yaml"), at("parallel-known.yaml"), at("out"));
    let run = match (example.kind.as_str(), example.more.as_str()) {
        ("machine", _) => abbe(&["derive", path], ""),
        ("calibration", _) if code == "E0425" => abbe(&["compensate", path], "x,y,z\n"),
        ("calibration", _) => abbe(&["compensate", "--leave-out-uncompensable", path], "x,y,z\n"),
        ("equation", _) => abbe(&["check", "excello-921", path], ""),
        ("recording", "given second") => abbe(&["diagnose", &first, path], ""),
        ("recording", "for an update") => abbe(&["update", &warm, path], ""),
        ("recording", _) => abbe(&["diagnose", path], ""),
        ("set-up", _) => abbe(&["calibrate", path], ""),
        ("fleet", _) => abbe(&["fleet", "run", "--list", path], ""),
        ("measurement", _) => {
            fs::write(folder.join("x.rtl"), text).unwrap();
            abbe(&["calibrate", &at("laser.yaml")], "")
        }
        ("correction", _) => {
            fs::write(folder.join("saved.txt"), text).unwrap();
            abbe(&["calibrate", &at("saved.yaml")], "")
        }
        ("file", _) => {
            let ranges = ["X=0:500", "Y=0:300", "Z=0:200"].map(|range| ["--range", range]).concat();
            abbe(&[&["export", "isg", &at("known.yaml"), "--check", path][..], &ranges].concat(), "")
        }
        ("path", "with a slide U") => {
            abbe(&["simulate", &parallel, path, "--output", &output, "--force"], "")
        }
        ("path", _) => abbe(&["simulate", &warm, path, "--output", &output, "--force"], ""),
        (kind, more) => panic!("no command for {kind}, {more}"),
    };
    run.err
}

/// What the program says of a file of a form on standard error.
pub(crate) fn told(form: &str, text: &str) -> String {
    let folder = bench("told");
    let example = Example {
        kind: form.to_owned(),
        part: false,
        more: String::new(),
        wrong: String::new(),
        mended: String::new(),
    };
    said("", &folder, &example, text)
}

#[test]
fn every_example_gives_its_code_and_its_mended_form_none() {
    let mut untrue = Vec::new();
    for (code, example) in examples() {
        let folder = bench(&code);
        let [wrong, mended] = example.files();
        let told = said(&code, &folder, &example, &wrong);
        if !told.contains(&format!("[{code}]")) {
            untrue.push(format!("{code} is not given by\n{wrong}\nbut\n{told}"));
        }
        let told = said(&code, &folder, &example, &mended);
        if told.contains("error[") || told.contains("warning[") {
            untrue.push(format!("{code} mended:\n{mended}\ngives\n{told}"));
        }
    }
    assert!(untrue.is_empty(), "{}", untrue.join("\n-----\n"));
}

#[test]
fn the_forms_of_the_terms_are_read_and_compensation_is_as_the_pages_say() {
    let folder = bench("terms");
    for name in TERM_NAMES {
        let text = page(name);
        let form = block(text.split("In a calibration file, under `errors`").nth(1).unwrap());
        for line in form.lines() {
            let path = folder.join("term.yaml");
            fs::write(&path, complete("calibration", &format!("errors:\n  {line}"))).unwrap();
            let run = abbe(&["compensate", path.to_str().unwrap()], "t,x,y,z\n");
            let plain = text.split_whitespace().collect::<Vec<_>>().join(" ");
            let refused = run.err.contains("error[E0425]");
            assert_eq!(refused, plain.contains("cannot compensate it in real time"), "{name}: {}", run.err);
            assert_eq!(refused, !plain.contains("can compensate it in real time"), "{name}");
            assert_eq!(run.err.matches("error[").count(), usize::from(refused), "{name}: {}", run.err);
        }
    }
}

#[test]
fn every_factor_has_a_page_whose_form_is_read() {
    let folder = bench("factors");
    let overview = abbe(&["explain"], "").out;
    for entry in &FACTORS {
        let name = entry.name;
        assert!(overview.contains(&format!("\n{name} ")), "{name}: {overview}");
        let text = page(name);
        let text = text.split(&format!("{name}: a factor of a term\n")).nth(1).unwrap();
        let plain = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(plain.contains(entry.physics) && plain.contains(entry.value), "{text}");
        assert!(text.lines().all(|line| line.len() <= 100 || line.starts_with("    ")), "{text}");
        let form = block(text.split("In a calibration file, under `errors`").nth(1).unwrap());
        assert!(form.contains(&format!("{{{name}: ")), "{form}");
        let path = folder.join("factor.yaml");
        fs::write(&path, complete("calibration", &format!("errors:\n  {form}"))).unwrap();
        let run = abbe(&["compensate", path.to_str().unwrap()], "t,x,y,z\n");
        let refused = run.err.contains("error[E0425]");
        assert_eq!(refused, entry.not_compensable.is_some(), "{name}: {}", run.err);
        assert_eq!(run.err.matches("error[").count(), usize::from(refused), "{name}: {}", run.err);
    }
}

#[test]
fn the_forms_of_simulated_instruments_are_driven() {
    let folder = bench("settings");
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    for name in SETTINGS {
        let form = block(page(name).split("In a path file").nth(1).unwrap());
        let circle = if form.contains("ballbar") { "circle: {plane: XY, radius: 50 mm}\n" } else { "" };
        fs::write(at("setting.yaml"), complete("path", &format!("{circle}{form}"))).unwrap();
        let run =
            abbe(&["simulate", &at("warm.yaml"), &at("setting.yaml"), "--output", &at("out"), "--force"], "");
        assert_eq!((run.status, run.err.contains("error")), (0, false), "{name}: {}", run.err);
    }
}
