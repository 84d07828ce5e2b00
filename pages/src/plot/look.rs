//! Looks: how one series is told from another. In: a number or a tone. Out: a colour, a dash and a mark, no two alike.

/// A colour of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// First colour of series.
    One,
    /// Second.
    Two,
    /// Third.
    Three,
    /// Fourth.
    Four,
    /// That of letters.
    Ink,
    /// That of what stands back.
    Quiet,
}

impl Tone {
    pub(super) fn class(self) -> &'static str {
        match self {
            Self::One => "c1",
            Self::Two => "c2",
            Self::Three => "c3",
            Self::Four => "c4",
            Self::Ink => "ci",
            Self::Quiet => "cq",
        }
    }
}

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Circle,
    Square,
    Triangle,
    Diamond,
    Plus,
    Cross,
}

impl Mark {
    /// From the place of the mark to where its stroke begins, and the stroke.
    pub(super) fn stroke(self) -> (f64, f64, &'static str) {
        match self {
            // All but a tenth of a pixel of it, which closes it: half as long as two arcs.
            Self::Circle => (0.0, -1.8, "a1.8 1.8 0 1 0 .1 0z"),
            Self::Square => (-1.6, -1.6, "h3.2v3.2h-3.2z"),
            Self::Triangle => (0.0, -2.2, "l2.1 3.8h-4.2z"),
            Self::Diamond => (0.0, -2.5, "l2.2 2.5-2.2 2.5-2.2-2.5z"),
            Self::Plus => (-2.3, 0.0, "h4.6m-2.3-2.3v4.6"),
            Self::Cross => (-1.9, -1.9, "l3.8 3.8m0-3.8l-3.8 3.8"),
        }
    }

    /// Whether it encloses something that can be filled.
    pub(super) fn closed(self) -> bool {
        !matches!(self, Self::Plus | Self::Cross)
    }
}

/// Colour, dash and mark of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    pub(super) tone: Tone,
    pub(super) dash: &'static str,
    pub(super) mark: Mark,
}

impl Look {
    /// The look of the series with this number, from 0 on; eight differ in all, and in dash and mark without colour too.
    pub fn of(number: usize) -> Self {
        let (tone, dash, mark) = LOOKS[number % LOOKS.len()];
        Self { tone, dash, mark }
    }

    /// The same dash and mark in another tone.
    pub fn toned(self, tone: Tone) -> Self {
        Self { tone, ..self }
    }
}

const LOOKS: [(Tone, &str, Mark); 8] = [
    (Tone::One, "", Mark::Circle),
    (Tone::Two, "5 3", Mark::Triangle),
    (Tone::Three, "1.5 2.5", Mark::Square),
    (Tone::Four, "8 3 1.5 3", Mark::Diamond),
    (Tone::Ink, "3 2", Mark::Plus),
    (Tone::Quiet, "10 4", Mark::Cross),
    (Tone::One, "8 2 1.5 2 1.5 2", Mark::Square),
    (Tone::Two, "1.5 4", Mark::Diamond),
];

#[cfg(test)]
mod tests {
    use super::{LOOKS, Look};

    #[test]
    fn no_two_looks_are_alike_in_black_and_white() {
        for (number, one) in LOOKS.iter().enumerate() {
            assert!(LOOKS[..number].iter().all(|other| other.1 != one.1), "dash of {number}");
            assert!(
                LOOKS[..number].iter().all(|other| (other.0, other.2) != (one.0, one.2)),
                "mark of {number}"
            );
        }
        assert_eq!(Look::of(8), Look::of(0));
    }
}
