//! The least cost in two dimensions.
//!
//! In: costs of some points at a time, and where to start. Out: the least one, and its point. Whatever a step of the search may
//! ask for is asked for at once: for likelihoods four together take hardly longer than one.

/// How many costs are worked out together.
pub(super) const TOGETHER: usize = 4;

/// The simplex search of Nelder and Mead in two dimensions: the least cost found, and where.
pub(super) fn minimise(
    costs: &impl Fn([[f64; 2]; TOGETHER]) -> [f64; TOGETHER],
    start: [f64; 2],
) -> (f64, [f64; 2]) {
    let near = |points: [[f64; 2]; TOGETHER]| {
        let found = costs(points);
        std::array::from_fn(|number| (found[number], points[number]))
    };
    let corners = [start, [start[0] + 1.0, start[1]], [start[0], start[1] + 1.0], start];
    let [first, second, third, _]: [(f64, [f64; 2]); TOGETHER] = near(corners);
    let mut simplex = [first, second, third];
    let along = |from: [f64; 2], to: [f64; 2], share: f64| {
        [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
    };
    for _ in 0..80 {
        simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [best, middle, worst] = simplex;
        if (worst.0 - best.0).abs() < 1e-3 {
            break;
        }
        let center = along(best.1, middle.1, 0.5);
        let [reflected, further, outside, inside] =
            near([-1.0, -2.0, -0.5, 0.5].map(|share| along(center, worst.1, share)));
        let contracted = if reflected.0 < worst.0 { outside } else { inside };
        simplex[2] = if reflected.0 < best.0 {
            if further.0 < reflected.0 { further } else { reflected }
        } else if reflected.0 < middle.0 {
            reflected
        } else if contracted.0 < worst.0.min(reflected.0) {
            contracted
        } else {
            let halves = [middle.1, worst.1, middle.1, worst.1].map(|far| along(best.1, far, 0.5));
            let [second, third, ..] = near(halves);
            simplex[1] = second;
            third
        };
    }
    simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
    simplex[0]
}
