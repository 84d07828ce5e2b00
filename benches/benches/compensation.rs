//! Times the compensation call: every contestant of a group on the same states, after their answers have been compared.
//!
//! In: nothing. Out: criterion's report, a group for each question and machine, the time of one call being the time of a
//! pass divided by its states.

use std::error::Error;
use std::time::Duration;

use abbe_benches::agreed::contestants;
use abbe_benches::case::{Case, STATES};
use abbe_benches::contest::{Group, MACHINES};
use criterion::{Criterion, Throughput};

fn main() -> Result<(), Box<dyn Error>> {
    let mut criterion = Criterion::default()
        .sample_size(60)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    for name in MACHINES {
        let case: &'static Case = Box::leak(Box::new(Case::new(name)?));
        for group in Group::ALL {
            let mut timed = criterion.benchmark_group(format!("{} {name}", group.name()));
            timed.throughput(Throughput::Elements(STATES as u64));
            for mut contestant in contestants(case, group)? {
                timed.bench_function(contestant.name(), |bencher| bencher.iter(|| contestant.pass()));
            }
            timed.finish();
        }
    }
    criterion.final_summary();
    Ok(())
}
