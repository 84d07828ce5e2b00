//! Kinds of effects that are injected. In: nothing. Out: each term of the vocabulary that an exact machine shows alone, and a play that
//! winds up apart from one that jumps.

use model_dsl::calibration::TermKind;

/// A kind of effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A term of the vocabulary.
    Term(TermKind),
    /// A backlash that is taken up over some way.
    WindUp,
}

impl Kind {
    /// All of them, in the order in which they are told.
    pub const ALL: [Self; 15] = [
        Self::Term(TermKind::Constant),
        Self::Term(TermKind::Polynomial),
        Self::Term(TermKind::Table),
        Self::Term(TermKind::Backlash),
        Self::WindUp,
        Self::Term(TermKind::ReversalSpike),
        Self::Term(TermKind::Cyclic),
        Self::Term(TermKind::Lag),
        Self::Term(TermKind::Acceleration),
        Self::Term(TermKind::Expansion),
        Self::Term(TermKind::Growth),
        Self::Term(TermKind::Drift),
        Self::Term(TermKind::Vibration),
        Self::Term(TermKind::Coupling),
        Self::Term(TermKind::Compliance),
    ];

    /// Its term.
    pub fn term(self) -> TermKind {
        match self {
            Self::Term(term) => term,
            Self::WindUp => TermKind::Backlash,
        }
    }

    /// Whether it is a wave, of which another one has a period of its own.
    pub fn is_wave(self) -> bool {
        matches!(self.term(), TermKind::Cyclic | TermKind::Vibration)
    }

    /// Whether any motion of an axis may have it; the others belong to its position.
    pub fn is_of_any_motion(self) -> bool {
        let any = [TermKind::Polynomial, TermKind::Table, TermKind::Backlash, TermKind::Cyclic];
        self != Self::WindUp && any.contains(&self.term())
    }

    /// Its name: that of the term, or `wind-up`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Term(term) => term.name(),
            Self::WindUp => "wind-up",
        }
    }

    /// The kind of a name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// All names.
    pub fn names() -> [&'static str; 15] {
        Self::ALL.map(Self::name)
    }
}
