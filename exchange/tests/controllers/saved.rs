//! What firmware has saved, taken over: the firmware's transform, written here from its source, against Abbe's compensation with the
//! calibration. Both must send the tool to the same place but for what is of second order.

use abbe_exchange::controller::{Geometry, Kind, Pose, SavedWanted, Unit, saved_terms};
use abbe_runtime::Direction;
use model_dsl::calibration::{self, Calibration};
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use crate::machine::{Machine, bilinear};

/// Orders of axes, the bed of the printer on the part's branch, on the tool's, and halfway.
const WORDS: [&str; 5] = ["XYFZ", "FXYZ", "YFXZ", "ZFXY", "YFZX"];

/// A machine's calibration of what stands in a file.
fn taken(machine: &Machine, text: &str, wanted: &SavedWanted) -> Calibration {
    let source = SourceFile::new("saved", text);
    let mut diagnostics = Diagnostics::new();
    let empty = Calibration::new("m", machine.calibration.constants.clone());
    let terms = saved_terms(&machine.equations, &empty, &source, wanted, &mut diagnostics).unwrap();
    assert!(diagnostics.is_empty(), "{}", render(&source, &diagnostics, false));
    let taken = empty.with(&terms);
    // What is written reads back to the same bits.
    let written = SourceFile::new("written", calibration::write(&taken, &machine.equations.names()));
    let root = yaml::read(&written, &mut Diagnostics::new()).unwrap();
    let read = calibration::read(&root, &machine.equations.names(), &mut Diagnostics::new()).unwrap();
    assert_eq!(read, taken);
    taken
}

/// What Abbe commands in place of x, y, z.
fn commanded(
    machine: &Machine,
    calibration: &Calibration,
    place: [f64; 3],
    direction: Direction,
) -> [f64; 3] {
    let axes = &machine.equations.axes;
    let number = |letter: &str| ["X", "Y", "Z"].iter().position(|known| *known == letter).unwrap();
    let position: Vec<f64> = axes.iter().map(|axis| place[number(&axis.letter)]).collect();
    let pose = Pose { position, direction: vec![direction; axes.len()] };
    let correction = Geometry::new(&machine.equations, calibration).correction(&pose).unwrap();
    let mut command = place;
    for (axis, more) in axes.iter().zip(correction) {
        command[number(&axis.letter)] += more;
    }
    command
}

/// Places all over a bed of 200 mm, 150 mm high.
fn places() -> impl Iterator<Item = [f64; 3]> {
    let steps = [-13.0, 0.0, 37.5, 90.0, 155.0, 200.0, 214.0];
    steps.into_iter().flat_map(move |x| {
        steps.into_iter().flat_map(move |y| [0.0, 20.0, 150.0].into_iter().map(move |z| [x, y, z]))
    })
}

fn apart(one: [f64; 3], other: [f64; 3]) -> f64 {
    one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// Marlin's `Planner::skew`, and Klipper's `calc_skew`, which is a port of it.
fn marlin([xy, xz, yz]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [x - y * xy - z * (xz - xy * yz), y - z * yz, z]
}

/// RepRapFirmware's `Move::AxisTransform`.
fn reprap([xy, yz, xz]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [x + xy * y + xz * z, y + yz * z, z]
}

#[test]
fn skew_of_each_firmware_is_that_of_its_transform() {
    let klipper = "#*# <- SAVE_CONFIG ->\n#*#\n#*# [skew_correction mine]\n#*# xy_skew = 0.004\n#*# xz_skew = -0.003\n#*# yz_skew = 0.002\n";
    let factors = [0.004, -0.003, 0.002];
    for word in WORDS {
        let machine = Machine::of(word, &[]);
        for text in [
            klipper,
            "Send: M503\nRecv: echo:  M852 I0.004 J-0.003 K0.002\nok\n",
            "M852 S0.004 J-0.003\nM852 K0.002 ; later",
        ] {
            let calibration = taken(&machine, text, &SavedWanted::default());
            for place in places() {
                let ours = commanded(&machine, &calibration, place, Direction::Positive);
                // The transform is the exact inverse of a linear error, which Abbe solves to a nanometre.
                assert!(apart(ours, marlin(factors, place)) < 1e-5, "{word} {place:?}: {ours:?}");
                // With the wrong sign the two would be up to 1.6 mm apart.
                assert!(place[1] < 30.0 || apart(ours, place) > 0.05);
            }
        }
        let calibration = taken(&machine, "M556 S100 X0.4 Y-0.3 Z0.2 ; measured\n", &SavedWanted::default());
        for place in places() {
            let ours = commanded(&machine, &calibration, place, Direction::Positive);
            assert!(apart(ours, reprap([0.004, -0.003, 0.002], place)) < 1e-5, "{word} {place:?}: {ours:?}");
        }
    }
}

#[test]
fn skew_by_numbers_worked_by_hand() {
    // M852 I0.001: the firmware sends the tool 0.1 mm towards -X at y = 100, since it stands 0.1 mm too far towards +X there. A lean
    // of +Y towards -X is a positive EC0Y, so that this one is -1 mrad.
    let machine = Machine::of("FXYZ", &[]);
    let of = |text: &str| {
        let calibration = taken(&machine, text, &SavedWanted::default());
        let motions = &calibration.motions;
        let name = |motion: usize| machine.equations.motions[motion].name.clone();
        motions.iter().map(|one| (name(one.motion), format!("{:?}", one.terms[0].value))).collect::<Vec<_>>()
    };
    assert_eq!(of("M852 I0.001"), [("EC0Y".to_owned(), "Constant { value: -0.001 }".to_owned())]);
    assert_eq!(of("M852 J0.001"), [("EB0Z".to_owned(), "Constant { value: 0.001 }".to_owned())]);
    assert_eq!(of("M852 K0.001"), [("EA0Z".to_owned(), "Constant { value: -0.001 }".to_owned())]);
    // RepRapFirmware adds where Marlin takes away.
    assert_eq!(of("M556 S100 X0.1"), [("EC0Y".to_owned(), "Constant { value: 0.001 }".to_owned())]);
    // Applied to Y in place of X it leans X towards -Y, which no alignment error of this machine does: the straightness of X does.
    assert_eq!(
        of("M556 S100 X0.1 P1"),
        [("EYX".to_owned(), "Polynomial { input: Axis(0), coefficients: [0.0, -0.001] }".to_owned())]
    );
}

#[test]
fn a_skew_that_no_alignment_error_may_be_is_the_slope_of_a_straightness() {
    // The lengths of Klipper's documentation, 140.4, 142.8 and 99.8 mm, are a lean of 17 mrad.
    for word in WORDS {
        let machine = Machine::of(word, &[]);
        let calibration = taken(&machine, "M852 I-0.017 J0.02 K0.015", &SavedWanted::default());
        for place in places() {
            let ours = commanded(&machine, &calibration, place, Direction::Positive);
            assert!(apart(ours, marlin([-0.017, 0.02, 0.015], place)) < 1e-5, "{word} {place:?}: {ours:?}");
        }
    }
}

/// Heights of a bed in mm, row by row from the least Y on: no two alike, so that a mesh that is mirrored or transposed shows.
const HEIGHTS: [[f64; 4]; 3] = [[0.1, -0.05, 0.02, 0.3], [0.0, 0.12, -0.08, 0.05], [-0.2, 0.07, 0.15, -0.11]];

/// The height at a place, the mesh lying over 10 to 190 mm in X and 20 to 180 mm in Y.
fn height(x: f64, y: f64) -> f64 {
    bilinear(&HEIGHTS, [[10.0, 190.0], [20.0, 180.0]], [x, y])
}

fn joined(separator: &str, row: &[f64; 4]) -> String {
    row.map(|height| format!("{height:+.3}")).join(separator)
}

#[test]
fn a_mesh_of_each_firmware_lifts_the_tool_where_the_bed_is_high() {
    let rows = || HEIGHTS.iter();
    let points: String = rows().map(|row| format!("#*# \t{}\n", joined(", ", row))).collect();
    let counts = "#*# x_count = 4\n#*# y_count = 3\n#*# mesh_x_pps = 2\n#*# algo = lagrange\n";
    let ends = "#*# min_x = 10.0\n#*# max_x = 190.0\n#*# min_y = 20.0\n#*# max_y = 180.0\n";
    let klipper = format!(
        "[bed_mesh]\nspeed: 120 # mm/s\n\n#*# [bed_mesh default]\n#*# version = 1\n#*# points =\n{points}{counts}{ends}"
    );
    // An old profile holds the places of the probe, and how far it is from the nozzle.
    let probe = "#*# min_x = 35.0\n#*# max_x = 215.0\n#*# min_y = 20.0\n#*# max_y = 180.0\n#*# x_offset = -25.0\n#*# y_offset = 0.0\n";
    let old = format!("#*# [bed_mesh default]\n#*# points =\n{points}{counts}{probe}");
    let heights: String = rows().map(|row| format!("{}\n", joined(",", row))).collect();
    let duet = format!(
        "RepRapFirmware height map file v2 generated at 2026-01-01 10:00, min error -0.200, max error 0.300, mean 0.020, deviation 0.133\n\
         axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1\nX,Y,10.00,191.00,20.00,180.00,-1.00,60.00,80.00,4,3\n{heights}"
    );
    let older = duet
        .replace(
            "axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1",
            "xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum",
        )
        .replace("X,Y,10", "10");
    let grid: String =
        rows().enumerate().map(|(number, row)| format!(" {number} {}\n", joined(" ", row))).collect();
    let bilinear =
        format!("echo:Bed Leveling ON\nBilinear Leveling Grid:\n      0      1      2      3\n{grid}\nok\n");
    let upside: String = rows()
        .enumerate()
        .rev()
        .map(|(number, row)| {
            format!("Recv: {number} | {}\nRecv:   |\n", joined("  ", row).replace("+0.300", "[+0.300]"))
        })
        .collect();
    let unified = format!(
        "Recv: Bed Topography Report:\nRecv:\nRecv:     ( 10,180)            (190,180)\nRecv:        0       1       2      3\n{upside}Recv:        0       1       2      3\nRecv:     ( 10, 20)            (190, 20)\n"
    );
    let table: String = rows().rev().map(|row| format!("{}\n", joined("\t", row))).collect();
    let table = format!("Bed Topography Report for CSV:\n\n{table}\n");
    let command = |begin: &str| -> String {
        let point = |(j, row): (usize, &[f64; 4])| -> String {
            row.iter().enumerate().map(|(i, height)| format!("{begin} I{i} J{j} Z{height}\n")).collect()
        };
        rows().enumerate().map(point).collect()
    };
    let (ubl, m503) = (command("M421"), command("echo:  G29 W"));
    let none = SavedWanted::default();
    let reach = SavedWanted { reach: [Some([10.0, 190.0]), Some([20.0, 180.0])], ..none.clone() };
    let files = [
        (klipper, &none),
        (old, &none),
        (duet, &none),
        (older, &none),
        (bilinear, &reach),
        (unified, &reach),
        (table, &reach),
        (ubl, &reach),
        (m503, &reach),
    ];
    for word in WORDS {
        let machine = Machine::of(word, &[]);
        for (text, wanted) in &files {
            let calibration = taken(&machine, text, wanted);
            for place in places() {
                let [x, y, z] = place;
                let ours = commanded(&machine, &calibration, place, Direction::Positive);
                assert!(apart(ours, [x, y, z + height(x, y)]) < 1e-5, "{word} {place:?}: {ours:?}\n{text}");
            }
        }
    }
}

#[test]
fn a_height_map_with_points_that_were_not_probed_takes_their_plane() {
    // z = 0.1 + 0.002 x - 0.001 y at eight of nine points; the ninth, at 100 and 100 mm, must be 0.2.
    let text = "RepRapFirmware height map file v2\nxmin,xmax,ymin,ymax,radius,spacing,xnum,ynum\n0,100,0,100,-1,50,3,3\n\
                0.100,0.200,0.300\n0.050,0.150,0.250\n0.000,0.100,      0\n";
    let machine = Machine::of("YFXZ", &[]);
    let source = SourceFile::new("saved", text);
    let mut diagnostics = Diagnostics::new();
    let empty = Calibration::new("m", machine.calibration.constants.clone());
    let terms =
        saved_terms(&machine.equations, &empty, &source, &SavedWanted::default(), &mut diagnostics).unwrap();
    let told = render(&source, &diagnostics, false);
    assert!(told.contains("W0801") && told.contains("1 of 9 points"), "{told}");
    let ours = commanded(&machine, &empty.with(&terms), [100.0, 100.0, 0.0], Direction::Positive);
    assert!((ours[2] - 0.2).abs() < 1e-9, "{ours:?}");
}

#[test]
fn a_screw_table_of_either_type_is_what_the_joint_adds() {
    let trims = [(0.0, 0.01, -0.02), (100.0, 0.05, 0.03), (250.0, -0.04, -0.04)];
    let trim = |place: f64, forward: bool| {
        let of = |entry: &(f64, f64, f64)| if forward { entry.1 } else { entry.2 };
        let pair = trims.windows(2).find(|pair| place <= pair[1].0).unwrap();
        let share = (place - pair[0].0) / (pair[1].0 - pair[0].0);
        of(&pair[0]) * (1.0 - share) + of(&pair[1]) * share
    };
    let type_1: String =
        trims.iter().map(|(at, forward, reverse)| format!("{at} {forward} {reverse}\n")).collect();
    let type_0: String = trims
        .iter()
        .map(|(at, forward, reverse)| format!("{at} {:.6} {:.6}\n", at - forward, at - reverse))
        .collect();
    let inches: String = trims
        .iter()
        .map(|(at, forward, reverse)| {
            format!("{:.9} {:.9} {:.9}\n", at / 25.4, forward / 25.4, reverse / 25.4)
        })
        .collect();
    for word in WORDS {
        let machine = Machine::of(word, &[]);
        for (letter, direction) in [("X", 0), ("Y", 1), ("Z", 2)] {
            let axis = machine.equations.axes.iter().position(|axis| axis.letter == letter);
            let wanted = |kind, unit| SavedWanted { axis, kind: Some(kind), unit, ..SavedWanted::default() };
            let files = [
                (&type_1, wanted(Kind::Trim, None)),
                (&type_0, wanted(Kind::Actual, Some(Unit::MM))),
                (&inches, wanted(Kind::Trim, Some(Unit::INCH))),
            ];
            for (text, wanted) in files {
                let calibration = taken(&machine, text, &wanted);
                for at in [0.0, 20.0, 100.0, 180.0, 250.0] {
                    for (way, forward) in [(Direction::Positive, true), (Direction::Negative, false)] {
                        let mut place = [7.0, 8.0, 9.0];
                        place[direction] = at;
                        let mut theirs = place;
                        theirs[direction] += trim(at, forward);
                        // Second order: 0.05 mm times a slope of 0.6 in a thousand.
                        let ours = commanded(&machine, &calibration, place, way);
                        assert!(apart(ours, theirs) < 5e-5, "{word} {letter} {at}: {ours:?}, {theirs:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn what_a_file_does_not_say_is_asked_for_at_its_place() {
    let machine = Machine::of("XYFZ", &[]);
    let mesh = "[bed_mesh a]\nx_count = 2\ny_count = 2\nmin_x = 0\nmax_x = 10\nmin_y = 0\nmax_y = 10\npoints =\n  0.1, 0.2\n  0.3, 0.4\n";
    let two = format!("{mesh}{}", mesh.replace("[bed_mesh a]", "[bed_mesh b]"));
    let heights = |rows: &str| {
        format!(
            "RepRapFirmware height map file v2\nxmin,xmax,ymin,ymax,radius,spacing,xnum,ynum\n0,50,0,50,-1,50,2,2\n{rows}"
        )
    };
    let reach = SavedWanted { reach: [Some([0.0, 10.0]); 2], ..SavedWanted::default() };
    let screw = SavedWanted { axis: Some(0), ..SavedWanted::default() };
    let typed = SavedWanted { kind: Some(Kind::Trim), ..screw.clone() };
    let named = SavedWanted { mesh: Some("c".to_owned()), ..SavedWanted::default() };
    let nothing = SavedWanted::default();
    let other = SavedWanted { kind: Some(Kind::Actual), ..screw.clone() };
    let cases: [(&str, &SavedWanted, &str, &str); 22] = [
        (&mesh.replace("0.4", "400"), &nothing, "E0430", ""),
        ("0 0.01 0.01\n500 0.02 0.03\n", &other, "E0430", ""),
        (&two, &nothing, "E0804", "b"),
        (&two, &named, "E0804", ""),
        (&mesh.replace("0.3, 0.4", "0.3, x4"), &nothing, "E0801", "x4"),
        (&mesh.replace("0.3, 0.4", "0.3"), &nothing, "E0803", "0.3"),
        (&mesh.replace("  0.3, 0.4\n", ""), &nothing, "E0803", "bed_mesh a"),
        (&mesh.replace("max_x = 10", "max_x = 0"), &nothing, "E0803", "bed_mesh a"),
        (&mesh.replace("min_y = 0\n", ""), &nothing, "E0802", "bed_mesh a"),
        ("[skew_correction a]\nxy_skew = 0.1\nxz_skew = 0\n", &nothing, "E0802", "skew_correction a"),
        (&heights("0.1,0.2\n0.1,O.2\n"), &nothing, "E0801", "O.2"),
        (&heights("0.1,0.2\n0.1\n"), &nothing, "E0803", "0.1"),
        (&heights("0.1,0.2,0.3,0.4\n"), &nothing, "E0803", "0.1,0.2,0.3,0.4"),
        (&heights("0,0\n0,0\n"), &nothing, "E0803", "0,50,0,50,-1,50,2,2"),
        ("M421 I0 J0 Z0.1\n", &nothing, "E0804", "M421 I0 J0 Z0.1"),
        ("M421 I0 Z0.1\n", &reach, "E0802", "M421 I0 Z0.1"),
        ("M421 I0 J0 Z0.1\nM421 I1 J1 Z0.1\n", &reach, "E0803", "M421 I0 J0 Z0.1"),
        ("M556 X0.1\n", &nothing, "E0803", "M556 X0.1"),
        ("M852 I0.1\nM556 S100 X0.1\n", &nothing, "E0803", "M556 S100 X0.1"),
        ("Bilinear Leveling Grid:\n 0 +0.1 =====\n 1 +0.1 +0.2\n", &reach, "E0801", "====="),
        ("0 1 1\n10 1 1\n", &screw, "E0804", ""),
        ("# no numbers here\n0 1 1\n", &typed, "E0802", ""),
    ];
    for (text, wanted, code, at) in cases {
        let source = SourceFile::new("saved", text);
        let mut found = Diagnostics::new();
        let empty = Calibration::new("m", machine.calibration.constants.clone());
        let terms = saved_terms(&machine.equations, &empty, &source, wanted, &mut found).unwrap();
        assert!(terms.is_empty());
        let finding = found.iter().find(|finding| finding.code == code);
        let finding = finding.unwrap_or_else(|| panic!("{text}\n{}", render(&source, &found, false)));
        assert_eq!(&text[finding.span.start..finding.span.end], at, "{text}");
        assert!(finding.help.is_some(), "{text}");
    }
}

#[test]
fn what_the_loader_of_a_screw_table_leaves_out_is_told() {
    let machine = Machine::of("XYFZ", &[]);
    let source = SourceFile::new("saved", "0 0.1 0.1\n10 0.2 0.2\n# the end\n20 0.3 0.3\n");
    let wanted = SavedWanted { axis: Some(0), kind: Some(Kind::Trim), ..SavedWanted::default() };
    let mut found = Diagnostics::new();
    let empty = Calibration::new("m", machine.calibration.constants.clone());
    let terms = saved_terms(&machine.equations, &empty, &source, &wanted, &mut found).unwrap();
    let told = render(&source, &found, false);
    assert!(terms.len() == 1 && told.contains("W0802") && told.contains("line 3"), "{told}");
}

#[test]
fn a_machine_without_such_slides_is_refused() {
    for (word, text, lacks) in [("XFZ", "M852 I0.001\n", "no axis Y"), ("FXY", "M852 J0.001\n", "no axis Z")]
    {
        let machine = Machine::of(word, &[]);
        let empty = Calibration::new("m", machine.calibration.constants.clone());
        let source = SourceFile::new("saved", text);
        let refused = saved_terms(
            &machine.equations,
            &empty,
            &source,
            &SavedWanted::default(),
            &mut Diagnostics::new(),
        );
        assert!(refused.unwrap_err().to_string().contains(lacks));
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn no_text_makes_a_reader_panic(text in "(RepRapFirmware height map file\n|\\[bed_mesh a\\]\n|\\[skew_correction a\\]\n|Bilinear Leveling Grid:\n|M421 |M556 |M852 |G29 W ){1,2}([-+0-9a-zA-Z.,;=:\\[\\]# |\n\t]|µ|points = |x_count = 2|I0 |J0 |Z0.1 |S100 |X0.1 |0 0.1 0.2\n){0,60}") {
        let machine = Machine::of("XYFZ", &[]);
        let empty = Calibration::new("m", machine.calibration.constants.clone());
        let wanted = SavedWanted { axis: Some(0), kind: Some(Kind::Actual), reach: [Some([0.0, 10.0]); 2], ..SavedWanted::default() };
        let _ = saved_terms(&machine.equations, &empty, &SourceFile::new("saved", text), &wanted, &mut Diagnostics::new());
    }
}
