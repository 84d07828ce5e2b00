//! Paths. In: places in the drawing. Out: the letters of an SVG path, with one decimal place: a tenth of a pixel is enough,
//! and pages stay small.

use std::fmt::Write as _;

use super::look::Mark;

/// A number with one decimal place at most.
fn short(value: f64) -> String {
    let rounded = if value.is_finite() { (value * 10.0).round() / 10.0 } else { 0.0 };
    if rounded == 0.0 { "0".to_owned() } else { format!("{rounded}") }
}

/// A line through places; what is missing is a gap. A point that stands alone is drawn as a dot.
pub(super) fn line(places: impl Iterator<Item = Option<(f64, f64)>>) -> String {
    let mut path = String::new();
    let mut on = 0;
    for place in places {
        match place {
            Some((x, y)) => {
                let letter = if on == 0 { 'M' } else { 'L' };
                let _ = write!(path, "{letter}{} {}", short(x), short(y));
                on += 1;
            }
            None => {
                end(&mut path, on);
                on = 0;
            }
        }
    }
    end(&mut path, on);
    path
}

fn end(path: &mut String, points: usize) {
    if points == 1 {
        path.push_str("h0");
    }
}

/// A mark at each place.
pub(super) fn marks(mark: Mark, places: impl Iterator<Item = (f64, f64)>) -> String {
    let mut path = String::new();
    for (x, y) in places {
        let (left, up, stroke) = mark.stroke();
        let _ = write!(path, "M{} {}{stroke}", short(x + left), short(y + up));
    }
    path
}

#[cfg(test)]
mod tests {
    use super::{line, marks};
    use crate::plot::look::Mark;

    #[test]
    fn a_gap_lifts_the_pen_and_a_lone_point_is_seen() {
        let places = [Some((0.0, 1.0)), Some((2.04, 3.0)), None, Some((5.0, 5.0)), None];
        assert_eq!(line(places.into_iter()), "M0 1L2 3M5 5h0");
    }

    #[test]
    fn nothing_that_is_not_finite_is_written() {
        let hostile = [Some((f64::NAN, f64::INFINITY))];
        assert_eq!(line(hostile.into_iter()), "M0 0h0");
        assert!(!marks(Mark::Cross, [(f64::NAN, 1e300)].into_iter()).contains("NaN"));
    }
}
