//! The samples of `halsampler`. In: its text, a line for each servo cycle. Out: typed samples of the mill; and those of them that
//! make a recording, as a table.

use std::error::Error;
use std::fmt::Write;

/// The columns of a sample, as `sampled.hal` wires them.
const COLUMNS: usize = 17;

/// From the head's origin to the tip of the tool, mm: `plant.c` and `mill-12.yaml` have the same.
const TOOL: f64 = 120.0;

/// The step of the instrument that the recording is of, mm: the tip is written with so many digits.
pub(crate) const STEP: f64 = 1e-4;

/// Every so many cycles one is recorded.
const RECORDED: usize = 10;

/// What was being done; `drive.py` has the numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Phase {
    /// Nothing that is looked at.
    SettingUp,
    /// The program, without compensation.
    Off,
    /// The program, with compensation.
    On,
    /// Compensation is switched on while the machine stands.
    Standing,
    /// Compensation is switched off and on while the machine moves.
    Moving,
    /// The thermometer falls silent and speaks again.
    Silent,
}

/// One servo cycle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Sample {
    /// What was being done.
    pub(crate) phase: Phase,
    /// Commanded position of X, Y, Z, mm.
    pub(crate) position: [f64; 3],
    /// Where the tip of the tool truly stands relative to the part, mm.
    pub(crate) tip: [f64; 3],
    /// Corrections of X, Y, Z, mm.
    pub(crate) correction: [f64; 3],
    /// Following errors of X, Y, Z, mm.
    pub(crate) following: [f64; 3],
    /// Temperature of the table, degC.
    pub(crate) temperature: f64,
    /// Status of Abbe.
    pub(crate) status: i32,
    /// How long the cycle of Abbe took, ns.
    pub(crate) nanoseconds: f64,
    /// Whether the motion controller moves the machine.
    pub(crate) machine_on: bool,
}

impl Sample {
    /// Distance of the tip from where it should be, mm.
    pub(crate) fn error(&self) -> f64 {
        let [x, y, z] = self.position;
        let nominal = [x, y, z + TOOL];
        length([0, 1, 2].map(|axis| self.tip[axis] - nominal[axis]))
    }
}

/// The length of a vector.
pub(crate) fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// Reads all samples of the mill.
pub(crate) fn read(text: &str) -> Result<Vec<Sample>, Box<dyn Error>> {
    rows(text)?.into_iter().map(sample).collect()
}

/// The columns of all samples; the last line may be cut off.
pub(crate) fn rows<const COLUMNS: usize>(text: &str) -> Result<Vec<[f64; COLUMNS]>, Box<dyn Error>> {
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    whole.lines().map(row).collect()
}

fn row<const COLUMNS: usize>(line: &str) -> Result<[f64; COLUMNS], Box<dyn Error>> {
    let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
    let columns = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    columns.ok_or_else(|| format!("not a sample: {line}").into())
}

/// What a number of `drive.py` stands for.
pub(crate) fn phase(number: f64) -> Result<Phase, Box<dyn Error>> {
    let phases = [Phase::SettingUp, Phase::Off, Phase::On, Phase::Standing, Phase::Moving, Phase::Silent];
    let numbered = (0..).zip(phases).find(|(phase, _)| f64::from(*phase) == number);
    numbered.map(|(_, phase)| phase).ok_or_else(|| format!("no phase: {number}").into())
}

/// A status of Abbe.
pub(crate) fn status(number: f64) -> Result<i32, Box<dyn Error>> {
    (-10..10).find(|status| f64::from(*status) == number).ok_or_else(|| format!("no status: {number}").into())
}

fn sample(columns: [f64; COLUMNS]) -> Result<Sample, Box<dyn Error>> {
    let [number, x, y, z, tip_x, tip_y, tip_z, dx, dy, dz, fx, fy, fz, temperature, status, nanoseconds, on] =
        columns;
    Ok(Sample {
        phase: phase(number)?,
        position: [x, y, z],
        tip: [tip_x, tip_y, tip_z],
        correction: [dx, dy, dz],
        following: [fx, fy, fz],
        temperature,
        status: self::status(status)?,
        nanoseconds,
        machine_on: on == 1.0,
    })
}

/// The table of a recording: what an instrument with steps of [`STEP`] would have read every 10 ms.
pub(crate) fn table(samples: &[&Sample]) -> String {
    let mut table = String::from("t,x,y,z,tip_x,tip_y,tip_z,T_table\n");
    for (cycle, sample) in samples.iter().enumerate().step_by(RECORDED) {
        let ([x, y, z], [tip_x, tip_y, tip_z]) = (sample.position, sample.tip);
        let time = cycle as f64 * 1e-3;
        // A String takes whatever is written to it.
        let _ = writeln!(
            table,
            "{time:.3},{x:.6},{y:.6},{z:.6},{tip_x:.4},{tip_y:.4},{tip_z:.4},{:.2}",
            sample.temperature
        );
    }
    table
}
