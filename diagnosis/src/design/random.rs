//! Random weights. In: the number of a recording and of a channel. Out: weights for its rows, the same in every run.

use crate::channel::ChannelAt;
use crate::random::Random;

/// Weights between -1 and 1 that are the same in every run of the program.
pub(super) struct RandomWeights(Random);

impl RandomWeights {
    /// The weights of a channel of a recording.
    pub(super) fn new(ChannelAt { scene, channel }: ChannelAt) -> Self {
        Self(Random::new(0x9E37_79B9_7F4A_7C15 ^ ((scene as u64) << 32) ^ (channel as u64)))
    }

    /// The weight of the next row.
    pub(super) fn next(&mut self) -> f64 {
        f64::from(self.0.next()) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}
