//! Legs: the pieces of a path between two corners, and how one goes along them.

/// One piece of a path.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Leg {
    /// From one point straight to another.
    Straight { from: Vec<f64>, to: Vec<f64>, length: f64 },
    /// Around the centre, which is `base` in the plane; a spiral where the radii differ.
    Arc { base: Vec<f64>, plane: [usize; 2], radii: [f64; 2], angles: [f64; 2] },
    /// At rest, with so many readings, the last of them at the end; with none it is read like a motion.
    Rest { at: Vec<f64>, time: f64, readings: u32 },
}

/// How one goes along: the speed, and the acceleration where it is not endless.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    pub(super) feed: f64,
    pub(super) acceleration: Option<f64>,
}

impl Leg {
    /// The way along the leg: mm, or rad where only rotary axes move.
    pub(super) fn length(&self) -> f64 {
        match self {
            Self::Straight { length, .. } => *length,
            Self::Arc { radii, angles, .. } => {
                let [[inner, outer], [from, to]] = [*radii, *angles];
                0.5 * (inner + outer) * (to - from).abs()
            }
            Self::Rest { .. } => 0.0,
        }
    }

    /// How long it takes, s.
    pub(super) fn duration(&self, pace: Pace) -> f64 {
        match self {
            Self::Rest { time, .. } => *time,
            _ => pace.duration(self.length()),
        }
    }

    /// Writes down where the axes are after a time on the leg.
    pub(super) fn position(&self, time: f64, pace: Pace, out: &mut [f64]) {
        let length = self.length();
        let share = if length > 0.0 { (pace.way(time, length) / length).clamp(0.0, 1.0) } else { 1.0 };
        match self {
            Self::Straight { from, to, .. } => {
                for ((out, from), to) in out.iter_mut().zip(from).zip(to) {
                    // The ends are met exactly, and what does not move keeps its number.
                    *out = if share < 1.0 { from + (to - from) * share } else { *to };
                }
            }
            Self::Arc { base, plane, radii, angles } => {
                out.iter_mut().zip(base).for_each(|(out, base)| *out = *base);
                let turned = turned(*radii, share);
                let [[inner, outer], [from, to]] = [*radii, *angles];
                let radius = inner + (outer - inner) * turned;
                let angle = from + (to - from) * turned;
                for (axis, away) in plane.iter().zip([angle.cos(), angle.sin()]) {
                    if let Some(out) = out.get_mut(*axis) {
                        *out += radius * away;
                    }
                }
            }
            Self::Rest { at, .. } => out.iter_mut().zip(at).for_each(|(out, at)| *out = *at),
        }
    }
}

/// The share of the angle at a share of the way: the radius grows evenly with the angle, the way with the radius.
fn turned([inner, outer]: [f64; 2], share: f64) -> f64 {
    let growth = outer - inner;
    if growth.abs() <= 1e-12 * (inner.abs() + outer.abs()) {
        return share;
    }
    ((inner * inner + share * (outer * outer - inner * inner)).max(0.0).sqrt() - inner) / growth
}

impl Pace {
    fn duration(self, length: f64) -> f64 {
        match self.acceleration {
            None => length / self.feed,
            Some(rise) if length >= self.feed * self.feed / rise => length / self.feed + self.feed / rise,
            Some(rise) => 2.0 * (length / rise).sqrt(),
        }
    }

    /// The way after a time on a leg of some length.
    fn way(self, time: f64, length: f64) -> f64 {
        let Some(rise) = self.acceleration else { return self.feed * time };
        let whole = self.duration(length);
        let top = self.feed.min((length * rise).sqrt());
        let ramp = top / rise;
        let left = (whole - time).max(0.0);
        if time < ramp {
            0.5 * rise * time * time
        } else if left < ramp {
            length - 0.5 * rise * left * left
        } else {
            top * (time - 0.5 * ramp)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trapezoids_and_triangles_end_where_they_must() {
        for length in [0.3, 4.0, 100.0] {
            let pace = Pace { feed: 10.0, acceleration: Some(25.0) };
            let leg = Leg::Straight { from: vec![0.0], to: vec![length], length };
            let whole = leg.duration(pace);
            let at = |time: f64| {
                let mut out = [f64::NAN];
                leg.position(time, pace, &mut out);
                out[0]
            };
            assert_eq!((at(0.0), at(whole)), (0.0, length));
            assert!((at(0.5 * whole) - 0.5 * length).abs() < 1e-12);
            // The speed nowhere exceeds the feed, the acceleration nowhere its bound.
            let h = whole / 1000.0;
            for number in 1..1000 {
                let time = f64::from(number) * h;
                let speed = (at(time + h) - at(time - h)) / (2.0 * h);
                let rise = (at(time + h) - 2.0 * at(time) + at(time - h)) / (h * h);
                assert!(speed <= 10.0 + 1e-6 && rise.abs() <= 25.0 + 1e-5, "{length} {time} {speed} {rise}");
            }
        }
    }

    #[test]
    fn a_spiral_keeps_its_feed() {
        let pace = Pace { feed: 5.0, acceleration: None };
        let leg = Leg::Arc { base: vec![0.0; 2], plane: [0, 1], radii: [10.0, 60.0], angles: [0.0, 25.0] };
        let mut before = [10.0, 0.0];
        let whole = leg.duration(pace);
        for number in 1..=2000 {
            let mut now = [0.0; 2];
            leg.position(whole * f64::from(number) / 2000.0, pace, &mut now);
            let speed = (now[0] - before[0]).hypot(now[1] - before[1]) / (whole / 2000.0);
            assert!((speed / 5.0 - 1.0).abs() < 0.03, "{speed}");
            before = now;
        }
        assert!((before[0].hypot(before[1]) - 60.0).abs() < 1e-9);
    }
}
