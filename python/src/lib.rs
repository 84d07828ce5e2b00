//! Abbe for Python: the module `abbe._abbe`, which the package `abbe` shows as its own.
//!
//! In: objects of Python: names of files, dictionaries, arrays, tables. Out: objects of Python: arrays, texts, pages, errors that point
//! at places. Nothing is worked out here: every number comes from the crates that the command line calls too, by way of
//! [`workshop`].

mod arguments;
mod arrow;
mod calibration;
mod columns;
mod diagnosis;
mod error;
mod exported;
mod file;
mod machine;
mod made;
mod mapped;
mod page;
mod positions;
mod recording;
mod report;
mod running;
mod space;

use pyo3::prelude::*;

/// The module.
#[pymodule]
mod _abbe {
    #[pymodule_export]
    use super::calibration::Calibration;
    #[pymodule_export]
    use super::diagnosis::{Diagnosis, diagnose};
    #[pymodule_export]
    use super::error::{AbbeWarning, Error};
    #[pymodule_export]
    use super::exported::{Exported, export};
    #[pymodule_export]
    use super::machine::Machine;
    #[pymodule_export]
    use super::made::{calibrate, simulate, update};
    #[pymodule_export]
    use super::recording::Recording;
    #[pymodule_export]
    use super::report::{Report, evaluate, explain};

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
