//! Where an axis is. In: what a recording knows of the axis. Out: the one position that stands for it, at which terms and
//! lever arms are taken.

use std::borrow::Cow;

use super::AxisChannels;

impl AxisChannels {
    /// The position that stands for the axis, where anything is known of it: the programmed one; the drive's own feedback
    /// where nothing was programmed; what the instrument has where there is neither.
    ///
    /// A whole column is taken, and never a sample of another one: where the command of a row is missing, so is the
    /// position, since a step from command to feedback would be a motion that there was none of.
    pub fn position(&self) -> Option<&[f64]> {
        let known = self.command.as_ref().or(self.actual.as_ref()).or(self.measured.as_ref());
        known.map(Vec::as_slice)
    }

    /// The same in a recording of so many rows; an axis of which nothing is known stands at zero.
    pub fn position_or_zero(&self, rows: usize) -> Cow<'_, [f64]> {
        self.position().map_or_else(|| vec![0.0; rows].into(), Cow::Borrowed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(command: Option<f64>, actual: Option<f64>, measured: Option<f64>) -> AxisChannels {
        let column = |value: Option<f64>| value.map(|value| vec![value, value]);
        AxisChannels { command: column(command), actual: column(actual), measured: column(measured) }
    }

    #[test]
    fn the_program_comes_before_the_drive_and_the_drive_before_the_instrument() {
        let (programmed, fed_back, seen) = (Some(10.0), Some(20.0), Some(30.0));
        for (known, stands_for_it) in [
            (axis(programmed, fed_back, seen), programmed),
            (axis(programmed, fed_back, None), programmed),
            (axis(programmed, None, seen), programmed),
            (axis(programmed, None, None), programmed),
            (axis(None, fed_back, seen), fed_back),
            (axis(None, fed_back, None), fed_back),
            (axis(None, None, seen), seen),
            (axis(None, None, None), None),
        ] {
            let column = stands_for_it.map(|value| vec![value, value]);
            assert_eq!(known.position(), column.as_deref());
            assert_eq!(*known.position_or_zero(2), column.unwrap_or(vec![0.0, 0.0]));
        }
    }

    #[test]
    fn a_missing_command_is_not_filled_in_from_the_drive() {
        let mut axis = axis(Some(10.0), Some(20.0), None);
        axis.command = Some(vec![f64::NAN, 11.0]);
        let position = axis.position().map(|column| column.to_vec()).unwrap_or_default();
        assert!(position[0].is_nan());
        assert_eq!(position[1], 11.0);
    }

    #[test]
    fn an_unknown_axis_stands_at_zero_in_every_row() {
        assert_eq!(*AxisChannels::default().position_or_zero(3), [0.0; 3]);
        assert!(AxisChannels::default().position_or_zero(0).is_empty());
    }
}
