//! Student's distribution. In: a number of standard errors, and degrees of freedom. Out: how probable one as far from zero is by chance.

/// The probability of a number at least so far from zero, on either side.
pub(crate) fn two_sided(t: f64, freedom: f64) -> f64 {
    if t.is_nan() || freedom.is_nan() || freedom <= 0.0 {
        return 1.0;
    }
    if t.is_infinite() {
        return 0.0;
    }
    beta(freedom / (freedom + t * t), freedom / 2.0, 0.5)
}

/// The number that chance passes with this probability, on either side.
pub(crate) fn quantile(probability: f64, freedom: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while two_sided(high, freedom) > probability && high < FARTHEST {
        high *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if two_sided(middle, freedom) > probability { low = middle } else { high = middle }
    }
    (low + high) / 2.0
}

/// No bound is asked for that one degree of freedom reaches only beyond: its tail falls as 1/t.
const FARTHEST: f64 = 1e15;

/// Halvings until nothing of an interval is left in twelve digits.
const HALVINGS: usize = 100;

/// The regularised incomplete beta function I_x(a, b), by Lentz's way through its continued fraction.
fn beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let front = (log_gamma(a + b) - log_gamma(a) - log_gamma(b) + a * x.ln() + b * (-x).ln_1p()).exp();
    // The fraction converges at once on one side of the middle; the other follows from symmetry.
    if x < (a + 1.0) / (a + b + 2.0) {
        front * fraction(x, a, b) / a
    } else {
        1.0 - front * fraction(1.0 - x, b, a) / b
    }
}

fn fraction(x: f64, a: f64, b: f64) -> f64 {
    let away = |value: f64| if value.abs() < TINY { TINY } else { value };
    let (mut c, mut d) = (1.0, 1.0 / away(1.0 - (a + b) * x / (a + 1.0)));
    let mut sum = d;
    let mut m = 1.0;
    while m < MOST_STEPS {
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / away(1.0 + even * d);
        c = away(1.0 + even / c);
        sum *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / away(1.0 + odd * d);
        c = away(1.0 + odd / c);
        sum *= d * c;
        if (d * c - 1.0).abs() < 1e-14 {
            break;
        }
        m += 1.0;
    }
    sum
}

/// In place of a zero.
const TINY: f64 = 1e-300;

/// More steps than ten thousand degrees of freedom need.
const MOST_STEPS: f64 = 500.0;

/// The logarithm of the gamma function, by Lanczos' approximation (g = 7, nine terms), to 1e-14.
fn log_gamma(x: f64) -> f64 {
    const TERMS: [f64; 8] = [
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let mut sum = 0.999_999_999_999_809_9;
    let mut place = 0.0;
    for term in TERMS {
        sum += term / (x + place);
        place += 1.0;
    }
    let t = x + 6.5;
    (std::f64::consts::TAU.sqrt() * sum).ln() + (x - 0.5) * t.ln() - t
}

#[cfg(test)]
mod tests {
    use super::{quantile, two_sided};

    #[test]
    fn two_degrees_of_freedom_and_one_have_closed_forms() {
        for t in [0.1_f64, 1.0, 3.0, 50.0] {
            let two = 1.0 - t / (2.0 + t * t).sqrt();
            assert!((two_sided(t, 2.0) / two - 1.0).abs() < 1e-9, "{t}");
            let one = 1.0 - 2.0 / std::f64::consts::PI * t.atan();
            assert!((two_sided(-t, 1.0) / one - 1.0).abs() < 1e-9, "{t}");
        }
    }

    #[test]
    fn tables_of_student_s_distribution() {
        // Two-sided 5 %, 1 % and 0.1 % points as printed in tables.
        let printed = [(5.0, 0.05, 2.571), (10.0, 0.01, 3.169), (24.0, 0.001, 3.745), (120.0, 0.05, 1.980)];
        for (freedom, probability, t) in printed {
            assert!((quantile(probability, freedom) - t).abs() < 6e-4, "{freedom}");
        }
        assert!(two_sided(130.0, 24.0) < 1e-34 && two_sided(130.0, 24.0) > 0.0);
        assert!((two_sided(0.0, 7.0) - 1.0).abs() < 1e-12);
        assert_eq!(two_sided(f64::NAN, 7.0), 1.0);
    }
}
