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

use abbe_fleet::{file, run};

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
    let fleet = file::read(&folder.join("fleet.yaml"), &()).expect("a fleet");
    let begun = Instant::now();
    let done = run::all(&fleet, (None, false), &(), &|_| {}).expect("results");
    let seconds = begun.elapsed().as_secs_f64();
    println!(
        "{} recordings, {} diagnosed and {} followed in {seconds:.0} s\n",
        done.recordings, done.diagnosed, done.followed
    );
    print!("{}", table(shop, &judged::judged(shop, &fleet)));
}

/// The table, in Markdown.
fn table(shop: shop::Shop, judged: &judged::Judged) -> String {
    let mut text = "| planted | raised in week | reported change, as a share of the true one | what is said in the last week |\n| --- | --- | --- | --- |\n"
        .to_owned();
    for (number, judged::Raised { what, week, sentence, size, .. }) in judged.raised.iter().enumerate() {
        let week = week.map_or_else(|| "never".to_owned(), |week| week.to_string());
        let (share, half) = (size.0 / shop.planted(number), size.1 / shop.planted(number));
        text += &format!("| {what} | {week} | {share:.3} +- {half:.3} | {sentence} |\n");
    }
    let square = judged.raised.iter().map(|raised| raised.claimed.0).next_back().unwrap_or_default();
    text += &format!("\nthe squareness is a finding in {square} recordings before it is there\n");
    text += &format!("\n{} quiet series, {} other alarms", judged.quiet, judged.other.len());
    text += &judged.other.iter().map(|alarm| format!("\n- {alarm}")).collect::<String>();
    let (held, all) = judged.held;
    let share = f64::from(u32::try_from(held).unwrap()) / f64::from(u32::try_from(all.max(1)).unwrap());
    text + &format!("\n\n{held} of {all} intervals hold the truth: {share:.3}\n")
}
