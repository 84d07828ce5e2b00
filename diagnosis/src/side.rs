//! Sides: where, seen from the drive's own feedback, an effect comes in. In: nothing. Out: the three sides, and what a drive and its
//! position loop have to do with each. Terms and models both speak of them.

/// On which side of the drive's own feedback an effect comes in.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Side {
    /// Inside the position loop of an axis, which answers it as it answers its command; the drive's feedback shows what
    /// remains.
    Loop {
        /// The number of the axis.
        axis: usize,
    },
    /// The drive's feedback shows it too.
    Drive,
    /// Only an instrument outside shows it.
    After,
}

impl Side {
    /// Whether the drive's own feedback shows it.
    pub(crate) fn at_drive(self) -> bool {
        self != Self::After
    }

    /// The axis whose position loop answers it.
    pub(crate) fn answered_by(self) -> Option<usize> {
        match self {
            Self::Loop { axis } => Some(axis),
            Self::Drive | Self::After => None,
        }
    }
}
