//! Rows that wait for their answers. In: the state of the machine in each row, in their order. Out: the same states again, in pieces
//! that can be answered side by side, and what terms remember where each piece begins.

use abbe_runtime::{Direction, ErrorMotion, Sample, TermState, states_needed};

/// Rows of a piece, for each of which a compensator is set up. Of 32, 256 and 1024 rows, 32 took 12 % more processor time, and 256 as much as
/// 1024; with 256, what one read of a file brings is enough for all processors.
pub(super) const PIECE: usize = 256;

/// Entries of the same width, one after the other.
#[derive(Clone, Debug)]
struct Entries<T> {
    width: usize,
    all: Vec<T>,
}

impl<T> Default for Entries<T> {
    fn default() -> Self {
        Self { width: 0, all: Vec::new() }
    }
}

impl<T: Copy> Entries<T> {
    fn push(&mut self, entry: &[T]) {
        self.width = entry.len();
        self.all.extend_from_slice(entry);
    }

    fn row(&self, number: usize) -> &[T] {
        let first = number.saturating_mul(self.width);
        self.all.get(first..first.saturating_add(self.width)).unwrap_or_default()
    }
}

/// The state of the machine in rows that follow each other.
#[derive(Clone, Debug)]
pub struct Samples<'m> {
    motions: &'m [ErrorMotion<'m>],
    position: Entries<f64>,
    travel: Entries<f64>,
    direction: Entries<Direction>,
    velocity: Entries<f64>,
    temperature: Entries<f64>,
    time_step: Vec<f64>,
    tools: Vec<Option<usize>>,
    /// What terms remember behind the last row, one motion after the other.
    states: Vec<TermState>,
    /// What they remember where each piece begins.
    starts: Vec<Vec<TermState>>,
}

impl<'m> Samples<'m> {
    /// No rows yet, of a machine with these error motions.
    #[must_use]
    pub fn new(motions: &'m [ErrorMotion<'m>]) -> Self {
        Self {
            motions,
            position: Entries::default(),
            travel: Entries::default(),
            direction: Entries::default(),
            velocity: Entries::default(),
            temperature: Entries::default(),
            time_step: Vec::new(),
            tools: Vec::new(),
            states: vec![TermState::default(); states_needed(motions)],
            starts: Vec::new(),
        }
    }

    /// Takes the next row, which has the tool of this number, and the memory of all terms over to it. A row that is not finite, which
    /// the compensator refuses, leaves the memory as it was.
    pub fn push(&mut self, sample: &Sample<'_>, tool: Option<usize>) {
        if self.len().is_multiple_of(PIECE) {
            self.starts.push(self.states.clone());
        }
        self.position.push(sample.position);
        self.travel.push(sample.travel);
        self.direction.push(sample.direction);
        self.velocity.push(sample.velocity);
        self.temperature.push(sample.temperature);
        self.time_step.push(sample.time_step);
        self.tools.push(tool);
        if sample.is_finite() {
            self.remember(sample);
        }
    }

    /// How many rows there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time_step.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time_step.is_empty()
    }

    /// The state in a row.
    #[must_use]
    pub fn sample(&self, row: usize) -> Sample<'_> {
        Sample {
            position: self.position.row(row),
            travel: self.travel.row(row),
            direction: self.direction.row(row),
            velocity: self.velocity.row(row),
            temperature: self.temperature.row(row),
            time_step: self.time_step.get(row).copied().unwrap_or(f64::NAN),
        }
    }

    /// Forgets all rows, and goes on behind the last row of others.
    pub fn follow(&mut self, others: &Self) {
        self.position.all.clear();
        self.travel.all.clear();
        self.direction.all.clear();
        self.velocity.all.clear();
        self.temperature.all.clear();
        self.time_step.clear();
        self.tools.clear();
        self.starts.clear();
        self.states.clone_from(&others.states);
    }

    /// The number of the tool in a row.
    pub(super) fn tool(&self, row: usize) -> Option<usize> {
        self.tools.get(row).copied().flatten()
    }

    /// The pieces, each with the number of its first row and what terms remember there.
    pub(super) fn pieces(&self) -> &[Vec<TermState>] {
        &self.starts
    }

    fn remember(&mut self, sample: &Sample<'_>) {
        let mut rest = self.states.as_mut_slice();
        for motion in self.motions {
            let (own, others) = rest.split_at_mut_checked(motion.terms.len()).unwrap_or_default();
            motion.advance(sample, own);
            rest = others;
        }
    }
}
