//! The pictures of the guide. In: equations and terms of small machines. Out: the SVG files of `docs/guide/pictures`, in which
//! every leaning line and every arrow is placed by a lever arm of the compiler, so that no picture can contradict it.
//!
//! `ABBE_WRITE_PICTURES=1` writes the files again; without it a file that is out of date fails.

use std::fs;

use abbe_runtime::{Direction, ErrorMotion, Sample, Term, TermState};
use model_dsl::equations::Names;
use model_dsl::program::Interpreter;
use pages::svg::{COLOURS, Drawing, number};

use super::{Wish, blocks};
use crate::agreement::compiled;
use crate::shipped::root;

/// How much an angle of a picture is larger than one of a machine: it is drawn as this many rad.
const DRAWN: f64 = 0.17;

const STYLE: &str = "\
.paper { fill: var(--paper); }
text { fill: var(--ink); }
.quiet { fill: var(--quiet); }
.head { font-weight: 600; }
.middle { text-anchor: middle; }
.line { fill: none; stroke: var(--ink); stroke-width: 1.2; }
.thin { fill: none; stroke: var(--quiet); stroke-dasharray: 3 3; }
.body { fill: var(--band); stroke: var(--ink); }
.true { fill: none; stroke: var(--two); stroke-width: 2.5; }
.tip { fill: var(--two); }
.turn { fill: none; stroke: var(--one); stroke-width: 2; }
.turnhead { fill: var(--one); }
.linehead { fill: var(--ink); }
";

type Point = (f64, f64);

/// A place on the page: rightwards and upwards from an origin.
struct Panel<'d> {
    drawing: &'d mut Drawing,
    origin: Point,
}

impl Panel<'_> {
    fn at(&self, (right, up): Point) -> Point {
        (self.origin.0 + right, self.origin.1 - up)
    }

    fn path(&mut self, class: &str, points: &[Point]) {
        let written = points.iter().enumerate().map(|(index, point)| {
            let (x, y) = self.at(*point);
            format!("{}{} {}", if index == 0 { 'M' } else { 'L' }, number(x), number(y))
        });
        let path: String = written.collect();
        self.drawing.element("path", &[("class", class), ("d", &path)]);
    }

    fn arrow(&mut self, class: &str, from: Point, to: Point) {
        self.path(class, &[from, to]);
        self.head(class, from, to);
    }

    fn head(&mut self, class: &str, from: Point, to: Point) {
        let (right, up) = (to.0 - from.0, to.1 - from.1);
        let length = right.hypot(up);
        let (right, up) = (right / length, up / length);
        let foot = (to.0 - 8.0 * right, to.1 - 8.0 * up);
        let sides = [3.5, -3.5].map(|side| (foot.0 - up * side, foot.1 + right * side));
        let class = match class {
            "turn" => "turnhead",
            "true" => "tip",
            _ => "linehead",
        };
        self.path(class, &[sides[0], to, sides[1]]);
    }

    fn text(&mut self, at: Point, class: &str, text: &str) {
        let at = self.at(at);
        self.drawing.text(at, class, text);
    }

    fn block(&mut self, (right, up): Point, (width, height): Point) {
        let (x, y) = self.at((right - width / 2.0, up + height / 2.0));
        let [x, y, width, height] = [x, y, width, height].map(number);
        self.drawing.element(
            "rect",
            &[("class", "body"), ("x", &x), ("y", &y), ("width", &width), ("height", &height)],
        );
    }
}

fn drawing(width: f64, height: f64, title: &str) -> Drawing {
    let mut drawing = Drawing::new(width, height, title);
    let (wide, high) = (number(width), number(height));
    drawing.element("rect", &[("class", "paper"), ("width", &wide), ("height", &high)]);
    drawing
}

/// What stands below a picture, line by line, the first at a height of the page.
fn caption(drawing: &mut Drawing, first: f64, lines: [&str; 2]) {
    for (y, line) in [first, first + 15.0].into_iter().zip(lines) {
        drawing.text((15.0, y), "quiet", line);
    }
}

fn file(drawing: &Drawing) -> String {
    drawing.file(&format!("{COLOURS}{STYLE}"))
}

/// The lever arm of a motion of a word, at values given by name and 0 elsewhere.
fn lever(word: &str, motion: &str, values: &[(&str, f64)]) -> [f64; 3] {
    let equations = compiled(&format!("abbe: 1\nname: one\ntopology: {word}\n"));
    let value = |name: &str| values.iter().find(|(known, _)| *known == name).map_or(0.0, |(_, value)| *value);
    let constants: Vec<f64> = equations.constants.iter().map(|constant| value(&constant.name)).collect();
    let position: Vec<f64> = equations.axes.iter().map(|axis| value(&axis.variable)).collect();
    let at = equations.motions.iter().position(|own| own.name == motion).unwrap();
    Interpreter::new(&equations, &constants).levers(&position, &[])[at]
}

fn signed(value: f64) -> String {
    format!("{}{}", if value < 0.0 { '\u{2212}' } else { '+' }, value.abs())
}

/// The three directions and the three rotations, seen as in the drawing of a chain.
fn hands() -> String {
    let mut drawing =
        drawing(360.0, 220.0, "Directions X, Y, Z and the right-handed rotations A, B, C about them");
    let mut panel = Panel { drawing: &mut drawing, origin: (120.0, 170.0) };
    let seen: [Point; 3] = [(1.0, 0.0), (0.62, 0.5), (0.0, 1.0)];
    let place = |parts: [f64; 3]| {
        seen.iter().zip(parts).fold((0.0, 0.0), |at, (own, part)| (at.0 + own.0 * part, at.1 + own.1 * part))
    };
    for (axis, (letter, rotation)) in [("X", "A"), ("Y", "B"), ("Z", "C")].into_iter().enumerate() {
        let along = |length: f64| std::array::from_fn(|row| if row == axis { length } else { 0.0 });
        panel.arrow("line", (0.0, 0.0), place(along(130.0)));
        let (right, up) = place(along(146.0));
        panel.text((right, up - 4.0), "head middle", &format!("+{letter}"));
        // From the next direction towards the one after it: the right hand.
        let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
        let arc: Vec<Point> = (0..=30)
            .map(|step| (20.0 + f64::from(step) * 8.0_f64).to_radians())
            .map(|angle| {
                let mut parts = along(88.0);
                parts[first] = 26.0 * angle.cos();
                parts[second] = 26.0 * angle.sin();
                place(parts)
            })
            .collect();
        panel.path("turn", &arc);
        panel.head("turn", arc[28], arc[30]);
        let (right, up) = place(along(88.0));
        let aside = [(0.0, -46.0), (44.0, 4.0), (48.0, -4.0)][axis];
        panel.text((right + aside.0, up + aside.1), "middle", &format!("+{rotation}"));
    }
    file(&drawing)
}

/// A pitch of 10 urad with the tip above its slide and below it.
fn pitch() -> String {
    let mut drawing =
        drawing(420.0, 255.0, "A pitch EBX moves a tip above the slide forwards and one below it backwards");
    for (column, height) in [(0.0, 50.0), (210.0, -50.0)] {
        let arm = lever("FX", "EBX", &[("Zt", height)]);
        let mut panel = Panel { drawing: &mut drawing, origin: (column + 90.0, 120.0) };
        panel.text((-75.0, 98.0), "head", &format!("Zt = {} mm", signed(height)));
        panel.path("line", &[(-70.0, -14.0), (100.0, -14.0)]);
        panel.block((0.0, 0.0), (70.0, 22.0));
        panel.arrow("line", (45.0, 0.0), (85.0, 0.0));
        panel.text((88.0, -4.0), "", "+X");
        let nominal = (0.0, 1.5 * height);
        let turned = (1.5 * arm[0] * DRAWN * 2.0, nominal.1 + 1.5 * arm[2] * DRAWN * 2.0);
        panel.path("thin", &[(0.0, 0.0), nominal]);
        panel.path("true", &[(0.0, 0.0), turned]);
        let beyond = if height > 0.0 { 12.0 } else { -14.0 };
        panel.arrow("true", (nominal.0, nominal.1 + beyond), (turned.0 * 2.0, nominal.1 + beyond));
        let micro = (arm[0] * 10e-6 * 1e3 * 1e3).round() / 1e3;
        let side = if micro > 0.0 { 56.0 } else { -106.0 };
        panel.text((side, nominal.1 + beyond - 4.0), "", &format!("{} \u{b5}m", signed(micro)));
    }
    caption(
        &mut drawing,
        232.0,
        ["EBX = +10 \u{b5}rad about Y (into the page) turns Z towards X.", "Drawn far too large."],
    );
    file(&drawing)
}

/// The same straightness on both branches.
fn branches() -> String {
    let mut drawing = drawing(
        420.0,
        245.0,
        "Straightness EYX of a slide that carries the tool, and of one that carries the part",
    );
    for (column, word, what) in
        [(0.0, "FX", "the slide carries the tool"), (210.0, "XF", "the slide carries the part")]
    {
        let arm = lever(word, "EYX", &[]);
        let mut panel = Panel { drawing: &mut drawing, origin: (column + 100.0, 110.0) };
        panel.text((-85.0, 90.0), "head", word);
        panel.text((-60.0, 90.0), "quiet", what);
        let (tool, part): (Point, Point) =
            if word == "FX" { ((0.0, 30.0), (0.0, -30.0)) } else { ((0.0, 0.0), (0.0, 0.0)) };
        let part_up = if word == "FX" { part.1 } else { -12.0 };
        panel.block((0.0, part_up), (110.0, 40.0));
        panel.text((-48.0, part_up - 14.0), "quiet", "part");
        let tip = if word == "FX" { tool.1 } else { 40.0 };
        panel.path("tip", &[(-7.0, tip + 16.0), (7.0, tip + 16.0), (0.0, tip)]);
        panel.text((12.0, tip + 8.0), "quiet", "tool");
        let mover = if word == "FX" { (-20.0, tip + 8.0) } else { (-66.0, part_up) };
        panel.arrow("turn", mover, (mover.0, mover.1 + 26.0));
        panel.text((-85.0, -72.0), "", "the body moves +3 \u{b5}m");
        panel.arrow("true", (75.0, 0.0), (75.0, 26.0 * arm[1]));
        panel.text((-85.0, -88.0), "", &format!("error_y = {} \u{b5}m", signed(3.0 * arm[1])));
    }
    caption(
        &mut drawing,
        220.0,
        [
            "EYX = +3 \u{b5}m, seen from above. Blue: what the body does;",
            "orange: what the tip does, as the part sees it.",
        ],
    );
    file(&drawing)
}

/// A slide, the direction of its travel, and a direction across it.
struct Leaning {
    motion: &'static str,
    slide: usize,
    across: usize,
}

/// Squareness: the line of motion of each slide as its lever arm leans it.
fn squareness() -> String {
    let mut drawing = drawing(540.0, 220.0, "Squareness errors lean the line of motion of a slide");
    let all = [
        Leaning { motion: "EC0Y", slide: 1, across: 0 },
        Leaning { motion: "EA0Z", slide: 2, across: 1 },
        Leaning { motion: "EB0Z", slide: 2, across: 0 },
    ];
    for (column, leaning) in [0.0, 180.0, 360.0].into_iter().zip(all) {
        let letters = ["X", "Y", "Z"];
        let (own, other) = (letters[leaning.slide], letters[leaning.across]);
        let arm = lever("FXYZ", leaning.motion, &[(&own.to_lowercase(), 110.0)])[leaning.across];
        let mut panel = Panel { drawing: &mut drawing, origin: (column + 65.0, 160.0) };
        panel.text((-50.0, 140.0), "head", &format!("{} > 0", leaning.motion));
        panel.arrow("line", (0.0, 0.0), (85.0, 0.0));
        panel.text((90.0, -4.0), "", &format!("+{other}"));
        panel.path("thin", &[(0.0, 0.0), (0.0, 110.0)]);
        panel.arrow("true", (0.0, 0.0), (arm * DRAWN, 110.0));
        panel.text((arm * DRAWN - 8.0, 116.0), "", &format!("+{own}"));
        let angle = if arm < 0.0 { "> 90\u{b0}" } else { "< 90\u{b0}" };
        panel.text((14.0, 14.0), "", angle);
        let at =
            |length: f64| lever("FXYZ", leaning.motion, &[(&own.to_lowercase(), length)])[leaning.across];
        let micro = (at(200.0) * 50e-6 * 1e3 * 1e3).round() / 1e3;
        panel.text((-50.0, -28.0), "", &format!("50 \u{b5}rad, {} = 200 mm:", own.to_lowercase()));
        panel.text(
            (-50.0, -44.0),
            "",
            &format!("error_{} = {} \u{b5}m", other.to_lowercase(), signed(micro)),
        );
    }
    file(&drawing)
}

/// What a lost motion of 10 um does to the error, on the way up and on the way down.
fn backlash() -> String {
    let mut drawing = drawing(420.0, 235.0, "Lost motion: the axis lags behind in both directions");
    let terms = [Term::Backlash { axis: 0, lost_motion: 0.010, wind_up: 0.0, ramp: 0.0 }];
    let value = |direction: Direction| {
        let sample = Sample {
            position: &[0.0],
            travel: &[],
            direction: &[direction],
            velocity: &[],
            temperature: &[],
            time_step: 0.001,
        };
        1e3 * ErrorMotion { terms: &terms }.value(&sample, &[TermState::default()])
    };
    let mut panel = Panel { drawing: &mut drawing, origin: (60.0, 108.0) };
    panel.arrow("line", (0.0, 0.0), (300.0, 0.0));
    panel.text((190.0, -16.0), "", "position y");
    panel.arrow("line", (0.0, -80.0), (0.0, 85.0));
    panel.text((-50.0, 90.0), "", "error, \u{b5}m");
    let (up, down) = (value(Direction::Positive), value(Direction::Negative));
    for (error, from, to, words) in [(up, 20.0, 270.0, "going up"), (down, 270.0, 20.0, "going down")] {
        let height = 11.0 * error;
        panel.arrow("true", (from, height), (to, height));
        panel.text(
            (110.0, height + if error > 0.0 { 10.0 } else { -18.0 }),
            "",
            &format!("{words}: {}", signed(error)),
        );
    }
    panel.path("thin", &[(270.0, 11.0 * up), (270.0, 11.0 * down)]);
    panel.text((275.0, 24.0), "quiet", "reversal");
    caption(
        &mut drawing,
        208.0,
        ["lost_motion: 10 um. Actual minus commanded:", "too short on the way up, too far on the way down."],
    );
    file(&drawing)
}

/// The chain of the first machine of the guide.
fn first_machine() -> String {
    let text = fs::read_to_string(root().join("docs/guide/first-machine.md")).unwrap();
    let wanted = Some(Wish::Writes("mill.yaml".to_owned()));
    let block = blocks(&text).into_iter().find(|block| block.wish == wanted).unwrap();
    notation::drawing(&compiled(&block.text), Names::Iso)
}

#[test]
fn the_pictures_are_those_of_the_equations() {
    let folder = root().join("docs/guide/pictures");
    let all = [
        ("hands", hands()),
        ("pitch", pitch()),
        ("branches", branches()),
        ("squareness", squareness()),
        ("backlash", backlash()),
        ("first-machine", first_machine()),
    ];
    let mut stale = Vec::new();
    for (name, picture) in all {
        let path = folder.join(format!("{name}.svg"));
        if std::env::var_os("ABBE_WRITE_PICTURES").is_some_and(|value| value == "1") {
            fs::write(&path, &picture).unwrap();
        } else if fs::read_to_string(&path).unwrap_or_default() != picture {
            stale.push(name);
        }
    }
    assert!(stale.is_empty(), "out of date: {stale:?}; ABBE_WRITE_PICTURES=1 draws them again");
}
