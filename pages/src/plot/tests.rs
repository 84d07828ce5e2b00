//! Plots as a whole. In: series with known numbers, and hostile ones. Out: that places are right, and markup is sound.

use super::{
    Axis, Band, Bar, Bars, Cartesian, Draw, Line, Look, Part, Plot, Polar, Series, Shares, Steps, Tone,
    Trace, Whole, histogram, panels, style,
};

/// The numbers that an attribute has in all elements of a kind and class.
fn attributes(markup: &str, element: &str, name: &str) -> Vec<String> {
    let of = |tag: &str| {
        let rest = tag.split_once(&format!(" {name}=\""))?.1;
        Some(rest.split_once('"')?.0.to_owned())
    };
    markup.split('<').filter(|tag| tag.starts_with(element)).filter_map(of).collect()
}

/// The corners of the last path of a class: the legend's pieces come first.
fn corners(markup: &str, class: &str) -> Vec<(f64, f64)> {
    let tag = markup.rsplit('<').find(|tag| tag.starts_with(&format!("path class=\"{class}\""))).unwrap();
    let path = tag.split_once(" d=\"").unwrap().1.split_once('"').unwrap().0;
    let corner = |part: &str| {
        let (x, y) = part.split_once(' ')?;
        Some((x.parse().ok()?, y.parse().ok()?))
    };
    path.split(['M', 'L']).filter_map(corner).collect()
}

fn diagonal() -> Cartesian {
    let line = Series::new("line", Look::of(0), Draw::Line, vec![(0.0, 0.0), (5.0, 0.001), (10.0, 0.002)]);
    Cartesian::new("a < b", Axis::new("position of X", "mm"), Axis::new("deviation", "mm")).series(line)
}

#[test]
fn a_point_lies_where_its_numbers_say() {
    let markup = diagonal().draw().inline();
    let places = corners(&markup, "l c1");
    let frame: Vec<f64> = ["x", "y", "width", "height"]
        .map(|name| attributes(&markup, "rect class=\"f\"", name)[0].parse().unwrap())
        .to_vec();
    let [x, y, width, height] = frame[..] else { panic!("{frame:?}") };
    // 0 to 10 and 0 to 2 µm are round already: the axes end there.
    let expected = [(x, y + height), (x + width / 2.0, y + height / 2.0), (x + width, y)];
    for (place, expected) in places.iter().zip(expected) {
        assert!(
            (place.0 - expected.0).abs() < 0.11 && (place.1 - expected.1).abs() < 0.11,
            "{places:?} {frame:?}"
        );
    }
}

#[test]
fn axes_say_their_quantity_and_their_unit_and_titles_are_text() {
    let markup = diagonal().draw().inline();
    assert!(markup.contains(">deviation, µm</text>") && markup.contains(">position of X, mm</text>"));
    assert!(markup.contains("a &lt; b") && !markup.contains("a < b"));
}

#[test]
fn a_deviation_lies_outside_the_nominal_circle_by_its_divisions() {
    let trace = |deviation: f64| Trace {
        name: String::new(),
        look: Look::of(0),
        draw: Draw::Line,
        points: vec![(0.0, deviation), (std::f64::consts::FRAC_PI_2, deviation), (0.1, -0.004), (0.1, 0.004)],
    };
    let drawn = |deviation| {
        let polar = Polar::new("circle", ["+X", "+Y"], 100.0, "mm").trace(trace(deviation));
        let markup = polar.draw().inline();
        let rings: Vec<f64> =
            attributes(&markup, "circle", "r").iter().map(|radius| radius.parse().unwrap()).collect();
        let middle: (f64, f64) = (
            attributes(&markup, "circle", "cx")[0].parse().unwrap(),
            attributes(&markup, "circle", "cy")[0].parse().unwrap(),
        );
        let places = corners(&markup, "l c1");
        (places[0].0 - middle.0, middle.1 - places[1].1, rings)
    };
    let (right, up, rings) = drawn(0.002);
    assert!((right - up).abs() < 0.11);
    // Rings of 1 µm from -4 to 4 µm: the deviation of 2 µm lies on the seventh of nine.
    assert_eq!(rings.len(), 9);
    assert!((right - rings[6]).abs() < 0.11, "{right} {rings:?}");
}

#[test]
fn nothing_that_is_not_finite_reaches_the_markup() {
    let hostile = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 5e-324, 0.0, 1.0];
    let points: Vec<(f64, f64)> = hostile.iter().flat_map(|x| hostile.iter().map(|y| (*x, *y))).collect();
    let axis = || Axis::new("q", "mm");
    let all = |axis: Axis| {
        [Draw::Line, Draw::Marks, Draw::Hollow, Draw::MarkedLine]
            .into_iter()
            .enumerate()
            .fold(Cartesian::new("hostile", axis.clone(), axis), |plot, (number, draw)| {
                plot.series(Series::new("s", Look::of(number), draw, points.clone()))
            })
    };
    let lined = |value: f64| {
        all(axis())
            .line(Line::new(value, "f"))
            .band(Band::of_x(value, 1.0, "b"))
            .band(Band::of_y(value, value, "b"))
    };
    let mut drawings: Vec<String> = hostile.iter().map(|value| lined(*value).draw().inline()).collect();
    drawings.push(all(axis().logarithmic()).draw().inline());
    let bar = |value: &f64| Bar { label: "l".to_owned(), value: *value, further: Some(*value) };
    drawings.push(Bars::new("bars", "", axis(), hostile.iter().map(bar).collect()).draw().inline());
    drawings.extend(hostile.map(|value| shares(&[value, value]).draw().inline()));
    for radius in hostile {
        let trace =
            Trace { name: "t".to_owned(), look: Look::of(0), draw: Draw::MarkedLine, points: points.clone() };
        drawings.push(Polar::new("polar", ["x", "y"], radius, "mm").trace(trace).draw().inline());
    }
    for markup in drawings {
        assert!(!markup.contains("NaN") && !markup.contains("inf"), "{markup}");
    }
}

#[test]
fn a_plot_without_numbers_says_so() {
    let empty = [
        Cartesian::new("nothing", Axis::new("x", "mm"), Axis::new("y", "mm")).draw(),
        Polar::new("nothing", ["+X", "+Y"], 100.0, "mm").draw(),
        Bars::new("nothing", "", Axis::new("x", "mm"), Vec::new()).draw(),
        Shares::new("nothing", "all", Vec::new()).draw(),
    ];
    assert!(empty.iter().all(|drawing| drawing.inline().contains("no data")));
    assert!(!diagonal().draw().inline().contains("no data"));
}

#[test]
fn a_distribution_stands_on_zero() {
    let steps = Steps {
        name: "before".to_owned(),
        look: Look::of(0),
        edges: vec![0.0, 1.0, 2.0],
        shares: vec![0.25, 0.75],
    };
    let places = corners(&histogram("d", Axis::exactly("deviation", "V"), &[steps]).draw().inline(), "l c1");
    let (first, last, highest) = (places[0], places[places.len() - 1], places[3]);
    assert!(first.1 == last.1 && first.1 > highest.1);
    // The second class is three times as high as the first.
    assert!(((first.1 - highest.1) / (first.1 - places[1].1) - 3.0).abs() < 0.02);
}

fn shares(parts: &[f64]) -> Shares {
    let part = |(number, share): (usize, &f64)| Part {
        label: format!("part {number}"),
        share: *share,
        note: "2 µm <rms>".to_owned(),
        tone: Tone::One,
    };
    let parts = parts.iter().enumerate().map(part).collect();
    Shares::new("parts", "the whole", vec![Whole { label: "whole".to_owned(), parts }])
}

#[test]
fn each_part_begins_where_the_one_before_it_ends() {
    let markup = shares(&[0.5, 0.3, 0.2]).draw().inline();
    let numbers = |name: &str| -> Vec<f64> {
        attributes(&markup, "rect class=\"m c1\"", name).iter().map(|text| text.parse().unwrap()).collect()
    };
    let (from, wide, below) = (numbers("x"), numbers("width"), numbers("y"));
    let whole: f64 = wide.iter().sum();
    for (number, (begun, part)) in [(0.0, 0.5), (0.5, 0.3), (0.8, 0.2)].into_iter().enumerate() {
        assert!((from[number] - from[0] - begun * whole).abs() < 0.03, "{from:?} {wide:?}");
        assert!((wide[number] - part * whole).abs() < 0.03, "{wide:?}");
    }
    assert!(below[0] < below[1] && below[1] < below[2], "{below:?}");
    // Where the axis says 0 and 100 %.
    let lines: Vec<f64> = attributes(&markup, "path class=\"", "d")
        .iter()
        .map(|path| path[1..].split(' ').next().unwrap().parse().unwrap())
        .collect();
    assert!((lines[0] - from[0]).abs() < 0.03 && (lines[lines.len() - 1] - from[0] - whole).abs() < 0.06);
    assert!(markup.contains(">share of the whole, %</text>"));
    let words = "part 0 50.0 %, 2 µm &lt;rms&gt;; part 1 30.0 %, 2 µm &lt;rms&gt;; part 2 20.0 %";
    assert!(markup.contains(&format!("<desc>whole: {words}")), "{markup}");
}

#[test]
fn panels_lie_beside_one_another_and_a_file_has_its_colours() {
    let plot = diagonal();
    let drawing = panels("two", &[&plot, &plot, &plot], 2);
    let single = plot.draw().size();
    assert!(drawing.size().0 > 2.0 * single.0 && drawing.size().1 > 2.0 * single.1);
    let file = drawing.file(&style());
    assert!(file.contains("prefers-color-scheme: dark") && file.contains("--one") && file.contains("xmlns="));
}

#[test]
fn with_one_scale_a_square_is_square_and_a_flat_shape_stays_flat() {
    let sides = |wide: f64, high: f64| {
        let square = vec![(0.0, 0.0), (wide, 0.0), (wide, high), (0.0, high)];
        let axis = || Axis::exactly("position", "mm");
        let plot = Cartesian::new("", axis(), axis()).equal();
        let markup = plot.series(Series::new("", Look::of(0), Draw::Line, square)).draw().inline();
        let places = corners(&markup, "l c1");
        ((places[1].0 - places[0].0).abs(), (places[2].1 - places[1].1).abs())
    };
    for (wide, high) in [(100.0, 100.0), (500.0, 130.0), (70.0, 900.0)] {
        let (across, up) = sides(wide, high);
        assert!(
            across > 10.0 && (up / across / (high / wide) - 1.0).abs() < 0.01,
            "{wide} {high}: {across} {up}"
        );
    }
}
