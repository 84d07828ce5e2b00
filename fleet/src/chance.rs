//! Chance, for tests. In: a seed, or how often something may happen. Out: numbers of a normal distribution; and how often chance lets it
//! happen.

/// Numbers of a normal distribution: twelve of a linear congruential generator together are near enough to one.
pub(crate) fn normals(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(state >> 33).unwrap()) / f64::from(1_u32 << 31)
    };
    (0..count).map(|_| (0..12).map(|_| next()).sum::<f64>() - 6.0).collect()
}

/// The range of counts that chance gives for an event of this probability in `cases` independent cases. A count below the range has a
/// probability of 0.001, and so has one above it. The binomial distribution is summed term by term.
pub(crate) fn bounds(cases: u32, probability: f64) -> (usize, usize) {
    let odds = probability / (1.0 - probability);
    let mut log = f64::from(cases) * (1.0 - probability).ln();
    let (mut sum, mut least, mut most) = (0.0, None, None);
    for count in 0..=cases {
        sum += log.exp();
        if sum > 1e-3 {
            least.get_or_insert(count);
        }
        if sum >= 1.0 - 1e-3 {
            most.get_or_insert(count);
        }
        log += (odds * f64::from(cases - count) / f64::from(count + 1)).ln();
    }
    (least.unwrap() as usize, most.unwrap_or(cases) as usize)
}

#[test]
fn a_coin_falls_on_either_side() {
    // 2^-10 is below 1e-3 and 11 of 2^10 are above.
    assert_eq!(bounds(10, 0.5), (1, 9));
    let drawn = normals(1, 10_000);
    let (mean, square) =
        drawn.iter().fold((0.0, 0.0), |sum, one| (sum.0 + one / 1e4, sum.1 + one * one / 1e4));
    assert!(mean.abs() < 0.04 && (square - 1.0).abs() < 0.05, "{mean} {square}");
}
