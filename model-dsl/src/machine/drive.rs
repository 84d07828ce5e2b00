//! What turns or repeats between the motor of an axis and its carriage. In: the `drive` of a machine file. Out: for each
//! axis that it names the elements of its drive and the travel after which each repeats, by which a diagnosis knows a wave
//! again. No equation and no generated code depends on them.

use std::f64::consts::TAU;

use super::draft::Chain;
use super::fields::{self, keys};
use super::motor::Motor;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::quantity::{self, Dimension};
use crate::source::Spanned;
use crate::yaml::Node;

/// The elements of the drive of one axis.
#[derive(Clone, Debug)]
pub struct Drive {
    /// The letter of the axis or the name of the motor, and where the file names it.
    pub axis: Spanned<String>,
    /// Its elements: the screw or the worm, the motor, the scale or the encoder.
    pub elements: Vec<Element>,
}

/// An element of a drive that does the same again after a stretch of travel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Element {
    /// What it is.
    pub kind: ElementKind,
    /// The travel of the axis for one turn of it, or from line to line: mm, or rad of a rotary axis; above zero.
    pub period: f64,
}

/// What an element of a drive is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ElementKind {
    /// A rotary axis itself, which is there without any `drive`.
    Axis,
    /// The screw of a slide.
    Screw,
    /// The worm that turns a wheel of so many teeth, one for each turn.
    Worm {
        /// The teeth of the wheel.
        teeth: u32,
    },
    /// The motor.
    Motor,
    /// The lines of a linear scale.
    Scale,
    /// The lines of an encoder on a rotary axis.
    Encoder {
        /// The lines of one turn of the axis.
        lines: u32,
    },
}

impl ElementKind {
    /// One word for it: `screw`, `worm`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Axis => "axis",
            Self::Screw => "screw",
            Self::Worm { .. } => "worm",
            Self::Motor => "motor",
            Self::Scale => "scale",
            Self::Encoder { .. } => "encoder",
        }
    }
}

/// Reads the `drive` of a machine file; every mistake in it is reported.
pub(super) fn read(node: Option<&Node>, motors: &[Motor], diagnostics: &mut Diagnostics) -> Vec<Drive> {
    let Some(node) = node else { return Vec::new() };
    let Some(entries) = node.entries() else {
        let message = format!("`drive` must be a mapping of axes, found {}", node.kind_name());
        diagnostics
            .push(Diagnostic::error("E0103", node.span, message).help("write `drive: {X: {pitch: 10 mm}}`"));
        return Vec::new();
    };
    entries.iter().filter_map(|(key, value)| of_axis(key, value, motors, diagnostics)).collect()
}

/// Reports the axes that no link of the chain is, and no motor.
pub(super) fn settle(drives: &[Drive], chain: &Chain<'_>, motors: &[Motor], diagnostics: &mut Diagnostics) {
    let letters = chain.links.iter().filter_map(|drafted| drafted.link.kind.letter());
    let motors = motors.iter().map(|motor| motor.name.value.clone());
    let letters: Vec<String> = letters.map(String::from).chain(motors).collect();
    for Drive { axis, .. } in drives.iter().filter(|drive| !letters.contains(&drive.axis.value)) {
        diagnostics.push(
            Diagnostic::error("E0144", axis.span, format!("the chain has no axis {}", axis.value))
                .label("its drive is described here")
                .help(format!("the axes of this machine are {}", letters.join(", "))),
        );
    }
}

fn of_axis(
    key: &Spanned<String>,
    value: &Node,
    motors: &[Motor],
    diagnostics: &mut Diagnostics,
) -> Option<Drive> {
    let letter = key.value.as_str();
    let elements = match letter {
        motor if motors.iter().any(|known| known.name.value == motor) => of_slide(motor, value, diagnostics)?,
        "X" | "Y" | "Z" | "U" | "V" | "W" => of_slide(letter, value, diagnostics)?,
        "A" | "B" | "C" => of_rotary_axis(letter, value, diagnostics)?,
        // No chain has such an axis, which is told where the chain is known.
        _ => Vec::new(),
    };
    Some(Drive { axis: key.clone(), elements })
}

fn of_slide(letter: &str, node: &Node, diagnostics: &mut Diagnostics) -> Option<Vec<Element>> {
    let what = format!("the drive of the slide {letter}");
    let fields = fields::open(node, &what, &["pitch", "ratio", "grating"], diagnostics)?;
    let pitch = fields.get("pitch").and_then(|node| length(node, "the pitch", diagnostics));
    let ratio = fields.get("ratio").and_then(|node| ratio(node, diagnostics));
    let grating = fields.get("grating").and_then(|node| length(node, "the grating", diagnostics));
    if fields.get("ratio").is_some() {
        let what = format!("{what}, which has a `ratio`,");
        fields.need("pitch", keys(&what), diagnostics);
    }
    let screw = pitch.map(|period| Element { kind: ElementKind::Screw, period });
    let motor = screw.zip(ratio).map(|(screw, ratio)| motor(screw.period, ratio));
    let scale = grating.map(|period| Element { kind: ElementKind::Scale, period });
    Some([screw, motor, scale].into_iter().flatten().collect())
}

fn of_rotary_axis(letter: &str, node: &Node, diagnostics: &mut Diagnostics) -> Option<Vec<Element>> {
    let what = format!("the drive of the rotary axis {letter}");
    let fields = fields::open(node, &what, &["teeth", "ratio", "lines"], diagnostics)?;
    let teeth = fields.get("teeth").and_then(|node| count(node, "the number of teeth", diagnostics));
    let ratio = fields.get("ratio").and_then(|node| ratio(node, diagnostics));
    let lines = fields.get("lines").and_then(|node| count(node, "the number of lines", diagnostics));
    let part_of_a_turn = |count: u32| TAU / f64::from(count);
    let worm =
        teeth.map(|teeth| Element { kind: ElementKind::Worm { teeth }, period: part_of_a_turn(teeth) });
    // Without a worm the motor turns the axis itself.
    let motor = ratio.map(|ratio| motor(worm.map_or(TAU, |worm| worm.period), ratio));
    let encoder =
        lines.map(|lines| Element { kind: ElementKind::Encoder { lines }, period: part_of_a_turn(lines) });
    Some([worm, motor, encoder].into_iter().flatten().collect())
}

/// A motor that turns `ratio` times while what it drives turns once, over the travel `driven`.
fn motor(driven: f64, ratio: f64) -> Element {
    Element { kind: ElementKind::Motor, period: driven / ratio }
}

/// The shortest and the longest stretch that something can repeat in, mm: a nanometre, and more than any machine's travel.
const LENGTHS: (f64, f64) = (1e-6, 1e6);
/// The least and the greatest ratio of a gear train: beyond them a slip of the pen.
const RATIOS: (f64, f64) = (1e-6, 1e6);
/// The most teeth or lines of a turn: more than any wheel or encoder has.
const MOST: u32 = 100_000_000;

fn length(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
    let length = quantity::read(node, Dimension::LENGTH, what, diagnostics)?;
    let (least, most) = LENGTHS;
    let sound = (least..=most).contains(&length.value);
    let must = format!("{what} must be a length from 1 nm to 1 km");
    checked(length, sound, must, "write the value from the catalogue, such as `10 mm`", diagnostics)
}

fn ratio(node: &Node, diagnostics: &mut Diagnostics) -> Option<f64> {
    let ratio = quantity::read_number(node, "the ratio", diagnostics)?;
    let (least, most) = RATIOS;
    let sound = (least..=most).contains(&ratio.value);
    let must = format!("the ratio must be a number from {least} to {most}");
    checked(ratio, sound, must, "write the turns of the motor per turn of the driven part", diagnostics)
}

fn count(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<u32> {
    let number = quantity::read_number(node, what, diagnostics)?;
    let sound = number.value.fract() == 0.0 && (1.0..=f64::from(MOST)).contains(&number.value);
    let must = format!("{what} must be a whole number from 1 to {MOST}");
    let number =
        checked(number, sound, must, "write the number in one full turn, such as `180`", diagnostics)?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be a whole number from 1 to MOST"
    )]
    let count = number as u32;
    Some(count)
}

/// The value where it is sound; else a finding that tells what it `must` be.
fn checked(
    value: Spanned<f64>,
    sound: bool,
    must: String,
    help: &str,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    if !sound {
        diagnostics.push(Diagnostic::error("E0145", value.span, must).label("not possible").help(help));
    }
    sound.then_some(value.value)
}

#[cfg(test)]
mod tests {
    use crate::codegen;
    use crate::compile;
    use crate::diagnostic::{Diagnostics, render};
    use crate::equations::{Equations, Names};
    use crate::machine::ElementKind::{self, Axis, Encoder, Motor, Scale, Screw, Worm};
    use crate::sheet::{Sheet, json, text};
    use crate::source::SourceFile;

    /// The equations of a mill with a table, and with this block of `drive`.
    fn equations(drive: &str) -> Equations {
        let source = SourceFile::new("mill.yaml", format!("abbe: 1\nname: mill\ntopology: CXFY\n{drive}"));
        let mut findings = Diagnostics::new();
        let compiled = compile(&source, &mut findings);
        compiled.unwrap_or_else(|| panic!("{}", render(&source, &findings, false))).equations
    }

    /// Whether an axis has these elements with these periods, mm or deg, and no others.
    #[track_caller]
    fn holds(equations: &Equations, letter: &str, expected: &[(ElementKind, f64)]) {
        let axis = equations.axes.iter().find(|axis| axis.letter == letter).unwrap();
        let told = |period: f64| if axis.rotary { period.to_degrees() } else { period };
        assert_eq!(axis.elements.len(), expected.len(), "{letter}: {:?}", axis.elements);
        for (element, (kind, period)) in axis.elements.iter().zip(expected) {
            assert_eq!(element.kind, *kind, "{letter}");
            assert!((told(element.period) / period - 1.0).abs() < 1e-12, "{letter} {element:?}");
        }
    }

    #[test]
    fn each_element_repeats_after_its_own_turn() {
        let drive = "drive:\n  X: {pitch: 10 mm, ratio: 2.5, grating: 20 um}\n  Y: {grating: 0.001 in}\n  \
            C: {teeth: 180, ratio: 4, lines: 18000}\n";
        let all = equations(drive);
        // Ten mm a turn of the screw are four a turn of the motor; 360 / 180, a quarter of it, 360 / 18000.
        holds(&all, "X", &[(Screw, 10.0), (Motor, 4.0), (Scale, 0.02)]);
        holds(&all, "Y", &[(Scale, 0.0254)]);
        let worm = (Worm { teeth: 180 }, 2.0);
        holds(&all, "C", &[(Axis, 360.0), worm, (Motor, 0.5), (Encoder { lines: 18_000 }, 0.02)]);
    }

    #[test]
    fn a_rotary_axis_is_an_element_itself_and_a_motor_without_a_worm_turns_it() {
        let bare = equations("");
        holds(&bare, "X", &[]);
        holds(&bare, "C", &[(Axis, 360.0)]);
        holds(&equations("drive: {C: {ratio: 100}, X: {}}"), "C", &[(Axis, 360.0), (Motor, 3.6)]);
    }

    /// A drive tells a diagnosis what repeats; the errors are the same and so is the code.
    #[test]
    fn equations_and_code_do_not_depend_on_it() {
        let (bare, driven) =
            (equations(""), equations("drive: {X: {pitch: 10 mm, ratio: 2}, C: {teeth: 90}}"));
        let page = |equations| text::page(&Sheet::new(equations, Names::Iso));
        assert_eq!(page(&bare), page(&driven));
        assert_eq!(json::object(&bare), json::object(&driven));
        assert_eq!(codegen::tokens(&bare).to_string(), codegen::tokens(&driven).to_string());
    }
}
