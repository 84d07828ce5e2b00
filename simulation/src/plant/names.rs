//! The names of a machine from the machine itself. In: a validated machine. Out: the names that its calibration may use, and which axis
//! an error motion is the own motion of.

use model_dsl::algebra::to_f64;
use model_dsl::calibration::{AxisName, MachineNames, MotionName, TurningTool};
use model_dsl::machine::{Link, LinkKind, Machine, MotionKind, Motor};

/// The names of a machine that its calibration may use, from the machine itself: also the error motions that no
/// direction of the equations sees.
pub fn names_of(machine: &Machine) -> MachineNames {
    let letter = |kind: LinkKind| kind.letter().map(String::from);
    let axes = machine.axes();
    let constants = machine.constants.iter();
    let motions = machine.motions.iter().enumerate().map(|(number, motion)| {
        let link = machine.links.get(motion.link);
        MotionName {
            name: motion.name.clone(),
            angular: motion.kind.angular(),
            axis: match motion.motor.and_then(|motor| machine.motors.get(motor)) {
                Some(motor) => Some(motor.name.value.clone()),
                None => link.and_then(|link| letter(link.kind)),
            },
            own: motion.motor.is_some() || link.is_some_and(|link| is_own(link, motion.kind)),
            counted: machine.counted(number),
        }
    });
    MachineNames {
        machine: machine.name.clone(),
        constants: constants.map(|constant| (constant.name.to_string(), constant.default)).collect(),
        turning: TurningTool::new(
            &machine.links,
            machine.constants.iter().map(|constant| (&constant.name, constant.direction)),
        ),
        axes: axes
            .iter()
            .map(|(_, link)| AxisName {
                letter: letter(link.kind).unwrap_or_default(),
                rotary: matches!(link.kind, LinkKind::Rotary(_)),
                follows: Vec::new(),
            })
            .chain(machine.motors.iter().map(|motor| motor_name(motor, &axes)))
            .collect(),
        motions: motions.collect(),
        unseen: Vec::new(),
    }
}

/// A motor as an axis that follows others.
fn motor_name(motor: &Motor, axes: &[(usize, &Link)]) -> AxisName {
    let axis = |link: usize| axes.iter().position(|(axis, _)| *axis == link);
    let follows = motor.follows.iter().filter_map(|(link, weight)| Some((axis(*link)?, to_f64(weight))));
    AxisName { letter: motor.name.value.clone(), rotary: false, follows: follows.collect() }
}

/// The axis whose own motion, actual minus commanded, an error motion is: EXX of X, ECC of C.
pub(super) fn own_axis(machine: &Machine, names: &MachineNames, motion: &str) -> Option<usize> {
    let motion = machine.motions.iter().find(|known| known.name == motion)?;
    if let Some(motor) = motion.motor.and_then(|motor| machine.motors.get(motor)) {
        return names.axis(&motor.name.value);
    }
    let link = machine.links.get(motion.link)?;
    let letter = link.kind.letter().filter(|_| is_own(link, motion.kind))?;
    names.axis(letter.encode_utf8(&mut [0; 4]))
}

/// Whether a motion is that of its link along itself, or about itself.
fn is_own(link: &Link, motion: MotionKind) -> bool {
    match (link.kind, motion) {
        (LinkKind::Slide(_), MotionKind::Linear(axis)) | (LinkKind::Rotary(_), MotionKind::Angular(axis)) => {
            axis == link.along.axis
        }
        _ => false,
    }
}
