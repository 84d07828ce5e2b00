//! The page: every figure stands in it, what is drawn lies where its numbers say, and it is well-formed and fetches nothing.

use abbe_evaluation::{Evaluation, report};

use crate::bench::{Bench, Program, near};
use crate::diagonals::four;
use crate::printed::{self, DOWN, TARGETS, UP};

/// A machine with play and an angle, on circles both ways.
fn circles() -> Evaluation {
    let bench = Bench::new("FXYZ", "EXX: [{backlash: {lost_motion: 9 um}}], EC0Y: 50 urad");
    bench.evaluate(&bench.positions(&Program::circles(100.0, 20.0, 20.0, &[1.0, -1.0], 3), 0.0, 1))
}

fn diagonals() -> Evaluation {
    let bench =
        Bench::new("FXYZ", "EXX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.1]}}], EC0Y: 30 urad");
    bench.evaluate(&bench.positions(&four(4), 0.0, 1))
}

/// The places of all marks of a class in the first drawing.
fn marks(page: &str, class: &str) -> Vec<(f64, f64)> {
    let drawing = page.split("<svg").nth(1).unwrap();
    // The first of a class is the legend's.
    let path = drawing.split(&format!("class=\"{class}\" d=\"")).nth(2).unwrap().split('"').next().unwrap();
    let places = path.split('M').skip(1).map(|place| {
        let numbers: Vec<f64> = place
            .split(|letter: char| letter.is_ascii_alphabetic())
            .next()
            .unwrap()
            .replace('-', " -")
            .split([' ', ','])
            .filter_map(|number| number.parse().ok())
            .collect();
        (numbers[0], numbers[1])
    });
    places.collect()
}

/// How far places lie from a straight relation to numbers, which the first and the last extreme of these fix.
fn off(numbers: &[f64], places: &[f64]) -> f64 {
    let least = (0..numbers.len()).min_by(|a, b| numbers[*a].total_cmp(&numbers[*b])).unwrap();
    let most = (0..numbers.len()).max_by(|a, b| numbers[*a].total_cmp(&numbers[*b])).unwrap();
    let slope = (places[most] - places[least]) / (numbers[most] - numbers[least]);
    assert!(slope.abs() > 1.0, "the numbers are told apart: {slope}");
    let away = |row: usize| (places[row] - places[least] - slope * (numbers[row] - numbers[least])).abs();
    (0..numbers.len()).map(away).fold(0.0, f64::max)
}

#[test]
fn each_reading_of_the_printed_data_lies_where_its_numbers_say() {
    let page = report::html(&printed::evaluated(), "");
    for (class, table) in [("m c1", &UP), ("m c2", &DOWN)] {
        let places = marks(&page, class);
        assert_eq!(places.len(), 25, "{class}");
        let targets: Vec<f64> = TARGETS.iter().flat_map(|target| [*target; 5]).collect();
        let read = table.iter().flatten().zip(&targets).map(|(read, target)| 1e3 * (read - target));
        let (x, y): (Vec<f64>, Vec<f64>) = places.into_iter().unzip();
        // Places have one decimal.
        near(off(&targets, &x), 0.0, 0.2);
        near(off(&read.collect::<Vec<f64>>(), &y), 0.0, 0.2);
    }
}

#[test]
fn every_figure_stands_in_the_page_with_its_value_or_why_there_is_none() {
    for evaluation in [printed::evaluated(), circles(), diagonals()] {
        let page = report::html(&evaluation, "");
        assert!(evaluation.gives_any());
        for figure in evaluation.figures() {
            assert!(page.contains(&format!("<td>{}</td>", figure.name)) || figure.value.reason().is_some());
            match figure.value.number() {
                Some(value) => {
                    let value = format!(">{:.2} \u{b5}m<", value * 1e3).replace(">-0.00 ", ">0.00 ");
                    assert!(page.contains(&value), "{} {value}", figure.symbol);
                }
                None => assert!(page.contains(figure.value.reason().unwrap()), "{}", figure.symbol),
            }
        }
    }
}

#[test]
fn both_senses_and_all_diagonals_are_named_in_their_pictures() {
    let page = report::html(&circles(), "");
    let polar = page.split("<svg").nth(1).unwrap().split("</svg>").next().unwrap();
    for name in [
        "CCW, run 1",
        "CW, run 1",
        "CCW, run 3",
        "CW, run 3",
        "1 division = ",
        ":1 relative to the circle",
        "of 6 traces",
    ] {
        assert!(polar.contains(name), "{name}");
    }
    let page = report::html(&diagonals(), "");
    let together = page.split("<svg").last().unwrap();
    for name in ["+X+Y+Z", "+X+Y-Z", "+X-Y+Z", "+X-Y-Z"] {
        assert!(together.contains(name), "{name}");
    }
}

#[test]
fn it_is_well_formed_and_fetches_and_runs_nothing() {
    for evaluation in [printed::evaluated(), circles(), diagonals(), Evaluation::default()] {
        let hostile = "</svg><script>x</script> \"&";
        let page = report::html(
            &Evaluation { title: Some(hostile.to_owned()), ..evaluation },
            "abbe evaluate '<x>'",
        );
        for part in ["<script", "http", "src=", "href=", "url(", "@import", "NaN", "inf"] {
            assert!(!page.contains(part), "{part}");
        }
        let mut open: Vec<String> = Vec::new();
        for mark in page.split('<').skip(1).map(|piece| piece.split_once('>').unwrap().0) {
            let name = mark.split_whitespace().next().unwrap();
            match mark.strip_prefix('/') {
                Some(closed) => assert_eq!(open.pop().as_deref(), Some(closed)),
                None if matches!(name, "!DOCTYPE" | "meta") || mark.ends_with('/') => {}
                None => open.push(name.to_owned()),
            }
        }
        assert!(open.is_empty(), "{open:?}");
    }
}
