//! One table of terms: the schemas and the reference say what it says, and no other source names a term.
//!
//! In: the vocabulary of the compiler, the schemas, the reference, all sources. Out: where one of them says more or less. Who adds
//! a term writes it into the table and beside the formulas that evaluate it; these tests tell which pages lack it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use model_dsl::calibration::factor::vocabulary::{FACTORS, FactorHolds, FactorKey, Measure};
use model_dsl::calibration::vocabulary::{
    Base, Entry, Form, Given, Holds, Key, Kind, Role, TIMES, VOCABULARY,
};
use serde_json::Value;

use crate::shipped::root;
use crate::tidy::rust_files;

/// The table, and the type of terms with their numbers beside it.
const TABLE: &str = "model-dsl/src/calibration/vocabulary.rs";
const TYPE: [&str; 2] = ["model-dsl/src/calibration/term.rs", "model-dsl/src/calibration/term/parts.rs"];

/// Where words that are terms elsewhere mean something else.
const OTHER_SENSES: [(&str, &str); 13] = [
    // What a number of a fleet does over time.
    ("fleet/src/change.rs", "step"),
    ("fleet/src/report/chart.rs", "step"),
    // What a calibration of an instrument writes of its table.
    ("exchange/src/instrument/report/json.rs", "table"),
    // A form of results in set-up files, beside `tables`.
    ("exchange/src/instrument/setup/measurement.rs", "backlash"),
    // The limit of a path.
    ("simulation/src/file.rs", "acceleration"),
    // States, on which something depends.
    ("diagnosis/src/words.rs", "acceleration"),
    ("diagnosis/src/returns/state.rs", "acceleration"),
    ("diagnosis/src/report/physics.rs", "constant"),
    // A factor.
    ("model-dsl/src/calibration/factor/vocabulary.rs", "acceleration"),
    // The distance of the nodes of a table.
    ("model-dsl/src/calibration/curve.rs", "step"),
    ("model-dsl/src/calibration/term/parts.rs", "step"),
    ("diagnosis/src/report/parameter.rs", "step"),
    // A word of Maxima.
    ("notation/src/maxima.rs", "step"),
];

/// The path of a file from the root, and its text without tests and comments; nothing for tests and examples.
fn source(path: &Path) -> Option<(String, String)> {
    let root = root();
    let name = path.strip_prefix(&root).ok()?.to_str()?.to_owned();
    let beside = ["tests", "examples", "benches", "fuzz"];
    let is_beside = name.split(['/', '.']).any(|part| beside.contains(&part));
    if is_beside || name.ends_with("testing.rs") {
        return None;
    }
    let text = fs::read_to_string(path).unwrap();
    let own = text.split("\n#[cfg(test)]\nmod ").next().unwrap_or_default();
    let lines = own.lines().filter(|line| !line.trim_start().starts_with("//"));
    Some((name, lines.map(|line| format!("{line}\n")).collect()))
}

fn sources() -> Vec<(String, String)> {
    let found: Vec<_> = rust_files(&root()).iter().filter_map(|path| source(path)).collect();
    assert!(found.iter().any(|(name, _)| name == TABLE) && found.len() > 200);
    found
}

#[test]
fn the_table_alone_names_terms() {
    let mut named = BTreeSet::new();
    for (file, text) in sources() {
        for entry in VOCABULARY {
            if file != TABLE && text.contains(&format!("\"{}\"", entry.name)) {
                named.insert((file.clone(), entry.name));
            }
        }
    }
    let other = OTHER_SENSES.map(|(file, word)| (file.to_owned(), word));
    assert_eq!(named, BTreeSet::from(other), "take the name from `TermKind`, or the word from the list");
}

/// The type of a term, as sources write it: `ReversalSpike`.
fn type_name(entry: &Entry) -> String {
    format!("{:?}", entry.kind)
}

/// Terms each of whose keys says one thing and that nothing but their formulas treats as a case of its own: the sources that
/// speak of one are those that a new one needs.
#[test]
fn a_term_is_its_entry_and_its_formulas() {
    let formulas = [
        "runtime/src/term",
        "simulation/src/plant/",
        "diagnosis/src/",
        "notation/src/formula.rs",
        "model-dsl/src/calibration/factor",
        // What is injected is written from the definitions of the terms alone, so that it can judge all others.
        "limits/src/injection/",
        "limits/src/size.rs",
    ];
    // How large a term is that no table of positions holds; without words of its own a term has general ones.
    let words = "exchange/src/controller/beyond.rs";
    let sources = sources();
    let plain = ["cyclic", "expansion", "growth", "drift", "vibration", "acceleration", "reversal-spike"];
    for entry in VOCABULARY.iter().filter(|entry| plain.contains(&entry.name)) {
        let variant = format!("::{}", type_name(entry));
        let speaks = |text: &str| {
            let ends = |rest: &str| !rest.starts_with(|next: char| next.is_alphanumeric() || next == '_');
            // What a term depends on has a name of its own, at times the same, and so has a factor.
            let others = ["State::", "Factor::", "FactorKind::", "Measure::"];
            let text = others.iter().fold(text.to_owned(), |text, other| text.replace(other, ""));
            text.split(&variant).skip(1).any(ends)
        };
        let files = sources.iter().filter(|(_, text)| speaks(text)).map(|(name, _)| name.as_str());
        let (known, other): (BTreeSet<&str>, BTreeSet<&str>) =
            files.partition(|name| *name == TABLE || TYPE.contains(name) || *name == words);
        assert!(known.contains(TABLE) && known.contains(TYPE[1]), "{}: {known:?}", entry.name);
        assert!(!other.is_empty(), "{}", entry.name);
        let strange: Vec<_> =
            other.iter().filter(|name| !formulas.iter().any(|folder| name.starts_with(folder))).collect();
        assert!(strange.is_empty(), "{} is a case of its own in {strange:?}", entry.name);
    }
}

/// The definition that a value of a key has in the schemas.
fn definition(entry: &Entry, key: &Key) -> Option<&'static str> {
    Some(match key.holds {
        Holds::Quantity(Kind { of, per: [] }) => match of {
            // With factors it is no length and no angle.
            Base::Motion => "sizeOfMotion",
            Base::Position => "size",
            Base::Angle => "angle",
            Base::Time => "time",
            Base::Frequency => "frequency",
            Base::Temperature => "temperature",
            Base::Load => "quantity",
        },
        Holds::Quantity(_) => "quantity",
        Holds::Numbers => "numbers",
        Holds::Unit(Base::Motion) => "unitOfMotion",
        // That of a polynomial may be one of a temperature.
        Holds::Unit(_) if entry.key("sensor").is_some() => return None,
        Holds::Unit(_) => "unitOfPosition",
        Holds::OwnAxis | Holds::OtherAxis => "axis",
        Holds::Sensor | Holds::Load => "word",
        Holds::Factors => "factors",
        Holds::Quantities(_) | Holds::Flag => return None,
    })
}

/// The definition that a schema gives a value, and its plain type.
fn given(value: &Value) -> (Option<&str>, Option<&str>) {
    let by = value["$ref"].as_str().or_else(|| value["allOf"][0]["$ref"].as_str());
    (by.and_then(|by| by.strip_prefix("#/definitions/")), value["type"].as_str())
}

fn names<'k>(keys: impl IntoIterator<Item = &'k Key>) -> BTreeSet<&'k str> {
    keys.into_iter().map(|key| key.name).collect()
}

#[test]
fn the_schemas_have_the_terms_and_the_keys_of_the_table() {
    for form in ["calibration", "set-up"] {
        let text = fs::read_to_string(root().join(format!("schemas/{form}.schema.json"))).unwrap();
        let schema: Value = serde_json::from_str(&text).unwrap();
        let terms = schema["definitions"]["term"]["properties"].as_object().unwrap();
        let listed: BTreeSet<&str> = terms.keys().map(String::as_str).collect();
        assert_eq!(listed, VOCABULARY.iter().map(|entry| entry.name).collect(), "{form}");
        for entry in &VOCABULARY {
            let (term, name) = (&terms[entry.name], entry.name);
            let (first, rest) = entry.physics.split_at(1);
            assert_eq!(term["description"], format!("{}{rest}.", first.to_uppercase()), "{form} {name}");
            let properties = term["properties"].as_object().unwrap();
            let keys: BTreeSet<&str> = properties.keys().map(String::as_str).collect();
            let mut known = names(entry.keys);
            known.extend(entry.kind.takes_factors().then_some(TIMES));
            assert_eq!(keys, known, "{form} {name}");
            let required = term["required"].as_array().unwrap().iter().filter_map(Value::as_str);
            let always = entry.keys.iter().filter(|key| key.given == Given::Required);
            assert_eq!(required.collect::<BTreeSet<_>>(), names(always), "{form} {name}");
            for key in entry.keys {
                let (by, kind) = given(&properties[key.name]);
                assert_eq!(by, definition(entry, key), "{form} {name} {}", key.name);
                let plain = match key.holds {
                    Holds::Flag => Some("boolean"),
                    Holds::Quantities(_) => Some("array"),
                    Holds::Unit(_) if by.is_none() => Some("string"),
                    _ => None,
                };
                assert_eq!(kind, plain, "{form} {name} {}", key.name);
            }
        }
    }
}

/// A table of the reference: its rows by the first row's cells.
fn table(reference: &str, head: &str) -> Vec<Vec<String>> {
    let rest = reference.split(head).nth(1).unwrap_or_else(|| panic!("no table {head}"));
    let rows = rest.lines().skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|row| row.trim_matches('|').split(" | ").map(|cell| cell.trim().to_owned()).collect()).collect()
}

/// The words in backquotes.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

fn reference() -> String {
    fs::read_to_string(root().join("docs/reference/terms.md")).unwrap()
}

#[test]
fn the_reference_has_the_terms_and_the_keys_of_the_table() {
    let rows = table(&reference(), "| term | parameters | value | physics |");
    let listed: BTreeSet<&str> = rows.iter().map(|row| quoted(&row[0])[0]).collect();
    assert_eq!((listed.len(), rows.len()), (VOCABULARY.len(), VOCABULARY.len()));
    for entry in &VOCABULARY {
        let row = rows.iter().find(|row| quoted(&row[0]) == [entry.name]);
        let row = row.unwrap_or_else(|| panic!("no `{}` in the reference", entry.name));
        let mut documented: BTreeSet<&str> = quoted(&row[1]).into_iter().collect();
        // That the link's own axis is meant where none is named is said once for all of them.
        let own = entry.keys.iter().find(|key| key.holds == Holds::OwnAxis);
        documented.extend(own.map(|key| key.name));
        assert_eq!(documented, names(entry.keys), "{}", entry.name);
        assert_eq!(row[3], entry.physics, "{}", entry.name);
    }
    let compensated = rows.iter().map(|row| quoted(&row[0])[0]);
    let is_compensated = |name: &str| VOCABULARY.iter().any(|one| one.name == name && one.kind.compensable());
    let order: Vec<bool> = compensated.map(is_compensated).collect();
    assert!(order[..11].iter().all(|yes| *yes) && order[11..].iter().all(|yes| !yes), "{order:?}");
}

/// The kind of what stands behind a key of a factor, in the words of the reference.
fn factor_words(key: &FactorKey) -> &'static str {
    match key.holds {
        FactorHolds::Axis => "the letter of an axis",
        FactorHolds::Sensor => "the name of a sensor",
        FactorHolds::Load => "the name of a load",
        FactorHolds::Power => "1, 2 or 3",
        FactorHolds::Range(_) => "two of the state's own kind, the lower first",
        FactorHolds::Nodes(_) => "a list of positions in rising order",
        FactorHolds::Ratios => "a list of bare numbers, one for each node",
        FactorHolds::Amount(measure, _) => match measure {
            Measure::Position => "position",
            Measure::Speed => "position over time",
            Measure::Acceleration => "position over time squared",
            Measure::Temperature => "temperature",
            Measure::Step => "difference of temperatures",
            Measure::Rise => "temperature over speed",
            Measure::Time => "time",
            Measure::Angle => "angle",
            Measure::Load => "load",
            Measure::Rate => "frequency over load",
        },
    }
}

#[test]
fn the_reference_has_the_factors_of_the_table() {
    let reference = reference().replace("\\|", "|");
    let rows = table(&reference, "| factor | keys | value | what depends on it |");
    assert_eq!(rows.len(), FACTORS.len());
    for (entry, row) in FACTORS.iter().zip(&rows) {
        assert_eq!(quoted(&row[0]), [entry.name]);
        assert_eq!(quoted(&row[1]), entry.key_names(), "{}", entry.name);
        assert_eq!([&row[2], &row[3]], [entry.value, entry.physics], "{}", entry.name);
        assert_eq!(entry.keys[0].name, entry.name, "a factor is named by its first key");
    }
    let rows = table(&reference, "| factor | why no controller knows it |");
    let told: Vec<(&str, &str)> = rows.iter().map(|row| (quoted(&row[0])[0], row[1].as_str())).collect();
    let reasons = FACTORS.iter().filter_map(|entry| Some((entry.name, entry.not_compensable?)));
    assert_eq!(told, reasons.collect::<Vec<_>>());
}

#[test]
fn the_reference_has_the_keys_of_factors() {
    let rows = table(&reference(), "| key of a factor | kind | left out |");
    let mut used = BTreeSet::new();
    for entry in &FACTORS {
        for key in entry.keys {
            let speaks = |row: &&Vec<String>| match row[0].split_once(" of ") {
                Some((name, factor)) => quoted(name) == [key.name] && quoted(factor) == [entry.name],
                None => quoted(&row[0]).contains(&key.name),
            };
            let row = rows.iter().find(speaks).unwrap_or_else(|| panic!("{} of {}", key.name, entry.name));
            assert_eq!(row[1], factor_words(key), "{} of {}", key.name, entry.name);
            assert_eq!(row[2].trim(), key.or.unwrap_or_default(), "{} of {}", key.name, entry.name);
            used.insert(&row[0]);
        }
    }
    assert_eq!(used.len(), rows.len(), "each row speaks of a key");
}

#[test]
fn the_schemas_have_the_factors_and_their_keys() {
    for form in ["calibration", "set-up"] {
        let text = fs::read_to_string(root().join(format!("schemas/{form}.schema.json"))).unwrap();
        let schema: Value = serde_json::from_str(&text).unwrap();
        let factor = &schema["definitions"]["factor"];
        let one_of =
            factor["oneOf"].as_array().unwrap().iter().map(|one| one["required"][0].as_str().unwrap());
        assert_eq!(one_of.collect::<Vec<_>>(), FACTORS.map(|entry| entry.name), "{form}");
        let listed: BTreeSet<&str> =
            factor["properties"].as_object().unwrap().keys().map(String::as_str).collect();
        let keys = FACTORS.iter().flat_map(|entry| entry.keys).map(|key| key.name);
        assert_eq!(listed, keys.collect(), "{form}");
    }
}

#[test]
fn the_reference_says_why_a_term_is_not_compensated() {
    let rows = table(&reference(), "| term | why no controller compensates it |");
    let told: BTreeMap<&str, &str> = rows.iter().map(|row| (quoted(&row[0])[0], row[1].as_str())).collect();
    let reasons = VOCABULARY.iter().filter_map(|entry| Some((entry.name, entry.not_compensable?)));
    assert_eq!(told, reasons.collect());
}

/// The kind of a quantity in the words of the reference.
fn words(kind: Kind) -> String {
    let word = |base: &Base| format!("{base:?}").to_lowercase();
    if let Kind { of: Base::Motion | Base::Position, per: [] } = kind {
        return format!("the {}'s", word(&kind.of));
    }
    let below = kind.per.chunk_by(|one, next| one == next).map(|alike| match alike {
        [base, _, ..] => format!("{} squared", word(base)),
        bases => bases.iter().map(word).collect(),
    });
    let below: Vec<String> = below.collect();
    if below.is_empty() { word(&kind.of) } else { format!("{} over {}", word(&kind.of), below.join(" and ")) }
}

/// What a row of a table of parameters speaks of: keys by their names, of one term where it names one.
fn speaks_of(cell: &str, entry: &Entry, key: &Key) -> bool {
    match cell.split_once(" of ") {
        Some((name, term)) => quoted(name) == [key.name] && quoted(term) == [entry.name],
        None => quoted(cell).contains(&key.name),
    }
}

/// The row that speaks of a key, one that names its term before one that does not.
fn row<'r>(rows: &'r [Vec<String>], entry: &Entry, key: &Key) -> Option<&'r Vec<String>> {
    let mut of_key: Vec<_> = rows.iter().filter(|row| speaks_of(&row[0], entry, key)).collect();
    of_key.sort_by_key(|row| !row[0].contains(" of "));
    of_key.first().copied()
}

#[test]
fn the_reference_has_the_kind_of_each_quantity() {
    let rows = table(&reference(), "| parameter | kind | example |");
    let mut used = BTreeSet::new();
    for entry in &VOCABULARY {
        for key in entry.keys {
            let Some(kind) = key.kind() else { continue };
            let row = row(&rows, entry, key).unwrap_or_else(|| panic!("{} of {}", key.name, entry.name));
            assert_eq!(row[1], words(kind), "{} of {}", key.name, entry.name);
            used.insert(&row[0]);
        }
    }
    assert_eq!(used.len(), rows.len(), "each row speaks of a key");
}

#[test]
fn the_reference_says_what_may_be_left_out() {
    let rows = table(&reference(), "| parameter | left out |");
    let mut used = BTreeSet::new();
    for entry in &VOCABULARY {
        for key in entry.keys {
            let row = row(&rows, entry, key);
            match key.given {
                Given::Optional(means) => {
                    let row = row.unwrap_or_else(|| panic!("{} of {}", key.name, entry.name));
                    assert_eq!(row[1], means, "{} of {}", key.name, entry.name);
                    used.insert(&row[0]);
                }
                // The other axis of a coupling is a key of another kind.
                _ if key.holds == Holds::OtherAxis => {}
                _ => assert_eq!(row, None, "{} of {}", key.name, entry.name),
            }
        }
    }
    assert_eq!(used.len(), rows.len(), "each row speaks of a key");
}

#[test]
fn lists_have_their_form_and_settings_stand_beside_terms() {
    for entry in &VOCABULARY {
        let lists = entry.keys.iter().any(|key| key.holds == Holds::Numbers);
        assert_eq!(lists, entry.form != Form::Plain, "{}", entry.name);
        for key in entry.keys.iter().filter(|key| key.role == Role::Setting) {
            assert!(matches!(key.given, Given::Optional(_)), "{} of {}", key.name, entry.name);
        }
    }
}
