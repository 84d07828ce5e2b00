//! What printers' firmware is told: the numbers of the files, read here by themselves, in the firmware's own formulas, against Abbe's
//! compensation; and signs by hand.

use abbe_exchange::controller::{Export, Format, Options, Pose, Space, Unusable, Wanted, check};
use abbe_runtime::Direction;
use model_dsl::source::SourceFile;

use crate::machine::{Machine, bilinear, options, text};

const FORMATS: [Format; 3] = [Format::Marlin, Format::Klipper, Format::RepRap];

/// Skew in all three planes, and a bed over 500 by 300 mm that is bent and twisted.
fn printer(word: &str) -> Machine {
    let hat = |row: i32| format!("{{curve: Y, at: [-200 mm, {row} mm, 100 mm], values: [0, 1, 0]}}");
    Machine::of(
        word,
        &[
            "EC0Y: -0.8 mrad".to_owned(),
            "EB0Z: 0.5 mrad".to_owned(),
            "EA0Z: 0.3 mrad".to_owned(),
            format!(
                "EZX: [{{table: {{axis: X, start: -100 mm, step: 125 mm, unit: um, values: [50, -120, 80, 200, -90], times: [{}]}}}}]",
                hat(-50)
            ),
            "EZY: [{polynomial: {axis: Y, unit: um, per: mm, coefficients: [0, 0.4]}}]".to_owned(),
        ],
    )
}

/// The numbers in a text, in their order.
fn numbers(text: &str) -> Vec<f64> {
    let ends = |letter: char| !(letter.is_ascii_digit() || letter == '.' || letter == '-');
    text.split(ends).filter_map(|word| word.parse().ok()).collect()
}

/// What a firmware was told: its skew as a function of the place, and its mesh: from where to where, and rows of heights.
struct Told {
    skew: [f64; 3],
    ends: [[f64; 2]; 2],
    rows: Vec<Vec<f64>>,
}

fn count<T>(list: &[T]) -> f64 {
    f64::from(u32::try_from(list.len()).unwrap())
}

fn told(format: Format, export: &Export) -> Told {
    let value = |text: &str, key: &str| -> f64 {
        let line = text.lines().find(|line| line.starts_with(&format!("{key} = "))).unwrap();
        line.rsplit(' ').next().unwrap().parse().unwrap()
    };
    match format {
        Format::Marlin => {
            let text = text(export, "abbe.gcode");
            let mut rows: Vec<Vec<f64>> = Vec::new();
            for line in text.lines().filter_map(|line| line.strip_prefix("M421 I")) {
                // Row by row, the columns in their order.
                let [column, row, height] = numbers(line).try_into().unwrap();
                if column == 0.0 {
                    rows.push(Vec::new());
                }
                assert_eq!(row + 1.0, count(&rows));
                rows.last_mut().unwrap().push(height);
                assert_eq!(column + 1.0, count(rows.last().unwrap()));
            }
            let skew: [f64; 3] =
                numbers(text.lines().next().unwrap().strip_prefix("M852").unwrap()).try_into().unwrap();
            // Where the points lie is said with the file.
            let said = export.loading.iter().find(|line| line.contains("GRID_MAX_POINTS_X")).unwrap();
            let [columns, from_x, to_x, lines, from_y, to_y] = numbers(said).try_into().unwrap();
            assert_eq!((columns, lines), (count(&rows[0]), count(&rows)));
            Told { skew, ends: [[from_x, to_x], [from_y, to_y]], rows }
        }
        Format::Klipper => {
            let text = text(export, "abbe.cfg");
            let rows: Vec<Vec<f64>> =
                text.lines().filter(|line| line.starts_with("  ")).map(numbers).collect();
            assert_eq!((value(text, "x_count"), value(text, "y_count")), (count(&rows[0]), count(&rows)));
            Told {
                skew: ["xy_skew", "xz_skew", "yz_skew"].map(|key| value(text, key)),
                ends: [
                    [value(text, "min_x"), value(text, "max_x")],
                    [value(text, "min_y"), value(text, "max_y")],
                ],
                rows,
            }
        }
        _ => {
            let [height, x, y, z, p]: [f64; 5] =
                numbers(text(export, "abbe.g").strip_prefix("M556").unwrap()).try_into().unwrap();
            assert_eq!(p, 0.0);
            let map: Vec<Vec<f64>> = text(export, "heightmap.csv").lines().skip(2).map(numbers).collect();
            let (grid, rows) = map.split_first().unwrap();
            let [from_x, _, from_y, _, _, step_x, step_y, columns, lines]: [f64; 9] =
                grid.clone().try_into().unwrap();
            Told {
                skew: [x / height, y / height, z / height],
                ends: [
                    [from_x, from_x + step_x * (columns - 1.0)],
                    [from_y, from_y + step_y * (lines - 1.0)],
                ],
                rows: rows.to_vec(),
            }
        }
    }
}

impl Told {
    /// What the firmware commands in place of x, y, z.
    fn commanded(&self, format: Format, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.skew;
        let [x, y] = match format {
            Format::RepRap => [x + a * y + c * z, y + b * z],
            _ => [x - y * a - z * (b - a * c), y - z * c],
        };
        [x, y, z + bilinear(&self.rows, self.ends, [x, y])]
    }
}

#[test]
fn each_firmware_commands_what_abbe_commands() {
    for word in ["XYFZ", "FXYZ", "YFXZ", "ZFXY"] {
        let machine = printer(word);
        let geometry = machine.geometry();
        for format in FORMATS {
            let export = machine.export(format, &options()).unwrap();
            let told = told(format, &export);
            for (x, y) in [(-100.0, -200.0), (25.0, 100.0), (140.0, -50.0), (390.0, 40.0), (400.0, 100.0)] {
                for z in [-100.0, 0.0, 100.0] {
                    let number =
                        |letter: &str| ["X", "Y", "Z"].iter().position(|known| *known == letter).unwrap();
                    let axes = &machine.equations.axes;
                    let place = [x, y, z];
                    let position: Vec<f64> = axes.iter().map(|axis| place[number(&axis.letter)]).collect();
                    let pose = Pose { position, direction: vec![Direction::Positive; axes.len()] };
                    let correction = geometry.correction(&pose).unwrap();
                    let theirs = told.commanded(format, place);
                    for (axis, more) in axes.iter().zip(correction) {
                        let direction = number(&axis.letter);
                        // Decimals of the files, and second order: 0.3 mm times a slope of 2.6 in a thousand.
                        let apart = (place[direction] + more - theirs[direction]).abs();
                        assert!(apart < 1e-3, "{word} {format:?} {place:?} {}: {apart}", axis.letter);
                    }
                }
            }
            let lost = &export.lost;
            assert!(lost.without.largest > 0.2 && lost.lost.largest < 1e-3, "{word} {format:?}: {lost:?}");
        }
    }
}

#[test]
fn signs_by_numbers_worked_by_hand() {
    // A Y that leans towards -X by 1 mrad lets the tool go 0.1 mm too far towards -X in 100 mm of Y. Marlin takes away its factor
    // times y: it must be -0.001. RepRapFirmware adds: 0.1 mm over 100 mm.
    let machine = Machine::of("FXYZ", &["EC0Y: 1 mrad".to_owned()]);
    let export = |format| machine.export(format, &options()).unwrap();
    assert_eq!(text(&export(Format::Marlin), "abbe.gcode"), "M852 I-0.001000000 J0.000000000 K0.000000000\n");
    let klipper = export(Format::Klipper);
    assert_eq!(
        text(&klipper, "abbe.cfg"),
        "[skew_correction abbe]\nxy_skew = -0.001000000\nxz_skew = 0.000000000\nyz_skew = 0.000000000\n"
    );
    let reprap = export(Format::RepRap);
    assert_eq!(text(&reprap, "abbe.g"), "M556 S100 X0.1000000 Y0.0000000 Z0.0000000 P0\n");
    assert_eq!(reprap.files.len(), 1, "Z needs no mesh");
    // A bed that is 0.1 mm high at X = 400 mm: the tool, that carries all axes, is 0.1 mm too near there, -0.2 um for each mm.
    let bed = ["EZX: [{polynomial: {axis: X, unit: um, per: mm, coefficients: [0, -0.2]}}]".to_owned()];
    let export = Machine::of("FXYZ", &bed).export(Format::Marlin, &options()).unwrap();
    let marlin = text(&export, "abbe.gcode");
    assert!(
        marlin.contains("M421 I0 J0 Z-0.02000\n") && marlin.contains("M421 I1 J1 Z0.08000\n"),
        "{marlin}"
    );
}

#[test]
fn what_no_printer_knows_is_lost_in_its_size() {
    // A scale that is 0.1 in a thousand too long: 25 um at either end of 500 mm.
    let error = ["EXX: [{polynomial: {axis: X, unit: um, per: mm, coefficients: [0, 0.1]}}]".to_owned()];
    for format in FORMATS {
        let export = Machine::of("YFXZ", &error).export(format, &options()).unwrap();
        assert!((export.lost.lost.largest - 0.025).abs() < 1e-5, "{:?}", export.lost);
        assert!((export.lost.with_files.rms - export.lost.without.rms).abs() < 1e-9);
    }
}

#[test]
fn meshes_are_as_large_as_a_firmware_takes() {
    // A wave over X is curved everywhere: as many points as there may be.
    let wave = ["EZX: [{cyclic: {axis: X, period: 250 mm, amplitude: 100 um, phase: 0 deg}}]".to_owned()];
    let machine = Machine::of("YFXZ", &wave);
    let columns = |format| told(format, &machine.export(format, &options()).unwrap()).rows[0].len();
    assert_eq!(FORMATS.map(columns), [15, 50, 21]);
    let asked = |points| Options { points: Some(points), ..options() };
    let export = machine.export(Format::Klipper, &asked(41)).unwrap();
    assert_eq!(told(Format::Klipper, &export).rows.iter().map(Vec::len).collect::<Vec<_>>(), [41; 41]);
    // The arrow of a sine of 100 um over 12.5 mm.
    let arrow = 0.1 * (1.0 - (std::f64::consts::PI * 12.5 / 250.0).cos());
    assert!(export.lost.lost.largest < 1.1 * arrow, "{:?} of {arrow}", export.lost);
    for (format, points) in
        [(Format::Marlin, 16), (Format::RepRap, 22), (Format::Klipper, 51), (Format::Klipper, 1)]
    {
        let refused = machine.export(format, &asked(points)).unwrap_err().to_string();
        assert!(refused.contains("points"), "{refused}");
    }
}

#[test]
fn other_machines_and_other_files_are_refused() {
    let machine = Machine::of("CFXYZ", &["EC0Y: 1 mrad".to_owned()]);
    let ranges = [("X", [0.0, 100.0]), ("Y", [0.0, 100.0]), ("Z", [0.0, 100.0]), ("C", [-1.0, 1.0])];
    let space = machine.space_with(&ranges);
    let refused = abbe_exchange::controller::export(&machine.geometry(), &space, Format::Marlin, &options());
    assert!(refused.unwrap_err().to_string().contains("more axes than the slides"));
    let machine = printer("XYFZ");
    let file = |text: &str| [(SourceFile::new("file", text), None)];
    for (format, text) in [
        (Format::Klipper, "M852 I0.1\n"),
        (Format::Marlin, "[skew_correction a]\nxy_skew = 0\n"),
        (Format::RepRap, "[skew_correction a]\nxy_skew = 0\n"),
        (Format::Marlin, "0 0.1 0.1\n10 0.2 0.2\n"),
        (Format::Marlin, "M556 S100 X0.1\n"),
        (Format::RepRap, "M852 I0.001\n"),
    ] {
        let checked = check(&machine.geometry(), &machine.space(), format, &options(), &file(text));
        let Err(Unusable::File(told)) = checked else { panic!("{text} is taken") };
        assert!(told.contains("E0802"), "{told}");
    }
    // A later file adds to an earlier one: the skew of one, the mesh of the other.
    let both = [file("M556 S100 X0.1\n"), file("RepRapFirmware height map file v2\nxmin,xmax,ymin,ymax,radius,spacing,xnum,ynum\n-100,400,-200,100,-1,300,2,2\n0.1,0.2\n0.3,0.4\n")].concat();
    let checked = check(&machine.geometry(), &machine.space(), Format::RepRap, &options(), &both).unwrap();
    let one = check(&machine.geometry(), &machine.space(), Format::RepRap, &options(), &both[..1]).unwrap();
    assert!(checked.lost != one.lost);
}

/// A mesh is a table over one axis for each place of the other: both say how far their axis goes.
#[test]
fn the_places_of_a_curve_say_how_far_its_axis_goes() {
    let row = "EZX: [{table: {axis: X, start: 20 mm, step: 100 mm, unit: um, values: [0, 10, 30], \
               times: [{curve: Y, at: [-40 mm, 10 mm, 60 mm], values: [0, 1, 0]}]}}]";
    let mut machine = Machine::of("YFXZ", &[row.to_owned()]);
    let wanted = |z| Wanted { ranges: vec![("Z".to_owned(), z)], reference: Vec::new() };
    let space = Space::new(&machine.equations, &machine.calibration, &wanted([0.0, 50.0])).unwrap();
    assert_eq!(space.ranges, [[20.0, 220.0], [-40.0, 60.0], [0.0, 50.0]]);
    machine.calibration.motions.clear();
    assert!(Space::new(&machine.equations, &machine.calibration, &wanted([0.0, 50.0])).is_err());
}
