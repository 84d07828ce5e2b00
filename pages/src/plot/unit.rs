//! Units of axes. In: the unit of numbers and how large they are. Out: the unit in which a reader takes them in, and the
//! factor to it.

/// A unit that an axis shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// The shown number for 1 of the given unit.
    pub factor: f64,
    /// The name as it is shown: `µm`.
    pub name: String,
}

impl Unit {
    /// The unit for numbers up to `size` that are given in `unit` (`mm`, `rad`, `deg`, `s`, `mm/s`, `rad/s`, `degC`; others stay).
    pub fn of(unit: &str, size: f64) -> Self {
        let (factor, name) = match unit {
            "mm" if size < 1e-4 => (1e6, "nm"),
            "mm" if size < 1.0 => (1e3, "µm"),
            "rad" if size < 0.01 => (180.0 * 3600.0 / std::f64::consts::PI, "arcsec"),
            "rad" => (180.0 / std::f64::consts::PI, "°"),
            "deg" if size < 0.5 => (3600.0, "arcsec"),
            "deg" => (1.0, "°"),
            "mm/s" if size < 0.1 => (1e3, "µm/s"),
            "rad/s" if size < 0.01 => (180.0 * 3600.0 / std::f64::consts::PI, "arcsec/s"),
            "rad/s" => (180.0 / std::f64::consts::PI, "°/s"),
            "s" if size < 0.5 => (1e3, "ms"),
            "s" if size >= 14_400.0 => (1.0 / 3600.0, "h"),
            "s" if size >= 600.0 => (1.0 / 60.0, "min"),
            other => return Self::exactly(other),
        };
        Self { factor, name: name.to_owned() }
    }

    /// The unit itself, its letters as people write them.
    pub fn exactly(unit: &str) -> Self {
        let name = match unit {
            "deg" => "°",
            "degC" => "°C",
            "um" => "µm",
            "um/m" => "µm/m",
            other => other,
        };
        Self { factor: 1.0, name: name.to_owned() }
    }

    /// A number of the given unit, in this one, with so many significant digits.
    pub fn text(&self, value: f64, digits: i32) -> String {
        let shown = value * self.factor;
        if !shown.is_finite() {
            return "not known".to_owned();
        }
        let first = if shown == 0.0 { 0.0 } else { shown.abs().log10().floor() };
        self.named(super::ticks::text(shown, f64::from(digits) - 1.0 - first))
    }

    /// A number that somebody chose: four significant digits, without zeros at its end.
    pub fn given(&self, value: f64) -> String {
        let shown = value * self.factor;
        if !shown.is_finite() {
            return "not known".to_owned();
        }
        let first = if shown == 0.0 { 0.0 } else { shown.abs().log10().floor() };
        let text = super::ticks::text(shown, 3.0 - first);
        let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        self.named(short.to_owned())
    }

    fn named(&self, number: String) -> String {
        if self.name.is_empty() { number } else { format!("{number} {}", self.name) }
    }
}

#[cfg(test)]
mod tests {
    use super::Unit;

    #[test]
    fn small_lengths_are_micrometres_and_small_angles_arcseconds() {
        assert_eq!(Unit::of("mm", 0.0123).text(0.0123, 3), "12.3 µm");
        assert_eq!(Unit::of("mm", 250.0).text(250.0, 3), "250 mm");
        // 1 arcsec = pi / 648 000 rad.
        assert_eq!(Unit::of("rad", 1e-4).text(std::f64::consts::PI / 648_000.0, 2), "1.0 arcsec");
        assert_eq!(Unit::of("s", 7200.0).text(7200.0, 3), "120 min");
        assert_eq!(Unit::of("N", 0.001).name, "N");
        assert_eq!([150.0, 99.75].map(|radius| Unit::exactly("mm").given(radius)), ["150 mm", "99.75 mm"]);
    }
}
