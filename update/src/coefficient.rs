//! Coefficients: the numbers of a calibration in which the error is linear.
//!
//! In: a calibration and the names of its machine. Out: every such number with its place, its name for people, its unit
//! and the term that has it as 1 and all others of the term as 0; and a list of what stands, with the reason. One function
//! lists the numbers of a term, for reading and for writing, so that no number can be read in one place and written in
//! another.

use model_dsl::calibration::factor::dimension_of;
use model_dsl::calibration::vocabulary::{Base, Form, Given, Holds, Key, Role, State};
use model_dsl::calibration::{CalibratedTerm, Calibration, MachineNames, MotionName, Part};
use model_dsl::quantity::Dimension;

use crate::update::Fixed;

/// One coefficient.
#[derive(Clone, Debug)]
pub(crate) struct Coefficient {
    /// Its error motion, by number.
    pub(crate) motion: usize,
    /// The motion's place in the calibration, the term's place in the motion, the number's place in the term.
    pub(crate) place: [usize; 3],
    /// `EXX.polynomial[1]`.
    pub(crate) name: String,
    /// The value, in mm, rad, degC.
    pub(crate) value: f64,
    /// The unit of the value.
    pub(crate) unit: String,
    /// Coefficients of the same number are moved together by `select`: the values of one table.
    pub(crate) piece: usize,
    /// The term with this coefficient 1 and its others 0.
    pub(crate) unit_term: CalibratedTerm,
}

/// What a calibration has: what may move, and what stands.
pub(crate) struct Coefficients {
    pub(crate) moving: Vec<Coefficient>,
    pub(crate) fixed: Vec<Fixed>,
}

/// Lists the coefficients of a calibration in its order.
pub(crate) fn coefficients(calibration: &Calibration, names: &MachineNames) -> Coefficients {
    let mut found = Coefficients { moving: Vec::new(), fixed: Vec::new() };
    let mut piece = 0;
    for (listed, motion) in calibration.motions.iter().enumerate() {
        let mut heads: Vec<String> = Vec::new();
        for (place, term) in motion.terms.iter().enumerate() {
            let words = Words { names, calibration, motion: motion.motion };
            let head = unlike(words.head(&term.value), &heads);
            heads.push(head.clone());
            found.fixed.extend(stands(&term.value, &head));
            let mut own = term.value.clone();
            let values: Vec<(String, f64)> =
                numbers(&mut own).into_iter().map(|(part, value)| (part, *value)).collect();
            // The values of a table belong together, every other number stands for itself.
            let whole = term.value.kind().entry().form == Form::Curve;
            piece += usize::from(whole);
            for (number, (part, value)) in values.into_iter().enumerate() {
                let name = format!("{head}{part}");
                if value == 0.0 {
                    found.fixed.push(Fixed { name, reason: "is zero, and a relative change keeps it zero" });
                    continue;
                }
                piece += usize::from(!whole);
                found.moving.push(Coefficient {
                    motion: motion.motion,
                    place: [listed, place, number],
                    name,
                    value,
                    unit: words.unit(&term.value, number),
                    piece,
                    unit_term: unit_term(&term.value, number),
                });
            }
        }
    }
    found
}

/// Writes a value to a coefficient's place.
pub(crate) fn set(calibration: &mut Calibration, coefficient: &Coefficient, value: f64) {
    let [listed, place, number] = coefficient.place;
    let motion = calibration.motions.get_mut(listed);
    let Some(term) = motion.and_then(|motion| motion.terms.get_mut(place)) else { return };
    let closed = is_closed(&term.value);
    if let Some((_, slot)) = numbers(&mut term.value).into_iter().nth(number) {
        *slot = value;
    }
    if closed {
        close(&mut term.value);
    }
}

/// Whether a term is a table that repeats, and whose ends, which are one place, have one value: it stays so.
fn is_closed(term: &CalibratedTerm) -> bool {
    matches!(term.core(), CalibratedTerm::Table { curve, .. } if curve.repeats && curve.meets())
}

/// Gives the last node of a table the value of the first.
fn close(term: &mut CalibratedTerm) {
    for (_, values) in term.linear_mut() {
        if let [first, .., last] = values {
            *last = *first;
        }
    }
}

/// The numbers in which the value of a term is linear, each with its name behind that of the term; none for terms that no
/// point of a part shows. The last node of a table that repeats is its first one.
fn numbers(term: &mut CalibratedTerm) -> Vec<(String, &mut f64)> {
    let entry = term.kind().entry();
    if unseen(term).is_some() {
        return Vec::new();
    }
    let first = term.kind().first_power();
    let twice = usize::from(is_closed(term));
    let lists = term.linear_mut().into_iter().flat_map(|(key, values)| {
        let key = entry.key(key);
        // What is the value of the term itself needs no name.
        let word = key.filter(|key| key.role != Role::Value).map(|key| format!(".{}", key.name));
        let is_list = key.is_some_and(|key| key.holds == Holds::Numbers);
        let word = word.unwrap_or_default();
        let own = values.len().saturating_sub(twice);
        values.iter_mut().take(own).enumerate().map(move |(k, value)| {
            let name = if is_list { format!("{word}[{}]", first + k) } else { word.clone() };
            (name, value)
        })
    });
    lists.collect()
}

/// Why no point of a part shows a term; nothing where one does.
fn unseen(term: &CalibratedTerm) -> Option<&'static str> {
    term.states().find_map(|(state, _)| unseen_state(state))
}

/// Why no point of a part shows what depends on this; nothing where one does.
fn unseen_state(state: State) -> Option<&'static str> {
    match state {
        State::Velocity | State::Acceleration => Some("is left out, because points are measured at rest"),
        State::Reversal | State::Time | State::Load => {
            Some("is left out: only a recording over time shows it (see abbe diagnose)")
        }
        // What a product depends on, its factors say.
        State::Nothing
        | State::Position
        | State::OtherPosition
        | State::Direction
        | State::Temperature
        | State::Factors => None,
    }
}

fn unit_term(term: &CalibratedTerm, number: usize) -> CalibratedTerm {
    let mut unit = term.clone();
    for (place, (_, value)) in numbers(&mut unit).into_iter().enumerate() {
        *value = if place == number { 1.0 } else { 0.0 };
    }
    if is_closed(term) {
        close(&mut unit);
    }
    unit
}

/// The numbers of a term that are not moved.
fn stands(term: &CalibratedTerm, head: &str) -> Vec<Fixed> {
    let entry = term.kind().entry();
    if let Some(reason) = unseen(term) {
        return vec![Fixed { name: head.to_owned(), reason }];
    }
    let shapes = entry.keys.iter().filter(|key| key.role == Role::Shape).filter(|key| {
        // A number that may be left out says nothing at 0.
        let optional = matches!(key.given, Given::Optional(_));
        term.part(key.name).is_some_and(|part| !(optional && part == Part::Number(0.0)))
    });
    let reason = "changes the shape of its term, which is not linear in it";
    shapes.map(|key| Fixed { name: format!("{head}.{}", key.name), reason }).collect()
}

/// What coefficients are named against.
struct Words<'w> {
    names: &'w MachineNames,
    calibration: &'w Calibration,
    motion: usize,
}

impl Words<'_> {
    /// `EXX.polynomial`, with the sensor or another axis in brackets: `EBX.polynomial(body)`.
    fn head(&self, term: &CalibratedTerm) -> String {
        let motion = self.names.motions.get(self.motion);
        let own = motion.and_then(|motion| motion.axis.as_deref()).and_then(|letter| self.names.axis(letter));
        let sensor = term.sensor().and_then(|sensor| self.calibration.sensors.iter().nth(sensor));
        let of = match (sensor, term.axis()) {
            (Some(sensor), _) => format!("({})", sensor.name.value),
            (None, Some(axis)) if Some(axis) != own => {
                format!("({})", self.names.axes.get(axis).map_or("?", |axis| &axis.letter))
            }
            _ => String::new(),
        };
        let sensors = &self.calibration.sensors;
        let factors = term.factors().iter().map(|factor| format!("*{}", factor.label(self.names, sensors)));
        let factors: String = factors.collect();
        format!("{}.{}{of}{factors}", motion.map_or("?", |motion| &motion.name), term.name())
    }

    fn unit(&self, term: &CalibratedTerm, number: usize) -> String {
        if !term.factors().is_empty() {
            return self.scaled_unit(term, number);
        }
        let angular = self.names.motions.get(self.motion).is_some_and(|motion| motion.angular);
        let unit = if angular { "rad" } else { "mm" };
        let rotary = |axis: usize| self.names.axes.get(axis).is_some_and(|axis| axis.rotary);
        let axis = term.axis().map_or("mm", |axis| if rotary(axis) { "rad" } else { "mm" });
        let entry = term.kind().entry();
        let (linear, of_axis) =
            (entry.keys.iter().find(|key| key.role == Role::Linear), term.sensor().is_none());
        match entry.form {
            Form::Powers { first } => {
                per(unit, if of_axis { axis } else { "K" }, usize::from(first) + number)
            }
            Form::Curve => unit.to_owned(),
            Form::Plain => {
                let bases = linear.and_then(Key::kind).map_or(&[] as &[Base], |kind| kind.per);
                let of = |base: &Base| if *base == Base::Position { axis } else { "K" };
                bases.iter().fold(unit.to_owned(), |unit, base| per(&unit, of(base), 1))
            }
        }
    }

    /// The unit of a number of a term with factors, which make it one of the error motion.
    fn scaled_unit(&self, term: &CalibratedTerm, number: usize) -> String {
        let motion = self.names.motions.get(self.motion).map_or(Dimension::LENGTH, MotionName::dimension);
        let own = motion.per(dimension_of(term.factors(), self.names));
        let entry = term.kind().entry();
        let of_input = match term.axis() {
            Some(axis) if term.sensor().is_none() => self.names.axis_dimension(axis),
            _ => Dimension::TEMPERATURE,
        };
        let below = match entry.form {
            Form::Powers { first } => {
                of_input.power(i8::try_from(usize::from(first) + number).unwrap_or(i8::MAX))
            }
            Form::Curve => Dimension::NONE,
            Form::Plain => {
                let bases = entry.keys.iter().find(|key| key.role == Role::Linear).and_then(Key::kind);
                let of = |base: &Base| match base {
                    Base::Position => of_input,
                    _ => Dimension::TEMPERATURE,
                };
                bases
                    .map_or(&[] as &[Base], |kind| kind.per)
                    .iter()
                    .map(of)
                    .fold(Dimension::NONE, Dimension::times)
            }
        };
        own.per(below).internal_unit()
    }
}

fn per(unit: &str, of: &str, power: usize) -> String {
    match power {
        0 => unit.to_owned(),
        1 => format!("{unit}/{of}"),
        _ => format!("{unit}/{of}^{power}"),
    }
}

/// A second term of the same name in one motion is told by its number.
fn unlike(head: String, heads: &[String]) -> String {
    let alike =
        heads.iter().filter(|known| **known == head || known.starts_with(&format!("{head}#"))).count();
    if alike == 0 { head } else { format!("{head}#{}", alike + 1) }
}
