//! What is refused, with what to do instead; and hostile files.

use std::sync::LazyLock;

use abbe_exchange::controller::{Format, Options, Sense, Space, Unusable, Wanted, check};
use model_dsl::source::SourceFile;
use proptest::prelude::*;

use crate::machine::{Machine, options};

fn scaled(word: &str) -> Machine {
    Machine::of(
        word,
        &["EXX: [{polynomial: {axis: X, unit: um, per: mm, coefficients: [0, 0.1]}}]".to_owned()],
    )
}

fn refusal(machine: &Machine, format: Format, options: &Options) -> String {
    machine.export(format, options).unwrap_err().to_string()
}

#[test]
fn more_points_than_a_controller_takes_are_refused_not_cut() {
    let text = refusal(&scaled("FXYZ"), Format::LinuxCnc, &Options { points: Some(257), ..options() });
    assert!(text.contains("257 points") && text.contains("--points 256"), "{text}");
    // Refused before there is a table of that size.
    for format in [Format::LinuxCnc, Format::Isg, Format::Sinumerik, Format::Pmac] {
        let text = refusal(&scaled("FXYZ"), format, &Options { points: Some(usize::MAX), ..options() });
        assert!(text.contains("the controller takes"), "{text}");
    }
}

#[test]
fn a_step_that_cannot_be_written_is_refused() {
    let text = refusal(&scaled("FXYZ"), Format::Sinumerik, &Options { points: Some(8), ..options() });
    assert!(text.contains("8 points over X") && text.contains("--points"), "{text}");
}

#[test]
fn a_sign_that_nobody_knows_is_asked_for() {
    let text = refusal(&scaled("FXYZ"), Format::Heidenhain, &options());
    assert!(text.contains("--value error or --value correction"), "{text}");
    let errors = ["EYX: [{polynomial: {axis: X, unit: um, per: mm, coefficients: [0, 0.1]}}]".to_owned()];
    let export = Machine::of("FXYZ", &errors).export(Format::Sinumerik, &options()).unwrap();
    assert_eq!(export.files.len(), 1, "no cross tables");
    assert!(export.left_out[0].contains("CEC"), "{:?}", export.left_out);
}

#[test]
fn counts_that_nobody_said_are_asked_for() {
    let text = refusal(&scaled("FXYZ"), Format::Pmac, &Options { counts: Vec::new(), ..options() });
    assert!(text.contains("--counts X=10000"), "{text}");
}

#[test]
fn a_correction_beyond_the_limit_is_refused() {
    let machine = "abbe: 1\nname: m\ntopology: FXYZ\n";
    let rest = "limits: {compensation: 20 um}\nerrors:\n  EXX: [{polynomial: {axis: X, unit: um, per: mm, coefficients: [0, 0.1]}}]\n";
    let text = refusal(&Machine::new(machine, rest), Format::LinuxCnc, &options());
    assert!(text.contains("exceeds the calibration's limit of 0.02 mm"), "{text}");
}

#[test]
fn files_that_would_make_the_machine_worse_are_refused() {
    // C moves X by 30 um times the cosine of its angle. A table of X over X holds what is right at 0 deg, and is twice as wrong at
    // 180 deg: 30 um (cos C - 1), whose rms is the square root of three times that without.
    let machine = Machine::new(
        "abbe: 1\nname: m\ntopology: CFXYZ\n",
        "errors:\n  EXC: [{cyclic: {axis: C, period: 360 deg, amplitude: 30 um, phase: 90 deg}}]\n",
    );
    let wanted = Wanted {
        ranges: [("X", 100.0), ("Y", 100.0), ("Z", 100.0), ("C", std::f64::consts::TAU)]
            .map(|(axis, end)| (axis.to_owned(), [0.0, end]))
            .to_vec(),
        reference: vec![("C".to_owned(), 0.0)],
    };
    let space = Space::new(&machine.equations, &machine.calibration, &wanted).unwrap();
    let refused =
        abbe_exchange::controller::export(&machine.geometry(), &space, Format::LinuxCnc, &options());
    let text = refused.unwrap_err().to_string();
    assert!(text.contains("would be 36.") && text.contains("with these files and 21."), "{text}");
}

#[test]
fn volumetric_compensation_is_for_three_slides() {
    let text = refusal(&scaled("ZFX"), Format::Isg, &options());
    assert!(text.contains("three slides X, Y, Z"), "{text}");
}

#[test]
fn an_axis_of_which_nothing_is_known_is_asked_for() {
    let machine = scaled("FXYZ");
    let space = |ranges: &[(&str, [f64; 2])], reference: &[(&str, f64)]| {
        let wanted = Wanted {
            ranges: ranges.iter().map(|(axis, range)| ((*axis).to_owned(), *range)).collect(),
            reference: reference.iter().map(|(axis, place)| ((*axis).to_owned(), *place)).collect(),
        };
        Space::new(&machine.equations, &machine.calibration, &wanted)
    };
    let all = [("X", [0.0, 500.0]), ("Y", [0.0, 300.0]), ("Z", [-200.0, 0.0])];
    assert!(space(&all, &[]).is_ok());
    for (ranges, reference, says) in [
        (&all[..1], &[][..], "gives the travel of Y"),
        (&[("X", [5.0, 5.0]), all[1], all[2]][..], &[], "the range of X is empty"),
        (&[("Q", [0.0, 5.0])][..], &[], "no axis Q"),
        (&all[..], &[("Z", 5.0)][..], "--at Z is outside"),
    ] {
        let text = space(ranges, reference).unwrap_err().to_string();
        assert!(text.contains(says), "{text}");
    }
}

#[test]
fn a_table_that_contradicts_itself_is_shown() {
    let machine = scaled("FXYZ");
    for (format, text, code, says) in [
        (
            Format::Sinumerik,
            "$AA_ENC_COMP[0,0,X1]=0.1\n$AA_ENC_COMP[0,1,X1]=0.1\n$AA_ENC_COMP_STEP[0,X1]=6.73\n$AA_ENC_COMP_MIN[0,X1]=0\n$AA_ENC_COMP_MAX[0,X1]=8\n",
            "E0803",
            "do not reach",
        ),
        (Format::Sinumerik, "$AA_ENC_COMP[0,0,Q1]=0.1\n", "E0804", "`Q1`"),
        (Format::Sinumerik, "hello\n", "E0802", "hello"),
        (Format::Isg, "X EXX\n0 0.1\n0 0.2\n", "E0803", "not a full grid"),
        (Format::Isg, "X EXX\n0 nan\n", "E0801", "nan"),
        (Format::Isg, "X EXQ\n0 0.1\n", "E0804", "EXQ"),
        (Format::Etalon, "[EXX]\nGridpoints = {\n0 0.1\n", "E0802", "[EXX]"),
        (
            Format::Heidenhain,
            "BEGIN AXIS_X.COM MM\nNR AXISPOS BACKLASH X\n0 0.0 0.1 0.1\n",
            "E0802",
            "0 0.0 0.1 0.1",
        ),
        (Format::Pmac, "#1 DEFINE COMP 3,#1D,#1,3000\n1 2\n", "E0802", "DEFINE COMP"),
    ] {
        let options = Options { sense: Some(Sense::Error), ..options() };
        let files = [(SourceFile::new("file", text), None)];
        match check(&machine.geometry(), &machine.space(), format, &options, &files) {
            Err(Unusable::File(told)) => assert!(told.contains(code) && told.contains(says), "{told}"),
            other => panic!("{format:?} {text}: {other:?}"),
        }
    }
}

#[test]
fn names_are_each_axis_its_own_and_motors_are_numbers() {
    let named = |names: &[(&str, &str)]| Options {
        names: names.iter().map(|(axis, name)| ((*axis).to_owned(), (*name).to_owned())).collect(),
        sense: Some(Sense::Error),
        ..options()
    };
    for (format, names, says) in [
        (Format::Heidenhain, &[("X", "Y")][..], "X and Y are both called `Y`"),
        (Format::Sinumerik, &[("X", "Y1")], "X and Y are both called `Y1`"),
        (Format::Pmac, &[("X", "2")], "X and Y are both called `2`"),
        (Format::Pmac, &[("X", "MX1")], "`MX1` is not a motor"),
    ] {
        let text = refusal(&scaled("FXYZ"), format, &named(names));
        assert!(text.contains(says), "{text}");
    }
}

#[test]
fn cross_tables_that_add_nothing_are_told() {
    let machine = scaled("FXYZ");
    let table = "$AN_CEC[0,0]=0\n$AN_CEC[0,1]=0.1\n$AN_CEC_INPUT_AXIS[0]=(X1)\n$AN_CEC_OUTPUT_AXIS[0]=(Y1)\n$AN_CEC_STEP[0]=500\n$AN_CEC_MIN[0]=-100\n$AN_CEC_MAX[0]=400\n$AN_CEC_MULT_BY_TABLE[0]=7\n";
    let told = |sense| {
        let files = [(SourceFile::new("cec.ini", table), None)];
        let options = Options { sense, ..options() };
        check(&machine.geometry(), &machine.space(), Format::Sinumerik, &options, &files).unwrap().findings
    };
    assert!(told(None)[0].contains("--value"), "{:?}", told(None));
    let findings = told(Some(Sense::Error));
    assert!(findings[0].contains("table 0") && findings[0].contains("number 7"), "{findings:?}");
}

#[test]
fn the_tip_of_a_volumetric_file_counts() {
    let machine = Machine::of(
        "FXYZ",
        &["EAX: [{polynomial: {axis: X, unit: urad, per: mm, coefficients: [0, 0.2]}}]".to_owned()],
    );
    let export = machine.export(Format::Isg, &options()).unwrap();
    assert!(export.lost.lost.largest < 1e-6);
    let text = export.files[0].text.replace("20.000000 20.000000 150.000000", "20 20 50");
    assert_ne!(text, export.files[0].text);
    let files = [(SourceFile::new("volumetric.csv", text), None)];
    let checked = check(&machine.geometry(), &machine.space(), Format::Isg, &options(), &files).unwrap();
    // 100 mm of the lever arm are missing: 0.2 urad for each of the 250 mm from the reference, 5 um.
    assert!((checked.lost.lost.largest - 5e-3).abs() < 1e-5, "{:?}", checked.lost);
}

const FORMATS: [Format; 6] =
    [Format::LinuxCnc, Format::Isg, Format::Etalon, Format::Sinumerik, Format::Heidenhain, Format::Pmac];

/// A machine, and its files of each format in one text, to be spoilt.
static WHOLE: LazyLock<(Machine, Vec<String>)> = LazyLock::new(|| {
    let machine = scaled("FXYZ");
    let options = Options { sense: Some(Sense::Error), points: Some(6), ..options() };
    let files =
        |format| machine.export(format, &options).unwrap().files.into_iter().map(|file| file.text).collect();
    let whole = FORMATS.map(files).to_vec();
    (machine, whole)
});

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn spoilt_files_end_in_an_answer_or_a_finding(cut in 0..4000_usize, more in "[ -~\n]{0,40}") {
        let (machine, whole) = &*WHOLE;
        for (format, text) in FORMATS.into_iter().zip(whole) {
            let mut text = text.clone();
            text.insert_str(cut % (text.len() + 1), &more);
            let options = Options { sense: Some(Sense::Error), ..options() };
            let files = [(SourceFile::new("file", text), Some(0))];
            if let Ok(checked) = check(&machine.geometry(), &machine.space(), format, &options, &files) {
                prop_assert!(checked.lost.lost.rms.is_finite());
            }
        }
    }
}
