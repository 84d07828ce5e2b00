//! The page of the derivation as its readers use it: the numbers of its worked example against the exact machine, its word
//! on what can be compensated against the compensator, and what was published against the command that compares it.
//!
//! In: the shipped machines. Out: nothing, or the sentence of the page that is not so.

use std::collections::BTreeMap;

use abbe_runtime::{Compensator, Direction, ErrorMotion, Sample, Term, TermState, Work, states_needed};
use model_dsl::equations::{Equations, Names};
use model_dsl::program::Interpreter;
use notation::{example, page};

use crate::agreement::compiled;
use crate::cli::abbe;
use crate::oracle::{Sizes, State, exact};
use crate::shipped::{SHIPPED, root};

/// The values by name.
fn named<'n>(names: impl Iterator<Item = &'n str>, values: &[f64]) -> BTreeMap<String, f64> {
    names.map(str::to_owned).zip(values.iter().copied()).collect()
}

/// A number as the page prints it.
fn short(value: f64) -> String {
    format!("{}", (value * 1e3).round() / 1e3)
}

#[test]
fn the_worked_example_is_what_the_exact_machine_does() {
    for shipped in SHIPPED {
        let (machine, equations) = ((shipped.described)(), compiled(&shipped.text()));
        // Squarenesses turn nothing, and axes that are wrong in their own angle alone have no tilt to work through.
        let Some(worked) = example(&equations) else {
            let without = ["linuxcnc-xyzac-trt", "linuxcnc-xyzbc-trt", "printer-skew"];
            assert!(without.contains(&shipped.name), "{}", shipped.name);
            continue;
        };
        assert_eq!(worked.value, 10e-6);
        let motion = &equations.motions[worked.motion];
        let straight = State {
            positions: named(equations.axes.iter().map(|axis| &*axis.variable), &worked.positions),
            travels: named(equations.travels.iter().map(|travel| &*travel.name), &worked.travels),
            constants: named(equations.constants.iter().map(|constant| &*constant.name), &worked.constants),
            ..State::default()
        };
        let turned =
            State { errors: BTreeMap::from([(motion.name.clone(), worked.value)]), ..straight.clone() };
        let (before, after) = (exact::tip(&machine, &straight), exact::tip(&machine, &turned));
        let sizes = Sizes::of(&machine, &turned);
        let text = page(&equations, Names::Iso, &[]);
        for row in &equations.rows {
            let axis = row.direction.index();
            let (error, told) = (after[axis] - before[axis], worked.error()[axis]);
            let bound = sizes.second() / 2.0 + sizes.rounding();
            assert!(
                (error - told).abs() <= bound,
                "{} {}: {error} mm, not {told}",
                shipped.name,
                motion.name
            );
            let reached = row.terms.iter().any(|term| term.motion == worked.motion);
            let (sign, back) = if told > 0.0 { ('+', '\u{2212}') } else { ('\u{2212}', '+') };
            let size = short(told.abs() * 1e3);
            let sentence = format!(
                "is {size} \u{b5}m too far towards {sign}{0} of the part. Compensation moves the tip by {back}{size} \u{b5}m in {0}",
                row.direction
            );
            assert_eq!(text.contains(&sentence), reached, "{}: {sentence}", shipped.name);
        }
    }
}

/// What the page says of each error motion: the cell of a column of its table, by the motion's name.
fn column(text: &str, heading: &str) -> BTreeMap<String, String> {
    let table = text.split("<table class=\"motions\">").nth(1).unwrap().split("</table>").next().unwrap();
    let (head, body) = table.split_once("<tbody>").unwrap();
    let cells = |row: &str, tag: &str| -> Vec<String> {
        let (start, end) = (format!("<{tag}>"), format!("</{tag}>"));
        row.split(&start).skip(1).map(|cell| cell.split(&end).next().unwrap().to_owned()).collect()
    };
    let headings = cells(head, "th");
    let at = headings.iter().position(|own| own == heading).unwrap();
    let iso = headings.iter().position(|own| own == "ISO 230-1").unwrap();
    let rows = body.split("<tr>").skip(1).map(|row| cells(row, "td"));
    rows.map(|row| (row[iso].clone(), row[at].clone())).collect()
}

/// What the compensator leaves, and what it began with, of one error motion alone at a point.
fn left(equations: &Equations, motion: usize, turn: f64) -> ([f64; 3], [f64; 3]) {
    let constants: Vec<f64> =
        (0..equations.constants.len()).map(|number| 31.0 + 7.0 * number as f64).collect();
    let machine = Interpreter::new(equations, &constants);
    let terms = [Term::Constant { value: if equations.motions[motion].angular { 1e-5 } else { 1e-3 } }];
    let motions: Vec<ErrorMotion<'_>> = (0..equations.motions.len())
        .map(|number| if number == motion { ErrorMotion { terms: &terms } } else { ErrorMotion::default() })
        .collect();
    let position: Vec<f64> = equations
        .axes
        .iter()
        .enumerate()
        .map(|(number, axis)| if axis.rotary { turn + number as f64 } else { 80.0 + 45.0 * number as f64 })
        .collect();
    let mut states = vec![TermState::default(); states_needed(&motions)];
    let mut directions = vec![[0.0; 3]; equations.axes.len()];
    let mut values = vec![0.0; equations.motions.len()];
    let mut travel = vec![0.0; equations.travels.len()];
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let mut compensator = Compensator::new(&machine, &motions, &mut states, work).unwrap();
    let forwards = vec![Direction::Positive; position.len()];
    let sample = Sample {
        position: &position,
        travel: &[],
        direction: &forwards,
        velocity: &[],
        temperature: &[],
        time_step: 0.001,
    };
    let mut command = vec![0.0; position.len()];
    let outcome = compensator.compensate(&sample, &mut command).unwrap();
    (outcome.remaining, outcome.error)
}

/// `yes` where the compensator leaves nothing wherever the axes stand, `no` where it changes nothing.
fn agrees_with_the_compensator(equations: &Equations) {
    let text = page(equations, Names::Iso, &[]);
    let (compensable, reaches) = (column(&text, "Compensable"), column(&text, "Reaches"));
    for (number, motion) in equations.motions.iter().enumerate() {
        let rows = equations.rows.iter().filter(|row| row.terms.iter().any(|term| term.motion == number));
        let directions: Vec<String> = rows.map(|row| row.direction.to_string()).collect();
        assert_eq!(reaches[&motion.name], directions.join(", "), "{} {}", equations.machine, motion.name);
        let trials: Vec<_> = [0.2, 0.9, 2.6].map(|turn| left(equations, number, turn)).into();
        let size = |vector: &[f64; 3]| vector.iter().map(|part| part * part).sum::<f64>().sqrt();
        let all = trials.iter().all(|(remaining, _)| size(remaining) < 1e-8);
        let none = trials
            .iter()
            .all(|(remaining, error)| size(remaining) > 0.999 * size(error) && size(error) > 0.0);
        let said = &compensable[&motion.name];
        assert_eq!(said == "yes", all, "{} {}: {said}", equations.machine, motion.name);
        assert_eq!(said == "no", none, "{} {}: {said}", equations.machine, motion.name);
    }
}

#[test]
fn what_the_page_calls_compensable_the_compensator_cancels() {
    for shipped in SHIPPED {
        agrees_with_the_compensator(&compiled(&shipped.text()));
    }
    for word in ["CFX", "FAY", "BXF", "XFC", "ZFA", "FBZ", "CXFY"] {
        agrees_with_the_compensator(&compiled(&format!("abbe: 1\nname: {word}\ntopology: {word}\n")));
    }
}

/// A rotary table and one slide: positioning errors lie along the slide, straightness across it, and the table undoes its own
/// angle; left to the slide, what that does lies along it as far as the tip is off its line.
#[test]
fn what_one_slide_cancels() {
    let said = |machine: &str| column(&page(&compiled(machine), Names::Iso, &[]), "Compensable");
    let all = said("abbe: 1\nname: one\ntopology: CFX\n");
    let of = |motion: &str| all[motion].as_str();
    assert_eq!([of("EXX"), of("EYX"), of("EZX"), of("ECC")], ["yes", "no", "no", "yes"]);
    let left = said(
        "abbe: 1\nname: one\nchain:\n  workpiece: [{rotary: C, along: -C, corrects: false}]\n  \
         tool: [{slide: X, along: +X}, {tool: tip, offset: [Xt, Yt, Zt]}]\n",
    );
    assert_eq!(left["ECC"], "X, Y in part");
}

#[test]
fn the_page_says_what_check_says() {
    for (machine, file) in [
        ("cai-wafer-grinder", "published/cai-wafer-grinder.eqs"),
        ("excello-921", "published/excello-921.eqs"),
        ("linuxcnc-xyzac-trt", "published/linuxcnc-xyzac-trt.eqs"),
        ("linuxcnc-xyzbc-trt", "published/linuxcnc-xyzbc-trt.eqs"),
        ("msl-moving-bridge", "published/msl-moving-bridge.eqs"),
        ("msl-moving-table", "published/msl-moving-table.eqs"),
        ("nist-turning-center", "published/nist-turning-center.eqs"),
        ("postech-mill", "published/postech-carriage.eqs"),
        ("printer-skew", "published/printer-skew.eqs"),
    ] {
        let text = abbe(&["derive", machine, "--format", "html"], "").out;
        let checked = abbe(&["check", machine, file], "").out;
        let rows =
            text.split("<table class=\"published\">").nth(1).unwrap().split("</table>").next().unwrap();
        let cells = |row: &str| -> Vec<String> {
            row.split("<td>").skip(1).map(|cell| cell.split("</td>").next().unwrap().to_owned()).collect()
        };
        let rows: Vec<Vec<String>> = rows.split("<tr>").skip(2).map(cells).collect();
        let lines =
            |word: &str| checked.lines().filter(|line| line.starts_with(&format!("  {word}"))).count();
        let sum = |at: usize| -> usize { rows.iter().map(|row| row[at].parse::<usize>().unwrap()).sum() };
        let nominal = checked.lines().filter(|line| line.contains("agrees         nominal part")).count();
        assert_eq!(sum(2), lines("agrees ") - nominal, "{machine}");
        assert_eq!(sum(3), lines("left out "), "{machine}");
        let disagreement =
            checked.split("\nDisagreement\n").nth(1).map(|rest| rest.split("\n\n").next().unwrap());
        let told: Vec<&str> = disagreement.unwrap_or_default().lines().map(str::trim).collect();
        let shown: Vec<&str> =
            rows.iter().flat_map(|row| row[4].split("<br>")).filter(|line| *line != "none").collect();
        assert_eq!(shown, told, "{machine}");
        assert!(text.contains("Source: "), "{machine}");
    }
}

/// A machine without published equations has no such section, nor has a changed copy of one that has.
#[test]
fn agreement_is_told_of_the_machine_that_was_published() {
    let heading = "Agreement with published equations";
    assert!(!abbe(&["derive", "xyfz-mill", "--format", "html"], "").out.contains(heading));
    let path = root().join("machines/excello-921.yaml");
    assert!(abbe(&["derive", path.to_str().unwrap(), "--format", "html"], "").out.contains(heading));
    let changed = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("changed-lathe.yaml");
    let text = std::fs::read_to_string(&path).unwrap().replace("along: +Z", "along: -Z");
    std::fs::write(&changed, text).unwrap();
    assert!(!abbe(&["derive", changed.to_str().unwrap(), "--format", "html"], "").out.contains(heading));
}
