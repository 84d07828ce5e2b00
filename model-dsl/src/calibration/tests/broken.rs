//! Files broken at random: whatever they hold, there is a finding or a calibration, and no panic.

use super::*;
use crate::diagnostic::render;
use crate::quantity::{parse_quantity, parse_unit};
use proptest::prelude::*;

const WHOLE: &str = "\
calibration: 1
machine: test-mill
source: µ-laser
constants: {Xt: 1 in, Zt: 100 mm}
limits: {compensation: 0.2 mm}
sensors: {start: {initial: body}, body: {mean: [T10, T21]}}
errors:
  EXX:
    - table: {at: [0, 1, 2], per: mm, unit: µm, forward: [-0.5, 5, 1e1], reverse: [1, 2, 3]}
    - backlash: {lost_motion: 10 um, wind_up: 1 mil}
    - growth: {sensor: start, coefficient: 3 um/K, reference: 20 °C}
  EBX: [{polynomial: {axis: X, per: mm, unit: arcsec, coefficients: [-0.349, 5.29e-2]}}]
  C0Y: 272 µrad
";

proptest! {
    #[test]
    fn edited_files(start in 0..WHOLE.len(), cut in 0..30_usize, insert in "[ \\n\t,:{}\\[\\]'\"&*!|>#~µ°0-9a-zA-Z./-]{0,4}") {
        let start = WHOLE.floor_char_boundary(start);
        let end = WHOLE.ceil_char_boundary((start + cut).min(WHOLE.len()));
        let text = format!("{}{insert}{}", &WHOLE[..start], &WHOLE[end..]);
        let (calibration, diagnostics, source) = read_with_diagnostics(&text);
        prop_assert!(calibration.is_some() || diagnostics.has_errors());
        for one in &diagnostics {
            prop_assert!(one.span.start <= one.span.end && one.span.end <= text.len());
            prop_assert!(text.is_char_boundary(one.span.start) && text.is_char_boundary(one.span.end), "{one:?}");
        }
        render(&source, &diagnostics, true);
    }

    #[test]
    fn any_text(text in "\\PC{0,60}") {
        let (_, diagnostics, source) = read_with_diagnostics(&text);
        render(&source, &diagnostics, false);
        for range in [parse_quantity(&text).err(), parse_unit(&text).err()].into_iter().flatten().map(|error| error.range) {
            prop_assert!(text.get(range).is_some());
        }
    }

    #[test]
    fn a_number_and_its_unit_survive(value in -1e9..1e9_f64, unit in prop::sample::select(vec!["mm", "um", "arcsec", "1/s", "um/m/K"])) {
        let quantity = parse_quantity(&format!("{value:e} {unit}")).expect("a quantity");
        let factor = parse_unit(unit).expect("a unit").factor;
        prop_assert_eq!(quantity.value, value * factor);
    }
}
