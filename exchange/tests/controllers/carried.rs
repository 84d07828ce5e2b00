//! What formats carry. Random machines whose errors a format holds in full lose nothing; what a format has no place for is lost,
//! and is as large as a calculation beside it says.

use abbe_exchange::controller::{Format, Geometry, Lost, Options, Sense, VolumetricForm, volumetric_terms};
use model_dsl::calibration::Calibration;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use proptest::prelude::*;

use crate::machine::{Machine, options};

/// Three slides in every order on both branches.
fn words() -> impl Strategy<Value = String> {
    (Just(vec!['X', 'Y', 'Z']).prop_shuffle(), 0..4_usize).prop_map(|(mut letters, bed)| {
        letters.insert(bed, 'F');
        letters.into_iter().collect()
    })
}

/// A table of five values from end to end of the test workspace, in um or urad.
fn table(motion: &str, axis: char, values: &[f64]) -> String {
    let (start, step) = match axis {
        'X' => (-100, 125),
        'Y' => (-200, 75),
        _ => (-100, 50),
    };
    let unit = if "XYZ".contains(&motion[1..2]) { "um" } else { "urad" };
    format!(
        "{motion}: [{{table: {{axis: {axis}, start: {start} mm, step: {step} mm, unit: {unit}, values: {values:?}}}}}]"
    )
}

fn values() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(-30.0..30.0_f64, 5)
}

/// What is of second order: such a curve changes by up to 60 um over 50 mm, 1.2 in a thousand, in three directions and through
/// lever arms of three times that step; and so does the error over the length of the correction.
fn second_order(lost: &Lost) -> f64 {
    0.01 * lost.without.largest
}

/// All eighteen motions and three squarenesses.
fn all_errors() -> impl Strategy<Value = Vec<String>> {
    (proptest::collection::vec(values(), 18), proptest::collection::vec(-50.0..50.0_f64, 3)).prop_map(
        |(curves, square)| {
            let names = ['X', 'Y', 'Z']
                .into_iter()
                .flat_map(|axis| ['X', 'Y', 'Z', 'A', 'B', 'C'].map(|along| (along, axis)));
            let curves = names
                .zip(&curves)
                .map(|((along, axis), curve)| table(&format!("E{along}{axis}"), axis, curve));
            let square = ["EC0Y", "EB0Z", "EA0Z"]
                .iter()
                .zip(&square)
                .map(|(name, value)| format!("{name}: {value} urad"));
            curves.chain(square).collect()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn volumetric_files_carry_all_of_a_mill(word in words(), errors in all_errors()) {
        let machine = Machine::of(&word, &errors);
        for format in [Format::Isg, Format::Etalon] {
            let export = machine.export(format, &options()).unwrap();
            prop_assert!(export.left_out.is_empty(), "{:?}", export.left_out);
            prop_assert!(export.lost.lost.largest < second_order(&export.lost), "{word} {format:?}: {:?}", export.lost);
            // What was written is taken back: the same errors everywhere, to the decimals of the file.
            let form = if format == Format::Isg { VolumetricForm::Isg } else { VolumetricForm::Etalon };
            let source = SourceFile::new("volumetric", export.files[0].text.clone());
            let mut diagnostics = Diagnostics::new();
            let empty = Calibration::new("m", machine.calibration.constants.clone());
            let terms = volumetric_terms(&machine.equations, &empty, &source, form, &mut diagnostics).unwrap();
            prop_assert!(diagnostics.is_empty());
            let taken = empty.with(&terms);
            let (ours, theirs) = (machine.geometry(), Geometry::new(&machine.equations, &taken));
            for pose in machine.space().poses(&ours).into_iter().step_by(97) {
                let [one, other] = [ours.error(&pose).unwrap(), theirs.error(&pose).unwrap()];
                prop_assert!(one.iter().zip(other).all(|(one, other)| (one - other).abs() < 1e-8), "{one:?} {other:?}");
            }
        }
    }

    #[test]
    fn sinumerik_carries_all_of_a_mill_with_tables_enough(word in words(), errors in all_errors()) {
        let machine = Machine::of(&word, &errors);
        let options = |sense| Options { tables: 100, points: Some(21), sense: Some(sense), ..options() };
        let export = machine.export(Format::Sinumerik, &options(Sense::Error)).unwrap();
        prop_assert!(export.left_out.is_empty());
        // At most 9 effects of one axis and 18 products of two are left out, each below 10 nm.
        prop_assert!(export.lost.lost.largest < 27.0 * 1e-5 + second_order(&export.lost), "{word}: {:?}", export.lost);
        let other = machine.export(Format::Sinumerik, &options(Sense::Correction)).unwrap();
        prop_assert!((export.lost.lost.rms - other.lost.lost.rms).abs() < 1e-6, "the sense is the user's own");
    }

    #[test]
    fn single_axes_lose_nothing_of_their_own(curves in proptest::collection::vec(values(), 3), play in 0.0..20.0_f64) {
        let errors: Vec<String> = ["X", "Y", "Z"].iter().zip(&curves).map(|(axis, curve)| {
            let own = table(&format!("E{axis}{axis}"), axis.chars().next().unwrap(), curve);
            own.replace("}]", &format!("}}, {{backlash: {{lost_motion: {play} um}}}}]"))
        }).collect();
        let machine = Machine::of("XFYZ", &errors);
        let options = Options { sense: Some(Sense::Error), ..options() };
        // Besides what is written: a sixteenth of a count is 6 nm, the others have nanometres or less.
        for (format, written) in [(Format::LinuxCnc, 1e-6), (Format::Heidenhain, 1e-6), (Format::Sinumerik, 1e-6), (Format::Pmac, 2e-5)] {
            let export = machine.export(format, &options).unwrap();
            let least = written + second_order(&export.lost);
            prop_assert!(export.lost.lost.largest < least, "{format:?}: {:?}", export.lost);
        }
        // Volumetric files know no direction: half of every play is lost, in all three axes at once.
        let export = machine.export(Format::Isg, &options).unwrap();
        let expected = 0.5e-3 * play * 3_f64.sqrt();
        prop_assert!((export.lost.lost.largest - expected).abs() < 1e-5 + second_order(&export.lost), "{} of {expected}", export.lost.lost.largest);
    }
}

#[test]
fn a_product_of_two_positions_is_carried_by_a_grid() {
    // 200 um/m^2 times x times y: -16 um at 400 and -200 mm. The reference, 150 and -50 mm, has -1.5 um of its own, which is a
    // shift of all positions. A grid over both axes holds the rest in full.
    let errors = ["EYX: [{product: {value: 200 um/m^2, times: [{position: X}, {position: Y}]}}]".to_owned()];
    let machine = Machine::of("FXYZ", &errors);
    let export = machine.export(Format::Isg, &options()).unwrap();
    assert!(export.left_out.is_empty(), "{:?}", export.left_out);
    assert!((export.lost.without.largest - 14.5e-3).abs() < 1e-5, "{:?}", export.lost);
    assert!(export.lost.lost.largest < second_order(&export.lost), "{:?}", export.lost);
    // What was written is taken back: a grid over two axes is a table for each of its rows, times a hat function.
    let source = SourceFile::new("volumetric", export.files[0].text.clone());
    let empty = Calibration::new("m", machine.calibration.constants.clone());
    let mut diagnostics = Diagnostics::new();
    let terms =
        volumetric_terms(&machine.equations, &empty, &source, VolumetricForm::Isg, &mut diagnostics).unwrap();
    assert!(diagnostics.is_empty());
    let taken = empty.with(&terms);
    let (ours, theirs) = (machine.geometry(), Geometry::new(&machine.equations, &taken));
    for pose in machine.space().poses(&ours) {
        let [one, other] = [ours.error(&pose).unwrap(), theirs.error(&pose).unwrap()];
        assert!(one.iter().zip(other).all(|(one, other)| (one - other).abs() < 1e-8), "{one:?} {other:?}");
    }
    // The other format has tables of one axis, and says so.
    let export = machine.export(Format::Etalon, &options()).unwrap();
    let said: Vec<String> = export.left_out.iter().map(ToString::to_string).collect();
    assert_eq!(said, ["EYX: it depends on several axes, but the tables of this format have one"]);
}

#[test]
fn a_wave_that_grows_along_its_axis_is_carried_at_its_nodes() {
    // 30 um/m of x: 12 um at 400 mm. 101 points over 500 mm follow a wave of 100 mm, but for the arrow over 5 mm of its sine.
    let wave = "EXX: [{cyclic: {amplitude: 30 um/m, period: 100 mm, phase: 0 rad, times: [{position: X}]}}]"
        .to_owned();
    let machine = Machine::of("FXYZ", &[wave]);
    let export = machine.export(Format::Isg, &Options { points: Some(101), ..options() }).unwrap();
    let arrow = 12e-3 * (1.0 - (std::f64::consts::PI * 2.5 / 50.0).cos());
    assert!(export.lost.lost.largest < 1.1 * arrow, "{:?} of {arrow}", export.lost);
}

#[test]
fn what_a_single_axis_cannot_know_is_lost_as_a_lever_arm_says() {
    // EAY of 40 urad turns the tool about the frame of Y: the tip, 150 mm and z above it, goes towards -Y by 40 urad times that. What
    // stands in the table of Y is right at the reference, z = 0; at the ends of Z, 100 mm from it, 4 um are missing.
    let machine = Machine::of("FXYZ", &["EAY: 40 urad".to_owned()]);
    let export = machine.export(Format::LinuxCnc, &options()).unwrap();
    assert!((export.lost.lost.largest - 4e-3).abs() < 1e-6, "{:?}", export.lost);
}

#[test]
fn terms_of_temperature_and_time_are_named_with_their_size() {
    let errors = ["EXX: [{expansion: {axis: X, sensor: bed, coefficient: 10 um/m/K, reference: 20 degC}}, {lag: {axis: X, gain: 20 1/s}}]".to_owned()];
    let machine = Machine::of("FXYZ", &errors);
    let (geometry, space) = (machine.geometry(), machine.space());
    let export = machine.export(Format::LinuxCnc, &options()).unwrap();
    let text = abbe_exchange::controller::text(&geometry, &space, &export.lost);
    assert!(text.contains("EXX expansion: up to 4.00 um for each degC from its reference"), "{text}");
    assert!(text.contains("EXX lag: up to 833.33 um at a feed of 1000 mm/min"), "{text}");
}
