//! `abbe derive`: the error equations of a machine in one of five notations.

use std::path::PathBuf;

use model_dsl::check;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations;
use model_dsl::notation::{self, Published};
use workshop::failure::Failure;
use workshop::load::{self, Loaded};

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
    };
    let names = match command.names {
        Names::Iso => equations::Names::Iso,
        Names::Symbols => equations::Names::Symbols,
    };
    let equations = &loaded.compiled.equations;
    command.target.put(&match format {
        notation::Format::Html => notation::page(equations, names, &published(&loaded)),
        format => notation::print(equations, format, names),
    })
}

/// How the machine stands to the equations that were published about it.
fn published(loaded: &Loaded) -> Vec<Published> {
    let Loaded { compiled, published, .. } = loaded;
    let compared = published.iter().filter_map(|file| {
        let report = check::check(&compiled.machine, &compiled.equations, file, &mut Diagnostics::new());
        report.map(|report| Published::new(file, report))
    });
    compared.collect()
}
