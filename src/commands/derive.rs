//! `abbe derive`: the error equations of a machine in one of six notations, or the drawing of its chain.

use std::path::PathBuf;

use model_dsl::equations;
use workshop::failure::Failure;
use workshop::load;

use crate::arguments::{Derive, Format, Names};
use crate::output::Person;

/// Runs the command.
pub(crate) fn run(command: &Derive) -> Result<(), Failure> {
    command.target.check(&[PathBuf::from(&command.machine)])?;
    let loaded = load::machine(&command.machine, None, &Person::default())?;
    let format = match command.format {
        Format::Text => notation::Format::Text,
        Format::Latex => notation::Format::Latex,
        Format::Html => notation::Format::Html,
        Format::Json => notation::Format::Json,
        Format::Maxima => notation::Format::Maxima,
        Format::Python => notation::Format::Python,
        Format::Svg => notation::Format::Svg,
    };
    let names = match command.names {
        Names::Iso => equations::Names::Iso,
        Names::Symbols => equations::Names::Symbols,
    };
    let equations = &loaded.compiled.equations;
    command.target.put(&match format {
        notation::Format::Html => loaded.page(names),
        format => notation::print(equations, format, names),
    })
}
