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
    /// The centre of a ballbar in one run against that of all, in one direction, mm, where runs do not repeat.
    RunEccentricity { direction: usize, run: i64 },
}

impl Setting {
    /// Whether it is of one run alone.
    pub(crate) fn of_a_run(self) -> bool {
        matches!(self, Self::RunOffset { .. } | Self::RunEccentricity { .. })
    }

    /// The setting's name in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Eccentricity { .. } | Self::RunEccentricity { .. } => "eccentricity",
            Self::Radius => "radius",
            Self::Cosine => "cosine",
            Self::Clock => "clock",
            Self::Offset { .. } | Self::RunOffset { .. } => "offset",
        }
    }
}
