//! Work on all processors, with the same result on any number of them.
//!
//! In: jobs that do not depend on one another. Out: what they return, in the order of the jobs, so that sums over it are taken in
//! one order however many processors there were. Small work is done at once: waking a processor takes some microseconds.

use rayon::prelude::*;

/// Less work than this, in numbers that are worked out, is done by one processor: some hundred microseconds. By a sweep over four
/// recordings: with a quarter of it two processors take up to two fifths longer over 20 000 rows than one does; with four times as much,
/// 4 000 rows gain nothing from a second one.
const WORTH: usize = 1 << 16;

/// Runs a job for each number below `count`, on all processors where the jobs together are `work` enough.
pub(crate) fn counted<R: Send>(count: usize, work: usize, job: impl Fn(usize) -> R + Sync) -> Vec<R> {
    if worth(count, work) {
        (0..count).into_par_iter().map(&job).collect()
    } else {
        (0..count).map(&job).collect()
    }
}

/// Runs a job on each item, on all processors where the jobs together are `work` enough.
pub(crate) fn each<T: Send, R: Send>(
    items: &mut [T],
    work: usize,
    job: impl Fn(&mut T) -> R + Sync,
) -> Vec<R> {
    if worth(items.len(), work) {
        items.par_iter_mut().map(&job).collect()
    } else {
        items.iter_mut().map(&job).collect()
    }
}

fn worth(count: usize, work: usize) -> bool {
    count > 1 && work >= WORTH
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_keep_their_order() {
        for work in [0, WORTH] {
            let squares: Vec<usize> = (0..23).map(|number| number * number).collect();
            assert_eq!(counted(23, work, |number| number * number), squares);
            let mut numbers: Vec<usize> = (0..23).collect();
            assert_eq!(each(&mut numbers, work, |number| std::mem::take(number).pow(2)), squares);
            assert!(numbers.iter().all(|number| *number == 0));
            assert!(counted(0, work, |number| number).is_empty());
        }
    }
}
