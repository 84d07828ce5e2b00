//! How the table of data is written, where it is not told by the file itself.
//!
//! In: the value of `data`, a path or a mapping. Out: the path and a [`Form`]; or findings E0603, E0604, E0630.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::fields::Fields;
use model_dsl::source::{Span, Spanned};
use model_dsl::yaml::Node;

use super::words::{FORM, keys, near_or_all, word};

/// How a table is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Form {
    /// What stands between the cells; told by the header row where it is not given.
    pub separator: Option<Separator>,
    /// Where the names of the columns stand.
    pub names: Names,
    /// Whether a comma is the decimal sign.
    pub decimal_comma: bool,
    /// The sheet of a workbook; the first one where it is not given.
    pub sheet: Option<String>,
    /// Where the recording file has the keys that say so.
    pub given: Vec<Spanned<&'static str>>,
}

/// What stands between the cells of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// A comma.
    Comma,
    /// A semicolon.
    Semicolon,
    /// A tab.
    Tab,
    /// Any number of spaces and tabs.
    Spaces,
}

/// Where the names of the columns stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Names {
    /// In the first row that is neither empty nor a comment.
    #[default]
    FirstRow,
    /// In the line of a text, or the row of a sheet, with this number, counted from 1.
    Line(u64),
    /// Nowhere: columns are numbered from 1.
    Nowhere,
}

impl Separator {
    /// All of them.
    const ALL: [Self; 4] = [Self::Comma, Self::Semicolon, Self::Tab, Self::Spaces];

    /// The name in recording files.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Comma => "comma",
            Self::Semicolon => "semicolon",
            Self::Tab => "tab",
            Self::Spaces => "spaces",
        }
    }
}

impl Form {
    /// The first key that says how a text is written, where one is given.
    pub(super) fn of_text(&self) -> Option<&'static str> {
        let given = [("separator", self.separator.is_some()), ("decimal", self.decimal_comma)];
        given.into_iter().find(|(_, given)| *given).map(|(key, _)| key)
    }

    /// The code of a key that does not suit the table, and where the recording file has it.
    pub(super) fn unsuited(&self, key: &str) -> Option<(&'static str, Span)> {
        let found = self.given.iter().find(|given| given.value == key);
        found.map(|given| (UNKNOWN_VALUE, given.span))
    }
}

/// The code for a value that is unknown, or does not suit the table.
const UNKNOWN_VALUE: &str = "E0630";

/// The path of the table, and how it is written.
pub(super) fn read_data(
    node: &Node,
    key: Span,
    diagnostics: &mut Diagnostics,
) -> Option<(Spanned<String>, Form)> {
    if node.entries().is_none() {
        return word(node, "`data`", diagnostics).map(|file| (file, Form::default()));
    }
    let wording = keys("`data`");
    let known = ["file", "separator", "header", "decimal", "sheet"];
    let fields = Fields::open(node, key, wording, &known, diagnostics)?;
    let file = fields.need("file", wording, diagnostics);
    let file = file.and_then(|node| word(node, "`file`", diagnostics));
    let sheet = fields.get("sheet").and_then(|node| word(node, "`sheet`", diagnostics));
    let form = Form {
        separator: fields.get("separator").and_then(|node| read_separator(node, diagnostics)),
        names: fields.get("header").and_then(|node| read_names(node, diagnostics)).unwrap_or_default(),
        decimal_comma: fields.get("decimal").is_some_and(|node| is_comma(node, diagnostics)),
        sheet: sheet.map(|sheet| sheet.value),
        given: known
            .into_iter()
            .filter_map(|key| fields.entry(key).map(|(written, _)| Spanned::new(key, written.span)))
            .collect(),
    };
    check_commas(&fields, &form, diagnostics);
    file.map(|file| (file, form))
}

fn read_separator(node: &Node, diagnostics: &mut Diagnostics) -> Option<Separator> {
    let written = word(node, "`separator`", diagnostics)?;
    let found = Separator::ALL.into_iter().find(|separator| separator.name() == written.value);
    if found.is_none() {
        let message = format!("unknown separator `{}`", written.value);
        let mistake = Diagnostic::error(UNKNOWN_VALUE, written.span, message);
        let names = Separator::ALL.map(Separator::name);
        diagnostics.push(near_or_all(mistake, &written.value, "separators are", &names));
    }
    found
}

fn read_names(node: &Node, diagnostics: &mut Diagnostics) -> Option<Names> {
    let written = word(node, "`header`", diagnostics)?;
    if written.value == "none" {
        return Some(Names::Nowhere);
    }
    let line = written.value.parse().ok().filter(|line| *line > 0);
    if line.is_none() {
        let message = format!("`header` must be the number of a line or `none`, found `{}`", written.value);
        let help = "write `header: 7` if line 7 has the names of the columns, or `header: none`";
        diagnostics.push(Diagnostic::error(UNKNOWN_VALUE, written.span, message).help(help));
    }
    line.map(Names::Line)
}

fn is_comma(node: &Node, diagnostics: &mut Diagnostics) -> bool {
    let Some(written) = word(node, "`decimal`", diagnostics) else { return false };
    if !matches!(written.value.as_str(), "," | ".") {
        let message = format!("`{}` is not a decimal sign", written.value);
        let mistake = Diagnostic::error(UNKNOWN_VALUE, written.span, message);
        diagnostics.push(mistake.help("write `decimal: \",\"`, or leave it out for a point"));
    }
    written.value == ","
}

/// A comma cannot stand both in the numbers and between them.
fn check_commas(fields: &Fields<'_>, form: &Form, diagnostics: &mut Diagnostics) {
    if !form.decimal_comma || form.separator != Some(Separator::Comma) {
        return;
    }
    let message = "a comma cannot be both the decimal sign and the separator";
    let mistake = Diagnostic::error(FORM, fields.key_span("separator"), message);
    let mistake = mistake.also(fields.key_span("decimal"), "the decimal sign");
    diagnostics.push(mistake.help("write `separator: semicolon` or `tab`, as in the file"));
}
