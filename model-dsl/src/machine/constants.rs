//! The named offsets of a machine. In: the `constants` of the file, where it has them, and
//! the names that the chain uses. Out: one list; an undefined or unused name is an error.

use super::draft::Chain;
use super::fields::items;
use super::words::is_name;
use crate::algebra::{Axis, Name, Symbol, decimal};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::quantity::{Dimension, parse_quantity};
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::{Node, NodeKind};

/// A named offset.
#[derive(Clone, Debug)]
pub struct Constant {
    /// The name, as written.
    pub name: Name,
    /// What it means, where the file says so.
    pub meaning: Option<String>,
    /// The value that a calibration may leave out, where the file gives one: mm, or the part of a direction.
    pub default: Option<f64>,
    /// Of a part of the tool's direction, a pure number, which part it is; none of an offset.
    pub direction: Option<Axis>,
    /// Where it was declared or first used.
    pub span: Span,
}

/// What the file's `constants` say.
pub(super) enum Declared {
    /// The file has no such key: every name that the chain uses is a constant.
    None,
    /// The declared constants; the chain may use these and must use all of them.
    Listed(Vec<Constant>),
}

/// Reads the `constants` of a machine file: a list of names, or a map from names to a meaning or a length.
pub(super) fn declared(node: Option<&Node>, diagnostics: &mut Diagnostics) -> Declared {
    let Some(node) = node else { return Declared::None };
    let mut listed: Vec<Constant> = Vec::new();
    if let NodeKind::Mapping(entries) = &node.kind {
        listed.extend(entries.iter().filter_map(|(key, value)| entry(key, value, diagnostics)));
    } else {
        for item in items(node, "`constants`", diagnostics).unwrap_or_default() {
            let Some(name) = super::fields::text(item, "a constant's name", diagnostics) else { continue };
            let name = Spanned::new(name.to_owned(), item.span);
            match listed.iter().find(|known| *known.name == *name.value) {
                Some(first) => diagnostics.push(
                    Diagnostic::error(
                        "E0130",
                        item.span,
                        format!("constant `{}` is declared twice", name.value),
                    )
                    .label("again here")
                    .also(first.span, "first here")
                    .help("declare each constant once"),
                ),
                None => listed.extend(named(&name, diagnostics)),
            }
        }
    }
    Declared::Listed(listed)
}

fn named(name: &Spanned<String>, diagnostics: &mut Diagnostics) -> Option<Constant> {
    if is_name(&name.value) {
        return Some(Constant {
            name: name.value.as_str().into(),
            meaning: None,
            default: None,
            direction: None,
            span: name.span,
        });
    }
    diagnostics.push(
        Diagnostic::error("E0131", name.span, format!("`{}` cannot name a constant", name.value))
            .label("not a name")
            .help("begin with a letter, followed by letters, digits and `_`"),
    );
    None
}

fn entry(key: &Spanned<String>, value: &Node, diagnostics: &mut Diagnostics) -> Option<Constant> {
    let mut constant = named(key, diagnostics)?;
    match &value.kind {
        NodeKind::Null => {}
        NodeKind::Scalar(scalar) if decimal(&scalar.text).is_some() => {
            diagnostics.push(
                Diagnostic::error("E0132", value.span, format!("`{}` has no unit", scalar.text))
                    .label("a length needs its unit")
                    .help(format!("write `{} mm`", scalar.text)),
            );
        }
        NodeKind::Scalar(scalar) => match parse_quantity(&scalar.text) {
            Ok(quantity) if quantity.dimension == Dimension::LENGTH => {
                constant.default = Some(quantity.value)
            }
            Ok(_) => diagnostics.push(
                Diagnostic::error("E0132", value.span, format!("`{}` is not a length", scalar.text))
                    .label("a constant of a machine must be a length")
                    .help("give it a unit of length, such as `250 mm`"),
            ),
            Err(_) => constant.meaning = Some(scalar.text.clone()),
        },
        _ => {
            super::fields::text(value, "a constant's meaning or length", diagnostics);
        }
    }
    Some(constant)
}

/// Joins what is declared and what is used; reports what is only one of the two.
pub(super) fn settle(declared: Declared, chain: &Chain, diagnostics: &mut Diagnostics) -> Vec<Constant> {
    let mut used = used_names(chain);
    let Declared::Listed(listed) = declared else {
        return used
            .into_iter()
            .map(|(name, span)| Constant { name, meaning: None, default: None, direction: None, span })
            .collect();
    };
    let parts = chain.links.iter().filter_map(|drafted| drafted.direction.as_ref()).flatten();
    used.extend(parts.map(|part| (part.value.clone(), part.span)));
    // An offset that could not be read hides the names in it; a misspelt name hides the right one.
    let unreadable = diagnostics.iter().any(|known| matches!(known.code, "E0117" | "E0118"));
    let mut meant: Vec<Name> = Vec::new();
    for (name, span) in &used {
        if !listed.iter().any(|constant| constant.name == *name) {
            let near = nearest(name, listed.iter().map(|constant| &*constant.name)).map(Name::from);
            diagnostics.push(undefined(name, *span, near.as_deref()));
            meant.extend(near);
        }
    }
    for constant in &listed {
        let is_used = used.iter().any(|(name, _)| *name == constant.name);
        if !is_used && !unreadable && !meant.contains(&constant.name) {
            diagnostics.push(
                Diagnostic::error(
                    "E0134",
                    constant.span,
                    format!("constant `{}` is never used", constant.name),
                )
                .label("no offset of the chain mentions it")
                .help("remove it, or use it in an `origin` or `offset`"),
            );
        }
    }
    listed
}

fn undefined(name: &Name, span: Span, near: Option<&str>) -> Diagnostic {
    let error = Diagnostic::error("E0133", span, format!("constant `{name}` is not defined"))
        .label("`constants` does not list it");
    match near {
        Some(known) => error.help(format!("did you mean `{known}`?")),
        None => error.help(format!("add `{name}` to `constants`")),
    }
}

fn used_names(chain: &Chain) -> Vec<(Name, Span)> {
    let mut used: Vec<(Name, Span)> = Vec::new();
    for drafted in &chain.links {
        for (offset, span) in drafted.link.origin.iter().zip(&drafted.origin_spans) {
            for symbol in offset.symbols() {
                if let Symbol::Constant(name) = symbol
                    && !used.iter().any(|(known, _)| *known == name)
                {
                    used.push((name, *span));
                }
            }
        }
    }
    used
}
