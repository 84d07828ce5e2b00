//! The command line as its users meet it: arguments and standard input in, standard output,
//! standard error and the exit status out.

use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use crate::shipped::root;

/// What a run of the program left behind.
pub(crate) struct Run {
    pub(crate) status: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

/// Starts the program in the root of the repository, with all its streams in pipes. What a user or a CI sets for colour is
/// taken away.
fn start(arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    for name in ["CI", "CLICOLOR", "CLICOLOR_FORCE", "NO_COLOR"] {
        command.env_remove(name);
    }
    command
        .args(arguments)
        .current_dir(root())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

pub(crate) fn abbe(arguments: &[&str], input: &str) -> Run {
    let mut child = start(arguments);
    let mut stdin = child.stdin.take().unwrap();
    // A program that stops early closes its input; that is its right.
    let _ = stdin.write_all(input.as_bytes());
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    Run {
        status: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

/// A file of the given text in a folder of the test's own.
fn file(test: &str, name: &str, text: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(test);
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The numbers of one column of CSV output.
pub(crate) fn column(out: &str, name: &str) -> Vec<f64> {
    let mut lines = out.lines();
    let at = lines.next().unwrap().split(',').position(|own| own == name).unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

#[test]
fn every_format_of_every_name_prints() {
    for format in ["text", "latex", "html", "json", "maxima", "python", "svg"] {
        for names in ["iso", "symbols"] {
            let run = abbe(&["derive", "excello-921", "--format", format, "--names", names], "");
            assert_eq!((run.status, run.err.as_str()), (0, ""), "{format} {names}");
            assert!(run.out.contains("excello-921"), "{format} {names}");
        }
    }
}

/// The drawing alone is that of the page, as a file that shows without one.
#[test]
fn the_drawing_of_a_chain_is_that_of_its_page() {
    let picture = abbe(&["derive", "trunnion-5axis", "--format", "svg"], "").out;
    assert!(picture.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" "), "{picture}");
    let body = picture.split("</style>\n").nth(1).unwrap();
    assert!(body.contains("rotary C about") && body.matches("class=\"card\"").count() == 7, "{body}");
    assert!(abbe(&["derive", "trunnion-5axis", "--format", "html"], "").out.contains(body));
}

#[test]
fn the_lathe_in_json_is_what_the_contract_says() {
    let out = abbe(&["derive", "excello-921", "--format", "json"], "").out;
    for piece in [
        r#""schema": "abbe-equations/1""#,
        r#""machine": "excello-921""#,
        r#""nominal": "x - X1 + X2 + Xt""#,
        r#"{"motion": "EBX", "symbol": "eyx", "arm": "Zt"}"#,
        r#"{"motion": "EB0X", "symbol": "alpha", "arm": "-x"}"#,
    ] {
        assert!(out.contains(piece), "{piece} in {out}");
    }
}

#[test]
fn a_topology_word_is_a_machine() {
    let run = abbe(&["derive", "FX"], "");
    assert!(run.out.contains("dPx = EXX + Zt*EBX - Yt*ECX"), "{}", run.out);
    let wrong = abbe(&["derive", "XXFZ"], "");
    assert_eq!(wrong.status, 2);
    assert!(wrong.err.contains("error[E0113]"), "{}", wrong.err);
}

/// Small letters, a digit and a word that is too long are mistakes of a topology, not names of machines.
#[test]
fn a_wrong_topology_word_is_told_as_such() {
    for (word, code, words) in [
        ("xyfz", "E0112", "write `XYFZ`"),
        ("XYFZ2", "E0112", "`2` is not an axis"),
        ("FXYZABCU", "E0112", "`U` is not an axis"),
        ("FXYZABCUV", "E0112", "`U` is not an axis"),
    ] {
        let run = abbe(&["derive", word], "");
        assert_eq!(run.status, 2, "{word}");
        assert!(run.err.contains(&format!("error[{code}]: `{word}` is not a topology")), "{}", run.err);
        assert!(run.err.contains(words) && !run.err.contains("did you mean"), "{}", run.err);
    }
}

/// A number below zero is told as a number, not as an option that is unknown.
#[test]
fn numbers_out_of_range_are_told_with_the_range() {
    for (words, told) in [
        (&["compensate", "c.yaml", "--hysteresis", "-1"][..], "write a number that is zero or more"),
        (&["update", "c.yaml", "m.yaml", "--tolerance", "-1"], "write a number that is zero or more"),
        (&["export", "linuxcnc", "c.yaml", "--points", "-3"], "write a whole number from 2 to 1000000"),
        (&["export", "linuxcnc", "c.yaml", "--type", "2"], "write a whole number from 0 to 1"),
        (
            &["export", "linuxcnc", "c.yaml", "--range", "X=0:1e300"],
            "`1e300` is farther than any machine reaches",
        ),
        (&["limits", "r.yaml", "--seed", "-1"], "write a whole number of at least 0"),
        (&["limits", "r.yaml", "--trials", "-1"], "write a whole number from 4 to 1000"),
        (&["limits", "r.yaml", "--trials", "0"], "write a whole number from 4 to 1000"),
        (&["simulate", "c.yaml", "p.yaml", "--seed", "-1"], "write a whole number of at least 0"),
        (&["plan", "path.yaml"], "--calibration <FILE>"),
    ] {
        let run = abbe(words, "");
        assert_eq!((run.status, run.out.as_str()), (2, ""), "{words:?}");
        assert!(run.err.contains(told) && !run.err.contains("use '-- "), "{words:?}: {}", run.err);
    }
}

#[test]
fn positions_that_cannot_be_read_are_told_with_what_is_wrong() {
    let numbers =
        file("far", "c.yaml", &fs::read_to_string(root().join("calibrations/postech-mill.yaml")).unwrap());
    for (positions, told) in [
        ("x,y,z\n1e308,0,0\n", "column `x`: `1e308` is farther than any machine reaches"),
        ("x y z\n0 0 0\n", "no commas, semicolons or tabs between the names; write `x,y,z`"),
        ("#unit,in,in,in\nx,y,z\n0,0,0\n", "the row of units stands above the names of the columns"),
    ] {
        let run = abbe(&["compensate", &numbers], positions);
        assert!(run.status != 0 && run.err.contains(told), "{positions}: {}{}", run.out, run.err);
        assert_eq!(run.err.matches("error:").count(), 1, "{}", run.err);
    }
}

/// A row of units that is not seen makes every position wrong by 25.4.
#[test]
fn units_of_positions_are_read_however_they_are_marked() {
    let calibration = file("marked", "backlash.yaml", BACKLASH);
    let plain = abbe(&["compensate", &calibration], "x,y,z\n#unit,in,in,in\n1,2,3\n");
    assert_eq!(plain.status, 0, "{}", plain.err);
    for units in [
        "#units,in,in,in",
        "# unit,in,in,in",
        "#Unit,in,in,in",
        "# Units: in,in,in",
        "# by hand\n#unit,in,in,in",
    ] {
        let run = abbe(&["compensate", "--skip-bad", &calibration], &format!("x,y,z\n{units}\n1,2,3\n"));
        assert_eq!((run.status, run.out, run.err.as_str()), (0, plain.out.clone(), ""), "{units}");
    }
    for (rows, told) in [
        ("# unit,in,in,in\nx,y,z\n1,2,3\n", "line 1: the row of units stands above the names of the columns"),
        ("x,y,z\n1,2,3\n\n#units,in,in,in\n1,2,3\n", "line 4: a row of units stands below rows of numbers"),
        ("x,y,z\n#unit,in\n1,2,3\n", "the row of units has 1 unit for 3 columns"),
    ] {
        let run = abbe(&["compensate", "--skip-bad", &calibration], rows);
        assert!(run.status != 0 && run.err.contains(told), "{rows}: {}", run.err);
    }
}

#[test]
fn comments_stand_among_positions_and_hide_no_row() {
    let calibration = file("commented", "backlash.yaml", BACKLASH);
    let plain = abbe(&["compensate", &calibration], "x,y,z\n1,2,3\n2,2,3\n");
    let comments = "# by hand, in May\n\nx,y,z\n# first\n1,2,3\n# a, b\n#\n2,2,3\n";
    let run = abbe(&["compensate", &calibration], comments);
    assert_eq!((run.status, run.out, run.err.as_str()), (0, plain.out.clone(), ""));
    let told = abbe(&["compensate", &calibration], "sep=;\r\nx;y;z\r\n1;2;3\r\n2;2;3\r\n");
    assert_eq!((told.status, told.out), (0, plain.out.replace(',', ";")), "{}", told.err);
    // Names of rows may begin with `#`.
    let named = abbe(&["compensate", &calibration], "point,x,y,z\n#1,1,2,3\n#2,2,2,3\n");
    assert_eq!(named.out.lines().count(), 3, "{}{}", named.out, named.err);
    // An open quote in a comment would hide the rows behind it.
    let open = abbe(&["compensate", &calibration], "x,y,z\n# a,\"b\n1,2,3\n2,2,3\n");
    assert!(open.status == 1 && open.err.contains("line 2, row 1 under the header"), "{}", open.err);
}

#[test]
fn a_column_that_is_nearly_read_is_refused() {
    let calibration = file("nearly", "backlash.yaml", BACKLASH);
    for (name, meant) in [("Dir_y", "dir_y"), ("DIR_X", "dir_x"), ("dr_y", "dir_y"), ("dir-y", "dir_y")] {
        let run = abbe(&["compensate", &calibration], &format!("x,y,z,{name}\n1,2,3,-1\n"));
        assert_eq!((run.status, run.out.as_str()), (2, ""), "{name}");
        let told = format!("nothing reads column `{name}`; did you mean `{meant}`?");
        assert!(run.err.contains(&told), "{}", run.err);
    }
    // Those of other machines, and those that stand beside what is read, are no slips.
    for names in ["dir_a", "n", "T", "direction", "dir_y,Dir_y", "Tool"] {
        let row = ["1"; 2].into_iter().take(names.split(',').count()).collect::<Vec<_>>().join(",");
        let run = abbe(&["compensate", &calibration], &format!("x,y,z,{names}\n1,2,3,{row}\n"));
        assert!(run.status == 0 && run.err.contains("but nothing reads it"), "{names}: {}", run.err);
    }
    let tools = format!("{BACKLASH}tools: {{probe: {{Zt: 80 mm}}}}\n");
    let tools = file("nearly", "tools.yaml", &tools);
    let run = abbe(&["compensate", &tools], "x,y,z,Tool\n1,2,3,probe\n");
    assert!(run.status == 2 && run.err.contains("did you mean `tool`?"), "{}", run.err);
}

#[test]
fn a_bad_row_is_quoted_as_it_stands_with_its_line() {
    let calibration = file("quoted", "backlash.yaml", BACKLASH);
    for (rows, told) in [
        ("x;y;z\n1,5;2;3\n", "line 2, row 1 under the header (`1,5;2;3`)"),
        ("x,y,z\n\n1,2,3\n\n\n4,5,bad\n", "line 6, row 2 under the header (`4,5,bad`)"),
        ("x,y,z\n\n1,2,3\n\n\n4,5,bad", "line 6, row 2 under the header (`4,5,bad`)"),
        ("x,y,z\r\n\r\n1,2,3\r\n# text\r\n\r\n4,5,bad\r\n", "line 6, row 2 under the header (`4,5,bad`)"),
        ("note,x,y,z\n\"a\nb\",1,2,3\n\"c\nd\",4,5,bad\n", "line 4, row 2 under the header"),
        ("x,y,z\n1\n", "1 cell for 3 columns"),
    ] {
        let run = abbe(&["compensate", &calibration], rows);
        assert!(run.status == 1 && run.err.contains(told), "{rows:?}: {}", run.err);
    }
}

#[test]
fn positions_in_a_file_are_told_to_come_from_standard_input() {
    let run = abbe(&["compensate", "calibrations/postech-mill.yaml", "points.csv"], "");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert!(
        run.err.contains("positions come from standard input")
            && run.err.contains("`abbe compensate calibrations/postech-mill.yaml < points.csv`"),
        "{}",
        run.err
    );
    assert!(!abbe(&["compensate", "--help"], "").out.contains("[POSITIONS]"));
}

#[test]
fn a_calibration_of_another_machine_is_told_how_to_name_this_one() {
    let machine = file("expand", "mill.yaml", &abbe(&["new", "XYFZ"], "").out);
    let calibration = file("expand", "k.yaml", BACKLASH.replace("XYFZ", "FX").as_str());
    let run = abbe(&["expand", &machine, "--calibration", &calibration], "");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert!(run.err.contains("E0426") && run.err.contains("k.yaml:2:10"), "{}", run.err);
    assert!(
        run.err.contains("write `machine: mill.yaml` if this is a calibration of that machine"),
        "{}",
        run.err
    );
    assert!(!run.err.contains("no such file"), "{}", run.err);
}

#[test]
fn a_file_of_another_kind_is_named() {
    let recording = file(
        "kinds",
        "r.yaml",
        "recording: 1\nmachine: FX\ninstrument: position\ndata: d.csv\nchannels: {}\n",
    );
    for words in [["compensate", &recording].as_slice(), &["update", &recording, &recording]] {
        let run = abbe(words, "x\n0\n");
        assert_eq!((run.status, run.out.as_str()), (2, ""));
        assert!(
            run.err.contains("error[E0402]: this is a recording file, not a calibration file"),
            "{}",
            run.err
        );
        assert_eq!(run.err.matches("error").count(), 1, "{}", run.err);
    }
}

#[test]
fn what_is_no_machine_is_told_with_the_nearest_name() {
    let run = abbe(&["derive", "xyfz-mil"], "");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert!(run.err.contains("did you mean `xyfz-mill`?"), "{}", run.err);
}

#[test]
fn a_typo_of_a_file_is_told_with_the_file_that_lies_beside() {
    let mill = file("typo", "workshop-mill.yaml", "abbe: 1\nname: workshop-mill\ntopology: XYFZ\n");
    let run = abbe(&["derive", &mill.replace("workshop", "workshp")], "");
    assert_eq!(run.status, 2);
    assert!(run.err.contains(&format!("did you mean `{mill}`?")), "{}", run.err);
}

#[test]
fn a_second_tool_is_told_where_tools_are_exchanged() {
    let text = "abbe: 1\nname: m\nchain:\n  workpiece: []\n  tool:\n    - slide: X\n      along: +X\n    - tool: one\n    - tool: two\n";
    let run = abbe(&["derive", &file("second-tool", "m.yaml", text)], "");
    assert_eq!(run.status, 2);
    assert!(
        run.err.contains("error[E0126]: the chain has a second tool")
            && run.err.contains("under `tools:` in the calibration"),
        "{}",
        run.err
    );
}

#[test]
fn published_equations_agree_and_a_flipped_sign_is_named() {
    let agreeing =
        ["excello-921", "linuxcnc-xyzac-trt", "linuxcnc-xyzbc-trt", "nist-turning-center", "printer-skew"];
    for machine in agreeing {
        let run = abbe(&["check", machine, &format!("published/{machine}.eqs")], "");
        assert_eq!(run.status, 0, "{}", run.out);
    }
    let printed = fs::read_to_string(root().join("published/excello-921.eqs")).unwrap();
    assert!(printed.contains("- Xt*eyx"));
    let flipped = file("flipped", "flipped.eqs", &printed.replace("- Xt*eyx", "+ Xt*eyx"));
    let run = abbe(&["check", "excello-921", &flipped], "");
    assert_eq!(run.status, 1);
    assert!(
        run.out.contains("opposite sign: eyx (EBX): derived with lever -Xt, printed with Xt"),
        "{}",
        run.out
    );
}

#[test]
fn the_misprint_of_the_carriage_matrix_is_named() {
    let run = abbe(&["check", "postech-mill", "published/postech-carriage.eqs"], "");
    assert_eq!(run.status, 1);
    let named: Vec<_> = run.out.lines().filter(|line| line.contains("opposite sign: ")).collect();
    assert_eq!(named.len(), 1, "{}", run.out);
    assert!(named[0].contains("T(2,3)"), "{}", named[0]);
}

#[test]
fn an_equation_file_that_cannot_be_read_is_located() {
    let path = file("unread", "wrong.eqs", "dPx = dxx +\ndPz = dzq\n");
    let run = abbe(&["check", "excello-921", &path], "");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert!(run.err.contains("wrong.eqs:1:") && run.err.contains("wrong.eqs:2:"), "{}", run.err);
}

#[test]
fn a_library_for_c_is_the_same_code_and_what_c_asks_of_it() {
    for machine in ["xyfz-mill", "nist-turning-center", "trunnion-5axis", "FX"] {
        let plain = abbe(&["expand", machine], "");
        let library = abbe(&["expand", "--c-abi", machine], "");
        assert_eq!((plain.status, library.status, library.err.as_str()), (0, 0, ""), "{machine}");
        let more = library.out.strip_prefix(plain.out.trim_end()).unwrap();
        assert!(more.contains("::abbe_c::CompiledMachine for Machine"), "{machine}: {more}");
        assert_eq!(more.matches("#[unsafe(no_mangle)]").count(), 1, "{machine}");
        // The names in the code are all that the library knows of them.
        for (name, known) in [("MOTIONS", "\"EXX\", false, Some(\"X\")"), ("AXES", "\"X\", false")] {
            assert!(more.contains(name) && more.contains(known), "{machine}: no {known} in {more}");
        }
    }
}

/// The command, a build script and the generator behind the macro give the same code over numbers of 32 bits.
#[test]
fn code_over_numbers_of_32_bits_has_no_others() {
    let (machine, numbers) =
        (root().join("machines/postech-mill.yaml"), root().join("calibrations/postech-mill.yaml"));
    let found = abbe(&["expand", "postech-mill", "--f32", "--calibration", numbers.to_str().unwrap()], "");
    assert_eq!((found.status, found.err.as_str()), (0, ""));
    assert_eq!(found.out, model_dsl::single::calibrated_rust_for(machine, numbers).unwrap());
    assert!(!found.out.contains("f64") && !found.out.contains("abbe_runtime::Term"), "{}", found.out);
    for known in ["pub x: f32", "abbe_runtime::single::Bundle<6, 11>", "lost_motion: 0.01,", "-> [f32; 3]"] {
        assert!(found.out.contains(known), "no {known} in {}", found.out);
    }
    let both = abbe(&["expand", "postech-mill", "--f32", "--c-abi"], "");
    assert_eq!((both.status, both.out.as_str()), (2, ""));
    let tiny = "calibration: 1\nmachine: FX\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nerrors:\n  EXX: [{polynomial: {per: mm, unit: mm, coefficients: [0, 1e-50]}}]\n";
    let tiny = abbe(&["expand", "FX", "--f32", "--calibration", &file("expand", "tiny.yaml", tiny)], "");
    assert_eq!((tiny.status, tiny.out.as_str()), (2, ""));
    assert!(tiny.err.contains("tiny.yaml: 1e-50 cannot be written in 32 bits"), "{}", tiny.err);
}

#[test]
fn a_calibration_is_compiled_in_beside_the_same_code() {
    let numbers = root().join("calibrations/postech-mill.yaml");
    let numbers = numbers.to_str().unwrap();
    let plain = abbe(&["expand", "postech-mill"], "");
    let calibrated = abbe(&["expand", "postech-mill", "--calibration", numbers], "");
    assert_eq!((plain.status, calibrated.status, calibrated.err.as_str()), (0, 0, ""));
    let more = calibrated.out.strip_prefix(plain.out.trim_end()).unwrap();
    // The offset of the tool, the limit, the first table and the play of Y, in mm and rad.
    for known in
        ["from_array([0.0, 0.0, 120.0])", "compensation: Some(0.2)", "uniform(\n", "lost_motion: 0.01,"]
    {
        assert!(more.contains(known), "no {known} in {more}");
    }
    let other = abbe(&["expand", "xyfz-mill", "--calibration", numbers], "");
    assert_eq!((other.status, other.out.as_str()), (2, ""));
    assert!(other.err.contains("E0426") && other.err.contains("postech-mill.yaml:"), "{}", other.err);
    let both = abbe(&["expand", "postech-mill", "--c-abi", "--calibration", numbers], "");
    assert_eq!((both.status, both.out.as_str()), (2, ""));
    let drift = "calibration: 1\nmachine: FX\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nerrors:\n  EXX: [{drift: {amplitude: 3 um, time_constant: 60 s}}]\n";
    let drift = abbe(&["expand", "FX", "--calibration", &file("expand", "drift.yaml", drift)], "");
    assert_eq!((drift.status, drift.out.as_str()), (2, ""));
    assert!(drift.err.contains("E0425") && drift.err.contains("drift.yaml:5:10"), "{}", drift.err);
}

#[test]
fn a_new_machine_file_derives_what_its_word_derives() {
    let template = abbe(&["new", "CAFXYZ"], "");
    let path = file("new", "machine.yaml", &template.out);
    let equations = |machine: &str| {
        let text = abbe(&["derive", machine], "").out;
        text.lines().skip_while(|line| !line.starts_with("Px")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(equations("CAFXYZ").len() > 20);
    assert_eq!(equations(&path), equations("CAFXYZ"));
}

#[test]
fn the_published_table_compensates_the_published_points() {
    let points = fs::read_to_string(root().join("calibrations/postech-points.csv")).unwrap();
    let run = abbe(&["compensate", "--summary", "calibrations/postech-mill.yaml"], &points);
    assert_eq!(run.status, 0, "{}", run.err);
    assert!(run.out.starts_with("x,y,z,error_x,error_y,error_z,x_comp,y_comp,z_comp\n"));
    assert_eq!(run.out.lines().count(), 8);
    assert!(run.err.contains("without compensation"), "{}", run.err);
    // By hand, at the first point (20, 20, -50), in um and urad (1 arcsec = 4.848 urad), lever z + Zt = 70 mm:
    // EXX 1.5, EXY 0, EXZ 0.673, EBX -0.318 arcsec, ECX 0.864, EBY 0.929, ECY 3.643, EBZ -1.955, EC0Y 272.
    let x = 1.5
        + 0.0
        + 0.672_727
        + 4.848_137e-3
            * (70.0 * (-0.318_182 + 0.928_571) - 20.0 * (0.863_636 + 3.642_857) - 120.0 * 1.954_545)
        - 0.272 * 20.0;
    assert!((column(&run.out, "error_x")[0] * 1e3 - x).abs() < 2e-3, "{x} and {}", run.out);
}

const BACKLASH: &str = "calibration: 1\nmachine: FXYZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nerrors:\n  EXX: [{backlash: {lost_motion: 10 um}}]\n";

#[test]
fn the_direction_comes_from_a_column_or_from_the_motion() {
    let calibration = file("direction", "backlash.yaml", BACKLASH);
    let given = abbe(&["compensate", &calibration], "x,y,z,dir_x\n1,0,0,+1\n1,0,0,-1\n");
    assert_eq!(column(&given.out, "error_x"), [-0.005, 0.005]);
    assert_eq!(column(&given.out, "x_comp"), [1.005, 0.995]);
    let moved = abbe(&["compensate", &calibration], "x,y,z\n1,0,0\n2,0,0\n1.5,0,0\n1.5004,0,0\n1.6,0,0\n");
    // A motion of 0.4 um back is dither, not a reversal.
    assert_eq!(column(&moved.out, "error_x"), [-0.005, -0.005, 0.005, 0.005, -0.005]);
    let exact =
        abbe(&["compensate", "--hysteresis", "0", &calibration], "x,y,z\n2,0,0\n1.5,0,0\n1.5004,0,0\n");
    assert_eq!(column(&exact.out, "error_x"), [-0.005, 0.005, -0.005]);
}

#[test]
fn other_units_stand_in_a_second_row_and_come_back() {
    let scale = BACKLASH.replace(
        "backlash: {lost_motion: 10 um}",
        "polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 1]}",
    );
    let calibration = file("units", "scale.yaml", &scale);
    let run = abbe(&["compensate", &calibration], "\u{feff}x,y,z\r\n#unit,in,mm,mm\r\n1,0,0\r\n");
    assert_eq!(run.status, 0, "{}", run.err);
    let lines: Vec<_> = run.out.lines().collect();
    assert_eq!(lines[1], "#unit,in,mm,mm,mm,mm,mm,in,mm,mm");
    // 25.4 mm at 1 um/mm is 25.4 um long; x_comp = 1 in / 1.001.
    assert_eq!(lines[2], "1,0,0,0.025400000,0.000000000,0.000000000,0.999000999,0.000000000,0.000000000");
}

#[test]
fn the_tool_of_a_lathe_whose_part_moves_is_sent_the_other_way() {
    let text = "calibration: 1\nmachine: excello-921\nconstants: {X1: 0 mm, Z1: 0 mm, X2: 0 mm, Xt: 0 mm, Zt: 0 mm}\nerrors:\n  EZZ: [{constant: {value: 10 um}}]\n";
    let calibration = file("lathe", "lathe.yaml", text);
    let run = abbe(&["compensate", &calibration], "x,z\n0,100\n");
    // The spindle rides 10 um too far towards +Z, so the tool stands 10 um too far towards -Z of the part;
    // the slide is sent 10 um less far.
    assert_eq!(column(&run.out, "error_z"), [-0.01]);
    assert_eq!(column(&run.out, "z_comp"), [99.99]);
}

#[test]
fn temperatures_come_from_columns_and_a_missing_one_is_named() {
    let text = BACKLASH.replace(
        "backlash: {lost_motion: 10 um}",
        "expansion: {sensor: scale, coefficient: 10 um/m/K, reference: 20 degC}",
    );
    let calibration = file("sensor", "hot.yaml", &text);
    let run = abbe(&["compensate", &calibration], "x,y,z,T_scale\n500,0,0,22\n");
    assert_eq!(column(&run.out, "error_x"), [0.01]);
    let fahrenheit =
        abbe(&["compensate", &calibration], "x,y,z,T_scale\n#unit,mm,mm,mm,degF\n500,0,0,71.6\n");
    assert!(fahrenheit.out.contains(",0.010000000,"), "{}", fahrenheit.out);
    let missing = abbe(&["compensate", &calibration], "x,y,z\n500,0,0\n");
    assert_eq!((missing.status, missing.out.as_str()), (2, ""));
    assert!(missing.err.contains("`T_scale`"), "{}", missing.err);
}

#[test]
fn a_lag_reads_the_time() {
    let text = BACKLASH.replace("backlash: {lost_motion: 10 um}", "lag: {gain: 20 1/s}");
    let calibration = file("lag", "lag.yaml", &text);
    // Without it, rows are points at which the machine stands.
    let untimed = abbe(&["compensate", &calibration], "x,y,z\n0,0,0\n1,0,0\n");
    assert_eq!((untimed.status, column(&untimed.out, "x_comp")), (0, vec![0.0, 1.0]));
    assert!(untimed.err.contains("static positions: the term `lag`"), "{}", untimed.err);
    let run = abbe(&["compensate", &calibration], "t,x,y,z\n0,0,0,0\n0.1,1,0,0\n");
    // 10 mm/s at 20 1/s lags 0.5 mm.
    assert_eq!(column(&run.out, "error_x"), [0.0, -0.5]);
}

#[test]
fn travels_are_positions_unless_given() {
    let names = ["T39", "T35", "T12", "T30", "T27", "T19", "T0", "T31", "T10", "T21"];
    let header: String = names.iter().map(|name| format!(",T_{name}")).collect();
    let values = ",22".repeat(names.len());
    let calibration = "calibrations/nist-turning-center.yaml";
    let by_default = abbe(&["compensate", calibration], &format!("x,z{header}\n-100,50{values}\n"));
    assert_eq!(by_default.status, 0, "{}", by_default.err);
    let given = abbe(
        &["compensate", calibration],
        &format!("x,z,dx,dz{header}\n-100,50,-100,50{values}\n-100,50,0,0{values}\n"),
    );
    assert_eq!(given.status, 0, "{}", given.err);
    let (default, both) = (column(&by_default.out, "error_z"), column(&given.out, "error_z"));
    assert!((default[0] - both[0]).abs() < 1e-9);
    // ao = -1.35437*22 + 10.312 arcsec over 100 mm.
    let ao = (-1.354_37 * 22.0 + 10.312_f64) / 3600.0;
    assert!((both[0] - both[1] - ao.to_radians() * -100.0).abs() < 1e-8, "{both:?}");
}

#[test]
fn what_no_controller_can_compensate_is_refused_by_name() {
    let text = BACKLASH.replace(
        "{backlash: {lost_motion: 10 um}}",
        "{backlash: {lost_motion: 10 um}}, {vibration: {frequency: 60 Hz, amplitude: 1 um, phase: 0 rad}}",
    );
    let calibration = file("uncompensable", "shaking.yaml", &text);
    let refused = abbe(&["compensate", &calibration], "x,y,z\n0,0,0\n");
    assert_eq!((refused.status, refused.out.as_str()), (2, ""));
    assert!(refused.err.contains("error[E0425]") && refused.err.contains("`vibration`"), "{}", refused.err);
    let run = abbe(&["compensate", "--leave-out-uncompensable", &calibration], "x,y,z\n0,0,0\n");
    assert_eq!(column(&run.out, "error_x"), [-0.005]);
    assert!(run.err.contains("vibration"), "{}", run.err);
}

#[test]
fn a_correction_over_the_limit_is_refused() {
    let calibration =
        file("limit", "limit.yaml", &BACKLASH.replace("errors:", "limits: {compensation: 4 um}\nerrors:"));
    let run = abbe(&["compensate", &calibration], "x,y,z\n0,0,0\n");
    assert_eq!(run.status, 1);
    assert_eq!(run.out.lines().count(), 1, "{}", run.out);
    assert!(run.err.contains("limit"), "{}", run.err);
}

#[test]
fn a_bad_row_stops_the_stream_unless_it_may_be_skipped() {
    let calibration = file("rows", "backlash.yaml", BACKLASH);
    let rows = "x,y,z\n1,0,0\n1,5,0,0\n1,zero,0\n3,0,0\n";
    let stopped = abbe(&["compensate", &calibration], rows);
    assert_eq!(stopped.status, 1);
    assert_eq!(stopped.out.lines().count(), 2, "complete rows only: {}", stopped.out);
    assert!(stopped.err.contains("row 2") && stopped.err.contains("decimal comma"), "{}", stopped.err);
    let skipped = abbe(&["compensate", "--skip-bad", &calibration], rows);
    assert_eq!((skipped.status, skipped.out.lines().count()), (0, 3));
    assert!(skipped.err.contains("2 bad rows were left out"), "{}", skipped.err);
    let nothing = abbe(&["compensate", "--skip-bad", &calibration], "x,y,z\nx,y,z\n");
    assert_eq!(nothing.status, 1);
}

/// Semicolons and tabs are read and written; the numbers are those behind commas.
#[test]
fn cells_are_separated_as_the_header_has_them() {
    let calibration = file("separated", "backlash.yaml", BACKLASH);
    let commas = abbe(&["compensate", &calibration], "x,y,z\n1,0,0\n0.5,0,0\n");
    assert_eq!(column(&commas.out, "error_x"), [-0.005, 0.005]);
    for separator in [";", "\t"] {
        let rows = "x,y,z\n1,0,0\n0.5,0,0\n".replace(',', separator);
        let run = abbe(&["compensate", &calibration], &rows);
        assert_eq!((run.status, run.out), (0, commas.out.replace(',', separator)), "{}", run.err);
    }
}

/// A unit behind a name is that of its column, in and out.
#[test]
fn units_may_stand_behind_the_names() {
    let calibration = file("behind", "backlash.yaml", BACKLASH);
    let run = abbe(&["compensate", &calibration], "x [in],y (mm),z\n1,0,0\n");
    assert_eq!(run.status, 0, "{}", run.err);
    assert!(run.out.starts_with("x [in],y (mm),z,error_x,"), "{}", run.out);
    // 25.4 mm and half of the lost motion, in inches.
    assert!((column(&run.out, "x_comp")[0] - 25.405 / 25.4).abs() < 1e-9, "{}", run.out);
    let two = abbe(&["compensate", &calibration], "x [in],y,z\n#unit,mm,mm,mm\n1,0,0\n");
    assert!(
        two.status == 2 && two.err.contains("column `x` has two units, `in` in its name and `mm`"),
        "{}",
        two.err
    );
    let none = abbe(&["compensate", &calibration], "x [left],y,z\n1,0,0\n");
    assert!(none.status == 2 && none.err.contains("`left` of column `x` is not a unit"), "{}", none.err);
}

#[test]
fn what_is_no_table_of_text_is_told() {
    let calibration = file("no-text", "backlash.yaml", BACKLASH);
    let workbook = abbe(&["compensate", &calibration], "PK\u{3}\u{4}\u{14}\0");
    assert!(
        workbook.status == 1 && workbook.err.contains("workbook") && workbook.err.contains("CSV"),
        "{}",
        workbook.err
    );
}

/// Rows beyond a table are counted, with the farthest; what is a rounding beyond its end is not.
#[test]
fn rows_beyond_the_tables_are_counted() {
    let table = BACKLASH.replace(
        "backlash: {lost_motion: 10 um}",
        "table: {axis: X, start: 0 mm, step: 250 mm, unit: um, values: [0, 5, 8]}",
    );
    let calibration = file("beyond", "table.yaml", &table);
    let inside = abbe(&["compensate", &calibration], "x,y,z\n0,0,0\n500.0001,0,900\n");
    assert_eq!((inside.status, inside.err.as_str()), (0, ""));
    let beyond = abbe(&["compensate", &calibration], "x,y,z\n-20,0,0\n100,0,0\n5000,0,0\n700,0,0\n");
    let told = "3 rows are outside the measured range of X, 0 to 500 mm, as far as 5000 mm";
    assert!(beyond.status == 0 && beyond.err.contains(told), "{}", beyond.err);
    assert_eq!(column(&beyond.out, "error_x"), [0.0, 0.002, 0.008, 0.008]);
}

/// Some thousand rows are answered while the next ones are read, and what terms remember goes on from one of these batches to the next.
/// X goes up by 10 mm and back; from the reversal on, the wind-up of 10 mm takes up the play in proportion to the way.
#[test]
fn rows_remember_across_all_that_is_read_ahead() {
    let wound = BACKLASH.replace("lost_motion: 10 um", "lost_motion: 10 um, wind_up: 10 mm");
    let calibration = file("ahead", "wound.yaml", &wound);
    let (top, rows) = (10_000_i32, 20_000_i32);
    let place = |row: i32| f64::from(top - (top - row).abs()) / 1000.0;
    let header = "x,y,z\n".to_owned();
    let table: Vec<String> = (0..=rows).map(|row| format!("{:.3},0,0\n", place(row))).collect();
    let run = abbe(&["compensate", &calibration], &(header.clone() + &table.concat()));
    assert_eq!(run.status, 0, "{}", run.err);
    let errors = column(&run.out, "error_x");
    assert_eq!(errors.len(), table.len());
    for (row, error) in (0..=rows).zip(errors) {
        let back = if row > top { place(top) - place(row) } else { 0.0 };
        let taken_up = 1.0 - 2.0 * back / 10.0;
        assert!((error + 0.005 * taken_up).abs() < 1e-8, "row {row}: {error}");
    }
    // A bad row ends it where it stands, however much was read beyond it.
    let mut broken = table;
    broken[12_345] = "1,zero,0\n".to_owned();
    let rows = header + &broken.concat();
    let stopped = abbe(&["compensate", &calibration], &rows);
    assert_eq!((stopped.status, stopped.out.lines().count()), (1, 1 + 12_345));
    assert!(stopped.err.contains("row 12346 under the header"), "{}", stopped.err);
    let skipped = abbe(&["compensate", "--skip-bad", &calibration], &rows);
    assert_eq!((skipped.status, skipped.out.lines().count()), (0, 1 + 20_000));
}

#[test]
fn mistakes_in_the_header_are_all_told() {
    let calibration = file("header", "backlash.yaml", BACKLASH);
    let run = abbe(&["compensate", &calibration], "x,Y,x,dir_q\n1,0,0,1\n");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    for piece in ["column `x` occurs twice", "no column `y`", "no column `z`"] {
        assert!(run.err.contains(piece), "{piece}: {}", run.err);
    }
    let units = abbe(&["compensate", &calibration], "x,y,z\n#unit,mm,deg,mm\n1,0,0\n");
    assert!(units.status == 2 && units.err.contains("`deg`"), "{}", units.err);
    let empty = abbe(&["compensate", &calibration], "");
    assert_eq!(empty.status, 1);
}

#[test]
fn mistakes_in_a_calibration_are_located() {
    let path = file("located", "wrong.yaml", &BACKLASH.replace("10 um", "10 arcsec").replace("EXX", "EXQ"));
    let run = abbe(&["compensate", &path], "x,y,z\n0,0,0\n");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert!(run.err.contains("wrong.yaml:5:3"), "{}", run.err);
    let nameless = file("located", "nameless.yaml", &BACKLASH.replace("machine: FXYZ", "machine: fxyz-mil"));
    let run = abbe(&["compensate", &nameless], "x,y,z\n0,0,0\n");
    assert!(
        run.status == 2 && run.err.contains("nameless.yaml:2:10") && run.err.contains("fxyz-mill"),
        "{}",
        run.err
    );
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let mut child = start(&["derive", "trunnion-5axis", "--format", "html"]);
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[test]
fn the_shipped_list_is_the_folder() {
    let listed = fs::read_to_string(root().join("workshop/src/shipped.rs")).unwrap();
    for entry in fs::read_dir(root().join("machines")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(listed.contains(&format!("/machines/{name}\"")), "machines/{name} is not shipped");
    }
}

#[test]
fn the_tip_of_a_single_stage_is_its_carriage() {
    let text = "calibration: 1\nmachine: FX\nerrors:\n  EXX: 3 um\n  EBX: 10 urad\n";
    let run = abbe(&["compensate", &file("stage", "stage.yaml", text)], "x\n100\n");
    assert_eq!(column(&run.out, "error_x"), [0.003], "{}", run.err);
    let lifted = text.replace("errors:", "constants: {Zt: 50 mm}\nerrors:");
    let run = abbe(&["compensate", &file("stage", "lifted.yaml", &lifted)], "x\n100\n");
    assert_eq!(column(&run.out, "error_x"), [0.0035], "{}", run.err);
}

#[test]
fn bytes_that_nobody_reads_come_through_as_they_are() {
    let calibration = file("bytes", "backlash.yaml", BACKLASH);
    let mut child = start(&["compensate", &calibration]);
    child.stdin.take().unwrap().write_all(b"x,y,z,note\n1,0,0,gr\xf6\xdfe\n").unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    assert!(output.stdout.windows(6).any(|bytes| bytes == b"gr\xf6\xdfe,"));
}

#[test]
fn every_answer_comes_before_the_next_question() {
    use std::io::{BufRead, BufReader};
    let calibration = file("live", "backlash.yaml", BACKLASH);
    let mut child = start(&["compensate", &calibration]);
    let mut questions = child.stdin.take().unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap()).lines();
    questions.write_all(b"x,y,z\n1,0,0\n").unwrap();
    assert!(answers.next().unwrap().unwrap().starts_with("x,y,z,error_x"));
    // The test would wait here for ever if the answer waited for the next row.
    assert!(answers.next().unwrap().unwrap().starts_with("1,0,0,-0.005"));
    questions.write_all(b"2,0,0\n").unwrap();
    assert!(answers.next().unwrap().unwrap().starts_with("2,0,0,-0.005"));
    drop(questions);
    assert!(answers.next().is_none());
    assert!(child.wait().unwrap().success());
}

#[test]
fn the_output_is_no_input_under_the_same_names() {
    let calibration = file("again", "backlash.yaml", BACKLASH);
    let once = abbe(&["compensate", &calibration], "x,y,z\n1,0,0\n");
    let twice = abbe(&["compensate", &calibration], &once.out);
    assert_eq!((twice.status, twice.out.as_str()), (2, ""));
    assert!(twice.err.contains("`error_x`") && twice.err.contains("`x_comp`"), "{}", twice.err);
}

/// The published way of a reversal: the correction is spread over time, what is told of the machine is not.
#[test]
fn a_ramp_spreads_the_correction_of_a_reversal() {
    let text = BACKLASH.replace("lost_motion: 10 um", "lost_motion: 10 um, ramp: 100 ms");
    let ramped = file("ramped", "ramp.yaml", &text);
    let run = abbe(&["compensate", &ramped], "x,y,z\n1,0,0\n");
    assert!(run.status == 2 && run.err.contains("a `ramp` of the calibration needs"), "{}", run.err);
    let rows = "t,x,y,z\n0,1,0,0\n0.02,2,0,0\n0.04,1,0,0\n0.07,1,0,0\n0.2,1,0,0\n";
    let out = abbe(&["compensate", &ramped], rows).out;
    let (error, command) = (column(&out, "error_x"), column(&out, "x_comp"));
    let expected = [(-0.005, 1.005), (-0.005, 2.005), (0.005, 1.003), (0.005, 1.0), (0.005, 0.995)];
    assert_eq!(error.len(), expected.len(), "{out}");
    for ((error, command), expected) in error.iter().zip(&command).zip(expected) {
        assert!((error - expected.0).abs() < 1e-9 && (command - expected.1).abs() < 1e-9, "{out}");
    }
}

#[test]
fn an_axis_cannot_move_in_no_time_where_its_speed_matters() {
    let text = BACKLASH.replace("backlash: {lost_motion: 10 um}", "lag: {gain: 20 1/s}");
    let lagging = file("still", "lag.yaml", &text);
    let run = abbe(&["compensate", &lagging], "t,x,y,z\n0,0,0,0\n0,1,0,0\n");
    assert!(run.status == 1 && run.err.contains("the time does not advance"), "{}", run.err);
    let indifferent = file("still", "backlash.yaml", BACKLASH);
    assert_eq!(abbe(&["compensate", &indifferent], "t,x,y,z\n0,0,0,0\n0,1,0,0\n").status, 0);
}

#[test]
fn check_reads_what_derive_prints() {
    for machine in ["excello-921", "head-table-5axis"] {
        let derived = abbe(&["derive", machine], "").out;
        let rows = derived
            .lines()
            .skip_while(|line| !line.starts_with("let ") && !line.starts_with("Px"))
            .take_while(|line| *line != "Error motions");
        let printed = file("derived", machine, &rows.collect::<Vec<_>>().join("\n"));
        let run = abbe(&["check", machine, &printed], "");
        assert_eq!(run.status, 0, "{}{}", run.out, run.err);
        let nominal = fs::read_to_string(&printed).unwrap().replacen("+ dPx", "- dPx", 1);
        let wrong = file("derived", "wrong.eqs", &nominal);
        assert_eq!(abbe(&["check", machine, &wrong], "").status, 1);
    }
}

#[test]
fn a_file_of_the_other_kind_is_told_apart() {
    let run = abbe(&["derive", "calibrations/postech-mill.yaml"], "");
    assert!(run.status == 2 && run.err.contains("this is a calibration file"), "{}", run.err);
    assert_eq!(run.err.matches("error").count(), 1, "{}", run.err);
    let run = abbe(&["compensate", "machines/postech-mill.yaml"], "");
    assert!(run.status == 2 && run.err.contains("this is a machine file"), "{}", run.err);
}

#[test]
fn new_files_are_taken_by_the_commands_that_read_them() {
    let folder = std::env::temp_dir().join(format!("abbe-new-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let at = |name: &str| folder.join(name).display().to_string();
    fs::write(folder.join("data.csv"), "t_s,run,x_cmd,y_cmd,dev_um\n0,1,0,0,0.5\n1,1,1,0,0.2\n2,1,2,0,0.1\n")
        .unwrap();
    for arguments in [
        &["new", "machine", "XYFZ", "--output", &at("mill.yaml")][..],
        &["new", "calibration", &at("mill.yaml"), "--output", &at("known.yaml")],
        &["new", "path", &at("mill.yaml"), "--output", &at("path.yaml")],
        &["new", "recording", &at("data.csv"), "--machine", "XYFZ", "--output", &at("recording.yaml")],
        &["new", "setup", &at("data.csv"), "--output", &at("setup.yaml")],
        &["simulate", &at("known.yaml"), &at("path.yaml"), "--output", &at("simulated")],
        &["diagnose", &at("simulated/recording.yaml")],
        &["diagnose", &at("recording.yaml")],
    ] {
        let run = abbe(arguments, "");
        assert_eq!(run.status, 0, "{arguments:?}: {}", run.err);
    }
    let setup = fs::read_to_string(folder.join("setup.yaml")).unwrap();
    assert!(setup.contains("measurements:\n  - {motion: E??, data: data.csv,"), "{setup}");
    // A file in another folder is named from there.
    fs::create_dir_all(folder.join("made/here")).unwrap();
    for arguments in [
        &["new", "calibration", &at("mill.yaml"), "--output", &at("made/known.yaml")][..],
        &[
            "new",
            "recording",
            &at("data.csv"),
            "--machine",
            &at("mill.yaml"),
            "--output",
            &at("made/here/r.yaml"),
        ],
        &["new", "setup", &at("data.csv"), "--output", &at("made/setup.yaml")],
        &["simulate", &at("made/known.yaml"), &at("path.yaml"), "--output", &at("simulated-too")],
        &["diagnose", &at("made/here/r.yaml")],
    ] {
        let run = abbe(arguments, "");
        assert_eq!(run.status, 0, "{arguments:?}: {}", run.err);
    }
    assert!(fs::read_to_string(folder.join("made/setup.yaml")).unwrap().contains("data: ../data.csv,"));
    let again = abbe(&["new", "XYFZ", "--output", &at("mill.yaml")], "");
    assert!(again.status == 2 && again.err.contains("already exists"), "{}", again.err);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_table_alone_is_answered_with_a_recording_file_for_its_columns() {
    let table = file("alone", "data.csv", "t_s,x_cmd,laser_x_um\n0,0,0\n");
    for command in ["diagnose", "evaluate", "limits"] {
        let run = abbe(&[command, &table], "");
        assert_eq!(run.status, 2, "{command}: {}", run.err);
        assert!(
            run.err.contains("is a table") && run.err.contains("measured.x: {column: laser_x_um, unit: um}"),
            "{}",
            run.err
        );
    }
}

/// Commands that print a result, each with files that it reads.
const PRINTERS: [&[&str]; 6] = [
    &["derive", "xyfz-mill", "--format", "json"],
    &["check", "excello-921", "published/excello-921.eqs"],
    &["expand", "FX"],
    &["explain", "backlash"],
    &["evaluate", "recordings/postech-ballbar/recording.yaml"],
    &["new", "XYFZ"],
];

#[test]
fn a_result_goes_to_a_file_as_it_is_printed() {
    let place = file("results", "there.txt", "mine\n");
    let new = place.replace("there.txt", "new.txt");
    for arguments in PRINTERS {
        let printed = abbe(arguments, "");
        let _ = fs::remove_file(&new);
        let written = abbe(&[arguments, &["--output", &new]].concat(), "");
        assert_eq!(
            (written.status, written.out.as_str()),
            (printed.status, ""),
            "{arguments:?}: {}",
            written.err
        );
        assert_eq!(fs::read_to_string(&new).unwrap(), printed.out, "{arguments:?}");
        let refused = abbe(&[arguments, &["--output", &place]].concat(), "");
        assert_eq!((refused.status, refused.out.as_str()), (2, ""), "{arguments:?}");
        assert!(
            refused.err.contains("there.txt already exists") && refused.err.contains("--force"),
            "{}",
            refused.err
        );
        assert_eq!(fs::read_to_string(&place).unwrap(), "mine\n", "{arguments:?}");
        abbe(&[arguments, &["--output", &place, "--force"]].concat(), "");
        assert_eq!(fs::read_to_string(&place).unwrap(), printed.out, "{arguments:?}");
        fs::write(&place, "mine\n").unwrap();
    }
    assert_eq!(abbe(&["derive", "FX", "--force"], "").status, 2, "--force is for --output");
    let nowhere = abbe(&["derive", "FX", "--output", "no/such/folder.txt"], "");
    assert!(nowhere.status == 2 && nowhere.err.contains("its folder does not exist"), "{}", nowhere.err);
}

#[test]
fn a_result_goes_over_no_file_that_was_read() {
    let machine = file("results-over", "mill.yaml", &abbe(&["new", "XYFZ"], "").out);
    let before = fs::read_to_string(&machine).unwrap();
    for command in ["derive", "expand"] {
        let run = abbe(&[command, &machine, "--output", &machine, "--force"], "");
        assert!(
            run.status == 2 && run.err.contains("is one of the files that this command reads or writes"),
            "{}",
            run.err
        );
    }
    assert_eq!(fs::read_to_string(&machine).unwrap(), before);
}

#[test]
fn new_recordings_of_other_formats_have_the_names_that_these_say() {
    let written = root().join("recording/tests/recording/written");
    for (file, column) in [("polars-zstd.parquet", "column: "), ("openpyxl.xlsx", "column: ")] {
        let path = written.join(file).display().to_string();
        let run = abbe(&["new", "recording", &path], "");
        assert!(run.status == 0 && run.out.contains(column) && run.out.is_ascii(), "{}{}", run.out, run.err);
    }
    let run = abbe(&["new", "recording", &written.join("h5py.h5").display().to_string()], "");
    assert!(run.status == 2 && run.out.is_empty() && run.err.contains("HDF5"), "{}", run.err);
}

/// A table as a European program writes it, one in UTF-16, and one whose names have spaces in them.
#[test]
fn new_recordings_are_of_any_text_or_say_why_not() {
    let european = file(
        "european",
        "d.csv",
        "Time [s];Run;X [mm];Deviation [um]\n0;1;0,0;-3,61\n1;1;10,0;-3,40\n2;1;20,0;-3,22\n",
    );
    let run = abbe(&["new", "recording", &european], "");
    assert!(run.out.contains(", decimal: \",\"}\n"), "{}{}", run.out, run.err);
    for line in [
        "instrument: linear ",
        "  time: {column: 'Time [s]', unit: s}\n",
        "  command.x: {column: 'X [mm]', unit: mm}\n",
        "  deviation: {column: 'Deviation [um]', unit: um}\n",
    ] {
        assert!(run.out.contains(line), "{}", run.out);
    }
    let words: Vec<u8> = "t,x\n0,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let sixteen = file("sixteen", "d.csv", "");
    fs::write(&sixteen, [&[0xff, 0xfe], words.as_slice()].concat()).unwrap();
    let spaced = file("spaced", "d.txt", "t x cmd\n0 1.5\n");
    for (table, told) in
        [(sixteen, "text in UTF-16"), (spaced, "3 words above 2 numbers, separated by spaces")]
    {
        let run = abbe(&["new", "recording", &table], "");
        assert!(run.status != 0 && run.out.is_empty() && run.err.contains(told), "{}{}", run.out, run.err);
    }
}

#[test]
fn new_set_ups_are_of_files_that_are_there_each_with_its_motion() {
    let table = file("new-setup", "p.csv", "target,deviation\n0,1\n");
    let run = abbe(&["new", "setup", &table, &table.replace("p.csv", "pp.csv")], "");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert!(
        run.err.contains("cannot read") && run.err.contains(&format!("did you mean `{table}`?")),
        "{}",
        run.err
    );
    // What a file does not say is left to be filled in; the order of the files says nothing.
    let unknown = abbe(&["new", "setup", &table, &table], "").out;
    assert_eq!(unknown.matches("{motion: E??, data: ").count(), 2, "{unknown}");
    assert!(unknown.contains("# put in the error motion that the file shows"), "{unknown}");
    assert!(
        unknown.starts_with("# A set-up file for Abbe") && unknown.contains("# a machine file"),
        "{unknown}"
    );
    let named = file("new-setup", "x-eyx.csv", "target,deviation\n0,1\n");
    let several = file("new-setup", "multi.csv", "x,EXX [um],EBX [arcsec]\n#unit,mm,um,arcsec\n0,1,2\n");
    let told = abbe(&["new", "setup", &named, &several], "");
    let motions: Vec<&str> = told
        .out
        .lines()
        .filter_map(|line| line.trim().strip_prefix("- {motion: ")?.split(',').next())
        .collect();
    assert_eq!(motions, ["EYX", "EXX", "EBX"], "{}{}", told.out, told.err);
}

#[test]
fn new_set_ups_are_of_no_folder_and_of_nothing_that_is_no_table() {
    let empty = file("no-setup", "empty.csv", "\n");
    let words = file("no-setup", "words.csv", "nothing but words\n");
    let folder = PathBuf::from(&empty).parent().unwrap().to_str().unwrap().to_owned();
    let book = root().join("recording/tests/recording/written/openpyxl.xlsx").display().to_string();
    for (path, told, help) in [
        (folder, "is a folder", "give the files in it"),
        (empty, "is empty", "give the file that the instrument wrote"),
        (words, "has no row of column names", "write the names above"),
        (book, "is a workbook", "save the table as CSV"),
    ] {
        let run = abbe(&["new", "setup", &path], "");
        assert!(run.status != 0 && run.out.is_empty(), "{path}: {}", run.out);
        assert!(run.err.contains(&format!("{path} {told}")) && run.err.contains(help), "{}", run.err);
    }
}

#[test]
fn new_recordings_say_what_the_table_says_of_units_and_times() {
    let inches = file("said", "d.csv", "t,run,x,dev\n#unit,s,,mm,in\n0,1,0,0.1\n");
    let run = abbe(&["new", "recording", &inches], "");
    assert!(run.out.contains("  deviation: {column: dev, unit: in}\n"), "{}{}", run.out, run.err);
    let quoted = file("said", "q.csv", "t,\"x, cmd\",m\n0,1,2\n");
    let run = abbe(&["new", "recording", &quoted], "");
    assert!(run.out.contains("  command.x: {column: 'x, cmd', unit: mm}\n"), "{}{}", run.out, run.err);
    let book = root().join("recording/tests/recording/written/openpyxl-clock.xlsx").display().to_string();
    let run = abbe(&["new", "recording", &book], "");
    assert!(run.out.contains("unit: date}\n") && run.out.contains("unit: um}\n"), "{}{}", run.out, run.err);
    let empty = file("said", "empty.csv", "");
    let run = abbe(&["new", "recording", &empty], "");
    assert!(run.status != 0 && run.err.contains("empty.csv is empty"), "{}", run.err);
}

#[test]
fn no_result_is_written_over_what_it_was_read_from() {
    let folder = std::env::temp_dir().join(format!("abbe-over-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let at = |name: &str| folder.join(name).display().to_string();
    fs::write(folder.join("x.csv"), "target,deviation\n0,0\n100,1\n200,3\n").unwrap();
    let setup = "setup: 1\nmachine: FX\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nmeasurements:\n  - {motion: EXX, data: x.csv, \
                 targets: {unit: mm, origin: 0 mm, sign: +1}, deviations: {unit: um, sign: +1}}\n";
    fs::write(folder.join("setup.yaml"), setup).unwrap();
    let before = fs::read_to_string(folder.join("x.csv")).unwrap();
    // By its name, and by a link that leads to it.
    #[cfg(unix)]
    std::os::unix::fs::symlink(folder.join("x.csv"), folder.join("link.txt")).unwrap();
    for target in ["x.csv", "link.txt"] {
        let run = abbe(&["evaluate", &at("setup.yaml"), "--output", &at(target), "--force"], "");
        assert!(
            run.status == 2 && run.err.contains("one of the files that this command reads or writes"),
            "{}",
            run.err
        );
        assert_eq!(fs::read_to_string(folder.join("x.csv")).unwrap(), before);
    }
    fs::remove_dir_all(folder).unwrap();
}
