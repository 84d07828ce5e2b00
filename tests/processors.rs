//! A diagnosis on one processor and on several: the same bytes.
//!
//! In: recordings that are long enough to be shared out, with one channel and with two. Out: every number of processors says the
//! same, to the last digit of every figure.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::cli::abbe;
use crate::shipped::root;

/// What a diagnosis says on so many processors.
fn said(recording: &str, processors: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    command.args(["diagnose", recording, "--format", "json", "--quiet"]);
    let output = command.current_dir(root()).env("RAYON_NUM_THREADS", processors).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The shipped machine on a circle, read in two directions, 9000 rows.
fn two_channels(folder: &Path) -> String {
    let path = folder.join("path.yaml");
    let text = "path: 1\nat: {X: 275 mm, Y: 140 mm, Z: -50 mm}\n\
        circle: {plane: XY, radius: 60 mm, directions: [ccw, cw]}\nfeed: 1500 mm/min\nrate: 100 Hz\nruns: 3\n\
        instrument: {position: [x, y]}\nnoise: {white: 0.6 um, walk: {sigma: 1 um, after: 20 s}}\nmissing: 1 %\nseed: 3\n";
    fs::write(&path, text).unwrap();
    let output = folder.join("recorded");
    let (path, output) = (path.to_str().unwrap(), output.to_str().unwrap());
    let known = ["--known", "calibrations/postech-mill.yaml", "--output", output, "--quiet"];
    let simulate = ["simulate", "recordings/postech-ballbar/true.yaml", path];
    let run = abbe(&[&simulate[..], &known].concat(), "");
    assert_eq!(run.status, 0, "{}", run.err);
    format!("{output}/recording.yaml")
}

#[test]
fn any_number_of_processors_says_the_same() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("processors");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    for recording in ["recordings/postech-ballbar/recording.yaml", &two_channels(&folder)] {
        let alone = said(recording, "1");
        assert!(alone.contains("\"findings\""), "{alone}");
        // Three processors rarely get equal shares of the jobs.
        assert_eq!(said(recording, "3"), alone, "{recording}");
    }
}
