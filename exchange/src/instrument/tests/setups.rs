//! Set-ups: what is wrong with faulty ones, with its code and place, alone and with the files that they name.

use super::{HEAD, machine, outcome, rtl, setup_of, table};

#[test]
fn a_whole_set_up_is_read() {
    let text = "setup: 1
machine: m
source: the laboratory, in May
constants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}
limits: {compensation: 0.2 mm}
errors: {EA0Z: 3 arcsec}
measurements:
  - motion: EXX
    data: x.rtl
    targets: {most_negative: -500 mm, sign: -1, unit: mm, column: t}
    deviations: {sign: -1, unit: um, column: d, zero_at: 0 mm}
    runs: alternating
    reversal: backlash
    smooth: 3
    resample: 10 mm
  - {motion: EAZ, axis: Z, data: z.csv, deviations: {unit: arcsec}}
";
    let (setup, found) = setup_of(text, &machine("XYFZ"));
    assert!(found.is_empty(), "{found:?}");
    let setup = setup.unwrap();
    assert_eq!(setup.measurements.len(), 2);
    assert_eq!(setup.known.source.as_deref(), Some("the laboratory, in May"));
    assert_eq!(setup.known.motions.len(), 1);
}

#[test]
fn a_faulty_set_up_is_marked_where_it_is_faulty() {
    let cases = [
        ("  - {motion: EXX}", "E0901", "{motion: EXX}"),
        ("  - {data: d}", "E0901", "{data: d}"),
        ("  - {motion: EXX, data: d, sign: -1}", "E0903", "sign"),
        ("  - {motion: EXX, data: d, targets: {start: 0 mm}}", "E0903", "start"),
        ("  - {motion: EXX, data: [d]}", "E0904", "[d]"),
        ("  - {motion: EXQ, data: d}", "E0905", "EXQ"),
        ("  - {motion: EC0Y, data: d}", "E0905", "EC0Y"),
        ("  - {motion: EXX, data: d, axis: W}", "E0906", "W"),
        ("  - {motion: EXX, data: d, at: {X: 1 mm}}", "E0906", "X"),
        ("  - {motion: EXX, data: d, at: {Q: 1 mm}}", "E0906", "Q"),
        ("  - {motion: EXX, data: d, at: {Z: 1 deg}}", "E0307", "deg"),
        ("  - {motion: EXX, data: d, at: 5 mm}", "E0904", "5 mm"),
        ("  - {motion: EAX, data: d, at: {Z: 1 mm}}", "E0910", "at"),
        ("  - {motion: EXX, data: d, targets: {sign: 2}}", "E0907", "2"),
        ("  - {motion: EXX, data: d, runs: both}", "E0907", "both"),
        ("  - {motion: EXX, data: d, remove: slope}", "E0907", "slope"),
        ("  - {motion: EXX, data: d, smooth: 4}", "E0907", "4"),
        ("  - {motion: EXX, data: d, resample: 0 mm}", "E0907", "0 mm"),
        ("  - {motion: EXX, data: d, targets: {origin: 5}}", "E0306", "5"),
        ("  - {motion: EXX, data: d, targets: {unit: deg}}", "E0908", "deg"),
        ("  - {motion: EAX, data: d, deviations: {unit: um}}", "E0908", "um"),
        (
            "  - {motion: EXX, data: d, targets: {origin: 0 mm, most_negative: 0 mm}}",
            "E0910",
            "most_negative",
        ),
        ("  - {motion: EXX, data: d}\n  - {motion: EXX, data: e}", "E0911", "EXX"),
        ("  - {motion: EYX, data: d, reference: s, remove: ends}", "E0910", "remove"),
        ("  - {motion: EYX, data: d, turned: true}", "E0912", "EYX"),
        ("  - {motion: EXX, data: d, turned: true}", "E0912", "turned"),
        ("  - {motion: EYX, data: d, reference: square}", "E0912", "square"),
    ];
    for (measurements, code, marked) in cases {
        let text = format!("{HEAD}{measurements}");
        let (setup, found) = setup_of(&text, &machine("XYFZ"));
        assert!(setup.is_none(), "{measurements}");
        assert_eq!(found.first(), Some(&(code, marked.to_owned())), "{measurements}");
    }
    let heads = [
        ("setup: 2\nmachine: m\nmeasurements: [{motion: EXX, data: d}]", "E0902", "2"),
        ("calibration: 1\nmachine: m", "E0902", "calibration"),
        ("setup: 1\nmeasurements: []", "E0901", "setup"),
        ("setup: 1\nmachine: m\nmeasurements: []", "E0901", "[]"),
        ("setup: 1\nmachine: m\nmeasured: []", "E0903", "measured"),
        (
            "setup: 1\nmachine: m\nreferences: {a: {angle: 1 urad}}\nmeasurements: [{motion: EXX, data: d}]",
            "E0912",
            "a",
        ),
        ("setup: 1\nmachine: m\nerrors: {EXX: 1 um}\nmeasurements: [{motion: EXX, data: d}]", "E0911", "EXX"),
    ];
    for (text, code, marked) in heads {
        let (setup, found) = setup_of(text, &machine("FX"));
        assert!(setup.is_none(), "{text}");
        assert!(found.contains(&(code, marked.to_owned())), "{text}: {found:?}");
    }
}

fn up_and_down() -> String {
    rtl(&[0.0, 10.0, 20.0], &[(true, vec![1.0, 2.0, 3.0]), (false, vec![1.0, 2.0, 4.0])])
}

#[test]
fn what_neither_file_nor_set_up_tells_is_asked_for() {
    let bare = "target,deviation\n0,1\n10,2\n20,2\n".to_owned();
    let sorted = "run,target,deviation\n#unit,,mm,um\n1,0,1\n1,10,2\n2,0,1\n2,10,2\n".to_owned();
    let flagged = up_and_down().replace("Flags: 0 0 2 0", "Flags: 0 1 2 0");
    let cases = [
        (bare.clone(), "", "E0909", "d"),
        (bare.clone(), ", targets: {unit: mm}", "E0909", "d"),
        (up_and_down(), ", deviations: {unit: nm}", "E0909", "d"),
        (table(&[0.0, 1.0], &[(true, vec![0.0, 1.0])]).replace("mm,um", "deg,um"), "", "E0908", "d"),
        (sorted.clone(), "", "E0916", "d"),
        (flagged, "", "E0916", "d"),
        (up_and_down(), ", runs: ascending", "E0916", "ascending"),
        (table(&[0.0, 1.0], &[(true, vec![0.0, 1.0])]), ", runs: ascending", "E0910", "ascending"),
        ("target,deviation\n#unit,mm,um\n0,1\n".to_owned(), "", "E0916", "d"),
        (table(&[0.0], &[(true, vec![0.0])]), "", "E0917", "d"),
        (up_and_down(), ", deviations: {zero_at: 21 mm}", "E0917", "21 mm"),
        (up_and_down(), ", resample: 1 um", "E0907", "1 um"),
        (up_and_down().replace("   20.000000", "10.0000000001"), "", "E0928", "d"),
        (
            up_and_down().replace("Linear", "Other").replace("   20.000000", "   1.7e308"),
            ", targets: {unit: m}, deviations: {unit: um}",
            "E0926",
            "d",
        ),
    ];
    for (file, extra, code, marked) in cases {
        let (one, found, _) =
            outcome("FX", &format!("  - {{motion: EXX, data: d{extra}}}"), std::slice::from_ref(&file));
        assert!(one.is_none(), "{file}");
        assert_eq!(found.first(), Some(&(code, marked.to_owned())), "{extra}\n{file}");
    }
    let told = outcome("FX", "  - {motion: EXX, data: d, runs: alternating}", &[sorted]).0.unwrap();
    assert_eq!(told.motions[0].parts[0].runs, [1, 1]);
    let units = "  - {motion: EXX, data: d, targets: {unit: mm}, deviations: {unit: um}}";
    assert!(outcome("FX", units, &[bare]).0.is_some());
}

/// Some programs fill the way back of a measurement in one direction with zeros.
#[test]
fn zeros_that_fill_the_way_back_are_left_out_and_told() {
    let runs = [
        (true, vec![1.0, 2.0, 3.0]),
        (false, vec![0.0; 3]),
        (true, vec![3.0, 4.0, 5.0]),
        (false, vec![0.0; 3]),
    ];
    let file = rtl(&[0.0, 10.0, 20.0], &runs).replace("Flags: 0 0 2 0", "Flags: 0 1 2 0");
    let (one, _, findings) = outcome("FX", "  - {motion: EXX, data: d}", &[file]);
    assert_eq!(one.unwrap().motions[0].parts[0].runs, [2, 0]);
    assert_eq!(findings.data[0].iter().map(|one| one.code).collect::<Vec<_>>(), ["W0903", "W0903"]);
}

#[test]
fn what_a_machine_does_not_show_alone_is_refused() {
    let square = "  - {motion: EYX, data: a, reference: s}\n  - {motion: EZX, data: b, reference: s}";
    let (one, found, _) = outcome("XYFZ", square, &[up_and_down(), up_and_down()]);
    assert!(one.is_none());
    assert_eq!(found, [("E0912", "s".to_owned())]);
    let over = "  - {motion: EYX, data: a}\n  - {motion: EYX, data: b, turned: true}";
    let shifted = up_and_down().replace("   20.000000", "   30.000000");
    let (one, found, _) = outcome("XYFZ", over, &[up_and_down(), shifted]);
    assert!(one.is_none());
    assert_eq!(found, [("E0918", "EYX".to_owned())]);
}

/// The same numbers are small in um and are not in mm: the unit is wrong, and where it stands is marked.
#[test]
fn a_unit_that_makes_errors_large_is_marked_where_it_stands() {
    let bare = "target,deviation\n0,1\n10,20\n20,35\n".to_owned();
    let given = "target,deviation\n#unit,mm,mm\n0,1\n10,20\n20,35\n".to_owned();
    let set_up = |unit: &str| {
        format!("  - {{motion: EXX, data: d, targets: {{unit: mm}}, deviations: {{unit: {unit}}}}}")
    };
    let faulty = [(set_up("mm"), &bare, "mm"), ("  - {motion: EXX, data: d}".to_owned(), &given, "d")];
    for (measurement, file, marked) in faulty {
        let (one, found, findings) = outcome("FX", &measurement, std::slice::from_ref(file));
        assert!(one.is_none(), "{measurement}");
        assert_eq!(found, [("E0430", marked.to_owned())], "{measurement}");
        let told: Vec<&str> = findings.setup.iter().map(|one| one.message.as_str()).collect();
        assert_eq!(told, ["35 mm is not a small error"]);
    }
    assert!(outcome("FX", &set_up("um"), &[bare]).0.is_some());
}
