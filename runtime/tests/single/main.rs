//! Tests of the runtime over numbers of 32 bits.
//!
//! In: the same machines, terms and tables over both kinds of numbers. Out: how far they are apart, against what rounding leaves, and
//! what only coarse numbers do: clocks that stand still, commands that jump to and fro.

#![cfg(feature = "single")]
#![expect(clippy::unwrap_used, reason = "in a test a panic is the report, in its helpers too")]
#![expect(clippy::cast_possible_truncation, reason = "the nearest number of 32 bits is asked for")]

mod searches;
mod sines;
mod tables;
mod terms;
mod time;

/// What one operation rounds by, beside its result.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;

/// Numbers that differ from test to test, the same on every run: from -1 to 1, in steps of 2^-23.
fn drawn(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        // Knuth's MMIX.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let top = u16::try_from(state >> 48).unwrap_or_default();
        let next = u16::try_from((state >> 32) & 0xff).unwrap_or_default();
        (f32::from(top) * 256.0 + f32::from(next)) / 8_388_608.0 - 1.0
    }
}
