//! Files to begin with. In: a machine, or the columns of a table. Out: a commented file that Abbe reads as it is, with what only its
//! owner knows marked as such.

mod calibration;
mod path;
mod recording;
mod setup;
mod table;

pub use calibration::calibration;
pub use path::path;
pub use recording::{recording, table_alone};
pub use setup::setup;
pub use table::{Columns, columns};
