//! A second reading of the machine file's meaning, which shares no code with the compiler.
//!
//! In: a machine described link by link, and numbers for its positions, constants and error motions. Out: the bodies of
//! both branches with every sign applied, for [`exact`] and [`dual`] to multiply. It exists so that the compiler's
//! equations are held against something that was not made from them.

pub(crate) mod dual;
pub(crate) mod exact;

use std::collections::BTreeMap;

/// The constants that are the direction of a tool.
pub(crate) const POINTING: [&str; 3] = ["It", "Jt", "Kt"];

/// A machine as its file describes it.
#[derive(Clone, Debug)]
pub(crate) struct Machine {
    /// Which of X, Y, Z are derived.
    pub(crate) sensitive: [bool; 3],
    /// `motions: relative`.
    pub(crate) relative: bool,
    /// Whether the file names the parts of the tool's direction, and asks for it.
    pub(crate) pointing: bool,
    /// The default of `reference`: whether rotations act about the origin that stays.
    pub(crate) bed: bool,
    /// From the bed to the part.
    pub(crate) workpiece: Vec<Link>,
    /// From the bed to the tool tip.
    pub(crate) tool: Vec<Link>,
}

/// What a link is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Slide(char),
    Rotary(char),
    Spindle,
    Fixed,
    Tool,
    Part,
}

/// One link of a branch.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    pub(crate) kind: Kind,
    pub(crate) id: String,
    /// The direction of positive programmed motion: X, Y, Z as 0, 1, 2.
    pub(crate) along: usize,
    /// Whether positive programmed motion runs against that direction.
    pub(crate) backwards: bool,
    /// The place of the frame at zero: sums of numbers and of multiples of constants.
    pub(crate) origin: [Sum; 3],
    /// By how many tenths of a degree the frame is turned for good about X, then Y, then Z of the frame before it. Behind a rotary axis
    /// that is turned back.
    pub(crate) turned: [i32; 3],
    /// The link's own `reference`, where it has one.
    pub(crate) bed: Option<bool>,
    /// The error motions that the file lists; none where it lists none and means the usual ones.
    pub(crate) errors: Option<Vec<ErrorMotion>>,
}

/// A number of mm or a multiple of a named constant, summed.
pub(crate) type Sum = Vec<(f64, Option<String>)>;

/// What an error motion does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Displaces the body.
    Linear,
    /// Turns the body.
    Angular,
    /// Displaces the axis of a rotary axis or spindle.
    Offset,
    /// Turns the line of motion of a slide, or tilts a rotary axis or spindle.
    Alignment,
}

/// One error motion of a link.
#[derive(Clone, Debug)]
pub(crate) struct ErrorMotion {
    pub(crate) shape: Shape,
    /// Along or about X, Y, Z: 0, 1, 2.
    pub(crate) axis: usize,
    /// Counted against the ISO sense.
    pub(crate) opposite: bool,
    pub(crate) symbol: Option<String>,
    /// The free travel in place of the position.
    pub(crate) travel: Option<String>,
    /// Whether the carriage turns with its line.
    pub(crate) rotates: bool,
}

/// Where the machine stands and what is wrong with it.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    /// By variable, `x`: mm or rad.
    pub(crate) positions: BTreeMap<String, f64>,
    /// How fast each position changes; only [`dual`] reads it.
    pub(crate) rates: BTreeMap<String, f64>,
    pub(crate) travels: BTreeMap<String, f64>,
    pub(crate) constants: BTreeMap<String, f64>,
    /// By ISO name, `EC0Y`: mm or rad.
    pub(crate) errors: BTreeMap<String, f64>,
}

/// A link with numbers in it; every error in the directions of the frame before it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Body {
    pub(crate) origin: [f64; 3],
    /// The angles of the frame against the one before it, rad.
    pub(crate) turned: [f64; 3],
    /// The direction of motion, or the axis of rotation; zero for a body that no program moves.
    pub(crate) direction: [f64; 3],
    pub(crate) turns: bool,
    pub(crate) position: f64,
    pub(crate) rate: f64,
    /// Rotations act about the origin that stays.
    pub(crate) bed: bool,
    pub(crate) linear: [f64; 3],
    pub(crate) angular: [f64; 3],
    pub(crate) offset: [f64; 3],
    pub(crate) tilt: [f64; 3],
    pub(crate) lines: Vec<Line>,
}

/// A line of motion that is turned.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) angle: [f64; 3],
    pub(crate) travel: f64,
    pub(crate) rotates: bool,
}

impl ErrorMotion {
    /// An error motion of the plain kind.
    pub(crate) fn plain(shape: Shape, axis: usize) -> Self {
        Self { shape, axis, opposite: false, symbol: None, travel: None, rotates: false }
    }

    /// The ISO name on a link.
    pub(crate) fn name(&self, id: &str) -> String {
        let letters = if matches!(self.shape, Shape::Linear | Shape::Offset) { "XYZ" } else { "ABC" };
        let zero = if matches!(self.shape, Shape::Offset | Shape::Alignment) { "0" } else { "" };
        format!("E{}{zero}{id}", &letters[self.axis..=self.axis])
    }
}

impl Link {
    /// The variable of an axis, `x`.
    pub(crate) fn variable(&self) -> Option<String> {
        match self.kind {
            Kind::Slide(letter) | Kind::Rotary(letter) => Some(letter.to_ascii_lowercase().to_string()),
            _ => None,
        }
    }

    /// The error motion of this name, if it is one of this link.
    pub(crate) fn error(&self, name: &str) -> Option<ErrorMotion> {
        // Most names are those of another link; thousands of machines ask.
        if !name.ends_with(&self.id) {
            return None;
        }
        if let Some(listed) = &self.errors {
            return listed.iter().find(|error| error.name(&self.id) == name).cloned();
        }
        let shapes: &[Shape] = match self.kind {
            Kind::Slide(_) => &[Shape::Linear, Shape::Angular, Shape::Alignment],
            Kind::Rotary(_) | Kind::Spindle => {
                &[Shape::Linear, Shape::Angular, Shape::Offset, Shape::Alignment]
            }
            _ => &[],
        };
        let every = shapes.iter().flat_map(|shape| (0..3).map(|axis| ErrorMotion::plain(*shape, axis)));
        every.into_iter().find(|error| error.name(&self.id) == name)
    }

    fn moves(&self) -> bool {
        matches!(self.kind, Kind::Slide(_) | Kind::Rotary(_))
    }
}

impl Machine {
    /// All links, the part's branch first.
    pub(crate) fn links(&self) -> impl Iterator<Item = &Link> {
        self.workpiece.iter().chain(&self.tool)
    }

    /// The names of the constants that the chain mentions.
    pub(crate) fn constants(&self) -> Vec<String> {
        let mut names: Vec<String> = self
            .links()
            .flat_map(|link| link.origin.iter().flatten())
            .filter_map(|(_, name)| name.clone())
            .collect();
        names.sort();
        names.dedup();
        if self.pointing {
            names.extend(POINTING.map(str::to_owned));
        }
        names
    }

    /// The direction of the tool in its own frame: what constants say, or along the last spindle before it that no rotary axis and no turned body follows, else Z.
    pub(crate) fn tool_axis(&self, state: &State) -> [f64; 3] {
        if self.pointing {
            return POINTING.map(|name| state.constants[name]);
        }
        let mut axis = [0.0, 0.0, 1.0];
        for link in &self.tool {
            match link.kind {
                Kind::Rotary(_) => axis = [0.0, 0.0, 1.0],
                Kind::Fixed if link.turned != [0; 3] => axis = [0.0, 0.0, 1.0],
                Kind::Spindle => {
                    axis = [0.0; 3];
                    axis[link.along] = if link.backwards { -1.0 } else { 1.0 };
                }
                _ => {}
            }
        }
        axis
    }

    /// Both branches with numbers in them: the part's, the tool's.
    pub(crate) fn bodies(&self, state: &State) -> [Vec<Body>; 2] {
        for name in state.errors.keys() {
            assert!(
                self.links().any(|link| link.error(name).is_some()),
                "{name} is no error motion of this machine"
            );
        }
        let branch =
            |links: &[Link], on_part| links.iter().map(|link| self.body(link, on_part, state)).collect();
        [branch(&self.workpiece, true), branch(&self.tool, false)]
    }

    fn body(&self, link: &Link, on_part: bool, state: &State) -> Body {
        let mut body = Body { bed: link.bed.unwrap_or(self.bed), ..Body::default() };
        body.origin = link.origin.each_ref().map(|sum| {
            sum.iter()
                .map(|(factor, name)| factor * name.as_ref().map_or(1.0, |name| state.constants[name]))
                .sum()
        });
        body.turned = link.turned.map(|tenths| (f64::from(tenths) / 10.0).to_radians());
        if let Some(variable) = link.variable() {
            body.direction[link.along] = if link.backwards { -1.0 } else { 1.0 };
            body.turns = matches!(link.kind, Kind::Rotary(_));
            body.position = state.positions[&variable];
            body.rate = state.rates.get(&variable).copied().unwrap_or(0.0);
        }
        for (name, value) in &state.errors {
            if let Some(error) = link.error(name) {
                let signed = value * self.sign(link, &error, on_part);
                let travel = error.travel.as_ref().map_or(body.position, |name| state.travels[name]);
                add(&mut body, link, &error, signed, travel);
            }
        }
        body
    }

    /// An error motion moves its own body in bed directions. The link's own direction is counted along `along`; where the
    /// motions are relative, those on the part's branch are seen from the part, but the line of a slide is turned alike from both sides.
    fn sign(&self, link: &Link, error: &ErrorMotion, on_part: bool) -> f64 {
        let own = link.moves()
            && error.axis == link.along
            && match link.kind {
                Kind::Slide(_) => error.shape == Shape::Linear,
                _ => matches!(error.shape, Shape::Angular | Shape::Alignment),
            };
        let line = matches!((link.kind, error.shape), (Kind::Slide(_), Shape::Alignment));
        let seen_from_part = self.relative && on_part && !line && !own;
        if own && link.backwards || seen_from_part { -1.0 } else { 1.0 }
    }
}

fn add(body: &mut Body, link: &Link, error: &ErrorMotion, signed: f64, travel: f64) {
    match (error.shape, link.kind) {
        (Shape::Linear, _) => body.linear[error.axis] += signed,
        (Shape::Angular, _) => body.angular[error.axis] += signed,
        (Shape::Offset, _) => body.offset[error.axis] += signed,
        (Shape::Alignment, Kind::Slide(_)) => {
            let mut angle = [0.0; 3];
            angle[error.axis] = signed;
            body.lines.push(Line { angle, travel, rotates: error.rotates });
        }
        (Shape::Alignment, _) => body.tilt[error.axis] += signed,
    }
}

/// The sizes that bound the remainder of the first order.
///
/// The tip is a sum of lengths, each turned by a product of rotations by `s` times an error angle, and of error
/// displacements, themselves `s` times their value. Differentiating such a sum k times by `s` gives at most
/// `lengths * angles^k + k * displacements * angles^(k-1)`, since a derivative of a rotation is the angle times the rotation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sizes {
    pub(crate) lengths: f64,
    pub(crate) angles: f64,
    pub(crate) displacements: f64,
}

impl Sizes {
    /// The sizes of a machine in a state.
    pub(crate) fn of(machine: &Machine, state: &State) -> Self {
        let total = |values: [f64; 3]| values.iter().map(|value| value.abs()).sum::<f64>();
        let mut sizes = Self { lengths: 0.0, angles: 0.0, displacements: 0.0 };
        for body in machine.bodies(state).iter().flatten() {
            sizes.lengths += total(body.origin);
            sizes.lengths += if body.turns { 0.0 } else { body.position.abs() };
            sizes.angles += total(body.angular) + total(body.tilt);
            sizes.displacements += total(body.linear) + total(body.offset);
            for line in &body.lines {
                sizes.lengths += line.travel.abs();
                // Once for the line and once for the carriage that may turn with it.
                sizes.angles += 2.0 * total(line.angle);
            }
        }
        sizes
    }

    /// The greatest second derivative: the remainder after the first order is at most half of it.
    pub(crate) fn second(self) -> f64 {
        self.lengths * self.angles.powi(2) + 2.0 * self.displacements * self.angles
    }

    /// The greatest third derivative.
    pub(crate) fn third(self) -> f64 {
        self.lengths * self.angles.powi(3) + 3.0 * self.displacements * self.angles.powi(2)
    }

    /// What rounding may add: some hundred operations on numbers of the size of all lengths.
    pub(crate) fn rounding(self) -> f64 {
        1e-13 * (1.0 + self.lengths)
    }
}

/// A number between -1 and 1 that depends on a seed and a name only.
pub(crate) fn draw(seed: u64, name: &str) -> f64 {
    let mixed = name.bytes().fold(seed ^ 0x9e37_79b9_7f4a_7c15, |hash, byte| {
        let hash = (hash ^ u64::from(byte)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        hash ^ (hash >> 29)
    });
    let mixed = (mixed ^ (mixed >> 32)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
