//! Sensors that may fall silent.
//!
//! In: the readings of each cycle. Out: readings without gaps, and which sensor has been silent longest. It exists because
//! a wire breaks while the spindle turns, and the temperature of a machine is still what it was a second before.

use super::super::real::{Real, onward};

/// What was heard in one cycle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Heard {
    /// The sensor that has been silent longest, and for how long, in s.
    pub(super) silent: Option<(usize, Real)>,
    /// Whether a sensor speaks again that was silent in the cycle before.
    pub(super) returned: bool,
}

/// The last reading of each sensor that the terms read, and how long ago it was.
#[derive(Debug)]
pub(super) struct Sensors<'a> {
    /// Last readings in degC; NaN before the first.
    temperature: &'a mut [Real],
    /// Time since the last reading in s.
    silence: &'a mut [Real],
}

impl<'a> Sensors<'a> {
    /// Sensors that have not been heard yet, in this storage.
    pub(super) fn new(temperature: &'a mut [Real], silence: &'a mut [Real]) -> Self {
        let mut sensors = Self { temperature, silence };
        sensors.restart();
        sensors
    }

    /// Forgets every reading.
    pub(super) fn restart(&mut self) {
        self.temperature.fill(Real::NAN);
        self.silence.fill(0.0);
    }

    /// Takes the readings of a cycle; one that is not finite was not given.
    pub(super) fn hear(&mut self, readings: &[Real], time_step: Real) -> Heard {
        let mut heard = Heard { silent: None, returned: false };
        let memories = self.temperature.iter_mut().zip(self.silence.iter_mut());
        for (sensor, ((last, silence), &reading)) in memories.zip(readings).enumerate() {
            if reading.is_finite() {
                heard.returned |= *silence > 0.0;
                (*last, *silence) = (reading, 0.0);
                continue;
            }
            *silence = onward(*silence, time_step);
            if heard.silent.is_none_or(|(_, longest)| *silence > longest) {
                heard.silent = Some((sensor, *silence));
            }
        }
        heard
    }

    /// The readings to calculate with; those of the sample where they are too few to be replaced, which is refused later.
    pub(super) fn readings<'s>(&'s self, of_sample: &'s [Real]) -> &'s [Real] {
        if of_sample.len() < self.temperature.len() { of_sample } else { self.temperature }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sensor_that_has_been_silent_longest_is_told() {
        let (mut temperature, mut silence) = ([0.0; 3], [0.0; 3]);
        let mut sensors = Sensors::new(&mut temperature, &mut silence);
        let gone = Real::NAN;
        let cycles = [
            ([20.0, 20.0, 20.0], None),
            ([20.0, gone, 20.0], Some((1, 0.5))),
            ([gone, gone, 20.0], Some((1, 1.0))),
            ([gone, gone, gone], Some((1, 1.5))),
            ([gone, 21.0, gone], Some((0, 1.5))),
        ];
        for (readings, silent) in cycles {
            assert_eq!(sensors.hear(&readings, 0.5).silent, silent, "{readings:?}");
        }
    }
}
