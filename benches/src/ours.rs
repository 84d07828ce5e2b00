//! Abbe's contestants: the generated equations, and the compensator around them.
//!
//! In: a case. Out: for the equations the generated function; for the other groups one whole call of the compensator,
//! with its checks and its refusals, as a controller calls it.

use abbe_runtime::{
    Compensator, Direction, ErrorMotion, ErrorMotions, Kinematics, Sample, SetupError, Table, Term,
    TermState, Values as Curves, Work, states_needed,
};

use crate::case::{Case, Values};
use crate::contest::{Answering, Contestant, EXACT, Group};
use crate::machines::{excello_921, trunnion_5axis, trunnion_5axis_turning, xyfz_mill};

/// The contestants of a machine.
pub(crate) fn contestants(case: &'static Case, group: Group) -> Vec<Box<dyn Contestant>> {
    macro_rules! compiled {
        ($machine:ident) => {
            with_room($machine::Calibration::TERMS, &$machine::Calibration::MACHINE, |states, work| {
                Compensator::with_calibration(
                    &$machine::Calibration::MACHINE,
                    &$machine::Calibration,
                    states,
                    work,
                )
            })
        };
    }
    macro_rules! of {
        ($machine:ident, $axes:literal) => {{
            let constants = $machine::Constants::from_array(array(&case.constants));
            let machine: &'static _ = leak($machine::Machine { constants });
            match group {
                Group::Equations => {
                    let states: Vec<_> = case
                        .states
                        .iter()
                        .map(|state| {
                            let axes = $machine::Axes::from_array(array(&state.position));
                            (axes, $machine::Motions::from_array(array(&state.motions)))
                        })
                        .collect();
                    #[inline(never)]
                    fn call(
                        machine: &$machine::Machine,
                        axes: &$machine::Axes,
                        motions: &$machine::Motions,
                        out: &mut [f64; 3],
                    ) {
                        *out = machine.error(axes, motions);
                    }
                    vec![boxed("abbe", move |state, out| {
                        call(machine, &states[state].0, &states[state].1, out);
                    })]
                }
                Group::Error => vec![
                    error("abbe", case, compensator(case, machine)),
                    error("abbe, numbers compiled in", case, compiled!($machine)),
                ],
                Group::Command => vec![
                    command::<_, _, $axes>("abbe", case, compensator(case, machine)),
                    command::<_, _, $axes>("abbe, numbers compiled in", case, compiled!($machine)),
                ],
            }
        }};
    }
    match case.name {
        "excello-921" => of!(excello_921, 2),
        "xyfz-mill" => of!(xyfz_mill, 3),
        "trunnion-5axis" => of!(trunnion_5axis, 5),
        "trunnion-5axis-turning" => of!(trunnion_5axis_turning, 5),
        _ => Vec::new(),
    }
}

fn boxed<const N: usize>(
    name: &'static str,
    answer: impl FnMut(usize, &mut [f64; N]) + 'static,
) -> Box<dyn Contestant> {
    Box::new(Answering { name, tolerance: EXACT, answer })
}

/// Numbers that live as long as the program, as a controller's do.
pub(crate) fn leak<T>(value: T) -> &'static mut T {
    Box::leak(Box::new(value))
}

/// As many numbers as asked for; NaN where there are not.
pub(crate) fn array<const N: usize>(values: &[f64]) -> [f64; N] {
    values.try_into().unwrap_or([f64::NAN; N])
}

fn error<K: Kinematics + 'static, M: ErrorMotions + ?Sized + 'static>(
    name: &'static str,
    case: &'static Case,
    mut compensator: Compensator<'static, K, M>,
) -> Box<dyn Contestant> {
    #[inline(never)]
    fn call<K: Kinematics, M: ErrorMotions + ?Sized>(
        compensator: &mut Compensator<'_, K, M>,
        sample: &Sample<'_>,
        out: &mut [f64; 3],
    ) {
        if let Ok(error) = compensator.error(sample) {
            *out = error;
        }
    }
    let samples = samples(case);
    boxed(name, move |state, out| call(&mut compensator, &samples[state], out))
}

fn command<K: Kinematics + 'static, M: ErrorMotions + ?Sized + 'static, const N: usize>(
    name: &'static str,
    case: &'static Case,
    mut compensator: Compensator<'static, K, M>,
) -> Box<dyn Contestant> {
    #[inline(never)]
    fn call<K: Kinematics, M: ErrorMotions + ?Sized>(
        compensator: &mut Compensator<'_, K, M>,
        sample: &Sample<'_>,
        out: &mut [f64],
    ) -> bool {
        compensator.compensate(sample, out).is_ok()
    }
    let samples = samples(case);
    boxed(name, move |state, out: &mut [f64; N]| {
        if !call(&mut compensator, &samples[state], out) {
            *out = [f64::NAN; N];
        }
    })
}

fn samples(case: &'static Case) -> Vec<Sample<'static>> {
    let sample = |state: &'static crate::case::State| {
        let direction = state.reversed.iter().map(|reversed| match reversed {
            true => Direction::Negative,
            false => Direction::Positive,
        });
        Sample {
            position: &state.position,
            travel: &[],
            direction: leak(direction.collect::<Vec<_>>()),
            velocity: &[],
            temperature: &[],
            time_step: 0.001,
        }
    };
    case.states.iter().map(sample).collect()
}

/// A compensator that reads the numbers of a case as terms.
fn compensator<K: Kinematics>(case: &'static Case, kinematics: &'static K) -> Compensator<'static, K> {
    let motions = case.motions.iter().map(|values| ErrorMotion { terms: leak(vec![term(values)]) });
    let motions: &[ErrorMotion<'static>] = leak(motions.collect::<Vec<_>>());
    with_room(states_needed(motions), kinematics, |states, work| {
        Compensator::new(kinematics, motions, states, work)
    })
}

#[expect(clippy::expect_used, reason = "a case that is set up wrong must end the measurement")]
fn term(values: &'static Values) -> Term<'static> {
    match values {
        Values::Number(value) => Term::Constant { value: *value },
        Values::Table(table) => {
            let curves = match &table.reverse {
                Some(reverse) => Curves::Directed { forward: &table.forward, reverse },
                None => Curves::Both(&table.forward),
            };
            let read = Table::uniform(table.start, table.step, curves).expect("a valid table");
            Term::Table { axis: table.axis, table: read }
        }
    }
}

/// A compensator with room for its memories and its work.
#[expect(clippy::expect_used, reason = "a case that is set up wrong must end the measurement")]
fn with_room<C>(
    terms: usize,
    kinematics: &impl Kinematics,
    made: impl FnOnce(&'static mut [TermState], Work<'static>) -> Result<C, SetupError>,
) -> C {
    let work = Work {
        directions: leak(vec![[0.0; 3]; kinematics.axes()]),
        motions: leak(vec![0.0; kinematics.motions()]),
        travel: &mut [],
    };
    made(leak(vec![TermState::default(); terms]), work).expect("a valid compensator")
}
