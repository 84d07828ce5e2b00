//! What C may do with a handle, from Rust, so that Miri sees each pointer. In: pointers, right and wrong. Out: a status, and
//! memory as it was where that is negative.
#![expect(unsafe_code, reason = "it calls what C calls")]

use std::ffi::{CStr, CString, c_char};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::{ptr, thread};

use crate::stage::{self, Folder, Stage};
use abbe_c::abi::*;
use abbe_c::{Cycle, Status};

const CALIBRATION: &str = "limits: {fade: 1 s}\nerrors:
  EXX:
    - constant: {value: 20 um}
    - growth: {sensor: body, coefficient: 1 um/K, reference: 20 degC}\n";

/// A handle, or the status and the message.
fn opened(path: &Path) -> Result<*mut Abbe, (Status, String)> {
    let path = CString::new(path.as_os_str().as_bytes()).unwrap();
    let mut handle = ptr::null_mut();
    let mut message: [c_char; 500] = [1; 500];
    // SAFETY: a string, a place for a pointer, and room.
    let status =
        unsafe { open::<Stage>(path.as_ptr(), &raw mut handle, message.as_mut_ptr(), message.len()) };
    // SAFETY: `open` ends it with a zero byte.
    let text = unsafe { CStr::from_ptr(message.as_ptr()) }.to_string_lossy().into_owned();
    assert_eq!(handle.is_null(), status != Status::Done);
    if handle.is_null() { Err((status, text)) } else { Ok(handle) }
}

fn stage() -> *mut Abbe {
    let folder = Folder::new();
    opened(&folder.file("stage.yaml", &stage::calibration(CALIBRATION))).unwrap()
}

/// A sample over these numbers.
fn sample(position: &[f64], temperature: &[f64]) -> Sample {
    Sample {
        position: position.as_ptr(),
        direction: ptr::null(),
        axes: position.len(),
        temperature: temperature.as_ptr(),
        sensors: temperature.len(),
        time_step: 0.1,
    }
}

#[test]
fn a_cycle_writes_the_correction_and_what_was_done() {
    let handle = stage();
    let (position, temperature) = ([50.0], [25.0]);
    let sample = sample(&position, &temperature);
    let (mut correction, mut cycle) = (f64::NAN, None::<Cycle>);
    // SAFETY: a handle, a sample with its numbers, and room for what is written.
    unsafe {
        assert_eq!(abbe_update(handle, &raw const sample, &raw mut correction, ptr::null_mut()), Status::Off);
        assert_eq!(correction, 0.0);
        assert_eq!(abbe_enable(handle, true), Status::Done);
        for _ in 0..12 {
            let mut done = std::mem::MaybeUninit::uninit();
            let status = abbe_update(handle, &raw const sample, &raw mut correction, done.as_mut_ptr());
            assert_eq!(status, Status::Active);
            cycle = Some(done.assume_init());
        }
        abbe_close(handle);
    }
    // 20 um, and 5 K of 1 um/K.
    assert!((correction + 0.025).abs() < 1e-9, "{correction}");
    let cycle = cycle.unwrap();
    assert!(
        (cycle.error[0] - 0.025).abs() < 1e-12 && (cycle.correction - 0.025).abs() < 1e-9 && !cycle.settling
    );
}

#[test]
fn wrong_pointers_and_lengths_have_a_status_and_nothing_is_written() {
    let handle = stage();
    let (numbers, more) = ([50.0], [1.0, 2.0]);
    let good = sample(&numbers, &numbers);
    let wrong = [
        (Sample { position: ptr::null(), ..good }, Status::NullPointer),
        (Sample { temperature: ptr::null(), ..good }, Status::NullPointer),
        (Sample { axes: 0, ..good }, Status::WrongLength),
        (Sample { axes: usize::MAX, ..good }, Status::WrongLength),
        (Sample { sensors: 0, ..good }, Status::WrongLength),
        (sample(&more, &numbers), Status::WrongLength),
        (Sample { direction: numbers.as_ptr(), ..good }, Status::OutOfRange),
    ];
    let (mut correction, mut none) = (7.0, ptr::null_mut());
    // SAFETY: null or what is asked for; lengths that are wrong are found before anything is read.
    unsafe {
        for (sample, status) in &wrong {
            let answer = abbe_update(handle, &raw const *sample, &raw mut correction, ptr::null_mut());
            assert_eq!((answer, correction), (*status, 7.0), "{sample:?}");
        }
        let null = Status::NullPointer;
        assert_eq!(abbe_update(ptr::null(), &raw const good, &raw mut correction, ptr::null_mut()), null);
        assert_eq!(abbe_update(handle, ptr::null(), &raw mut correction, ptr::null_mut()), null);
        assert_eq!(abbe_update(handle, &raw const good, ptr::null_mut(), ptr::null_mut()), null);
        assert_eq!(open::<Stage>(ptr::null(), &raw mut none, ptr::null_mut(), 0), null);
        assert_eq!(open::<Stage>(c"/".as_ptr(), ptr::null_mut(), ptr::null_mut(), 0), null);
        abbe_close(ptr::null_mut());
        abbe_close(handle);
    }
}

#[test]
fn a_correction_may_take_the_place_of_its_position() {
    let handle = stage();
    let (mut both, temperature) = (50.0, [20.0]);
    let sample = Sample { position: &raw const both, ..sample(&[0.0], &temperature) };
    // SAFETY: one number, read before it is written.
    let status = unsafe { abbe_update(handle, &raw const sample, &raw mut both, ptr::null_mut()) };
    assert_eq!((status, both), (Status::Off, 0.0));
    // SAFETY: nobody has it any more.
    unsafe { abbe_close(handle) };
}

/// A stage whose X is turned about Y, with two tools of other lengths.
const TOOLS: &str =
    "limits: {fade: 1 s}\ntools: {T2: {Zt: 150 mm}, long: {Zt: 300 mm}}\nerrors: {EBX: 100 urad}\n";

#[test]
fn a_tool_changes_the_lever_arms_without_a_jump() {
    let folder = Folder::new();
    let handle = opened(&folder.file("stage.yaml", &stage::calibration(TOOLS))).unwrap();
    let sample = sample(&[50.0], &[]);
    let mut correction = f64::NAN;
    // Runs some cycles of 0.1 s, and gives the correction of each in um.
    let mut run = |cycles: usize| -> Vec<f64> {
        let cycle = |_| {
            // SAFETY: a handle, a sample with its numbers, and room for what is written.
            let status =
                unsafe { abbe_update(handle, &raw const sample, &raw mut correction, ptr::null_mut()) };
            assert_eq!(status, Status::Active);
            (correction * 1e4).round() / 10.0
        };
        (0..cycles).map(cycle).collect()
    };
    // SAFETY: a handle, and strings and numbers that live as long as the calls.
    unsafe {
        assert_eq!(abbe_enable(handle, true), Status::Done);
        assert_eq!(run(10), [-1.0, -2.0, -3.0, -4.0, -5.0, -6.0, -7.0, -8.0, -9.0, -10.0]);
        // 100 urad of 150 mm and no longer of 100 mm: 5 um more, over a second.
        assert_eq!(abbe_set_tool(handle, c"2".as_ptr()), Status::Done);
        assert_eq!(
            run(12),
            [-10.5, -11.0, -11.5, -12.0, -12.5, -13.0, -13.5, -14.0, -14.5, -15.0, -15.0, -15.0]
        );
        for unknown in [c"3".as_ptr(), c"T".as_ptr(), c"\xff".as_ptr()] {
            assert_eq!(abbe_set_tool(handle, unknown), Status::OutOfRange);
        }
        assert_eq!(run(1), [-15.0]);
        assert_eq!(abbe_set_constants(handle, [0.0, 0.0, 50.0].as_ptr(), 3), Status::Done);
        assert_eq!(run(11).last(), Some(&-5.0));
        assert_eq!(abbe_set_constants(handle, [0.0, 0.0].as_ptr(), 2), Status::WrongLength);
        assert_eq!(abbe_set_constants(handle, [0.0, 0.0, f64::NAN].as_ptr(), 3), Status::OutOfRange);
        assert_eq!(abbe_set_constants(handle, ptr::null(), 3), Status::NullPointer);
        assert_eq!(run(1), [-5.0]);
        assert_eq!(abbe_set_tool(handle, ptr::null()), Status::Done);
        assert_eq!(run(11).last(), Some(&-10.0));
        assert_eq!(abbe_set_tool(ptr::null(), ptr::null()), Status::NullPointer);
        assert_eq!(abbe_set_constants(ptr::null(), ptr::null(), 3), Status::NullPointer);
        assert_eq!((abbe_tools(handle), abbe_constants(handle)), (2, 3));
        assert_eq!(CStr::from_ptr(abbe_tool_name(handle, 1)), c"long");
        assert_eq!(CStr::from_ptr(abbe_constant_name(handle, 2)), c"Zt");
        assert!(abbe_tool_name(handle, 2).is_null() && abbe_constant_name(handle, 3).is_null());
        assert_eq!((abbe_tools(ptr::null()), abbe_constants(ptr::null())), (0, 0));
        abbe_close(handle);
    }
}

#[test]
fn names_are_those_of_the_machine_and_its_calibration() {
    let handle = stage();
    // SAFETY: strings that live as long as the handle.
    unsafe {
        assert_eq!(CStr::from_ptr(abbe_machine(handle)), c"stage");
        assert_eq!((abbe_axes(handle), CStr::from_ptr(abbe_axis_letter(handle, 0))), (1, c"X"));
        assert_eq!((abbe_sensors(handle), CStr::from_ptr(abbe_sensor_name(handle, 0))), (1, c"body"));
        assert!(abbe_axis_letter(handle, 1).is_null() && abbe_sensor_name(handle, usize::MAX).is_null());
        assert!(!abbe_axis_is_rotary(handle, 0));
        assert_eq!(CStr::from_ptr(abbe_version()).to_str(), Ok(env!("CARGO_PKG_VERSION")));
        assert_eq!(CStr::from_ptr(abbe_status_text(-5)), Status::Busy.text());
        assert_eq!(CStr::from_ptr(abbe_status_text(6)), c"not a status of Abbe");
        abbe_close(handle);
    }
}

#[test]
fn a_message_is_cut_at_a_whole_character() {
    // The name of a missing file stands in the message, umlauts of two bytes each.
    let path = CString::new("\u{e4}".repeat(100)).unwrap();
    for size in 0..60 {
        let mut message: Vec<c_char> = vec![1; 60];
        let mut handle = ptr::null_mut();
        // SAFETY: a string, a place for a pointer, and room for so many bytes.
        let status = unsafe { open::<Stage>(path.as_ptr(), &raw mut handle, message.as_mut_ptr(), size) };
        assert_eq!(status, Status::Calibration);
        assert!(message[size..].iter().all(|&byte| byte == 1), "written beyond {size} bytes");
        if size > 0 {
            // SAFETY: it ends within its size.
            let text = unsafe { CStr::from_ptr(message.as_ptr()) };
            assert!(text.to_bytes().len() < size && text.to_str().is_ok());
        }
    }
}

#[test]
fn a_second_thread_is_told_that_it_is_one() {
    struct Shared(*mut Abbe);
    // SAFETY: a handle may be used from any thread.
    unsafe impl Sync for Shared {}
    let shared = Shared(stage());
    let cycles = |handle: &Shared| {
        let (position, temperature) = ([50.0], [20.0]);
        let sample = sample(&position, &temperature);
        for _ in 0..50 {
            let mut correction = 0.0;
            // SAFETY: a handle, a sample with its numbers, and room for one.
            let status =
                unsafe { abbe_update(handle.0, &raw const sample, &raw mut correction, ptr::null_mut()) };
            assert!([Status::Off, Status::Active, Status::Busy].contains(&status));
            // SAFETY: a handle.
            assert_eq!(unsafe { abbe_enable(handle.0, true) }, Status::Done);
        }
    };
    thread::scope(|scope| {
        scope.spawn(|| cycles(&shared));
        cycles(&shared);
    });
    // SAFETY: both threads are done with it.
    unsafe { abbe_close(shared.0) };
}
