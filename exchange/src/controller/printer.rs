//! Firmware of printers: Marlin, Klipper, RepRapFirmware. In: the correction of a machine of three slides. Out: its skew factors and
//! the mesh of its bed, as each firmware is told them; and what a firmware does that was told so.
//!
//! All three know the same two things: axes that are not square, as three numbers, and the height of the bed over X and Y. The skew is
//! corrected first, and the mesh is read where that leads to. Signs and formulas: [`Skew`] and [`Mesh`].

mod fit;
mod write;

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::{SourceFile, Span};

use super::geometry::Pose;
use super::job::{Controller, File, Job, Written};
use super::lost::Target;
use super::refused::Refused;
use super::saved::{self, Mesh, Saved, SavedForm, SavedWanted, Skew, saved_form};

/// Whose firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Firmware {
    /// Marlin.
    Marlin,
    /// Klipper.
    Klipper,
    /// RepRapFirmware.
    RepRap,
}

impl Firmware {
    /// The forms of the files that it takes.
    fn forms(self) -> &'static [SavedForm] {
        match self {
            Self::Marlin => &[SavedForm::Codes],
            Self::Klipper => &[SavedForm::Klipper],
            Self::RepRap => &[SavedForm::Codes, SavedForm::Heights],
        }
    }

    /// The command of another firmware that says what this one's says: a skew that it would pass over without a word.
    fn foreign(self) -> &'static str {
        match self {
            Self::Marlin | Self::Klipper => "M556",
            Self::RepRap => "M852",
        }
    }

    /// The most points that a mesh has along an axis. Marlin: 15, which unified bed levelling takes; RepRapFirmware: 441 in all,
    /// `MaxGridProbePoints`; Klipper has no such bound, and 50 are more than any probe takes.
    fn most(self) -> usize {
        match self {
            Self::Marlin => 15,
            Self::RepRap => 21,
            Self::Klipper => 50,
        }
    }
}

/// A printer with what its firmware was told.
#[derive(Debug)]
pub(super) struct Printer {
    firmware: Firmware,
    /// The numbers of X, Y and Z among the machine's axes.
    axes: [usize; 3],
    /// From where to where a mesh of commands reaches, mm.
    reach: [Option<[f64; 2]>; 2],
    skew: Option<Skew>,
    mesh: Option<Mesh>,
}

/// The printer without corrections.
///
/// # Errors
/// A machine of other axes than three slides X, Y, Z.
pub(super) fn controller(job: &Job<'_, '_>, firmware: Firmware) -> Result<Printer, Refused> {
    let axes = axes(job)?;
    let reach = [axes[0], axes[1]].map(|axis| job.space.ranges.get(axis).copied());
    Ok(Printer { firmware, axes, reach, skew: None, mesh: None })
}

/// The numbers of the slides X, Y and Z.
fn axes(job: &Job<'_, '_>) -> Result<[usize; 3], Refused> {
    let Job { geometry, .. } = job;
    let [x, y, z] = [0, 1, 2].map(|direction| saved::slide(geometry, direction));
    let axes = [x?, y?, z?];
    if geometry.equations.axes.iter().filter(|axis| !axis.is_motor()).count() == axes.len() {
        return Ok(axes);
    }
    let what = format!("{} has more axes than the slides X, Y, Z", geometry.equations.machine);
    Err(Refused::new(what, "choose another format; the skew and the mesh of a printer have only these"))
}

impl Controller for Printer {
    fn load(&mut self, source: &SourceFile, _axis: Option<usize>, diagnostics: &mut Diagnostics) {
        let form = saved_form(source.text()).filter(|form| self.firmware.forms().contains(form));
        let Some(form) = form else {
            let message = "this file has neither a skew nor a mesh of this firmware";
            let help = "see docs/reference/calibrate.md for what each firmware saves";
            return diagnostics.push(Diagnostic::error("E0802", Span::default(), message).help(help));
        };
        if let Some(command) = saved::commands(source).find(|command| command.code == self.firmware.foreign())
        {
            return command
                .line
                .malformed("this firmware has no such command and would ignore it", diagnostics);
        }
        let wanted = SavedWanted { reach: self.reach, ..SavedWanted::default() };
        let Saved { skew, mesh, .. } = saved::read(form, source, &wanted, diagnostics);
        self.skew = skew.or(self.skew.take());
        self.mesh = mesh.or(self.mesh.take());
    }

    fn target(&self) -> &dyn Target {
        self
    }
}

impl Target for Printer {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        let place = self.axes.map(|axis| pose.position.get(axis).copied().unwrap_or(f64::NAN));
        let mut more = self.skew.map_or([0.0; 3], |skew| skew.correction(place));
        let skewed = [place[0] + more[0], place[1] + more[1]];
        more[2] += self.mesh.as_ref().map_or(0.0, |mesh| mesh.height(skewed));
        let mut correction = vec![0.0; pose.position.len()];
        for (axis, more) in self.axes.into_iter().zip(more) {
            if let Some(slot) = correction.get_mut(axis) {
                *slot = more;
            }
        }
        Ok(correction)
    }
}

/// The files for a firmware.
pub(super) fn written(job: &Job<'_, '_>, firmware: Firmware) -> Result<Written, Refused> {
    let axes = axes(job)?;
    let skew = fit::skew(job, axes)?;
    let mesh = fit::mesh(job, axes, firmware.most())?;
    Ok(match firmware {
        Firmware::Marlin => write::marlin(&skew, mesh.as_ref()),
        Firmware::Klipper => write::klipper(&skew, mesh.as_ref()),
        Firmware::RepRap => write::reprap(&skew, mesh.as_ref()),
    })
}

/// A file of no axis of its own.
fn file(name: &str, text: String, about: String) -> File {
    File { name: name.to_owned(), axis: None, text, about }
}
