//! Circles. In: what a ballbar, or an instrument with two directions, showed of a path around a nominal circle. Out: radial
//! deviations by angle, as measured, as the known calibration gives them, and with the findings.

use pages::plot::thin::extremes;

use super::channel::Sight;
use super::{Circle, Pass};
use crate::channel::{ChannelAt, Kind};
use crate::course::Course;
use crate::observations;
use crate::scene::Scene;

/// How many points are drawn of a pass, and how many passes of each sense at most: the first and the last.
const POINTS: usize = 500;
const PASSES: usize = 2;
/// How far from the circle, as a share of its radius, the path may lie; and how much of it may lie farther.
const ROUND: f64 = 2e-3;
const OFF: f64 = 0.3;
/// The least arc of a pass, rad, and its fewest points.
const ARC: f64 = 0.5;
const FEWEST: usize = 12;

/// The circle of a recording; nothing where its path is none.
pub(super) fn draw(sight: &Sight<'_>, before: &[Vec<f64>], after: &[Vec<f64>]) -> Option<Circle> {
    let study = sight.study;
    let scene = &study.scenes[sight.scene];
    let seen = Seen::of(scene)?;
    let programmed: Vec<&[f64]> = scene.given.programmed.iter().map(|position| &**position).collect();
    let path = scene.built.interpreter.nominal_columns(&programmed);
    let plane = seen.plane(&path);
    let (center, radius) = seen.geometry(&path, plane)?;
    let spoke = |row: usize| [path[plane[0]][row] - center[0], path[plane[1]][row] - center[1]];
    let on = |row: usize| {
        let [x, y] = spoke(row);
        (x.hypot(y) / radius - 1.0).abs() < ROUND
    };
    let rows = scene.rows();
    let away = crate::number((0..rows).filter(|row| !on(*row)).count());
    if away > OFF * crate::number(rows) {
        return None;
    }
    // What the known calibration predicts, without any setting of the instrument.
    let none = sight.model.with_effects([]);
    let plain = observations::residuals(study, sight.scene, &none, &Course::new(study, sight.scene, &none));
    let radial = |row: usize, of: &dyn Fn(usize) -> f64| match &seen {
        Seen::Bar { channel, .. } => of(*channel),
        Seen::Tip(channels) => {
            let [x, y] = spoke(row);
            let part = |direction: usize| {
                channels.iter().find(|(_, d)| *d == direction).map(|(channel, _)| of(*channel))
            };
            match (part(plane[0]), part(plane[1])) {
                (Some(along), Some(across)) => (along * x + across * y) / x.hypot(y),
                _ => f64::NAN,
            }
        }
    };
    let reference = |channel: usize, row: usize| match scene.channels[channel].kind {
        Kind::Tip(direction) => path[direction][row],
        _ => 0.0,
    };
    let known = |row: usize| {
        radial(row, &|channel| {
            scene.channels[channel].values[row] - plain[channel][row] - reference(channel, row)
        })
    };
    let left = |row: usize, residuals: &[Vec<f64>]| radial(row, &|channel| residuals[channel][row]);
    let left_out = |channel: &usize, row: usize| {
        sight.outliers.of(ChannelAt { scene: sight.scene, channel: *channel })[row]
    };
    let outlier = |row: usize| seen.channels().iter().any(|channel| left_out(channel, row));
    let point = |row: usize| {
        let [x, y] = spoke(row);
        let known = known(row);
        let measured = known + left(row, before);
        [y.atan2(x), measured, known, measured - left(row, after)]
    };
    let passes = passes(scene, &|row| on(row).then(|| spoke(row)));
    let of = passes.len();
    let fitted = scene.fitted_rows();
    let chosen = chosen(passes).into_iter().map(|(rows, against_the_clock)| {
        let all: Vec<[f64; 4]> = rows.iter().filter(|row| !outlier(**row)).map(|row| point(*row)).collect();
        let measured: Vec<f64> = all.iter().map(|point| point[1]).collect();
        Pass {
            run: rows.first().map_or(0, |row| scene.recording.run[*row]),
            against_the_clock,
            held_out: rows.iter().all(|row| !fitted[*row]),
            points: extremes(&measured, POINTS).into_iter().map(|row| all[row]).collect(),
        }
    });
    let chosen: Vec<Pass> = chosen.collect();
    let name = |direction: usize| format!("+{}", ["X", "Y", "Z"][direction]);
    let directions = [name(plane[0]), name(plane[1])];
    (!chosen.is_empty()).then_some(Circle { radius, directions, passes: chosen, of })
}

/// How a circle is seen.
enum Seen {
    Bar {
        channel: usize,
        center: [f64; 3],
        radius: f64,
    },
    /// Channels with their directions.
    Tip(Vec<(usize, usize)>),
}

impl Seen {
    fn of(scene: &Scene<'_>) -> Option<Self> {
        let mut tips = Vec::new();
        for (channel, known) in scene.channels.iter().enumerate() {
            match known.kind {
                Kind::Radius { center, radius } => return Some(Self::Bar { channel, center, radius }),
                Kind::Tip(direction) => tips.push((channel, direction)),
                _ => {}
            }
        }
        (tips.len() >= 2).then_some(Self::Tip(tips))
    }

    fn channels(&self) -> Vec<usize> {
        match self {
            Self::Bar { channel, .. } => vec![*channel],
            Self::Tip(channels) => channels.iter().map(|(channel, _)| *channel).collect(),
        }
    }

    /// The two directions in which the path spreads most, in the order in which they turn right-handed.
    fn plane(&self, path: &[Vec<f64>; 3]) -> [usize; 2] {
        let spread = |direction: usize| {
            let finite = path[direction].iter().filter(|place| place.is_finite());
            let (low, high) =
                finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(*q), high.max(*q)));
            (high - low).max(0.0)
        };
        match (0..3).min_by(|a, b| spread(*a).total_cmp(&spread(*b))) {
            Some(0) => [1, 2],
            Some(1) => [2, 0],
            _ => [0, 1],
        }
    }

    /// Centre in the plane, and radius.
    fn geometry(&self, path: &[Vec<f64>; 3], plane: [usize; 2]) -> Option<([f64; 2], f64)> {
        match self {
            Self::Bar { center, radius, .. } => Some((plane.map(|direction| center[direction]), *radius)),
            Self::Tip(_) => {
                let places = path[plane[0]].iter().zip(&path[plane[1]]);
                let places: Vec<[f64; 2]> = places
                    .map(|(x, y)| [*x, *y])
                    .filter(|place| place.iter().all(|part| part.is_finite()))
                    .collect();
                around(places)
            }
        }
    }
}

/// The circle through most of the places: fitted, and fitted again to those near it.
fn around(mut places: Vec<[f64; 2]>) -> Option<([f64; 2], f64)> {
    let mut found = None;
    for _ in 0..4 {
        if places.len() < 3 * FEWEST {
            return None;
        }
        let (center, radius) = least_squares(&places)?;
        found = Some((center, radius));
        places.retain(|[x, y]| ((x - center[0]).hypot(y - center[1]) / radius - 1.0).abs() < 0.05);
    }
    found
}

/// x^2 + y^2 = 2 a x + 2 b y + c, by least squares about the mean place.
fn least_squares(places: &[[f64; 2]]) -> Option<([f64; 2], f64)> {
    let count = crate::number(places.len());
    let middle = [0, 1].map(|part| places.iter().map(|place| place[part]).sum::<f64>() / count);
    let rows = places.iter().map(|place| [place[0] - middle[0], place[1] - middle[1]]);
    let mut matrix = nalgebra::Matrix3::zeros();
    let mut right = nalgebra::Vector3::zeros();
    for [x, y] in rows {
        let row = nalgebra::Vector3::new(2.0 * x, 2.0 * y, 1.0);
        matrix += row * row.transpose();
        right += row * (x * x + y * y);
    }
    let solved = matrix.try_inverse()? * right;
    let radius = (solved[2] + solved[0] * solved[0] + solved[1] * solved[1]).sqrt();
    let known = radius.is_finite() && radius > 0.0;
    known.then_some(([middle[0] + solved[0], middle[1] + solved[1]], radius))
}

/// Rows that go round in one sense, run by run, with whether it is against the clock.
fn passes(scene: &Scene<'_>, spoke: &dyn Fn(usize) -> Option<[f64; 2]>) -> Vec<(Vec<usize>, bool)> {
    let mut passes: Vec<(Vec<usize>, bool)> = Vec::new();
    let mut last: Option<(usize, [f64; 2])> = None;
    for row in 0..scene.rows() {
        let here = spoke(row);
        let run = |other: usize| scene.recording.run[other];
        let (Some(here), Some((from, there))) = (here, last.filter(|(from, _)| run(*from) == run(row)))
        else {
            last = here.map(|here| (row, here));
            continue;
        };
        let turned = turned(there, here);
        if turned.abs() < STANDS {
            continue;
        }
        last = Some((row, here));
        match passes.last_mut() {
            Some((rows, against)) if rows.last() == Some(&from) && *against == (turned > 0.0) => {
                rows.push(row)
            }
            _ => passes.push((vec![from, row], turned > 0.0)),
        }
    }
    let arc = |rows: &[usize]| -> f64 {
        let pairs = rows.windows(2).filter_map(|pair| Some((spoke(pair[0])?, spoke(pair[1])?)));
        pairs.map(|(there, here)| turned(there, here).abs()).sum()
    };
    passes.retain(|(rows, _)| rows.len() >= FEWEST && arc(rows) >= ARC);
    passes
}

/// A smaller angle between rows is none, rad.
const STANDS: f64 = 1e-9;

/// The angle from one spoke to another, less than half a turn.
fn turned(there: [f64; 2], here: [f64; 2]) -> f64 {
    (there[0] * here[1] - there[1] * here[0]).atan2(there[0] * here[0] + there[1] * here[1])
}

/// The first and the last pass of each sense, in order.
fn chosen(passes: Vec<(Vec<usize>, bool)>) -> Vec<(Vec<usize>, bool)> {
    let mut chosen = Vec::new();
    for sense in [true, false] {
        let mut of: Vec<_> = passes.iter().filter(|(_, against)| *against == sense).cloned().collect();
        if of.len() > PASSES {
            of.drain(1..of.len() - 1);
        }
        chosen.extend(of);
    }
    chosen
}
