//! The commands, one file each. In: arguments. Out: output, or why there is none.

pub(crate) mod calibrate;
pub(crate) mod check;
pub(crate) mod compensate;
pub(crate) mod completions;
pub(crate) mod derive;
pub(crate) mod diagnose;
pub(crate) mod evaluate;
pub(crate) mod expand;
pub(crate) mod explain;
pub(crate) mod export;
pub(crate) mod fleet;
pub(crate) mod limits;
pub(crate) mod man;
pub(crate) mod new;
pub(crate) mod plan;
pub(crate) mod simulate;
pub(crate) mod update;
