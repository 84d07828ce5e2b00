//! Why a calibration is not exported: what is wrong, and what to do instead.

use std::fmt;

use abbe_runtime::{Refusal, SetupError};

/// Why there are no files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// What is wrong.
    pub what: String,
    /// What to do.
    pub help: Option<String>,
}

impl Refused {
    /// A refusal with a help line.
    pub fn new(what: impl Into<String>, help: impl Into<String>) -> Self {
        Self { what: what.into(), help: Some(help.into()) }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.what)?;
        self.help.iter().try_for_each(|help| write!(f, "\nhelp: {help}"))
    }
}

impl std::error::Error for Refused {}

impl From<Refusal> for Refused {
    fn from(refusal: Refusal) -> Self {
        Self { what: format!("the correction cannot be computed: {refusal}"), help: None }
    }
}

impl From<SetupError> for Refused {
    fn from(error: SetupError) -> Self {
        Self { what: format!("the calibration cannot be used: {error}"), help: None }
    }
}
