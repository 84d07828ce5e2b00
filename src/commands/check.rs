//! `abbe check`
use crate::arguments::Check;
use crate::failure::Failure;
pub(crate) fn run(command: &Check) -> Result<(), Failure> { let _ = (&command.machine, &command.equations); Ok(()) }
