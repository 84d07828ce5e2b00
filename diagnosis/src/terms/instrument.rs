//! Settings of the instrument: of the recording and not of the machine. They are always candidates, and never
//! compensated. What they do to a reading stands with the reading, in `observations`.

use super::plausible::Range;

/// The plausible cosine error, half the square of the angle: a beam that is set up by eye stands within two degrees.
pub(super) const COSINE: Range = (0.0, 6.1e-4);

/// A setting of the instrument by its name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum SettingKind {
    /// The centre of the circle.
    Eccentricity,
    /// The length of the bar.
    Radius,
    /// The angle of the beam.
    Cosine,
    /// The time of the readings.
    Clock,
    /// How the part lies.
    Datum,
    /// The zero.
    Offset,
}

impl SettingKind {
    const ALL: [Self; 6] =
        [Self::Eccentricity, Self::Radius, Self::Cosine, Self::Clock, Self::Datum, Self::Offset];

    /// The name in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Eccentricity => "eccentricity",
            Self::Radius => "radius",
            Self::Cosine => "cosine",
            Self::Clock => "clock",
            Self::Datum => "datum",
            Self::Offset => "offset",
        }
    }

    /// The setting of a name.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Whether it is physics that was left out, and no matter of putting the instrument in its place.
    pub(crate) fn is_physics(self) -> bool {
        matches!(self, Self::Cosine | Self::Clock)
    }
}

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
    /// How the part lies where it was measured, where that is free: displaced along one direction, mm, beside the zeros of channels.
    Displacement { direction: usize },
    /// The same, turned about one direction, rad: beside how the readings alone have it.
    Rotation { direction: usize },
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

    /// Whether it adds to a reading what it does times its size, whatever the size. Others act exactly.
    pub(crate) fn adds(self) -> bool {
        self.of_a_run()
            || matches!(
                self,
                Self::Offset { .. } | Self::Cosine | Self::Displacement { .. } | Self::Rotation { .. }
            )
    }

    /// Which setting it is.
    pub(crate) fn kind(self) -> SettingKind {
        match self {
            Self::Eccentricity { .. } | Self::RunEccentricity { .. } => SettingKind::Eccentricity,
            Self::Radius => SettingKind::Radius,
            Self::Cosine => SettingKind::Cosine,
            Self::Clock => SettingKind::Clock,
            Self::Displacement { .. } | Self::Rotation { .. } => SettingKind::Datum,
            Self::Offset { .. } | Self::RunOffset { .. } => SettingKind::Offset,
        }
    }

    /// The setting's name in reports.
    pub(crate) fn name(self) -> &'static str {
        self.kind().name()
    }
}
