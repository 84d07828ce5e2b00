//! `growth`: a spindle or a structure that grows with its temperature. In: a temperature. Out: T* - T0, T* being T behind
//! a first-order filter that starts at the first T and runs on through pauses, T being straight between rows.

use super::Memory;
use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "The spindle or the structure expands or tilts as it warms up, with a time constant if the body \
    warms later than the sensor. Plausible: up to some tens of micrometres or microradians per kelvin.";

pub(super) fn fill(
    rows: &Rows<'_>,
    sensor: usize,
    reference: f64,
    time_constant: f64,
    memory: &mut Memory,
    out: &mut Vec<f64>,
) {
    let temperatures = rows.temperature(sensor);
    if time_constant <= 0.0 {
        out.extend(temperatures.iter().map(|temperature| temperature - reference));
        return;
    }
    let mut last = memory.last_input;
    for (temperature, time) in temperatures.iter().zip(rows.time) {
        let filtered = match memory.value {
            None => *temperature,
            Some(before) => {
                let step = time - memory.last;
                let slope = (temperature - last) / step;
                let behind = before - last + slope * time_constant;
                temperature - slope * time_constant + behind * (-step / time_constant).exp()
            }
        };
        if filtered.is_finite() {
            memory.value = Some(filtered);
            memory.last = *time;
            last = *temperature;
        }
        out.push(filtered - reference);
    }
    memory.last_input = last;
}
