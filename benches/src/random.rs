//! Numbers that look random and are the same in every run. In: a seed. Out: numbers from 0 to 1.

/// A SplitMix64 generator.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// A number from 0 (inclusive) to 1 (exclusive).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
        // The upper 53 bits, as many as a double holds.
        (mixed >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number from `-size` to `size`.
    pub(crate) fn around(&mut self, size: f64) -> f64 {
        (2.0 * self.unit() - 1.0) * size
    }
}
