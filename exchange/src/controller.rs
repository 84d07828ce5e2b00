//! Compensation tables of controllers. In: a calibrated machine. Out: files in the controller's own form, and what of the model
//! they cannot carry, as a length at the tool.
//!
//! ```text
//! calibration -> geometry: what a table can hold -> effects, parameters -> linuxcnc, isg, sinumerik, ...: files -> lost: read again, compared
//! saved, tool_table, volumetric files -> terms and constants of a calibration (taken)
//! ```
//!
//! A file is believed only when it has been read again: every format has a reader that does what the controller's maker
//! documents of his own, and what is lost is measured with what that reader made of the file.
//!
//! | code | finding |
//! | --- | --- |
//! | E0801 | what should be a number is none |
//! | E0802 | a line that has another form |
//! | E0803 | a table that contradicts itself |
//! | E0804 | a name that means nothing here, or a name that is missing |
//! | W0801 | points of a bed mesh that were not probed |
//! | W0802 | lines that the controller leaves out |

mod beyond;
mod decimal;
mod effects;
mod etalon;
mod even;
mod export;
mod geometry;
mod grid;
mod heidenhain;
mod isg;
mod job;
mod lines;
pub mod linuxcnc;
mod lost;
mod nodes;
mod options;
mod parameters;
mod pmac;
mod printer;
mod refused;
mod report;
mod saved;
mod sinumerik;
mod space;
mod taken;
mod tool_table;
mod volumetric;

pub use beyond::Beyond;
pub use effects::{Effect, Effects, Factor, Product};
pub use export::{Checked, Export, Unusable, check, export};
pub use geometry::{Geometry, Pose};
pub use job::File;
pub use lost::{Lost, Size, Target};
pub use nodes::{Nodes, Spacing};
pub use options::{Format, Kind, Options, Sense, Unit};
pub use parameters::motion_of;
pub use refused::Refused;
pub use report::text;
pub use saved::{SavedForm, SavedWanted, saved_form, saved_terms, skew_terms};
pub use space::{Space, Wanted};
pub use taken::{VolumetricForm, volumetric_form, volumetric_terms};
pub use tool_table::tool_table;
