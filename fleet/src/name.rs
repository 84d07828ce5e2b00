//! Names of effects. In: motion, term and what it reads, and of a wave its period. Out: the name under which it is followed, and the same
//! parts of a name that was read.

/// What an effect is called: `EXX cyclic axis=X 10.02 mm`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Name {
    /// Motion, term, and what it reads: `EXX cyclic axis=X`.
    pub(crate) family: String,
    /// Of a wave along an axis its period, of one in time its frequency, in the unit of the name.
    pub(crate) period: Option<f64>,
}

/// Waves are one screw's where their periods lie within this share: screws of one catalogue have theirs to far less, and the next wave is
/// a harmonic.
const SAME_PERIOD: f64 = 0.05;

impl Name {
    /// The parts of a name.
    pub(crate) fn of(effect: &str) -> Self {
        let words: Vec<&str> = effect.split(' ').collect();
        let parts = words.len().checked_sub(2).and_then(|place| words.split_at_checked(place));
        let period = parts.and_then(|(before, last)| Some((before, last.first()?.parse().ok()?)));
        match period {
            Some((family, period)) => Self { family: family.join(" "), period: Some(period) },
            None => Self { family: effect.to_owned(), period: None },
        }
    }

    /// The name of a wave, its period rounded to as many digits as half of its interval leaves.
    pub(crate) fn of_wave(family: &str, (value, half): (f64, f64), unit: &str) -> String {
        let digits = (-(half.max(value.abs() * 1e-6)).log10()).ceil().clamp(0.0, 6.0);
        let scale = 10_f64.powf(digits);
        format!("{family} {} {unit}", (value * scale).round() / scale)
    }

    /// Whether another one is of the same cause: waves of two machines, or of one before and after a screw was changed, have periods that
    /// are nearly the same.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        self.family == other.family
            && match (self.period, other.period) {
                (Some(one), Some(two)) => (one - two).abs() <= SAME_PERIOD * one.abs().max(two.abs()),
                (None, None) => true,
                _ => false,
            }
    }
}

#[cfg(test)]
mod tests {
    use super::Name;

    #[test]
    fn a_name_gives_its_parts_again() {
        let wave = Name::of_wave("EXX cyclic axis=X", (9.997_12, 0.003), "mm");
        assert_eq!(wave, "EXX cyclic axis=X 9.997 mm");
        assert_eq!(Name::of(&wave), Name { family: "EXX cyclic axis=X".to_owned(), period: Some(9.997) });
        let plain = "EXX backlash axis=X";
        assert_eq!(Name::of(plain), Name { family: plain.to_owned(), period: None });
        assert_eq!(Name::of("noise").family, "noise");
        assert_eq!(Name::of_wave("EXX cyclic", (250.4, 3.0), "mm"), "EXX cyclic 250 mm");
    }

    #[test]
    fn waves_are_alike_by_their_periods() {
        let like = |one: &str, two: &str| Name::of(one).is_like(&Name::of(two));
        assert!(like("EXX cyclic axis=X 10 mm", "EXX cyclic axis=X 10.02 mm"));
        assert!(!like("EXX cyclic axis=X 10 mm", "EXX cyclic axis=X 5 mm"));
        assert!(!like("EXX cyclic axis=X 10 mm", "EYY cyclic axis=Y 10 mm"));
        assert!(!like("EXX cyclic axis=X 10 mm", "EXX cyclic axis=X"));
    }
}
