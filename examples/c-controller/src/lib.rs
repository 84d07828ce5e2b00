//! A mill as a library for a controller in C: `libmill.a`, `libmill.so`.
//!
//! In: what `build.rs` made of `mill.yaml`. Out: `abbe_open` for this machine; the other functions of `abbe.h` come from the
//! crate `abbe-c`. All of it is generated.

include!(concat!(env!("OUT_DIR"), "/mill.rs"));
