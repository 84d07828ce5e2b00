//! Random weights. In: the number of a recording and of a channel. Out: weights for its rows, the same in every run.

use crate::channel::ChannelAt;

/// Weights between -1 and 1 that are the same in every run of the program.
pub(super) struct Random(u64);

impl Random {
    /// The weights of a channel of a recording.
    pub(super) fn new(ChannelAt { scene, channel }: ChannelAt) -> Self {
        Self(0x9E37_79B9_7F4A_7C15 ^ ((scene as u64) << 32) ^ (channel as u64))
    }

    /// One step of the generator splitmix64.
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^= mixed >> 31;
        let half = u32::try_from(mixed >> 32).unwrap_or_default();
        f64::from(half) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}
