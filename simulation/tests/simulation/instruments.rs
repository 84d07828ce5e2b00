//! Instruments, each against its own short formula.

use abbe_simulation::path::{Path, Shape, Stations, Stroke};
use abbe_simulation::{Commands, Datum, Instrument, Measurement, Normal, replay, simulate, write};

use crate::common::{Built, circle, line, path, plant, scenario};

#[test]
fn a_ballbar_sees_an_eccentric_centre_as_a_distance() {
    let plant = plant("XYFZ", "{}");
    let eccentricity = [0.006, -0.003, 0.05];
    let instrument = Instrument::Ballbar { center: None, radius: None, eccentricity, offset: 0.002 };
    let mut wanted = scenario(path(circle(100.0), 20.0, 30.0), instrument);
    wanted.path.at = vec![vec![275.0], vec![140.0], vec![-50.0]];
    let recorded = simulate(&plant, &wanted).unwrap();
    let center = match recorded.instrument {
        Instrument::Ballbar { center: Some(center), radius: Some(100.0), .. } => center,
        ref other => panic!("{other:?}"),
    };
    for (found, wanted) in center.iter().zip([275.0, 140.0, 70.0]) {
        assert!((found - wanted).abs() < 1e-12, "the tool is 120 mm long");
    }
    for (row, reading) in recorded.readings[0].values.iter().enumerate() {
        let (x, y) = (recorded.commands[0][row] - 275.0, recorded.commands[1][row] - 140.0);
        let away = ((x - 0.006).powi(2) + (y + 0.003).powi(2) + 0.05_f64.powi(2)).sqrt();
        assert!((reading - (away - 100.0 + 0.002)).abs() < 1e-10);
    }
}

#[test]
fn a_misaligned_laser_reads_short() {
    let plant = plant("FX", "{EXX: [{polynomial: {per: mm, unit: mm, coefficients: [0, 1e-5]}}]}");
    let instrument = Instrument::Linear { axis: 0, direction: [1.0, 0.0, 0.0], cosine: 2e-3 };
    let recorded = simulate(&plant, &scenario(path(line(0, 10.0, 510.0), 100.0, 10.0), instrument)).unwrap();
    for (reading, q) in recorded.readings[0].values.iter().zip(&recorded.commands[0]) {
        let length = q * (1.0 + 1e-5) - 10.0;
        assert!((reading - (2e-3_f64.cos() * length - (q - 10.0))).abs() < 1e-10);
    }
}

#[test]
fn straightness_and_angles_are_read_alone() {
    let errors = "{EXX: 3 um, EZX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.02]}}], EBX: [{polynomial: {per: mm, unit: urad, coefficients: [5, 0.1]}}]}";
    let plant = plant("FX", errors);
    let recorded =
        |instrument| simulate(&plant, &scenario(path(line(0, 0.0, 300.0), 30.0, 5.0), instrument)).unwrap();
    let straight = recorded(Instrument::Straightness { axis: 0, direction: [0.0, 0.0, 1.0] });
    let turned = recorded(Instrument::Angular { axis: Some(0), about: [0.0, 1.0, 0.0] });
    for (row, q) in straight.commands[0].iter().enumerate() {
        assert!((straight.readings[0].values[row] - 2e-5 * q).abs() < 1e-12);
        assert!((turned.readings[0].values[row] - (5e-6 + 1e-7 * q)).abs() < 1e-12);
    }
    let across = recorded(Instrument::Angular { axis: Some(0), about: [1.0, 0.0, 0.0] });
    assert!(across.readings[0].values.iter().all(|value| value.abs() < 1e-12));
}

#[test]
fn a_probe_reads_along_its_normals() {
    let plant = plant("XYFZ", "{EYY: 4 um, EXX: 3 um}");
    let probe = |normal| {
        let mut wanted = scenario(path(circle(30.0), 10.0, 5.0), Instrument::Probe { normal });
        wanted.path.at = vec![vec![100.0], vec![50.0], vec![0.0]];
        simulate(&plant, &wanted).unwrap()
    };
    let face = probe(Normal::Fixed([0.6, 0.8, 0.0]));
    // EXX and EYY are counted along the programmed motion: the part goes the other way, so the tip gains.
    assert!(face.readings[0].values.iter().all(|value| (value - (0.6 * 0.003 + 0.8 * 0.004)).abs() < 1e-12));
    let ring = probe(Normal::Radial(None));
    let [across, along, up] = ring.normals.as_ref().unwrap();
    for (row, reading) in ring.readings[0].values.iter().enumerate() {
        let (x, y) = (ring.commands[0][row] - 100.0, ring.commands[1][row] - 50.0);
        assert!((across[row] - x / 30.0).abs() < 1e-12 && (along[row] - y / 30.0).abs() < 1e-12);
        assert_eq!(up[row], 0.0);
        assert!((reading - (0.003 * x + 0.004 * y) / 30.0).abs() < 1e-12);
    }
}

#[test]
fn a_part_that_was_clamped_anew_is_read_turned_and_displaced() {
    let plant = plant("XYFZ", "{EYY: 4 um}");
    let angle = 0.5_f64.to_radians();
    let lying = |instrument: Instrument| {
        let mut wanted = scenario(path(circle(60.0), 20.0, 5.0), instrument);
        wanted.path.at = vec![vec![100.0], vec![50.0], vec![-20.0]];
        let straight = simulate(&plant, &wanted).unwrap();
        wanted.measurement.datum =
            Some(Datum { displacement: [0.3, -0.2, 0.1], rotation: [angle, 0.0, 0.0] });
        let turned = simulate(&plant, &wanted).unwrap();
        assert!(turned.free_datum && !straight.free_datum);
        (straight, turned)
    };
    let (straight, turned) = lying(Instrument::position());
    let [x, y, z] = [0, 1, 2].map(|channel: usize| &straight.readings[channel].values);
    for row in 0..x.len() {
        // About X, by the matrix written out: Y goes towards Z.
        let expected = [
            x[row] + 0.3,
            angle.cos() * y[row] - angle.sin() * z[row] - 0.2,
            angle.sin() * y[row] + angle.cos() * z[row] + 0.1,
        ];
        for (channel, expected) in expected.iter().enumerate() {
            assert!((turned.readings[channel].values[row] - expected).abs() < 1e-10);
        }
    }
    let head = |simulated| write::recording(simulated, &write::Head::default());
    assert!(head(&turned).contains("setup: {datum: free}\n") && !head(&straight).contains("setup"));
    // A probe from above sees the height alone.
    let (_, probed) = lying(Instrument::Probe { normal: Normal::Fixed([0.0, 0.0, 1.0]) });
    for (row, read) in probed.readings[0].values.iter().enumerate() {
        // The tool is 120 mm long, and Z stands at -20 mm.
        let found = angle.sin() * y[row] + angle.cos() * z[row] + 0.1;
        assert!((read - (found - 100.0)).abs() < 1e-10, "{row}");
    }
}

#[test]
fn a_rotary_axis_reads_in_the_sense_of_its_command() {
    for word in ["FC", "CF"] {
        let plant =
            plant(word, "{ECC: [{polynomial: {per: rad, unit: mrad, coefficients: [1, 2]}}], EAC: 3 mrad}");
        let angles = Instrument::Position { directions: [false; 3], angles: vec![0] };
        let recorded = simulate(&plant, &scenario(path(line(0, -3.0, 3.0), 0.5, 5.0), angles)).unwrap();
        for (measured, command) in recorded.readings[0].values.iter().zip(&recorded.commands[0]) {
            // The tilt is no angle of the axis, to first order: what it adds is of second order.
            assert!((measured - command - (1e-3 + 2e-3 * command)).abs() < 2e-5, "{word}");
        }
    }
}

#[test]
fn a_clock_that_is_late_shows_the_past() {
    let plant = plant("FX", "{}");
    let mut wanted = scenario(path(line(0, 0.0, 100.0), 10.0, 20.0), Instrument::position());
    wanted.measurement.clock = 0.013;
    let recorded = simulate(&plant, &wanted).unwrap();
    let behind: Vec<f64> =
        recorded.readings[0].values.iter().zip(&recorded.commands[0]).map(|(m, c)| m - c).collect();
    assert_eq!(behind[0], 0.0, "before the beginning it stood still");
    assert!((behind[100] + 0.13).abs() < 1e-9 && (behind[300] - 0.13).abs() < 1e-9);
    // A curve is followed on the curve, not on the chord between two samples.
    let mut round = scenario(path(circle(100.0), 50.0, 10.0), Instrument::position());
    round.measurement.clock = 0.05;
    let recorded = simulate(&plant_xy(), &round).unwrap();
    let radius = |row: usize| recorded.readings[0].values[row].hypot(recorded.readings[1].values[row]);
    assert!((1..recorded.time.len()).all(|row| (radius(row) - 100.0).abs() < 1e-9));
}

fn plant_xy() -> abbe_simulation::Plant {
    plant("XYFZ", "{}")
}

#[test]
fn drives_show_what_came_in_at_the_drive() {
    let built = Built::of(
        "FX",
        "{EXX: [{lag: {gain: 30 1/s}}, {backlash: {lost_motion: 6 um}}, {cyclic: {period: 7 mm, amplitude: 5 um, phase: 0 rad}}]}",
    );
    let mut plant = built.plant();
    plant.see_at_drive(&built.machine, "EXX", "backlash").unwrap();
    assert!(plant.see_at_drive(&built.machine, "EXX", "growth").is_err());
    assert!(plant.see_at_drive(&built.machine, "EYX", "backlash").is_err());
    let mut wanted = scenario(path(line(0, 0.0, 70.0), 7.0, 20.0), Instrument::position());
    wanted.measurement.drives = vec![0];
    let recorded = simulate(&plant, &wanted).unwrap();
    let actual = recorded.actual[0].as_ref().unwrap();
    let at = |time: f64| recorded.time.iter().position(|known| *known >= time).unwrap();
    // Steady: the lag and half the play; not the screw.
    let row = at(7.3);
    assert!((actual[row] - recorded.commands[0][row] + 7.0 / 30.0 + 0.003).abs() < 1e-9);
    let screw = recorded.readings[0].values[row] - actual[row];
    let q = actual[row] + 0.003;
    assert!((screw - 0.005 * (std::f64::consts::TAU * q / 7.0).sin()).abs() < 1e-9);
}

#[test]
fn stations_are_read_at_rest() {
    let plant = plant("FX", "{EXX: [{lag: {gain: 10 1/s}}, {backlash: {lost_motion: 10 um}}]}");
    let shape = Shape::Line {
        strokes: vec![Stroke { axis: 0, from: 0.0, to: 80.0 }],
        back: true,
        overrun: 5.0,
        stations: Some(Stations { count: 5, dwell: 4.0, readings: 2 }),
    };
    let recorded = simulate(&plant, &scenario(path(shape, 40.0, 1.0), Instrument::position())).unwrap();
    let commands = &recorded.commands[0];
    let stops: Vec<f64> = commands.iter().step_by(2).copied().collect();
    assert_eq!(stops, [0.0, 20.0, 40.0, 60.0, 80.0, 80.0, 60.0, 40.0, 20.0, 0.0]);
    for (row, measured) in recorded.readings[0].values.iter().enumerate() {
        // Two seconds of dwell are twenty time constants: the lag is over, the play stays.
        let side = if row < 10 { -0.005 } else { 0.005 };
        assert!((measured - commands[row] - side).abs() < 1e-6, "row {row}");
    }
}

#[test]
fn a_replay_of_a_path_is_that_path() {
    let plant = plant(
        "XYFZ",
        "{EXX: [{lag: {gain: 30 1/s}}], EYY: [{backlash: {lost_motion: 5 um, wind_up: 1 mm}}]}",
    );
    let wanted = scenario(path(circle(40.0), 20.0, 25.0), Instrument::position());
    let driven = simulate(&plant, &wanted).unwrap();
    let commands = Commands {
        time: driven.time.clone(),
        run: driven.run.clone(),
        positions: driven.commands.clone(),
        ..Commands::default()
    };
    let replayed = replay(&plant, &commands, &Measurement::perfect(Instrument::position())).unwrap();
    assert_eq!(driven.readings, replayed.readings);
    let mut short = commands;
    short.run.pop();
    assert!(replay(&plant, &short, &wanted.measurement).is_err());
}

#[test]
fn every_run_begins_at_rest_whatever_was_driven_before_it() {
    let plant = plant("FX", "{EXX: [{lag: {gain: 33.3 1/s}}, {backlash: {lost_motion: 8 um}}]}");
    let linear = || Instrument::Linear { axis: 0, direction: [1.0, 0.0, 0.0], cosine: 0.0 };
    let sweep = |row: u32| 0.3 * f64::from(row.clamp(10, 60) - 10);
    // Two sweeps one way: as runs whose clocks were laid one behind another, and in one run with a gap.
    let time =
        |rows: u32, gap: f64| (0..rows).map(move |row| f64::from(row) * 0.02 + f64::from(row / 80) * gap);
    for (second, gap) in [(2, 0.0), (2, 3.0), (1, 3.0)] {
        for clock in [0.0, 0.013, -0.05, 0.4] {
            let commands = Commands {
                time: time(160, gap).collect(),
                run: [[1; 80], [second; 80]].concat(),
                positions: vec![(0..160).map(|row| sweep(row % 80)).collect()],
                ..Commands::default()
            };
            let measurement = Measurement { clock, ..Measurement::perfect(linear()) };
            let read = replay(&plant, &commands, &measurement).unwrap().readings[0].values.clone();
            let (first, again) = read.split_at(80);
            let apart = first.iter().zip(again).map(|(first, again)| (first - again).abs());
            let worst = apart.fold(0.0, f64::max);
            assert!(worst < 1e-9, "run {second}, gap {gap}, clock {clock}: {worst}");
            // At rest where it stands: only the play of its first motion.
            assert!((again[0] + 0.004).abs() < 1e-9, "{}", again[0]);
        }
    }
}

#[test]
fn every_shape_stays_within_its_bounds_and_keeps_its_feed() {
    let shapes = [
        Shape::Diamond { plane: [0, 1], radius: 50.0 },
        Shape::Grid { plane: [0, 1], from: [-50.0, -50.0], to: [50.0, 50.0], lines: 4 },
        Shape::Spiral { plane: [0, 1], inner: 5.0, outer: 50.0, turns: 12.0 },
        Shape::Points(vec![vec![(0, 0.0), (1, 0.0)], vec![(0, 50.0)], vec![(1, -30.0)]]),
        circle(50.0),
    ];
    for shape in shapes {
        let path = Path { runs: 2, ..path(shape.clone(), 10.0, 20.0) };
        let timeline = path.timeline(&[false; 3]).unwrap();
        let times: Vec<f64> = timeline.instants().iter().map(|instant| instant.time).collect();
        let columns = timeline.positions(&times);
        let runs: Vec<i64> = timeline.instants().iter().map(|instant| instant.run).collect();
        assert_eq!((runs[0], runs[runs.len() - 1]), (1, 2));
        for row in 1..times.len() {
            let step = (columns[0][row] - columns[0][row - 1]).hypot(columns[1][row] - columns[1][row - 1]);
            let speed = step / (times[row] - times[row - 1]);
            assert!(
                columns[0][row].abs() <= 50.0 + 1e-9 && columns[1][row].abs() <= 50.0 + 1e-9,
                "{shape:?}"
            );
            // A pause may be a jump; a chord or a corner is shorter than the way, a spiral adds its growth.
            assert!(runs[row] != runs[row - 1] || speed < 10.3, "{shape:?} {row} {speed}");
        }
    }
}
