//! An outcome as it is shown. In: an [`Outcome`]. Out: text, JSON, and the comments at the head of the calibration. It computes
//! nothing.

mod json;

pub use json::json;

use std::fmt::Write as _;

use model_dsl::equations::Equations;

use super::bound::Bound;
use super::calibrate::{MeasuredMotion, Outcome};
use super::curve::Mean;
use super::lever::Levers;
use super::line::Line;
use super::reduce::Reduced;
use super::squareness::Squareness;
use super::uncertainty::Uncertainty;

/// Units of a motion or an axis for people.
#[derive(Clone, Copy)]
struct Shown {
    unit: &'static str,
    factor: f64,
    digits: usize,
}

const MICRONS: Shown = Shown { unit: "um", factor: 1e3, digits: 2 };
const MICRORADIANS: Shown = Shown { unit: "urad", factor: 1e6, digits: 2 };
const MILLIMETRES: Shown = Shown { unit: "mm", factor: 1.0, digits: 3 };
const DEGREES: Shown = Shown { unit: "deg", factor: 180.0 / std::f64::consts::PI, digits: 4 };

impl Shown {
    fn number(self, value: f64) -> String {
        let text = format!("{:.*}", self.digits, value * self.factor);
        // A rounded zero has no sign.
        if text.trim_start_matches('-').bytes().all(|byte| matches!(byte, b'0' | b'.')) {
            text.trim_start_matches('-').to_owned()
        } else {
            text
        }
    }

    fn with_unit(self, value: f64) -> String {
        format!("{} {}", self.number(value), self.unit)
    }

    /// Half of the interval of 95 %, or that it is not known.
    fn interval(self, uncertainty: Option<Uncertainty>) -> String {
        let known = uncertainty.map(Uncertainty::expanded);
        known.map_or_else(|| "unknown".to_owned(), |half| self.number(half))
    }

    fn plus_minus(self, value: f64, uncertainty: Option<Uncertainty>) -> String {
        match uncertainty {
            Some(known) => {
                format!("{} +- {} {}", self.number(value), self.number(known.expanded()), self.unit)
            }
            None => format!("{}, uncertainty unknown", self.with_unit(value)),
        }
    }
}

/// What of a machine a report speaks of.
struct Names<'e> {
    equations: &'e Equations,
}

impl Names<'_> {
    fn motion(&self, number: usize) -> &str {
        self.equations.motions.get(number).map_or("?", |motion| &motion.name)
    }

    fn meaning(&self, number: usize) -> &str {
        self.equations.motions.get(number).map_or("", |motion| &motion.meaning)
    }

    fn of_motion(&self, number: usize) -> Shown {
        let angular = self.equations.motions.get(number).is_some_and(|motion| motion.angular);
        if angular { MICRORADIANS } else { MICRONS }
    }

    fn letter(&self, axis: usize) -> &str {
        self.equations.axes.get(axis).map_or("?", |axis| &axis.letter)
    }

    fn of_axis(&self, axis: usize) -> Shown {
        let rotary = self.equations.axes.get(axis).is_some_and(|axis| axis.rotary);
        if rotary { DEGREES } else { MILLIMETRES }
    }
}

/// The outcome as text for a terminal. Intervals are those of 95 %.
pub fn text(outcome: &Outcome, equations: &Equations) -> String {
    let names = Names { equations };
    let mut text =
        format!("Calibration of {}; the intervals contain the mean with 95 % confidence\n", outcome.machine);
    for motion in &outcome.motions {
        put(&mut text, "");
        about(&mut text, motion, &names);
        table(&mut text, motion, &names);
        figures(&mut text, motion, &names);
    }
    for squareness in &outcome.squarenesses {
        put(&mut text, "");
        for line in squared(squareness, &names) {
            put(&mut text, &line);
        }
    }
    if let Some(bound) = &outcome.bound {
        put(&mut text, "");
        put(&mut text, &limited(bound));
    }
    text
}

/// The lines at the head of the calibration: what each motion rests on.
pub fn comments(outcome: &Outcome, equations: &Equations) -> Vec<String> {
    let names = Names { equations };
    let of_motion = |one: &MeasuredMotion| {
        let shown = names.of_motion(one.motion);
        let mut line = format!("{} from {}: {}", names.motion(one.motion), one.files.join(", "), runs(one));
        line += &match widest(one) {
            Some(half) => format!("; means within +- {} at 95 %", shown.with_unit(half)),
            None => "; the uncertainty of a mean of one reading is unknown".to_owned(),
        };
        for part in one.parts.iter().filter_map(|part| part.line.as_ref()) {
            line += &format!("; line removed, slope {}", slope(part, one, &names));
        }
        for levers in one.parts.iter().filter_map(|part| part.levers.as_ref()) {
            line += &format!("; {}", leveled(levers, &names));
        }
        line + "."
    };
    let squarenesses = outcome.squarenesses.iter().map(|one| {
        let lines: Vec<String> = squared(one, &names).iter().map(|line| line.trim().to_owned()).collect();
        lines.join("; ") + "."
    });
    let limit = outcome.bound.as_ref().map(limited);
    outcome.motions.iter().map(of_motion).chain(squarenesses).chain(limit).collect()
}

/// The limit of corrections, and why it is that.
fn limited(bound: &Bound) -> String {
    format!(
        "limits: {{compensation: {} mm}} is twice the largest correction within the measured range, {}, rounded up.",
        bound.limit,
        MICRONS.with_unit(bound.largest)
    )
}

fn put(text: &mut String, line: &str) {
    // A string takes every line.
    let _ = writeln!(text, "{}", line.trim_end());
}

fn widest(motion: &MeasuredMotion) -> Option<f64> {
    let means = motion.curve.forward.iter().chain(&motion.curve.reverse).flatten();
    let halves: Option<Vec<f64>> = means.map(|mean| Some(mean.uncertainty?.expanded())).collect();
    halves.map(|halves| halves.into_iter().fold(0.0, f64::max))
}

fn about(text: &mut String, motion: &MeasuredMotion, names: &Names<'_>) {
    put(text, &format!("{}: {}", names.motion(motion.motion), names.meaning(motion.motion)));
    for ((file, set_up), said) in motion.files.iter().zip(&motion.set_ups).zip(&motion.about) {
        put(text, &format!("  {}{set_up}{}", plain(file), of_itself(said)));
    }
    let axis = names.of_axis(motion.axis);
    let ends = motion.curve.positions.first().zip(motion.curve.positions.last());
    let ends = ends.map_or(String::new(), |(first, last)| {
        format!(" from {} to {}", axis.number(*first), axis.with_unit(*last))
    });
    put(
        text,
        &format!(
            "  {} targets on {}{ends}; {}",
            motion.curve.positions.len(),
            names.letter(motion.axis),
            runs(motion)
        ),
    );
    if motion.against {
        put(
            text,
            "  in the sign convention of the machine file: the tool moved in the opposite direction relative to the part",
        );
    }
    for part in &motion.parts {
        if !part.left_out.is_empty() {
            let places: Vec<String> = part.left_out.iter().map(|at| axis.number(*at)).collect();
            put(
                text,
                &format!(
                    "  left out, because one direction was not read there: {} {}",
                    places.join(", "),
                    axis.unit
                ),
            );
        }
    }
}

/// What a file says of itself, in brackets.
fn of_itself(said: &[(String, String)]) -> String {
    let entries: Vec<String> =
        said.iter().map(|(key, value)| format!("{} {}", plain(key), plain(value))).collect();
    if entries.is_empty() { String::new() } else { format!(" ({})", entries.join("; ")) }
}

/// Text of a file without what would move a terminal.
fn plain(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

/// `5 runs forward, 5 back`.
fn runs(motion: &MeasuredMotion) -> String {
    let of = |part: &Reduced| match part.runs {
        [forward, 0] => format!("{} forward", counted(forward)),
        [0, reverse] => format!("{} back", counted(reverse)),
        [forward, reverse] => format!("{} forward, {reverse} back", counted(forward)),
    };
    let parts = motion.parts.iter().zip(&motion.set_ups);
    let all = parts.map(|(part, set_up)| match set_up.strip_prefix(", ") {
        Some(set_up) => format!("{set_up} {}", of(part)),
        None => of(part),
    });
    all.collect::<Vec<_>>().join("; ")
}

fn counted(runs: usize) -> String {
    if runs == 1 { "1 run".to_owned() } else { format!("{runs} runs") }
}

/// A row for each target.
fn table(text: &mut String, motion: &MeasuredMotion, names: &Names<'_>) {
    let (axis, shown) = (names.of_axis(motion.axis), names.of_motion(motion.motion));
    let sides = [("forward", &motion.curve.forward), ("reverse", &motion.curve.reverse)];
    let sides: Vec<(&str, &Vec<Mean>)> =
        sides.into_iter().filter_map(|(name, side)| Some((name, side.as_ref()?))).collect();
    let mut head = format!("  {:>12}", format!("{}/{}", names.letter(motion.axis).to_lowercase(), axis.unit));
    for (name, _) in &sides {
        head += &format!("  {:>13}  {:>8}  {:>3}", format!("{name}/{}", shown.unit), "+-", "n");
    }
    if motion.edge.is_some() {
        head += &format!("  {:>10}", format!("edge/{}", shown.unit));
    }
    put(text, &head);
    for (place, at) in motion.curve.positions.iter().enumerate() {
        let mut row = format!("  {:>12}", axis.number(*at));
        for mean in sides.iter().filter_map(|(_, side)| side.get(place)) {
            row += &format!(
                "  {:>13}  {:>8}  {:>3}",
                shown.number(mean.value),
                shown.interval(mean.uncertainty),
                mean.readings
            );
        }
        if let Some(edge) = motion.edge.as_ref().and_then(|edge| edge.get(place)) {
            row += &format!("  {:>10}", shown.number(*edge));
        }
        put(text, &row);
    }
}

/// What holds for a motion as a whole.
fn figures(text: &mut String, motion: &MeasuredMotion, names: &Names<'_>) {
    let (axis, shown) = (names.of_axis(motion.axis), names.of_motion(motion.motion));
    if motion.slope_alone {
        put(text, "  two targets: only the slope is known, so the calibration has no table of it");
    }
    if let Some(reversal) = &motion.reversal {
        put(
            text,
            &format!(
                "  reversal, forward minus reverse: mean {}; greatest {} at {}",
                shown.plus_minus(reversal.mean, reversal.uncertainty),
                shown.with_unit(reversal.greatest),
                axis.with_unit(reversal.at)
            ),
        );
    }
    for (part, set_up) in motion.parts.iter().zip(&motion.set_ups) {
        if let Some(line) = &part.line {
            put(text, &format!("  line removed{set_up}: slope {}", slope(line, motion, names)));
        }
    }
    for levers in motion.parts.iter().filter_map(|part| part.levers.as_ref()) {
        put(text, &format!("  {}", leveled(levers, names)));
    }
    if let Some(lost) = motion.table.lost_motion {
        put(
            text,
            &format!("  written as the mean of both directions and a backlash of {}", shown.with_unit(lost)),
        );
    }
    if let Some(most) = motion.table.smoothed {
        put(text, &format!("  smoothed: values moved by up to {}", shown.with_unit(most)));
    }
    if let Some(most) = motion.table.resampled {
        put(
            text,
            &format!(
                "  resampled to {} nodes: up to {} from the means at the targets",
                motion.table.nodes.len(),
                shown.with_unit(most)
            ),
        );
    }
}

/// What lever arms did: which rotations were taken off, and which were not measured.
fn leveled(levers: &Levers, names: &Names<'_>) -> String {
    let taken = levers
        .taken
        .iter()
        .map(|(motion, most)| format!("{} of up to {}", names.motion(*motion), MICRONS.with_unit(*most)));
    let taken: Vec<String> = taken.collect();
    let remaining: Vec<&str> = levers.remaining.iter().map(|motion| names.motion(*motion)).collect();
    let mut text = match taken.as_slice() {
        [] => "lever arms: nothing subtracted".to_owned(),
        taken => format!("lever arms subtracted: {}", taken.join(", ")),
    };
    if !remaining.is_empty() {
        text += &format!("; not measured, and still included: {}", remaining.join(", "));
    }
    text
}

/// A slope: an angle for a displacement over a slide, else the units of both.
fn slope(line: &Line, motion: &MeasuredMotion, names: &Names<'_>) -> String {
    let angular = names.equations.motions.get(motion.motion).is_some_and(|motion| motion.angular);
    let rotary = names.equations.axes.get(motion.axis).is_some_and(|axis| axis.rotary);
    let per = match (angular, rotary) {
        (false, false) => MICRORADIANS,
        (true, false) => Shown { unit: "urad/mm", ..MICRORADIANS },
        (false, true) => Shown { unit: "um/rad", ..MICRONS },
        (true, true) => Shown { unit: "urad/rad", ..MICRORADIANS },
    };
    let from = match (line.from_residual, line.from_runs) {
        (Some(residual), Some(runs)) => {
            format!(
                " (standard {} from the residual, {} from the runs)",
                per.number(residual.standard),
                per.number(runs.standard)
            )
        }
        (Some(residual), None) => format!(
            " (standard {} from the residual alone: too few whole runs)",
            per.number(residual.standard)
        ),
        _ => String::new(),
    };
    per.plus_minus(line.slope, line.uncertainty()) + &from
}

/// What a square gave.
fn squared(one: &Squareness, names: &Names<'_>) -> Vec<String> {
    let [first, second] = one.from.map(|motion| names.motion(motion));
    let square = match (one.square, one.turned) {
        (Some(square), true) => {
            format!("the error of the square is {}, found by turning it over", MICRORADIANS.with_unit(square))
        }
        (Some(square), false) => {
            format!("the square's own {} is taken into account", MICRORADIANS.with_unit(square))
        }
        (None, _) => "the square is assumed to be perfect; its own error is fully included".to_owned(),
    };
    let mut lines = vec![
        format!("{}: {}", names.motion(one.motion), MICRORADIANS.plus_minus(one.angle, one.uncertainty)),
        format!("  from the lines of {first} and {second} against `{}`; {square}", one.reference),
    ];
    if !one.set_ups.is_empty() {
        let all: Vec<String> = one.set_ups.iter().map(|angle| MICRORADIANS.number(*angle)).collect();
        lines.push(format!(
            "  the mean of {} set-ups, and their scatter: {} {}",
            all.len(),
            all.join(", "),
            MICRORADIANS.unit
        ));
    }
    lines
}
