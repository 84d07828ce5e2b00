//! Measurements. In: a recording file. Out: the time and the memory that a process of its own needs to read and to diagnose it.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use diagnosis::Inputs;
use diagnosis::recording::read_header;
use model_dsl::calibration;
use model_dsl::diagnostic::Diagnostics;

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

/// What the process of its own does: it reads, diagnoses and says what that needed.
pub(crate) fn diagnose(path: &Path) {
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
    };
    let diagnosis = diagnosis::diagnose(&inputs, &mut |_| {});
    let wall = begun.elapsed().as_secs_f64();
    println!("{wall} {} {} {} {}", processor_time(), peak(), diagnosis.candidates, diagnosis.findings.len());
}

/// The processor time of this process, s.
fn processor_time() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    // Fields 14 and 15, in hundredths of a second; the second field, a name in brackets, may hold spaces.
    let fields = stat.rsplit(')').next().unwrap().split_whitespace().skip(11).take(2);
    fields.map(|ticks| ticks.parse::<f64>().unwrap()).sum::<f64>() / 100.0
}

/// The greatest memory of this process, bytes.
fn peak() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    line.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1024.0
}
