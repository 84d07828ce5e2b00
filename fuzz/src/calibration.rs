//! Calibration files: read, written and read again, run in a compensator, and made into an exact machine.

use abbe_runtime::{Compensator, Direction, ErrorMotion, Sample, Term, TermState, Work, states_needed};
use model_dsl::Compiled;
use model_dsl::calibration::{self, Calibration};
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::program::Interpreter;
use model_dsl::source::SourceFile;
use model_dsl::yaml::{self, Node};
use simulation::Plant;

use super::text::{findings_hold, machine, source};

/// Takes a file of any bytes as a calibration file.
pub fn run(bytes: &[u8]) {
    let Some(source) = source(bytes) else { return };
    let mut diagnostics = Diagnostics::new();
    let Some(root) = yaml::read(&source, &mut diagnostics) else {
        return findings_hold(&source, &diagnostics);
    };
    let name = calibration::machine_of(&root, &mut diagnostics);
    let machine = machine(name.as_ref().map_or("", |name| &name.value));
    let read = calibration::read(&root, &machine.equations.names(), &mut diagnostics);
    findings_hold(&source, &diagnostics);
    let Some(calibration) = read.filter(|_| name.is_some()) else {
        return assert!(diagnostics.has_errors(), "neither a calibration nor an error");
    };
    survives(&calibration, &machine);
    compensates(&calibration, &machine);
    let names = machine.equations.names();
    // What cannot be a machine is said; how far a machine is driven is for the paths to try.
    let _ = Plant::new(&machine.machine, &names, &calibration);
}

/// The calibration that a tree holds, for whoever needs one that is known to be right.
pub(crate) fn right(root: &Node, machine: &Compiled) -> Calibration {
    let mut diagnostics = Diagnostics::new();
    let read = calibration::read(root, &machine.equations.names(), &mut diagnostics);
    read.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

/// What is written means what was read.
fn survives(calibration: &Calibration, machine: &Compiled) {
    let names = machine.equations.names();
    let text = calibration::write(calibration, &names);
    let source = SourceFile::new("written.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let read = yaml::read(&source, &mut diagnostics)
        .and_then(|root| calibration::read(&root, &names, &mut diagnostics));
    let Some(read) = read else { panic!("{}\n{}", render(&source, &diagnostics, false), source.text()) };
    assert_eq!(calibration::write(&read, &names), source.text(), "written again it is another text");
}

/// The compensable terms, the rest left out, at a few positions: an answer is finite, or refused.
fn compensates(calibration: &Calibration, machine: &Compiled) {
    let equations = &machine.equations;
    let terms: Vec<Vec<Term<'_>>> = (0..equations.motions.len())
        .map(|motion| calibration.runtime(motion).flatten().flatten().collect())
        .collect();
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let interpreter = Interpreter::new(equations, &calibration.constants);
    let axes = equations.axes.len();
    let mut states = vec![TermState::default(); states_needed(&motions)];
    let mut directions = vec![[0.0; 3]; axes];
    let (mut values, mut travel) = (vec![0.0; equations.motions.len()], vec![0.0; equations.travels.len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let Ok(mut compensator) = Compensator::new(&interpreter, &motions, &mut states, work) else { return };
    compensator.limits = calibration.limits.of_compensator();
    let mut compensated = vec![0.0; axes];
    let temperature = vec![21.5; compensator.sensors()];
    for (place, direction) in
        [(0.0, Direction::Positive), (120.0, Direction::Positive), (-55.5, Direction::Negative)]
    {
        let sample = Sample {
            position: &vec![place; axes],
            travel: &[],
            direction: &vec![direction; axes],
            velocity: &vec![10.0; axes],
            temperature: &temperature,
            time_step: 0.01,
        };
        if let Ok(outcome) = compensator.compensate(&sample, &mut compensated) {
            let mut numbers = outcome.error.iter().chain(&outcome.remaining).chain(&compensated);
            assert!(numbers.all(|number| number.is_finite()), "{outcome:?} {compensated:?}");
        }
    }
}
