//! Every example recording reads without findings, and what was read agrees with the text of its table.

use std::fs;
use std::path::{Path, PathBuf};

use abbe_recording::{ChannelKind, Header, Recording, machine_of, read_header};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::{Compiled, compile, compile_word, yaml};

use crate::beside::listed;

/// The recording files of the examples; none where the folder is missing.
fn examples() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for kind in ["concealed", "recordings"] {
        let Some(folders) = listed(kind) else { continue };
        let before = found.len();
        let files = folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
        let files = files.map(|file| file.path());
        found.extend(files.filter(|path| {
            let name = path.file_name().unwrap().to_string_lossy();
            name.starts_with("recording") && name.ends_with(".yaml")
        }));
        assert!(found.len() > before, "no recording in {kind}");
    }
    found.sort();
    found
}

fn compiled(name: &str) -> Compiled {
    let mut diagnostics = Diagnostics::new();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../machines/{name}.yaml"));
    let compiled = match fs::read_to_string(&shipped) {
        Ok(text) => compile(&SourceFile::new(name, text), &mut diagnostics),
        Err(_) => compile_word(name, &mut diagnostics),
    };
    compiled.unwrap_or_else(|| panic!("{name}: {diagnostics:?}"))
}

fn read(path: &Path) -> (Header, Recording) {
    let source = SourceFile::new(path.display().to_string(), fs::read_to_string(path).unwrap());
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics).unwrap();
    let machine = machine_of(&root, &mut diagnostics).unwrap();
    let header = read_header(&root, &compiled(&machine.value).equations, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{}: {diagnostics:#?}", path.display());
    let header = header.unwrap();
    let data = path.with_file_name(&header.data.value);
    let recording = header.read_data(&data).unwrap_or_else(|error| panic!("{error}"));
    (header, recording)
}

#[test]
fn all_are_read_without_findings() {
    for path in examples() {
        let (_, recording) = read(&path);
        let text = fs::read_to_string(path.with_file_name("data.csv")).unwrap();
        let rows = text.lines().skip(1).filter(|line| !line.trim().is_empty()).count();
        let name = path.display();
        assert_eq!(recording.time.len(), rows, "{name}");
        assert_eq!(recording.run.len(), rows, "{name}");
        assert!(recording.time.windows(2).all(|pair| pair[1] > pair[0]), "{name}");
        assert!(recording.notes.is_empty(), "{name}: {:?}", recording.notes);
        let axes = recording.axes.iter().flat_map(|axis| [&axis.command, &axis.actual, &axis.measured]);
        let columns = axes.chain(&recording.measured).chain([&recording.deviation]).flatten();
        let named = recording.temperatures.iter().chain(&recording.loads).map(|named| &named.values);
        for column in columns.chain(named) {
            assert_eq!(column.len(), rows, "{name}");
        }
    }
}

/// The column of a channel as the CSV library reads it, in units written out here.
fn as_the_library_reads(path: &Path, column: &str, unit: &str) -> Vec<f64> {
    let factor = match unit {
        "deg" => std::f64::consts::PI / 180.0,
        "arcsec" => std::f64::consts::PI / 180.0 / 3600.0,
        "um" => 1e-3,
        _ => 1.0,
    };
    let mut reader = csv::Reader::from_path(path.with_file_name("data.csv")).unwrap();
    let index = reader.headers().unwrap().iter().position(|name| name == column).unwrap();
    let cells = reader.records().map(|record| record.unwrap()[index].to_owned());
    cells.map(|cell| if cell.is_empty() { f64::NAN } else { cell.parse::<f64>().unwrap() * factor }).collect()
}

#[test]
fn every_number_is_that_of_the_table() {
    for path in examples() {
        let (header, recording) = read(&path);
        for channel in &header.channels {
            let expected = as_the_library_reads(&path, &channel.columns()[0].value, &channel.written_unit);
            let named = |list: &[abbe_recording::Named], name: &str| {
                list.iter().find(|one| one.name == name).unwrap().values.clone()
            };
            let found = match &channel.kind {
                ChannelKind::Time => recording.time.iter().map(|time| time + expected[0]).collect(),
                ChannelKind::Run => recording.run.iter().map(|run| *run as f64).collect(),
                ChannelKind::Command(axis) => recording.axes[*axis].command.clone().unwrap(),
                ChannelKind::Actual(axis) => recording.axes[*axis].actual.clone().unwrap(),
                ChannelKind::MeasuredAngle(axis) => recording.axes[*axis].measured.clone().unwrap(),
                ChannelKind::Measured(direction) => recording.measured[*direction].clone().unwrap(),
                ChannelKind::Deviation => recording.deviation.clone().unwrap(),
                ChannelKind::Normal(direction) => recording.normal.clone().unwrap()[*direction].clone(),
                ChannelKind::Temperature(name) => named(&recording.temperatures, name),
                ChannelKind::Load(name) => named(&recording.loads, name),
            };
            let same = |(found, expected): (&f64, &f64)| {
                (found.is_nan() && expected.is_nan()) || (found - expected).abs() <= 1e-9 * expected.abs()
            };
            assert!(found.iter().zip(&expected).all(same), "{}: {}", path.display(), channel.name.value);
        }
    }
}
