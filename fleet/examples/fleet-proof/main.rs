//! A fleet of which the truth is known. In: a folder. Out: a simulated shop in it, its results, and a table: in which week each planted
//! change is raised, what else is, and how many intervals hold the truth.
//!
//! ```text
//! cargo run --release -p abbe-fleet --example fleet-proof -- FOLDER [MACHINES [WEEKS [SEED]]]
//! ```

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::expect_used,
    reason = "a program for the terminal, whose shop is its own"
)]

mod judged;
mod shop;

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use fleet::{file, run};

fn main() {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().expect("the folder for the shop"));
    let mut number = |usual: u64| words.next().map_or(usual, |word| word.parse().expect("a number"));
    let (machines, weeks, seed) = (number(24), number(26), number(1));
    let shop = shop::Shop {
        machines: usize::try_from(machines).unwrap(),
        weeks: usize::try_from(weeks).unwrap(),
        seed,
    };
    fs::create_dir_all(&folder).unwrap();
    shop.write(&folder);
    let fleet = file::read(&folder.join("fleet.yaml"), &()).ok().expect("a fleet");
    let begun = Instant::now();
    let done = run::all(&fleet, (None, false), &(), &|_| {}).ok().expect("results");
    let seconds = begun.elapsed().as_secs_f64();
    println!(
        "{} recordings, {} diagnosed and {} followed in {seconds:.0} s\n",
        done.recordings, done.diagnosed, done.followed
    );
    print!("{}", judged::judged(shop, &fleet).table());
}
