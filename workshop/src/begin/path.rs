//! A path to begin with. In: a machine's equations. Out: a path file that the simulation drives: a circle where the machine has two
//! slides, a line there and back where it has one axis.

use model_dsl::equations::{AxisInfo, Equations};

/// A commented path file for the machine.
#[must_use]
pub fn path(equations: &Equations) -> String {
    let slides: Vec<&AxisInfo> = equations.axes.iter().filter(|axis| axis.effect.is_some()).collect();
    let shape = match slides.as_slice() {
        [one, other, ..] => circle(one, other),
        slides => slides.first().copied().or(equations.axes.first()).map(line).unwrap_or_default(),
    };
    format!(
        "# A path file for Abbe: the trajectory and the instrument. `abbe simulate CALIBRATION PATH` drives it,\n\
         # `abbe plan PATH` says what its recording would show.\n\
         path: 1\n\
         # title: a line for people\n\
         {shape}\
         runs: 3\n\
         seed: 1\n"
    )
}

fn circle(one: &AxisInfo, other: &AxisInfo) -> String {
    let (one, other) = (&one.letter, &other.letter);
    format!(
        "at: {{{one}: 150 mm, {other}: 150 mm}}   # the centre, and the position of each other axis\n\
         circle: {{plane: {one}{other}, radius: 100 mm, directions: [ccw, cw]}}\n\
         feed: 1000 mm/min\n\
         rate: 50 Hz\n\
         instrument: ballbar\n\
         noise: {{white: 0.3 um, resolution: 0.1 um}}\n"
    )
}

fn line(axis: &AxisInfo) -> String {
    let letter = &axis.letter;
    let (unit, small) = if axis.rotary { ("deg", "arcsec") } else { ("mm", "um") };
    format!(
        "line: {{axis: {letter}, from: 0 {unit}, to: 300 {unit}, stations: {{count: 11, dwell: 4 s}}}}\n\
         feed: 1000 {unit}/min\n\
         instrument: position\n\
         noise: {{white: 0.3 {small}, resolution: 0.1 {small}}}\n"
    )
}

#[cfg(test)]
mod tests {
    use model_dsl::diagnostic::Diagnostics;
    use model_dsl::source::SourceFile;
    use model_dsl::yaml;
    use simulation::file;

    use super::*;
    use crate::load;
    use crate::shipped::MACHINES;

    #[test]
    fn it_is_read_as_it_is() {
        for name in MACHINES.map(|(name, _)| name).into_iter().chain(["XYFZ", "FX", "FC", "ZFX"]) {
            let compiled = load::machine(name, None, &()).ok().unwrap().compiled;
            let source = SourceFile::new("path.yaml", path(&compiled.equations));
            let mut diagnostics = Diagnostics::new();
            let root = yaml::read(&source, &mut diagnostics).unwrap();
            let read = file::read(&root, &compiled.machine, &compiled.equations.names(), &mut diagnostics);
            assert!(read.is_some() && diagnostics.is_empty(), "{name}: {diagnostics:?}");
        }
    }
}
