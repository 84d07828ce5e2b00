//! Recordings as files: what is written can be read again.

use abbe_simulation::noise::Missing;
use abbe_simulation::write::{Head, recording, table};
use abbe_simulation::{Instrument, Load, Simulated, Temperature, simulate};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use crate::common::{circle, line, path, plant, scenario};

fn head() -> Head {
    let plant = plant("XYFZ", "{}");
    Head {
        machine: "xyfz-mill".to_owned(),
        calibration: Some("known.yaml".to_owned()),
        data: "data.csv".to_owned(),
        axes: plant.names().axes.clone(),
    }
}

fn ballbar() -> Simulated {
    let instrument = Instrument::Ballbar { center: None, radius: None, eccentricity: [0.0; 3], offset: 0.0 };
    let mut wanted = scenario(path(circle(50.0), 20.0, 5.0), instrument);
    wanted.title = Some("a circle: both ways".to_owned());
    wanted.measurement.drives = vec![0];
    wanted.measurement.missing = Missing { rate: 0.3, ..Missing::default() };
    wanted.temperatures =
        vec![Temperature { name: "ball screw".to_owned(), start: 20.0, ..Temperature::default() }];
    wanted.loads = vec![Load { name: "cut".to_owned(), unit: "%".to_owned(), base: 7.0, ..Load::default() }];
    wanted.path.runs = 2;
    wanted.holdout = vec![2];
    simulate(&plant("XYFZ", "{EXX: 5 um}"), &wanted).unwrap()
}

#[test]
fn the_head_names_every_column() {
    let simulated = ballbar();
    let text = recording(&simulated, &head());
    let tree = yaml::read(&SourceFile::new("recording.yaml", text.clone()), &mut Diagnostics::new()).unwrap();
    let word = |key: &str| tree.get(key).and_then(|node| node.text()).unwrap().to_owned();
    assert_eq!((word("recording"), word("title")), ("1".to_owned(), "a circle: both ways".to_owned()));
    assert_eq!((word("instrument"), word("calibration")), ("ballbar".to_owned(), "known.yaml".to_owned()));
    let mut csv = Vec::new();
    table(&simulated, &head().axes, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let channels = tree.get("channels").unwrap().entries().unwrap();
    let columns: Vec<&str> =
        channels.iter().map(|(_, node)| node.get("column").and_then(|node| node.text()).unwrap()).collect();
    assert_eq!(columns, header);
    let names: Vec<&str> = channels.iter().map(|(name, _)| name.value.as_str()).collect();
    assert_eq!(
        names,
        [
            "time",
            "run",
            "command.x",
            "command.y",
            "command.z",
            "actual.x",
            "deviation",
            "temperature.ball screw",
            "load.cut"
        ]
    );
    assert!(text.contains("setup: {center: [0 mm, 0 mm, 120 mm], radius: 50 mm}\n"), "{text}");
    assert!(text.contains("holdout: {runs: [2]}\n"), "{text}");
}

#[test]
fn the_table_holds_the_numbers_and_empty_cells_for_gaps() {
    let simulated = ballbar();
    let mut csv = Vec::new();
    table(&simulated, &head().axes, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), simulated.time.len());
    let mut gaps = 0;
    for (row, cells) in rows.iter().enumerate() {
        assert_eq!(cells.len(), 9);
        let same = |cell: &str, value: f64| (cell.parse::<f64>().unwrap() - value).abs() < 1e-9;
        assert!(same(cells[0], simulated.time[row]) && same(cells[2], simulated.commands[0][row]));
        assert_eq!(cells[1], simulated.run[row].to_string());
        let reading = simulated.readings[0].values[row];
        gaps += usize::from(reading.is_nan());
        assert!(if reading.is_nan() { cells[6].is_empty() } else { same(cells[6], reading) });
    }
    assert!(gaps > 10);
}

#[test]
fn rotary_axes_are_written_in_degrees() {
    let plant = plant("FC", "{}");
    let angles = Instrument::Position { directions: [false; 3], angles: vec![0] };
    let simulated = simulate(&plant, &scenario(path(line(0, 0.0, 1.0), 0.5, 1.0), angles)).unwrap();
    let mut csv = Vec::new();
    table(&simulated, &plant.names().axes, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    assert_eq!(csv.lines().next(), Some("t_s,run,c_cmd,c_meas"));
    assert_eq!(csv.lines().nth(2), Some("1,1,28.647889757,28.647889757"));
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let written = || {
        let mut csv = Vec::new();
        table(&ballbar(), &head().axes, &mut csv).unwrap();
        (recording(&ballbar(), &head()), csv)
    };
    assert_eq!(written(), written());
}
