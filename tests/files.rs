//! Files and streams of a real system. In: the program, and files as other programs, other systems and accidents leave them.
//! Out: an answer, or an error that names the file; never half a file, and never a panic.

mod read;
mod streams;
mod written;

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use crate::shipped::root;

/// The program in the root of the repository, without a terminal and without input.
fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    for name in ["CI", "CLICOLOR", "CLICOLOR_FORCE", "NO_COLOR"] {
        command.env_remove(name);
    }
    command.current_dir(root()).stdin(Stdio::null());
    command
}

/// What the program leaves behind with these arguments.
fn run<I: AsRef<OsStr>>(arguments: &[I]) -> Output {
    program().args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// An end that was meant: 0, 1 or 2, and no panic told.
fn status(output: &Output) -> i32 {
    let err = text(&output.stderr);
    let status = output.status.code();
    assert!(!err.contains("panicked") && status.is_some(), "{:?}\n{err}", output.status);
    status.filter(|status| (0..=2).contains(status)).unwrap_or_else(|| panic!("{status:?}\n{err}"))
}

/// An empty folder of the test's own.
fn folder(test: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("files").join(test);
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// A stage with a scale error, and a short recording of it: what every command can work on.
const MACHINE: &str =
    "abbe: 1\nname: stage\nchain: {tool: [{slide: X, along: +X}, {tool: tip, offset: [0, 0, Zt]}]}\n";
const CALIBRATION: &str = "calibration: 1\nmachine: machine.yaml\nconstants: {Zt: 50 mm}\nlimits: {compensation: 1 mm}\nerrors:\n  EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 1]}}]\n";
const RECORDING: &str = "recording: 1\nmachine: machine.yaml\ncalibration: calibration.yaml\ninstrument: position\ndata: data.csv\nchannels: {time: {column: t, unit: s}, run: {column: run}, command.x: {column: x, unit: mm}, measured.x: {column: m, unit: mm}}\n";
const PATH: &str = "path: 1\nline: {axis: X, from: 0 mm, to: 20 mm, stations: {count: 3, dwell: 1 s}}\nfeed: 600 mm/min\nrate: 5 Hz\nruns: 2\npause: 1 s\ninstrument: position\n";
const EQUATIONS: &str = "dPx = EXX + Zt*EBX\n";
const POSITIONS: &str = "x\n1\n2\n";

/// The stage there and back, twice.
fn data() -> String {
    let places = [0.0, 10.0, 20.0, 10.0, 0.0];
    let rows = (0..10).map(|row| {
        let place: f64 = places[row % 5];
        format!(
            "{row},{},{place},{}\n",
            row / 5 + 1,
            place * 1.002 + if row % 5 > 2 { -0.004 } else { 0.004 }
        )
    });
    format!("t,run,x,m\n{}", rows.collect::<String>())
}

const SET_UP: &str = "setup: 1\nmachine: machine.yaml\nconstants: {Zt: 50 mm}\nmeasurements: [{motion: EXX, data: readings.csv}]\n";

const READINGS: &str =
    "run,direction,x,deviation\n#unit,,,mm,um\n1,+1,0,0.4\n1,+1,50,1.1\n1,-1,50,4.9\n1,-1,0,4.1\n";

/// The stage there and back six times, its readings off by a micrometre or so.
fn noisy() -> String {
    let rows = (0..120_u32).map(|row| {
        let (run, place) = (row / 20, f64::from(10 - (i32::try_from(row % 20).unwrap() - 10).abs()));
        let noise = f64::from(row.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
        format!("{row},{},{place},{}\n", run + 1, place * 1.001 + 0.002 * noise)
    });
    format!("t,run,x,m\n{}", rows.collect::<String>())
}

/// The path with noise, and runs enough to hold one out.
fn noisy_path() -> String {
    PATH.replace("count: 3", "count: 11").replace("runs: 2", "runs: 6") + "noise: {white: 1 um}\n"
}

/// The files of the stage in a folder.
fn stage(folder: &Path) {
    let data = data();
    for (name, text) in [
        ("machine.yaml", MACHINE),
        ("calibration.yaml", CALIBRATION),
        ("recording.yaml", RECORDING),
        ("data.csv", &data),
        ("path.yaml", PATH),
        ("noisy.yaml", &RECORDING.replace("data.csv", "noisy.csv")),
        ("noisy.csv", &noisy()),
        ("noisy-path.yaml", &noisy_path()),
        ("stage.eqs", EQUATIONS),
        ("positions.csv", POSITIONS),
        ("set-up.yaml", SET_UP),
        ("readings.csv", READINGS),
        ("fleet.yaml", FLEET),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
}

/// The stage as a fleet of one machine.
const FLEET: &str = "fleet: 1\nmachines: {stage: {recordings: recording.yaml}}\n";

/// What the stage could show, in few diagnoses.
const LIMITS: &[&str] = &["limits", "@/noisy.yaml", "--only", "X,backlash", "--trials", "4"];
const PLAN: &[&str] = &[
    "plan",
    "@/noisy-path.yaml",
    "--calibration",
    "@/calibration.yaml",
    "--only",
    "X,backlash",
    "--trials",
    "4",
];

/// Every command that reads a file, with the file and the arguments behind it; `@` is the folder of the stage.
const READERS: [(&str, &[&str]); 15] = [
    ("machine.yaml", &["derive", "@/machine.yaml"]),
    ("machine.yaml", &["expand", "@/machine.yaml"]),
    ("calibration.yaml", &["expand", "@/machine.yaml", "--calibration", "@/calibration.yaml"]),
    ("stage.eqs", &["check", "@/machine.yaml", "@/stage.eqs"]),
    ("calibration.yaml", &["compensate", "@/calibration.yaml"]),
    ("path.yaml", &["simulate", "@/calibration.yaml", "@/path.yaml", "--output", "@/out", "--force"]),
    (
        "recording.yaml",
        &["simulate", "@/calibration.yaml", "@/recording.yaml", "--output", "@/out", "--force"],
    ),
    ("data.csv", &["diagnose", "@/recording.yaml"]),
    ("noisy.csv", LIMITS),
    ("noisy-path.yaml", PLAN),
    ("recording.yaml", &["evaluate", "@/recording.yaml"]),
    ("data.csv", &["evaluate", "@/recording.yaml"]),
    ("recording.yaml", &["update", "@/calibration.yaml", "@/recording.yaml"]),
    ("set-up.yaml", &["calibrate", "@/set-up.yaml"]),
    ("readings.csv", &["calibrate", "@/set-up.yaml"]),
];

/// The arguments with the folder in its place.
fn placed(arguments: &[&str], folder: &Path) -> Vec<String> {
    arguments.iter().map(|argument| argument.replacen('@', folder.to_str().unwrap(), 1)).collect()
}

/// Runs a command on the stage in a folder; positions are on standard input.
fn on_stage(arguments: &[&str], folder: &Path) -> Output {
    let positions = fs::File::open(folder.join("positions.csv")).unwrap();
    program().args(placed(arguments, folder)).stdin(positions).output().unwrap()
}
