//! `abbe new`: a commented machine file to start from.

use model_dsl::diagnostic::Diagnostics;
use model_dsl::machine::template;
use model_dsl::source::SourceFile;
use workshop::failure::Failure;

use crate::arguments::New;
use crate::output;

/// Runs the command.
pub(crate) fn run(command: &New) -> Result<(), Failure> {
    let mut diagnostics = Diagnostics::new();
    let source = SourceFile::new("topology", command.topology.as_str());
    let text = template(&command.topology, &mut diagnostics);
    output::print(&text.ok_or_else(|| Failure::marked(&source, &diagnostics))?)
}
