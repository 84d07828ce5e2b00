//! The vocabulary: the table of all terms that a calibration may have.
//!
//! In: nothing. Out: for each term its name, its keys, the kinds of their quantities, what may be left out, what it depends on and
//! whether a controller can compensate it. Readers, writers, schemas and the reference speak of terms from here alone, so
//! that a term is added in one place: here, beside its [`CalibratedTerm`](super::CalibratedTerm).

mod key;

pub use key::{Base, Bound, Given, Holds, Key, Kind, Role};

use key::{FACTORS, LOAD, NUMBERS, OTHER_AXIS, OWN_AXIS, PER, SENSOR, UNIT, flag, list, quantity};

/// A term of the vocabulary, without its numbers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum TermKind {
    /// An offset, an alignment.
    Constant,
    /// Powers of a position or of a temperature.
    Polynomial,
    /// A measured curve.
    Table,
    /// Play.
    Backlash,
    /// A spike after each reversal.
    ReversalSpike,
    /// A wave along an axis.
    Cyclic,
    /// What a position loop stays behind.
    Lag,
    /// What follows the acceleration.
    Acceleration,
    /// A scale that follows a temperature.
    Expansion,
    /// A length or an angle that follows a temperature.
    Growth,
    /// What settles with time.
    Drift,
    /// A wave in time.
    Vibration,
    /// Powers of the position of another axis.
    Coupling,
    /// What follows a load.
    Compliance,
    /// A time that an axis is late.
    Delay,
    /// An event.
    Step,
    /// States of the machine multiplied with one another.
    Product,
}

/// What the vocabulary says of a term.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The term.
    pub kind: TermKind,
    /// Its name in calibration files.
    pub name: &'static str,
    /// The physics that it stands for.
    pub physics: &'static str,
    /// What it depends on.
    pub state: State,
    /// How its keys belong together.
    pub form: Form,
    /// Its keys, in the order in which messages list them.
    pub keys: &'static [Key],
    /// Why no controller can compensate it in real time; nothing where one can.
    pub not_compensable: Option<&'static str>,
}

/// What a term depends on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum State {
    /// Nothing: it is the same everywhere.
    Nothing,
    /// The position of an axis, or what stands in its place in a polynomial of a sensor.
    Position,
    /// The position of an axis that is not the link's own.
    OtherPosition,
    /// The direction of motion.
    Direction,
    /// The time since the last reversal.
    Reversal,
    /// The velocity.
    Velocity,
    /// The acceleration.
    Acceleration,
    /// A temperature.
    Temperature,
    /// The time since the recording began.
    Time,
    /// A load.
    Load,
    /// What its factors depend on.
    Factors,
}

impl State {
    /// Whether it is where an axis stands.
    pub fn is_position(self) -> bool {
        matches!(self, Self::Position | Self::OtherPosition)
    }
}

/// How the keys of a term belong together.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form {
    /// Each key says one thing, whatever the others say.
    Plain,
    /// A list of coefficients, the first of them of this power, in `unit` over powers of `per`.
    Powers {
        /// The power of the first coefficient.
        first: u8,
    },
    /// Nodes and values.
    Curve,
}

/// The time over which the correction of a reversal is spread: a setting beside its term.
pub const RAMP: &str = "ramp";

/// Whether a position loop answers a term: a setting beside it.
pub const INSIDE_LOOP: &str = "inside_loop";

/// The natural frequency of a position loop.
pub const FREQUENCY: &str = "frequency";

/// The factors that a term is multiplied with. All terms but a delay may have them, and a product must.
pub const TIMES: &str = "times";

/// All terms, in the order of [`TermKind`].
pub const VOCABULARY: [Entry; 17] = [
    Entry {
        kind: TermKind::Constant,
        name: "constant",
        physics: "offset, alignment",
        state: State::Nothing,
        form: Form::Plain,
        keys: &[quantity("value", Kind::MOTION).role(Role::Value)],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::Polynomial,
        name: "polynomial",
        physics: "scale, straightness, pitch, yaw, roll; a component against temperature",
        state: State::Position,
        form: Form::Powers { first: 0 },
        keys: &[
            OWN_AXIS,
            SENSOR.one_of(),
            PER.one_of(),
            UNIT,
            NUMBERS.named("coefficients").role(Role::Value),
        ],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::Table,
        name: "table",
        physics: "any measured curve",
        state: State::Position,
        form: Form::Curve,
        keys: &[
            OWN_AXIS,
            quantity("start", Kind::POSITION).role(Role::Place).one_of(),
            quantity("step", Kind::POSITION).bound(Bound::NotZero).role(Role::Place).one_of(),
            list("at", Kind::POSITION).one_of(),
            PER.or("each entry of `at` has its own unit"),
            quantity("period", Kind::POSITION)
                .bound(Bound::Positive)
                .or("constant beyond its ends; over one turn of a rotary axis it repeats after that")
                .role(Role::Place),
            UNIT,
            NUMBERS.named("values").role(Role::Value).one_of(),
            NUMBERS.named("forward").role(Role::Linear).one_of(),
            NUMBERS.named("reverse").role(Role::Linear).one_of(),
        ],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::Backlash,
        name: "backlash",
        physics: "lost motion, reversal error, pre-sliding hysteresis",
        state: State::Direction,
        form: Form::Plain,
        keys: &[
            quantity("lost_motion", Kind::MOTION).role(Role::Linear),
            quantity("wind_up", Kind::POSITION)
                .bound(Bound::NotNegative)
                .or("the backlash is taken up at once"),
            quantity(RAMP, Kind::TIME)
                .bound(Bound::NotNegative)
                .or("it is corrected at once")
                .role(Role::Setting),
            flag(INSIDE_LOOP).or("no position loop responds to it").role(Role::Setting),
            OWN_AXIS,
        ],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::ReversalSpike,
        name: "reversal-spike",
        physics: "stick-slip at a reversal",
        state: State::Reversal,
        form: Form::Plain,
        keys: &[
            quantity("height", Kind::MOTION).role(Role::Linear),
            quantity("decay", Kind::TIME).bound(Bound::Positive),
            OWN_AXIS,
        ],
        not_compensable: Some("it has passed before a correction can reach the slide"),
    },
    Entry {
        kind: TermKind::Cyclic,
        name: "cyclic",
        physics: "pitch of a screw, interpolation of an encoder",
        state: State::Position,
        form: Form::Plain,
        keys: &[
            quantity("period", Kind::POSITION).bound(Bound::Positive),
            quantity("amplitude", Kind::MOTION).role(Role::Linear),
            quantity("phase", Kind::ANGLE),
            OWN_AXIS,
        ],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::Lag,
        name: "lag",
        physics: "following error of a position loop, which rings if it has a natural frequency",
        state: State::Velocity,
        form: Form::Plain,
        keys: &[
            quantity("gain", Kind { of: Base::Position, per: &[Base::Motion, Base::Time] })
                // Below zero the drive leads: no loop of second order does.
                .bound(Bound::PositiveBeside(FREQUENCY)),
            quantity(FREQUENCY, Kind::FREQUENCY)
                .bound(Bound::Positive)
                .or("a first-order loop")
                .role(Role::Transient),
            OWN_AXIS,
        ],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::Acceleration,
        name: "acceleration",
        physics: "feed-forward that is missing, or too large",
        state: State::Acceleration,
        form: Form::Plain,
        keys: &[
            quantity("gain", Kind { of: Base::Position, per: &[Base::Motion, Base::Time, Base::Time] })
                // Below zero the axis runs ahead: the feed-forward is too large.
                .bound(Bound::NotZero),
            OWN_AXIS,
        ],
        not_compensable: Some("the correction would itself accelerate the axis"),
    },
    Entry {
        kind: TermKind::Expansion,
        name: "expansion",
        physics: "a scale that grows with temperature",
        state: State::Temperature,
        form: Form::Plain,
        keys: &[
            SENSOR,
            quantity("coefficient", Kind { of: Base::Motion, per: &[Base::Position, Base::Temperature] })
                .role(Role::Linear),
            quantity("reference", Kind::TEMPERATURE),
            OWN_AXIS,
        ],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::Growth,
        name: "growth",
        physics: "growth of a spindle or a structure",
        state: State::Temperature,
        form: Form::Plain,
        keys: &[
            SENSOR,
            quantity("coefficient", Kind { of: Base::Motion, per: &[Base::Temperature] }).role(Role::Linear),
            quantity("reference", Kind::TEMPERATURE),
            quantity("time_constant", Kind::TIME).bound(Bound::Positive).or("no filter"),
        ],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::Drift,
        name: "drift",
        physics: "warm-up without a sensor",
        state: State::Time,
        form: Form::Plain,
        keys: &[
            quantity("amplitude", Kind::MOTION).role(Role::Linear),
            quantity("time_constant", Kind::TIME).bound(Bound::Positive),
        ],
        not_compensable: Some("a controller does not know when it began"),
    },
    Entry {
        kind: TermKind::Vibration,
        name: "vibration",
        physics: "mains, imbalance",
        state: State::Time,
        form: Form::Plain,
        keys: &[
            quantity("frequency", Kind::FREQUENCY).bound(Bound::Positive),
            quantity("amplitude", Kind::MOTION).role(Role::Linear),
            quantity("phase", Kind::ANGLE),
        ],
        not_compensable: Some("a controller does not know its phase"),
    },
    Entry {
        kind: TermKind::Coupling,
        name: "coupling",
        physics: "sag, cross-talk",
        state: State::OtherPosition,
        form: Form::Powers { first: 1 },
        keys: &[OTHER_AXIS, PER, UNIT, NUMBERS.named("coefficients").role(Role::Value)],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::Compliance,
        name: "compliance",
        physics: "deflection under load",
        state: State::Load,
        form: Form::Plain,
        keys: &[
            LOAD,
            quantity("coefficient", Kind { of: Base::Motion, per: &[Base::Load] }).role(Role::Linear),
            flag(INSIDE_LOOP).or("no position loop responds to it").role(Role::Setting),
        ],
        not_compensable: Some("a controller does not know the load in time"),
    },
    Entry {
        kind: TermKind::Delay,
        name: "delay",
        physics: "dead time: an axis that gets its commands later than the others, or responds later",
        state: State::Velocity,
        form: Form::Plain,
        keys: &[quantity("time", Kind::TIME).bound(Bound::NotZero), OWN_AXIS],
        not_compensable: None,
    },
    Entry {
        kind: TermKind::Step,
        name: "step",
        physics: "an event: a collision, a slip, a clamp that moved",
        state: State::Time,
        form: Form::Plain,
        keys: &[quantity("time", Kind::TIME), quantity("size", Kind::MOTION).role(Role::Linear)],
        not_compensable: Some("a controller does not know when it happened"),
    },
    Entry {
        kind: TermKind::Product,
        name: "product",
        physics: "a form that no other term has: a product of states of the machine",
        state: State::Factors,
        form: Form::Plain,
        keys: &[quantity("value", Kind::MOTION).role(Role::Value), FACTORS],
        not_compensable: None,
    },
];

/// The names of all terms as calibration files write them.
pub const TERM_NAMES: [&str; VOCABULARY.len()] = {
    let mut names = [""; VOCABULARY.len()];
    let mut number = 0;
    while number < names.len() {
        // A term is found by its number.
        assert!(VOCABULARY[number].kind as usize == number);
        names[number] = VOCABULARY[number].name;
        number += 1;
    }
    names
};

/// The table at one place, so that what is taken from it stays.
static TABLE: [Entry; VOCABULARY.len()] = VOCABULARY;

impl TermKind {
    /// All of them, in the order of the vocabulary.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|entry| entry.kind)
    }

    /// The term of a name in calibration files.
    pub fn of_name(name: &str) -> Option<Self> {
        TABLE.iter().find(|entry| entry.name == name).map(|entry| entry.kind)
    }

    /// What the vocabulary says of it.
    pub fn entry(self) -> &'static Entry {
        &TABLE[self as usize]
    }

    /// Its name in calibration files.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// Whether a controller can compensate it in real time.
    pub fn compensable(self) -> bool {
        self.entry().not_compensable.is_none()
    }

    /// Whether it may be multiplied with factors. A delay moves the axis itself, which nothing multiplies.
    pub fn takes_factors(self) -> bool {
        self != Self::Delay
    }

    /// The power of the first of its coefficients; 0 where it has none.
    pub fn first_power(self) -> usize {
        match self.entry().form {
            Form::Powers { first } => usize::from(first),
            Form::Plain | Form::Curve => 0,
        }
    }
}

impl Entry {
    /// The key of a name.
    pub fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// The names of its keys, in order.
    pub fn key_names(&self) -> Vec<&'static str> {
        self.keys.iter().map(|key| key.name).collect()
    }
}

#[cfg(test)]
mod tests;
