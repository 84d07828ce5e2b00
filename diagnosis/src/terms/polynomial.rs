//! `polynomial`: a smooth error along an axis (scale, straightness, pitch), or a component against temperature.
//!
//! In: positions or temperatures. Out: the powers of x = (q - center) / scale, which are far less alike than those of q;
//! [`raw`] turns coefficients of x into those of q.

/// Fills the powers of x from `first` on.
pub(crate) fn fill(inputs: &[f64], center: f64, scale: f64, first: usize, out: &mut [Vec<f64>]) {
    out.iter_mut().for_each(Vec::clear);
    for input in inputs {
        let x = (input - center) / scale;
        let mut power = if first == 0 { 1.0 } else { x };
        for column in out.iter_mut() {
            column.push(power);
            power *= x;
        }
    }
}

/// The matrix that turns coefficients of x, from power 0 on, into coefficients of q, from power 0 on.
pub(crate) fn raw(degree: usize, center: f64, scale: f64) -> Vec<Vec<f64>> {
    // x^k = sum over m of binomial(k, m) q^m (-center)^(k-m) / scale^k
    let mut matrix = vec![vec![0.0; degree + 1]; degree + 1];
    for k in 0..=degree {
        let mut binomial = 1.0;
        for m in 0..=k {
            let powers = (-center).powi(small(k - m)) / scale.powi(small(k));
            matrix[m][k] = binomial * powers;
            binomial *= fraction(k - m, m + 1);
        }
    }
    matrix
}

fn small(number: usize) -> i32 {
    i32::try_from(number).unwrap_or(i32::MAX)
}

fn fraction(over: usize, under: usize) -> f64 {
    f64::from(small(over)) / f64::from(small(under))
}
