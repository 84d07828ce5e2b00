//! Positions as CSV, as `abbe compensate` reads them: the same columns, rows and states, with two calibrations that need much.

#[path = "../../src/positions/layout.rs"]
mod layout;
#[path = "../../src/positions/state.rs"]
mod state;

use std::cell::OnceCell;

use abbe_runtime::{Compensator, ErrorMotion, Term, TermState, Work, states_needed};
use csv::ByteRecord;
use layout::{Column, Layout, Wanted};
use model_dsl::calibration::Calibration;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use state::{State, quoted};
use workshop::rows::output_columns;

use super::calibration::right;
use super::text::machine;

/// Free travels and temperatures; and rotary axes, time and memory.
const CALIBRATIONS: [(&str, &str); 2] = [
    ("nist-turning-center", include_str!("../../calibrations/nist-turning-center.yaml")),
    (
        "trunnion-5axis",
        "calibration: 1
machine: trunnion-5axis
constants: {Ya: 1 mm, Za: 2 mm, Xc: 3 mm, Yc: 4 mm, Zc: 50 mm, Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}
errors:
  EXX: [{lag: {gain: 20 1/s}}, {backlash: {lost_motion: 10 um, ramp: 100 ms}}]
  EZZ: [{growth: {sensor: spindle, coefficient: 2 um/K, reference: 20 degC, time_constant: 600 s}}]
  EBX: [{polynomial: {axis: X, per: mm, unit: arcsec, coefficients: [0, 0.1, 1e-3]}}]
",
    ),
];

thread_local! {
    static KNOWN: OnceCell<Vec<Calibration>> = const { OnceCell::new() };
}

/// Takes a file of any bytes as positions.
pub fn run(bytes: &[u8]) {
    KNOWN.with(|known| {
        let known = known.get_or_init(|| CALIBRATIONS.iter().map(|(name, text)| read(name, text)).collect());
        for (calibration, (name, _)) in known.iter().zip(CALIBRATIONS) {
            compensate(bytes, calibration, &machine(name).equations);
        }
    });
}

fn read(name: &str, text: &str) -> Calibration {
    let root = yaml::read(&SourceFile::new("known.yaml", text), &mut Diagnostics::new());
    right(&root.unwrap_or_else(|| panic!("no YAML")), &machine(name))
}

/// Row by row; a bad one is left out, as with `--skip-bad`, and the next must still be taken or refused.
fn compensate(bytes: &[u8], calibration: &Calibration, equations: &Equations) {
    let mut rows = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(bytes);
    let mut rows = rows.byte_records().map_while(Result::ok).peekable();
    let Some(header) = rows.next() else { return };
    let units = rows.next_if(|row| row.get(0).is_some_and(|cell| cell.trim_ascii() == b"#unit"));
    let text = |cell: &[u8]| String::from_utf8_lossy(cell).trim().to_owned();
    let units: Option<Vec<String>> = units.map(|row| row.iter().skip(1).map(text).collect());
    let sensors = calibration.sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str()).collect();
    let wanted = Wanted { equations, sensors, time: Some("a term".to_owned()), timed: true, tools: true };
    assert!(!wanted.reads_number(b"#"));
    let layout = match Layout::read(&header, units.as_deref(), &wanted) {
        Ok(layout) => layout,
        Err(mistakes) => return assert!(mistakes.iter().all(|mistake| !mistake.is_empty())),
    };
    assert_eq!((layout.header.len(), layout.width), (header.len(), header.len()));
    assert!(layout.units.is_none() || units.is_some());
    assert!(layout.unread.len() <= header.len() && !output_columns(equations).is_empty());
    assert!(layout.unread.iter().all(|name| quoted(name).len() <= 200));
    let columns = layout.axes.clone();
    let mut state = State::new(layout, true, calibration, &vec![5e-4; equations.axes.len()]);
    let terms: Vec<Vec<Term<'_>>> = (0..equations.motions.len())
        .map(|motion| calibration.runtime(motion).flatten().flatten().collect())
        .collect();
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let interpreter = Interpreter::new(equations, &calibration.constants);
    let mut states = vec![TermState::default(); states_needed(&motions)];
    let mut directions = vec![[0.0; 3]; equations.axes.len()];
    let (mut values, mut travel) = (vec![0.0; equations.motions.len()], vec![0.0; equations.travels.len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let mut compensator =
        Compensator::new(&interpreter, &motions, &mut states, work).unwrap_or_else(|error| panic!("{error}"));
    let mut compensated = vec![0.0; equations.axes.len()];
    for row in rows {
        answer(&mut state, &row, &mut compensator, &columns, &mut compensated);
    }
}

fn answer(
    state: &mut State<'_>,
    row: &ByteRecord,
    compensator: &mut Compensator<'_, Interpreter>,
    columns: &[Column],
    compensated: &mut [f64],
) {
    if let Err(mistake) = state.take(row) {
        return assert!(!mistake.is_empty());
    }
    assert_eq!(state.tool(), None, "the calibrations have no tools");
    let Ok(outcome) = compensator.compensate(&state.sample(), compensated) else { return };
    let positions =
        compensated.iter().zip(columns).map(|(value, column)| value / column.factor - column.offset);
    let mut numbers = outcome.error.into_iter().chain(outcome.remaining).chain(positions);
    assert!(numbers.all(f64::is_finite), "{outcome:?} {compensated:?}");
}
