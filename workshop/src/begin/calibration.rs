//! A calibration to begin with. In: a machine's equations. Out: a calibration file with each of its constants and error motions, all
//! of them zero.

use model_dsl::equations::{ConstantInfo, Equations, Motion};

/// A commented calibration file of the machine that `machine` names: a file, a shipped name or a topology word.
#[must_use]
pub fn calibration(machine: &str, equations: &Equations) -> String {
    let mut text = format!(
        "# A calibration file for Abbe: the numbers of one machine. Every number has its unit.\n\
         calibration: 1\n\
         machine: {machine}\n\
         # source: who measured what, with which instrument, when, and at which temperature\n"
    );
    text += &constants(&equations.constants);
    text += "# limits: {compensation: 0.1 mm}   # a larger correction is refused\n\n";
    text += "# An error is actual minus commanded. A bare quantity is a constant. Most error motions are tables:\n\
             #   EXX: [{table: {start: 0 mm, step: 50 mm, unit: um, values: [0, 1.2, 0.8]}}, {backlash: {lost_motion: 6 um}}]\n\
             # `abbe explain EXX` describes an error motion, `abbe explain table` a term.\n\
             errors:\n";
    let width = equations.motions.iter().map(|motion| motion.name.len()).max().unwrap_or_default();
    text += &equations.motions.iter().map(|motion| error_motion(motion, width)).collect::<String>();
    text
}

fn constants(constants: &[ConstantInfo]) -> String {
    let constants: Vec<_> = constants.iter().filter(|constant| constant.direction.is_none()).collect();
    if constants.is_empty() {
        return String::new();
    }
    let line = |constant: &&ConstantInfo| {
        let value = constant.default.unwrap_or_default();
        let meaning = constant.meaning.as_ref().map(|meaning| format!("   # {meaning}")).unwrap_or_default();
        format!("  {}: {value} mm{meaning}\n", constant.name)
    };
    let lines: String = constants.iter().map(line).collect();
    format!(
        "# Offsets of this machine. Put in your own values, above all the length of the tool.\nconstants:\n{lines}"
    )
}

fn error_motion(motion: &Motion, width: usize) -> String {
    let zero = if motion.angular { "0 urad" } else { "0 um" };
    format!("  {:width$} {zero:7}# {}\n", format!("{}:", motion.name), motion.meaning, width = width + 1)
}

#[cfg(test)]
mod tests {
    use model_dsl::calibration::read;
    use model_dsl::diagnostic::Diagnostics;
    use model_dsl::source::SourceFile;
    use model_dsl::yaml;

    use super::*;
    use crate::load;
    use crate::shipped::MACHINES;

    #[test]
    fn it_is_read_as_it_is_and_has_every_error_motion_of_the_machine() {
        for name in MACHINES.map(|(name, _)| name).into_iter().chain(["XYFZ", "FX", "CAFXYZ"]) {
            let equations = load::machine(name, None, &()).ok().unwrap().compiled.equations;
            let source = SourceFile::new("new.yaml", calibration(name, &equations));
            let mut diagnostics = Diagnostics::new();
            let root = yaml::read(&source, &mut diagnostics).unwrap();
            let known = read(&root, &equations.names(), &mut diagnostics).unwrap();
            assert!(diagnostics.is_empty(), "{name}: {diagnostics:?}");
            for (number, motion) in equations.motions.iter().enumerate() {
                assert_eq!(known.terms(number).len(), 1, "{name}: {}", motion.name);
            }
        }
    }
}
