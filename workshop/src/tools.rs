//! A tool by its name. In: a calibration and the name of one of its tools. Out: the calibration as it is with that tool in the
//! machine; or which tools there are.

use model_dsl::calibration::Calibration;
use model_dsl::suggest::nearest;

use crate::failure::Failure;

/// The most tools that a message lists: more than a line of a terminal are not read.
const MOST_TOLD: usize = 10;

/// Puts the constants of the tool that `--tool` names in place of the calibration's own; refuses a name that no tool has.
pub fn mount(calibration: &mut Calibration, name: &str) -> Result<(), Failure> {
    let found = calibration.tool(name).and_then(|number| calibration.tools.get(number));
    let Some(tool) = found else {
        let help = instead(calibration, name);
        return Err(Failure::wrong(format!(
            "error: --tool: the calibration has no tool `{name}`\nhelp: {help}"
        )));
    };
    calibration.constants.clone_from(&tool.constants);
    Ok(())
}

/// What may have been meant by a name that no tool has.
#[must_use]
pub fn instead(calibration: &Calibration, name: &str) -> String {
    let tools = || calibration.tools.iter().map(|tool| tool.name.value.as_str());
    match nearest(name, tools()) {
        Some(near) => format!("is it `{near}`?"),
        None if calibration.tools.is_empty() => {
            let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
            let name = if !name.is_empty() && name.chars().all(plain) { name } else { "T1" };
            format!("write `tools: {{{name}: {{Zt: -120 mm}}}}` in it")
        }
        None => format!("there are {}", tools().take(MOST_TOLD).collect::<Vec<_>>().join(", ")),
    }
}
