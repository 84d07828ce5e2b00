//! Paths of the simulation: read for a machine with a little of everything, driven where the path is short, written and drawn.

use std::cell::OnceCell;

use model_dsl::calibration::Calibration;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use simulation::write::{self, Head};
use simulation::{Plant, file, picture};

use super::calibration::right;
use super::text::{findings_hold, machine, source};

/// Five axes, one position loop, one sensor and one load.
const CALIBRATION: &str = "calibration: 1
machine: trunnion-5axis
constants: {Ya: 1 mm, Za: 2 mm, Xc: 3 mm, Yc: 4 mm, Zc: 50 mm, Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}
errors:
  EXX: [{lag: {gain: 20 1/s}}, {backlash: {lost_motion: 10 um}}]
  EZZ: [{growth: {sensor: spindle, coefficient: 2 um/K, reference: 20 degC}}]
  EYY: [{compliance: {load: force, coefficient: 0.1 um/N}}]
";

/// A longer path is as good as a short one, and takes longer.
const MOST_INSTANTS: usize = 4_000;

thread_local! {
    static KNOWN: OnceCell<Calibration> = const { OnceCell::new() };
}

/// Takes a file of any bytes as a path file.
pub fn run(bytes: &[u8]) {
    let Some(source) = source(bytes) else { return };
    let machine = machine("trunnion-5axis");
    let names = machine.equations.names();
    let plant = KNOWN.with(|known| {
        let known = known.get_or_init(|| {
            let source = SourceFile::new("known.yaml", CALIBRATION);
            let root = yaml::read(&source, &mut Diagnostics::new());
            right(&root.unwrap_or_else(|| panic!("no YAML")), &machine)
        });
        Plant::new(&machine.machine, &names, known)
    });
    let mut plant = plant.unwrap_or_else(|error| panic!("{error}"));
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics);
    let file = root.and_then(|root| file::read(&root, &machine.machine, &names, &mut diagnostics));
    if let Some(file) = &file {
        file.fit(&machine.machine, &mut plant, &mut diagnostics);
    }
    findings_hold(&source, &diagnostics);
    let Some(file) = file.filter(|_| !diagnostics.has_errors()) else {
        return assert!(diagnostics.has_errors(), "neither a path nor an error");
    };
    let rotary: Vec<bool> = names.axes.iter().map(|axis| axis.rotary).collect();
    let short = file.scenario.path.timeline(&rotary);
    if short.is_ok_and(|timeline| timeline.instants().len() > MOST_INSTANTS) {
        return;
    }
    let Ok(simulated) = simulation::simulate(&plant, &file.scenario) else { return };
    let head = Head {
        machine: "trunnion-5axis".to_owned(),
        calibration: None,
        data: "data.csv".to_owned(),
        axes: names.axes.clone(),
    };
    let written = write::recording(&simulated, &head);
    let source = SourceFile::new("recording.yaml", written);
    let mut diagnostics = Diagnostics::new();
    assert!(yaml::read(&source, &mut diagnostics).is_some(), "{diagnostics:?}\n{}", source.text());
    let mut table = Vec::new();
    assert!(write::table(&simulated, &names.axes, &mut table).is_ok());
    assert!(!picture::svg(&simulated, &plant).contains("NaN"), "a drawing with what is no number");
}
