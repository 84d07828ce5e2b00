//! `abbe simulate` as its users meet it, and the exact machine against the oracle's.

use std::fs;
use std::path::{Path, PathBuf};

use model_dsl::diagnostic::Diagnostics;
use model_dsl::machine;
use model_dsl::source::{SourceFile, Span};
use proptest::prelude::*;
use simulation::{Plant, names_of};

use crate::beside::listed;
use crate::cli::{abbe, column};
use crate::oracle::{self, Sizes, draw, exact};
use crate::random::{machines, of_word, state, words};
use crate::shipped::SHIPPED;
use crate::yaml;

/// A machine of the compiler and its description, with errors of finite size on every error motion.
fn same_place(
    described: &oracle::Machine,
    machine: &machine::Machine,
    seed: u64,
) -> Result<(), TestCaseError> {
    let names = names_of(machine);
    let mut at = state(described, seed);
    // The simulation lets a free travel be the position of its axis.
    for link in described.links() {
        let position = link.variable().map_or(0.0, |variable| at.positions[&variable]);
        for travel in link.errors.iter().flatten().filter_map(|error| error.travel.clone()) {
            at.travels.insert(travel, position);
        }
    }
    // A hundred times what machines have, so that nothing linear could agree.
    let size = |angular: bool| if angular { 4e-3 } else { 5.0 };
    let motions: Vec<f64> =
        names.motions.iter().map(|motion| size(motion.angular) * draw(seed, &motion.name)).collect();
    at.errors = names.motions.iter().map(|motion| motion.name.clone()).zip(motions.iter().copied()).collect();
    let constants: Vec<f64> = names.constants.iter().map(|(name, _)| at.constants[name]).collect();
    let positions: Vec<f64> =
        names.axes.iter().map(|axis| at.positions[&axis.letter.to_ascii_lowercase()]).collect();
    let plant = Plant::perfect(machine, &names, &constants).unwrap();
    let tip = plant.pose(&positions, &motions).tip;
    let bound = Sizes::of(described, &at).rounding();
    let turned = plant.pose(&positions, &motions).turn * plant.nominal(&positions).turn.inverse();
    for (own, other) in turned.scaled_axis().iter().zip(exact::turn_by_errors(described, &at)) {
        // The cosine, from which this rotation vector comes, is blunt for small angles.
        prop_assert!((own - other).abs() <= 1e-7, "{own} {other}");
    }
    for (own, other) in tip.iter().zip(exact::tip(described, &at)) {
        prop_assert!((own - other).abs() <= bound, "{own} {other} {bound}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Every convention of the machine file, on random chains.
    #[test]
    fn random_machines_stand_where_the_oracle_has_them(described in machines(), seed in any::<u64>()) {
        let text = yaml::text(&described, true);
        let mut findings = Diagnostics::new();
        let machine = machine::read(&SourceFile::new("machine.yaml", text.clone()), &mut findings);
        let machine = machine.expect(&text);
        same_place(&described, &machine, seed)?;
    }

    #[test]
    fn topology_words_stand_where_the_oracle_has_them(word in words(), seed in any::<u64>()) {
        let machine = machine::from_word(&word, Span::default(), &mut Diagnostics::new()).unwrap();
        same_place(&of_word(&word), &machine, seed)?;
    }
}

#[test]
fn shipped_machines_stand_where_the_oracle_has_them() {
    for shipped in SHIPPED {
        let source = SourceFile::new(shipped.name, shipped.text());
        let machine = machine::read(&source, &mut Diagnostics::new()).unwrap();
        for seed in 0..20 {
            same_place(&(shipped.described)(), &machine, seed).unwrap_or_else(|error| {
                panic!("{}: {error}", shipped.name);
            });
        }
    }
}

/// A folder of a test's own, empty.
fn folder(test: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("simulate").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

const CALIBRATION: &str = "calibration: 1\nmachine: xyfz-mill\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\nerrors:\n  EXX: [{backlash: {lost_motion: 8 um}}]\n";
const KNOWN: &str =
    "calibration: 1\nmachine: xyfz-mill\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\nerrors: {}\n";
const PATH: &str = "path: 1\ntitle: a line\nat: {Y: 100 mm}\nline: {axis: X, from: 0 mm, to: 50 mm}\nfeed: 10 mm/s\nrate: 20 Hz\nruns: 2\ninstrument: position\nnoise: {white: 0.2 um}\nseed: 3\n";

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_simulation_writes_a_recording_that_conceals_what_is_not_known() {
    let folder = folder("conceals");
    let [full, known, path] = [("full.yaml", CALIBRATION), ("known.yaml", KNOWN), ("path.yaml", PATH)]
        .map(|(name, text)| write(&folder, name, text));
    let output = folder.join("out/deep");
    let arguments = ["simulate", &full, &path, "--output", output.to_str().unwrap(), "--known", &known];
    let run = abbe(&arguments, "");
    assert_eq!((run.status, run.out.as_str()), (0, ""), "{}", run.err);
    let recording = fs::read_to_string(output.join("recording.yaml")).unwrap();
    for line in
        ["title: a line", "machine: xyfz-mill", "calibration: ../../known.yaml", "instrument: position"]
    {
        assert!(recording.lines().any(|own| own == line), "{line} in {recording}");
    }
    let data = fs::read_to_string(output.join("data.csv")).unwrap();
    let (command, measured) = (column(&data, "x_cmd"), column(&data, "x_meas"));
    let half = |rows: std::ops::Range<usize>| {
        let count = rows.len() as f64;
        rows.map(|row| measured[row] - command[row]).sum::<f64>() / count
    };
    assert!((half(1..100) + 0.004).abs() < 1e-4 && (half(101..200) - 0.004).abs() < 1e-4);
    // Again: refused; forced: the same bytes; with another seed: others.
    let again = abbe(&arguments, "");
    assert_eq!(again.status, 2);
    assert!(again.err.contains("already exists") && again.err.contains("--force"), "{}", again.err);
    let forced = |seed: &str| {
        let run = abbe(&[&arguments[..], &["--force", "--seed", seed]].concat(), "");
        assert_eq!(run.status, 0, "{}", run.err);
        fs::read_to_string(output.join("data.csv")).unwrap()
    };
    assert_eq!(forced("3"), data);
    assert_ne!(forced("4"), data);
}

#[test]
fn a_recording_may_have_a_name_and_a_machine_of_its_own() {
    let folder = folder("named");
    let machine = "abbe: 1\nname: stage\ntopology: FX\n";
    write(&folder, "stage.yaml", machine);
    let constants = "constants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\n";
    let calibration = write(
        &folder,
        "numbers.yaml",
        &format!("calibration: 1\nmachine: stage.yaml\n{constants}errors: {{EXX: 1 um}}\n"),
    );
    let path = write(&folder, "path.yaml", &PATH.replace("at: {Y: 100 mm}\n", ""));
    let output = folder.join("recordings/first.yaml");
    let run = abbe(&["simulate", &calibration, &path, "--output", output.to_str().unwrap()], "");
    assert_eq!(run.status, 0, "{}", run.err);
    let recording = fs::read_to_string(output).unwrap();
    assert!(
        recording.contains("machine: ../stage.yaml\n") && recording.contains("data: first.csv\n"),
        "{recording}"
    );
    assert!(!recording.contains("calibration:"));
    assert!(folder.join("recordings/first.csv").is_file());
}

#[test]
fn mistakes_end_with_status_two_and_write_nothing() {
    let folder = folder("mistakes");
    let calibration = write(&folder, "full.yaml", CALIBRATION);
    let wrong = write(&folder, "wrong.yaml", &PATH.replace("runs", "rnus"));
    let good = write(&folder, "path.yaml", PATH);
    let other = write(&folder, "other.yaml", "calibration: 1\nmachine: FX\nerrors: {}\n");
    let output = folder.join("out");
    let output = output.to_str().unwrap();
    for (arguments, words) in [
        (vec![calibration.as_str(), wrong.as_str()], "did you mean `runs`?"),
        (vec![&calibration, &good, "--known", &other], "not of xyfz-mill"),
        (vec![&calibration, "nowhere.yaml"], "nowhere.yaml"),
        (vec![&good, &good], "calibration"),
        (vec![&calibration, &calibration], "begin a path file with `path: 1`"),
    ] {
        let run = abbe(&[&["simulate"], &arguments[..], &["--output", output]].concat(), "");
        assert_eq!((run.status, run.out.as_str()), (2, ""), "{arguments:?}");
        assert!(run.err.contains(words), "{arguments:?}: {}", run.err);
        assert!(!Path::new(output).exists(), "{arguments:?}");
    }
}

#[test]
fn a_simulation_goes_over_no_file_that_it_reads() {
    let folder = folder("over");
    let machine = write(&folder, "stage.yaml", "abbe: 1\nname: stage\ntopology: FX\n");
    let of_stage = |text: &str| text.replace("xyfz-mill", "stage.yaml").replace("at: {Y: 100 mm}\n", "");
    let calibration = write(&folder, "full.yaml", &of_stage(CALIBRATION));
    let known = write(&folder, "known.yaml", &of_stage(KNOWN));
    let path = write(&folder, "path.yaml", &of_stage(PATH));
    let measured = folder.join("measured");
    let at = |name: &str| measured.join(name).to_str().unwrap().to_owned();
    let made = ["simulate", &calibration, &path, "--output", measured.to_str().unwrap(), "--known", &known];
    assert_eq!(abbe(&made, "").status, 0);
    let (recording, data) = (at("recording.yaml"), at("data.csv"));
    let link = folder.join("link.yaml").to_str().unwrap().to_owned();
    #[cfg(unix)]
    std::os::unix::fs::symlink(&calibration, &link).unwrap();
    let all = [&machine, &calibration, &known, &path, &recording, &data];
    let texts = || all.map(|file| fs::read_to_string(file).unwrap());
    let before = texts();
    for (driven, output) in [
        (&path, &calibration),
        (&path, &machine),
        (&path, &known),
        (&path, &path),
        (&path, &link),
        (&recording, &recording),
        (&recording, &measured.to_str().unwrap().to_owned()),
        // A recording of this name would have the data beside it.
        (&recording, &at("data.yaml")),
    ] {
        if !Path::new(output).exists() && *output == link {
            continue;
        }
        let arguments = ["simulate", &calibration, driven, "--output", output, "--force", "--known", &known];
        let run = abbe(&arguments, "");
        assert_eq!(run.status, 2, "{driven} to {output}: {}", run.err);
        assert!(run.err.contains("is one of the files that this command reads"), "{}", run.err);
        assert_eq!(texts(), before, "{driven} to {output}");
    }
}

/// Recordings from another simulation of the same page, in `../shared/concealed`: what its truth adds to its calibration
/// must leave nothing but the noise that the truth states.
#[test]
fn another_simulation_agrees_but_for_its_noise() {
    let Some(folders) = listed("concealed") else { return };
    let mut seen = 0;
    for folder in folders.into_iter().filter(|path| path.is_dir()) {
        let case = concealed::Case::read(&folder);
        if !matches!(case.word("verdict").as_str(), "left-out-physics" | "adequate") {
            continue;
        }
        let left = case.left_over();
        let noise: f64 = case.word("noise_rms").parse().unwrap();
        assert!((left / noise - 1.0).abs() < 0.005, "{}: {left} is left, {noise} is noise", folder.display());
        seen += 1;
    }
    assert!(seen > 0, "no example is to be explained");
}

/// Reading the examples of another simulation.
mod concealed {
    use std::collections::BTreeMap;
    use std::fmt::Write;
    use std::fs;
    use std::path::Path;

    use model_dsl::calibration;
    use model_dsl::diagnostic::{Diagnostics, render};
    use model_dsl::machine::{self, Machine};
    use model_dsl::source::{SourceFile, Span};
    use model_dsl::yaml::{self, Node};
    use simulation::{Column, Commands, Instrument, Measurement, Plant, names_of, replay};

    use crate::shipped::SHIPPED;

    /// One example.
    pub(super) struct Case {
        recording: Node,
        truth: Node,
        calibration: Option<String>,
        columns: BTreeMap<String, Vec<f64>>,
    }

    fn tree(path: &Path) -> Node {
        let source = SourceFile::new(path.display().to_string(), fs::read_to_string(path).unwrap());
        yaml::read(&source, &mut Diagnostics::new()).unwrap()
    }

    fn text(node: &Node, key: &str) -> String {
        node.get(key).and_then(Node::text).unwrap_or_default().to_owned()
    }

    fn number(node: &Node) -> f64 {
        node.text().unwrap().trim_end_matches(" mm").parse().unwrap()
    }

    impl Case {
        pub(super) fn read(folder: &Path) -> Self {
            let recording = tree(&folder.join("recording.yaml"));
            let data = fs::read_to_string(folder.join("data.csv")).unwrap();
            let mut lines = data.lines();
            let header: Vec<&str> = lines.next().unwrap().split(',').collect();
            let mut table: Vec<Vec<f64>> = vec![Vec::new(); header.len()];
            for line in lines {
                for (column, cell) in table.iter_mut().zip(line.split(',')) {
                    column.push(cell.parse().unwrap_or(f64::NAN));
                }
            }
            let of_column: BTreeMap<&str, Vec<f64>> = header.into_iter().zip(table).collect();
            let channels = recording.get("channels").unwrap().entries().unwrap();
            let columns = channels.iter().map(|(name, node)| {
                let factor = if text(node, "unit") == "deg" { 1_f64.to_radians() } else { 1.0 };
                let values = of_column[text(node, "column").as_str()].iter().map(|value| value * factor);
                (name.value.clone(), values.collect())
            });
            Self {
                columns: columns.collect(),
                truth: tree(&folder.join("truth.yaml")),
                calibration: fs::read_to_string(folder.join("calibration.yaml")).ok(),
                recording,
            }
        }

        pub(super) fn word(&self, key: &str) -> String {
            text(&self.truth, key)
        }

        fn machine(&self) -> Machine {
            let name = text(&self.recording, "machine");
            let mut findings = Diagnostics::new();
            let machine = match SHIPPED.iter().find(|shipped| shipped.name == name) {
                Some(shipped) => machine::read(&SourceFile::new(&*name, shipped.text()), &mut findings),
                None => machine::from_word(&name, Span::default(), &mut findings),
            };
            machine.unwrap()
        }

        /// The calibration with the findings of the truth added to it.
        fn full(&self) -> String {
            let mut text = self.calibration.clone().unwrap_or_else(|| {
                format!("calibration: 1\nmachine: {}\nerrors:\n", text(&self.recording, "machine"))
            });
            for finding in self.truth.get("findings").unwrap().items().unwrap() {
                let motion = self::text(finding, "motion");
                let item = format!("    - {}\n", self.term(finding, &motion));
                let head = format!("  {motion}:\n");
                match text.find(&head) {
                    Some(at) => text.insert_str(at + head.len(), &item),
                    None => text.push_str(&(head + &item)),
                }
            }
            text
        }

        fn term(&self, finding: &Node, motion: &str) -> String {
            let degrees = self.word("unit") == "deg";
            let angular = "ABC".contains(&motion[1..2]);
            let length = if degrees {
                "deg"
            } else if angular {
                "rad"
            } else {
                "mm"
            };
            let mut parameters = String::new();
            for (name, value) in finding.get("parameters").unwrap().entries().unwrap() {
                let name = name.value.as_str();
                let unit = match name {
                    "value" | "lost_motion" | "amplitude" => length,
                    "period" => {
                        if degrees {
                            "deg"
                        } else {
                            "mm"
                        }
                    }
                    "phase" => "rad",
                    "gain" | "frequency" => "1/s",
                    "time_constant" => "s",
                    "reference" => "degC",
                    "coefficient" if text(finding, "term") == "expansion" => "mm/mm/K",
                    "coefficient" => {
                        if angular {
                            "rad/K"
                        } else {
                            "mm/K"
                        }
                    }
                    "coefficients" => {
                        let list: Vec<&str> = value.items().unwrap().iter().filter_map(Node::text).collect();
                        let _ = write!(
                            parameters,
                            "per: mm, unit: {length}, coefficients: [{}], ",
                            list.join(", ")
                        );
                        continue;
                    }
                    _ => "",
                };
                let _ = write!(parameters, "{name}: {} {unit}, ", value.text().unwrap());
            }
            let term = text(finding, "term");
            format!("{term}: {{{}}}", parameters.trim_end_matches(", "))
        }

        fn commands(&self, axes: &[calibration::AxisName]) -> Commands {
            let column = |name: String| self.columns[&name].clone();
            let named = |kind: &str| {
                let own = self.columns.iter().filter_map(|(name, values)| {
                    let name = name.strip_prefix(kind)?.to_owned();
                    Some(Column { name, unit: String::new(), values: values.clone() })
                });
                own.collect::<Vec<_>>()
            };
            Commands {
                time: column("time".to_owned()),
                run: column("run".to_owned())
                    .iter()
                    .map(|run| format!("{run:.0}").parse().unwrap())
                    .collect(),
                positions: axes
                    .iter()
                    .map(|axis| column(format!("command.{}", axis.letter.to_ascii_lowercase())))
                    .collect(),
                temperatures: named("temperature."),
                ..Commands::default()
            }
        }

        fn instrument(&self, rotary: bool) -> Instrument {
            let setup = self.recording.get("setup");
            match text(&self.recording, "instrument").as_str() {
                "ballbar" => {
                    let setup = setup.unwrap();
                    let center: Vec<f64> =
                        setup.get("center").unwrap().items().unwrap().iter().map(number).collect();
                    let mut eccentricity = [0.0; 3];
                    for term in self.truth.get("instrument").unwrap().items().unwrap() {
                        let given = term.get("parameters").unwrap();
                        for (slot, key) in eccentricity.iter_mut().zip(["x", "y", "z"]) {
                            *slot = given.get(key).map_or(0.0, number);
                        }
                    }
                    Instrument::Ballbar {
                        center: Some([center[0], center[1], center[2]]),
                        radius: setup.get("radius").map(number),
                        eccentricity,
                        offset: 0.0,
                    }
                }
                "linear" => Instrument::Linear { axis: 1, direction: [0.0, 1.0, 0.0], cosine: 0.0 },
                _ if rotary => Instrument::Position { directions: [false; 3], angles: vec![0] },
                _ => {
                    let has = |letter: &str| self.columns.contains_key(&format!("measured.{letter}"));
                    Instrument::Position { directions: ["x", "y", "z"].map(has), angles: Vec::new() }
                }
            }
        }

        /// What is left of the readings, root mean square, the mean of each channel taken off.
        pub(super) fn left_over(&self) -> f64 {
            let machine = self.machine();
            let names = names_of(&machine);
            let source = SourceFile::new("full.yaml", self.full());
            let mut findings = Diagnostics::new();
            let root = yaml::read(&source, &mut findings).unwrap();
            let numbers = calibration::read(&root, &names, &mut findings);
            let numbers = numbers.unwrap_or_else(|| panic!("{}", render(&source, &findings, false)));
            let plant = Plant::new(&machine, &names, &numbers).unwrap();
            let rotary = names.axes.iter().all(|axis| axis.rotary);
            let measurement = Measurement::perfect(self.instrument(rotary));
            let predicted = replay(&plant, &self.commands(&names.axes), &measurement).unwrap();
            let mut measured: Vec<&Vec<f64>> = ["x", "y", "z", "c"]
                .iter()
                .filter_map(|letter| self.columns.get(&format!("measured.{letter}")))
                .collect();
            measured.extend(self.columns.get("deviation"));
            let (mut square, mut count) = (0.0, 0.0);
            for (measured, reading) in measured.iter().zip(&predicted.readings) {
                let left = measured.iter().zip(&reading.values).map(|(measured, value)| measured - value);
                let left: Vec<f64> = left.filter(|value| value.is_finite()).collect();
                let mean = left.iter().sum::<f64>() / left.len() as f64;
                square += left.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
                count += left.len() as f64;
            }
            let unit = if self.word("unit") == "deg" { 1_f64.to_radians() } else { 1.0 };
            (square / count).sqrt() / unit
        }
    }
}
