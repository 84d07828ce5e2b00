//! The sets of equations that come with programs: what agrees, and who is right where it does not. In: `machines/` and
//! `published/`. Out: the verdicts, held against exact rotations and against the other half of the source.

use super::{Verdict, contradictions, file, machine, report};
use crate::Compiled;
use crate::algebra::{Polynomial, Symbol};

/// The published file of the machine of its name.
fn text(name: &str) -> String {
    file(&format!("published/{name}.eqs")).text().to_owned()
}

fn named(left: &str, motion: &str, verdict: Verdict) -> (String, String, Verdict) {
    (left.to_owned(), motion.to_owned(), verdict)
}

/// The derived lever of a motion in X, Y and Z, at a place of axes and constants.
fn levers(compiled: &Compiled, motion: &str, at: &dyn Fn(&str) -> f64) -> [f64; 3] {
    let value = |row: &crate::equations::Row| -> f64 {
        let terms = row.terms.iter().filter(|term| compiled.equations.motions[term.motion].name == motion);
        terms.map(|term| number(&term.arm, at)).sum()
    };
    let found: Vec<f64> = compiled.equations.rows.iter().map(value).collect();
    found.try_into().expect("three directions")
}

/// The value of a polynomial; sines and cosines are those of the positions.
fn number(value: &Polynomial, at: &dyn Fn(&str) -> f64) -> f64 {
    value.evaluate(|symbol| match symbol {
        Symbol::Sin(name) => at(name).sin(),
        Symbol::Cos(name) => at(name).cos(),
        other => at(other.name()),
    })
}

#[test]
fn linuxcnc_s_trunnions_agree_in_full() {
    for name in ["linuxcnc-xyzac-trt", "linuxcnc-xyzbc-trt"] {
        let report = report(&machine(name), &text(name));
        assert!(report.agrees(), "{name}: {}", report.text());
        assert_eq!((report.equations.len(), report.count(Verdict::Agrees)), (6, 13), "{name}");
    }
}

/// The inverse functions of the same source, as they are printed, take the derived position back to the joints.
#[test]
fn the_printed_inverse_undoes_the_derived_position() {
    let joints = [37.0, -52.0, 81.0];
    let (tilt, turn) = (0.7_f64, -1.9_f64);
    let at = |name: &str| match name {
        "x" => joints[0],
        "y" => joints[1],
        "z" => joints[2],
        "a" | "b" => tilt,
        "c" => turn,
        "Xr" => 200.0,
        "Yr" => 150.0,
        "Zr" => -300.0,
        "Xo" | "Yo" => 12.0,
        "Zo" => -40.0,
        "Lt" => 120.0,
        name => panic!("{name} has no value"),
    };
    let ((st, ct), (sc, cc)) = (tilt.sin_cos(), turn.sin_cos());
    let (across, dz) = (12.0, -40.0 + 120.0);
    for name in ["linuxcnc-xyzac-trt", "linuxcnc-xyzbc-trt"] {
        let compiled = machine(name);
        let [x, y, z] = [0, 1, 2].map(|row| number(&compiled.equations.rows[row].nominal, &at));
        let (x, y, z) = (x - 200.0, y - 150.0, z + 300.0);
        let back = if name == "linuxcnc-xyzac-trt" {
            [
                cc * x - sc * y + 200.0,
                sc * ct * x + cc * ct * y - st * z - ct * across + st * dz + across + 150.0,
                sc * st * x + cc * st * y + ct * z - st * across - ct * dz + dz - 300.0,
            ]
        } else {
            let dpx = -ct * across - st * dz + across;
            let dpz = st * across - ct * dz + dz;
            [
                cc * ct * x - sc * ct * y + st * z + dpx + 200.0,
                sc * x + cc * y + 150.0,
                -cc * st * x + sc * st * y + ct * z + dpz - 300.0,
            ]
        };
        for (found, joint) in back.iter().zip(joints) {
            assert!((found - joint).abs() < 1e-9, "{name}: {found} {joint}");
        }
    }
}

/// Every error motion agrees in both programs; the squarenesses shear the stylus in one, and stand nowhere in the other.
#[test]
fn the_measuring_machines_agree_but_for_their_squarenesses() {
    let table = report(&machine("msl-moving-table"), &text("msl-moving-table"));
    let expected = [
        named("Ex", "EC0Y", Verdict::OtherLever),
        named("Ex", "EB0Z", Verdict::OtherLever),
        named("Ey", "EC0Y", Verdict::Extra),
        named("Ey", "EA0Z", Verdict::OtherLever),
        named("Ez", "EA0Z", Verdict::Extra),
        named("Ez", "EB0Z", Verdict::Extra),
        named("Ex", "EC0Y", Verdict::Missing),
        named("Ex", "EB0Z", Verdict::Missing),
        named("Ey", "EA0Z", Verdict::Missing),
    ];
    assert_eq!(contradictions(&table), expected, "{}", table.text());
    assert_eq!(table.count(Verdict::Agrees), 2 * 27 + 9);
    let bridge = report(&machine("msl-moving-bridge"), &text("msl-moving-bridge"));
    assert_eq!(contradictions(&bridge), expected[6..], "{}", bridge.text());
    assert_eq!(bridge.count(Verdict::Agrees), 27);
}

/// A machine whose Y leans by the angle `lean` about Z, exactly: Y moves along its own line, and the stylus is a rigid body that
/// no guide turns. The printed shear of the stylus is not in it.
#[test]
fn a_line_that_leans_does_not_move_the_stylus() {
    let (lean, y, stylus) = (1e-5_f64, 300.0, [0.0, 60.0, -120.0]);
    let tip = |lean: f64| [-y * lean.sin() + stylus[0], y * lean.cos() + stylus[1], stylus[2]];
    let error: Vec<f64> = tip(lean).iter().zip(tip(0.0)).map(|(is, wanted)| is - wanted).collect();
    let at = |name: &str| match name {
        "y" => y,
        "Yt" => stylus[1],
        name => panic!("{name} has no value"),
    };
    let derived = levers(&machine("msl-moving-table"), "EC0Y", &at).map(|lever| lever * lean);
    for (exact, derived) in error.iter().zip(derived) {
        assert!((exact - derived).abs() < 1e-7, "{exact} {derived}");
    }
    let printed = -(y + stylus[1]) * lean;
    assert!((printed - error[0]).abs() > 5e-4, "60 mm of stylus times 10 urad are 0.6 um");
}

#[test]
fn the_skew_of_printers_agrees_and_its_product_is_of_second_order() {
    let report = report(&machine("printer-skew"), &text("printer-skew"));
    assert!(report.agrees(), "{}", report.text());
    assert_eq!((report.equations.len(), report.count(Verdict::Agrees)), (6, 6));
    assert!(report.text().contains("second order   -z*EA0Z*EC0Y"), "{}", report.text());
}

#[test]
fn the_grinder_s_turned_bracket_and_short_lever_are_named() {
    let compiled = machine("cai-wafer-grinder");
    let found = report(&compiled, &text("cai-wafer-grinder"));
    let expected = [
        named("Ex", "ECX", Verdict::OtherLever),
        named("Ey", "ECX", Verdict::OtherLever),
        named("Ey", "EXX", Verdict::OppositeSign),
        named("Ey", "EXZ", Verdict::OppositeSign),
    ];
    assert_eq!(contradictions(&found), expected, "{}", found.text());
    let mended = text("cai-wafer-grinder")
        .replace("-sin(c)*(dxx - dxz)", "-sin(c)*(dxz - dxx)")
        .replace("(ezz - ezx)*(Yt*cos(c) - Xt*sin(c))", "(ezz - ezx)*(Yt*cos(c) - Xt*sin(c)) + x*sin(c)*ezx")
        .replace("(ezz - ezx)*(Xt*cos(c) + Yt*sin(c))", "(ezz - ezx)*(Xt*cos(c) + Yt*sin(c)) + x*cos(c)*ezx");
    assert!(report(&compiled, &mended).agrees());
}

/// The chain of equation (2) with exact rotations about Z: the wafer stands at x, and the slide under it is turned by `yaw`.
#[test]
fn the_exact_chain_of_the_grinder_has_the_whole_lever() {
    let (x, wheel, wafer, yaw) = (100.0, [60.0, 40.0], 0.7_f64, 1e-6_f64);
    let seen = |yaw: f64| {
        let (across, along) = (wheel[0] - x, wheel[1]);
        let (sine, cosine) = (-wafer - yaw).sin_cos();
        [cosine * across - sine * along, sine * across + cosine * along]
    };
    let at = |name: &str| match name {
        "x" => x,
        "c" => wafer,
        "Xt" => wheel[0],
        "Yt" => wheel[1],
        name => panic!("{name} has no value"),
    };
    let derived = levers(&machine("cai-wafer-grinder"), "ECX", &at);
    for direction in [0, 1] {
        let exact = (seen(yaw)[direction] - seen(0.0)[direction]) / yaw;
        assert!((exact - derived[direction]).abs() < 1e-3, "{exact} {}", derived[direction]);
    }
    let short = wheel[1] * wafer.cos() - wheel[0] * wafer.sin();
    assert!((short - derived[0]).abs() > 60.0, "x sin(c) is missing: {short} {}", derived[0]);
}

/// `[name significant]` is a selection as `[significant]` is; a name with the word elsewhere is none.
#[test]
fn a_selection_may_have_a_name() {
    let lathe = machine("excello-921");
    let of = |section: &str| report(&lathe, &format!("[{section}]\ndPx = dxx\n")).agrees();
    assert!(of("significant") && of("first significant"));
    assert!(!of("first") && !of("significant first") && !of("insignificant"));
}
