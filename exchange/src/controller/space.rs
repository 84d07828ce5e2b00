//! The workspace of an export. In: the tables of a calibration, and what the user says. Out: how far each axis goes, the pose
//! at which tables of one axis hold exactly, and poses all over the workspace.

use abbe_runtime::Direction;
use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;

use super::geometry::{Geometry, Pose};
use super::refused::Refused;

/// So many poses all over the workspace, besides its corners.
const POSES: u32 = 2048;

/// So many axes at most: two directions each make so many poses of a place.
const MOST_DIRECTED: usize = 6;

/// How far each axis goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    /// From where to where, mm or rad, ascending.
    pub ranges: Vec<[f64; 2]>,
    /// Where the other axes stand while a table follows one, mm or rad.
    pub reference: Vec<f64>,
}

/// What the user says of the workspace; for each axis nothing where the calibration is to say it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Ranges by axis letter, mm or rad.
    pub ranges: Vec<(String, [f64; 2])>,
    /// Reference positions by axis letter, mm or rad.
    pub reference: Vec<(String, f64)>,
}

impl Space {
    /// The reach of the calibration's tables, or what is said instead; the reference is the middle, or what is said.
    ///
    /// # Errors
    /// An axis that the machine lacks, one of which nothing is known, a range that is none, a reference outside its range.
    pub fn new(equations: &Equations, calibration: &Calibration, wanted: &Wanted) -> Result<Self, Refused> {
        let letters = wanted.ranges.iter().map(|(letter, _)| letter);
        for letter in letters.chain(wanted.reference.iter().map(|(letter, _)| letter)) {
            known(equations, letter)?;
        }
        let axes = equations.axes.iter().enumerate();
        let ranges: Vec<[f64; 2]> = axes
            .map(|(axis, info)| match info.is_motor() {
                // Its axes say how far it goes.
                true => Ok([0.0, 0.0]),
                false => range(calibration, axis, &info.letter, info.rotary, &wanted.ranges),
            })
            .collect::<Result<_, _>>()?;
        let reference = equations.axes.iter().zip(&ranges);
        let reference = reference.map(|(info, range)| pose_of(&info.letter, *range, &wanted.reference));
        Ok(Self { reference: reference.collect::<Result<_, _>>()?, ranges })
    }

    /// The reference, all axes having come in one direction.
    pub fn reference_pose(&self, direction: Direction) -> Pose {
        Pose { position: self.reference.clone(), direction: vec![direction; self.reference.len()] }
    }

    /// Poses all over the workspace: its corners and places between them that no grid repeats, each from all directions
    /// that the machine tells apart.
    pub fn poses(&self, geometry: &Geometry<'_>) -> Vec<Pose> {
        let mut directed = geometry.directed();
        directed.truncate(MOST_DIRECTED);
        let axes = self.ranges.len();
        let corners = (0..1_u32 << axes.min(MOST_DIRECTED)).map(|corner| self.corner(corner));
        let between = (1..=POSES >> directed.len()).map(|number| self.between(number));
        let places = corners.chain(between);
        let ways = 0..1_u32 << directed.len();
        places
            .flat_map(|position| {
                let directed = &directed;
                ways.clone().map(move |way| from_all_sides(position.clone(), directed, way))
            })
            .collect()
    }

    /// A corner, each bit being the end of an axis.
    fn corner(&self, corner: u32) -> Vec<f64> {
        let ends = self.ranges.iter().enumerate();
        ends.map(|(axis, [low, high])| if corner >> axis.min(31) & 1 == 1 { *high } else { *low }).collect()
    }

    /// A member of Halton's sequence, spread over the workspace.
    fn between(&self, number: u32) -> Vec<f64> {
        const BASES: [u32; 9] = [2, 3, 5, 7, 11, 13, 17, 19, 23];
        let ranges = self.ranges.iter().zip(BASES.iter().cycle());
        ranges.map(|([low, high], base)| low + (high - low) * radical_inverse(number, *base)).collect()
    }
}

/// The digits of a number mirrored at the point: evenly spread in 0 to 1 for 1, 2, 3, ...
fn radical_inverse(mut number: u32, base: u32) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0 / f64::from(base));
    while number > 0 {
        value += digit * f64::from(number % base);
        number /= base;
        digit /= f64::from(base);
    }
    value
}

fn from_all_sides(position: Vec<f64>, directed: &[usize], way: u32) -> Pose {
    let mut direction = vec![Direction::Positive; position.len()];
    for (bit, axis) in directed.iter().enumerate() {
        if way >> bit & 1 == 1
            && let Some(slot) = direction.get_mut(*axis)
        {
            *slot = Direction::Negative;
        }
    }
    Pose { position, direction }
}

fn known(equations: &Equations, letter: &str) -> Result<(), Refused> {
    let letters: Vec<&str> = equations.axes.iter().map(|axis| axis.letter.as_str()).collect();
    if letters.contains(&letter) {
        return Ok(());
    }
    let help = format!("its axes are {}", letters.join(", "));
    Err(Refused::new(format!("{} has no axis {letter}", equations.machine), help))
}

fn range(
    calibration: &Calibration,
    axis: usize,
    letter: &str,
    rotary: bool,
    said: &[(String, [f64; 2])],
) -> Result<[f64; 2], Refused> {
    if let Some((_, range)) = said.iter().find(|(said, _)| said == letter) {
        let ends = range.iter().all(|end| end.is_finite()) && range[0] < range[1];
        let help = "write the lower end first, as in --range X=0:500";
        return if ends {
            Ok(*range)
        } else {
            Err(Refused::new(format!("the range of {letter} is empty"), help))
        };
    }
    tables(calibration, axis).ok_or_else(|| {
        let example = if rotary { "-90:90" } else { "0:500" };
        Refused::new(
            format!("no table of the calibration gives the travel of {letter}"),
            format!("give it in {}: --range {letter}={example}", if rotary { "deg" } else { "mm" }),
        )
    })
}

/// From the first to the last node of all tables and curves over an axis.
fn tables(calibration: &Calibration, axis: usize) -> Option<[f64; 2]> {
    let terms = calibration.motions.iter().flat_map(|motion| &motion.terms);
    let nodes = terms.flat_map(|term| term.value.nodes(axis));
    let (low, high) =
        nodes.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), node| (low.min(node), high.max(node)));
    (low < high).then_some([low, high])
}

fn pose_of(letter: &str, [low, high]: [f64; 2], said: &[(String, f64)]) -> Result<f64, Refused> {
    let Some((_, place)) = said.iter().find(|(said, _)| said == letter) else {
        return Ok(f64::midpoint(low, high));
    };
    if (low..=high).contains(place) {
        return Ok(*place);
    }
    let help = format!("give its travel with --range {letter}=..., or a place within it with --at");
    Err(Refused::new(format!("the place of --at {letter} is outside the axis's range"), help))
}
