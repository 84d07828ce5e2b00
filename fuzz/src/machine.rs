//! Machine files: read, derived, written in every notation, and compiled to code.

use model_dsl::codegen;
use model_dsl::compile;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::{Equations, Names};
use model_dsl::program::Interpreter;
use notation::Format;

use super::text::{findings_hold, source};

const FORMATS: [Format; 7] =
    [Format::Text, Format::Latex, Format::Html, Format::Json, Format::Maxima, Format::Python, Format::Svg];

/// Takes a file of any bytes as a machine file.
pub fn run(bytes: &[u8]) {
    let Some(source) = source(bytes) else { return };
    let mut diagnostics = Diagnostics::new();
    let compiled = compile(&source, &mut diagnostics);
    findings_hold(&source, &diagnostics);
    assert_eq!(compiled.is_none(), diagnostics.has_errors(), "a machine exactly where no error is");
    let Some(compiled) = compiled else { return };
    let equations = &compiled.equations;
    for names in [Names::Iso, Names::Symbols] {
        for format in FORMATS {
            assert!(!notation::print(equations, format, names).is_empty());
        }
    }
    let code = codegen::file(&codegen::tokens(equations), "file.yaml");
    assert!(code.is_ok(), "the generated code does not parse: {code:?}");
    numbers_are_finite(equations);
}

/// Coordinates are bounded, so that no position of a workspace gives a number that is none.
fn numbers_are_finite(equations: &Equations) {
    let interpreter = Interpreter::new(equations, &vec![100.0; equations.constants.len()]);
    let position = vec![0.5; equations.axes.len()];
    let travel = vec![0.5; equations.travels.len()];
    let finite = |vector: [f64; 3]| vector.into_iter().all(f64::is_finite);
    assert!(finite(interpreter.nominal(&position)), "a nominal position that is not finite");
    assert!(interpreter.levers(&position, &travel).into_iter().all(finite), "a lever arm that is not finite");
}
