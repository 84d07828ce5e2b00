//! All measurements of a set-up together. In: the set-up, its files, the machine. Out: the error motions that they show, the
//! squarenesses, and the calibration that holds them.

use std::f64::consts::TAU;

use model_dsl::calibration::{self, CalibratedTerm, Calibration, CurveNodes, CurveValues};
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;

use super::bound::{self, Bound};
use super::curve::Curve;
use super::lever;
use super::measured::Measured;
use super::placed::Placed;
use super::reduce::{Reduced, Reversal, Tabulated, is_of_two, slope_of_two};
use super::setup::{Measurement, Setup};
use super::size;
use super::squareness::{self, Side, Squareness};
use super::uncertainty::{count, mean, together};
use super::view::View;

/// What the measurements give.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The machine's name.
    pub machine: String,
    /// The error motions, in the order of the set-up.
    pub motions: Vec<MeasuredMotion>,
    /// The squarenesses, in the order in which the set-up names their squares.
    pub squarenesses: Vec<Squareness>,
    /// All of it, and what the set-up knew before, as a calibration.
    pub calibration: Calibration,
    /// The limit of corrections that the data give, where the set-up sets none.
    pub bound: Option<Bound>,
}

/// One error motion with what it rests on.
#[derive(Clone, Debug)]
pub struct MeasuredMotion {
    /// The motion: an index into [`Equations::motions`].
    pub motion: usize,
    /// The axis that moved: an index into [`Equations::axes`].
    pub axis: usize,
    /// The files: that with the edge turned over behind the one before, and each set-up behind the one before.
    pub files: Vec<String>,
    /// How the set-up of each is called beside others: nothing for the first, `, turned over`, `, set-up 2`.
    pub set_ups: Vec<String>,
    /// What each of them says of itself: machine, serial number, date and so on.
    pub about: Vec<Vec<(String, String)>>,
    /// What each of them shows.
    pub parts: Vec<Reduced>,
    /// The motion: of the one file, or half the sum of both.
    pub curve: Curve,
    /// The difference of its directions, where both were read.
    pub reversal: Option<Reversal>,
    /// What the edge added to the readings of the first file, at the targets, where it was turned over: half the difference of
    /// both files, counted as the tool relative to the part, so that the same edge is the same on every machine.
    pub edge: Option<Vec<f64>>,
    /// Whether the machine file counts the motion against the tool relative to the part: all figures but the edge turn then.
    pub against: bool,
    /// The table in the calibration.
    pub table: Tabulated,
    /// Whether two targets gave its slope alone: then it has no table in the calibration.
    pub slope_alone: bool,
}

/// Findings at places of the set-up, and of each data file in the order of the measurements.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// In the set-up.
    pub setup: Diagnostics,
    /// In the files.
    pub data: Vec<Diagnostics>,
}

/// Calibrates: `files` are those of the set-up's measurements, in their order. Nothing is returned where a finding is an error.
pub fn calibrate(
    setup: &Setup,
    files: &[Measured],
    equations: &Equations,
    findings: &mut Findings,
) -> Option<Outcome> {
    let view = View::new(equations, &setup.known.constants);
    findings.data.resize_with(files.len(), Diagnostics::new);
    let mut placed: Vec<Option<Placed>> = Vec::new();
    for ((one, file), in_data) in setup.measurements.iter().zip(files).zip(&mut findings.data) {
        placed.push(Placed::new(file, one, &view, (&mut findings.setup, in_data)));
    }
    let placed: Vec<Placed> = placed.into_iter().collect::<Option<_>>()?;
    let reduced = reduced(&setup.measurements, placed, &view, &mut findings.setup)?;
    let pairs = setup.measurements.iter().zip(&reduced);
    for (one, _) in pairs.filter(|(one, reduced)| is_of_two(&reduced.curve, one)) {
        findings.setup.push(slope_of_two(one));
    }
    let all: Vec<Source<'_>> = setup
        .measurements
        .iter()
        .zip(&reduced)
        .zip(files)
        .map(|((measurement, reduced), file)| Source { measurement, reduced, file })
        .collect();
    let upright: Vec<&Source<'_>> = all.iter().filter(|source| !source.measurement.turned).collect();
    let first = |place: usize, source: &Source<'_>| {
        let before = upright.get(..place).unwrap_or(&[]);
        before.iter().all(|other| other.measurement.motion != source.measurement.motion)
    };
    let firsts = upright.iter().enumerate().filter(|(place, source)| first(*place, source));
    let motions: Vec<Option<MeasuredMotion>> =
        firsts.map(|(_, source)| source.motion(&all, &view, &mut findings.setup)).collect();
    let motions: Vec<MeasuredMotion> = motions.into_iter().collect::<Option<_>>()?;
    let squarenesses = squarenesses(setup, &all, &view, &mut findings.setup);
    let mut calibration = filled(equations, &setup.known, &motions, &squarenesses);
    size::check(&calibration, setup, &squarenesses, equations, &mut findings.setup);
    if findings.setup.has_errors() {
        return None;
    }
    let bound = bound::write(&mut calibration, equations);
    Some(Outcome { machine: equations.machine.clone(), motions, squarenesses, calibration, bound })
}

/// Reduces all measurements: rotations as they are, displacements without the rotations that act on them where that is asked for.
fn reduced(
    measurements: &[Measurement],
    placed: Vec<Placed>,
    view: &View<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Reduced>> {
    let plain: Vec<Option<Reduced>> = measurements
        .iter()
        .zip(&placed)
        .map(|(one, placed)| Reduced::new(placed, one, diagnostics))
        .collect();
    let plain: Vec<Reduced> = plain.into_iter().collect::<Option<_>>()?;
    let rotations = measurements.iter().zip(&plain).filter(|(one, _)| view.is_angular(one.motion.value));
    let angles: Vec<(usize, &Curve)> =
        rotations.map(|(one, reduced)| (one.motion.value, &reduced.curve)).collect();
    let without = measurements.iter().zip(placed).zip(&plain).map(|((one, mut placed), plain)| {
        let Some(place) = &one.at else { return Some(plain.clone()) };
        let (levers, shares) = lever::take_off(&mut placed, one, place, &angles, view);
        let mut reduced = Reduced::new(&placed, one, diagnostics)?;
        shares.add_to(&mut reduced.curve);
        reduced.levers = Some(levers);
        Some(reduced)
    });
    without.collect()
}

/// A measurement with its file and what that shows.
struct Source<'s> {
    measurement: &'s Measurement,
    reduced: &'s Reduced,
    file: &'s Measured,
}

impl Source<'_> {
    /// The motion that this file shows, together with those of the same edge laid on anew: the mean of all set-ups.
    fn motion(
        &self,
        all: &[Source<'_>],
        view: &View<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<MeasuredMotion> {
        let again = |other: &&Source<'_>| {
            !other.measurement.turned && other.measurement.motion == self.measurement.motion
        };
        let again: Vec<&Source<'_>> = all.iter().filter(again).collect();
        let shown = view.shown(self.measurement.motion.value)?;
        let mut set_ups = Vec::new();
        for source in &again {
            if !std::ptr::eq(*source, self) {
                self.check_alike(source, diagnostics)?;
            }
            set_ups.push(source.set_up(all, shown, diagnostics)?);
        }
        let curves: Vec<Curve> = set_ups.iter().map(|one| one.curve.clone()).collect();
        let curve = Curve::mean(&curves)?;
        let reversals: Option<Vec<Reversal>> = set_ups.iter().map(|one| one.reversal).collect();
        let reversal = match reversals.as_deref() {
            Some([one]) => Some(*one),
            Some(several) => Reversal::mean(several, &curve),
            None => None,
        };
        let edges: Option<Vec<Vec<f64>>> = set_ups.iter().map(|one| one.edge.clone()).collect();
        let parts: Vec<&Source<'_>> = set_ups.iter().flat_map(|one| one.parts.iter().copied()).collect();
        let table = Tabulated::of(&curve, self.measurement, reversal.map(|reversal| reversal.mean));
        table.check(self.measurement, diagnostics)?;
        Some(MeasuredMotion {
            motion: self.measurement.motion.value,
            axis: self.measurement.axis,
            files: parts.iter().map(|part| part.file.source.name().to_owned()).collect(),
            set_ups: parts.iter().map(|part| part.called()).collect(),
            about: parts.iter().map(|part| part.file.about.clone()).collect(),
            parts: parts.iter().map(|part| part.reduced.clone()).collect(),
            slope_alone: is_of_two(&curve, self.measurement),
            table,
            curve,
            reversal,
            edge: edges.map(|edges| mean_of(&edges)),
            against: shown < 0.0,
        })
    }

    /// What one set-up of the edge shows, together with the file that has it turned over.
    fn set_up<'a>(
        &'a self,
        all: &'a [Source<'a>],
        shown: f64,
        diagnostics: &mut Diagnostics,
    ) -> Option<SetUp<'a>> {
        let over =
            |other: &&Source<'_>| other.measurement.turned && other.measurement.is_of(self.measurement);
        let Some(over) = all.iter().find(over) else {
            let (curve, reversal) = (self.reduced.curve.clone(), self.reduced.reversal);
            return Some(SetUp { curve, reversal, edge: None, parts: vec![self] });
        };
        self.check_alike(over, diagnostics)?;
        let (one, other) = (&self.reduced.curve, &over.reduced.curve);
        let curve = one.half_sum(other, 1.0);
        let reversal = self.reduced.reversal.zip(over.reduced.reversal);
        let reversal = reversal.and_then(|(one, other)| Reversal::mean(&[one, other], &curve));
        let edge = one.half_sum(other, -1.0).centre().into_iter().map(|value| value * shown).collect();
        Some(SetUp { curve, reversal, edge: Some(edge), parts: vec![self, over] })
    }

    /// How its set-up is called beside others: nothing for the first one.
    fn called(&self) -> String {
        let anew = match self.measurement.placement {
            1 => String::new(),
            number => format!(", set-up {number}"),
        };
        if self.measurement.turned { format!("{anew}, turned over") } else { anew }
    }

    /// A reversal, and set-ups of which the mean is taken, have the same targets and directions (E0918).
    fn check_alike(&self, over: &Source<'_>, diagnostics: &mut Diagnostics) -> Option<()> {
        const NEAR: f64 = 1e-6;
        let (one, other) = (&self.reduced.curve, &over.reduced.curve);
        let mut pairs = one.positions.iter().zip(&other.positions);
        let places = one.positions.len() == other.positions.len()
            && pairs.all(|(one, other)| (one - other).abs() < NEAR);
        let sides = one.forward.is_some() == other.forward.is_some()
            && one.reverse.is_some() == other.reverse.is_some();
        if places && sides && self.measurement.axis == over.measurement.axis {
            return Some(());
        }
        let message = "the two set-ups do not have the same targets in the same directions";
        let mistake = Diagnostic::error("E0918", over.measurement.motion.span, message);
        let mistake = mistake.also(self.measurement.motion.span, "the other set-up");
        diagnostics
            .push(mistake.help("measure the same targets in both, and give `origin` and `sign` of both"));
        None
    }
}

impl Reversal {
    /// The mean of several, for the curve that is the mean of theirs.
    fn mean(all: &[Self], curve: &Curve) -> Option<Self> {
        let differences = curve.differences()?;
        let greater = |one: &(&f64, &f64), other: &(&f64, &f64)| one.0.abs().total_cmp(&other.0.abs());
        let (greatest, at) = differences.iter().zip(&curve.positions).max_by(greater)?;
        let share = 1.0 / count(all.len());
        let uncertainties: Vec<_> = all.iter().map(|one| (share, one.uncertainty)).collect();
        let values: Vec<f64> = all.iter().map(|one| one.mean).collect();
        let uncertainty = together(&uncertainties);
        Some(Self { mean: mean(&values), uncertainty, greatest: *greatest, at: *at })
    }
}

/// What one set-up of an edge shows.
struct SetUp<'s> {
    curve: Curve,
    reversal: Option<Reversal>,
    edge: Option<Vec<f64>>,
    parts: Vec<&'s Source<'s>>,
}

/// The mean of lists, place by place.
fn mean_of(lists: &[Vec<f64>]) -> Vec<f64> {
    let places = lists.first().map_or(0, Vec::len);
    let at =
        |place: usize| mean(&lists.iter().filter_map(|list| list.get(place).copied()).collect::<Vec<_>>());
    (0..places).map(at).collect()
}

/// The squarenesses of all squares that measurements name.
fn squarenesses(
    setup: &Setup,
    all: &[Source<'_>],
    view: &View<'_>,
    diagnostics: &mut Diagnostics,
) -> Vec<Squareness> {
    let name = |source: &Source<'_>| Some(source.measurement.reference.as_ref()?.value.clone());
    let mut names: Vec<String> = Vec::new();
    for name in all.iter().filter_map(name) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let mut found: Vec<Squareness> = Vec::new();
    for square in names {
        let own = all.iter().filter(|source| name(source).as_ref() == Some(&square));
        let sides: Vec<Side<'_>> = own
            .filter_map(|source| Some(Side { measurement: source.measurement, line: source.reduced.line? }))
            .collect();
        let known = setup.references.iter().find(|reference| reference.name.value == square);
        warn_of_rotations(all, &sides, view, diagnostics);
        let one = squareness::of_set_ups((&square, known), &sides, view, diagnostics);
        found.extend(one.filter(|one| is_new(one, &sides, setup, &found, view, diagnostics)));
    }
    found
}

/// Warns of a squareness in which the zero of an angular instrument stands again (W0904).
fn warn_of_rotations(all: &[Source<'_>], sides: &[Side<'_>], view: &View<'_>, diagnostics: &mut Diagnostics) {
    let motions = all.iter().map(|source| source.measurement.motion.value);
    let angles: Vec<usize> = motions.filter(|motion| view.is_angular(*motion)).collect();
    let unplaced = all.iter().filter(|source| source.measurement.at.is_none());
    for source in
        unplaced.filter(|source| sides.iter().any(|side| std::ptr::eq(side.measurement, source.measurement)))
    {
        let (one, positions) = (source.measurement, &source.reduced.curve.positions);
        let Some(rotation) = lever::turning(one, positions, &angles, view) else { continue };
        let name = |motion: usize| view.equations.motions.get(motion).map_or("", |motion| &motion.name);
        let message = format!(
            "the slope of {1}, and so the squareness, includes the zero of {0}",
            name(rotation),
            name(one.motion.value)
        );
        let help = "give the positions of the other axes with `at`, so that it is subtracted";
        diagnostics.push(Diagnostic::warning("W0904", one.motion.span, message).help(help));
    }
}

/// Whether an alignment error is given in no other way (E0911).
fn is_new(
    one: &Squareness,
    sides: &[Side<'_>],
    setup: &Setup,
    found: &[Squareness],
    view: &View<'_>,
    diagnostics: &mut Diagnostics,
) -> bool {
    let given = setup.known.motions.iter().any(|known| known.motion == one.motion);
    if !given && found.iter().all(|other| other.motion != one.motion) {
        return true;
    }
    let name = view.equations.motions.get(one.motion).map_or("", |motion| &motion.name);
    let span = sides.first().and_then(|side| side.measurement.reference.as_ref()).map(|name| name.span);
    let message = format!("the square `{}` gives {name}, which is also given elsewhere", one.reference);
    let mistake = Diagnostic::error("E0911", span.unwrap_or_default(), message);
    diagnostics.push(mistake.help("leave one of the two out"));
    false
}

/// What was known with what was measured.
fn filled(
    equations: &Equations,
    known: &Calibration,
    motions: &[MeasuredMotion],
    squarenesses: &[Squareness],
) -> Calibration {
    let mut terms: Vec<(usize, CalibratedTerm)> = Vec::new();
    for one in motions.iter().filter(|one| !one.slope_alone) {
        let rotary = equations.axes.get(one.axis).is_some_and(|axis| axis.rotary);
        let curve = one.table.curve();
        let curve = if rotary { closed(curve) } else { curve };
        terms.push((one.motion, CalibratedTerm::Table { axis: one.axis, curve }));
        if let Some(lost_motion) = one.table.lost_motion {
            terms.push((one.motion, CalibratedTerm::Backlash { axis: one.axis, lost_motion, wind_up: 0.0 }));
        }
    }
    let angle =
        |one: &Squareness| (one.motion, CalibratedTerm::Constant { value: super::placed::tidy(one.angle) });
    terms.extend(squarenesses.iter().map(angle));
    known.with(&terms)
}

impl Tabulated {
    /// The table as a calibration has it: a start and a step where the nodes are evenly spaced.
    fn curve(&self) -> calibration::Curve {
        let values = match &self.reverse {
            Some(reverse) => {
                CurveValues::Directed { forward: self.forward.clone(), reverse: reverse.clone() }
            }
            None => CurveValues::Both(self.forward.clone()),
        };
        let nodes = match even(&self.nodes) {
            Some((start, step)) => CurveNodes::Uniform { start, step },
            None => CurveNodes::At(self.nodes.clone()),
        };
        calibration::Curve::new(nodes, values)
    }
}

/// How far the ends of a table over one turn may be from a turn, in rad: the digits that are kept of a node.
const A_TURN: f64 = 1e-9;

/// A curve over a rotary axis: where it spans one turn its ends are one place, which was measured twice, and have the mean of both.
fn closed(curve: calibration::Curve) -> calibration::Curve {
    let turns = curve.ends().is_some_and(|[first, last]| ((last - first).abs() - TAU).abs() < A_TURN);
    if !turns {
        return curve;
    }
    let meet = |mut values: Vec<f64>| {
        if let [first, .., last] = values.as_mut_slice() {
            *first = super::placed::tidy(f64::midpoint(*first, *last));
            *last = *first;
        }
        values
    };
    let values = match curve.values {
        CurveValues::Both(values) => CurveValues::Both(meet(values)),
        CurveValues::Directed { forward, reverse } => {
            CurveValues::Directed { forward: meet(forward), reverse: meet(reverse) }
        }
    };
    calibration::Curve { values, repeats: true, ..curve }
}

/// Start and step of nodes that are evenly spaced to the last digit that is kept.
pub(crate) fn even(nodes: &[f64]) -> Option<(f64, f64)> {
    let (start, next) = (*nodes.first()?, *nodes.get(1)?);
    let step = super::placed::tidy(next - start);
    let expected = (0..).map(|number: u32| super::placed::tidy(start + f64::from(number) * step));
    nodes.iter().zip(expected).all(|(node, expected)| *node == expected).then_some((start, step))
}
