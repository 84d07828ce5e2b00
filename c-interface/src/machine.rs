//! A compiled machine with its names: what generated code tells beside its equations.
//!
//! In: constants that generated code holds. Out: the names that a calibration file is read against. It exists because a
//! controller has the calibration file of its machine, and not the machine file: what that said is compiled in.

use std::ffi::CString;

use abbe_runtime::{Exchanged, Kinematics};
use model_dsl::calibration::{AxisName, Calibration, MachineNames, MotionName, TurningTool};
use model_dsl::machine::Counted;

/// A constant of a machine by its name, with its value in mm where the machine file gives one.
pub type ConstantOfMachine = (&'static str, Option<f64>);

/// The letter of an axis, and whether it is rotary (rad) rather than a slide (mm).
pub type AxisOfMachine = (&'static str, bool);

/// An error motion by its name, whether it is an angle (rad) rather than a length (mm), the letter of its link's axis, and whether
/// it is the motion of that axis along itself, or about itself.
pub type MotionOfMachine = (&'static str, bool, Option<&'static str>, bool);

/// An alignment error by its name, the id of another axis, and what it is counted from that one, in names of the machine.
pub type CountedOfMachine = (&'static str, &'static str, &'static str);

/// The numbers of the constants that are the direction of the tool, and of those that are the coordinates of its tip, none for one
/// that is zero; nothing where those are something else.
pub type TurningToolOfMachine = ([usize; 3], Option<[Option<usize>; 3]>);

/// A machine compiled to Rust. `abbe expand --c-abi` writes the implementation; nobody else needs one.
pub trait CompiledMachine: Kinematics + Copy + Send + 'static {
    /// The machine's name, by which calibrations refer to it.
    const NAME: &'static str;
    /// Its constants, in the order of [`CompiledMachine::with_constants`].
    const CONSTANTS: &'static [ConstantOfMachine];
    /// Its axes, in the order of positions.
    const AXES: &'static [AxisOfMachine];
    /// Its motors, which are axes that follow others: the number of the motor, that of an axis, and how far the motor goes for each mm of it.
    const FOLLOWS: &'static [(usize, usize, f64)] = &[];
    /// What each tool of a calibration turns, where it has a direction of its own.
    const TURNING: Option<TurningToolOfMachine> = None;
    /// Its error motions, in the order of the equations.
    const MOTIONS: &'static [MotionOfMachine];
    /// Those without a lever at the tool tip, which a calibration may list.
    const UNSEEN: &'static [MotionOfMachine] = &[];
    /// What its alignment errors are, each counted from the axes that show it.
    const COUNTED: &'static [CountedOfMachine] = &[];
    /// Its equations, as `abbe derive --format json --names iso` prints them: a machine file that says something else is
    /// not the one that was compiled.
    const EQUATIONS: &'static str;

    /// The machine with these constants, in mm; none where they are too few or too many.
    fn with_constants(constants: &[f64]) -> Option<Self>;
}

/// A machine whose constants may be changed between two cycles: another tool.
pub trait ChangingMachine: Kinematics + Send {
    /// Puts these constants, in mm, in the place of those that are there; whether they are as many as the machine has.
    fn change(&self, constants: &[f64]) -> bool;
}

impl<M: CompiledMachine> ChangingMachine for Exchanged<M> {
    fn change(&self, constants: &[f64]) -> bool {
        let machine = M::with_constants(constants);
        machine.map(|machine| self.exchange(machine)).is_some()
    }
}

/// The names of a machine, as a calibration is read against them.
pub(crate) fn names<M: CompiledMachine>() -> MachineNames {
    MachineNames {
        machine: M::NAME.to_owned(),
        constants: M::CONSTANTS.iter().map(|&(name, default)| (name.to_owned(), default)).collect(),
        turning: M::TURNING.map(|(direction, offset)| TurningTool { direction, offset }),
        axes: M::AXES.iter().enumerate().map(axis_name::<M>).collect(),
        motions: M::MOTIONS.iter().map(|motion| motion_name::<M>(*motion)).collect(),
        unseen: M::UNSEEN.iter().map(|motion| motion_name::<M>(*motion)).collect(),
    }
}

fn axis_name<M: CompiledMachine>((number, &(letter, rotary)): (usize, &AxisOfMachine)) -> AxisName {
    let own = M::FOLLOWS.iter().filter(|(motor, ..)| *motor == number);
    AxisName {
        letter: letter.to_owned(),
        rotary,
        follows: own.map(|&(_, of, weight)| (of, weight)).collect(),
    }
}

fn motion_name<M: CompiledMachine>((name, angular, axis, own): MotionOfMachine) -> MotionName {
    let counted = M::COUNTED.iter().filter(|(motion, ..)| *motion == name);
    let counted =
        counted.map(|(_, from, is)| Counted { from: (*from).to_owned(), is: (*is).to_owned() }).collect();
    MotionName { name: name.to_owned(), angular, axis: axis.map(str::to_owned), own, counted }
}

/// The names that C asks for.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ForC {
    /// The machine.
    pub machine: CString,
    /// The letter of each axis, or the id of its link, and whether it is rotary; in the order of positions.
    pub axes: Vec<(CString, bool)>,
    /// Each temperature sensor, in the order of temperatures.
    pub sensors: Vec<CString>,
    /// Each tool of the calibration.
    pub tools: Vec<CString>,
    /// Each constant of the machine.
    pub constants: Vec<CString>,
}

impl ForC {
    /// The names of the machine `M`, and those of the sensors and tools of a calibration of it.
    ///
    /// # Errors
    /// Gives the name that C cannot read, since there is a zero byte in it.
    pub fn new<M: CompiledMachine>(calibration: &Calibration) -> Result<Self, String> {
        let sensors = calibration.sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str());
        let tools = calibration.tools.iter().map(|tool| tool.name.value.as_str());
        let constants = M::CONSTANTS.iter().map(|&(name, _)| name);
        let axes = M::AXES.iter().map(|&(letter, rotary)| Ok((c_string(letter)?, rotary)));
        Ok(Self {
            machine: c_string(M::NAME)?,
            axes: axes.collect::<Result<_, String>>()?,
            sensors: sensors.map(c_string).collect::<Result<_, _>>()?,
            tools: tools.map(c_string).collect::<Result<_, _>>()?,
            constants: constants.map(c_string).collect::<Result<_, _>>()?,
        })
    }
}

fn c_string(name: &str) -> Result<CString, String> {
    CString::new(name).map_err(|_| name.to_owned())
}
