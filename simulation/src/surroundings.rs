//! Surroundings: temperatures and loads over time.
//!
//! In: how a sensor warms up, how a load goes up and down. Out: the true temperature or load at any time. The noise of
//! its readings is only carried along.

use std::f64::consts::TAU;

use crate::commands::Column;
use crate::noise::Noise;

/// A temperature sensor: heat in steps, through a first-order filter, and the swing of the room.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Temperature {
    /// The name of the sensor.
    pub name: String,
    /// The temperature at the beginning, degC.
    pub start: f64,
    /// From which time on (s, ascending) which temperature is aimed at (degC).
    pub steps: Vec<(f64, f64)>,
    /// The time constant of the filter, s; 0: no filter.
    pub time_constant: f64,
    /// The swing of the room, added to the rest.
    pub swing: Option<Swing>,
    /// The noise of the sensor, degC.
    pub noise: Noise,
}

/// A sinusoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Its amplitude.
    pub amplitude: f64,
    /// Its period, s.
    pub period: f64,
    /// Its phase at time zero, rad.
    pub phase: f64,
}

/// A load.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Load {
    /// The name of the channel.
    pub name: String,
    /// The unit as files write it.
    pub unit: String,
    /// The load that is always there.
    pub base: f64,
    /// Pulses on top.
    pub pulses: Option<Pulses>,
    /// A sinusoid on top.
    pub swing: Option<Swing>,
    /// The noise with which it is read.
    pub noise: Noise,
}

/// Rectangular pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulses {
    /// The height.
    pub height: f64,
    /// From one pulse to the next, s.
    pub period: f64,
    /// How long each lasts, s.
    pub width: f64,
    /// When the first begins, s.
    pub start: f64,
}

impl Swing {
    fn value(&self, time: f64) -> f64 {
        self.amplitude * (TAU * time / self.period + self.phase).sin()
    }
}

impl Temperature {
    /// The true temperature at a time, degC.
    pub fn value(&self, time: f64) -> f64 {
        let swing = self.swing.map_or(0.0, |swing| swing.value(time));
        let mut filtered = self.start;
        let mut aim = self.start;
        let mut since = 0.0;
        for &(begin, next) in self.steps.iter().take_while(|(begin, _)| *begin <= time) {
            filtered = self.approach(filtered, aim, begin - since);
            (aim, since) = (next, begin);
        }
        self.approach(filtered, aim, time - since) + swing
    }

    /// How far a sensor has come from one temperature towards another after a time, s.
    fn approach(&self, from: f64, aim: f64, time: f64) -> f64 {
        if self.time_constant > 0.0 { aim + (from - aim) * (-time / self.time_constant).exp() } else { aim }
    }

    /// The true temperatures at many times.
    pub fn column(&self, times: &[f64]) -> Column {
        let values = times.iter().map(|time| self.value(*time)).collect();
        Column { name: self.name.clone(), unit: "degC".to_owned(), values }
    }
}

impl Load {
    /// The true load at a time.
    pub fn value(&self, time: f64) -> f64 {
        let pulses = self.pulses.map_or(0.0, |pulses| pulses.value(time));
        self.base + pulses + self.swing.map_or(0.0, |swing| swing.value(time))
    }

    /// The true loads at many times.
    pub fn column(&self, times: &[f64]) -> Column {
        let values = times.iter().map(|time| self.value(*time)).collect();
        Column { name: self.name.clone(), unit: self.unit.clone(), values }
    }
}

impl Pulses {
    fn value(&self, time: f64) -> f64 {
        let since = time - self.start;
        if since >= 0.0 && since.rem_euclid(self.period) < self.width { self.height } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_comes_and_goes_exponentially() {
        let sensor = Temperature {
            name: "motor".to_owned(),
            start: 20.0,
            steps: vec![(10.0, 50.0), (110.0, 20.0)],
            time_constant: 25.0,
            ..Temperature::default()
        };
        assert_eq!(sensor.value(9.0), 20.0);
        let warm = 50.0 - 30.0 * (-100.0_f64 / 25.0).exp();
        assert!((sensor.value(110.0) - warm).abs() < 1e-12);
        let cool = 20.0 + (warm - 20.0) * (-40.0_f64 / 25.0).exp();
        assert!((sensor.value(150.0) - cool).abs() < 1e-12);
    }

    #[test]
    fn pulses_are_on_and_off() {
        let pulses = Pulses { height: 80.0, period: 10.0, width: 3.0, start: 2.0 };
        let load = Load { base: 5.0, pulses: Some(pulses), ..Load::default() };
        let values = load.column(&[0.0, 2.0, 4.9, 5.0, 12.5, 19.0]).values;
        assert_eq!(values, [5.0, 85.0, 85.0, 5.0, 85.0, 5.0]);
    }
}
