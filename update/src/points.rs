//! Points: every reading of every part, with what each coefficient moves it by.
//!
//! In: recordings and the coefficients of a calibration. Out: for each reading its direction, its deviation and, for each
//! coefficient A, the displacement along the direction that A itself makes there: `(n . L) phi A`. A relative change dA adds
//! dA times that. What the calibration itself predicts is no sum of these, but the product of finite matrices. Rows are gone
//! through in their order, also those without a reading: they show from where an axis came. A part whose datum is free is then turned to
//! where its readings have it ([`crate::setup`]), and directions and lever arms are those of the part that is turned.

use abbe_runtime::{Direction, DirectionTracker, ErrorMotion, Sample, Term, TermState};
use model_dsl::calibration::{Calibration, SensorReadings};
use model_dsl::equations::Equations;
use model_dsl::exact::{Columns, ExactProduct};
use model_dsl::program::Interpreter;
use recording::{Instrument, PartReading, Recording};

use crate::coefficient::Coefficient;
use crate::error::UpdateError;
use crate::setup::Setup;
use crate::update::Part;

/// How far an axis must move back before its direction turns, mm or rad: the rounding of a programmed position.
const HYSTERESIS: f64 = 1e-9;

/// One reading.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// The set-up that it was measured in, by number over all recordings.
    pub(crate) setup: usize,
    /// The direction of the reading, part frame, a unit vector.
    pub(crate) direction: [f64; 3],
    /// The deviation along it, mm.
    pub(crate) deviation: f64,
    /// Whether it is kept for the test.
    pub(crate) held_out: bool,
    /// What is expected there, mm: what the calibration predicts, unless the machine has taken it off, of the part as it lies.
    pub(crate) expected: f64,
    /// What each coefficient displaces it by, mm.
    pub(crate) shares: Vec<f64>,
    /// What each radian more of the part's rotation about X, Y and Z makes of it, mm; 0 where the part does not turn.
    pub(crate) levers: [f64; 3],
}

/// All readings, the parts that they are of, and how these were set up.
pub(crate) struct Points {
    pub(crate) points: Vec<Point>,
    pub(crate) parts: Vec<Part>,
    pub(crate) setups: Vec<Setup>,
}

/// What the points are taken with.
pub(crate) struct Machine<'m> {
    pub(crate) equations: &'m Equations,
    pub(crate) calibration: &'m Calibration,
    pub(crate) coefficients: &'m [Coefficient],
    /// Whether it has taken off what the calibration predicts.
    pub(crate) compensated: bool,
}

impl Machine<'_> {
    /// The readings of all recordings.
    pub(crate) fn points(&self, recordings: &[&Recording]) -> Result<Points, UpdateError> {
        let mut all = Points { points: Vec::new(), parts: Vec::new(), setups: Vec::new() };
        for (number, recording) in recordings.iter().enumerate() {
            let is_read = matches!(
                recording.instrument,
                Instrument::Probe | Instrument::Position | Instrument::Ballbar { .. }
            );
            if !is_read {
                return Err(UpdateError::Instrument { recording: number });
            }
            let constants = recording.constants(&self.calibration.constants);
            let interpreter = Interpreter::new(self.equations, &constants);
            let exact = ExactProduct::new(self.equations, &constants);
            let course = Course::of(self, recording, number)?;
            let rows = course.rows(&interpreter, &exact);
            let setups: Vec<Setup> =
                (0..course.runs.len()).map(|place| course.setup(number, place, &rows)).collect();
            let (points, left_out) = course.points(&rows, &setups, all.setups.len());
            all.setups.extend(setups);
            all.parts.push(Part {
                file: recording.file.clone(),
                title: recording.title.clone(),
                points: points.iter().filter(|point| !point.held_out).count(),
                held_out: points.iter().filter(|point| point.held_out).count(),
                left_out,
                standing: course.standing(),
            });
            all.points.extend(points);
        }
        Ok(all)
    }
}

/// A row that holds a reading.
struct Row {
    /// Its set-up, by the place of its run among those of the recording.
    setup: usize,
    held_out: bool,
    /// The tip as programmed, and how far the calibration has it off, mm.
    nominal: [f64; 3],
    error: [f64; 3],
    /// The value of each coefficient's term with the coefficient 1.
    values: Vec<f64>,
    /// The lever arms of the error motions.
    levers: Vec<[f64; 3]>,
    /// Directions, and the deviations along them.
    readings: Vec<([f64; 3], f64)>,
}

impl Row {
    /// Where the point is expected of a part that lies as its frame says.
    fn place(&self, compensated: bool) -> [f64; 3] {
        if compensated { self.nominal } else { minus(self.nominal, self.error.map(|part| -part)) }
    }

    /// The readings beside where they are expected.
    fn part_readings(&self, compensated: bool) -> impl Iterator<Item = PartReading> {
        let place = self.place(compensated);
        let off = minus(place, self.nominal);
        self.readings.iter().map(move |(direction, deviation)| PartReading {
            direction: *direction,
            place,
            deviation: deviation - dot(*direction, off),
        })
    }
}

/// One recording on its way through its rows.
struct Course<'c> {
    machine: &'c Machine<'c>,
    recording: &'c Recording,
    positions: Vec<Vec<f64>>,
    temperatures: Vec<Option<Vec<f64>>>,
    /// The runs in order of their first rows.
    runs: Vec<i64>,
}

impl<'c> Course<'c> {
    fn of(machine: &'c Machine<'c>, recording: &'c Recording, number: usize) -> Result<Self, UpdateError> {
        let rows = recording.time.len();
        let axes = machine.equations.axes.len();
        let known =
            |axis: usize| recording.axes.get(axis).map(|axis| axis.position_or_zero(rows).into_owned());
        Ok(Self {
            machine,
            recording,
            positions: (0..axes).map(|axis| known(axis).unwrap_or(vec![0.0; rows])).collect(),
            temperatures: temperatures(machine.calibration, recording, number)?,
            runs: recording.run_numbers(),
        })
    }

    /// The axes of which the recording knows nothing, and which are taken to stand at zero.
    fn standing(&self) -> Vec<String> {
        let axes = self.machine.equations.axes.iter().zip(&self.recording.axes);
        let unknown = axes.filter(|(_, channels)| channels.position().is_none());
        unknown.map(|(axis, _)| axis.letter.clone()).collect()
    }

    /// The rows that hold a reading.
    fn rows(&self, interpreter: &Interpreter, exact: &ExactProduct) -> Vec<Row> {
        let mut states = self.states();
        let mut rows = Vec::new();
        for row in 0..self.recording.time.len() {
            let position: Vec<f64> = self.positions.iter().map(|column| cell(column, row)).collect();
            let values = states.next(row, &position, self);
            let nominal = interpreter.nominal(&position);
            let readings = readings(self.recording, row, nominal);
            if readings.is_empty() {
                continue;
            }
            let travel: Vec<f64> =
                self.machine.equations.travels.iter().map(|travel| cell(&position, travel.axis)).collect();
            let run = self.recording.run.get(row).copied().unwrap_or(1);
            rows.push(Row {
                setup: self.runs.iter().position(|known| *known == run).unwrap_or(0),
                held_out: self.recording.holdout.as_ref().is_some_and(|runs| runs.contains(&run)),
                nominal,
                error: self.error(exact, &position, &travel, &values),
                levers: interpreter.levers(&position, &travel),
                values,
                readings,
            });
        }
        rows
    }

    /// A set-up by the place of its run: how the part lies in it.
    fn setup(&self, number: usize, place: usize, rows: &[Row]) -> Setup {
        let own = rows.iter().filter(|row| row.setup == place);
        let each = own.flat_map(|row| row.part_readings(self.machine.compensated));
        let run = self.runs.get(place).copied().unwrap_or(1);
        Setup::of(self.recording, (number, run), &each.collect::<Vec<PartReading>>())
    }

    /// The readings, and how many could not be used because a position is missing in their row. `first` is the number of the first
    /// set-up among those of all recordings.
    fn points(&self, rows: &[Row], setups: &[Setup], first: usize) -> (Vec<Point>, usize) {
        let (mut points, mut left_out) = (Vec::new(), 0);
        for row in rows {
            let pose = setups.get(row.setup).and_then(|setup| setup.pose.as_ref());
            let place = row.place(self.machine.compensated);
            for (direction, deviation) in &row.readings {
                let in_part = pose.map_or(*direction, |pose| pose.back(*direction));
                let shares = self.shares(&row.values, &row.levers, in_part);
                let predicted = dot(*direction, row.error);
                let moved = pose.map_or(0.0, |pose| dot(*direction, minus(pose.moved(place), place)));
                let expected = if self.machine.compensated { 0.0 } else { predicted } + moved;
                // Like the error motions' own: what a rotation of the machine makes too is exactly the same.
                let levers = pose.map_or([0.0; 3], |pose| pose.levers(*direction, row.nominal));
                let known = [*deviation, predicted].iter().chain(&shares).all(|number| number.is_finite());
                if known {
                    points.push(Point {
                        setup: first + row.setup,
                        direction: *direction,
                        deviation: *deviation,
                        held_out: row.held_out,
                        expected,
                        shares,
                        levers,
                    });
                } else {
                    left_out += 1;
                }
            }
        }
        (points, left_out)
    }

    /// What each coefficient displaces a point by along a direction.
    fn shares(&self, values: &[f64], levers: &[[f64; 3]], direction: [f64; 3]) -> Vec<f64> {
        let coefficients = self.machine.coefficients.iter().zip(values);
        let share = |(coefficient, value): (&Coefficient, &f64)| {
            let gain = levers.get(coefficient.motion).map_or(0.0, |lever| dot(*lever, direction));
            gain * value * coefficient.value
        };
        coefficients.map(share).collect()
    }

    /// The error of the tip by all coefficients together, mm.
    fn error(&self, exact: &ExactProduct, position: &[f64], travel: &[f64], values: &[f64]) -> [f64; 3] {
        let mut motions: Vec<Option<f64>> = vec![None; self.machine.equations.motions.len()];
        for (coefficient, value) in self.machine.coefficients.iter().zip(values) {
            if let Some(motion) = motions.get_mut(coefficient.motion) {
                *motion.get_or_insert(0.0) += coefficient.value * value;
            }
        }
        let positions: Vec<&[f64]> = position.chunks(1).collect();
        let travels: Vec<&[f64]> = travel.chunks(1).collect();
        let motions: Vec<Option<&[f64]>> =
            motions.iter().map(|motion| motion.as_ref().map(std::slice::from_ref)).collect();
        let columns = Columns { positions: &positions, travels: &travels, motions: &motions };
        exact.displaced(&columns, false).tip.map(|column| cell(&column, 0))
    }

    fn states(&self) -> States<'_> {
        let terms: Vec<Vec<Term<'_>>> = self
            .machine
            .coefficients
            .iter()
            .map(|known| known.unit_term.runtime().unwrap_or_default())
            .collect();
        States {
            memories: terms.iter().map(|terms| vec![TermState::default(); terms.len()]).collect(),
            terms,
            trackers: vec![DirectionTracker::new(HYSTERESIS); self.positions.len()],
            sensors: SensorReadings::of_terms(&self.machine.calibration.sensors),
            time: 0.0,
        }
    }
}

/// The state of the machine from row to row.
struct States<'s> {
    /// Of each coefficient its term, with the factors before it; nothing where no controller has it.
    terms: Vec<Vec<Term<'s>>>,
    memories: Vec<Vec<TermState>>,
    trackers: Vec<DirectionTracker>,
    sensors: SensorReadings<'s>,
    time: f64,
}

impl States<'_> {
    /// Goes on to a row and gives the value of each coefficient's term with the coefficient 1.
    fn next(&mut self, row: usize, position: &[f64], course: &Course<'_>) -> Vec<f64> {
        let direction: Vec<Direction> =
            self.trackers.iter_mut().zip(position).map(|(tracker, at)| tracker.update(*at)).collect();
        let inputs = &course.temperatures;
        let input = |sensor: usize| {
            inputs.get(sensor).and_then(Option::as_ref).map_or(f64::NAN, |column| cell(column, row))
        };
        let temperature = self.sensors.update(input);
        let time = cell(&course.recording.time, row);
        let sample = Sample {
            position,
            travel: &[],
            direction: &direction,
            velocity: &[],
            temperature,
            time_step: time - self.time,
        };
        self.time = time;
        let terms = self.terms.iter().zip(&mut self.memories);
        let value = |(terms, memories): (&Vec<Term<'_>>, &mut Vec<TermState>)| {
            let motion = ErrorMotion { terms };
            motion.advance(&sample, memories);
            motion.value(&sample, memories)
        };
        terms.map(value).collect()
    }
}

/// The readings of a row: a direction and the deviation along it, mm. Cells without a sample are no readings.
fn readings(recording: &Recording, row: usize, nominal: [f64; 3]) -> Vec<([f64; 3], f64)> {
    let deviation = recording.deviation.as_ref().map_or(f64::NAN, |column| cell(column, row));
    if let Instrument::Ballbar { center, radius } = recording.instrument {
        return length_reading(deviation, minus(nominal, center), radius).into_iter().collect();
    }
    if recording.instrument == Instrument::Probe {
        let normal = recording.normal.as_ref().map_or([f64::NAN; 3], |normal| {
            [0, 1, 2].map(|part| normal.get(part).map_or(f64::NAN, |column| cell(column, row)))
        });
        // A normal is a unit vector or is missing as a whole.
        let normal = if dot(normal, normal).is_finite() { normal } else { [f64::NAN; 3] };
        return if deviation.is_finite() { vec![(normal, deviation)] } else { Vec::new() };
    }
    let mut found = Vec::new();
    for (part, column) in recording.measured.iter().enumerate() {
        let Some(measured) = column.as_ref().map(|column| cell(column, row)) else { continue };
        if measured.is_finite() {
            let direction = [0, 1, 2].map(|other| if other == part { 1.0 } else { 0.0 });
            found.push((direction, measured - nominal.get(part).copied().unwrap_or(f64::NAN)));
        }
    }
    found
}

/// A length from a centre to the tip, read as longer than nominal, as a displacement of the tip along it: `arm` is the way from the centre to
/// where the tip was told to be. Across it, a displacement of 0.1 mm makes 100 mm longer by 0.05 um.
fn length_reading(deviation: f64, arm: [f64; 3], radius: f64) -> Option<([f64; 3], f64)> {
    let length = dot(arm, arm).sqrt();
    let read = deviation - (length - radius);
    (length > 0.0 && read.is_finite()).then(|| (arm.map(|part| part / length), read))
}

/// The channel of every sensor that is an input of a term, gaps held from the sample before.
fn temperatures(
    calibration: &Calibration,
    recording: &Recording,
    number: usize,
) -> Result<Vec<Option<Vec<f64>>>, UpdateError> {
    let mut columns = vec![None; calibration.sensors.len()];
    for (index, sensor) in calibration.sensors.inputs() {
        let name = &sensor.name.value;
        let channel = recording.temperatures.iter().find(|channel| channel.name == *name);
        let first = channel.and_then(|channel| channel.values.iter().find(|value| value.is_finite()));
        let (Some(channel), Some(first)) = (channel, first) else {
            return Err(UpdateError::NoTemperature { recording: number, sensor: name.clone() });
        };
        let mut last = *first;
        let held = channel.values.iter().map(|value| {
            last = if value.is_finite() { *value } else { last };
            last
        });
        if let Some(column) = columns.get_mut(index) {
            *column = Some(held.collect());
        }
    }
    Ok(columns)
}

fn cell(column: &[f64], row: usize) -> f64 {
    column.get(row).copied().unwrap_or(f64::NAN)
}

fn dot(left: [f64; 3], right: [f64; 3]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

fn minus(left: [f64; 3], right: [f64; 3]) -> [f64; 3] {
    let mut left = left;
    left.iter_mut().zip(right).for_each(|(left, right)| *left -= right);
    left
}
