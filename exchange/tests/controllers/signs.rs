//! Signs, worked out by hand. X runs 100 um/m too far: at 100 mm it is 10 um beyond, so that its command must be 10 um less.
//! Every format says that in its own way; a wrong sign would double the error.

use abbe_exchange::controller::{Format, Kind, Options, Sense, Unit, VolumetricForm, volumetric_terms};
use model_dsl::calibration::CalibratedTerm;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;

use crate::machine::{Machine, options, text};

fn too_far() -> Machine {
    Machine::of(
        "FXYZ",
        &["EXX: [{polynomial: {axis: X, unit: um, per: mm, coefficients: [0, 0.1]}}]".to_owned()],
    )
}

#[test]
fn linuxcnc_adds_the_trim_and_makes_it_of_where_the_joint_is() {
    let machine = too_far();
    let export = machine.export(Format::LinuxCnc, &Options { points: Some(6), ..options() }).unwrap();
    let row =
        |text: &str| text.lines().find(|line| line.starts_with("100.0")).map(ToOwned::to_owned).unwrap();
    // 10 um less, apart from the error of the 10 um themselves: 1 nm.
    assert_eq!(row(text(&export, "x.comp")), "100.000000 -0.009999 -0.009999");
    let positions = Options { points: Some(6), kind: Kind::Actual, ..options() };
    let export = machine.export(Format::LinuxCnc, &positions).unwrap();
    assert_eq!(row(text(&export, "x.comp")), "100.000000 100.009999 100.009999");
    let inches = Options { points: Some(6), unit: Unit::INCH, ..options() };
    let export = machine.export(Format::LinuxCnc, &inches).unwrap();
    assert!(
        text(&export, "x.comp").contains("3.93700787 -0.00039366 -0.00039366"),
        "100 mm, 10 um in inches"
    );
}

#[test]
fn sinumerik_subtracts_what_stands_in_the_screw_table() {
    let export = too_far().export(Format::Sinumerik, &Options { points: Some(6), ..options() }).unwrap();
    let text = text(&export, "eec.ini");
    // -100, 0, 100: the third point.
    assert!(text.contains("$AA_ENC_COMP[0,2,X1]=0.009999\n"), "{text}");
    for line in [
        "$AA_ENC_COMP_STEP[0,X1]=100.000000",
        "$AA_ENC_COMP_MIN[0,X1]=-100.000000",
        "$AA_ENC_COMP_MAX[0,X1]=400.000000",
    ] {
        assert!(text.contains(line), "{text}");
    }
}

#[test]
fn volumetric_files_hold_the_error_itself() {
    for (format, name, line) in [
        (Format::Isg, "volumetric.csv", "\nX EXX\n-100.000000 -0.010000000000\n"),
        (Format::Etalon, "volumetric.txt", "[EXX]\nGridpoints = {\n-100.000000 -0.010000000000\n"),
    ] {
        let export = too_far().export(format, &options()).unwrap();
        assert!(text(&export, name).contains(line), "{}", text(&export, name));
    }
}

#[test]
fn no_offset_of_a_frame_turns_the_sign_of_an_angle() {
    // ISO 230-1 counts a rotation about Y by the right hand wherever the carriage stands: here 2 m above the bed's zero, so that
    // the tip lies below the bed's zero and above the carriage's.
    for (origin, word) in [("[0, 0, -2000]", "on a column"), ("[0, 0, 0]", "at the zero")] {
        let text = format!(
            "abbe: 1\nname: m\nchain:\n  tool:\n    - {{slide: X, along: +X, origin: {origin}}}\n    - {{slide: Y, along: +Y}}\n    - {{slide: Z, along: +Z}}\n    - {{tool: tip, offset: [Xt, Yt, Zt]}}\n"
        );
        let machine = Machine::new(&text, "errors: {EBX: 3 urad}\n");
        let source = SourceFile::new("volumetric", "EBX\n0.00002\n");
        let mut diagnostics = Diagnostics::new();
        let terms = volumetric_terms(
            &machine.equations,
            &machine.calibration,
            &source,
            VolumetricForm::Isg,
            &mut diagnostics,
        );
        let motion = machine.equations.motions.iter().position(|motion| motion.name == "EBX").unwrap();
        assert_eq!(terms.unwrap(), [(motion, CalibratedTerm::Constant { value: 0.00002 })], "{word}");
    }
}

#[test]
fn a_pmac_adds_sixteenths_of_a_count() {
    let export = too_far().export(Format::Pmac, &Options { points: Some(6), ..options() }).unwrap();
    // 10 000 counts/mm: 10 um are 100 counts, 1600 sixteenths, less one in ten thousand. From one spacing on 100, 200, 300,
    // 400 mm, the gap, -100 mm, 0.
    let text = text(&export, "compensation.pmc");
    assert!(
        text.contains("#1 DEFINE COMP 7,#1D,#1,7000000\n-1600 -3200 -4800 -6399 -6399 1600 0\n"),
        "{text}"
    );
}

#[test]
fn heidenhain_says_what_the_user_says_that_it_says() {
    for (sense, number) in [(Sense::Error, "0.009999"), (Sense::Correction, "-0.009999")] {
        let options = Options { points: Some(6), sense: Some(sense), ..options() };
        let export = too_far().export(Format::Heidenhain, &options).unwrap();
        let text = text(&export, "AXIS_X.COM");
        let row: Vec<&str> = text.lines().nth(4).unwrap().split_whitespace().collect();
        assert_eq!(row, ["2", "100.000000", number, number], "{text}");
    }
}

#[test]
fn lost_motion_is_made_up_for_in_the_direction_of_motion() {
    // A play of 10 um: the axis stays 5 um behind in either direction, and must be sent 5 um further.
    let machine = Machine::of("FXYZ", &["EXX: [{backlash: {lost_motion: 10 um}}]".to_owned()]);
    let export = machine.export(Format::LinuxCnc, &options()).unwrap();
    assert!(text(&export, "x.comp").lines().all(|line| line.ends_with("0.005000 -0.005000")));
    let export = machine.export(Format::Pmac, &options()).unwrap();
    // Subtracted in the negative direction alone: 10 um of 10 000 counts/mm, in sixteenths.
    assert!(
        text(&export, "compensation.pmc").contains("I186=1600\n"),
        "{}",
        text(&export, "compensation.pmc")
    );
    let cross = Options { sense: Some(Sense::Correction), ..options() };
    let export = machine.export(Format::Sinumerik, &cross).unwrap();
    let cec = text(&export, "cec.ini");
    assert!(cec.contains("$AN_CEC[0,0]=0.005000000\n") && cec.contains("$AN_CEC_DIRECTION[0]=1\n"), "{cec}");
    assert!(
        cec.contains("$AN_CEC[1,0]=-0.005000000\n") && cec.contains("$AN_CEC_DIRECTION[1]=-1\n"),
        "{cec}"
    );
}

#[test]
fn a_lever_arm_becomes_a_product_of_tables() {
    // EBX turns the tool about Y: with the tip at a height z below the carriage X moves by EBX times that height.
    let machine = Machine::of(
        "FXYZ",
        &["EBX: [{polynomial: {axis: X, unit: urad, per: mm, coefficients: [0, 1]}}]".to_owned()],
    );
    let options = Options { sense: Some(Sense::Error), points: Some(6), ..options() };
    let export = machine.export(Format::Sinumerik, &options).unwrap();
    let cec = text(&export, "cec.ini");
    assert!(
        cec.contains("$AN_CEC_MULT_BY_TABLE[0]=2\n") || cec.contains("$AN_CEC_MULT_BY_TABLE[1]=3\n"),
        "{cec}"
    );
    // Second order alone is left: 400 urad times as much again.
    assert!(export.lost.without.largest > 0.07 && export.lost.lost.largest < 1e-4, "{:?}", export.lost);
}
