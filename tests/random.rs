//! Random machines. In: proptest's choices. Out: descriptions of valid machines and topology words, with every feature of
//! the machine file; what shrinks are links, origins and error motions.

use proptest::collection::vec;
use proptest::prelude::*;

use crate::oracle::{ErrorMotion, Kind, Link, Machine, POINTING, Shape, State, Sum, draw};

/// Names of constants that a chain may mention.
const CONSTANTS: [&str; 5] = ["K1", "K2", "Lz", "Q", "offset_a"];

/// Angles by which a link leans, tenths of a degree: mostly none; those whose sines or squares are fractions, right angles, and others.
const ANGLES: [i32; 12] = [0, 0, 0, 0, 450, -300, 600, 900, -1350, 1800, 175, -1234];

/// One link before it is known which letters are still free.
#[derive(Clone, Debug)]
struct Plan {
    pick: u8,
    kind: u8,
    on_tool: bool,
    backwards: bool,
    own_id: bool,
    origin: [Vec<(i16, u8)>; 3],
    turned: Option<[u8; 3]>,
    bed: Option<bool>,
    errors: Option<Vec<ErrorPlan>>,
}

#[derive(Clone, Debug)]
struct ErrorPlan {
    pick: u8,
    symbol: bool,
    opposite: bool,
    travel: bool,
    rotates: bool,
}

/// Machines with chains of up to seven links besides part and tool.
pub(crate) fn machines() -> impl Strategy<Value = Machine> {
    let ends = (plan(), plan(), any::<bool>());
    let sensitive = prop_oneof![3 => Just([true; 3]), 1 => any::<[bool; 3]>()];
    (vec(plan(), 1..=7), ends, sensitive, any::<bool>(), any::<bool>()).prop_map(
        |(plans, (tool, part, with_part), sensitive, relative, bed)| {
            let sensitive = if sensitive == [false; 3] { [true; 3] } else { sensitive };
            let mut builder = Builder::default();
            let (workpiece, tool_links) = (Vec::new(), Vec::new());
            let mut machine =
                Machine { sensitive, relative, pointing: false, bed, workpiece, tool: tool_links };
            for plan in &plans {
                let link = builder.link(plan);
                if plan.on_tool { machine.tool.push(link) } else { machine.workpiece.push(link) }
            }
            if with_part {
                machine.workpiece.push(builder.end(&part, Kind::Part, "P"));
            }
            machine.tool.push(builder.end(&tool, Kind::Tool, "tip"));
            machine
        },
    )
}

/// Topology words: one to six distinct axes in any order, and F anywhere.
pub(crate) fn words() -> impl Strategy<Value = String> {
    let letters = Just(vec!['X', 'Y', 'Z', 'A', 'B', 'C']).prop_shuffle();
    (letters, 1..=6_usize, any::<prop::sample::Index>()).prop_map(|(mut letters, count, bed)| {
        letters.truncate(count);
        letters.insert(bed.index(count + 1), 'F');
        letters.into_iter().collect()
    })
}

/// The machine that a topology word stands for, as the page of the format says.
pub(crate) fn of_word(word: &str) -> Machine {
    let (part, tool) = word.split_once('F').expect("a word with a bed");
    let axis = |letter: char, backwards| {
        let along = match letter {
            'X' | 'A' => 0,
            'Y' | 'B' => 1,
            _ => 2,
        };
        let kind = if "ABC".contains(letter) { Kind::Rotary(letter) } else { Kind::Slide(letter) };
        let origin = [Sum::new(), Sum::new(), Sum::new()];
        Link {
            kind,
            id: letter.to_string(),
            along,
            backwards,
            origin,
            turned: [0; 3],
            bed: None,
            errors: None,
        }
    };
    let tip = Link {
        kind: Kind::Tool,
        id: "tip".to_owned(),
        along: 2,
        backwards: false,
        origin: ["Xt", "Yt", "Zt"].map(|name| vec![(1.0, Some(name.to_owned()))]),
        turned: [0; 3],
        bed: None,
        errors: None,
    };
    Machine {
        sensitive: [true; 3],
        relative: false,
        pointing: false,
        bed: false,
        workpiece: part.chars().rev().map(|letter| axis(letter, true)).collect(),
        tool: tool.chars().map(|letter| axis(letter, false)).chain([tip]).collect(),
    }
}

/// A state without errors: slides within 500 mm, rotary axes over the whole turn, constants within 300 mm.
pub(crate) fn state(machine: &Machine, seed: u64) -> State {
    let mut state = State::default();
    for link in machine.links() {
        if let Some(variable) = link.variable() {
            let range = if matches!(link.kind, Kind::Rotary(_)) { std::f64::consts::PI } else { 500.0 };
            state.positions.insert(variable.clone(), range * draw(seed, &variable));
        }
        for travel in link.errors.iter().flatten().filter_map(|error| error.travel.clone()) {
            let value = 500.0 * draw(seed, &travel);
            state.travels.insert(travel, value);
        }
    }
    state.constants =
        machine.constants().into_iter().map(|name| (name.clone(), 300.0 * draw(seed, &name))).collect();
    if machine.pointing {
        let direction = nalgebra::Vector3::from(POINTING.map(|name| draw(seed, name))).normalize();
        state.constants.extend(POINTING.map(str::to_owned).into_iter().zip(direction.iter().copied()));
    }
    state
}

fn plan() -> impl Strategy<Value = Plan> {
    let coordinate = || vec((-4000..4000_i16, any::<u8>()), 0..=2);
    let errors = prop_oneof![2 => Just(None), 3 => vec(error_plan(), 0..=7).prop_map(Some)];
    let origin = [coordinate(), coordinate(), coordinate()];
    let bed = prop_oneof![3 => Just(None), 2 => any::<bool>().prop_map(Some)];
    let turned = prop_oneof![2 => Just(None), 1 => any::<[u8; 3]>().prop_map(Some)];
    (any::<u8>(), any::<u8>(), any::<[bool; 3]>(), origin, turned, bed, errors).prop_map(
        |(pick, kind, [on_tool, backwards, own_id], origin, turned, bed, errors)| Plan {
            pick,
            kind,
            on_tool,
            backwards,
            own_id,
            origin,
            turned,
            bed,
            errors,
        },
    )
}

fn error_plan() -> impl Strategy<Value = ErrorPlan> {
    (any::<u8>(), any::<[bool; 4]>()).prop_map(|(pick, [symbol, opposite, travel, rotates])| ErrorPlan {
        pick,
        symbol,
        opposite,
        travel,
        rotates,
    })
}

/// What is already taken while plans become links.
#[derive(Default)]
struct Builder {
    letters: String,
    links: usize,
    symbols: usize,
}

impl Builder {
    /// An axis while letters are free (always for the first link), a spindle or a fixed body now and then.
    fn link(&mut self, plan: &Plan) -> Link {
        let free: Vec<char> = "XYZABCUVW".chars().filter(|letter| !self.letters.contains(*letter)).collect();
        let body = self.links > 0 && plan.kind.is_multiple_of(5);
        self.links += 1;
        let along = usize::from(plan.pick) % 3;
        if body || free.is_empty() {
            let kind = if plan.kind.is_multiple_of(2) { Kind::Spindle } else { Kind::Fixed };
            let id = format!("N{}", self.links);
            return self.dressed(plan, kind, id, along);
        }
        let letter = free[usize::from(plan.pick) % free.len()];
        self.letters.push(letter);
        let along = "XYZABCUVW".find(letter).unwrap_or_default() % 3;
        let kind = if "ABC".contains(letter) { Kind::Rotary(letter) } else { Kind::Slide(letter) };
        let id = if plan.own_id { format!("{letter}{}", self.links) } else { letter.to_string() };
        self.dressed(plan, kind, id, along)
    }

    fn end(&mut self, plan: &Plan, kind: Kind, id: &str) -> Link {
        self.dressed(plan, kind, id.to_owned(), 2)
    }

    fn dressed(&mut self, plan: &Plan, kind: Kind, id: String, along: usize) -> Link {
        let mut link = Link {
            kind,
            id,
            along,
            backwards: plan.backwards,
            origin: plan.origin.each_ref().map(|sum| coordinate(sum)),
            turned: [0; 3],
            bed: None,
            errors: None,
        };
        if matches!(kind, Kind::Slide(_) | Kind::Rotary(_)) {
            link.bed = plan.bed;
        }
        if matches!(kind, Kind::Fixed | Kind::Rotary(_)) {
            let angle = |pick: u8| ANGLES[usize::from(pick) % ANGLES.len()];
            link.turned = plan.turned.map(|picks| picks.map(angle)).unwrap_or_default();
        }
        link.errors = plan.errors.as_ref().map(|plans| self.errors(plans, &link));
        link
    }

    fn errors(&mut self, plans: &[ErrorPlan], link: &Link) -> Vec<ErrorMotion> {
        let shapes: &[Shape] = match link.kind {
            Kind::Slide(_) => &[Shape::Linear, Shape::Angular, Shape::Alignment],
            Kind::Rotary(_) | Kind::Spindle => {
                &[Shape::Linear, Shape::Angular, Shape::Offset, Shape::Alignment]
            }
            _ => &[Shape::Linear, Shape::Angular],
        };
        let mut errors: Vec<ErrorMotion> = Vec::new();
        for plan in plans {
            let pick = usize::from(plan.pick) % (3 * shapes.len());
            let mut error = ErrorMotion::plain(shapes[pick / 3], pick % 3);
            if errors.iter().any(|known| known.name(&link.id) == error.name(&link.id)) {
                continue;
            }
            self.symbols += 1;
            error.symbol = plan.symbol.then(|| format!("m{}", self.symbols));
            // It is the symbol that is counted against the ISO sense.
            error.opposite = plan.symbol && plan.opposite;
            if matches!(link.kind, Kind::Slide(_)) && error.shape == Shape::Alignment {
                error.travel = plan.travel.then(|| format!("d{}", link.id));
                error.rotates = plan.rotates;
            }
            errors.push(error);
        }
        errors
    }
}

/// Quarters of a mm, and multiples of constants by halves; a constant never cancels itself.
fn coordinate(plan: &[(i16, u8)]) -> Sum {
    let mut sum = Sum::new();
    for (number, pick) in plan {
        let constant =
            CONSTANTS.get(usize::from(*pick) % (2 * CONSTANTS.len())).map(|name| (*name).to_owned());
        if sum.iter().any(|(_, known)| *known == constant) {
            continue;
        }
        let factor = match &constant {
            None => f64::from(*number) / 4.0,
            Some(_) => [1.0, -1.0, 0.5, -2.0][usize::from(number.unsigned_abs()) % 4],
        };
        sum.push((factor, constant));
    }
    sum
}
