//! Measurements. In: a recording file. Out: the time and the memory that a process of its own needs to read and to diagnose it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use diagnosis::Inputs;
use model_dsl::calibration;
use model_dsl::diagnostic::Diagnostics;
use recording::read_header;

use crate::case::{machine, tree};

/// What a diagnosis needed.
pub(crate) struct Figures {
    /// s, from the start of reading to the end.
    pub(crate) wall: f64,
    /// s, of all processors.
    pub(crate) cpu: f64,
    /// Bytes, at their most.
    pub(crate) memory: f64,
    pub(crate) candidates: usize,
    pub(crate) findings: usize,
}

/// Diagnoses a recording in a process of its own.
pub(crate) fn measured(recording: &Path) -> Figures {
    let program = std::env::current_exe().unwrap();
    let output = Command::new(program).arg("--diagnose").arg(recording).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    let mut numbers = said.split_whitespace().map(|word| word.parse::<f64>().expect("a number"));
    let mut next = || numbers.next().expect("five numbers");
    let (wall, cpu, memory) = (next(), next(), next());
    let (candidates, findings) = (count(next()), count(next()));
    Figures { wall, cpu, memory, candidates, findings }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small counts")]
fn count(number: f64) -> usize {
    number as usize
}

/// Diagnoses recordings one after the other in a process of its own, which says of each what it needed.
pub(crate) fn in_a_row(recordings: &[PathBuf]) {
    let program = std::env::current_exe().unwrap();
    let status = Command::new(program).arg("--diagnose-in-a-row").args(recordings).status().unwrap();
    assert!(status.success(), "{status}");
}

/// What that process does.
pub(crate) fn diagnose_in_a_row(recordings: impl Iterator<Item = String>) {
    for (number, recording) in recordings.enumerate() {
        // From here on the greatest memory is counted anew.
        fs::write("/proc/self/clear_refs", "5").unwrap();
        let before = processor_time();
        let (wall, _, findings) = diagnosed(recording.as_ref());
        println!(
            "| {} | {wall:.1} | {:.1} | {:.0} | {:.0} | {findings} |",
            number + 1,
            processor_time() - before,
            memory("VmHWM:") / 1e6,
            memory("VmRSS:") / 1e6
        );
    }
}

/// What the process of its own does: it reads, diagnoses and says what that needed.
pub(crate) fn diagnose(path: &Path) {
    let (wall, candidates, findings) = diagnosed(path);
    println!("{wall} {} {} {candidates} {findings}", processor_time(), memory("VmHWM:"));
}

/// Reads and diagnoses a recording: how long that took, s, how many candidates there were, and how many findings.
fn diagnosed(path: &Path) -> (f64, usize, usize) {
    let begun = Instant::now();
    let (machine, names) = machine();
    let mut diagnostics = Diagnostics::new();
    let header = read_header(&tree(path), &machine.equations, &mut diagnostics).unwrap();
    let known = path.with_file_name(&header.calibration.as_ref().unwrap().value);
    let known = calibration::read(&tree(&known), &names, &mut diagnostics).unwrap();
    let recording = header.read_data(&path.with_file_name(&header.data.value)).unwrap();
    let inputs = Inputs {
        equations: &machine.equations,
        calibration: Some(&known),
        recordings: vec![&recording],
        holdout: None,
        calibration_file: None,
        chains: None,
    };
    let diagnosis = diagnosis::diagnose(&inputs, &mut |_| {});
    (begun.elapsed().as_secs_f64(), diagnosis.candidates, diagnosis.findings.len())
}

/// The processor time of this process, s.
fn processor_time() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    // Fields 14 and 15, in hundredths of a second; the second field, a name in brackets, may hold spaces.
    let fields = stat.rsplit(')').next().unwrap().split_whitespace().skip(11).take(2);
    fields.map(|ticks| ticks.parse::<f64>().unwrap()).sum::<f64>() / 100.0
}

/// The memory of this process, bytes: the greatest (`VmHWM:`) or that of now (`VmRSS:`).
fn memory(which: &str) -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix(which)).unwrap();
    line.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1024.0
}
