//! From statements to printed equations. In: the sections of a file. Out: each equation with its target and
//! its right side as a canonical polynomial. Every mistake is reported, each name once in an expression.

use super::Target;
use super::syntax::{self, Statement};
use super::vocabulary::Vocabulary;
use crate::algebra::{Axis, Polynomial, Symbol};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::equations::Equations;
use crate::expression::parse_within;
use crate::machine::Machine;
use crate::source::{SourceFile, Span, Spanned};
use crate::suggest::nearest;

/// Files larger than this many bytes are refused (E0003): what is printed in a book is a few pages.
const MOST_BYTES: usize = 256 * 1024;

/// How much work reading all expressions of a file may take: see [`parse_within`].
const MOST_WORK: usize = 100_000;

/// The most unknown names that are told of one expression.
const MOST_UNKNOWN: usize = 20;

/// An equation as printed.
#[derive(Clone, Debug)]
pub(super) struct Printed {
    /// The left side.
    pub(super) left: Spanned<String>,
    /// What it is about.
    pub(super) target: Target,
    /// The right side.
    pub(super) value: Polynomial,
}

/// The equations under one header.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// The header's words.
    pub(super) name: Option<String>,
    /// Whether motions that occur nowhere in it were left out by its authors.
    pub(super) selection: bool,
    /// In the file's order.
    pub(super) equations: Vec<Printed>,
}

/// What a header says.
struct Kind {
    selection: bool,
    link: Option<usize>,
}

/// Reads all sections; `None` where there is a mistake.
pub(super) fn sections(
    machine: &Machine,
    equations: &Equations,
    file: &SourceFile,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Section>> {
    let mut found = Diagnostics::new();
    if file.text().len() > MOST_BYTES {
        let message = format!("this file is larger than {} KiB", MOST_BYTES / 1024);
        let help = "write only the equations of one machine that you want to compare";
        diagnostics.push(Diagnostic::error("E0003", Span::default(), message).help(help));
        return None;
    }
    let mut work = MOST_WORK;
    let read: Vec<Section> = syntax::read(file, &mut found)
        .iter()
        .filter_map(|section| read_section(section, machine, equations, &mut work, &mut found))
        .collect();
    if !found.has_errors() && read.iter().all(|section| section.equations.is_empty()) {
        found.push(
            Diagnostic::error("E0507", Span::default(), "this file has no equations")
                .label("nothing to compare")
                .help("write one line `Px = expression` for each equation"),
        );
    }
    let good = !found.has_errors();
    diagnostics.extend(found);
    good.then_some(read)
}

fn read_section(
    section: &syntax::Section,
    machine: &Machine,
    equations: &Equations,
    work: &mut usize,
    diagnostics: &mut Diagnostics,
) -> Option<Section> {
    let kind = kind(section.name.as_ref(), machine, diagnostics)?;
    let mut vocabulary = Vocabulary::new(machine);
    let mut printed: Vec<Printed> = Vec::new();
    for statement in &section.statements {
        match statement {
            Statement::Let(letter, value) => give(&mut vocabulary, letter, value, work, diagnostics),
            Statement::Equation(left, right) => {
                let target = target(left, kind.link, equations, diagnostics);
                let value = value(right, target.as_ref(), &vocabulary, work, diagnostics);
                if let (Some(target), Some(value)) = (target, value) {
                    add(&mut printed, Printed { left: left.clone(), target, value }, diagnostics);
                }
            }
        }
    }
    let name = section.name.as_ref().map(|name| name.value.clone());
    Some(Section { name, selection: kind.selection, equations: printed })
}

fn add(printed: &mut Vec<Printed>, equation: Printed, diagnostics: &mut Diagnostics) {
    match printed.iter().find(|known| known.target == equation.target) {
        Some(first) => diagnostics.push(
            Diagnostic::error(
                "E0506",
                equation.left.span,
                format!("`{}` is printed twice", equation.left.value),
            )
            .label("again here")
            .also(first.left.span, "first here")
            .help("remove one of them, or move it to another section"),
        ),
        None => printed.push(equation),
    }
}

fn kind(name: Option<&Spanned<String>>, machine: &Machine, diagnostics: &mut Diagnostics) -> Option<Kind> {
    let Some(name) = name else { return Some(Kind { selection: false, link: None }) };
    let words: Vec<&str> = name.value.split(' ').collect();
    match words.as_slice() {
        ["carriage", id] => {
            Some(Kind { selection: false, link: Some(link(id, name, machine, diagnostics)?) })
        }
        ["carriage", id, "significant"] => {
            Some(Kind { selection: true, link: Some(link(id, name, machine, diagnostics)?) })
        }
        ["carriage", ..] => {
            diagnostics.push(
                Diagnostic::error("E0508", name.span, "this section names no carriage")
                    .label("expected one link after `carriage`")
                    .help("write `[carriage X]` or `[carriage X significant]`"),
            );
            None
        }
        words => Some(Kind { selection: words.last() == Some(&"significant"), link: None }),
    }
}

fn link(id: &str, name: &Spanned<String>, machine: &Machine, diagnostics: &mut Diagnostics) -> Option<usize> {
    let found = machine.links.iter().position(|link| link.id == id);
    if found.is_none() {
        let ids: Vec<&str> = machine.links.iter().map(|link| link.id.as_str()).collect();
        let error = Diagnostic::error("E0508", name.span, format!("the machine has no link `{id}`"));
        let error = error.label("not a link of this machine");
        diagnostics.push(match nearest(id, ids.iter().copied()) {
            Some(near) => error.suggest(Some(near)),
            None => error.help(format!("links of {}: {}", machine.name, ids.join(", "))),
        });
    }
    found
}

fn give(
    vocabulary: &mut Vocabulary<'_>,
    letter: &Spanned<String>,
    expression: &Spanned<String>,
    work: &mut usize,
    diagnostics: &mut Diagnostics,
) {
    let name = letter.value.as_str();
    let shaped = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && !["sin", "cos"].contains(&name);
    if !shaped || vocabulary.has_letter(name) {
        let problem = if shaped { "is given twice in this section" } else { "cannot be a letter" };
        diagnostics.push(
            Diagnostic::error("E0509", letter.span, format!("`{name}` {problem}"))
                .label("not a new name")
                .help("write `let gamma = -EAX`, or `let L = Z1 + z`"),
        );
    } else {
        // What cannot be read has been told: the letter is known, so that it is told once.
        let value = value(expression, None, vocabulary, work, diagnostics).unwrap_or_default();
        vocabulary.give(name, value);
    }
}

fn target(
    left: &Spanned<String>,
    link: Option<usize>,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) -> Option<Target> {
    let found = direction(&left.value).or_else(|| entry(&left.value, link));
    let problem = match (&found, link) {
        (Some(Target::Entry { .. }), Some(_)) => return found,
        (Some(Target::Direction(axis) | Target::DirectionError(axis)), None) => {
            if equations.orientation_row(*axis).is_some() {
                return found;
            }
            diagnostics.push(no_direction(left, equations));
            return None;
        }
        (Some(Target::Position(axis) | Target::Error(axis)), None) => {
            if equations.row(*axis).is_some() {
                return found;
            }
            diagnostics.push(insensitive(*axis, left, equations));
            return None;
        }
        (_, Some(_)) => {
            ("E0510", "is not an entry of a matrix", "write `T(2,3) = expression`, with numbers from 1 to 4")
        }
        (_, None) => (
            "E0502",
            "cannot be the left side of an equation",
            "write `Px` for position and error, `dPx` or `Ex` for the error alone, `I` or `dI` for the direction of the tool; put `T(i,j)` under `[carriage X]`",
        ),
    };
    let (code, what, help) = problem;
    diagnostics.push(
        Diagnostic::error(code, left.span, format!("`{}` {what}", left.value))
            .label("not expected here")
            .help(help),
    );
    None
}

fn insensitive(axis: Axis, left: &Spanned<String>, equations: &Equations) -> Diagnostic {
    let derived: Vec<String> = equations.rows.iter().map(|row| row.direction.to_string()).collect();
    Diagnostic::error("E0505", left.span, format!("{} has no derived equation in {axis}", equations.machine))
        .label("the machine file does not call this direction sensitive")
        .help(format!("sensitive directions: {}", derived.join(", ")))
}

fn no_direction(left: &Spanned<String>, equations: &Equations) -> Diagnostic {
    let message = format!("{} has no derived direction of the tool", equations.machine);
    Diagnostic::error("E0505", left.span, message)
        .label("the machine file does not request it")
        .help("write `orientation: true` in the machine file, or remove the equation")
}

/// `Px`, `dPx` or `Ex`, the direction in either case; `I` or `dI`.
fn direction(left: &str) -> Option<Target> {
    of_tool(left).or_else(|| of_tip(left))
}

/// `I`, `J` or `K`, or the error of it.
fn of_tool(left: &str) -> Option<Target> {
    let (make, letter): (fn(Axis) -> Target, _) = match left.strip_prefix('d') {
        Some(letter) => (Target::DirectionError, letter),
        None => (Target::Direction, left),
    };
    Axis::ALL.into_iter().find(|axis| axis.direction_letter().to_string() == letter).map(make)
}

fn of_tip(left: &str) -> Option<Target> {
    let axis = match left.chars().last()?.to_ascii_lowercase() {
        'x' => Axis::X,
        'y' => Axis::Y,
        'z' => Axis::Z,
        _ => return None,
    };
    match left.get(..left.len() - 1)? {
        "P" => Some(Target::Position(axis)),
        "dP" | "E" => Some(Target::Error(axis)),
        _ => None,
    }
}

/// `T(i,j)`; outside of a carriage's section it is recognised too, to be refused by name.
fn entry(left: &str, link: Option<usize>) -> Option<Target> {
    let inner = left.strip_prefix('T')?.trim_start().strip_prefix('(')?.strip_suffix(')')?;
    let (row, column) = inner.split_once(',')?;
    let number = |text: &str| text.trim().parse::<usize>().ok().filter(|number| (1..=4).contains(number));
    Some(Target::Entry { link: link?, row: number(row)?, column: number(column)? })
}

/// The symbol that stands for the whole error, where `Px` is printed as `... + dPx`, or `I` as `... + dI`.
pub(super) const WHOLE_ERROR: &str = "dP";

/// `dPx` or `Ex` in the equation of `Px`, `dI` in that of `I`: the error is printed in an equation of its own.
fn whole_error(name: &str, target: Option<&Target>) -> Option<Symbol> {
    let error = match target? {
        Target::Position(axis) => Target::Error(*axis),
        Target::Direction(axis) => Target::DirectionError(*axis),
        _ => return None,
    };
    (direction(name) == Some(error)).then(|| Symbol::Motion(WHOLE_ERROR.into()))
}

/// Reads a right side. After an unknown name the rest is read again without asking for that name.
fn value(
    right: &Spanned<String>,
    target: Option<&Target>,
    vocabulary: &Vocabulary<'_>,
    work: &mut usize,
    diagnostics: &mut Diagnostics,
) -> Option<Polynomial> {
    let mut told: Vec<String> = Vec::new();
    loop {
        let mut unknown: Option<String> = None;
        let mut resolve = |name: &str| {
            if told.iter().any(|known| known == name) {
                return Some(Symbol::Constant(name.into()));
            }
            let symbol = vocabulary.resolve(name).or_else(|| whole_error(name, target));
            if symbol.is_none() {
                unknown = Some(name.to_owned());
            }
            symbol
        };
        let error = match parse_within(&right.value, &mut resolve, work) {
            Ok(_) if !told.is_empty() => return None,
            Ok(value) => {
                let settled = vocabulary.settle(&value, work);
                if settled.is_none() {
                    diagnostics.push(
                        Diagnostic::error("E0503", right.span, "the expression expands to too many terms")
                            .label("with the letters written out"),
                    );
                }
                return settled;
            }
            Err(error) => error,
        };
        let span = Span::new(right.span.start + error.start, right.span.start + error.end);
        let Some(name) = unknown else {
            if told.is_empty() {
                diagnostics.push(
                    Diagnostic::error("E0503", span, error.message).label("the expression is not valid here"),
                );
            }
            return None;
        };
        let unknown = Diagnostic::error("E0504", span, format!("`{name}` is unknown here"));
        diagnostics.push(match vocabulary.miscounted(&name) {
            Some(reason) => {
                unknown.label(reason).help("write the alignment error without an axis, or the sum")
            }
            None => unknown
                .label("not an error motion, position, constant or travel of the machine")
                .suggest(vocabulary.nearest(&name)),
        });
        told.push(name);
        if told.len() == MOST_UNKNOWN {
            return None;
        }
    }
}
