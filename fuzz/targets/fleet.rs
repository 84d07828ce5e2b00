//! The search for files that break [`abbe_fuzz::fleet`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| abbe_fuzz::fleet::run(bytes));
