//! Columns of numbers. In: one number a row, NaN where there is none. Out: their gaps filled, their lines taken away, their
//! sizes.

/// Two columns that are closer to one line are one column.
const ALIKE: f64 = 0.9;

/// One less the other, row by row.
pub fn difference(left: &[f64], right: &[f64]) -> Vec<f64> {
    left.iter().zip(right).map(|(left, right)| left - right).collect()
}

/// Gaps take the value before them; those in the beginning the first value there is.
pub fn filled(values: &[f64]) -> Vec<f64> {
    let mut last = values.iter().copied().find(|value| value.is_finite()).unwrap_or(0.0);
    let next = |value: &f64| {
        last = if value.is_finite() { *value } else { last };
        last
    };
    values.iter().map(next).collect()
}

/// Values less their line over `along`; NaN stays.
pub fn straightened(values: &[f64], along: &[f64]) -> Vec<f64> {
    let rows: Vec<(f64, f64)> =
        along.iter().zip(values).filter(|(_, y)| y.is_finite()).map(|(x, y)| (*x, *y)).collect();
    let count = rows.len().max(1) as f64;
    let (x0, y0) = (
        rows.iter().map(|row| row.0).sum::<f64>() / count,
        rows.iter().map(|row| row.1).sum::<f64>() / count,
    );
    let square: f64 = rows.iter().map(|(x, _)| (x - x0).powi(2)).sum();
    let product: f64 = rows.iter().map(|(x, y)| (x - x0) * (y - y0)).sum();
    let slope = if square > 0.0 { product / square } else { 0.0 };
    along.iter().zip(values).map(|(x, y)| y - y0 - slope * (x - x0)).collect()
}

/// The root mean square of what is there.
pub fn rms(values: &[f64]) -> f64 {
    let there = values.iter().filter(|value| value.is_finite());
    let (sum, count) = there.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    f64::sqrt(sum / f64::max(count, 1.0))
}

/// The middle one by size; zero of nothing.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

/// Whether two columns are nearly on one line.
pub fn alike(left: &[f64], right: &[f64]) -> bool {
    correlation(left, right).abs() > ALIKE
}

/// The correlation of two columns: 1 or -1 on one line, 0 where neither tells of the other.
pub fn correlation(left: &[f64], right: &[f64]) -> f64 {
    let flat = vec![0.0; left.len()];
    let (left, right) = (straightened(left, &flat), straightened(right, &flat));
    let product: f64 = left.iter().zip(&right).map(|(left, right)| left * right).sum();
    product / (rms(&left) * rms(&right) * left.len() as f64).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_on_a_line_are_alike_and_a_bow_is_not() {
        let along: Vec<f64> = (0..50).map(f64::from).collect();
        let line: Vec<f64> = along.iter().map(|x| 3.0 - 2.0 * x).collect();
        let bow: Vec<f64> = along.iter().map(|x| (x - 24.5).powi(2)).collect();
        assert!(alike(&along, &line) && !alike(&along, &bow));
    }

    #[test]
    fn a_gap_takes_the_value_before_it() {
        assert_eq!(filled(&[f64::NAN, 2.0, f64::NAN, 3.0]), [2.0, 2.0, 2.0, 3.0]);
    }

    #[test]
    fn a_line_leaves_nothing_and_gaps_do_not_count() {
        let along = [0.0, 1.0, 2.0, 3.0];
        assert!(rms(&straightened(&[1.0, f64::NAN, 5.0, 7.0], &along)) < 1e-12);
    }
}
