//! The JSON Schemas of the six YAML forms, in `schemas/`: an editor checks with them what a reader will accept.
//!
//! In: every file of these forms that there is. Out: where a schema says other than the reader. The validator is a crate
//! that knows nothing of the readers, and the readers know nothing of the schemas.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use jsonschema::Validator;
use model_dsl::diagnostic::{Diagnostics, Severity};
use model_dsl::quantity::{Dimension, UNIT_NAMES, parse_unit};
use model_dsl::source::SourceFile;
use model_dsl::yaml::{self, Node, NodeKind, Scalar};
use serde_json::{Map, Value};

use crate::beside::shared;
use crate::cli::abbe;
use crate::explain::{complete, examples, told};
use crate::machine_files::{cases, findings};
use crate::shipped::root;

/// The forms by the key that a file of each begins with, and the schemas' names.
const FORMS: [(&str, &str); 6] = [
    ("abbe", "machine"),
    ("calibration", "calibration"),
    ("recording", "recording"),
    ("path", "path"),
    ("setup", "set-up"),
    ("fleet", "fleet"),
];

/// Codes of mistakes in the form of a file, which a schema sees too. All others depend on more than the form: on the
/// machine, on another value, on the file as a whole.
const OF_FORM: [&str; 62] = [
    "E0101", "E0102", "E0103", "E0104", "E0105", "E0106", "E0107", "E0108", "E0109", "E0110", "E0111",
    "E0112", "E0114", "E0117", "E0119", "E0120", "E0121", "E0122", "E0127", "E0128", "E0130", "E0131",
    "E0132", "E0145", "E0151", "E0301", "E0302", "E0303", "E0304", "E0306", "E0307", "E0308", "E0309",
    "E0401", "E0402", "E0403", "E0404", "E0409", "E0410", "E0411", "E0412", "E0414", "E0416", "E0422",
    "E0601", "E0602", "E0603", "E0604", "E0605", "E0606", "E0609", "E0610", "E0611", "E0612", "E0615",
    "E0616", "E0617", "E0620", "E0630", "E0631", "E0701", "E0702",
];

/// More of them: of path files.
const OF_FORM_OF_PATHS: [&str; 6] = ["E0703", "E0704", "E0705", "E0706", "E0707", "E0716"];

/// And of set-up files.
const OF_FORM_OF_SET_UPS: [&str; 7] = ["E0901", "E0902", "E0903", "E0904", "E0907", "E0908", "E0910"];

/// And of fleet files.
const OF_FORM_OF_FLEETS: [&str; 6] = ["E1001", "E1002", "E1003", "E1004", "E1005", "E1006"];

fn of_form(code: &str) -> bool {
    all_of_form().any(|known| known == code)
}

fn all_of_form() -> impl Iterator<Item = &'static str> {
    OF_FORM.into_iter().chain(OF_FORM_OF_PATHS).chain(OF_FORM_OF_SET_UPS).chain(OF_FORM_OF_FLEETS)
}

fn schema(name: &str) -> Value {
    let text = fs::read_to_string(root().join(format!("schemas/{name}.schema.json"))).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn validators() -> BTreeMap<&'static str, Validator> {
    FORMS.into_iter().map(|(_, name)| (name, jsonschema::validator_for(&schema(name)).unwrap())).collect()
}

/// A file as an editor sees it: plain scalars are what the core schema of YAML 1.2 makes of them.
fn value(node: &Node) -> Value {
    match &node.kind {
        NodeKind::Null => Value::Null,
        NodeKind::Scalar(scalar) => plain(scalar),
        NodeKind::Sequence(items) => items.iter().map(value).collect(),
        NodeKind::Mapping(entries) => {
            Value::Object(entries.iter().map(|(key, node)| (key.value.clone(), value(node))).collect())
        }
    }
}

fn plain(scalar: &Scalar) -> Value {
    let text = scalar.text.as_str();
    if scalar.quoted {
        return Value::from(text);
    }
    match text {
        "true" | "True" | "TRUE" => return Value::Bool(true),
        "false" | "False" | "FALSE" => return Value::Bool(false),
        _ => {}
    }
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    if !unsigned.is_empty() && unsigned.bytes().all(|byte| byte.is_ascii_digit()) {
        return text.parse::<i64>().map_or_else(|_| Value::from(text), Value::from);
    }
    let number = unsigned.starts_with(|first: char| first.is_ascii_digit() || first == '.');
    match text.parse::<f64>() {
        Ok(found) if number && found.is_finite() => Value::from(found),
        _ => Value::from(text),
    }
}

/// The value of a text, where it is YAML.
fn parsed(text: &str) -> Option<Value> {
    let mut diagnostics = Diagnostics::new();
    yaml::read(&SourceFile::new("file.yaml", text), &mut diagnostics).map(|root| value(&root))
}

/// The form of a file, by the first of its keys that tells it; a recording names a calibration too.
fn form(text: &str) -> Option<&'static str> {
    let first = text.lines().find(|line| !line.is_empty() && !line.starts_with('#'))?;
    FORMS.into_iter().find(|(key, _)| first.starts_with(&format!("{key}: 1"))).map(|(_, name)| name)
}

/// What a schema has against a text.
fn against(validator: &Validator, text: &str) -> Vec<String> {
    let value = parsed(text).unwrap();
    validator.iter_errors(&value).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

/// All files under a folder whose name ends so, in order.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let Ok(entries) = fs::read_dir(folder) else { return found };
    let mut entries: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.to_string_lossy().ends_with(ending) {
            found.push(path);
        }
    }
    found
}

/// Folders that hold nothing that is shipped: tests with their faulty files, and what is built.
const NOT_SHIPPED: [&str; 3] = ["tests", "target", "fuzz"];

/// Files of no form: what a recording conceals, for people.
const OF_NO_FORM: &str = "truth.yaml";

/// The files of these forms that are shipped: all YAML files that there are, wherever they stand.
fn shipped_files() -> Vec<(PathBuf, String, &'static str)> {
    let read = shipped_yaml(&root()).into_iter().filter(|path| !path.ends_with(OF_NO_FORM)).map(|path| {
        let text = fs::read_to_string(&path).unwrap();
        let form = form(&text).unwrap_or_else(|| panic!("{} is of none of the forms", path.display()));
        (path, text, form)
    });
    read.collect()
}

/// The YAML files under a folder but for folders that are not shipped, in order.
fn shipped_yaml(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let mut found = Vec::new();
    for path in entries {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let shipped = !name.starts_with('.') && !NOT_SHIPPED.contains(&name.as_str());
        match path.is_dir() {
            true if shipped => found.extend(shipped_yaml(&path)),
            false if name.ends_with(".yaml") || name.ends_with(".yml") => found.push(path),
            _ => {}
        }
    }
    found
}

#[test]
fn the_schemas_are_schemas() {
    for (_, name) in FORMS {
        let schema = schema(name);
        assert!(jsonschema::meta::is_valid(&schema), "{name}");
        assert_eq!(schema["$schema"], "http://json-schema.org/draft-07/schema#", "{name}");
        // The version is that of the form, which is the value of its first key.
        assert_eq!(schema["$id"], format!("urn:abbe:{name}:1"));
    }
}

#[test]
fn every_shipped_file_is_valid_and_names_its_schema() {
    let validators = validators();
    let shipped = shipped_files();
    assert!(shipped.len() > 20);
    for (path, text, form) in shipped {
        assert_eq!(against(&validators[form], &text), [""; 0], "{}", path.display());
        let first = text.lines().next().unwrap();
        let named = first.strip_prefix("# yaml-language-server: $schema=");
        let named = named.unwrap_or_else(|| panic!("{} does not begin with its schema", path.display()));
        let named = path.parent().unwrap().join(named).canonicalize();
        let expected = root().join(format!("schemas/{form}.schema.json")).canonicalize();
        assert_eq!(named.unwrap(), expected.unwrap(), "{}", path.display());
    }
}

#[test]
fn what_the_documents_show_is_valid() {
    let validators = validators();
    let mut seen = BTreeSet::new();
    let documents = files(&root().join("docs"), ".md").into_iter().chain([root().join("README.md")]);
    for path in documents {
        let text = fs::read_to_string(&path).unwrap();
        for block in text.split("```yaml\n").skip(1) {
            let block = block.split("```").next().unwrap();
            if let Some(form) = form(block) {
                seen.insert(form);
                assert_eq!(against(&validators[form], block), [""; 0], "{}\n{block}", path.display());
            }
        }
    }
    assert_eq!(seen.len(), FORMS.len(), "an example of every form: {seen:?}");
}

#[test]
fn what_the_program_writes_is_valid() {
    let validators = validators();
    for word in ["FX", "XYFZ", "XYFZAC"] {
        let text = abbe(&["new", word], "").out;
        assert_eq!(against(&validators["machine"], &text), [""; 0], "{text}");
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("schemas");
    let bench = root().join("recordings/postech-ballbar");
    let at = |name: &str| bench.join(name).to_str().unwrap().to_owned();
    let output = folder.join("recording.yaml");
    fs::create_dir_all(&folder).unwrap();
    let run = abbe(
        &["simulate", &at("true.yaml"), &at("path.yaml"), "--output", output.to_str().unwrap(), "--force"],
        "",
    );
    assert_eq!(run.status, 0, "{}", run.err);
    let text = fs::read_to_string(&output).unwrap();
    assert_eq!(against(&validators["recording"], &text), [""; 0], "{text}");
}

/// Recordings and machines that are kept beside the project, where they are there.
#[test]
fn other_files_of_these_forms_are_valid() {
    let validators = validators();
    // Files on which the program was wrong may be wrong themselves.
    let Some(shared) = shared("") else { return };
    let wrong = shared.join("found");
    let mut found = files(&shared, ".yaml");
    found.retain(|path| !path.starts_with(&wrong));
    let mut seen = 0;
    for path in found {
        let text = fs::read_to_string(&path).unwrap();
        if let Some(form) = form(&text) {
            assert_eq!(against(&validators[form], &text), [""; 0], "{}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 0, "no file of these forms in {}", shared.display());
}

#[test]
fn machine_files_are_refused_where_the_reader_refuses_their_form() {
    let validator = &validators()["machine"];
    let mut refused = BTreeSet::new();
    for case in cases() {
        let (source, found) = findings(&case);
        let Some(value) = parsed(source.text()) else { continue };
        let mistaken: Vec<&str> = found.iter().map(|one| one.code).filter(|code| of_form(code)).collect();
        let whole = found.iter().all(|one| one.severity == Severity::Warning);
        assert!(!whole || validator.is_valid(&value), "{}: a file that is right", case.display());
        assert!(mistaken.is_empty() || !validator.is_valid(&value), "{}: {mistaken:?}", case.display());
        refused.extend(mistaken);
    }
    assert!(refused.len() > 20, "{refused:?}");
}

#[test]
fn examples_of_mistakes_in_form_are_refused_and_all_mended_ones_are_valid() {
    let validators = validators();
    let mut refused = BTreeSet::new();
    for (code, example) in examples() {
        let Some(validator) = validators.get(example.kind.as_str()) else { continue };
        let [wrong, mended] = example.files();
        assert_eq!(against(validator, &mended), [""; 0], "{code}\n{mended}");
        if of_form(&code) {
            let valid = parsed(&wrong).is_some_and(|value| validator.is_valid(&value));
            assert!(!valid, "{code} is a mistake in form:\n{wrong}");
            refused.insert(code);
        }
    }
    let all: BTreeSet<String> = all_of_form().map(str::to_owned).collect();
    assert_eq!(refused, all);
}

/// Where a mapping stands, with a key that no reader knows, and the place of its keys in the schema.
fn mappings() -> Vec<(&'static str, String, String)> {
    let mut all = Vec::new();
    let mut add =
        |form, part: &str, pointer: &str| all.push((form, complete(form, part), pointer.to_owned()));
    add("machine", "unheardof: 1", "");
    add("machine", "chain: {unheardof: 1}", "/properties/chain");
    let slide = "slide: X, drives: {X1: {y: 0 mm}, X2: {y: 9 mm}}";
    for (number, link) in
        [slide, "rotary: C", "spindle: S", "fixed: T", "tool: tip", "part: W"].iter().enumerate()
    {
        let part = format!("chain: {{tool: [{{{link}, unheardof: 1}}]}}");
        add("machine", &part, &format!("/definitions/link/oneOf/{number}"));
    }
    let motion = "chain: {tool: [{slide: X, along: +X, errors: {EXX: {unheardof: 1}}}, {tool: tip}]}";
    add("machine", motion, "/definitions/motion/anyOf/2");
    let leaning = "chain: {tool: [{rotary: B, along: +B, leans: {unheardof: 1}}]}";
    add("machine", leaning, "/definitions/angles");
    add("machine", "drive: {X: {unheardof: 1}}", "/definitions/slideDrive");
    add("machine", "topology: XYFZC\ndrive: {C: {unheardof: 1}}", "/definitions/rotaryDrive");
    // A set-up has the head of a calibration.
    for form in ["calibration", "set-up"] {
        add(form, "unheardof: 1", "");
        add(form, "limits: {unheardof: 1}", "/properties/limits");
        add(form, "sensors: {body: {unheardof: 1}}", "/properties/sensors/additionalProperties");
        add(form, "errors: {EXX: [{unheardof: {a: 1}}]}", "/definitions/term");
        for term in model_dsl::calibration::TERM_NAMES {
            let part = format!("errors: {{EXX: [{{{term}: {{unheardof: 1}}}}]}}");
            add(form, &part, &format!("/definitions/term/properties/{term}"));
        }
    }
    add("set-up", "references: {a: {unheardof: 1}}", "/properties/references/additionalProperties");
    add("set-up", "corrections: [{unheardof: 1}]", "/properties/corrections/items");
    add("set-up", "diagonals: {unheardof: 1}", "/properties/diagonals");
    add("set-up", "diagonals: {XY: {unheardof: 1}}", "/definitions/square");
    let measurement = "/properties/measurements/items";
    add("set-up", "measurements: [{unheardof: 1}]", measurement);
    for key in ["targets", "deviations"] {
        let part = format!("measurements: [{{motion: EXX, data: x.csv, {key}: {{unheardof: 1}}}}]");
        add("set-up", &part, &format!("{measurement}/properties/{key}"));
    }
    add("recording", "unheardof: 1", "");
    for channel in ["time", "run", "deviation"] {
        let part = format!("channels: {{{channel}: {{unheardof: 1}}}}");
        add("recording", &part, &format!("/properties/channels/properties/{channel}"));
    }
    for (pattern, channel) in [
        (r"^command\.[xyzuvw]$", "command.x"),
        (r"^actual\.[xyzuvw]$", "actual.x"),
        (r"^command\.[abc]$", "command.c"),
        (r"^actual\.[abc]$", "actual.c"),
        (r"^measured\.[xyz]$", "measured.x"),
        (r"^measured\.[abc]$", "measured.c"),
        (r"^normal\.[xyz]$", "normal.x"),
        (r"^temperature\..*\S", "temperature.a"),
        (r"^load\..*\S", "load.a"),
    ] {
        let part = format!("machine: XYFZC\nchannels: {{{channel}: {{unheardof: 1}}}}");
        add("recording", &part, &format!("/properties/channels/patternProperties/{pattern}"));
    }
    add("fleet", "unheardof: 1", "");
    add("fleet", "machines: {a: {unheardof: 1}}", "/properties/machines/additionalProperties");
    add("recording", "setup: {unheardof: 1}", "/properties/setup");
    add("recording", "holdout: {unheardof: 1}", "/properties/holdout");
    add("recording", "data: {unheardof: 1}", "/properties/data/anyOf/1");
    add("recording", "extra: {a: {unheardof: 1}}", "/properties/extra/additionalProperties");
    add("path", "unheardof: 1", "");
    for shape in ["line", "circle", "diamond", "grid", "spiral"] {
        add("path", &format!("{shape}: {{unheardof: 1}}"), &format!("/properties/{shape}"));
    }
    let stations = "line: {axis: X, from: 0 mm, to: 1 mm, stations: {unheardof: 1}}";
    add("path", stations, "/properties/line/properties/stations");
    let instruments = "/properties/instrument/anyOf/1";
    add("path", "instrument: {unheardof: {a: 1}}", instruments);
    for instrument in ["ballbar", "linear", "straightness", "angular", "probe"] {
        let pointer = format!("{instruments}/properties/{instrument}");
        add("path", &format!("instrument: {{{instrument}: {{unheardof: 1}}}}"), &pointer);
    }
    let pointer = format!("{instruments}/properties/ballbar/properties/eccentricity");
    add("path", "instrument: {ballbar: {eccentricity: {unheardof: 1}}}", &pointer);
    add("path", "instrument: position\ndatum: {unheardof: 1}", "/properties/datum");
    add("path", "noise: {unheardof: 1}", "/definitions/noise/anyOf/1");
    for noise in ["correlated", "walk", "outliers"] {
        let pointer = format!("/definitions/noise/anyOf/1/properties/{noise}");
        add("path", &format!("noise: {{{noise}: {{unheardof: 1}}}}"), &pointer);
    }
    add("path", "missing: {unheardof: 1}", "/properties/missing/anyOf/1");
    add("path", "drive: {unheardof: 1}", "/properties/drive");
    add("path", "holdout: {unheardof: 1}", "/properties/holdout");
    let sensor = "/properties/temperatures/additionalProperties";
    add("path", "temperatures: {motor: {unheardof: 1}}", sensor);
    add(
        "path",
        "temperatures: {motor: {steps: [{unheardof: 1}]}}",
        &format!("{sensor}/properties/steps/items"),
    );
    add("path", "temperatures: {motor: {swing: {unheardof: 1}}}", &format!("{sensor}/properties/swing"));
    let load = "/properties/loads/additionalProperties";
    add("path", "loads: {cutting: {unheardof: 1}}", load);
    add("path", "loads: {cutting: {unit: N, pulses: {unheardof: 1}}}", &format!("{load}/properties/pulses"));
    add("path", "loads: {cutting: {unit: N, swing: {unheardof: 1}}}", &format!("{load}/properties/swing"));
    all
}

/// The places of all mappings of a schema that have their keys by name and no others.
fn closed(value: &Value, pointer: String, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(entries) => {
            let closed_mapping = entries.get("additionalProperties") == Some(&Value::Bool(false));
            if closed_mapping && entries.get("properties").is_some_and(Value::is_object) {
                // Which keys a factor may have depends on its name: its own table is compared beside that of the terms.
                let channels = pointer == "/properties/channels" || pointer == "/definitions/factor";
                if !channels {
                    found.insert(pointer.clone());
                }
            }
            for (key, value) in entries {
                closed(value, format!("{pointer}/{key}"), found);
            }
        }
        Value::Array(items) => {
            for (number, value) in items.iter().enumerate() {
                closed(value, format!("{pointer}/{number}"), found);
            }
        }
        _ => {}
    }
}

/// What a reader says of a mapping with a key that nobody knows.
struct Reader {
    /// The keys that it lists instead.
    known: BTreeSet<String>,
    /// The keys that it misses.
    missing: BTreeSet<String>,
}

fn reader(form: &str, text: &str) -> Reader {
    let told = told(form, text);
    let findings: Vec<&str> = told.split("error[").flat_map(|part| part.split("warning[")).collect();
    let about = |finding: &&&str| finding.lines().next().is_some_and(|line| line.contains("`unheardof`"));
    let unknown = findings.iter().find(about);
    let unknown = unknown.unwrap_or_else(|| panic!("no word of the unknown key in\n{text}\n{told}"));
    let help = unknown.lines().find_map(|line| line.split_once("help: ")).unwrap().1;
    let list = help.split_once(" are ").or_else(|| help.split_once("one of ")).unwrap().1;
    let what = unknown.split_once("]: ").unwrap().1.split(" has no ").next().unwrap();
    let misses = |finding: &&str| -> Option<String> {
        let needs = finding.split_once("]: ")?.1.strip_prefix(what)?.strip_prefix(" needs ")?;
        match needs.strip_prefix("the key `").or_else(|| needs.strip_prefix("the parameter `")) {
            Some(key) => key.split('`').next().map(str::to_owned),
            None => needs.starts_with("a unit").then(|| "unit".to_owned()),
        }
    };
    Reader {
        known: list.split(", ").map(str::to_owned).collect(),
        missing: findings.iter().filter_map(misses).collect(),
    }
}

/// All keys that a mapping requires, those of one of several ways to write it too.
fn required(place: &Value, always: bool) -> BTreeSet<String> {
    let own = place["required"].as_array().into_iter().flatten();
    let mut keys: BTreeSet<String> = own.filter_map(|key| key.as_str().map(str::to_owned)).collect();
    if !always {
        for several in ["oneOf", "allOf", "anyOf"] {
            let ways = place[several].as_array().into_iter().flatten();
            keys.extend(ways.flat_map(|way| required(way, false)));
        }
    }
    keys
}

#[test]
fn every_mapping_has_the_keys_that_its_reader_knows_and_misses() {
    let mut looked_at: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    let mut missed = 0;
    for (form, text, pointer) in mappings() {
        let schema = schema(form);
        let place = schema.pointer(&pointer).unwrap_or_else(|| panic!("no {pointer} in {form}"));
        let properties: &Map<String, Value> = place["properties"].as_object().unwrap();
        let keys: BTreeSet<String> = properties.keys().cloned().collect();
        let reader = reader(form, &text);
        assert_eq!(keys, reader.known, "{form} {pointer}");
        // An axis misses its direction, and a chain its tool, in words of their own (E0102, E0125).
        let given =
            |key: &String| matches!(key.as_str(), "along" | "tool") || text.contains(&format!("{key}: "));
        let always: BTreeSet<String> = required(place, true).into_iter().filter(|key| !given(key)).collect();
        let sometimes = required(place, false);
        assert!(always.is_subset(&reader.missing), "{form} {pointer}: {always:?}, {:?}", reader.missing);
        assert!(
            reader.missing.is_subset(&sometimes),
            "{form} {pointer}: {sometimes:?}, {:?}",
            reader.missing
        );
        missed += reader.missing.len();
        looked_at.entry(form).or_default().insert(pointer);
    }
    assert!(missed > 50, "{missed}");
    for (_, name) in FORMS {
        let mut all = BTreeSet::new();
        closed(&schema(name), String::new(), &mut all);
        assert_eq!(looked_at[name], all, "{name}: every mapping of the schema is compared");
    }
}

#[test]
fn every_unit_is_a_quantity_of_its_kind_and_of_no_other() {
    let calibration = schema("calibration");
    let kinds = [
        ("length", Dimension::LENGTH),
        ("angle", Dimension::ANGLE),
        ("time", Dimension::TIME),
        ("frequency", Dimension::FREQUENCY),
        ("temperature", Dimension::TEMPERATURE),
    ];
    let units = UNIT_NAMES.split("; and ratios").next().unwrap().split([',', ';']).map(str::trim);
    let units: Vec<&str> = units.chain(["1/s", "\u{b5}m", "\u{3bc}rad", "\u{b0}", "\u{b0}C"]).collect();
    assert!(units.len() > 25, "{units:?}");
    for (name, dimension) in kinds {
        let validator = jsonschema::validator_for(&calibration["definitions"][name]).unwrap();
        for unit in &units {
            let own = parse_unit(unit).unwrap().dimension == dimension;
            for number in ["1 ", "-2.5e-3", "+.5  "] {
                assert_eq!(
                    validator.is_valid(&Value::from(format!("{number}{unit}"))),
                    own,
                    "{unit} as {name}"
                );
            }
        }
        for wrong in ["1", "1,5 mm", "mm", "ten mm", ""] {
            assert!(!validator.is_valid(&Value::from(wrong)), "{wrong} as {name}");
        }
    }
}
