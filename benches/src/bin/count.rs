//! Runs one contestant a number of times, for an instruction counter.
//!
//! In: a machine, a group, the number of a contestant and a number of passes; without arguments: nothing. Out: without
//! arguments the list of all that can be counted, a line each; else the work itself. See `callgrind.sh`.

use std::error::Error;

use abbe_benches::agreed::contestants;
use abbe_benches::case::Case;
use abbe_benches::contest::{Group, MACHINES};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [] => {
            for machine in MACHINES {
                let case: &'static Case = Box::leak(Box::new(Case::new(machine)?));
                for group in Group::ALL {
                    for (number, contestant) in contestants(case, group)?.iter().enumerate() {
                        println!("{machine}\t{}\t{number}\t{}", group.name(), contestant.name());
                    }
                }
            }
        }
        [machine, group, number, passes] => {
            let machine = MACHINES.into_iter().find(|name| name == machine).ok_or("no such machine")?;
            let group = Group::ALL.into_iter().find(|known| known.name() == group).ok_or("no such group")?;
            let case: &'static Case = Box::leak(Box::new(Case::new(machine)?));
            let mut all = contestants(case, group)?;
            let contestant = all.get_mut(number.parse::<usize>()?).ok_or("no such contestant")?;
            (0..passes.parse::<u32>()?).for_each(|_| contestant.pass());
        }
        _ => return Err("give a machine, a group, a contestant and the passes, or nothing".into()),
    }
    Ok(())
}
