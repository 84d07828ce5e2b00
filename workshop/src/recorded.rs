//! Recordings with their machines. In: recording files. Out: the data in columns, the machine, its equations and the
//! calibration that the recording names; or every mistake, located.

mod lacking;

use std::path::{Path, PathBuf};

use model_dsl::calibration::Calibration;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::machine::Machine;
use model_dsl::source::{SourceFile, Span, Spanned};
use model_dsl::yaml::{Node, NodeKind, Scalar};
use model_dsl::{Compiled, yaml};
use recording::{self, DataError, Header, Recording};

use crate::begin;
use crate::calibrated::{self, Calibrated};
use crate::failure::Failure;
use crate::load;
use crate::told::{Listener, Words};
use crate::topology::Topology;

/// A recording and all that it names.
#[derive(Clone)]
pub struct Recorded {
    /// The recording file.
    pub source: SourceFile,
    /// The equations of the machine that was recorded.
    pub equations: Equations,
    /// The machine that was recorded.
    pub machine: Machine,
    /// Where they come from a topology word: the word, and its file.
    pub topology: Option<Topology>,
    /// What is already known of it, where the recording names a calibration.
    pub calibration: Option<Calibrated>,
    /// The data.
    pub recording: Recording,
    /// Whether the recording has no times, and its rows were taken in their order.
    pub in_order: bool,
    /// The calibration's file, where there is one.
    calibration_path: Option<PathBuf>,
    /// Where the file names its machine and its calibration.
    named: Named,
}

#[derive(Clone)]
struct Named {
    machine: Span,
    channels: Span,
    calibration: Option<Span>,
}

/// Reads a recording file, its data, and the machine and the calibration that it names. All paths in the file are
/// counted from its own folder.
pub fn read(path: &Path, listener: &dyn Listener) -> Result<Recorded, Failure> {
    read_as(path, false, listener)
}

/// The same where the channel `time` may be missing: the rows are then taken in their order, so far apart that each counts as a stand.
pub fn read_in_order(path: &Path, listener: &dyn Listener) -> Result<Recorded, Failure> {
    read_as(path, true, listener)
}

fn read_as(path: &Path, may_lack_time: bool, listener: &dyn Listener) -> Result<Recorded, Failure> {
    let source = load::read(path).map_err(|failure| begin::table_alone(path).unwrap_or(failure))?;
    if !is_mapping(&source)
        && let Some(table) = begin::table_alone(path)
    {
        return Err(table);
    }
    let folder = path.parent();
    let data = |header: &Header| {
        let path = in_folder(folder, &header.data.value);
        listener.begin(&format!("reading {}", path.display()));
        let mut read = header.read_data(&path);
        if let (Err(error), false) = (&mut read, path.exists())
            && let Some(near) = load::near_file(&path, &[])
        {
            error.help.get_or_insert_with(|| format!("did you mean `{near}`?"));
        }
        listener.end();
        read
    };
    of_as(source, folder, data, may_lack_time, listener)
}

/// Whether a file may be a recording file at all: a mapping of keys.
fn is_mapping(source: &SourceFile) -> bool {
    yaml::read(source, &mut Diagnostics::new()).is_some_and(|root| root.entries().is_some())
}

/// Reads the text of a recording file, whose names are counted from a folder; its data are what `data` makes of what it says of them.
pub fn of(
    source: SourceFile,
    folder: Option<&Path>,
    data: impl FnOnce(&Header) -> Result<Recording, DataError>,
    listener: &dyn Listener,
) -> Result<Recorded, Failure> {
    of_as(source, folder, data, false, listener)
}

fn of_as(
    source: SourceFile,
    folder: Option<&Path>,
    data: impl FnOnce(&Header) -> Result<Recording, DataError>,
    may_lack_time: bool,
    listener: &dyn Listener,
) -> Result<Recorded, Failure> {
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics).ok_or_else(|| wrong(&source, &diagnostics))?;
    let ordered = may_lack_time.then(|| with_order(&root)).flatten();
    let in_order = ordered.is_some();
    let root = ordered.unwrap_or(root);
    let name = recording::machine_of(&root, &mut diagnostics).ok_or_else(|| wrong(&source, &diagnostics))?;
    let loaded = load::machine(&name.value, folder, listener)
        .map_err(|failure| unusable(&source, "E0622", "machine", &name, failure))?;
    let topology = Topology::of(&loaded);
    let Compiled { machine, equations } = loaded.compiled;
    let header = recording::read_header(&root, &equations, &mut diagnostics);
    let header = header.filter(|_| !diagnostics.has_errors()).ok_or_else(|| wrong(&source, &diagnostics))?;
    listener.hear(&Words::marked(&source, &diagnostics));
    let calibration_path = header.calibration.as_ref().map(|name| in_folder(folder, &name.value));
    let calibration = read_calibration(&source, &header, calibration_path.as_deref(), &equations, listener)?;
    let recording = read_data(data(&header), &source, listener)?;
    let named = Named {
        machine: name.span,
        channels: key_of(&root, "channels").unwrap_or(name.span),
        calibration: header.calibration.map(|name| name.span),
    };
    Ok(Recorded {
        source,
        equations,
        machine,
        topology,
        calibration,
        recording,
        in_order,
        calibration_path,
        named,
    })
}

/// The time from row to row where the order is all that is known: longer than any machine needs to settle, so that each row counts
/// as a stand.
const STAND: &str = "10 s";

/// A recording file with a time for each row; nothing where it has times, or no channels.
fn with_order(root: &Node) -> Option<Node> {
    let place = root.get("channels")?.span;
    let add = |(key, node): &(Spanned<String>, Node)| {
        let mut node = node.clone();
        if let (true, NodeKind::Mapping(channels)) = (key.value == "channels", &mut node.kind) {
            let step = Node {
                span: place,
                kind: NodeKind::Scalar(Scalar { text: STAND.to_owned(), quoted: false }),
            };
            let step = NodeKind::Mapping(vec![(Spanned::new("every".to_owned(), place), step)]);
            let time = (Spanned::new("time".to_owned(), place), Node { span: place, kind: step });
            channels.insert(0, time);
        }
        (key.clone(), node)
    };
    let channels = root.get("channels")?.entries()?;
    if channels.iter().any(|(name, _)| name.value == "time") {
        return None;
    }
    let entries = root.entries()?.iter().map(add).collect();
    Some(Node { span: root.span, kind: NodeKind::Mapping(entries) })
}

/// Reads several recordings of one machine with one calibration.
pub fn read_all(paths: &[PathBuf], listener: &dyn Listener) -> Result<Vec<Recorded>, Failure> {
    let mut all: Vec<Recorded> = Vec::new();
    for path in paths {
        let recorded = read(path, listener)?;
        add(&mut all, recorded)?;
    }
    Ok(all)
}

/// Adds a recording to others of one machine with one calibration; refuses one of another, and one that is there already: twice as many
/// readings of the same noise make intervals too narrow, and noise that repeats looks like physics.
pub fn add(all: &mut Vec<Recorded>, mut recorded: Recorded) -> Result<(), Failure> {
    if let Some(first) = all.first() {
        first.take_other(&mut recorded)?;
    }
    if let Some(copy) = all.iter().find(|known| recorded.recording.is_copy_of(&known.recording)) {
        return Err(copy.refuse_copy(&recorded));
    }
    all.push(recorded);
    Ok(())
}

fn read_calibration(
    source: &SourceFile,
    header: &Header,
    path: Option<&Path>,
    equations: &Equations,
    listener: &dyn Listener,
) -> Result<Option<Calibrated>, Failure> {
    let (Some(name), Some(path)) = (&header.calibration, path) else { return Ok(None) };
    let calibrated = calibrated::read(path, listener)
        .map_err(|failure| unusable(source, "E0623", "calibration", name, failure))?;
    let of = &calibrated.equations;
    if of.names() == equations.names() {
        return Ok(Some(calibrated));
    }
    let message = if of.machine == equations.machine {
        format!("the calibration is for another machine that is also named {}", of.machine)
    } else {
        format!("the calibration is for {}, but the recording is from {}", of.machine, equations.machine)
    };
    let mistake =
        Diagnostic::error("E0624", name.span, message).also(header.machine.span, "the recorded machine");
    Err(one(source, mistake.help("name the machine file that the calibration names, or another calibration")))
}

fn read_data(
    read: Result<Recording, DataError>,
    source: &SourceFile,
    listener: &dyn Listener,
) -> Result<Recording, Failure> {
    let mut recording = read.map_err(|error| not_read(error, source))?;
    for note in &recording.notes {
        listener.hear(&format!("note: {note}").into());
    }
    source.name().clone_into(&mut recording.file);
    Ok(recording)
}

/// Why the data cannot be read; in the recording file where that is what is wrong.
fn not_read(error: DataError, source: &SourceFile) -> Failure {
    let Some((code, place)) = error.recording.as_deref().copied() else {
        return Failure::no(error.to_string());
    };
    let mistake = Diagnostic::error(code, place, format!("{}: {}", error.file, error.message));
    one(source, error.help.into_iter().fold(mistake, Diagnostic::help))
}

fn in_folder(folder: Option<&Path>, name: &str) -> PathBuf {
    folder.map_or_else(|| PathBuf::from(name), |folder| folder.join(name))
}

/// Where a file has a key.
fn key_of(root: &Node, key: &str) -> Option<Span> {
    root.entries()?.iter().find(|(name, _)| name.value == key).map(|(name, _)| name.span)
}

fn wrong(source: &SourceFile, diagnostics: &Diagnostics) -> Failure {
    Failure::marked(source, diagnostics)
}

fn one(source: &SourceFile, diagnostic: Diagnostic) -> Failure {
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(diagnostic);
    wrong(source, &diagnostics)
}

/// What a recording names cannot be used, for a reason that was found in another file.
pub fn unusable(
    source: &SourceFile,
    code: &'static str,
    what: &str,
    name: &Spanned<String>,
    failure: Failure,
) -> Failure {
    let Failure::Wrong(reason) = failure else { return failure };
    let mistake = Diagnostic::error(code, name.span, format!("{what} `{}` cannot be used", name.value));
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(mistake.label("named here; the reason is below"));
    Failure::Wrong(Words::marked(source, &diagnostics).then(reason))
}

/// Whether calibrations differ in nothing that acts, or in constants alone.
fn are_alike(known: &Calibration, other: &Calibration) -> bool {
    let (constants, source) = (known.constants.clone(), known.source.clone());
    *known == Calibration { constants, source, ..other.clone() }
}

/// The constants that are others than those that are known, by their numbers.
fn differing(known: &[f64], own: &[f64]) -> Vec<(usize, f64)> {
    let all = known.iter().zip(own).enumerate();
    all.filter(|(_, (known, own))| known != own).map(|(number, (_, own))| (number, *own)).collect()
}

impl Recorded {
    /// A recording whose rows are those of this one (E0625).
    fn refuse_copy(&self, copy: &Self) -> Failure {
        let [name, own] = [copy, self].map(|recorded| recorded.source.name());
        let message = if name == own {
            format!("{name} is given twice")
        } else {
            format!("{name} has the same rows as {own}, to the last digit")
        };
        let mistake = Diagnostic::error("E0625", copy.named.machine, message);
        one(&copy.source, mistake.help("give each recording once: no two measurements have the same noise"))
    }

    /// Reports a recording that is of another machine, or counts on another calibration (E0625). Calibrations that differ in constants
    /// alone are one calibration with other tools: the recording then tells what its own are.
    fn take_other(&self, other: &mut Self) -> Result<(), Failure> {
        let first = self.source.name();
        if self.equations.names() != other.equations.names() {
            let message = format!(
                "{} is a recording of {}, but {first} is one of {}",
                other.source.name(),
                other.equations.machine,
                self.equations.machine
            );
            let mistake = Diagnostic::error("E0625", other.named.machine, message);
            return Err(one(
                &other.source,
                mistake.help("give recordings of one machine, or run the command once for each machine"),
            ));
        }
        match (&self.calibration, &other.calibration) {
            (None, None) => return Ok(()),
            (Some(known), Some(own)) if are_alike(&known.calibration, &own.calibration) => {
                let own = other.recording.constants(&own.calibration.constants);
                other.recording.constants = differing(&known.calibration.constants, &own);
                return Ok(());
            }
            _ => {}
        }
        let named = |recorded: &Self| match &recorded.calibration_path {
            Some(path) => format!("starts from {}", path.display()),
            None => "names no calibration".to_owned(),
        };
        let message = format!("{} {}, {first} {}", other.source.name(), named(other), named(self));
        let place = other.named.calibration.unwrap_or(other.named.machine);
        let mistake = Diagnostic::error("E0625", place, message);
        Err(one(&other.source, mistake.help("name the same calibration in all recordings")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHANNELS: &str = "data: d.csv\ninstrument: position\nchannels: {time: {column: t, unit: s}, measured.x: {column: x, unit: mm}}\n";

    /// A folder with the files that all tests need, and some of their own.
    fn folder(test: &str, files: &[(&str, &str)]) -> Folder {
        let folder = std::env::temp_dir().join(format!("abbe-recorded-{}-{test}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let common = [
            ("d.csv", "t,x\n5,1\n6,2\n"),
            ("stage.yaml", "abbe: 1\nname: stage\ntopology: FX\n"),
            ("other.yaml", "abbe: 1\nname: stage\ntopology: FY\n"),
            (
                "known.yaml",
                "calibration: 1\nmachine: stage.yaml\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\n",
            ),
        ];
        for (name, text) in common.iter().chain(files) {
            std::fs::write(folder.join(name), text).unwrap();
        }
        Folder(folder)
    }

    /// A folder that goes with its test.
    struct Folder(PathBuf);

    impl Folder {
        fn join(&self, name: &str) -> PathBuf {
            self.0.join(name)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    fn recording(head: &str) -> String {
        format!("recording: 1\n{head}\n{CHANNELS}")
    }

    fn wrong<T>(result: Result<T, Failure>) -> String {
        match result {
            Err(failure) => failure.words().unwrap().text(false),
            Ok(_) => panic!("it was read"),
        }
    }

    #[test]
    fn everything_is_found_from_the_recording_s_folder() {
        let text = recording("machine: stage.yaml\ncalibration: known.yaml");
        let folder = folder("found", &[("r.yaml", &text)]);
        let recorded = read(&folder.join("r.yaml"), &()).ok().unwrap();
        assert_eq!(recorded.equations.machine, "stage");
        assert!(recorded.calibration.is_some());
        assert_eq!(recorded.recording.time, [0.0, 1.0]);
        assert_eq!(recorded.recording.file, folder.join("r.yaml").display().to_string());
    }

    #[test]
    fn a_recording_counts_once() {
        let text = recording("machine: stage.yaml");
        let (still, other) = (text.replace("d.csv", "still.csv"), text.replace("d.csv", "other.csv"));
        let files = [
            ("r.yaml", text.as_str()),
            ("copy.yaml", &text),
            ("still.yaml", &still),
            ("again.yaml", &still),
            ("apart.yaml", &other),
            ("still.csv", "t,x\n5,1\n6,1\n"),
            ("other.csv", "t,x\n5,1\n6,2.000001\n"),
        ];
        let folder = folder("once", &files);
        let together = |names: [&str; 2]| read_all(&names.map(|name| folder.join(name)), &());
        let said = wrong(together(["r.yaml", "r.yaml"]));
        assert!(said.contains("E0625") && said.contains("given twice"), "{said}");
        let said = wrong(together(["r.yaml", "copy.yaml"]));
        assert!(said.contains("E0625") && said.contains("the same rows as"), "{said}");
        // Another reading; and readings that are one number, as of a machine that stands still.
        for names in [["r.yaml", "apart.yaml"], ["still.yaml", "again.yaml"]] {
            assert_eq!(together(names).ok().unwrap().len(), 2, "{names:?}");
        }
    }

    #[test]
    fn what_cannot_be_used_is_marked_where_it_is_named() {
        let files = [
            ("machine.yaml", recording("machine: stge.yaml"), "E0622", "no machine `stge.yaml`"),
            ("missing.yaml", recording("machine: FX\ncalibration: none.yaml"), "E0623", "cannot read"),
            (
                "another.yaml",
                recording("machine: FX\ncalibration: known.yaml"),
                "E0624",
                "for stage, but the recording is from FX",
            ),
            (
                "alike.yaml",
                recording("machine: other.yaml\ncalibration: known.yaml"),
                "E0624",
                "that is also named stage",
            ),
            ("data.yaml", recording("machine: FX").replace("d.csv", "e.csv"), "e.csv: it cannot be read", ""),
        ];
        for (name, text, code, part) in files {
            let folder = folder("marked", &[(name, &text)]);
            let said = wrong(read(&folder.join(name), &()));
            assert!(said.contains(code) && said.contains(part), "{said}");
        }
    }

    #[test]
    fn recordings_given_together_are_of_one_machine() {
        let (one, two) = (recording("machine: stage.yaml"), recording("machine: FX"));
        let three = recording("machine: stage.yaml\ncalibration: known.yaml");
        let files = [("one.yaml", one.as_str()), ("two.yaml", two.as_str()), ("three.yaml", three.as_str())];
        let folder = folder("together", &files);
        for other in ["two.yaml", "three.yaml"] {
            let said = wrong(read_all(&[folder.join("one.yaml"), folder.join(other)], &()));
            assert!(said.contains("E0625") && said.contains("one.yaml") && said.contains(other), "{said}");
        }
    }
}
