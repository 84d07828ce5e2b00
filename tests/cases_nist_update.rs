//! The case of docs/cases/nist-turning-center.md: a turning centre's calibration, updated from a part of two cylinders.
//!
//! In: the shipped machine and calibration, which drive the exact machine. Out: the figures of the page, each held to what
//! the page says. What an update is worth is judged on noiseless parts by the exact machine with either calibration, and by
//! nothing of the update's own.

use std::fs;
use std::path::PathBuf;

use model_dsl::Compiled;
use model_dsl::calibration::{self, CalibratedTerm, Calibration};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use recording::{AxisChannels, Instrument, Named, Recording};
use serde_json::Value;
use simulation::noise::Source;
use simulation::{Column, Commands, Plant};
use update::{Inputs, Method, Options, Update};

use crate::beside::shared;
use crate::cli::abbe;
use crate::shipped::root;

/// Offset of the work point from the slides' positions, X1 + X2 + X4 - X5 and Z1 + Z2 + Z4 - Z5 of the report's table A.2,
/// and where the top face of every part stands before the spindle: not in the report, chosen.
const WORK: [f64; 2] = [-148.0 + 30.0 - 35.0 + 386.0, -43.0 - 26.0 + 30.0];
const TOP: f64 = 200.0;

/// The thermocouples that the calibration reads.
const SENSORS: [&str; 10] = ["T0", "T10", "T12", "T19", "T21", "T27", "T30", "T31", "T35", "T39"];

/// Standard deviation of the averaged readings in X and in Z, mm: that of the report's table 1, a little below.
const NOISE: [f64; 2] = [0.0015, 0.0009];

/// A part of two cylinders.
struct TwoCylinders {
    radii: [f64; 2],
    lengths: [f64; 2],
    /// At the first thermocouple; the others are warmer by [`PATTERN`] times the warming.
    start: f64,
    warming: f64,
}

/// How much of the warming each thermocouple shows: scales, ways, spindle head, motor bearing, ballscrew nut differ.
const PATTERN: [f64; 10] = [0.5, 0.7, 0.6, 0.0, 0.8, 1.6, 1.4, 0.4, 1.2, 1.1];

/// The part of the report: 50.8 mm and 152.4 mm; lengths and temperatures are not in it.
fn report_part() -> TwoCylinders {
    TwoCylinders { radii: [25.4, 76.2], lengths: [50.0, 50.0], start: 21.0, warming: 4.0 }
}

/// Another one: slender, long, on a hotter day.
fn other_part() -> TwoCylinders {
    TwoCylinders { radii: [12.0, 45.0], lengths: [70.0, 80.0], start: 26.0, warming: 7.0 }
}

/// A point: positions of X and Z, and which of the two is measured.
type Spot = ([f64; 2], usize);

impl TwoCylinders {
    /// 8 points on the top of the small cylinder, 9 each on its side, the top of the large one and its side.
    fn spots(&self) -> Vec<Spot> {
        let [small, large] = self.radii;
        let [first, second] = self.lengths;
        let along = |from: f64, to: f64, count: u32| -> Vec<f64> {
            (0..count).map(|k| from + (to - from) * (f64::from(k) + 0.5) / f64::from(count)).collect()
        };
        let face = |from: f64, to: f64, depth: f64, count: u32| -> Vec<Spot> {
            along(from, to, count).into_iter().map(|r| ([r, -depth], 1)).collect()
        };
        let side = |radius: f64, from: f64, to: f64| -> Vec<Spot> {
            along(from, to, 9).into_iter().map(|depth| ([radius, -depth], 0)).collect()
        };
        let spots = [
            face(0.0, small, 0.0, 8),
            side(small, 0.0, first),
            face(small, large, first, 9),
            side(large, first, first + second),
        ];
        let slides = |([r, z], measured): Spot| ([r - WORK[0], z + TOP - WORK[1]], measured);
        spots.concat().into_iter().map(slides).collect()
    }

    fn temperatures(&self) -> [f64; 10] {
        PATTERN.map(|share| self.start + share * self.warming)
    }

    /// What the machine commands and feels at the points.
    fn commands(&self) -> Commands {
        let spots = self.spots();
        let column = |part: usize| spots.iter().map(|(at, _)| at[part]).collect();
        let sensor = |(name, value): (&str, f64)| Column {
            name: name.to_owned(),
            unit: "degC".to_owned(),
            values: vec![value; spots.len()],
        };
        Commands {
            time: (0..spots.len()).map(|row| 10.0 * f64::from(u32::try_from(row).unwrap())).collect(),
            run: vec![1; spots.len()],
            positions: vec![column(0), column(1)],
            temperatures: SENSORS.into_iter().zip(self.temperatures()).map(sensor).collect(),
            ..Commands::default()
        }
    }

    /// The deviations of the exact machine along the normals, mm; the part's zero is touched off, so that the small
    /// cylinder and its top are right on average.
    fn deviations(&self, case: &Case, truth: &Calibration) -> Vec<f64> {
        let (compiled, spots) = (&case.compiled, self.spots());
        let plant = Plant::new(&compiled.machine, &compiled.equations.names(), truth).unwrap();
        let mut errors = Vec::new();
        let each = |moment: &simulation::Moment<'_>| {
            let at = [moment.state.position(0), moment.state.position(1)];
            let perfect = plant.nominal(&at).tip;
            errors.push([moment.pose.tip.x - perfect.x, moment.pose.tip.z - perfect.z]);
        };
        plant.run(&self.commands(), each).unwrap();
        let mut along: Vec<f64> =
            spots.iter().zip(&errors).map(|((_, measured), error)| error[*measured]).collect();
        let zero = [mean(&along[8..17]), mean(&along[..8])];
        along.iter_mut().zip(&spots).for_each(|(value, (_, measured))| *value -= zero[*measured]);
        along
    }

    /// The part on the measuring machine.
    fn recording(&self, case: &Case, truth: &Calibration, seed: u64) -> Recording {
        let spots = self.spots();
        let commands = self.commands();
        let mut source = Source::new(seed, "part");
        let exact = self.deviations(case, truth);
        let deviation =
            exact.iter().zip(&spots).map(|(exact, (_, d))| exact + NOISE[*d] * source.normal()).collect();
        let normal = |part: usize| spots.iter().map(|(_, d)| f64::from(u8::from(*d == part))).collect();
        let axis =
            |position: &Vec<f64>| AxisChannels { command: Some(position.clone()), ..Default::default() };
        let named = |column: &Column| Named {
            name: column.name.clone(),
            unit: column.unit.clone(),
            values: column.values.clone(),
        };
        Recording {
            instrument: Instrument::Probe,
            axes: commands.positions.iter().map(axis).collect(),
            deviation: Some(deviation),
            normal: Some([normal(0), vec![0.0; spots.len()], normal(1)]),
            temperatures: commands.temperatures.iter().map(named).collect(),
            time: commands.time,
            run: commands.run,
            ..Recording::default()
        }
    }

    /// What a calibration leaves of the exact machine on a part of this kind, its zero set anew: X and Z, mm.
    fn left(&self, case: &Case, calibration: &Calibration, truth: &Calibration) -> [Vec<f64>; 2] {
        let (here, there) = (self.deviations(case, truth), self.deviations(case, calibration));
        let spots = self.spots();
        [0, 1].map(|direction| {
            let rows = (0..spots.len()).filter(|row| spots[*row].1 == direction);
            let left: Vec<f64> = rows.map(|row| here[row] - there[row]).collect();
            let zero = mean(&left);
            left.iter().map(|left| (left - zero).abs()).collect()
        })
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / f64::from(u32::try_from(values.len()).unwrap())
}

fn rms(left: &[Vec<f64>; 2]) -> f64 {
    1e3 * mean(&left.concat().iter().map(|size| size * size).collect::<Vec<f64>>()).sqrt()
}

/// The machine and its calibration as shipped.
struct Case {
    compiled: Compiled,
    shipped: Calibration,
}

impl Case {
    fn new() -> Self {
        let read = |name: &str| {
            let path = root().join(name);
            SourceFile::new(name, fs::read_to_string(path).unwrap())
        };
        let mut findings = Diagnostics::new();
        let compiled = model_dsl::compile(&read("machines/nist-turning-center.yaml"), &mut findings).unwrap();
        let tree =
            model_dsl::yaml::read(&read("calibrations/nist-turning-center.yaml"), &mut findings).unwrap();
        let shipped = calibration::read(&tree, &compiled.equations.names(), &mut findings).unwrap();
        Self { compiled, shipped }
    }

    fn update(&self, known: &Calibration, parts: &[&Recording], method: Method) -> Update {
        let inputs =
            Inputs { equations: &self.compiled.equations, calibration: known, recordings: parts.to_vec() };
        update::update(&inputs, &Options { method, ..Options::default() }).unwrap()
    }

    /// Every coefficient off by 20 % to 30 % of itself, either way.
    fn disturbed(&self, seed: u64) -> Calibration {
        let mut source = Source::new(seed, "coefficients");
        let mut other = self.shipped.clone();
        for term in other.motions.iter_mut().flat_map(|motion| &mut motion.terms) {
            for value in numbers(&mut term.value) {
                let share = 0.2 + 0.1 * source.uniform();
                *value *= 1.0 + if source.uniform() < 0.5 { share } else { -share };
            }
        }
        other
    }

    /// A machine whose headstock was knocked by 20 arcsec: one coefficient of the parallelism of Z to the spindle.
    fn knocked(&self) -> Calibration {
        let mut other = self.shipped.clone();
        let motion = self.compiled.equations.names().motion("EB0Z").unwrap();
        let listed = other.motions.iter_mut().find(|listed| listed.motion == motion).unwrap();
        *numbers(&mut listed.terms[0].value)[0] += (20.0_f64 / 3600.0).to_radians();
        other
    }
}

fn numbers(term: &mut CalibratedTerm) -> Vec<&mut f64> {
    match term {
        CalibratedTerm::Polynomial { coefficients, .. } => coefficients.iter_mut().collect(),
        CalibratedTerm::Expansion { coefficient, .. } => vec![coefficient],
        other => panic!("the shipped calibration has no {}", other.name()),
    }
}

/// The methods in the order of the page's tables.
const METHODS: [Method; 3] = [Method::Svd, Method::Ridge, Method::Select];

/// The seeds of the disturbed calibrations and of the noise.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=15;

/// What the disturbed calibrations leave, rms in um: on the part of the report and on the other one, with the number of
/// coefficients that moved. A row for each seed; first without an update, then the three methods.
fn disturbed_machines(case: &Case) -> Vec<[[f64; 2]; 4]> {
    let both = |calibration: &Calibration| {
        [report_part(), other_part()].map(|part| rms(&part.left(case, calibration, &case.shipped)))
    };
    let row = |seed: u64| {
        let known = case.disturbed(seed);
        let part = report_part().recording(case, &case.shipped, seed);
        let after = METHODS.map(|method| both(&case.update(&known, &[&part], method).calibration));
        [both(&known), after[0], after[1], after[2]]
    };
    SEEDS.map(row).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Table 1 of the report: greatest, mean and standard deviation of what the update leaves, um, in X and in Z.
const TABLE_1: [[f64; 3]; 2] = [[4.1, 1.4, 1.0], [2.5, 0.8, 0.7]];

/// The three figures of a direction of an update, um.
fn after(updated: &Update, direction: &str) -> [f64; 3] {
    let residual = updated.residuals.iter().find(|residual| residual.direction == direction).unwrap();
    [residual.after.max, residual.after.mean, residual.after.std].map(|size| 1e3 * size)
}

/// The page, whose figures these are.
fn page_has(words: &str) {
    let page = fs::read_to_string(root().join("docs/cases/nist-turning-center.md")).unwrap();
    let page = page.split_whitespace().collect::<Vec<&str>>().join(" ");
    assert!(page.contains(words), "docs/cases/nist-turning-center.md does not say: {words}");
}

#[test]
fn the_fitted_part_is_met_at_least_as_well_as_in_the_report() {
    let case = Case::new();
    let updates = SEEDS.map(|seed| {
        let part = report_part().recording(&case, &case.shipped, seed);
        case.update(&case.disturbed(seed), &[&part], Method::Svd)
    });
    let updates: Vec<Update> = updates.collect();
    // 35 readings, 18 of X and 17 of Z, and two zeros; ten temperatures that never change are constants.
    for updated in &updates {
        assert_eq!((updated.points, updated.zeros, updated.unknowns, updated.rank), (35, 2, 37, 7));
        let points: Vec<usize> = updated.residuals.iter().map(|residual| residual.points).collect();
        assert_eq!(points, [18, 17, 35]);
    }
    for (direction, published) in ["X", "Z"].into_iter().zip(TABLE_1) {
        let middle =
            [0, 1, 2].map(|figure| median(updates.iter().map(|one| after(one, direction)[figure]).collect()));
        let below = middle.iter().zip(published).all(|(here, there)| *here <= there);
        assert!(below, "{direction}: {middle:?} against {published:?}");
        let [max, mean, std] = middle;
        page_has(&format!(
            "| {direction} | {:.1} | {:.1} | {:.1} | {max:.1} | {mean:.1} | {std:.1} |",
            published[0], published[1], published[2]
        ));
    }
    // The zeros in the constants instead: two more directions of the coefficients, and the same is left.
    for (seed, updated) in SEEDS.zip(&updates) {
        let part = report_part().recording(&case, &case.shipped, seed);
        let known = case.disturbed(seed);
        let inputs =
            Inputs { equations: &case.compiled.equations, calibration: &known, recordings: vec![&part] };
        let absolute = update::update(&inputs, &Options { datum: [false; 3], ..Options::default() }).unwrap();
        assert_eq!((absolute.zeros, absolute.rank), (0, 9));
        let same = |direction| {
            after(&absolute, direction)
                .iter()
                .zip(after(updated, direction))
                .all(|(one, other)| (one - other).abs() < 1e-3)
        };
        assert!(same("X") && same("Z") && absolute.changes.len() > updated.changes.len());
    }
    // It is met by moving coefficients by many times themselves, as in the report's appendix B.
    let moved = |updated: &Update| updated.changes.iter().filter(|change| change.change.abs() > 1.0).count();
    assert!(updates.iter().all(|updated| moved(updated) >= 9 && updated.changes[0].change.abs() > 15.0));
    assert!(updates.iter().all(|updated| updated.changes.iter().all(|change| !change.determined)));
}

#[test]
fn another_part_is_met_worse_and_the_page_says_by_how_much() {
    let case = Case::new();
    let rows = disturbed_machines(&case);
    let of = |way: usize, part: usize| median(rows.iter().map(|row| row[way][part]).collect());
    for (way, name) in ["before", "svd", "ridge", "select"].into_iter().enumerate() {
        let greatest = rows.iter().map(|row| row[way][1]).fold(0.0, f64::max);
        page_has(&format!("| {name} | {:.1} | {:.1} | {greatest:.1} |", of(way, 0), of(way, 1)));
    }
    let worse = |one: usize, other: usize| rows.iter().filter(|row| row[one][1] > row[other][1]).count();
    page_has(&format!("`ridge` is better than `svd` on it in {} of {} machines", worse(1, 2), rows.len()));
    page_has(&format!("`select` in {} of {}", worse(1, 3), rows.len()));
    page_has(&format!("worse than no update at all in {} of {}", worse(1, 0), rows.len()));
    // What the part showed is right there to below the noise, and ten times as wrong elsewhere.
    assert!((1..4).all(|way| of(way, 0) < 1.0 && of(way, 1) > 5.0 * of(way, 0)));
    assert!((1..4).all(|way| of(way, 1) < 0.25 * of(0, 1)));
}

#[test]
fn a_knock_is_found_as_one_coefficient_and_a_second_part_tells_which() {
    let case = Case::new();
    let truth = case.knocked();
    let both = |calibration: &Calibration| {
        [report_part(), other_part()].map(|part| rms(&part.left(&case, calibration, &truth)))
    };
    let mut left: Vec<[[f64; 2]; 6]> = Vec::new();
    let (mut motions, mut constants, mut told) = (0, 0, [0, 0]);
    for seed in SEEDS {
        let part = report_part().recording(&case, &truth, seed);
        let hot = other_part().recording(&case, &truth, 100 + seed);
        let updated = |parts: &[&Recording]| METHODS.map(|method| case.update(&case.shipped, parts, method));
        let (one, two) = (updated(&[&part]), updated(&[&part, &hot]));
        // What the machine suffered is the choice, or among what would do as well.
        let named = |select: &Update| {
            let suffered = "EB0Z.polynomial(start)[0]";
            assert!((1..=2).contains(&select.changes.len()));
            let mut changes = select.changes.iter();
            changes.any(|one| one.name == suffered || one.alternatives.iter().any(|other| other == suffered))
        };
        told[0] += usize::from(named(&one[2]));
        told[1] += usize::from(named(&two[2]));
        let shape = |name: &str| name.starts_with("EB0Z.") || name.starts_with("EXZ.polynomial[");
        assert!(one[2].changes.iter().all(|change| shape(&change.name)));
        motions += usize::from(one[2].changes[0].name.starts_with("EB0Z."));
        constants += usize::from(two[2].changes[0].name == "EB0Z.polynomial(start)[0]");
        let all: Vec<[f64; 2]> = one.iter().chain(&two).map(|updated| both(&updated.calibration)).collect();
        left.push(all.try_into().unwrap());
    }
    let of = |way: usize, part: usize| median(left.iter().map(|row| row[way][part]).collect());
    let before = both(&case.shipped);
    page_has(&format!("| before | {:.1} | {:.1} |", before[0], before[1]));
    let ways =
        ["svd, one part", "ridge, one part", "select, one part", "svd, both", "ridge, both", "select, both"];
    for (way, name) in ways.into_iter().enumerate() {
        page_has(&format!("| {name} | {:.1} | {:.1} |", of(way, 0), of(way, 1)));
    }
    page_has(&format!("the motion in {motions} of 15 cases"));
    page_has(&format!("the constant itself in {constants} of 15"));
    page_has(&format!("names it in {} of 15 with one part and in {} with both", told[0], told[1]));
    assert!(of(2, 0) < of(0, 0) && of(2, 1) < of(0, 1));
    assert!(of(5, 1) < of(2, 1) && of(5, 1) < of(3, 1));
}

/// The changes of the report's own tables, where they are: their size, not their values, can be compared.
#[test]
fn the_report_moves_coefficients_by_many_times_themselves_too() {
    let Some(table) = shared("published/nist-coefficients.csv") else { return };
    let table = fs::read_to_string(table).unwrap();
    // A45 is misprinted.
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let number = |text: &str| text.parse::<f64>().unwrap();
    let kept = rows.iter().filter(|row| row[1] != "A45");
    let changes: Vec<f64> = kept.map(|row| (number(row[4]) / number(row[3]) - 1.0).abs()).collect();
    let over = changes.iter().filter(|change| **change > 1.0).count();
    let greatest = changes.iter().copied().fold(0.0, f64::max);
    page_has(&format!("{over} of the {} coefficients by more than themselves", changes.len()));
    page_has(&format!("A13 by {greatest:.0} times itself"));
}

/// A recording as two files of a folder.
fn written(folder: &str, recording: &Recording) -> (PathBuf, String) {
    let place = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let _ = fs::remove_dir_all(&place);
    fs::create_dir_all(&place).unwrap();
    let mut table = format!("t,x,z,nx,ny,nz,d,{}\n", SENSORS.join(","));
    for row in 0..recording.time.len() {
        let position = |axis: usize| recording.axes[axis].command.as_ref().unwrap()[row];
        let [nx, ny, nz] = recording.normal.as_ref().unwrap();
        let cells = [recording.time[row], position(0), position(1), nx[row], ny[row], nz[row]];
        let deviation = recording.deviation.as_ref().unwrap()[row];
        let cells = cells.into_iter().chain([deviation]);
        let cells = cells.chain(recording.temperatures.iter().map(|sensor| sensor.values[row]));
        table += &(cells.map(|cell| cell.to_string()).collect::<Vec<_>>().join(",") + "\n");
    }
    let sensors: String = SENSORS
        .iter()
        .map(|name| format!("  temperature.{name}: {{column: {name}, unit: degC}}\n"))
        .collect();
    let text = format!(
        "recording: 1\nmachine: nist-turning-center\ninstrument: probe\ndata: part.csv\nchannels:\n  \
         time: {{column: t, unit: s}}\n  command.x: {{column: x, unit: mm}}\n  command.z: {{column: z, unit: mm}}\n  \
         normal.x: {{column: nx}}\n  normal.y: {{column: ny}}\n  normal.z: {{column: nz}}\n  \
         deviation: {{column: d, unit: mm}}\n{sensors}"
    );
    fs::write(place.join("part.csv"), table).unwrap();
    fs::write(place.join("part.yaml"), &text).unwrap();
    (place, text)
}

fn read(case: &Case, path: &std::path::Path) -> Calibration {
    let source = SourceFile::new("new.yaml", fs::read_to_string(path).unwrap());
    let mut findings = Diagnostics::new();
    let tree = model_dsl::yaml::read(&source, &mut findings).unwrap();
    calibration::read(&tree, &case.compiled.equations.names(), &mut findings).unwrap()
}

#[test]
fn the_command_writes_what_the_library_finds() {
    let case = Case::new();
    let truth = case.knocked();
    let recording = report_part().recording(&case, &truth, 1);
    let (place, _) = written("update", &recording);
    let known = root().join("calibrations/nist-turning-center.yaml");
    let at = |name: &str| place.join(name).to_str().unwrap().to_owned();
    let (known, part, new) = (known.to_str().unwrap(), at("part.yaml"), at("new.yaml"));
    for method in METHODS {
        let arguments = ["update", known, &part, "--method", method.name(), "--output", &new, "--force"];
        let run = abbe(&[&arguments[..], &["--format", "json"]].concat(), "");
        assert_eq!((run.status, run.err.as_str()), (0, ""));
        let told: Value = serde_json::from_str(&run.out).unwrap();
        let expected = case.update(&case.shipped, &[&recording], method);
        assert_eq!(told["schema"], "abbe-update/1");
        assert_eq!(told["rank"], expected.rank);
        let all = expected.residuals.iter().find(|residual| residual.direction == "all").unwrap();
        let rms = told["residuals"].as_array().unwrap().last().unwrap()["after"]["rms"].as_f64().unwrap();
        assert!((rms - all.after.rms).abs() < 1e-12);
        assert_eq!(read(&case, &place.join("new.yaml")).motions, expected.calibration.motions);
        let text = abbe(&arguments, "");
        assert!(text.status == 0 && text.out.contains("Collinear at these points"));
    }
    // The compiler's own doors take the file.
    let fed = abbe(
        &["compensate", &new],
        "x,z,T_T0,T_T10,T_T12,T_T19,T_T21,T_T27,T_T30,T_T31,T_T35,T_T39\n-200,200,22,22,22,21,22,25,22,22,22,22\n",
    );
    assert_eq!(fed.status, 0, "{}", fed.err);
}

#[test]
fn the_command_refuses_with_places_and_writes_nothing() {
    let case = Case::new();
    let recording = report_part().recording(&case, &case.shipped, 1);
    let (place, text) = written("update-refused", &recording);
    let known = root().join("calibrations/nist-turning-center.yaml");
    let other = root().join("calibrations/postech-mill.yaml");
    let (known, other) = (known.to_str().unwrap(), other.to_str().unwrap());
    let at = |name: &str| place.join(name).to_str().unwrap().to_owned();
    let file = |name: &str, text: &str| {
        fs::write(place.join(name), text).unwrap();
        at(name)
    };
    let part = at("part.yaml");
    let cold = file("cold.yaml", &text.replace("  temperature.T27: {column: T27, unit: degC}\n", ""));
    let angle = text.replace("instrument: probe", "instrument: linear\nsetup: {direction: X}");
    let angle = angle.lines().filter(|line| !line.contains("normal.")).collect::<Vec<_>>().join("\n");
    let linear = file("linear.yaml", &angle);
    let there = file("there.yaml", "kept");
    let new = at("never.yaml");
    let data = at("part.csv");
    let cases: [(&[&str], i32, &[&str]); 8] = [
        (&[known, &cold, "--output", &new], 2, &["E0626", "cold.yaml", "T27"]),
        (&[known, &linear, "--output", &new], 2, &["E0627", "linear.yaml", "probe"]),
        (&[other, &part, "--output", &new], 2, &["nist-turning-center", "postech-mill"]),
        (&[known, &part, "--output", &there], 2, &["already exists", "--force"]),
        (&[known, &part, "--output", known, "--force"], 2, &["reads or writes"]),
        (&[known, &part, "--output", &data, "--force"], 2, &["reads or writes"]),
        (&[known, &part, "--output", &at("no/such/folder.yaml")], 2, &["its folder does not exist"]),
        (&[known, &part, "--datum", "w"], 2, &["--datum"]),
    ];
    for (arguments, status, words) in cases {
        let run = abbe(&[&["update"], arguments].concat(), "");
        assert_eq!(run.status, status, "{arguments:?}: {}", run.err);
        assert!(words.iter().all(|word| run.err.contains(word)), "{arguments:?}: {}", run.err);
    }
    assert!(!place.join("never.yaml").exists());
    assert_eq!(fs::read_to_string(place.join("there.yaml")).unwrap(), "kept");
}
