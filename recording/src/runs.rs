//! Runs: which rows of a recording belong together. In: the number of the run of every row. Out: the rows cut where the run
//! changes, and the numbers that there are.

use std::ops::Range;

use super::Recording;

impl Recording {
    /// The stretches of rows of one run each, with its number, in order. Together they are all rows, none of them empty. A run
    /// that was broken off and taken up again has a stretch for each time.
    pub fn runs(&self) -> Vec<(Range<usize>, i64)> {
        let mut start = 0;
        let stretch = |rows: &[i64]| {
            let first = *rows.first()?;
            let stretch = start..start + rows.len();
            start = stretch.end;
            Some((stretch, first))
        };
        self.run.chunk_by(|one, next| one == next).filter_map(stretch).collect()
    }

    /// The numbers of the runs, each once, in the order in which they begin.
    pub fn run_numbers(&self) -> Vec<i64> {
        let mut numbers: Vec<i64> = Vec::new();
        for (_, run) in self.runs() {
            if !numbers.contains(&run) {
                numbers.push(run);
            }
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn recording(run: &[i64]) -> Recording {
        Recording { run: run.to_vec(), ..Recording::default() }
    }

    #[test]
    fn rows_are_cut_where_the_run_changes() {
        let recording = recording(&[1, 1, 3, 2, 2, 2]);
        assert_eq!(recording.runs(), [(0..2, 1), (2..3, 3), (3..6, 2)]);
        assert_eq!(recording.run_numbers(), [1, 3, 2]);
    }

    #[test]
    fn a_run_that_is_taken_up_again_is_one_run_in_two_stretches() {
        let recording = recording(&[1, 2, 2, 1]);
        assert_eq!(recording.runs(), [(0..1, 1), (1..3, 2), (3..4, 1)]);
        assert_eq!(recording.run_numbers(), [1, 2]);
    }

    #[test]
    fn no_rows_are_no_run() {
        assert!(recording(&[]).runs().is_empty());
        assert!(recording(&[]).run_numbers().is_empty());
    }

    proptest! {
        /// Laid end to end, the stretches are the column again, and two neighbours are of different runs.
        #[test]
        fn the_stretches_are_all_rows(run in proptest::collection::vec(1_i64..4, 0..40)) {
            let recording = recording(&run);
            let runs = recording.runs();
            let again: Vec<i64> = runs.iter().flat_map(|(rows, run)| rows.clone().map(|_| *run)).collect();
            prop_assert_eq!(&again, &run);
            let mut next = 0;
            for (rows, _) in &runs {
                prop_assert!(rows.start == next && rows.end > rows.start);
                next = rows.end;
            }
            prop_assert!(runs.windows(2).all(|pair| pair[0].1 != pair[1].1));
        }
    }
}
