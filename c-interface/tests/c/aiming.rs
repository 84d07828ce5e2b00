//! The direction of the tool, as C asks for it. In: a head that tilts the tool, and a link that leans. Out: the error of the direction
//! and what stays of it, from a machine that corrects it; a status from one that does not.
#![expect(unsafe_code, reason = "it calls what C calls")]

use std::cell::Cell;
use std::ffi::CString;
use std::os::unix::ffi::OsStrExt;
use std::ptr;

use abbe_c::abi::*;
use abbe_c::{AxisOfMachine, CompiledMachine, ConstantOfMachine, MotionOfMachine, Status};
use abbe_runtime::Kinematics;

use crate::stage::{Folder, Stage};

/// A tool that a head B tilts from Z towards X; a link before it is turned about Y by EBF.
#[derive(Clone, Copy)]
struct Head;

fn across(position: &[f64]) -> [f64; 3] {
    let b = position.first().copied().unwrap_or(f64::NAN);
    [b.cos(), 0.0, -b.sin()]
}

impl Kinematics for Head {
    fn axes(&self) -> usize {
        1
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        1
    }
    fn error(&self, _: &[f64], _: &[f64], _: &[f64]) -> [f64; 3] {
        [0.0; 3]
    }
    fn directions(&self, _: &[f64], directions: &mut [[f64; 3]]) {
        directions.fill([0.0; 3]);
    }
    fn aiming(&self) -> &[usize] {
        &[0]
    }
    fn nominal(&self, _: &[f64]) -> [f64; 3] {
        [0.0; 3]
    }
    fn direction(&self, position: &[f64]) -> [f64; 3] {
        let [cosine, _, minus_sine] = across(position);
        [-minus_sine, 0.0, cosine]
    }
    fn direction_error(&self, position: &[f64], _: &[f64], motions: &[f64]) -> [f64; 3] {
        across(position).map(|part| part * motions.first().copied().unwrap_or(f64::NAN))
    }
    fn aims(&self, position: &[f64], aims: &mut [[f64; 3]; 3]) {
        *aims = [across(position), [0.0; 3], [0.0; 3]];
    }
}

impl CompiledMachine for Head {
    const NAME: &'static str = "head";
    const CONSTANTS: &'static [ConstantOfMachine] = &[];
    const AXES: &'static [AxisOfMachine] = &[("B", true)];
    const MOTIONS: &'static [MotionOfMachine] = &[("EBF", true, None, false)];
    const EQUATIONS: &'static str = "what no machine file says";

    fn with_constants(constants: &[f64]) -> Option<Self> {
        constants.is_empty().then_some(Self)
    }
}

/// A handle of the machine with this calibration.
fn opened<M: CompiledMachine>(text: &str) -> *mut Abbe {
    let folder = Folder::new();
    let path = CString::new(folder.file("calibration.yaml", text).as_os_str().as_bytes()).unwrap();
    let mut handle = ptr::null_mut();
    // SAFETY: a string, a place for a pointer, and no room that is needed.
    let status = unsafe { open::<M>(path.as_ptr(), &raw mut handle, ptr::null_mut(), 0) };
    assert_eq!(status, Status::Done);
    handle
}

fn sample(position: &[f64; 1]) -> Sample {
    Sample {
        position: position.as_ptr(),
        direction: ptr::null(),
        axes: 1,
        temperature: ptr::null(),
        sensors: 0,
        time_step: 10.0,
    }
}

#[test]
fn the_direction_is_told_and_corrected() {
    let handle = opened::<Head>(
        "calibration: 1\nmachine: head\nlimits: {rotation: 1 mrad}\nerrors:\n  EBF: 40 urad\n",
    );
    let (position, endless) = ([0.3], [f64::NAN]);
    let (mut error, mut remaining) = ([7.0; 3], [7.0; 3]);
    // SAFETY: a handle, samples with their numbers, and room for what is written.
    unsafe {
        assert_eq!(abbe_direction(handle, error.as_mut_ptr(), remaining.as_mut_ptr()), Status::Done);
        assert!(error.iter().chain(&remaining).all(|part| part.is_nan()), "no cycle yet");
        let made = Cell::new(f64::NAN);
        let update = |position: &[f64; 1]| {
            let sample = sample(position);
            abbe_update(handle, &raw const sample, made.as_ptr(), ptr::null_mut())
        };
        let expected = [40e-6 * 0.3_f64.cos(), 0.0, -40e-6 * 0.3_f64.sin()];
        let near =
            |found: [f64; 3]| found.iter().zip(expected).all(|(found, part)| (found - part).abs() < 1e-9);
        assert_eq!(update(&position), Status::Off);
        assert_eq!(abbe_direction(handle, error.as_mut_ptr(), remaining.as_mut_ptr()), Status::Done);
        assert!(near(error) && near(remaining), "{error:?} {remaining:?}");
        assert_eq!(abbe_enable(handle, true), Status::Done);
        assert_eq!((update(&position), update(&position)), (Status::Active, Status::Active));
        assert_eq!(abbe_direction(handle, error.as_mut_ptr(), remaining.as_mut_ptr()), Status::Done);
        assert!(near(error) && remaining.iter().all(|part| part.abs() < 1e-9), "{error:?} {remaining:?}");
        assert!((made.get() + 40e-6).abs() < 1e-9, "{made:?}");
        assert_eq!(update(&endless), Status::Refused);
        assert_eq!(abbe_direction(handle, ptr::null_mut(), remaining.as_mut_ptr()), Status::Done);
        assert!(remaining.iter().all(|part| part.is_nan()));
        abbe_close(handle);
    }
}

#[test]
fn a_machine_that_corrects_no_direction_says_so() {
    let handle = opened::<Stage>(
        "calibration: 1\nmachine: stage\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nerrors: {}\n",
    );
    let mut error = [7.0; 3];
    // SAFETY: a handle or null, and room.
    unsafe {
        assert_eq!(abbe_direction(handle, error.as_mut_ptr(), ptr::null_mut()), Status::OutOfRange);
        assert_eq!(abbe_direction(ptr::null(), error.as_mut_ptr(), ptr::null_mut()), Status::NullPointer);
        abbe_close(handle);
    }
    assert_eq!(error, [7.0; 3]);
}
