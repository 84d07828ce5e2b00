//! Kinds of quantities, as exponents of a few base kinds, and their names for messages.

/// The exponents of the base kinds that a quantity is made of: a length per temperature is length 1, temperature -1.
///
/// Angles count as a base kind, so that `10 urad` is never taken for a length ratio; a percentage and a count are base
/// kinds because they measure loads.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct Dimension {
    /// Exponent of length, unit mm.
    pub length: i8,
    /// Exponent of angle, unit rad.
    pub angle: i8,
    /// Exponent of time, unit s.
    pub time: i8,
    /// Exponent of temperature, unit degC (or K, the same step).
    pub temperature: i8,
    /// Exponent of force, unit N.
    pub force: i8,
    /// Exponent of voltage, unit V.
    pub voltage: i8,
    /// Exponent of current, unit A.
    pub current: i8,
    /// Exponent of percent, unit %.
    pub percent: i8,
    /// Exponent of counts, unit count.
    pub count: i8,
}

/// Name and unit of each base kind, in the order of [`Dimension::exponents`].
const BASES: [(&str, &str); 9] = [
    ("length", "mm"),
    ("angle", "rad"),
    ("time", "s"),
    ("temperature", "K"),
    ("force", "N"),
    ("voltage", "V"),
    ("current", "A"),
    ("percentage", "%"),
    ("count", "count"),
];

impl Dimension {
    /// A pure number or a ratio of equals.
    pub const NONE: Self = Self {
        length: 0,
        angle: 0,
        time: 0,
        temperature: 0,
        force: 0,
        voltage: 0,
        current: 0,
        percent: 0,
        count: 0,
    };
    /// A length, in mm.
    pub const LENGTH: Self = Self { length: 1, ..Self::NONE };
    /// An angle, in rad.
    pub const ANGLE: Self = Self { angle: 1, ..Self::NONE };
    /// A time, in s.
    pub const TIME: Self = Self { time: 1, ..Self::NONE };
    /// A temperature, in degC.
    pub const TEMPERATURE: Self = Self { temperature: 1, ..Self::NONE };
    /// A force, in N.
    pub const FORCE: Self = Self { force: 1, ..Self::NONE };
    /// A voltage, in V.
    pub const VOLTAGE: Self = Self { voltage: 1, ..Self::NONE };
    /// A current, in A.
    pub const CURRENT: Self = Self { current: 1, ..Self::NONE };
    /// A percentage, in %.
    pub const PERCENT: Self = Self { percent: 1, ..Self::NONE };
    /// A count of an encoder or converter.
    pub const COUNT: Self = Self { count: 1, ..Self::NONE };
    /// A frequency or a loop gain, in 1/s.
    pub const FREQUENCY: Self = Self { time: -1, ..Self::NONE };

    fn exponents(self) -> [i8; 9] {
        [
            self.length,
            self.angle,
            self.time,
            self.temperature,
            self.force,
            self.voltage,
            self.current,
            self.percent,
            self.count,
        ]
    }

    fn combine(self, other: Self, combine: impl Fn(i8, i8) -> i8) -> Self {
        Self {
            length: combine(self.length, other.length),
            angle: combine(self.angle, other.angle),
            time: combine(self.time, other.time),
            temperature: combine(self.temperature, other.temperature),
            force: combine(self.force, other.force),
            voltage: combine(self.voltage, other.voltage),
            current: combine(self.current, other.current),
            percent: combine(self.percent, other.percent),
            count: combine(self.count, other.count),
        }
    }

    /// The kind of a quotient: a length [`per`](Self::per) a temperature.
    #[must_use]
    pub fn per(self, divisor: Self) -> Self {
        self.combine(divisor, i8::saturating_sub)
    }

    /// The kind of a product: a length [`times`](Self::times) a temperature.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        self.combine(other, i8::saturating_add)
    }

    /// The kind with every load counted as a force, whatever a drive tells in its place.
    #[must_use]
    pub fn loads_as_forces(self) -> Self {
        let others = [self.voltage, self.current, self.percent, self.count];
        let force = others.into_iter().fold(self.force, i8::saturating_add);
        Self { force, voltage: 0, current: 0, percent: 0, count: 0, ..self }
    }

    /// The kind of a power.
    #[must_use]
    pub fn power(self, exponent: i8) -> Self {
        self.combine(Self::NONE, |own, _| own.saturating_mul(exponent))
    }

    /// Its name with an article: `a length`, `an angle`, `a length per temperature`, `a frequency`.
    pub fn name(self) -> String {
        if self == Self::FREQUENCY {
            return "a frequency".to_owned();
        }
        let above = self.named(1);
        let below = self.named(-1);
        let above = if above.is_empty() { "ratio".to_owned() } else { above.join(" ") };
        let article = if above.starts_with('a') { "an" } else { "a" };
        let per: String = below.iter().map(|base| format!(" per {base}")).collect();
        match (above.as_str(), below.is_empty()) {
            ("ratio", true) => "a plain number".to_owned(),
            _ => format!("{article} {above}{per}"),
        }
    }

    /// The base kinds whose exponent has the sign, `squared` and the like added.
    fn named(self, sign: i8) -> Vec<String> {
        let bases = BASES.iter().zip(self.exponents());
        let bases = bases.filter(|(_, exponent)| exponent.signum() == sign);
        let named = bases.map(|((name, _), exponent)| match exponent.unsigned_abs() {
            1 => (*name).to_owned(),
            2 => format!("{name} squared"),
            power => format!("{name} to the power of {power}"),
        });
        named.collect()
    }

    /// A unit of this kind that people use, for help lines: `mm`, `urad`, `um/m/K`.
    pub fn usual_unit(self) -> String {
        let per_kelvin = Self::NONE.per(Self::TEMPERATURE);
        let usual = [
            (Self::NONE, "um/m"),
            (Self::ANGLE, "urad"),
            (Self::TEMPERATURE, "degC"),
            (per_kelvin, "um/m/K"),
            (Self::LENGTH.per(Self::TEMPERATURE), "um/K"),
            (Self::ANGLE.per(Self::TEMPERATURE), "urad/K"),
            (Self::LENGTH.per(Self::FORCE), "um/N"),
            (Self::ANGLE.per(Self::FORCE), "urad/N"),
        ];
        let known = usual.iter().find(|(kind, _)| *kind == self);
        known.map_or_else(|| self.internal_unit(), |(_, unit)| (*unit).to_owned())
    }

    /// The unit in which values of this kind are kept: `mm`, `rad`, `mm/K`, `1/s`.
    pub fn internal_unit(self) -> String {
        let parts = |sign: i8| {
            let bases = BASES.iter().zip(self.exponents());
            let bases = bases.filter(move |(_, exponent)| exponent.signum() == sign);
            bases.flat_map(|((_, unit), exponent)| {
                std::iter::repeat_n(*unit, usize::from(exponent.unsigned_abs()))
            })
        };
        let above: Vec<_> = parts(1).collect();
        let above = if above.is_empty() { "1".to_owned() } else { above.join("*") };
        parts(-1).fold(above, |unit, base| format!("{unit}/{base}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_articles() {
        let name = Dimension::name;
        assert_eq!(name(Dimension::LENGTH), "a length");
        assert_eq!(name(Dimension::ANGLE), "an angle");
        assert_eq!(name(Dimension::NONE), "a plain number");
        assert_eq!(name(Dimension::FREQUENCY), "a frequency");
        assert_eq!(name(Dimension::TEMPERATURE), "a temperature");
        let per_kelvin = Dimension::NONE.per(Dimension::TEMPERATURE);
        assert_eq!(name(per_kelvin), "a ratio per temperature");
        let growth = Dimension::LENGTH.per(Dimension::TEMPERATURE);
        assert_eq!(name(growth), "a length per temperature");
        let acceleration = Dimension::LENGTH.per(Dimension::TIME.power(2));
        assert_eq!(name(acceleration), "a length per time squared");
    }

    #[test]
    fn units_are_those_people_use() {
        let unit = |kind: Dimension| (kind.usual_unit(), kind.internal_unit());
        let pair = |usual: &str, internal: &str| (usual.to_owned(), internal.to_owned());
        assert_eq!(unit(Dimension::LENGTH), pair("mm", "mm"));
        assert_eq!(unit(Dimension::ANGLE), pair("urad", "rad"));
        let growth = Dimension::LENGTH.per(Dimension::TEMPERATURE);
        assert_eq!(unit(growth), pair("um/K", "mm/K"));
        assert_eq!(unit(Dimension::FREQUENCY), pair("1/s", "1/s"));
        assert_eq!(unit(Dimension::TIME.power(-2)), pair("1/s/s", "1/s/s"));
    }
}
