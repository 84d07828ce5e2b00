//! `abbe derive`: the error equations of a machine in one of five notations.

use model_dsl::equations;
use model_dsl::notation;

use crate::arguments::{Derive, Format, Names};
use crate::failure::Failure;
use crate::{load, output};

/// Runs the command.
pub(crate) fn run(command: &Derive) -> Result<(), Failure> {
    let loaded = load::machine(&command.machine, None)?;
    let format = match command.format {
        Format::Text => notation::Format::Text,
        Format::Latex => notation::Format::Latex,
        Format::Html => notation::Format::Html,
        Format::Json => notation::Format::Json,
        Format::Maxima => notation::Format::Maxima,
    };
    let names = match command.names {
        Names::Iso => equations::Names::Iso,
        Names::Symbols => equations::Names::Symbols,
    };
    output::print(&notation::print(&loaded.compiled.equations, format, names))
}
