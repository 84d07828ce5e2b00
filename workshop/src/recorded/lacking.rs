//! What a recording lacks. In: a recording that was read. Out: nothing, or an error at its channels that says what to add.
//!
//! It exists because a file can be well formed and still say nothing of the machine: readings without the positions that were programmed.

use model_dsl::diagnostic::Diagnostic;
use recording::Instrument;

use super::{Recorded, one};
use crate::failure::Failure;

/// The code of a recording that lacks what it measures, or what that is compared with.
const NOTHING_MEASURED: &str = "E0613";

impl Recorded {
    /// Checks that some channel gives the position of an axis. The circle of a ballbar and the targets of a laser are known from nothing
    /// else. A machine that stands still while temperatures or loads change needs no positions.
    ///
    /// # Errors
    ///
    /// No channel gives a position (E0613).
    pub fn needs_positions(&self) -> Result<(), Failure> {
        let recording = &self.recording;
        let of_circle = matches!(recording.instrument, Instrument::Ballbar { .. });
        let at_targets = !matches!(recording.instrument, Instrument::Position | Instrument::Probe);
        let otherwise = !recording.temperatures.is_empty() || !recording.loads.is_empty();
        let known = recording.axes.iter().any(|axis| axis.command.is_some() || axis.actual.is_some());
        if known || !of_circle && (otherwise || !at_targets) {
            return Ok(());
        }
        let what = if of_circle { "the circle is unknown" } else { "the targets are unknown" };
        Err(self.no_command(&format!("there is no channel `command.<axis>`, so {what}")))
    }

    /// Why no row of the recording can be used (E0613).
    #[must_use]
    pub fn unusable(&self) -> Failure {
        if self.recording.axes.iter().any(|axis| axis.command.is_some()) {
            let message = "no row has both a programmed position and a reading";
            let mistake = Diagnostic::error(NOTHING_MEASURED, self.named.channels, message);
            let help =
                "check that the columns of `command.<axis>` and of the reading are filled in the same rows";
            return one(&self.source, mistake.help(help));
        }
        self.no_command("there is no channel `command.<axis>`, so the readings can be compared with nothing")
    }

    fn no_command(&self, message: &str) -> Failure {
        let mistake = Diagnostic::error(NOTHING_MEASURED, self.named.channels, message);
        one(&self.source, mistake.help(format!("add {}, the programmed position", self.command())))
    }

    /// The channel that is missing, as the file would list it: the command of the first axis that has other channels, or of the first axis.
    fn command(&self) -> String {
        let axes = || self.equations.axes.iter().filter(|axis| !axis.is_motor());
        let heard = |letter: &str| {
            let number = self.equations.axes.iter().position(|axis| axis.letter == letter);
            let channels = number.and_then(|number| self.recording.axes.get(number));
            channels.is_some_and(|axis| axis.actual.is_some() || axis.measured.is_some())
        };
        let axis = axes().find(|axis| heard(&axis.letter)).or_else(|| axes().next());
        let unit = if axis.is_some_and(|axis| axis.rotary) { "deg" } else { "mm" };
        let name = axis.map_or("x", |axis| &*axis.variable);
        format!("`command.{name}: {{column: ..., unit: {unit}}}`")
    }
}
