//! The notation of equations: one tree of sums, products and letters, and writers of it.
//!
//! In: derived [`Equations`], and terms with their numbers ([`formula()`]). Out: plain text, LaTeX, a page with MathML, JSON, Maxima input, a Python module or a drawing of the chain. What stands
//! where (order, signs, brackets, how a name is split into letter and subscript) is decided once, while the
//! tree is built; a writer only spells it, so that no two formats can say different things.

mod brackets;
mod chain;
mod example;
mod factored;
mod formula;
mod html;
mod json;
mod latex;
mod letter;
mod mathml;
mod maxima;
mod number;
mod published;
mod python;
mod reach;
mod sheet;
mod text;
mod tree;
mod wrap;
mod writer;

#[cfg(test)]
mod tests;

use crate::algebra::Polynomial;
use crate::equations::{Equations, Names};

pub use example::{Example, example};
pub use formula::{Formula, formula};
pub use published::Published;
pub(crate) use sheet::followed;

/// In which form equations are printed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// Plain text, to be held beside a printed report.
    #[default]
    Text,
    /// A LaTeX document that needs amsmath, geometry and longtable.
    Latex,
    /// One self-contained HTML page with MathML and a drawing of the chain.
    Html,
    /// JSON of schema `abbe-equations/1`.
    Json,
    /// A batch file for Maxima.
    Maxima,
    /// A module for Python: NumPy and SymPy.
    Python,
    /// The drawing of the chain alone, as an SVG file.
    Svg,
}

/// Prints equations. JSON gives both names of every motion, whatever `names` says.
pub fn print(equations: &Equations, format: Format, names: Names) -> String {
    let sheet = || sheet::Sheet::new(equations, names);
    match format {
        Format::Text => text::page(&sheet()),
        Format::Latex => latex::page(&sheet()),
        Format::Html => page(equations, names, &[]),
        Format::Maxima => maxima::batch(&sheet()),
        Format::Python => python::module(&sheet()),
        Format::Json => json::object(equations),
        Format::Svg => drawing(equations, names),
    }
}

/// The equations alone in LaTeX, without the document around them: a block `align*` of amsmath for each direction.
pub fn latex_equations(equations: &Equations, names: Names) -> String {
    latex::equations(&sheet::Sheet::new(equations, names))
}

/// The page for a browser, with what was published about the machine beside what is derived.
pub fn page(equations: &Equations, names: Names, published: &[Published]) -> String {
    html::page(&sheet::Sheet::new(equations, names), equations, names, published)
}

/// The drawing of the chain that stands on the page, as an SVG file of its own.
pub fn drawing(equations: &Equations, names: Names) -> String {
    // On the page the drawing stands in a figure, which its rules name.
    let style = chain::STYLE.replace(".chain svg {", "svg {").replace(".chain ", "");
    let paper = "svg { background: var(--paper); }\n";
    chain::drawing(equations, names).file(&format!("{}{paper}{style}", pages::svg::COLOURS))
}

/// The error of each direction as one line of plain text: `dPx = dxx - dxz + ...`. Before these stand the brackets that have a name,
/// `Ly = y - Ya + Yt`, where the machine has rotary axes.
pub fn error_lines(equations: &Equations, names: Names) -> Vec<String> {
    let sheet = sheet::Sheet::new(&Equations { orientation: Vec::new(), ..equations.clone() }, names);
    lines(&sheet, &sheet.rows)
}

/// The error of each part of the tool's direction as one line of plain text, `dI = EBX + ...`, with its own brackets before, as in
/// [`error_lines`]; none where it is not derived.
pub fn direction_error_lines(equations: &Equations, names: Names) -> Vec<String> {
    let sheet = sheet::Sheet::new(&Equations { rows: Vec::new(), ..equations.clone() }, names);
    lines(&sheet, &sheet.orientation)
}

/// The named brackets, then the errors of rows.
fn lines(sheet: &sheet::Sheet, rows: &[sheet::SheetRow]) -> Vec<String> {
    let line = |statement: &sheet::Statement| {
        format!("{} = {}", statement.left.plain, writer::line(&text::Plain, &statement.right))
    };
    sheet.brackets.iter().chain(rows.iter().map(|row| &row.error)).map(line).collect()
}

/// A polynomial as plain infix text, `-x*cos(c) + Zt`, which [`crate::expression::parse`] reads back.
pub fn infix(polynomial: &Polynomial) -> String {
    writer::line(&text::Plain, &tree::polynomial(polynomial))
}
