//! Cases. In: how many rows, channels and temperature sensors. Out: the files of a recording, the same every time.

use std::fs;
use std::path::{Path, PathBuf};

use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml::{self, Node};
use model_dsl::{Compiled, calibration, compile};
use simulation::write::{self, Head};
use simulation::{Plant, file, simulate};

/// One recording.
pub(crate) struct Case {
    pub(crate) rows: usize,
    /// Of x, y and z, in this order.
    pub(crate) channels: usize,
    /// Temperature sensors, each of which adds candidates to every error motion.
    pub(crate) sensors: usize,
    /// What the noise is drawn from.
    pub(crate) seed: u64,
}

/// The seed of a case that is not one of many.
pub(crate) const SEED: u64 = 11;

/// Runs of two circles each; the radius, mm, and the feed, mm/s.
const RUNS: usize = 4;
const RADIUS: f64 = 100.0;
const FEED: f64 = 1000.0 / 60.0;

impl Case {
    /// Simulates it into a folder of its own; the recording file.
    pub(crate) fn recorded(&self, folder: &Path) -> PathBuf {
        let Self { rows, channels, sensors, seed } = self;
        let folder = folder.join(format!("{rows}-{channels}-{sensors}-{seed}"));
        let recording = folder.join("recording.yaml");
        if recording.exists() {
            return recording;
        }
        fs::create_dir_all(&folder).unwrap();
        // The machine as it is: what is published, and two effects that the calibration does not have.
        let (machine, names) = machine();
        let truth = root().join("recordings/postech-ballbar/true.yaml");
        let mut diagnostics = Diagnostics::new();
        let truth = calibration::read(&tree(&truth), &names, &mut diagnostics).unwrap();
        let path = yaml::read(&SourceFile::new("path.yaml", self.path()), &mut diagnostics).unwrap();
        let path = file::read(&path, &machine.machine, &names, &mut diagnostics)
            .unwrap_or_else(|| panic!("{diagnostics:?}"));
        let mut plant = Plant::new(&machine.machine, &names, &truth).unwrap();
        path.fit(&machine.machine, &mut plant, &mut diagnostics);
        let simulated = simulate(&plant, &path.scenario).unwrap();
        let known = root().join("calibrations/postech-mill.yaml");
        let head = Head {
            machine: "postech-mill".to_owned(),
            calibration: Some(known.to_str().unwrap().to_owned()),
            data: "data.csv".to_owned(),
            axes: names.axes.clone(),
        };
        fs::write(&recording, write::recording(&simulated, &head)).unwrap();
        let table = fs::File::create(recording.with_file_name(&head.data)).unwrap();
        write::table(&simulated, &head.axes, table).unwrap();
        recording
    }

    /// The path file: as many rows in the same time, whatever their number.
    fn path(&self) -> String {
        let seconds = 2.0 * std::f64::consts::TAU * RADIUS / FEED;
        let rate = self.rows as f64 / RUNS as f64 / seconds;
        let channels = ["x", "y", "z"][..self.channels].join(", ");
        let sensor = |number: usize| {
            format!(
                "  sensor{number}: {{start: 20 degC, steps: [{{at: 0 s, to: {} degC}}], time_constant: {} s, noise: 0.02 K}}\n",
                25 + number,
                120 + 60 * number
            )
        };
        let sensors: String = (0..self.sensors).map(sensor).collect();
        let temperatures =
            if sensors.is_empty() { String::new() } else { format!("temperatures:\n{sensors}") };
        format!(
            "path: 1
at: {{X: 275 mm, Y: 140 mm, Z: -50 mm}}
circle: {{plane: XY, radius: {RADIUS} mm, directions: [ccw, cw]}}
feed: {} mm/min
rate: {rate:.6} Hz
runs: {RUNS}
pause: 2 s
instrument: {{position: [{channels}]}}
noise: {{white: 0.6 um, resolution: 0.1 um}}
seed: {}
{temperatures}",
            FEED * 60.0,
            self.seed
        )
    }
}

/// The shipped mill and its names.
pub(crate) fn machine() -> (Compiled, calibration::MachineNames) {
    let path = root().join("machines/postech-mill.yaml");
    let source = SourceFile::new("postech-mill.yaml", fs::read_to_string(path).unwrap());
    let compiled = compile(&source, &mut Diagnostics::new()).unwrap();
    let names = compiled.equations.names();
    (compiled, names)
}

/// The tree of a file.
pub(crate) fn tree(path: &Path) -> Node {
    let text = fs::read_to_string(path).unwrap();
    yaml::read(&SourceFile::new(path.display().to_string(), text), &mut Diagnostics::new()).unwrap()
}

/// The folder of the repository.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
