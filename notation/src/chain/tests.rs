//! Tests of the drawing: everything of the chain stands in it once, at its place, and every arrow points where it should.

use super::{broken, drawing, word};
use model_dsl::algebra::Polynomial;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::{Equations, Names};
use model_dsl::machine::{Branch, LinkKind};
use model_dsl::sheet::infix;
use model_dsl::source::SourceFile;

/// Every shipped machine, and one of nine links with long names and expressions.
fn machines() -> Vec<Equations> {
    let folder = format!("{}/../machines", env!("CARGO_MANIFEST_DIR"));
    let files =
        std::fs::read_dir(folder).expect("the shipped machines").map(|entry| entry.expect("a file").path());
    let mut texts: Vec<String> =
        files.map(|path| std::fs::read_to_string(path).expect("a machine file")).collect();
    texts.push(LONG.to_owned());
    assert!(texts.len() > 9);
    texts.iter().map(|text| compiled(text)).collect()
}

const LONG: &str = "abbe: 1
name: long
chain:
  workpiece:
    - slide: X
      along: -X
      origin: [a_rather_long_offset - 12.5 + another_long_offset, 0, yet_another - 40]
    - rotary: A
      along: -A
    - rotary: C
      along: +C
      id: TURNTABLE
    - part: P
      offset: [0, 0, 10]
  tool:
    - slide: Y
      along: -Y
    - slide: Z
      along: -Z
    - spindle: S
    - fixed: a_chuck_with_a_name_that_no_card_holds
      errors: [EXa_chuck_with_a_name_that_no_card_holds]
    - tool: tip
      offset: [0, -Q, 2*Q]
";

fn compiled(text: &str) -> Equations {
    let source = SourceFile::new("machine.yaml", text);
    let mut diagnostics = Diagnostics::new();
    model_dsl::compile(&source, &mut diagnostics).unwrap_or_else(|| panic!("{diagnostics:?}")).equations
}

/// The attribute of an element, from its text.
fn attribute<'t>(element: &'t str, name: &str) -> &'t str {
    let rest = element.split_once(&format!(" {name}=\"")).unwrap_or_else(|| panic!("{name} in {element}")).1;
    rest.split('"').next().expect("a value")
}

/// The cards: the id of the link, the markup that is its own, and the offset that stands on the way to it.
fn cards(equations: &Equations) -> Vec<(String, String, String)> {
    let markup = drawing(equations, Names::Iso).inline();
    let mut pieces = markup.split("<g class=\"link\"");
    let mut before = pieces.next().expect("the bed").to_owned();
    let mut cards = Vec::new();
    for piece in pieces {
        let (own, after) = piece.split_once("</g>").expect("the end of the card");
        let lines =
            before.split("class=\"offset\">").skip(1).map(|line| line.split('<').next().expect("text"));
        let offset = lines.collect::<Vec<_>>().join(" ");
        cards.push((attribute(own, "data-link").to_owned(), own.to_owned(), offset));
        before = after.to_owned();
    }
    cards
}

#[test]
fn every_error_motion_stands_once_at_its_link() {
    for equations in machines() {
        let mut shown: Vec<(String, String)> = Vec::new();
        for (link, own, _) in cards(&equations) {
            let motions = own.split("<text").filter(|element| element.contains("class=\"motion\""));
            shown.extend(motions.map(|element| (attribute(element, "data-motion").to_owned(), link.clone())));
        }
        let mut meant: Vec<(String, String)> =
            equations.motions.iter().map(|motion| (motion.name.clone(), motion.link.clone())).collect();
        shown.sort();
        meant.sort();
        assert_eq!(shown, meant, "{}", equations.machine);
    }
}

#[test]
fn every_offset_stands_on_the_way_to_its_link() {
    for equations in machines() {
        let cards = cards(&equations);
        assert_eq!(cards.len(), equations.links.len());
        for (link, (id, _, offset)) in equations.links.iter().zip(cards) {
            assert_eq!(link.id, id, "the part's branch first, from the bed outwards");
            let meant = if link.origin.iter().all(Polynomial::is_zero) {
                String::new()
            } else {
                let [x, y, z] = link.origin.each_ref().map(infix);
                format!("[{x}, {y}, {z}]")
            };
            assert_eq!(offset, meant, "{} {id}", equations.machine);
        }
    }
}

/// Nothing is drawn outside the picture, and no card over another.
#[test]
fn all_of_it_lies_in_the_picture() {
    for equations in machines() {
        let markup = drawing(&equations, Names::Iso).inline();
        let size: Vec<f64> =
            attribute(&markup, "viewBox").split(' ').map(|one| one.parse().expect("a number")).collect();
        let mut cards: Vec<[f64; 4]> = Vec::new();
        for element in markup.split('<').filter(|element| element.starts_with("rect")) {
            let [x, y, width, height] =
                ["x", "y", "width", "height"].map(|name| attribute(element, name).parse().expect("a number"));
            assert!(x >= 0.0 && y >= 0.0 && x + width <= size[2] && y + height <= size[3], "{element}");
            if element.contains("class=\"card\"") {
                cards.push([x, y, x + width, y + height]);
            }
        }
        // Names are at most 9 units a letter; a longer one is told how much room it has.
        for element in markup.split("<text").filter(|element| element.contains("class=\"motion\"")) {
            let left: f64 = attribute(element, "x").parse().expect("a number");
            let room = if left < super::CARD { super::CARD } else { size[2] } - left;
            let letters = attribute(element, "data-motion").chars().fold(0.0, |width, _| width + 9.0);
            assert!(letters < room || element.contains(" textLength=\"1"), "{element}");
        }
        for (number, one) in cards.iter().enumerate() {
            for other in &cards[..number] {
                let apart =
                    one[2] <= other[0] || other[2] <= one[0] || one[3] <= other[1] || other[3] <= one[1];
                assert!(apart, "{}: {one:?} over {other:?}", equations.machine);
            }
        }
    }
}

/// The points of a path.
fn points(path: &str) -> Vec<(f64, f64)> {
    let pairs = path.trim_end_matches('Z').split(['M', 'L']).filter(|pair| !pair.is_empty());
    pairs
        .map(|pair| pair.split_once(' ').expect("two numbers"))
        .map(|(x, y)| (x.parse().expect("a number"), y.parse().expect("a number")))
        .collect()
}

fn paths(markup: &str, class: &str) -> Vec<Vec<(f64, f64)>> {
    let class = format!("path class=\"{class}\"");
    let found = markup.split('<').filter(|element| element.starts_with(&class));
    found.map(|element| points(attribute(element, "d"))).collect()
}

/// Where +X, +Y, +Z are seen: to the right, into the page (upwards to the right), upwards. y grows downwards.
const SEEN: [(f64, f64); 3] = [(1.0, 0.0), (0.6, -0.5), (0.0, -1.0)];

#[test]
fn the_full_head_of_a_slide_lies_where_its_position_grows() {
    for (letter, (right, down)) in ["X", "Y", "Z"].into_iter().zip(SEEN) {
        for (sign, turned) in [("+", 1.0), ("-", -1.0)] {
            let text = format!(
                "abbe: 1\nname: one\nchain: {{tool: [{{slide: {letter}, along: {sign}{letter}, errors: []}}, {{tool: tip, offset: [1, 2, 3]}}]}}\n"
            );
            let cards = cards(&compiled(&text));
            let line = &paths(&cards[0].1, "joint")[0];
            let middle = ((line[0].0 + line[1].0) / 2.0, (line[0].1 + line[1].1) / 2.0);
            let head = &paths(&cards[0].1, "solid")[0];
            let forward: f64 =
                head.iter().map(|(x, y)| (x - middle.0) * right + (y - middle.1) * down).sum::<f64>()
                    * turned;
            assert!(forward > 10.0, "{sign}{letter}: {forward}");
        }
    }
}

/// Seen as the page shows it, a right-handed turn about X or Z runs against the clock, and about Y, which goes into the
/// page, with it.
#[test]
fn the_arc_of_a_rotary_axis_runs_where_its_angle_grows() {
    for (letter, about, against_the_clock) in [("A", "X", true), ("B", "Y", false), ("C", "Z", true)] {
        for (sign, positive) in [("+", true), ("-", false)] {
            let text = format!(
                "abbe: 1\nname: one\nchain: {{tool: [{{rotary: {letter}, along: {sign}{letter}, errors: []}}, {{tool: tip, offset: [1, 2, 3]}}]}}\n"
            );
            let cards = cards(&compiled(&text));
            assert!(
                cards[0].1.contains(&format!("about {}{about}", if positive { "+" } else { "\u{2212}" }))
            );
            let arc = &paths(&cards[0].1, "joint")[0];
            // Twice the area between the arc and its first point; with y downwards it is positive with the clock.
            let (x, y) = arc[0];
            let area: f64 = arc
                .windows(2)
                .map(|step| (step[0].0 - x) * (step[1].1 - y) - (step[1].0 - x) * (step[0].1 - y))
                .sum();
            assert_eq!(area < 0.0, against_the_clock == positive, "{sign}{letter}: {area}");
            let (last, head) = (arc[arc.len() - 1], &paths(&cards[0].1, "solid")[0]);
            let distance = head.iter().map(|(x, y)| (x - last.0).hypot(y - last.1)).fold(f64::MAX, f64::min);
            assert!(distance < 6.0, "the head is {distance} from the end of the arc");
        }
    }
}

#[test]
fn the_word_is_that_of_the_topology() {
    for letters in ["XYFZ", "FXYZ", "XYZF", "CAFXYZ", "FX"] {
        let equations = model_dsl::compile_word(letters, &mut Diagnostics::new()).expect("a word").equations;
        assert_eq!(word(&equations), letters);
    }
    let turning = machines().into_iter().find(|one| one.machine == "nist-turning-center").expect("shipped");
    assert_eq!(word(&turning), "FZX", "the spindle carries the part and is no axis");
}

#[test]
fn branches_stand_side_by_side() {
    for equations in machines() {
        for (link, (_, own, _)) in equations.links.iter().zip(cards(&equations)) {
            let rect = own.split("<rect").nth(1).expect("a card");
            let left: f64 = attribute(rect, "x").parse().expect("a number");
            assert_eq!(
                left < super::CARD,
                link.branch == Branch::Workpiece,
                "{} {}",
                equations.machine,
                link.id
            );
        }
        let parts = equations.links.iter().filter(|link| link.kind == LinkKind::Part).count();
        let named = drawing(&equations, Names::Iso).inline().matches(">part</text>").count();
        assert_eq!(parts + named, 1, "{}: one part, as a link or by itself", equations.machine);
    }
}

#[test]
fn lines_keep_every_letter() {
    assert_eq!(broken("[X1, 0, Z1]", 25), ["[X1, 0, Z1]"]);
    assert_eq!(broken("[long_one, other, Z1]", 10), ["[long_one,", "other, Z1]"]);
    assert_eq!(broken("abcdefgh", 3), ["abc", "def", "gh"]);
}
