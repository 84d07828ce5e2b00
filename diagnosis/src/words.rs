//! Words: where a finding acts and how it shows.
//!
//! In: an effect of a model. Out: link, side, state and a sentence.

use model_dsl::calibration::Factor;
use model_dsl::calibration::vocabulary::State;

use crate::alternatives::{factor_state, listed, state};
use crate::curves::active;
use crate::diagnosis::{Interval, IntervalOf, Location};
use crate::model::{Effect, Fitted, Model};
use crate::parameters::axis_unit;
use crate::side::Side;
use crate::states::Crossing;
use crate::study::Study;
use crate::terms::Shape;

/// Where an effect acts. `others` are the names that could stand for it: a side is only told where all agree.
pub(crate) fn location(study: &Study<'_>, model: &Model, fitted: &Fitted, others: &[Effect]) -> Location {
    let effect = &fitted.effect;
    let Some(motion) = effect.motion() else { return Location::default() };
    let own = side(study, effect);
    let agreed =
        others.iter().filter(|other| other.motion().is_some()).all(|other| side(study, other) == own);
    Location {
        link: study.equations.motions[motion].link.clone(),
        side: if agreed { own } else { "unknown" },
        state: state_word(&effect.shape),
        detail: detail(study, model, effect),
        interval: interval(study, fitted),
        at_drive: effect.side().is_some_and(Side::at_drive),
        inside_loop: effect.side().is_some_and(|side| side.answered_by().is_some()),
    }
}

/// On which side of the drive's feedback an effect comes in, and what follows from the motion alone.
fn side(study: &Study<'_>, effect: &Effect) -> &'static str {
    let Some(motion) = effect.motion() else { return "unknown" };
    let own_axis = study.own.iter().position(|own| *own == Some(motion));
    match (own_axis, effect.side()) {
        // What moves a link aside or turns it cannot come from its drive.
        (None, _) => "structure",
        (Some(_), _) if matches!(effect.shape, Shape::Lag { .. }) => "drive",
        (Some(axis), _) if !study.has_drive(axis) => "unknown",
        (Some(_), Some(Side::Drive | Side::Loop { .. })) => "drive",
        (Some(_), _) => "transmission",
    }
}

fn state_word(shape: &Shape) -> &'static str {
    match shape {
        Shape::Constant | Shape::Polynomial { .. } | Shape::Table { .. } | Shape::Cyclic { .. } => "position",
        Shape::Backlash { .. } => "direction",
        Shape::ReversalSpike { .. } => "reversal",
        Shape::Lag { .. } => "velocity",
        Shape::Acceleration { .. } => "acceleration",
        Shape::Expansion { .. } | Shape::Growth { .. } | Shape::SensorPolynomial { .. } => "temperature",
        Shape::Drift { .. } => "time",
        Shape::Vibration { .. } => "frequency",
        Shape::Coupling { .. } => "other-axis",
        Shape::Compliance { .. } => "load",
        Shape::Delay { .. } => "velocity",
        Shape::Step { .. } => "time",
        Shape::Times { core, factors } => match **core {
            Shape::Constant => factors.first().map_or("position", factor_word),
            ref core => state_word(core),
        },
        Shape::Instrument(_) => "instrument",
    }
}

/// The state that a factor is.
fn factor_word(factor: &Factor<usize>) -> &'static str {
    match factor.kind().entry().state {
        State::Direction => "direction",
        State::Velocity => "velocity",
        State::Acceleration => "acceleration",
        State::Temperature => "temperature",
        State::Load => "load",
        State::Time => "time",
        _ => "position",
    }
}

fn detail(study: &Study<'_>, model: &Model, effect: &Effect) -> String {
    let shown = bare_detail(study, model, effect);
    match effect.side().and_then(Side::answered_by) {
        Some(_) => format!("{shown}, as far as the position loop allows"),
        None => shown,
    }
}

fn bare_detail(study: &Study<'_>, model: &Model, effect: &Effect) -> String {
    let name = |axis: usize| study.equations.axes[axis].letter.to_lowercase();
    match &effect.shape {
        Shape::Constant => format!("follows {}", state(study, effect)),
        Shape::Polynomial { axis, .. } => format!("changes smoothly along {}", name(*axis)),
        Shape::Table { axis, .. } => format!("follows a curve along {}", name(*axis)),
        Shape::Cyclic { axis, period, order, .. } => {
            let (factor, unit) = axis_unit(study, *axis);
            let own = period * factor / f64::from(*order);
            let harmonic = match order {
                1 => String::new(),
                order => format!(", harmonic {order} of {:.4} {unit}", period * factor),
            };
            format!("repeats every {own:.4} {unit} of {}{harmonic}", name(*axis))
        }
        Shape::Backlash { axis, wind_up } if *wind_up > 0.0 => {
            let (factor, unit) = axis_unit(study, *axis);
            format!("builds up over {:.3} {unit} after every reversal of {}", wind_up * factor, name(*axis))
        }
        Shape::Backlash { axis, .. } => match model.crossing(*axis) {
            Crossing::After(way) => {
                let (factor, unit) = axis_unit(study, *axis);
                format!("jumps {:.3} {unit} after every reversal of {}", way * factor, name(*axis))
            }
            Crossing::AtOnce | Crossing::Over(_) => format!("jumps at every reversal of {}", name(*axis)),
        },
        Shape::ReversalSpike { axis, decay } => {
            format!("a spike at every reversal of {}, gone within {}", name(*axis), seconds(3.0 * decay))
        }
        Shape::Lag { axis, inertia } if *inertia > 0.0 => {
            format!("follows the velocity of {}, from its second-order position loop", name(*axis))
        }
        Shape::Lag { axis, .. } => {
            format!("follows the velocity of {}, from its position loop", name(*axis))
        }
        Shape::Acceleration { axis } => format!("follows the acceleration of {}", name(*axis)),
        Shape::Expansion { axis, sensor, .. } => {
            format!("grows with {} and with the temperature of {}", name(*axis), study.sensors[*sensor])
        }
        Shape::Growth { sensor, time_constant, .. } if *time_constant > 0.0 => {
            format!("follows the temperature of {}, {time_constant:.0} s behind it", study.sensors[*sensor])
        }
        Shape::Growth { sensor, .. } | Shape::SensorPolynomial { sensor, .. } => {
            format!("follows the temperature of {}", study.sensors[*sensor])
        }
        Shape::Drift { time_constant } => {
            format!("settles with time, within {}", seconds(3.0 * time_constant))
        }
        Shape::Vibration { frequency } => format!("oscillates at {frequency:.3} Hz"),
        Shape::Coupling { axis, .. } => format!("changes with the position of {}", name(*axis)),
        Shape::Compliance { load } => format!("follows the load {}", study.loads[*load].0),
        Shape::Delay { axis, time } => format!("{} is {} late", name(*axis), seconds(*time)),
        Shape::Step { time } => format!("jumps once, at {}", seconds(*time)),
        Shape::Times { core, factors } => {
            let states =
                listed(&factors.iter().map(|factor| factor_state(study, factor)).collect::<Vec<_>>());
            match **core {
                Shape::Constant => format!("follows the product of {states}"),
                ref core => {
                    let core =
                        bare_detail(study, model, &Effect { place: effect.place, shape: core.clone() });
                    format!("{core}, by an amount that follows {states}")
                }
            }
        }
        Shape::Instrument(setting) => setting.name().to_owned(),
    }
}

/// A time in words, with about three digits.
pub(crate) fn seconds(time: f64) -> String {
    match time {
        short if short < 0.1 => format!("{:.1} ms", 1e3 * short),
        short if short < 1.0 => format!("{short:.3} s"),
        middle if middle < 100.0 => format!("{middle:.1} s"),
        long => format!("{long:.0} s"),
    }
}

/// Where a table is more than its median.
fn interval(study: &Study<'_>, fitted: &Fitted) -> Option<Interval> {
    let axis = fitted.effect.shape.axis()?;
    let (from, to) = active(fitted)?;
    let (factor, unit) = axis_unit(study, axis);
    let of = IntervalOf::Axis(study.equations.axes[axis].letter.clone());
    Some(Interval { of, from: from * factor, to: to * factor, unit })
}
