//! What firmware and controllers have saved of a machine: bed meshes, skew factors, screw tables. In: a file, and what the user says
//! of it. Out: the correction in it as the firmware applies it, and as error motions of a calibration.
//!
//! Such a file holds no errors but corrections: what is added to a command. Each reader says what its firmware adds, from the
//! firmware's own code; [`terms`] makes errors of it, which for skew and meshes is minus the correction, exactly or to second order.

mod choice;
mod codes;
mod heights;
mod klipper;
mod marlin;
mod mesh;
mod printed;
mod screw;
mod skew;
mod terms;

use model_dsl::calibration::{CalibratedTerm, Calibration, LARGEST_DISPLACEMENT};
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::source::{SourceFile, Span};

use super::geometry::Geometry;
use super::options::{Kind, Unit};
use super::refused::Refused;
pub(super) use codes::commands;
pub(super) use heights::BEGIN as HEIGHTS;
pub(super) use mesh::{Mesh, over_two};
pub(super) use skew::Skew;
pub(super) use terms::slide;

/// Whose file it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SavedForm {
    /// Klipper's configuration, with what `SAVE_CONFIG` wrote.
    Klipper,
    /// RepRapFirmware's `heightmap.csv`.
    Heights,
    /// Commands and printed meshes of Marlin, and commands of RepRapFirmware.
    Codes,
    /// LinuxCNC's screw compensation.
    Screw,
}

/// What the user says of a file, where it does not say it itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SavedWanted {
    /// The axis of a screw table: an index into [`Equations::axes`].
    pub axis: Option<usize>,
    /// What a screw table holds.
    pub kind: Option<Kind>,
    /// The unit of a screw table; by default mm.
    pub unit: Option<Unit>,
    /// From where to where a printed mesh reaches in X and in Y, mm.
    pub reach: [Option<[f64; 2]>; 2],
    /// The mesh to take, by its name.
    pub mesh: Option<String>,
    /// The skew to take, by its name.
    pub skew: Option<String>,
}

/// What stands in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Saved {
    /// The heights of a bed.
    pub(super) mesh: Option<Mesh>,
    /// The axes that are not square.
    pub(super) skew: Option<Skew>,
    /// The table of a screw: positions in mm, and the trim that is added there, mm, forward and in reverse.
    screw: Option<screw::Screw>,
}

impl Saved {
    /// Refuses what no working machine needs (E0430): mostly the unit is wrong, or the type of a screw table.
    fn check_size(&self, diagnostics: &mut Diagnostics) {
        let heights = self.mesh.iter().flat_map(Mesh::rows).flatten();
        let trims = self.screw.iter().flat_map(|screw| screw.forward.iter().chain(&screw.reverse));
        for (what, help, largest) in [
            ("a height", "check the unit: heights are in mm", largest(heights)),
            (
                "a trim",
                "check the type: with type 0 the numbers are positions, with type 1 they are added to the command",
                largest(trims),
            ),
        ] {
            if largest > LARGEST_DISPLACEMENT {
                let message = format!("{what} of {largest:.1} mm is not a small error");
                diagnostics.push(Diagnostic::error("E0430", Span::default(), message).help(help));
            }
        }
    }
}

fn largest<'v>(values: impl Iterator<Item = &'v f64>) -> f64 {
    values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

/// The form of a text that looks like the file of a controller's correction.
pub fn saved_form(text: &str) -> Option<SavedForm> {
    if klipper::is_here(text) {
        Some(SavedForm::Klipper)
    } else if heights::is_here(text) {
        Some(SavedForm::Heights)
    } else if codes::is_here(text) || printed::is_here(text) {
        Some(SavedForm::Codes)
    } else if screw::is_here(text) {
        Some(SavedForm::Screw)
    } else {
        None
    }
}

/// The terms that a file adds to a calibration, with the numbers of their error motions. `known` gives the values of the
/// machine's constants. What is wrong in the file goes to `diagnostics`.
///
/// # Errors
/// A machine without slides X, Y, Z that do what the file corrects.
pub fn saved_terms(
    equations: &Equations,
    known: &Calibration,
    source: &SourceFile,
    wanted: &SavedWanted,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<(usize, CalibratedTerm)>, Refused> {
    let Some(form) = saved_form(source.text()) else {
        let message = "this is not a correction file of a controller";
        let help = "Abbe reads Klipper's printer.cfg, RepRapFirmware's heightmap.csv, commands and printed meshes of \
                    Marlin and RepRapFirmware, LinuxCNC's COMP_FILE; no public document gives the signs in tables of Mach or Centroid: \
                    write their numbers as a plain table of positions and errors (`data:` with `columns:`)";
        diagnostics.push(Diagnostic::error("E0802", Span::default(), message).help(help));
        return Ok(Vec::new());
    };
    let saved = read(form, source, wanted, diagnostics);
    saved.check_size(diagnostics);
    if diagnostics.has_errors() {
        return Ok(Vec::new());
    }
    terms::of(&Geometry::new(equations, known), &saved)
}

/// The terms of axes that are not square: how much Y leans towards X, Z towards X and Z towards Y, for each mm.
///
/// # Errors
/// A machine without slides X, Y, Z that lean so.
pub fn skew_terms(
    equations: &Equations,
    known: &Calibration,
    leans: [f64; 3],
) -> Result<Vec<(usize, CalibratedTerm)>, Refused> {
    let saved = Saved { skew: Some(Skew::of_factors(leans)), ..Saved::default() };
    terms::of(&Geometry::new(equations, known), &saved)
}

/// Reads a file of a form.
pub(super) fn read(
    form: SavedForm,
    source: &SourceFile,
    wanted: &SavedWanted,
    diagnostics: &mut Diagnostics,
) -> Saved {
    match form {
        SavedForm::Klipper => klipper::read(source, wanted, diagnostics),
        SavedForm::Heights => heights::read(source, diagnostics),
        SavedForm::Codes => marlin::read(source, wanted, diagnostics),
        SavedForm::Screw => screw::read(source, wanted, diagnostics),
    }
}
