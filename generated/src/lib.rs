//! The shipped machines, compiled: one module for each file of `machines/`.
//!
//! In: error motions and positions, as typed structs. Out: the error at the tool, its lever
//! arms, and the interface that `abbe_runtime::Compensator` calls. Nothing here is written by
//! hand: `build.rs` compiles the machine files again whenever one of them changes.
//!
//! ```
//! use abbe_generated::excello_921::{Axes, Constants, Machine, Motions};
//!
//! let lathe = Machine { constants: Constants { x1: 100.0, z1: -700.0, x2: 150.0, xt: 80.0, zt: -120.0 } };
//! // The Z slide yaws by 10 urad; its arm in X is z + Z1 - Zt = 300 - 700 + 120 = -280 mm.
//! let motions = Motions { ebz: 10e-6, ..Default::default() };
//! let [x, _, _] = lathe.error(&Axes { x: 40.0, z: 300.0 }, &motions);
//! assert!((x - -0.0028).abs() < 1e-12);
//! ```
#![no_std]

include!(concat!(env!("OUT_DIR"), "/machines.rs"));
