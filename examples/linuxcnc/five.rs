//! What the samples of a machine of five axes show of a compensation. In: the text of `halsampler`, with the columns that `five.tcl`
//! wires. Out: figures on standard output, and a complaint where one is not what it has to be.

use std::fs;

use crate::samples::{Phase, length, phase, rows, status};
use crate::{Complaint, LEFT, compare, hold, tell_times};

/// The columns of a sample.
const COLUMNS: usize = 9;

/// One servo cycle.
struct Sample {
    phase: Phase,
    /// Distance of the tip from where it should be relative to the part, um.
    tip: f64,
    /// The angle from the direction that the tool should have, arcsec.
    turned: f64,
    status: i32,
    /// How long the cycle of Abbe took, ns.
    nanoseconds: f64,
    machine_on: bool,
    /// The angle between the tool and the axis of C, deg.
    tilt: f64,
}

/// Nearer than this to the pose in which the tool stands along C, C cannot turn the tool as far as it errs, deg: the errors of its
/// direction are up to 0.3 mrad, and the limit of `draw.py` lets C turn by 3.5 mrad for them.
const NEAR: f64 = 5.0;

/// Judges tip and direction of the tool but for where it stands nearly along C: that is told. There the direction cannot be had, and the
/// slides follow C so fast that each is through its play some cycles before its direction counts as turned.
pub(crate) fn judge(path: &str) -> Result<(), Complaint> {
    let rows = rows(&fs::read_to_string(path)?)?;
    let samples = rows.into_iter().map(sample).collect::<Result<Vec<_>, _>>()?;
    judge_running(&samples)?;
    let tilted = |figure| of_tilted(&samples, |tilt| tilt >= NEAR, figure);
    let along = |figure| of_tilted(&samples, |tilt| tilt < NEAR, figure);
    let [tip, turned] = [tilted(|sample| sample.tip), tilted(|sample| sample.turned)];
    // The program, five moves and the way back, takes more than 3 s, and most of it is far from that pose.
    hold(tip.iter().all(|errors| errors.len() > 2000), "the program was not sampled as a whole")?;
    let at_tip = compare("error at the tool", "um", &tip);
    let direction = compare("direction of the tool", "arcsec", &turned);
    compare(&format!("error at the tool, within {NEAR} deg of C"), "um", &along(|sample| sample.tip));
    compare(
        &format!("direction of the tool, within {NEAR} deg of C"),
        "arcsec",
        &along(|sample| sample.turned),
    );
    tell_times(of(&samples, Phase::On, |sample| sample.nanoseconds));
    hold(
        at_tip.least > 20.0 && direction.least > 2.0,
        "the machine hardly errs: there is nothing to be shown",
    )?;
    hold(at_tip.left < LEFT, "too much of the error at the tool is left")?;
    hold(direction.left < LEFT, "too much of the error of the direction is left")
}

/// A figure without compensation and with it, where the tool is tilted so far.
fn of_tilted(samples: &[Sample], tilted: fn(f64) -> bool, figure: fn(&Sample) -> f64) -> [Vec<f64>; 2] {
    [Phase::Off, Phase::On].map(|phase| {
        let samples = samples.iter().filter(|sample| sample.phase == phase && tilted(sample.tilt));
        samples.map(figure).collect()
    })
}

/// The motion controller never stopped, and Abbe did as it was told.
fn judge_running(samples: &[Sample]) -> Result<(), Complaint> {
    let all = |phase, status| {
        samples
            .iter()
            .filter(|sample| sample.phase == phase)
            .all(|sample| sample.status == status && sample.machine_on)
    };
    hold(all(Phase::Off, 5), "compensated while it was to be off, or the machine was switched off")?;
    hold(all(Phase::On, 1), "not compensated while it was to be on, or the machine was switched off")
}

fn of(samples: &[Sample], phase: Phase, figure: fn(&Sample) -> f64) -> Vec<f64> {
    samples.iter().filter(|sample| sample.phase == phase).map(figure).collect()
}

fn sample(columns: [f64; COLUMNS]) -> Result<Sample, Complaint> {
    let [number, x, y, z, turned, state, nanoseconds, on, tilt] = columns;
    Ok(Sample {
        phase: phase(number)?,
        tip: length([x, y, z]) * 1e3,
        turned,
        status: status(state)?,
        nanoseconds,
        machine_on: on == 1.0,
        tilt: tilt.abs(),
    })
}
