//! Pointers of C as slices, and text for C. In: pointers with lengths. Out: slices, or nothing where a pointer is null.

use std::ffi::c_char;
use std::{ptr, slice};

/// As many numbers from a pointer on; none where it is null and numbers are asked for.
///
/// # Safety
/// `from` is null or to `count` numbers that nobody writes during `'a`.
pub(super) unsafe fn slice<'a>(from: *const f64, count: usize) -> Option<&'a [f64]> {
    if count == 0 {
        return Some(&[]);
    }
    if from.is_null() {
        return None;
    }
    // SAFETY: not null, and to so many numbers that nobody writes.
    Some(unsafe { slice::from_raw_parts(from, count) })
}

/// Writes these numbers to where a pointer leads.
///
/// # Safety
/// `to` is room for as many numbers.
pub(super) unsafe fn write_numbers(numbers: &[f64], to: *mut f64) {
    // SAFETY: there is room, and these numbers are Rust's own, which no pointer of C reaches.
    unsafe { ptr::copy_nonoverlapping(numbers.as_ptr(), to, numbers.len()) };
}

/// Writes as much of a text as fits, in whole characters and with a zero byte at its end.
///
/// # Safety
/// `message` is null or room for `size` bytes.
pub(super) unsafe fn write_message(text: &str, message: *mut c_char, size: usize) {
    let Some(room) = size.checked_sub(1).filter(|_| !message.is_null()) else { return };
    let text = text.get(..text.floor_char_boundary(room)).unwrap_or_default();
    // SAFETY: the text is no longer than the room, which lies elsewhere than a string of Rust.
    unsafe { ptr::copy_nonoverlapping(text.as_ptr().cast(), message, text.len()) };
    // SAFETY: one more than the text is no more than the size.
    let end = unsafe { message.add(text.len()) };
    // SAFETY: as above.
    unsafe { end.write(0) };
}
