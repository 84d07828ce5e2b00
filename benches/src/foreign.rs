//! The contestants in C: by hand (`c/`), and by the symbolic tools that were there at build time.
//!
//! In: a case. Out: contestants that call C through its interface. Only this file has unsafe code: C reads slices
//! whose lengths it does not know, and they are checked here once.

use std::ffi::{c_int, c_long};

use crate::case::{Case, NODES, Values};
use crate::contest::{Answering, Contestant, EXACT, Group};
use crate::ours::leak;

/// The most axes of a machine here.
const AXES: usize = 5;

type Equations = unsafe extern "C" fn(*const f64, *const f64, *const f64, *mut f64);
type Error = unsafe extern "C" fn(*const u8, *const f64, *const c_long, *mut f64);
type Command = unsafe extern "C" fn(*const u8, *const f64, *const c_long, *mut f64) -> c_int;

unsafe extern "C" {
    fn lathe_equations(constants: *const f64, position: *const f64, motions: *const f64, out: *mut f64);
    fn mill_equations(constants: *const f64, position: *const f64, motions: *const f64, out: *mut f64);
    fn trunnion_equations(constants: *const f64, position: *const f64, motions: *const f64, out: *mut f64);
    fn lathe_error_own(machine: *const u8, position: *const f64, reverse: *const c_long, out: *mut f64);
    fn mill_error_own(machine: *const u8, position: *const f64, reverse: *const c_long, out: *mut f64);
    fn trunnion_error_own(machine: *const u8, position: *const f64, reverse: *const c_long, out: *mut f64);
    fn lathe_error_shared(machine: *const u8, position: *const f64, reverse: *const c_long, out: *mut f64);
    fn mill_error_shared(machine: *const u8, position: *const f64, reverse: *const c_long, out: *mut f64);
    fn trunnion_error_shared(machine: *const u8, position: *const f64, reverse: *const c_long, out: *mut f64);
    fn lathe_compensate_own(m: *const u8, p: *const f64, reverse: *const c_long, out: *mut f64) -> c_int;
    fn mill_compensate_own(m: *const u8, p: *const f64, reverse: *const c_long, out: *mut f64) -> c_int;
    fn trunnion_compensate_own(m: *const u8, p: *const f64, reverse: *const c_long, out: *mut f64) -> c_int;
    fn lathe_compensate_shared(m: *const u8, p: *const f64, reverse: *const c_long, out: *mut f64) -> c_int;
    fn mill_compensate_shared(m: *const u8, p: *const f64, reverse: *const c_long, out: *mut f64) -> c_int;
    fn trunnion_compensate_shared(
        m: *const u8,
        p: *const f64,
        reverse: *const c_long,
        out: *mut f64,
    ) -> c_int;
    fn trunnion_turning_own(m: *const u8, p: *const f64, reverse: *const c_long, out: *mut f64) -> c_int;
    fn trunnion_turning_shared(m: *const u8, p: *const f64, reverse: *const c_long, out: *mut f64) -> c_int;
}

/// The code of a symbolic tool for the three machines: position, constants, motions, out.
macro_rules! tool {
    ($feature:ident, $lathe:ident, $mill:ident, $trunnion:ident) => {
        #[cfg($feature)]
        unsafe extern "C" {
            fn $lathe(position: *const f64, constants: *const f64, motions: *const f64, out: *mut f64);
            fn $mill(position: *const f64, constants: *const f64, motions: *const f64, out: *mut f64);
            fn $trunnion(position: *const f64, constants: *const f64, motions: *const f64, out: *mut f64);
        }
        #[cfg($feature)]
        fn $feature() -> Option<[Equations; 3]> {
            Some([$lathe, $mill, $trunnion])
        }
        #[cfg(not($feature))]
        fn $feature() -> Option<[Equations; 3]> {
            None
        }
    };
}
tool!(sympy, sympy_excello_921, sympy_xyfz_mill, sympy_trunnion_5axis);
tool!(casadi, casadi_excello_921, casadi_xyfz_mill, casadi_trunnion_5axis);
tool!(symforce, symforce_excello_921, symforce_xyfz_mill, symforce_trunnion_5axis);

/// The functions of a machine by hand.
struct Hand {
    equations: Equations,
    errors: [Error; 2],
    commands: [Command; 2],
}

fn hand(machine: usize) -> Option<Hand> {
    let hands = [
        Hand {
            equations: lathe_equations,
            errors: [lathe_error_own, lathe_error_shared],
            commands: [lathe_compensate_own, lathe_compensate_shared],
        },
        Hand {
            equations: mill_equations,
            errors: [mill_error_own, mill_error_shared],
            commands: [mill_compensate_own, mill_compensate_shared],
        },
        Hand {
            equations: trunnion_equations,
            errors: [trunnion_error_own, trunnion_error_shared],
            commands: [trunnion_compensate_own, trunnion_compensate_shared],
        },
        Hand {
            equations: trunnion_equations,
            errors: [trunnion_error_own, trunnion_error_shared],
            commands: [trunnion_turning_own, trunnion_turning_shared],
        },
    ];
    hands.into_iter().nth(machine)
}

/// The contestants of a machine.
pub(crate) fn contestants(case: &'static Case, group: Group) -> Vec<Box<dyn Contestant>> {
    let number = crate::contest::MACHINES.iter().position(|name| *name == case.name);
    let Some((number, hand)) = number.and_then(|number| Some((number, hand(number)?))) else {
        return Vec::new();
    };
    match group {
        Group::Equations => equations(case, number, hand.equations),
        Group::Error => {
            vec![error(case, "c, own nodes", hand.errors[0]), error(case, "c, shared nodes", hand.errors[1])]
        }
        Group::Command => match case.chain.variables.len() {
            2 => commands::<2>(case, hand.commands),
            3 => commands::<3>(case, hand.commands),
            _ => commands::<5>(case, hand.commands),
        },
    }
}

fn equations(case: &'static Case, number: usize, hand: Equations) -> Vec<Box<dyn Contestant>> {
    let by_hand = Box::new(Answering {
        name: "c by hand",
        tolerance: EXACT,
        answer: move |state: usize, out: &mut [f64; 3]| {
            let state = &case.states[state];
            // SAFETY: the case holds as many constants, positions and motions as its machine has; out has three.
            unsafe {
                hand(
                    case.constants.as_ptr(),
                    state.position.as_ptr(),
                    state.motions.as_ptr(),
                    out.as_mut_ptr(),
                );
            }
        },
    });
    let mut all: Vec<Box<dyn Contestant>> = vec![by_hand];
    for (name, written) in [("sympy", sympy()), ("casadi", casadi()), ("symforce", symforce())] {
        let Some(function) = written.and_then(|machines| machines.get(number).copied()) else {
            eprintln!("{name}: its code is not in this build, it is left out");
            continue;
        };
        let answer = move |state: usize, out: &mut [f64; 3]| {
            let state = &case.states[state];
            // SAFETY: as above.
            unsafe {
                function(
                    state.position.as_ptr(),
                    case.constants.as_ptr(),
                    state.motions.as_ptr(),
                    out.as_mut_ptr(),
                );
            }
        };
        all.push(Box::new(Answering { name, tolerance: EXACT, answer }));
    }
    all
}

/// `struct nodes` and `struct table` of `c/lookup.h`.
#[repr(C)]
struct Table {
    start: f64,
    per_step: f64,
    last: c_long,
    curve: [*const f64; 2],
}

/// The struct of a machine in C: constants, tables, then all motions, of which only the alignments are read.
fn packed(case: &'static Case) -> *const u8 {
    let mut words: Vec<u64> = case.constants.iter().map(|value| value.to_bits()).collect();
    for values in &case.motions {
        if let Values::Table(table) = values {
            let c = Table {
                start: table.start,
                per_step: 1.0 / table.step,
                last: (NODES - 1) as c_long,
                curve: [table.curve(false).as_ptr(), table.curve(true).as_ptr()],
            };
            words.extend([c.start.to_bits(), c.per_step.to_bits(), c.last as u64]);
            words.extend(c.curve.map(|curve| curve as u64));
        }
    }
    words.extend(case.motions.iter().map(|values| match values {
        Values::Number(value) => value.to_bits(),
        Values::Table(_) => 0,
    }));
    leak(words).as_ptr().cast()
}

fn reversals(case: &'static Case) -> Vec<[c_long; AXES]> {
    let one = |state: &crate::case::State| {
        let mut flags = [0; AXES];
        for (flag, reversed) in flags.iter_mut().zip(&state.reversed) {
            *flag = c_long::from(*reversed);
        }
        flags
    };
    case.states.iter().map(one).collect()
}

fn error(case: &'static Case, name: &'static str, function: Error) -> Box<dyn Contestant> {
    let (machine, reversals) = (packed(case), reversals(case));
    let answer = move |state: usize, out: &mut [f64; 3]| {
        // SAFETY: the machine is packed as its struct, and positions and flags are one for each of its axes.
        unsafe {
            function(
                machine,
                case.states[state].position.as_ptr(),
                reversals[state].as_ptr(),
                out.as_mut_ptr(),
            );
        }
    };
    Box::new(Answering { name, tolerance: EXACT, answer })
}

fn commands<const N: usize>(case: &'static Case, functions: [Command; 2]) -> Vec<Box<dyn Contestant>> {
    let names = ["c, own nodes", "c, shared nodes"];
    let one = |(name, function): (&'static str, Command)| {
        let (machine, reversals) = (packed(case), reversals(case));
        let answer = move |state: usize, out: &mut [f64; N]| {
            // SAFETY: as for the error; N is the number of axes.
            let steps = unsafe {
                function(
                    machine,
                    case.states[state].position.as_ptr(),
                    reversals[state].as_ptr(),
                    out.as_mut_ptr(),
                )
            };
            if steps <= 0 {
                *out = [f64::NAN; N];
            }
        };
        let boxed: Box<dyn Contestant> = Box::new(Answering { name, tolerance: EXACT, answer });
        boxed
    };
    names.into_iter().zip(functions).map(one).collect()
}
