//! Rotary axes in controllers' tables: a table C that stands 10 arcsec too far at 90 deg. Its command must be 10 arcsec less there,
//! which is 1/360 deg, whatever it does to the tip; a wrong sign, or a value in rad, would show.

use abbe_exchange::controller::{Format, Options, Sense};

use crate::machine::{Machine, options, text};

/// A part on a table C, with slides above it.
fn table() -> Machine {
    Machine::of(
        "CFXYZ",
        &[
            "ECC: [{table: {start: 0 deg, step: 90 deg, unit: arcsec, values: [0, 10, 4, -6, 0]}}]"
                .to_owned(),
            "EXX: [{polynomial: {unit: um, per: mm, coefficients: [0, 0.02]}}]".to_owned(),
        ],
    )
}

fn asked() -> Options {
    let mut options = Options { points: Some(5), sense: Some(Sense::Error), ..options() };
    options.counts.push(("C".to_owned(), 36_000.0));
    options
}

#[test]
fn every_format_with_a_place_for_it_carries_the_angle() {
    for (format, least) in [
        (Format::LinuxCnc, 1e-5),
        (Format::Sinumerik, 1e-5),
        (Format::Heidenhain, 1e-5),
        // A sixteenth of a count of 0.1 um.
        (Format::Pmac, 1e-4),
    ] {
        let options = match format {
            Format::LinuxCnc | Format::Pmac => Options { sense: None, ..asked() },
            _ => asked(),
        };
        let export = table().export(format, &options).unwrap();
        let lost = export.lost;
        assert!(lost.without.largest > 0.02, "{format:?}: {lost:?}");
        assert!(lost.with_abbe.largest < 1e-6, "{format:?}: {lost:?}");
        assert!(lost.lost.largest < least, "{format:?}: {lost:?}");
    }
}

#[test]
fn the_sign_and_the_unit_are_those_of_the_controller() {
    let with = |format, sense| table().export(format, &Options { sense, ..asked() }).unwrap();
    let row = |text: &str, start: &str| text.lines().find(|line| line.starts_with(start)).unwrap().to_owned();
    let linuxcnc = with(Format::LinuxCnc, None);
    // c + c (10/3600)/90 = 90: c is 90 less 10/3600 / (1 + 10/3600/90).
    assert_eq!(row(text(&linuxcnc, "c.comp"), "90.0"), "90.00000000 -0.00277769 -0.00277769");
    let sinumerik = with(Format::Sinumerik, Some(Sense::Error));
    let archive = text(&sinumerik, "eec.ini");
    assert_eq!(row(archive, "$AA_ENC_COMP[0,1,C1]"), "$AA_ENC_COMP[0,1,C1]=0.00277769");
    assert_eq!(row(archive, "$AA_ENC_COMP_MAX[0,C1]"), "$AA_ENC_COMP_MAX[0,C1]=360.000000");
    // C may wind up, X may not.
    assert_eq!(row(archive, "$AA_ENC_COMP_IS_MODULO[0,C1]"), "$AA_ENC_COMP_IS_MODULO[0,C1]=1");
    assert_eq!(row(archive, "$AA_ENC_COMP_IS_MODULO[0,X1]"), "$AA_ENC_COMP_IS_MODULO[0,X1]=0");
    let heidenhain = with(Format::Heidenhain, Some(Sense::Correction));
    let rows = row(text(&heidenhain, "AXIS_C.COM"), "1 ");
    let numbers: Vec<&str> = rows.split_whitespace().collect();
    assert_eq!(numbers, ["1", "90.000000", "-0.00277769", "-0.00277769"]);
    // 10 arcsec are 100 counts of 36000 for a degree: 1600 sixteenths. A turn is 12 960 000 counts, without a gap.
    let pmac = with(Format::Pmac, None);
    let commands = text(&pmac, "compensation.pmc");
    let head = commands.lines().position(|line| line.ends_with("DEFINE COMP 4,#4D,#4,12960000")).unwrap();
    assert_eq!(commands.lines().nth(head + 1), Some("-1600 -640 960 0"));
}

#[test]
fn a_motor_without_counts_is_told() {
    let options = Options { sense: None, ..options() };
    let export = table().export(Format::Pmac, &options).unwrap();
    assert!(export.left_out.iter().any(|line| line.contains("--counts C=")), "{:?}", export.left_out);
}
