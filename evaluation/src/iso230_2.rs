//! The figures of ISO 230-2, from deviations at targets.
//!
//! In: for each target position the positional deviations (actual minus target) read when it was approached upwards and
//! downwards. Out: figures of each target and of the axis. The clauses are those of the edition of 2006; the definitions stand
//! unchanged in that of 2014, which says *error* for the systematic deviations. The coverage factor is 2.
//!
//! With x_ij the deviation at target i in approach j of n, up and down:
//!
//! | figure | definition | clause |
//! | --- | --- | --- |
//! | mean unidirectional deviation | x_i = (1/n) sum over j of x_ij, up and down | 2.10 |
//! | mean bidirectional deviation | x_i = (x_i up + x_i down) / 2 | 2.11 |
//! | reversal value at a target | B_i = x_i up - x_i down | 2.12 |
//! | reversal value B | greatest absolute B_i | 2.13 |
//! | mean reversal value | (1/m) sum over i of B_i | 2.14 |
//! | estimator of the standard uncertainty | s_i = sqrt(sum over j of (x_ij - x_i)^2 / (n - 1)), up and down | 2.15 |
//! | unidirectional repeatability at a target | R_i up = 4 s_i up; R_i down = 4 s_i down | 2.16 |
//! | bidirectional repeatability at a target | R_i = max(2 s_i up + 2 s_i down + abs(B_i); R_i up; R_i down) | 2.17 |
//! | repeatability R up, R down | greatest R_i up, R_i down | 2.18 |
//! | repeatability R | greatest R_i | 2.19 |
//! | systematic deviation E up, E down | greatest minus least x_i up, x_i down | 2.20 |
//! | systematic deviation E | greatest minus least of all x_i up and x_i down | 2.21 |
//! | mean bidirectional deviation M | greatest minus least x_i | 2.22 |
//! | accuracy A up, A down | greatest x_i + 2 s_i minus least x_i - 2 s_i, up, down | 2.23 |
//! | accuracy A | the same over both directions | 2.24 |
//!
//! The R of an axis is not the greater of R up and R down, and E is not the greater or less of E up and E down: a
//! reversal counts in both.

use crate::figure::{Figure, Given, Rests, Unit};
use crate::number;

/// The readings of one target.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Target {
    /// The target position, mm or rad.
    pub position: f64,
    /// The deviations when it was approached in the positive direction, in order of time.
    pub up: Vec<f64>,
    /// Those when it was approached in the negative direction.
    pub down: Vec<f64>,
}

/// The figures of one target, in mm or rad.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TargetFigures {
    /// The target position.
    pub position: f64,
    /// Approached in the positive direction; none where it never was.
    pub up: Option<Side>,
    /// Approached in the negative direction.
    pub down: Option<Side>,
}

/// The figures of one target in one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Side {
    /// How often it was read.
    pub readings: usize,
    /// The mean deviation (2.10).
    pub mean: f64,
    /// The estimator s of the standard uncertainty (2.15); none from one reading.
    pub s: Option<f64>,
}

impl Side {
    /// The figures of some deviations; none of no deviation.
    pub fn of(deviations: &[f64]) -> Option<Self> {
        let readings = deviations.len();
        if readings == 0 {
            return None;
        }
        let mean = deviations.iter().sum::<f64>() / number(readings);
        let squares: f64 = deviations.iter().map(|deviation| (deviation - mean).powi(2)).sum();
        let s = (readings > 1).then(|| (squares / (number(readings) - 1.0)).sqrt());
        Some(Self { readings, mean, s })
    }

    /// The unidirectional repeatability (2.16).
    pub fn repeatability(self) -> Option<f64> {
        self.s.map(|s| 4.0 * s)
    }
}

impl TargetFigures {
    /// The figures of one target.
    pub fn of(target: &Target) -> Self {
        Self { position: target.position, up: Side::of(&target.up), down: Side::of(&target.down) }
    }

    /// The mean bidirectional deviation (2.11).
    pub fn mean(&self) -> Option<f64> {
        Some(f64::midpoint(self.up?.mean, self.down?.mean))
    }

    /// The reversal value (2.12), with its sign.
    pub fn reversal(&self) -> Option<f64> {
        Some(self.up?.mean - self.down?.mean)
    }

    /// The bidirectional repeatability (2.17).
    pub fn repeatability(&self) -> Option<f64> {
        let (up, down) = (self.up?.s?, self.down?.s?);
        let both = 2.0 * up + 2.0 * down + self.reversal()?.abs();
        Some(both.max(4.0 * up).max(4.0 * down))
    }
}

/// The figures of an axis.
///
/// Where targets were approached from both sides, those alone count, for the unidirectional figures too: places where the
/// motion only turned are no targets. Where there are none, each direction has its own.
pub fn of_axis(targets: &[TargetFigures], unit: Unit) -> Vec<Figure> {
    let axis = Axis::of(targets, unit);
    let mean = |side: &Side| side.mean;
    vec![
        axis.figure(
            "B",
            "reversal value",
            "ISO 230-2:2014 (edition of 2006: 2.13)",
            axis.reversals().map(|all| greatest(all.map(f64::abs))),
        ),
        axis.figure(
            "B_mean",
            "mean reversal value",
            "ISO 230-2:2014 (edition of 2006: 2.14)",
            axis.reversals().map(|all| all.sum::<f64>() / number(axis.both.len())),
        ),
        axis.one_way(
            "R_up",
            "repeatability, upwards",
            "ISO 230-2:2014 (edition of 2006: 2.18)",
            Way::Up,
            |axis, way| axis.repeatabilities(way).map(|all| greatest(all.into_iter())),
        ),
        axis.one_way(
            "R_down",
            "repeatability, downwards",
            "ISO 230-2:2014 (edition of 2006: 2.18)",
            Way::Down,
            |axis, way| axis.repeatabilities(way).map(|all| greatest(all.into_iter())),
        ),
        axis.figure(
            "R",
            "bidirectional repeatability",
            "ISO 230-2:2014 (edition of 2006: 2.19)",
            axis.repeatability(),
        ),
        axis.one_way(
            "E_up",
            "systematic deviation, upwards",
            "ISO 230-2:2014 (edition of 2006: 2.20)",
            Way::Up,
            |axis, way| axis.range(&[way], mean, mean),
        ),
        axis.one_way(
            "E_down",
            "systematic deviation, downwards",
            "ISO 230-2:2014 (edition of 2006: 2.20)",
            Way::Down,
            |axis, way| axis.range(&[way], mean, mean),
        ),
        axis.figure(
            "E",
            "bidirectional systematic deviation",
            "ISO 230-2:2014 (edition of 2006: 2.21)",
            axis.both_ways(mean, mean),
        ),
        axis.figure(
            "M",
            "mean bidirectional deviation",
            "ISO 230-2:2014 (edition of 2006: 2.22)",
            axis.means(),
        ),
        axis.one_way(
            "A_up",
            "accuracy, upwards",
            "ISO 230-2:2014 (edition of 2006: 2.23)",
            Way::Up,
            |axis, way| axis.accuracy(&[way]),
        ),
        axis.one_way(
            "A_down",
            "accuracy, downwards",
            "ISO 230-2:2014 (edition of 2006: 2.23)",
            Way::Down,
            |axis, way| axis.accuracy(&[way]),
        ),
        axis.figure(
            "A",
            "bidirectional accuracy",
            "ISO 230-2:2014 (edition of 2006: 2.24)",
            axis.needs_both().and_then(|()| axis.accuracy(&[Way::Up, Way::Down])),
        ),
    ]
}

/// A direction of approach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Up,
    Down,
}

impl Way {
    fn word(self) -> &'static str {
        match self {
            Self::Up => "upwards",
            Self::Down => "downwards",
        }
    }

    fn side(self, target: &TargetFigures) -> Option<Side> {
        match self {
            Self::Up => target.up,
            Self::Down => target.down,
        }
    }
}

/// The targets that count.
struct Axis<'t> {
    /// Those approached from both sides.
    both: Vec<&'t TargetFigures>,
    /// Those that count for the figures of one direction.
    counted: Vec<&'t TargetFigures>,
    unit: Unit,
}

impl<'t> Axis<'t> {
    fn of(targets: &'t [TargetFigures], unit: Unit) -> Self {
        let both: Vec<&TargetFigures> = targets.iter().filter(|target| target.reversal().is_some()).collect();
        let counted = if both.is_empty() { targets.iter().collect() } else { both.clone() };
        Self { both, counted, unit }
    }

    fn sides(&self, way: Way) -> Vec<(f64, Side)> {
        self.counted.iter().filter_map(|target| Some((target.position, way.side(target)?))).collect()
    }

    fn needs_both(&self) -> Result<(), String> {
        match (self.both.len(), self.sides(Way::Up).is_empty(), self.sides(Way::Down).is_empty()) {
            (0, _, true) => Err("every target was approached only upwards".to_owned()),
            (0, true, _) => Err("every target was approached only downwards".to_owned()),
            (0, _, _) => Err("no target was approached from both sides".to_owned()),
            _ => Ok(()),
        }
    }

    /// Ranges over targets need two of them.
    fn needs_range(&self, sides: usize) -> Result<(), String> {
        if sides < 2 { Err("one target alone has no range".to_owned()) } else { Ok(()) }
    }

    fn sides_of(&self, way: Way) -> Result<Vec<(f64, Side)>, String> {
        let sides = self.sides(way);
        if sides.is_empty() {
            return Err(format!("no target was approached {}", way.word()));
        }
        Ok(sides)
    }

    /// The estimators s of one direction; all of them are needed.
    fn estimators(&self, way: Way) -> Result<Vec<f64>, String> {
        let estimator = |(position, side): (f64, Side)| {
            side.s.ok_or_else(|| {
                format!("the target {} was approached {} only once", self.unit.place(position), way.word())
            })
        };
        self.sides_of(way)?.into_iter().map(estimator).collect()
    }

    fn repeatabilities(&self, way: Way) -> Result<Vec<f64>, String> {
        Ok(self.estimators(way)?.into_iter().map(|s| 4.0 * s).collect())
    }

    fn reversals(&self) -> Result<impl Iterator<Item = f64>, String> {
        self.needs_both()?;
        Ok(self.both.iter().filter_map(|target| target.reversal()))
    }

    fn repeatability(&self) -> Result<f64, String> {
        self.needs_both()?;
        self.estimators(Way::Up)?;
        self.estimators(Way::Down)?;
        Ok(greatest(self.both.iter().filter_map(|target| target.repeatability())))
    }

    /// Greatest of one number minus least of another, over all targets in some directions.
    fn range(
        &self,
        ways: &[Way],
        high: impl Fn(&Side) -> f64,
        low: impl Fn(&Side) -> f64,
    ) -> Result<f64, String> {
        let mut sides = Vec::new();
        for way in ways {
            let of_way = self.sides_of(*way)?;
            self.needs_range(of_way.len())?;
            sides.extend(of_way);
        }
        let high = greatest(sides.iter().map(|(_, side)| high(side)));
        Ok(high - least(sides.iter().map(|(_, side)| low(side))))
    }

    fn both_ways(&self, high: impl Fn(&Side) -> f64, low: impl Fn(&Side) -> f64) -> Result<f64, String> {
        self.needs_both()?;
        self.range(&[Way::Up, Way::Down], high, low)
    }

    fn means(&self) -> Result<f64, String> {
        self.needs_both()?;
        self.needs_range(self.both.len())?;
        let means = || self.both.iter().filter_map(|target| target.mean());
        Ok(greatest(means()) - least(means()))
    }

    fn accuracy(&self, ways: &[Way]) -> Result<f64, String> {
        for way in ways {
            self.estimators(*way)?;
        }
        let twice = |side: &Side| 2.0 * side.s.unwrap_or(f64::NAN);
        self.range(ways, |side| side.mean + twice(side), |side| side.mean - twice(side))
    }

    fn one_way(
        &self,
        symbol: &'static str,
        name: &'static str,
        source: &'static str,
        way: Way,
        value: impl Fn(&Self, Way) -> Result<f64, String>,
    ) -> Figure {
        let rests = self.rests(&self.sides(way));
        self.built(symbol, name, source, value(self, way), rests)
    }

    /// A figure of both directions.
    fn figure(
        &self,
        symbol: &'static str,
        name: &'static str,
        source: &'static str,
        value: Result<f64, String>,
    ) -> Figure {
        let sides: Vec<(f64, Side)> = self
            .both
            .iter()
            .flat_map(|target| {
                [target.up, target.down].into_iter().flatten().map(|side| (target.position, side))
            })
            .collect();
        let rests = Rests { targets: Some(self.both.len()), ..self.rests(&sides) };
        self.built(symbol, name, source, value, rests)
    }

    fn rests(&self, sides: &[(f64, Side)]) -> Rests {
        let readings = || sides.iter().map(|(_, side)| side.readings);
        Rests {
            targets: Some(sides.len()),
            readings: readings().sum(),
            runs: [readings().min().unwrap_or(0), readings().max().unwrap_or(0)],
        }
    }

    fn built(
        &self,
        symbol: &'static str,
        name: &'static str,
        source: &'static str,
        value: Result<f64, String>,
        rests: Rests,
    ) -> Figure {
        Figure { symbol, name, source, value: Given::from(value), unit: self.unit, rests }
    }
}

fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, f64::max)
}

fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::INFINITY, f64::min)
}
