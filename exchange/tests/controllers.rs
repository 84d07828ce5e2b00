//! Files for controllers: signs, losses and refusals, against machines whose corrections are known without them.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test may end where its own set-up is wrong")]

#[path = "controllers/carried.rs"]
mod carried;
#[path = "controllers/linuxcnc.rs"]
mod linuxcnc;
#[path = "controllers/machine.rs"]
mod machine;
#[path = "controllers/printers.rs"]
mod printers;
#[path = "controllers/refusals.rs"]
mod refusals;
#[path = "controllers/saved.rs"]
mod saved;
#[path = "controllers/signs.rs"]
mod signs;
#[path = "controllers/turns.rs"]
mod turns;
