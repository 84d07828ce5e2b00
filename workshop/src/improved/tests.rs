//! Written calibrations, read back: against those that come with the program, in another folder, with sensors of their own.

use std::fs;
use std::path::PathBuf;

use diagnosis::diagnosis::{Evidence, Location, Summary, Verdict};
use model_dsl::calibration::{CalibratedTerm, SensorKind, SeriesInput};

use super::*;
use crate::calibrated;
use crate::named::check_target;
use crate::recorded;

/// A folder that goes with its test.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("abbe-improved-{}-{test}", std::process::id()));
        fs::create_dir_all(folder.join("kept")).unwrap();
        fs::write(folder.join("d.csv"), "t,x\n0,1\n1,2\n").unwrap();
        Self(folder)
    }

    /// The recording of a machine that counts on a calibration, and the paths that it names.
    fn recorded(&self, machine: &str, calibration: Option<&str>) -> (Recorded, Files) {
        let calibration = calibration.map(|path| format!("calibration: {path}\n")).unwrap_or_default();
        let text = format!(
            "recording: 1\nmachine: {machine}\n{calibration}data: d.csv\ninstrument: position\n\
             channels: {{time: {{column: t, unit: s}}, measured.x: {{column: x, unit: mm}}}}\n"
        );
        let path = self.0.join("r.yaml");
        fs::write(&path, text).unwrap();
        let recorded = recorded::read(&path, &()).unwrap_or_else(|failure| panic!("{}", words(&failure)));
        let files = Files::of(&recorded, &path);
        (recorded, files)
    }

    fn join(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn words(failure: &Failure) -> String {
    failure.words().map_or_else(|| "closed".to_owned(), |words| words.text(false))
}

/// A finding that reads sensor 0 of its own, if any.
fn finding(recorded: &Recorded, motion: &str, calibrated: CalibratedTerm, sensor: Option<&str>) -> Finding {
    Finding {
        motion: motion.to_owned(),
        motion_number: recorded.equations.names().motion(motion).unwrap(),
        motion_meaning: String::new(),
        term: calibrated.name(),
        parameters: Vec::new(),
        over_travel: None,
        share: 0.5,
        location: Location::default(),
        evidence: Evidence::default(),
        alternatives: Vec::new(),
        explanation: String::new(),
        repeats_with: Vec::new(),
        compensable: calibrated.compensable(),
        calibrated,
        form: None,
        sensors: sensor.map(|name| (0, name.to_owned())).into_iter().collect(),
    }
}

fn diagnosis(findings: Vec<Finding>) -> Diagnosis {
    let recordings =
        vec![Summary { file: "r.yaml\nerrors: {}".to_owned(), samples: 2, ..Summary::default() }];
    Diagnosis { verdict: Verdict::LeftOutPhysics, findings, recordings, ..Diagnosis::default() }
}

fn written(
    target: &Path,
    recorded: &Recorded,
    files: &Files,
    findings: Vec<Finding>,
) -> calibrated::Calibrated {
    write(target, recorded, files, &diagnosis(findings), &())
        .unwrap_or_else(|failure| panic!("{}", words(&failure)));
    calibrated::read(target, &()).unwrap_or_else(|failure| panic!("{}", words(&failure)))
}

const BACKLASH: CalibratedTerm = CalibratedTerm::Backlash { axis: 0, lost_motion: 0.0098, wind_up: 0.0 };

#[test]
fn every_calibration_that_comes_with_the_program_takes_a_finding_and_keeps_the_rest() {
    let shipped = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../calibrations");
    let mut tried = 0;
    for entry in fs::read_dir(shipped).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "yaml") {
            continue;
        }
        let known = calibrated::read(&path, &()).ok().unwrap();
        let folder = Folder::new(&format!("shipped-{tried}"));
        let name = path.display().to_string();
        let (recorded, files) = folder.recorded(&known.calibration.machine.value, Some(&name));
        let motion = known.equations.motions.iter().position(|motion| motion.name == "EXX").unwrap();
        let read = written(
            &folder.join("new.yaml"),
            &recorded,
            &files,
            vec![finding(&recorded, "EXX", BACKLASH.clone(), None)],
        );
        assert_eq!(read.calibration, known.calibration.with(&[(motion, BACKLASH.clone())]), "{name}");
        // Without findings it is what was known.
        let read = written(&folder.join("same.yaml"), &recorded, &files, Vec::new());
        assert_eq!(read.calibration, known.calibration, "{name}");
        tried += 1;
    }
    assert!(tried >= 3, "only {tried} calibrations were found");
}

#[test]
fn each_finding_reads_the_sensor_of_its_name() {
    let folder = Folder::new("sensors");
    let known = "calibration: 1\nmachine: xfyz-mill\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\n\
                 sensors: {body: {mean: [a, b]}}\n\
                 errors: {EZZ: [{growth: {sensor: body, coefficient: 1 um/K, reference: 20 degC}}]}\n";
    fs::write(folder.join("known.yaml"), known).unwrap();
    let (recorded, files) = folder.recorded("xfyz-mill", Some("known.yaml"));
    let expansion = CalibratedTerm::Expansion { axis: 0, sensor: 0, coefficient: 7e-6, reference: 20.0 };
    let growth =
        CalibratedTerm::Growth { sensor: 0, coefficient: 2e-3, reference: 21.0, time_constant: 700.0 };
    let series = CalibratedTerm::Polynomial { input: SeriesInput::Sensor(0), coefficients: vec![0.0, 1e-6] };
    let read = written(
        &folder.join("kept/new.yaml"),
        &recorded,
        &files,
        vec![
            finding(&recorded, "EXX", expansion, Some("scale")),
            finding(&recorded, "EZZ", growth, Some("body")),
            finding(&recorded, "EBX", series, Some("b")),
        ],
    );
    let names = read.equations.names();
    let sensor_of = |motion: &str| {
        let term = &read.calibration.terms(names.motion(motion).unwrap()).last().unwrap().value;
        read.calibration.sensors.iter().nth(term.sensor().unwrap()).unwrap().clone()
    };
    assert_eq!(sensor_of("EXX").name.value, "scale");
    assert_eq!(sensor_of("EBX").name.value, "b");
    let body = sensor_of("EZZ");
    assert_eq!(body.name.value, "body");
    assert!(matches!(body.kind, SensorKind::Mean(sources) if sources.len() == 2));
    assert_eq!(read.calibration.terms(names.motion("EZZ").unwrap()).len(), 2);
    let mut inputs: Vec<&str> =
        read.calibration.sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str()).collect();
    inputs.sort_unstable();
    assert_eq!(inputs, ["a", "b", "scale"]);
}

#[test]
fn a_machine_file_is_found_from_the_new_folder_with_a_calibration_and_without() {
    let folder = Folder::new("machine");
    fs::write(folder.join("stage.yaml"), "abbe: 1\nname: stage\ntopology: FX\n").unwrap();
    fs::write(
        folder.join("kept/known.yaml"),
        "calibration: 1\nmachine: ../stage.yaml\nconstants: {Xt: 5 mm, Yt: 0 mm, Zt: 0 mm}\n",
    )
    .unwrap();
    fs::create_dir_all(folder.join("a/b")).unwrap();
    for calibration in [None, Some("kept/known.yaml")] {
        let (recorded, files) = folder.recorded("stage.yaml", calibration);
        let found = finding(&recorded, "EXX", BACKLASH.clone(), None);
        let read = written(&folder.join("a/b/new.yaml"), &recorded, &files, vec![found]);
        assert_eq!(read.calibration.machine.value, "../../stage.yaml");
        assert_eq!(read.calibration.constants[0], if calibration.is_some() { 5.0 } else { 0.0 });
        assert_eq!(read.calibration.terms(0)[0].value, BACKLASH);
    }
}

#[test]
fn the_head_says_where_it_comes_from_and_no_name_ends_a_comment() {
    let folder = Folder::new("head");
    let (recorded, files) = folder.recorded("FX", None);
    let target = folder.join("new.yaml");
    written(&target, &recorded, &files, vec![finding(&recorded, "EXX", BACKLASH.clone(), None)]);
    let text = fs::read_to_string(&target).unwrap();
    let head: Vec<&str> = text.lines().take_while(|line| line.starts_with("# ")).collect();
    assert_eq!(head.len(), 5, "{text}");
    assert!(head[0].contains("from r.yaml errors: {}."), "{text}");
    assert!(head[1].contains("left-out physics") && head[4].contains("backlash of EXX"), "{text}");
    let left: Vec<_> = fs::read_dir(&folder.0).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().ends_with(".part")), "{left:?}");
}

#[test]
fn what_could_not_be_read_is_not_written_and_leaves_what_stood_there() {
    let folder = Folder::new("unreadable");
    let (recorded, files) = folder.recorded("FX", None);
    let target = folder.join("new.yaml");
    fs::write(&target, "kept").unwrap();
    let broken = CalibratedTerm::Lag { axis: 0, gain: f64::NAN, frequency: 0.0 };
    let findings = vec![finding(&recorded, "EXX", broken, None)];
    assert!(write(&target, &recorded, &files, &diagnosis(findings), &()).is_err());
    assert_eq!(fs::read_to_string(&target).unwrap(), "kept");
}

#[test]
fn nothing_that_is_read_is_written_over() {
    let folder = Folder::new("inputs");
    fs::write(folder.join("stage.yaml"), "abbe: 1\nname: stage\ntopology: FX\n").unwrap();
    fs::write(
        folder.join("known.yaml"),
        "calibration: 1\nmachine: stage.yaml\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\n",
    )
    .unwrap();
    let (recorded, files) = folder.recorded("stage.yaml", Some("known.yaml"));
    let inputs = [(files, &recorded)];
    for name in ["r.yaml", "d.csv", "known.yaml", "stage.yaml", "kept/../known.yaml"] {
        let refused = check_target(&folder.join(name), &inputs).err().unwrap_or_else(|| panic!("{name}"));
        assert!(words(&refused).contains("one of the files that the diagnosis reads"), "{name}");
        assert!(matches!(refused, Failure::Wrong(_)));
    }
    for (name, why) in [("kept", "is a folder"), ("none/new.yaml", "its folder does not exist")] {
        let refused = check_target(&folder.join(name), &inputs).err().unwrap_or_else(|| panic!("{name}"));
        assert!(words(&refused).contains(why), "{name}");
    }
    // A mapping says besides how the table is written.
    let text =
        fs::read_to_string(folder.join("r.yaml")).unwrap().replace("data: d.csv", "data: {file: d.csv}");
    let named = Files::named_in(&SourceFile::new("r.yaml", text), &folder.join("r.yaml"));
    assert!(named.all(None).contains(&folder.join("d.csv")));
    fs::write(folder.join("old.yaml"), "").unwrap();
    for name in ["new.yaml", "old.yaml"] {
        assert!(check_target(&folder.join(name), &inputs).is_ok(), "{name}");
    }
}
