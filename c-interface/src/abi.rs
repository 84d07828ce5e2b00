//! The functions that C calls, and the only unsafe code of Abbe.
//!
//! In: pointers. Out: what the safe [`Controller`] says, as numbers. It exists because C has no references: every
//! function here turns its pointers into references, or into a negative [`Status`] where they are null, and calls safe code. A
//! panic, which there should be none of, ends at this border as [`Status::Fault`]; the handle says the same ever after.
//!
//! `abbe_open` is not here but in the code that `abbe expand --c-abi` writes, since it alone differs from machine to machine;
//! it calls [`open`].
#![expect(unsafe_code, reason = "C hands over pointers; nothing else of Abbe is unsafe")]

mod pointers;

use std::ffi::{CStr, OsStr, c_char};
use std::os::unix::ffi::OsStrExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, TryLockError};

use self::pointers::{slice, write_message, write_numbers};
use crate::controller::{Controller, Inputs};
use crate::load::{Loaded, load};
use crate::machine::{CompiledMachine, ForC};
use crate::status::{Cycle, Status};

/// The compensation of one machine. C holds it by a pointer and knows nothing of its inside.
pub struct Abbe {
    names: ForC,
    /// Whether the compensation is switched on: from the next cycle on.
    enabled: AtomicBool,
    /// Nobody ever waits for it.
    controller: Mutex<Controller>,
}

/// What a controller knows in one servo cycle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Position commanded for each axis: mm, rad for a rotary axis; machine coordinates.
    pub position: *const f64,
    /// For each axis the direction of its last real motion: +1, -1, or 0: found from its commands, their
    /// corrections included. Null: all are found.
    pub direction: *const f64,
    /// How many axes `position`, `direction` and the correction have.
    pub axes: usize,
    /// Temperature of each sensor in degC, NaN where it is silent. May be null where there are no sensors.
    pub temperature: *const f64,
    /// How many sensors `temperature` has.
    pub sensors: usize,
    /// Time since the cycle before this one, s.
    pub time_step: f64,
}

impl Abbe {
    /// Calls `inside` with the controller; [`Status::Busy`] where another call is inside already.
    fn enter(&self, inside: impl FnOnce(&mut Controller) -> Status) -> Status {
        guarded(|| match self.controller.try_lock() {
            Ok(mut controller) => inside(&mut controller),
            Err(TryLockError::WouldBlock) => Status::Busy,
            Err(TryLockError::Poisoned(_)) => Status::Fault,
        })
    }
}

/// Keeps a panic on this side of the border.
fn guarded(call: impl FnOnce() -> Status) -> Status {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or(Status::Fault)
}

/// What `abbe_open` of the machine `M` does; its documentation stands in the generated code.
///
/// # Safety
/// `calibration` is null or a string that ends in a zero byte, `handle` null or a place for a pointer, and `message` null or
/// room for `size` bytes.
pub unsafe fn open<M: CompiledMachine>(
    calibration: *const c_char,
    handle: *mut *mut Abbe,
    message: *mut c_char,
    size: usize,
) -> Status {
    if calibration.is_null() || handle.is_null() {
        return Status::NullPointer;
    }
    // SAFETY: not null, and a place for a pointer.
    unsafe { handle.write(ptr::null_mut()) };
    // SAFETY: not null, and a string that ends in a zero byte; it is read in this call only.
    let path = unsafe { CStr::from_ptr(calibration) };
    let path = Path::new(OsStr::from_bytes(path.to_bytes()));
    let loaded = catch_unwind(|| load::<M>(path));
    let (status, words) = match loaded {
        Ok(Ok(Loaded { controller, names, warnings })) => {
            let abbe = Abbe { names, enabled: AtomicBool::new(false), controller: Mutex::new(controller) };
            // SAFETY: not null, and a place for a pointer.
            unsafe { handle.write(Box::into_raw(Box::new(abbe))) };
            (Status::Done, warnings)
        }
        Ok(Err(mistakes)) => (Status::Calibration, mistakes),
        Err(_) => (Status::Fault, "error: a bug in Abbe".to_owned()),
    };
    // SAFETY: null or room for so many bytes.
    unsafe { write_message(&words, message, size) };
    status
}

/// One servo cycle: writes to `correction` what is to be added to the position of each axis, mm or rad.
///
/// It reads and writes no file, allocates nothing and does not wait. After a negative status nothing is written and nothing
/// goes on: the controller keeps its last correction, and an operator has to hear of it. `cycle` may be null.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed; `sample` is null or what it is said to be, with its pointers null or
/// to as many numbers as it says; `correction` is null or room for `sample->axes` numbers, which may be those of the positions;
/// `cycle` is null or room for one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_update(
    handle: *const Abbe,
    sample: *const Sample,
    correction: *mut f64,
    cycle: *mut Cycle,
) -> Status {
    // SAFETY: null or from `abbe_open` and not closed.
    let Some(abbe) = (unsafe { handle.as_ref() }) else { return Status::NullPointer };
    // SAFETY: null or a sample.
    let Some(sample) = (unsafe { sample.as_ref() }) else { return Status::NullPointer };
    if sample.axes != abbe.names.axes.len() || sample.sensors != abbe.names.sensors.len() {
        return Status::WrongLength;
    }
    let directions = if sample.direction.is_null() { 0 } else { sample.axes };
    // SAFETY: null or to as many numbers, which the two lines above have found to be those of the machine.
    let position = unsafe { slice(sample.position, sample.axes) };
    // SAFETY: as above.
    let direction = unsafe { slice(sample.direction, directions) };
    // SAFETY: as above.
    let temperature = unsafe { slice(sample.temperature, sample.sensors) };
    let (Some(position), Some(direction), Some(temperature)) = (position, direction, temperature) else {
        return Status::NullPointer;
    };
    if correction.is_null() {
        return Status::NullPointer;
    }
    let inputs = Inputs { position, direction, temperature, time_step: sample.time_step };
    let enabled = abbe.enabled.load(Ordering::Relaxed);
    abbe.enter(|controller| match controller.update(&inputs, enabled) {
        Ok((status, done)) => {
            // SAFETY: not null, and room for a number of each axis; the positions have been read.
            unsafe { write_numbers(controller.correction(), correction) };
            if !cycle.is_null() {
                // SAFETY: not null, and room for one.
                unsafe { cycle.write(done) };
            }
            status
        }
        Err(status) => status,
    })
}

/// Switches the compensation on or off, from the next cycle on and without a jump; from any thread. It begins switched off.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_enable(handle: *const Abbe, enabled: bool) -> Status {
    // SAFETY: null or from `abbe_open` and not closed.
    let Some(abbe) = (unsafe { handle.as_ref() }) else { return Status::NullPointer };
    abbe.enabled.store(enabled, Ordering::Relaxed);
    Status::Done
}

/// Takes a tool of the calibration by its name, from the next cycle on and without a jump; null: the constants of the calibration
/// itself. `12` is `T12` where no tool is called `12`. A name that no tool has is out of range, and nothing changes.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed; `name` is null or a string that ends in a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_set_tool(handle: *const Abbe, name: *const c_char) -> Status {
    // SAFETY: null or from `abbe_open` and not closed.
    let Some(abbe) = (unsafe { handle.as_ref() }) else { return Status::NullPointer };
    // SAFETY: not null where it is asked, and a string that ends in a zero byte; it is read in this call only.
    let name = (!name.is_null()).then(|| unsafe { CStr::from_ptr(name) });
    // What is not UTF-8 is the name of no tool.
    match name.map(CStr::to_str).transpose() {
        Ok(name) => abbe.enter(|controller| controller.set_tool(name)),
        Err(_) => Status::OutOfRange,
    }
}

/// Takes these constants of the machine, in mm, in the order of `abbe_constant_name`, from the next cycle on and without a jump: the
/// lengths of a tool that the controller itself knows.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed; `constants` is null or to `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_set_constants(
    handle: *const Abbe,
    constants: *const f64,
    count: usize,
) -> Status {
    // SAFETY: null or from `abbe_open` and not closed.
    let Some(abbe) = (unsafe { handle.as_ref() }) else { return Status::NullPointer };
    if count != abbe.names.constants.len() {
        return Status::WrongLength;
    }
    // SAFETY: null or to as many numbers, which the lines above have found to be those of the machine.
    let Some(constants) = (unsafe { slice(constants, count) }) else { return Status::NullPointer };
    abbe.enter(|controller| controller.set_constants(constants))
}

/// Writes what the last cycle found of the direction of the tool, from its tip towards the spindle: its error without compensation, and
/// what stays of it at the end of the correction; I, J, K in the part's frame, rad, NaN where there was no cycle yet or its sample was
/// refused. Out of range on a machine whose rotary axes do not correct that direction; nothing is written then. Either may be null.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed; `error` and `remaining` are null or room for three numbers each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_direction(handle: *const Abbe, error: *mut f64, remaining: *mut f64) -> Status {
    // SAFETY: null or from `abbe_open` and not closed.
    let Some(abbe) = (unsafe { handle.as_ref() }) else { return Status::NullPointer };
    abbe.enter(|controller| {
        let Some(direction) = controller.direction() else { return Status::OutOfRange };
        if !error.is_null() {
            // SAFETY: not null, and room for three numbers.
            unsafe { write_numbers(&direction.error, error) };
        }
        if !remaining.is_null() {
            // SAFETY: as above.
            unsafe { write_numbers(&direction.remaining, remaining) };
        }
        Status::Done
    })
}

/// Forgets what terms, sensors and axes remember, as if the machine had just started: after homing, say. The correction made
/// stays, and goes from there to what is wanted next.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_restart(handle: *const Abbe) -> Status {
    // SAFETY: null or from `abbe_open` and not closed.
    let Some(abbe) = (unsafe { handle.as_ref() }) else { return Status::NullPointer };
    abbe.enter(|controller| {
        controller.restart();
        Status::Done
    })
}

/// How far an axis must move back before its direction counts as turned: mm, or rad for a rotary axis. Until it is called,
/// 0.001 mm or 0.001 deg. The axis forgets its motion: its direction starts again as positive.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_set_hysteresis(handle: *const Abbe, axis: usize, threshold: f64) -> Status {
    // SAFETY: null or from `abbe_open` and not closed.
    let Some(abbe) = (unsafe { handle.as_ref() }) else { return Status::NullPointer };
    abbe.enter(|controller| controller.set_hysteresis(axis, threshold))
}

/// How many axes the machine has; 0 for a null pointer.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_axes(handle: *const Abbe) -> usize {
    // SAFETY: null or from `abbe_open` and not closed.
    unsafe { handle.as_ref() }.map_or(0, |abbe| abbe.names.axes.len())
}

/// The letter of an axis, or the id of its link, in the order of positions; null where there is none. It lives as long as
/// the handle.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_axis_letter(handle: *const Abbe, axis: usize) -> *const c_char {
    // SAFETY: null or from `abbe_open` and not closed.
    let abbe = unsafe { handle.as_ref() };
    abbe.and_then(|abbe| abbe.names.axes.get(axis)).map_or(ptr::null(), |(letter, _)| letter.as_ptr())
}

/// Whether positions on an axis are angles in rad rather than lengths in mm.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_axis_is_rotary(handle: *const Abbe, axis: usize) -> bool {
    // SAFETY: null or from `abbe_open` and not closed.
    let abbe = unsafe { handle.as_ref() };
    abbe.and_then(|abbe| abbe.names.axes.get(axis)).is_some_and(|(_, rotary)| *rotary)
}

/// How many temperature sensors the calibration reads; 0 for a null pointer.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_sensors(handle: *const Abbe) -> usize {
    // SAFETY: null or from `abbe_open` and not closed.
    unsafe { handle.as_ref() }.map_or(0, |abbe| abbe.names.sensors.len())
}

/// The name of a temperature sensor, in the order of temperatures; null where there is none. It lives as long as the handle.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_sensor_name(handle: *const Abbe, sensor: usize) -> *const c_char {
    // SAFETY: null or from `abbe_open` and not closed.
    let abbe = unsafe { handle.as_ref() };
    abbe.and_then(|abbe| abbe.names.sensors.get(sensor)).map_or(ptr::null(), |name| name.as_ptr())
}

/// How many tools the calibration has; 0 for a null pointer.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_tools(handle: *const Abbe) -> usize {
    // SAFETY: null or from `abbe_open` and not closed.
    unsafe { handle.as_ref() }.map_or(0, |abbe| abbe.names.tools.len())
}

/// The name of a tool, in the order of the calibration; null where there is none. It lives as long as the handle.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_tool_name(handle: *const Abbe, tool: usize) -> *const c_char {
    // SAFETY: null or from `abbe_open` and not closed.
    let abbe = unsafe { handle.as_ref() };
    abbe.and_then(|abbe| abbe.names.tools.get(tool)).map_or(ptr::null(), |name| name.as_ptr())
}

/// How many constants the machine has; 0 for a null pointer.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_constants(handle: *const Abbe) -> usize {
    // SAFETY: null or from `abbe_open` and not closed.
    unsafe { handle.as_ref() }.map_or(0, |abbe| abbe.names.constants.len())
}

/// The name of a constant of the machine, such as `Zt`; null where there is none. It lives as long as the handle.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_constant_name(handle: *const Abbe, constant: usize) -> *const c_char {
    // SAFETY: null or from `abbe_open` and not closed.
    let abbe = unsafe { handle.as_ref() };
    abbe.and_then(|abbe| abbe.names.constants.get(constant)).map_or(ptr::null(), |name| name.as_ptr())
}

/// The name of the machine that was compiled in; null for a null pointer. It lives as long as the handle.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_machine(handle: *const Abbe) -> *const c_char {
    // SAFETY: null or from `abbe_open` and not closed.
    unsafe { handle.as_ref() }.map_or(ptr::null(), |abbe| abbe.names.machine.as_ptr())
}

/// Gives back what `abbe_open` took. A null pointer is nothing to give back.
///
/// # Safety
/// `handle` is null or from `abbe_open` and not closed, and no thread is in a call with it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abbe_close(handle: *mut Abbe) {
    if !handle.is_null() {
        // SAFETY: from `Box::into_raw` in `open`, not closed since, and nobody else has a reference.
        drop(unsafe { Box::from_raw(handle) });
    }
}

/// A status in words, in English; for any number. It lives for ever.
#[unsafe(no_mangle)]
pub extern "C" fn abbe_status_text(status: i32) -> *const c_char {
    Status::of(status).map_or(c"not a status of Abbe", Status::text).as_ptr()
}

/// The version of Abbe, such as `0.1.0`. It lives for ever.
#[unsafe(no_mangle)]
pub extern "C" fn abbe_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
