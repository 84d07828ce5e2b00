//! `abbe.export`.
