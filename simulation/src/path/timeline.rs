//! Timelines: a path laid out in time, run after run.

use super::leg::{Leg, Pace};
use super::{MOST_INSTANTS, Path, PathError};

/// A path laid out in time.
#[derive(Clone, Debug)]
pub struct Timeline {
    pace: Pace,
    runs: Vec<Run>,
    instants: Vec<Instant>,
    axes: usize,
}

/// One instant of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Time since the recording began, s.
    pub time: f64,
    /// The run, counted from 1.
    pub run: i64,
    /// Whether it is written down.
    pub recorded: bool,
}

#[derive(Clone, Debug)]
struct Run {
    start: f64,
    /// The time of the last instant.
    end: f64,
    /// Each leg with the time in the run at which it begins.
    legs: Vec<(f64, Leg)>,
}

/// How many instants a leg between stations gets besides its ends, where its speed is not even.
const UNEVEN: u32 = 32;

impl Timeline {
    pub(super) fn of(path: &Path, rotary: &[bool]) -> Result<Self, PathError> {
        let pace = Pace { feed: path.feed, acceleration: path.acceleration };
        let mut timeline = Self { pace, runs: Vec::new(), instants: Vec::new(), axes: rotary.len() };
        let mut start = 0.0;
        for (number, run) in (0..path.runs).zip(1_i64..) {
            // A run number beyond the address space only begins the lists of places again.
            let base = path.base(rotary.len(), usize::try_from(number).unwrap_or_default());
            let legs = path.shape.legs(&base, rotary);
            let mut end = 0.0;
            let placed: Vec<(f64, Leg)> = legs
                .into_iter()
                .map(|leg| {
                    let begin = end;
                    end += leg.duration(pace);
                    (begin, leg)
                })
                .collect();
            if placed.is_empty() || end <= 0.0 {
                return Err(PathError::NoLength);
            }
            let before = timeline.instants.len();
            timeline.take_instants(path.rate, run, start, end, &placed)?;
            let last = timeline.instants.last().filter(|_| timeline.instants.len() > before);
            let end = last.map_or(start, |instant| instant.time);
            timeline.runs.push(Run { start, end, legs: placed });
            start = end + path.pause;
        }
        Ok(timeline)
    }

    fn take_instants(
        &mut self,
        rate: f64,
        run: i64,
        start: f64,
        duration: f64,
        legs: &[(f64, Leg)],
    ) -> Result<(), PathError> {
        let stations = legs.iter().any(|(_, leg)| matches!(leg, Leg::Rest { readings: 1.., .. }));
        if !stations {
            // A hair more, so that a duration of whole steps keeps its last reading in spite of rounding.
            let readings = (duration * rate * (1.0 + 1e-12) + 1e-9).floor() + 1.0;
            if readings + self.instants.len() as f64 > MOST_INSTANTS as f64 {
                return Err(PathError::TooLong);
            }
            let times = (0_u32..).map(f64::from).take_while(|number| *number < readings);
            self.instants.extend(times.map(|number| Instant {
                time: start + number / rate,
                run,
                recorded: true,
            }));
            return Ok(());
        }
        self.instants.push(Instant { time: start, run, recorded: false });
        for (begin, leg) in legs {
            let duration = leg.duration(self.pace);
            let (parts, recorded) = match leg {
                Leg::Rest { readings, .. } => (*readings, true),
                _ if self.pace.acceleration.is_some() => (UNEVEN, false),
                _ => (1, false),
            };
            let times = (1..=parts).map(|part| duration * f64::from(part) / f64::from(parts));
            let instants = times.map(|time| Instant { time: start + begin + time, run, recorded });
            self.instants.extend(instants);
            if self.instants.len() > MOST_INSTANTS {
                return Err(PathError::TooLong);
            }
        }
        Ok(())
    }

    /// The instants of the recording, in order; the machine goes through those that are not written down too.
    pub fn instants(&self) -> &[Instant] {
        &self.instants
    }

    /// The commanded position of each axis at any time: held before the first run and after the last, straight from the
    /// end of a run to the beginning of the next.
    pub fn positions(&self, times: &[f64]) -> Vec<Vec<f64>> {
        let mut columns = vec![Vec::with_capacity(times.len()); self.axes];
        let mut place = vec![0.0; self.axes];
        for &time in times {
            self.place(time, &mut place);
            columns.iter_mut().zip(&place).for_each(|(column, position)| column.push(*position));
        }
        columns
    }

    /// The run at a time; a pause belongs to the run before it.
    pub fn run(&self, time: f64) -> i64 {
        let begun = self.runs.partition_point(|run| run.start <= time);
        i64::try_from(begun.max(1)).unwrap_or(i64::MAX)
    }

    fn place(&self, time: f64, out: &mut [f64]) {
        let begun = self.runs.partition_point(|run| run.start <= time).max(1);
        let Some(run) = self.runs.get(begun - 1) else { return };
        let Some(next) = self.runs.get(begun).filter(|_| time > run.end) else {
            return run.place(time.clamp(run.start, run.end), self.pace, out);
        };
        run.place(run.end, self.pace, out);
        let mut ahead = out.to_vec();
        next.place(next.start, self.pace, &mut ahead);
        let share = (time - run.end) / (next.start - run.end);
        out.iter_mut().zip(&ahead).for_each(|(out, ahead)| *out += (ahead - *out) * share);
    }
}

impl Run {
    fn place(&self, time: f64, pace: Pace, out: &mut [f64]) {
        let since = time - self.start;
        let begun = self.legs.partition_point(|(begin, _)| *begin <= since).max(1);
        if let Some((begin, leg)) = self.legs.get(begun - 1) {
            leg.position(since - begin, pace, out);
        }
    }
}
