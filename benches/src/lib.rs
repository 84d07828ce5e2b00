//! The compensation call of three machines, by Abbe and by what else computes the same.
//!
//! In: the machines that `build.rs` compiled, numbers that [`case`] draws. Out: [`contest::Contestant`]s, which answer the same
//! question about the same states: Abbe's, C by hand, C by symbolic tools, and a product of matrices at run time. The
//! benchmarks time them and `count` runs them under an instruction counter; both hold the answers against each other
//! first. It exists so that every figure compares like with like.

pub mod agreed;
pub mod case;
pub mod chain;
pub mod contest;
mod foreign;
mod ours;
mod product;
mod random;

/// The machines, compiled by Abbe.
pub mod machines {
    include!(concat!(env!("OUT_DIR"), "/machines.rs"));
}
