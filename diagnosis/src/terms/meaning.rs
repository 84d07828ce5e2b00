//! What the terms are, physically. In: a term's name in calibration files. Out: the sentences that a report says of it, so
//! that whoever explains the vocabulary says the same.

use model_dsl::calibration::TermKind;

use super::{
    acceleration, backlash, coupling, cyclic, delay, drift, expansion, factor, growth, lag, load, polynomial,
    reversal_spike, step, table, vibration,
};

/// What a constant is, physically.
pub(super) const CONSTANT: &str = "An alignment: an axis that is not square to the others, or a body at an angle. It does not \
    change while the machine runs.";

/// What a term is physically, and how large it may well be: the words of the reports. `None` for a name that is no term of
/// calibration files. A `polynomial` is one of positions; one of a temperature has the physics of `growth`.
pub fn meaning(term: &str) -> Option<&'static str> {
    let words = match TermKind::of_name(term)? {
        TermKind::Constant => CONSTANT,
        TermKind::Polynomial => polynomial::MEANING,
        TermKind::Table => table::MEANING,
        TermKind::Backlash => backlash::MEANING,
        TermKind::ReversalSpike => reversal_spike::MEANING,
        TermKind::Cyclic => cyclic::MEANING,
        TermKind::Lag => lag::MEANING,
        TermKind::Acceleration => acceleration::MEANING,
        TermKind::Expansion => expansion::MEANING,
        TermKind::Growth => growth::MEANING,
        TermKind::Drift => drift::MEANING,
        TermKind::Vibration => vibration::MEANING,
        TermKind::Coupling => coupling::MEANING,
        TermKind::Compliance => load::MEANING,
        TermKind::Delay => delay::MEANING,
        TermKind::Step => step::MEANING,
        TermKind::Product => factor::MEANING,
    };
    Some(words)
}

#[cfg(test)]
mod tests {
    use model_dsl::calibration::{Factor, TERM_NAMES};

    use super::meaning;
    use crate::terms::Shape;

    #[test]
    fn every_term_of_the_vocabulary_has_a_meaning() {
        for name in TERM_NAMES {
            assert!(meaning(name).is_some_and(|words| words.ends_with('.')), "{name}");
        }
        assert_eq!(meaning("eccentricity"), None);
    }

    #[test]
    fn a_report_says_the_same() {
        let shapes = [
            Shape::Constant,
            Shape::Polynomial { axis: 0, degree: 1, center: 0.0, scale: 1.0 },
            Shape::Table { axis: 0, nodes: vec![0.0, 1.0], directed: false, repeats: false },
            Shape::Backlash { axis: 0, wind_up: 0.0 },
            Shape::ReversalSpike { axis: 0, decay: 1.0 },
            Shape::Cyclic { axis: 0, period: 1.0, order: 1, center: 0.0 },
            Shape::Lag { axis: 0, inertia: 0.0 },
            Shape::Acceleration { axis: 0 },
            Shape::Expansion { axis: 0, sensor: 0, reference: 20.0 },
            Shape::Growth { sensor: 0, reference: 20.0, time_constant: 0.0 },
            Shape::Drift { time_constant: 1.0 },
            Shape::Vibration { frequency: 1.0 },
            Shape::Coupling { axis: 1, degree: 1, scale: 1.0 },
            Shape::Compliance { load: 0 },
            Shape::Delay { axis: 0, time: 0.01 },
            Shape::Step { time: 1.0 },
            Shape::Times { core: Box::new(Shape::Constant), factors: vec![Factor::Direction { axis: 0 }] },
        ];
        for shape in shapes {
            assert_eq!(meaning(shape.name()), Some(shape.meaning()), "{}", shape.name());
        }
    }
}
