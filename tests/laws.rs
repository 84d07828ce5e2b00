//! Laws of levers and signs, with numbers. In: small machines whose levers can be told by hand. Out: the facts that the page
//! of conventions states, each asserted once.

use std::collections::BTreeMap;

use abbe_runtime::Kinematics;
use model_dsl::program::Interpreter;

use crate::agreement::{compiled, every_word};
use crate::oracle::draw;
use crate::shipped::SHIPPED;

/// The lever of each motion at a point; constants and positions by name, 0 where not given.
fn levers(text: &str, values: &[(&str, f64)]) -> BTreeMap<String, [f64; 3]> {
    let equations = compiled(text);
    let value = |name: &str| values.iter().find(|(known, _)| *known == name).map_or(0.0, |(_, value)| *value);
    let constants: Vec<f64> = equations.constants.iter().map(|constant| value(&constant.name)).collect();
    let position: Vec<f64> = equations.axes.iter().map(|axis| value(&axis.variable)).collect();
    let travel: Vec<f64> = equations.travels.iter().map(|travel| value(&travel.name)).collect();
    let arms = Interpreter::new(&equations, &constants).levers(&position, &travel);
    equations.motions.iter().map(|motion| motion.name.clone()).zip(arms).collect()
}

fn word(word: &str, motions: &str) -> String {
    format!("abbe: 1\nname: word\nmotions: {motions}\ntopology: {word}\n")
}

fn stage(links: &str) -> String {
    format!("abbe: 1\nname: stage\nchain: {links}\n")
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(axis: usize) -> [f64; 3] {
    std::array::from_fn(|row| f64::from(u8::from(row == axis)))
}

/// A point of a mill, all numbers different.
const POINT: [(&str, f64); 6] =
    [("x", 110.0), ("y", 70.0), ("z", -30.0), ("Xt", 3.0), ("Yt", 5.0), ("Zt", 120.0)];

/// EB0X > 0 moves +X travel towards -Z, on whichever branch X runs.
#[test]
fn squareness_of_x_about_y() {
    let tool = "{tool: [{slide: X, along: +X, errors: [EB0X]}, {tool: tip}]}";
    let table = "{workpiece: [{slide: X, along: -X, errors: [EB0X]}], tool: [{tool: tip}]}";
    for chain in [tool, table] {
        assert_eq!(levers(&stage(chain), &[("x", 100.0)])["EB0X"], [0.0, 0.0, -100.0], "{chain}");
    }
}

/// EB0Z > 0 moves +Z travel towards +X.
#[test]
fn squareness_of_z_about_y() {
    let tool = "{tool: [{slide: Z, along: +Z, errors: [EB0Z]}, {tool: tip}]}";
    let table = "{workpiece: [{slide: Z, along: -Z, errors: [EB0Z]}], tool: [{tool: tip}]}";
    for chain in [tool, table] {
        assert_eq!(levers(&stage(chain), &[("z", 100.0)])["EB0Z"], [100.0, 0.0, 0.0], "{chain}");
    }
}

/// A lathe whose carriage holds the part and runs along +Z: the tip moves towards -Z of the part as z grows, and EB0Z of the
/// carriage moves the part towards +X, the tip towards -X of it.
#[test]
fn a_part_that_runs_with_its_axis() {
    let arms = levers(
        &stage("{workpiece: [{slide: Z, along: +Z, errors: [EZZ, EXZ, EB0Z]}], tool: [{tool: tip}]}"),
        &[("z", 100.0)],
    );
    assert_eq!(arms["EB0Z"], [-100.0, 0.0, 0.0]);
    assert_eq!(arms["EZZ"], [0.0, 0.0, -1.0]);
    assert_eq!(arms["EXZ"], [-1.0, 0.0, 0.0]);
}

/// Squarenesses of the four mills, in bodies' and in relative motions: EC0Y acts with -y in X, EB0Z with z in X, EA0Z with -z in Y.
#[test]
fn squarenesses_are_the_same_in_the_four_mills() {
    for motions in ["body", "relative"] {
        for mill in ["FXYZ", "XFYZ", "XYFZ", "XYZF"] {
            let arms = levers(&word(mill, motions), &POINT);
            assert_eq!(arms["EC0Y"], [-70.0, 0.0, 0.0], "{mill}");
            assert_eq!(arms["EB0Z"], [-30.0, 0.0, 0.0], "{mill}");
            assert_eq!(arms["EA0Z"], [0.0, 30.0, 0.0], "{mill}");
        }
    }
}

/// Positioning errors are actual minus commanded in every topology; straightnesses are the tool's relative to the part where
/// the motions are relative, and change sign with the branch where they are those of bodies.
#[test]
fn displacements_in_every_topology_of_three_slides() {
    for mill in every_word(3).iter().filter(|word| word.len() == 4 && !word.contains(['A', 'B', 'C'])) {
        let (relative, body) = (levers(&word(mill, "relative"), &POINT), levers(&word(mill, "body"), &POINT));
        for (axis, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            for (link, on_part) in
                mill.chars().filter(|link| *link != 'F').map(|link| (link, mill.find(link) < mill.find('F')))
            {
                let name = format!("E{letter}{link}");
                assert_eq!(relative[&name], unit(axis), "{name} of {mill}");
                let turned = on_part && !name.ends_with(letter);
                let sign = if turned { -1.0 } else { 1.0 };
                assert_eq!(body[&name], unit(axis).map(|part| sign * part), "{name} of {mill}");
            }
        }
    }
}

/// Angles act over the way from the carriage's origin to the tip. In a word read from part to tool, every axis behind the
/// carriage moves the tip away from that origin, and so does the carriage's own if it carries the part.
#[test]
fn angles_in_every_topology_of_three_slides() {
    for mill in every_word(3).iter().filter(|word| word.len() == 4 && !word.contains(['A', 'B', 'C'])) {
        let (relative, body) = (levers(&word(mill, "relative"), &POINT), levers(&word(mill, "body"), &POINT));
        for link in mill.chars().filter(|link| *link != 'F') {
            let on_part = mill.find(link) < mill.find('F');
            let way: [f64; 3] = std::array::from_fn(|axis| {
                let other = ['X', 'Y', 'Z'][axis];
                let moves = mill.find(other) > mill.find(link) || other == link && on_part;
                POINT[3 + axis].1 + if moves { POINT[axis].1 } else { 0.0 }
            });
            for (axis, letter) in ["A", "B", "C"].into_iter().enumerate() {
                let name = format!("E{letter}{link}");
                let expected = cross(unit(axis), way);
                assert_eq!(
                    relative[&name].map(|part| part + 0.0),
                    expected.map(|part| part + 0.0),
                    "{name} of {mill}"
                );
                let sign = if on_part { -1.0 } else { 1.0 };
                assert_eq!(
                    body[&name].map(|part| part + 0.0),
                    expected.map(|part| sign * part + 0.0),
                    "{name} of {mill}"
                );
            }
        }
    }
}

/// FXYZ and XYZF with relative motions: displacements and squarenesses alike; the pitch of X differs by x, since the origin
/// that travels with a table runs away from the tool.
#[test]
fn the_first_and_the_last_mill() {
    let (first, last) =
        (levers(&word("FXYZ", "relative"), &POINT), levers(&word("XYZF", "relative"), &POINT));
    for name in first.keys().filter(|name| name.contains('0') || name.starts_with(['X', 'Y', 'Z'])) {
        assert_eq!(first[name], last[name], "{name}");
    }
    assert_eq!(first["EBX"], [90.0, 0.0, -3.0]);
    assert_eq!(last["EBX"], [90.0, 0.0, -113.0]);
}

/// About the bed's point a rotation also acts over the travel; that is what a turned line does whose carriage turns with it.
#[test]
fn a_turned_line_with_its_carriage_is_a_rotation_about_the_bed() {
    let slide = |more: &str| {
        stage(&format!("{{tool: [{{slide: X, along: +X, {more}}}, {{tool: tip, offset: [Xt, Yt, Zt]}}]}}"))
    };
    let carriage = levers(&slide("errors: [EBX, ECX]"), &POINT);
    let bed = levers(&slide("reference: bed, errors: [EBX, ECX]"), &POINT);
    let line = levers(&slide("errors: [EB0X, EC0X]"), &POINT);
    let rotating = levers(&slide("errors: {EB0X: {rotates: true}, EC0X: {rotates: true}}"), &POINT);
    assert_eq!(carriage["EBX"], [120.0, 0.0, -3.0]);
    assert_eq!(bed["EBX"], [120.0, 0.0, -113.0]);
    assert_eq!(line["EB0X"], [0.0, 0.0, -110.0]);
    for (angle, aligned) in [("EBX", "EB0X"), ("ECX", "EC0X")] {
        assert_eq!(rotating[aligned], bed[angle]);
        let sum: [f64; 3] = std::array::from_fn(|axis| carriage[angle][axis] + line[aligned][axis]);
        assert_eq!(sum, bed[angle]);
    }
}

/// A rotary table: its errors act in the directions of the frame before the turn; the part's frame has turned with it.
#[test]
fn a_rotary_table_at_ninety_degrees() {
    let chain = "{workpiece: [{rotary: C, along: +C}], tool: [{slide: X, along: +X}, {tool: tip, offset: [Xt, Yt, Zt]}]}";
    let arms = levers(&stage(chain), &[&POINT[..], &[("c", std::f64::consts::FRAC_PI_2)]].concat());
    let near = |name: &str, expected: [f64; 3]| {
        for (found, expected) in arms[name].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{name}: {:?}", arms[name]);
        }
    };
    // The bed's X is the part's -Y now. The body of C displaced towards the bed's +X leaves the tip at -X of the bed: +Y of the part.
    near("EXC", [0.0, 1.0, 0.0]);
    near("EX0C", [0.0, 1.0, 0.0]);
    // The tip stands at (113, 5, 120) of the bed, at (5, -113, 120) of the part. A part that is turned too far sees the tip turn back.
    near("ECC", [-113.0, -5.0, 0.0]);
    near("EC0C", [-113.0, -5.0, 0.0]);
    // The slide is the tool's: EXX along the bed's +X.
    near("EXX", [0.0, -1.0, 0.0]);
}

/// `sign: -1` is a matter of the symbol and turns no lever of the name; a free travel stands in it for the position.
#[test]
fn signs_and_travels_of_the_file() {
    let slide = |detail: &str| {
        stage(&format!("{{tool: [{{slide: X, along: +X, errors: {{EB0X: {detail}}}}}, {{tool: tip}}]}}"))
    };
    let values = [("x", 100.0), ("dx", 40.0)];
    assert_eq!(levers(&slide("ao"), &values)["EB0X"], [0.0, 0.0, -100.0]);
    assert_eq!(levers(&slide("{symbol: ao, sign: -1}"), &values)["EB0X"], [0.0, 0.0, -100.0]);
    assert_eq!(levers(&slide("{symbol: ao, sign: -1, travel: dx}"), &values)["EB0X"], [0.0, 0.0, -40.0]);
}

/// The error is the sum of levers times motions, in every shipped machine.
#[test]
fn the_error_is_linear_in_the_motions() {
    for shipped in SHIPPED {
        let equations = compiled(&shipped.text());
        let numbers = |count: usize, range: f64, what: &str| -> Vec<f64> {
            (0..count).map(|number| range * draw(3, &format!("{what}{number}"))).collect()
        };
        let interpreter =
            Interpreter::new(&equations, &numbers(equations.constants.len(), 300.0, "constant"));
        let position = numbers(equations.axes.len(), 400.0, "axis");
        let travel = numbers(equations.travels.len(), 400.0, "travel");
        let motions = numbers(equations.motions.len(), 1e-3, "motion");
        let sum = interpreter
            .levers(&position, &travel)
            .iter()
            .zip(&motions)
            .fold([0.0; 3], |sum, (arm, motion)| std::array::from_fn(|axis| sum[axis] + arm[axis] * motion));
        let error = interpreter.error(&position, &travel, &motions);
        for axis in 0..3 {
            // Some forty products of numbers up to 1: their roundings add up to less than 1e-13.
            assert!((error[axis] - sum[axis]).abs() < 1e-12, "{}: {error:?} {sum:?}", shipped.name);
        }
    }
}

/// Lengths a thousand times as long make levers of angles a thousand times as long, and leave those of displacements alone.
#[test]
fn levers_scale_with_the_machine() {
    for shipped in SHIPPED {
        let equations = compiled(&shipped.text());
        let at = |scale: f64| {
            let constants: Vec<f64> =
                equations.constants.iter().map(|constant| scale * draw(5, &constant.name)).collect();
            let turning = |rotary: bool| if rotary { 1.0 } else { scale };
            let position: Vec<f64> =
                equations.axes.iter().map(|axis| turning(axis.rotary) * draw(5, &axis.variable)).collect();
            let travel: Vec<f64> =
                equations.travels.iter().map(|travel| scale * draw(5, &travel.name)).collect();
            Interpreter::new(&equations, &constants).levers(&position, &travel)
        };
        for ((motion, small), large) in equations.motions.iter().zip(at(1.0)).zip(at(1000.0)) {
            let factor = if motion.angular { 1000.0 } else { 1.0 };
            for (small, large) in small.into_iter().zip(large) {
                assert!((large - factor * small).abs() < 1e-9, "{} of {}", motion.name, shipped.name);
            }
        }
    }
}

/// Offsets are in mm where they have no unit; every unit of length reads, and every way to write a number.
#[test]
fn lengths_of_the_machine_file() {
    let cases = [
        ("12", 12.0),
        ("+12.5", 12.5),
        ("-.5", -0.5),
        ("1e2", 100.0),
        ("2.5e-1", 0.25),
        ("12 mm", 12.0),
        ("0.5 m", 500.0),
        ("250 um", 0.25),
        ("1500 nm", 0.0015),
        ("-2 in", -50.8),
        ("100 mil", 2.54),
        ("1000 uin", 0.0254),
        ("2*(K - 3)/4", 98.5),
        ("-K", -200.0),
        ("3 + K", 203.0),
    ];
    for (written, expected) in cases {
        let text = stage(&format!(
            "{{tool: [{{slide: X, along: +X, origin: [\"{written}\", 0, 0]}}, {{tool: tip}}]}}"
        ));
        let equations = compiled(&text);
        let constants = vec![200.0; equations.constants.len()];
        let nominal = Interpreter::new(&equations, &constants).nominal(&[0.0]);
        assert!((nominal[0] - expected).abs() < 1e-12, "{written}: {nominal:?}");
    }
}

/// A file from another system means the same: line ends of two characters, a mark before the text, none after it.
#[test]
fn line_ends_and_byte_order_marks() {
    for shipped in SHIPPED {
        let text = shipped.text();
        let code = |text: &str| model_dsl::codegen::tokens(&compiled(text)).to_string();
        for variant in [text.replace('\n', "\r\n"), format!("\u{feff}{text}"), text.trim_end().to_owned()] {
            assert_eq!(code(&variant), code(&text), "{}", shipped.name);
        }
    }
}

/// A head whose axis leans by 45 degrees between Y and Z, on a slide, with a tool of 120 mm below it.
const NUTATOR: &str = "{tool: [{slide: X, along: +X, errors: [EXX]}, {rotary: B, along: [0, 1, 1]}, {tool: tip, offset: [0, 0, -120]}]}";

/// Half a turn about (0, 1, 1)/sqrt(2) exchanges Y and Z and turns X over. The tool, which hung down, then lies: its tip is at
/// (0, -120, 0), seen from the axis. All by hand: with n = (0, 1, 1)/sqrt(2) and m = (0, -1, 1)/sqrt(2), the directions of B's own frame are
/// X, n and m, and an angle e about one of them moves the tip by e times its cross product with (0, -120, 0).
#[test]
fn a_nutating_head_after_half_a_turn() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let arms = levers(&stage(NUTATOR), &[("b", std::f64::consts::PI)]);
    let expected = [
        ("EXB", [1.0, 0.0, 0.0]),
        ("EYB", [0.0, half, half]),
        ("EZB", [0.0, -half, half]),
        ("EAB", [0.0, 0.0, -120.0]),
        ("EBB", [120.0 * half, 0.0, 0.0]),
        ("ECB", [120.0 * half, 0.0, 0.0]),
        ("EX0B", [1.0, 0.0, 0.0]),
        ("EZ0B", [0.0, -half, half]),
        ("EA0B", [0.0, 0.0, -120.0]),
        ("EB0B", [120.0 * half, 0.0, 0.0]),
        ("EC0B", [120.0 * half, 0.0, 0.0]),
    ];
    for (name, arm) in expected {
        for (found, wanted) in arms[name].into_iter().zip(arm) {
            assert!((found - wanted).abs() < 1e-12, "{name}: {:?}", arms[name]);
        }
    }
    assert_eq!(arms.len(), expected.len() + 1);
}

/// The same head, written as a vector of any length, as angles, and as an upright axis between two bodies that are turned: one set of
/// equations. A rotary axis that always stands at 45 degrees says the same in numbers.
#[test]
fn one_lean_in_four_ways() {
    let chain = |before: &str, along: &str, behind: &str| {
        stage(&format!(
            "{{workpiece: [{{rotary: C, along: -C}}], tool: [{{slide: X, along: +X}}, {before}{{rotary: B, {along}}}, {behind}{{tool: tip, offset: [Xt, 0, Zt]}}]}}"
        ))
    };
    let vector = chain("", "along: [0, 0.3, 0.3]", "");
    let angles = chain("", "along: +B, leans: {A: 45 deg}", "");
    let bodies =
        chain("{fixed: lean, turned: {A: 45 deg}}, ", "along: +B", "{fixed: back, turned: {A: -45 deg}}, ");
    let rows = |text: &str| {
        let equations = compiled(text);
        let terms = equations.rows.iter().flat_map(|row| row.terms.iter());
        let named = terms.map(|term| (equations.motions[term.motion].name.clone(), term.arm.clone()));
        (equations.rows.iter().map(|row| row.nominal.clone()).collect::<Vec<_>>(), named.collect::<Vec<_>>())
    };
    assert_eq!(rows(&vector), rows(&angles));
    assert_eq!(rows(&vector), rows(&bodies));
    // A vector of any length along a straight direction is that direction.
    assert_eq!(rows(&chain("", "along: [0, -2.5, 0]", "")), rows(&chain("", "along: -B", "")));
    let quarter = std::f64::consts::FRAC_PI_4;
    let clamped = chain("{rotary: A, along: +A, errors: []}, ", "along: +B", "");
    let mut point = vec![("x", 12.0), ("b", 0.7), ("c", -1.9), ("a", quarter), ("Xt", 5.0), ("Zt", -80.0)];
    let leaning = levers(&vector, &point);
    // Behind it the tool is turned: its offset is that of the upright one, seen from the turned frame.
    let (sine, cosine) = quarter.sin_cos();
    let clamped = clamped.replace("offset: [Xt, 0, Zt]", "offset: [Xt, Yt, Zt]");
    point.extend([("Yt", -80.0 * sine)]);
    point.iter_mut().filter(|(name, _)| *name == "Zt").for_each(|(_, value)| *value = -80.0 * cosine);
    for (name, arm) in levers(&clamped, &point) {
        for (found, wanted) in leaning[&name].into_iter().zip(arm) {
            assert!((found - wanted).abs() < 1e-11, "{name}: {:?} {arm:?}", leaning[&name]);
        }
    }
}
