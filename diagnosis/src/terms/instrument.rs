//! Settings of the instrument: of the recording and not of the machine. They are always candidates, and never
//! compensated. What they do to a reading stands with the reading, in `observations`.

/// A setting of the instrument. Directions are 0, 1, 2 for X, Y, Z of the part's frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Setting {
    /// True centre minus declared centre in one direction, mm.
    Eccentricity { direction: usize },
    /// True radius of the instrument minus declared radius, mm.
    Radius,
    /// Half the square of the angle between beam and motion.
    Cosine,
    /// `measured(t)` shows the state at t - offset, s.
    Clock,
    /// The zero of one channel.
    Offset { channel: usize },
    /// The zero of one channel in one run, where runs do not repeat.
    RunOffset { channel: usize, run: i64 },
}

impl Setting {
    /// The setting's name in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Eccentricity { .. } => "eccentricity",
            Self::Radius => "radius",
            Self::Cosine => "cosine",
            Self::Clock => "clock",
            Self::Offset { .. } | Self::RunOffset { .. } => "offset",
        }
    }
}
