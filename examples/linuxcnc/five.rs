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
    /// What that angle would be if rotary axes erred by nothing but their own angles, arcsec.
    turned_own: f64,
    status: i32,
    /// How long the cycle of Abbe took, ns.
    nanoseconds: f64,
    machine_on: bool,
}

/// Judges the tip of the tool, and its direction as far as rotary axes have to correct it. The direction as a whole is told: tilts of
/// guides and axes turn the tool too, and nobody corrects these.
pub(crate) fn judge(path: &str) -> Result<(), Complaint> {
    let rows = rows(&fs::read_to_string(path)?)?;
    let samples = rows.into_iter().map(sample).collect::<Result<Vec<_>, _>>()?;
    judge_running(&samples)?;
    let tip = [Phase::Off, Phase::On].map(|phase| of(&samples, phase, |sample| sample.tip));
    let own = [Phase::Off, Phase::On].map(|phase| of(&samples, phase, |sample| sample.turned_own));
    let whole = [Phase::Off, Phase::On].map(|phase| of(&samples, phase, |sample| sample.turned));
    // The program, five moves and the way back, takes more than 3 s.
    hold(tip.iter().all(|errors| errors.len() > 3000), "the program was not sampled as a whole")?;
    let at_tip = compare("error at the tool", "um", &tip);
    let own = compare("direction of the tool, by the rotary axes' own angles", "arcsec", &own);
    compare("direction of the tool, as a whole", "arcsec", &whole);
    tell_times(of(&samples, Phase::On, |sample| sample.nanoseconds));
    hold(at_tip.least > 20.0 && own.least > 2.0, "the machine hardly errs: there is nothing to be shown")?;
    hold(at_tip.left < LEFT, "too much of the error at the tool is left")?;
    hold(own.left < LEFT, "too much of the axes' own angles is left")
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
    let [number, x, y, z, turned, turned_own, state, nanoseconds, on] = columns;
    Ok(Sample {
        phase: phase(number)?,
        tip: length([x, y, z]) * 1e3,
        turned,
        turned_own,
        status: status(state)?,
        nanoseconds,
        machine_on: on == 1.0,
    })
}
