//! Circles through points: least squares, and the minimum zone.
//!
//! In: points of a path that is nearly a circle. Out: the circle whose radial distances have the least sum of squares, or the
//! centre about which two concentric circles hold all points at the least distance from each other.

/// A point in the plane, mm.
pub type Place = [f64; 2];

/// The least-squares circle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Round {
    /// Its centre.
    pub center: Place,
    /// Its radius.
    pub radius: f64,
}

/// The minimum zone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Zone {
    /// The common centre of the two circles.
    pub center: Place,
    /// The difference of their radii.
    pub width: f64,
    /// No centre has a width below this: how well the search ended.
    pub at_least: f64,
}

/// Steps towards the least-squares circle; each squares what is left.
const STEPS: usize = 30;

/// Steps of the search for the minimum zone: each takes 23 % off the area in which its centre may lie.
const CUTS: usize = 400;

/// The search ends when the width is known to this share of itself.
const NEAR: f64 = 1e-7;

/// The circle with the least sum of squared radial distances; none where the points make none.
pub fn least_squares(points: &[Place]) -> Option<Round> {
    let mut round = algebraic(points)?;
    for _ in 0..STEPS {
        // Radial distance from the circle: its change by the centre is -u, by the radius -1.
        let mut normal = Normal::default();
        for point in points {
            let (distance, [across, up]) = from(round.center, *point);
            normal.add([across, up, 1.0], distance - round.radius);
        }
        let [across, up, wider] = normal.solve()?;
        let [x, y] = round.center;
        round = Round { center: [x + across, y + up], radius: round.radius + wider };
        if across.abs().max(up.abs()).max(wider.abs()) <= 1e-14 * round.radius {
            break;
        }
    }
    let Round { center: [x, y], radius } = round;
    (x.is_finite() && y.is_finite() && radius.is_finite()).then_some(round)
}

/// The circle by x^2 + y^2 = 2 a x + 2 b y + c, about the mean point: where the steps begin.
fn algebraic(points: &[Place]) -> Option<Round> {
    if points.len() < 3 {
        return None;
    }
    let count = crate::number(points.len());
    let mean = |part: usize| {
        points.iter().map(|point| point.get(part).copied().unwrap_or(f64::NAN)).sum::<f64>() / count
    };
    let [x, y] = [mean(0), mean(1)];
    let mut normal = Normal::default();
    for [own, other] in points {
        let (own, other) = (own - x, other - y);
        normal.add([2.0 * own, 2.0 * other, 1.0], own * own + other * other);
    }
    let [across, up, rest] = normal.solve()?;
    let radius = (rest + across * across + up * up).sqrt();
    (radius > 0.0).then_some(Round { center: [x + across, y + up], radius })
}

/// The two concentric circles that hold all points at the least distance from each other.
///
/// The points must go all around `start`, no gap wider than 90 degrees: the width falls towards its least value from everywhere
/// then, and the ellipsoid method cannot miss it. `at_least` bounds it from below; it leaves out the square of the shift
/// over the radius, below a nanometre where the start is the least-squares centre.
pub fn minimum_zone(points: &[Place], start: Place) -> Zone {
    let Some(first) = cut(points, start) else { return Zone { center: start, ..Zone::default() } };
    let mut best = Zone { center: start, width: first.width, at_least: 0.0 };
    // Shifted by more than its width, the zone is wider on the far side, gaps included.
    let reach = 3.0 * first.width;
    let mut ellipse = [reach * reach, 0.0, reach * reach];
    let mut center = start;
    for _ in 0..CUTS {
        let Some(cut) = cut(points, center) else { break };
        let [xx, xy, yy] = ellipse;
        let [gx, gy] = cut.slope;
        let along = [xx * gx + xy * gy, xy * gx + yy * gy];
        let size = (along[0] * gx + along[1] * gy).max(0.0).sqrt();
        if cut.width < best.width {
            (best.width, best.center) = (cut.width, center);
        }
        best.at_least = best.at_least.max(cut.width - size);
        if size <= 0.0 || best.width - best.at_least <= NEAR * best.width {
            break;
        }
        let [sx, sy] = along.map(|part| part / size);
        center = [center[0] - sx / 3.0, center[1] - sy / 3.0];
        let shrunk = |own: f64, taken: f64| 4.0 / 3.0 * (own - 2.0 / 3.0 * taken);
        ellipse = [shrunk(xx, sx * sx), shrunk(xy, sx * sy), shrunk(yy, sy * sy)];
    }
    best
}

/// The width of the zone about a centre, and how it changes with the centre.
struct Cut {
    width: f64,
    slope: Place,
}

fn cut(points: &[Place], center: Place) -> Option<Cut> {
    let mut ends: Option<[(f64, Place); 2]> = None;
    for point in points {
        let own = from(center, *point);
        ends = Some(match ends {
            None => [own, own],
            Some([near, far]) => {
                [if own.0 < near.0 { own } else { near }, if own.0 > far.0 { own } else { far }]
            }
        });
    }
    let [(near, inner), (far, outer)] = ends?;
    Some(Cut { width: far - near, slope: [inner[0] - outer[0], inner[1] - outer[1]] })
}

/// Distance and direction of a point from a centre.
pub(crate) fn from(center: Place, point: Place) -> (f64, Place) {
    let [x, y] = [point[0] - center[0], point[1] - center[1]];
    let distance = x.hypot(y);
    (distance, if distance > 0.0 { [x / distance, y / distance] } else { [0.0; 2] })
}

/// Normal equations of three unknowns.
#[derive(Default)]
struct Normal {
    /// Rows of the products, with the right-hand side.
    rows: [[f64; 4]; 3],
}

impl Normal {
    fn add(&mut self, design: [f64; 3], value: f64) {
        for (row, own) in self.rows.iter_mut().zip(design) {
            let columns = design.into_iter().chain([value]);
            for (sum, other) in row.iter_mut().zip(columns) {
                *sum += own * other;
            }
        }
    }

    /// By Cramer's rule; none where the equations do not tell.
    fn solve(&self) -> Option<[f64; 3]> {
        let column = |number: usize| self.rows.map(|row| row.get(number).copied().unwrap_or(f64::NAN));
        let [a, b, c, d] = [column(0), column(1), column(2), column(3)];
        let whole = determinant(a, b, c);
        let size = [a, b, c].map(|column| column.iter().map(|part| part * part).sum::<f64>().sqrt());
        if whole.abs() <= 1e-13 * size.iter().product::<f64>() || !whole.is_finite() {
            return None;
        }
        Some([determinant(d, b, c) / whole, determinant(a, d, c) / whole, determinant(a, b, d) / whole])
    }
}

fn determinant(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    let [a0, a1, a2] = a;
    let [b0, b1, b2] = b;
    let [c0, c1, c2] = c;
    a0 * (b1 * c2 - b2 * c1) - b0 * (a1 * c2 - a2 * c1) + c0 * (a1 * b2 - a2 * b1)
}
