//! Thinning. In: more values than can be drawn. Out: the rows to draw: of each stretch the least and the greatest value, so
//! that no peak and no spike is lost.

/// The rows to draw of a column, in order: all where there are at most `most`, else the rows of the least and the greatest
/// finite value of each of `most / 2` stretches of equal length. Rows without a value are dropped but for one of each gap
/// that a line must show.
pub fn extremes(values: &[f64], most: usize) -> Vec<usize> {
    if values.len() <= most {
        return (0..values.len()).collect();
    }
    let stretches = (most / 2).max(1);
    let mut rows = Vec::with_capacity(most);
    for stretch in 0..stretches {
        let (from, to) = (values.len() * stretch / stretches, values.len() * (stretch + 1) / stretches);
        let known = || (from..to).filter(|row| values[*row].is_finite());
        let least = known().min_by(|a, b| values[*a].total_cmp(&values[*b]));
        let greatest = known().max_by(|a, b| values[*a].total_cmp(&values[*b]));
        match (least, greatest) {
            (Some(a), Some(b)) if a != b => rows.extend([a.min(b), a.max(b)]),
            (Some(a), _) => rows.push(a),
            _ => rows.extend((from < to).then_some(from)),
        }
    }
    rows
}

/// The rows to draw of a column as marks, in order: most of them spread evenly but not at equal steps, which would hide what
/// repeats in step with them; the others are [`extremes`]. So dense stretches look as they are, and no spike is lost.
pub fn spread(values: &[f64], most: usize) -> Vec<usize> {
    if values.len() <= most {
        return (0..values.len()).collect();
    }
    let peaks = most / 6;
    let even = most - peaks;
    let mut rows = extremes(values, peaks);
    // Within each stretch the place moves on by the golden ratio.
    let (mut place, golden) = (0usize, 618_034usize);
    for stretch in 0..even {
        let (from, to) = (values.len() * stretch / even, values.len() * (stretch + 1) / even);
        place = (place + golden) % 1_000_000;
        rows.push(from + (to - from) * place / 1_000_000);
    }
    rows.sort_unstable();
    rows.dedup();
    rows
}

/// What to tell of it: "1998 of 24 841 samples shown"; nothing where all are.
pub fn told(shown: usize, of: usize) -> Option<String> {
    (shown < of).then(|| format!("{} of {} samples shown", grouped(shown), grouped(of)))
}

/// A count with a narrow space between thousands.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{extremes, spread, told};

    #[test]
    fn no_spike_is_lost() {
        let mut values: Vec<f64> = (0..100_000).map(|row| f64::from(row % 7)).collect();
        values[77_777] = -50.0;
        values[12_345] = 80.0;
        values[500] = f64::NAN;
        let rows = extremes(&values, 2000);
        assert!(rows.len() <= 2000 && rows.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(rows.contains(&77_777) && rows.contains(&12_345));
        assert_eq!(extremes(&values[..100], 2000).len(), 100);
    }

    #[test]
    fn what_is_spread_keeps_the_form_and_the_spike() {
        // A wave of 10 rows: rows at equal steps would all have one phase.
        let mut values: Vec<f64> = (0..20_000).map(|row| f64::from(row % 10)).collect();
        values[7_007] = 99.0;
        let rows = spread(&values, 2000);
        assert!(rows.len() <= 2000 && rows.windows(2).all(|pair| pair[0] < pair[1]) && rows.contains(&7_007));
        for phase in 0..10 {
            let share = rows.iter().filter(|row| **row % 10 == phase).count();
            assert!((100..=400).contains(&share), "{phase}: {share} of {}", rows.len());
        }
    }

    #[test]
    fn a_long_gap_stays_a_gap() {
        let mut values = vec![1.0; 1000];
        values[400..600].fill(f64::NAN);
        let rows = extremes(&values, 100);
        assert!(rows.iter().any(|row| values[*row].is_nan()));
        assert_eq!(extremes(&[], 10), Vec::<usize>::new());
    }

    #[test]
    fn what_was_left_out_is_told() {
        assert_eq!(told(1998, 24_841).as_deref(), Some("1998 of 24\u{202f}841 samples shown"));
        assert_eq!(told(12, 12), None);
    }
}
