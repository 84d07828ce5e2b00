//! LinuxCNC's table of tools (`tool.tbl`). In: a machine with the numbers of its spindle without a tool, and the file. Out: for each tool
//! the constants of the machine with it.
//!
//! Facts: LinuxCNC, `docs/src/gcode/tool-compensation.adoc`: a line is a tool, `T` its number, `X` to `W` its offsets in machine units,
//! `;` begins a comment. With `G43` the controlled point is the position of the machine less the offset: a tool that is longer by Z has
//! its tip lower by Z. So a coordinate of the tip in the frame of the tool's link is less by the offset of its letter.

use model_dsl::algebra::{Axis, Name, Polynomial, Symbol};
use model_dsl::calibration::{Calibration, Tool};
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::machine::LinkKind;
use model_dsl::source::{SourceFile, Spanned};

use super::lines::{Line, lines};
use super::options::Unit;

/// The form of a line, for findings.
const FORM: &str = "a line is such as `T12 P3 X0 Z+152.3 D8 ;end mill`";

/// The constant that moves the tip along a direction, and by how much for each mm of it.
struct Lever {
    constant: usize,
    factor: f64,
}

/// The tools of a file, each as the machine's constants with it.
///
/// Findings: E0801 no number, E0802 a line of another form, E0803 a tool that stands twice, E0804 an offset for which the machine has no
/// constant.
pub fn tool_table(
    equations: &Equations,
    calibration: &Calibration,
    source: &SourceFile,
    unit: Unit,
    diagnostics: &mut Diagnostics,
) -> Vec<Tool> {
    let levers = Axis::ALL.map(|direction| lever(equations, direction));
    let mut tools: Vec<Tool> = Vec::new();
    for line in lines(source, ";") {
        let Some(tool) = read(line, &levers, calibration, unit, diagnostics) else { continue };
        if tools.iter().any(|known| known.name.value == tool.name.value) {
            let message = format!("the tool {} occurs twice", tool.name.value);
            let mistake = Diagnostic::error("E0803", tool.name.span, message);
            diagnostics.push(mistake.help("leave one of them out; LinuxCNC uses only one"));
        } else {
            tools.push(tool);
        }
    }
    tools
}

/// One tool; none where its line has no number of a tool, which is told.
fn read(
    line: Line<'_>,
    levers: &[Option<Lever>; 3],
    calibration: &Calibration,
    unit: Unit,
    diagnostics: &mut Diagnostics,
) -> Option<Tool> {
    let mut constants = calibration.constants.clone();
    let mut name = None;
    for word in line.words() {
        let (letter, number) = word.text.split_at_checked(1).unwrap_or((word.text, ""));
        let number = word.part(number);
        match letter.to_ascii_uppercase().as_str() {
            "T" => match number.text.parse::<u32>() {
                Ok(tool) => name = Some(Spanned::new(format!("T{tool}"), word.span)),
                Err(_) => word.malformed(FORM, diagnostics),
            },
            // The pocket, the diameter, the angles of a lathe's edge and its kind: none of them moves the tip.
            "P" | "D" | "I" | "J" | "Q" => _ = number.number(diagnostics),
            "X" | "Y" | "Z" => {
                let lever = levers
                    .iter()
                    .zip("XYZ".chars())
                    .find(|(_, own)| letter.eq_ignore_ascii_case(&own.to_string()));
                let offset = number.number(diagnostics)? * unit.0;
                offset_tip(
                    word,
                    offset,
                    lever.and_then(|(lever, _)| lever.as_ref()),
                    &mut constants,
                    diagnostics,
                );
            }
            "A" | "B" | "C" | "U" | "V" | "W" => {
                let offset = number.number(diagnostics)?;
                offset_tip(word, offset, None, &mut constants, diagnostics);
            }
            _ => word.malformed(FORM, diagnostics),
        }
    }
    if name.is_none() {
        line.malformed(FORM, diagnostics);
    }
    Some(Tool { name: name?, constants })
}

/// Moves the tip back by an offset; one that is zero needs no constant.
fn offset_tip(
    word: Line<'_>,
    offset: f64,
    lever: Option<&Lever>,
    constants: &mut [f64],
    diagnostics: &mut Diagnostics,
) {
    if offset == 0.0 {
        return;
    }
    match lever.and_then(|lever| Some((constants.get_mut(lever.constant)?, lever.factor))) {
        Some((constant, factor)) => *constant -= offset / factor,
        None => {
            let message = format!("no constant of the machine corresponds to the offset `{}`", word.text);
            let mistake = Diagnostic::error("E0804", word.span, message);
            diagnostics
                .push(mistake.help("give it its own constant in the `offset` of the machine file's `tool`"));
        }
    }
}

/// The constant that moves the tip alone along a direction: the only one in that coordinate of the tool's offset, and nowhere else.
fn lever(equations: &Equations, direction: Axis) -> Option<Lever> {
    let is_tool = |kind: LinkKind| kind == LinkKind::Tool;
    let tool = equations.links.iter().find(|link| is_tool(link.kind))?;
    let own = tool.origin.get(direction.index())?;
    let mut names = own.symbols().into_iter().filter_map(constant_of);
    let (name, None) = (names.next()?, names.next()) else { return None };
    let others = equations.links.iter().flat_map(|link| {
        let all = link.origin.iter().enumerate();
        all.filter(move |(place, _)| !(is_tool(link.kind) && *place == direction.index()))
    });
    let mut others = others.flat_map(|(_, origin)| origin.symbols());
    if others.any(|symbol| symbol == Symbol::Constant(name.clone())) {
        return None;
    }
    let constant = equations.constants.iter().position(|constant| constant.name == name)?;
    Some(Lever { constant, factor: factor(own, &name) }).filter(|lever| lever.factor != 0.0)
}

fn constant_of(symbol: Symbol) -> Option<Name> {
    match symbol {
        Symbol::Constant(name) => Some(name),
        _ => None,
    }
}

/// The factor of a constant in a sum of lengths.
fn factor(sum: &Polynomial, name: &Name) -> f64 {
    sum.derivative(&Symbol::Constant(name.clone())).evaluate(|_| 0.0)
}
