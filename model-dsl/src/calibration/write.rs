//! A calibration as its file. In: a calibration and the names of its machine. Out: text that reads back to it.

use super::names::{MachineNames, MotionName};
use super::sensors::{SensorKind, Sensors};
use super::spelling::{Item, braces, brackets, number, quantity, sentence, term, word};
use super::term::CalibratedTerm;
use super::vocabulary::{INSIDE_LOOP, RAMP};
use super::write_term::{Context, UNKNOWN, parameters};
use super::{CalibratedMotion, Calibration, Limits, Tool};

/// Writes a calibration: a term a line, in mm, rad, s and degC, so that no number is converted and [`super::read`] gives
/// back every bit of it.
///
/// What is read back is equal, but that its sensors are numbered as the text comes to them. A calibration that was read
/// from a file has them so already. The coefficient of a `compliance` is written per N: which kind of load it is per, a
/// term does not keep, and none is converted. Comments of the file that a calibration came from are not in it.
///
/// What no file can say does not come back, and most of it is refused: a number that is not finite or that
/// [`CalibratedTerm`] does not admit, a motion, an axis or a sensor by a number that nothing has, one motion listed twice.
/// White space at the ends of a name is lost.
pub fn write(calibration: &Calibration, names: &MachineNames) -> String {
    let mut text = format!("calibration: 1\nmachine: {}\n", sentence(&calibration.machine.value));
    if let Some(source) = &calibration.source {
        text += &format!("source: {}\n", sentence(source));
    }
    text += &constants(calibration, names);
    text += &tools(calibration, names);
    text += &limits(&calibration.limits);
    text += &derived(&calibration.sensors);
    if !(calibration.motions.is_empty() && calibration.unseen.is_empty()) {
        text += "errors:\n";
    }
    for (listed, known) in [(&calibration.motions, &names.motions), (&calibration.unseen, &names.unseen)] {
        text.extend(listed.iter().map(|listed| motion(listed, known.get(listed.motion), calibration, names)));
    }
    text
}

fn constants(calibration: &Calibration, names: &MachineNames) -> String {
    let given = names.offsets().zip(&calibration.constants);
    let given: Vec<_> = given.map(|((name, _), value)| (word(name), quantity(*value, "mm"))).collect();
    if given.is_empty() { String::new() } else { format!("constants: {}\n", braces(given)) }
}

/// The tools, each with the constants that are different with it.
fn tools(calibration: &Calibration, names: &MachineNames) -> String {
    let line = |tool: &Tool| {
        let differs = names.offsets().zip(tool.constants.iter().zip(&calibration.constants));
        let differs = differs.filter(|(_, (with, without))| with.to_bits() != without.to_bits());
        let given = differs.map(|((name, _), (value, _))| (word(name), quantity(*value, "mm")));
        let given: Vec<_> = given.chain(direction(tool, calibration, names)).collect();
        format!("  {}: {}\n", word(&tool.name.value), braces(given))
    };
    let lines: String = calibration.tools.iter().map(line).collect();
    if lines.is_empty() { lines } else { format!("tools:\n{lines}") }
}

/// The direction of a tool that has one of its own.
fn direction(tool: &Tool, calibration: &Calibration, names: &MachineNames) -> Option<(String, String)> {
    let parts = names.turning?.direction;
    let of = |constants: &[f64]| parts.map(|part| constants.get(part).copied().unwrap_or(f64::NAN));
    let (own, without) = (of(&tool.constants), of(&calibration.constants));
    (own != without).then(|| ("direction".to_owned(), brackets(&own.map(number))))
}

fn limits(limits: &Limits) -> String {
    let given = [
        ("compensation", limits.compensation, "mm"),
        ("rotation", limits.rotation, "rad"),
        ("rate", limits.rate, "mm/s"),
        ("rotation_rate", limits.rotation_rate, "rad/s"),
        ("hold", limits.hold, "s"),
        ("fade", limits.fade, "s"),
    ];
    let given = given.into_iter();
    let given: Vec<_> = given
        .filter_map(|(key, limit, unit)| limit.map(|limit| (key.to_owned(), quantity(limit.value, unit))))
        .collect();
    if given.is_empty() { String::new() } else { format!("limits: {}\n", braces(given)) }
}

/// The derived sensors, each after those that it is derived from.
fn derived(sensors: &Sensors) -> String {
    let name = |number: usize| word(sensors.iter().nth(number).map_or(UNKNOWN, |sensor| &sensor.name.value));
    let lines: String = sensors
        .iter()
        .filter_map(|sensor| {
            let from = match &sensor.kind {
                SensorKind::Input => return None,
                SensorKind::Mean(sources) => {
                    let sources: Vec<String> = sources.iter().map(|source| name(*source)).collect();
                    ("mean".to_owned(), brackets(&sources))
                }
                SensorKind::Initial(source) => ("initial".to_owned(), name(*source)),
            };
            Some(format!("  {}: {}\n", word(&sensor.name.value), braces([from])))
        })
        .collect();
    if lines.is_empty() { lines } else { format!("sensors:\n{lines}") }
}

fn motion(
    listed: &CalibratedMotion,
    known: Option<&MotionName>,
    calibration: &Calibration,
    names: &MachineNames,
) -> String {
    let context = Context { names, sensors: &calibration.sensors, motion: known };
    let name = word(known.map_or(UNKNOWN, |motion| &motion.name));
    match listed.terms.as_slice() {
        [] => format!("  {name}: []\n"),
        [alone] if let CalibratedTerm::Constant { value } = alone.value => {
            format!("  {name}: {}\n", quantity(value, context.motion_unit()))
        }
        terms => {
            let lines = terms.iter().enumerate().map(|(place, one)| {
                let mut parameters = parameters(&one.value, &context);
                let ramp = listed.ramp(place);
                if ramp > 0.0 {
                    parameters.push((RAMP, Item::One(quantity(ramp, "s"))));
                }
                if listed.is_inside_loop(place) {
                    parameters.push((INSIDE_LOOP, Item::One("true".to_owned())));
                }
                term(one.value.name(), &parameters)
            });
            format!("  {name}:\n{}", lines.collect::<String>())
        }
    }
}
