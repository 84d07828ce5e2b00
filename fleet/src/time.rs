//! When a recording was made, where its file does not say so. In: a pattern of names, and names. Out: a moment.

use recording::Moment;

/// A pattern such as `YYYY-MM-DD_hhmmss`: the letters stand for digits of the date and the time, all else for itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    parts: Vec<Part>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// So many digits of one of year, month, day, hour, minute, second.
    Digits {
        of: usize,
        count: usize,
    },
    Letter(char),
}

/// Each number with the letters that stand for it.
const NUMBERS: [&str; 6] = ["YYYY", "MM", "DD", "hh", "mm", "ss"];

/// A date needs the first three of them.
const NEEDED: usize = 3;

impl Pattern {
    /// Reads a pattern; what is wrong with it where it gives no date.
    pub fn read(text: &str) -> Result<Self, String> {
        let (mut parts, mut seen, mut rest) = (Vec::new(), [false; NUMBERS.len()], text);
        while let Some(letter) = rest.chars().next() {
            let number = NUMBERS.iter().enumerate().find(|(_, name)| rest.starts_with(**name));
            let length = match number {
                Some((of, name)) => {
                    if seen.get(of) == Some(&true) {
                        return Err(format!("`{name}` occurs twice in it"));
                    }
                    if let Some(seen) = seen.get_mut(of) {
                        *seen = true;
                    }
                    parts.push(Part::Digits { of, count: name.len() });
                    name.len()
                }
                None => {
                    parts.push(Part::Letter(letter));
                    letter.len_utf8()
                }
            };
            rest = rest.get(length..).unwrap_or_default();
        }
        let missing = NUMBERS.iter().zip(seen).take(NEEDED).find(|(_, seen)| !seen);
        missing.map_or(Ok(Self { parts }), |(name, _)| Err(format!("`{name}` is missing in it")))
    }

    /// The moment that a name tells: at the last place at which the pattern fits and is a date, since folders stand before files.
    pub fn find(&self, name: &str) -> Option<Moment> {
        name.char_indices().rev().find_map(|(place, _)| self.at(name.get(place..)?))
    }

    fn at(&self, text: &str) -> Option<Moment> {
        let (mut numbers, mut rest) = ([0; NUMBERS.len()], text);
        for part in &self.parts {
            rest = match *part {
                Part::Letter(letter) => rest.strip_prefix(letter)?,
                Part::Digits { of, count } => {
                    let digits = rest
                        .get(..count)
                        .filter(|digits| digits.bytes().all(|digit| digit.is_ascii_digit()))?;
                    *numbers.get_mut(of)? = digits.parse().ok()?;
                    rest.get(count..)?
                }
            };
        }
        let [year, month, day, hour, minute, second] = numbers;
        Moment::of([year, month, day], [hour, minute, second])
    }
}

#[cfg(test)]
mod tests {
    use super::Pattern;

    #[test]
    fn names_tell_when_they_were_written() {
        let found =
            |pattern, name| Pattern::read(pattern).unwrap().find(name).map(|moment| moment.to_string());
        let night = "2026-07-09T22:59:28";
        assert_eq!(
            found("YYYY-MM-DD_hhmmss", "fleet/2026-07-09_225928/recording.yaml").as_deref(),
            Some(night)
        );
        assert_eq!(found("DD.MM.YYYY", "mill 09.07.2026.yaml").as_deref(), Some("2026-07-09T00:00:00"));
        assert_eq!(found("YYYYMMDD", "2025/20260709-3.yaml").as_deref(), Some("2026-07-09T00:00:00"));
        // Eight digits in a row that are no date are passed over.
        assert_eq!(found("YYYYMMDD", "20260709/99999999.yaml").as_deref(), Some("2026-07-09T00:00:00"));
        assert_eq!(found("YYYY-MM-DD", "machine.yaml"), None);
    }

    #[test]
    fn a_pattern_without_a_date_is_refused() {
        assert_eq!(Pattern::read("YYYY-MM").unwrap_err(), "`DD` is missing in it");
        assert_eq!(Pattern::read("YYYY-MM-DD-DD").unwrap_err(), "`DD` occurs twice in it");
        assert!(Pattern::read("").is_err());
    }
}
