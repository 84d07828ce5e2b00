//! The published experiments, driven again: one module for each page of `docs/cases/`.
//!
//! In: machines, calibrations and paths from the folders of those pages, and the figures that the sources print. Out: the
//! figures of the pages. Each is held against theory that the sources give or that follows from them, so that neither the
//! simulation nor a page is judged by itself.

mod bench;
mod excello;
mod moore;
mod postech;
mod stlbb;
