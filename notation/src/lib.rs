//! The notation of equations: how they are printed.
//!
//! In: derived [`Equations`], and terms with their numbers ([`formula()`]). Out: LaTeX, a page with MathML, Maxima input, a Python module or a
//! drawing of the chain, beside the plain text and the JSON of the compiler. What a page says is a [`Sheet`], which the compiler settles; a
//! writer here only spells it. It is a crate of its own since who compiles a machine into a controller prints nothing.

mod chain;
mod example;
mod formula;
mod html;
mod latex;
mod mathml;
mod maxima;
mod published;
mod python;
mod reach;

#[cfg(test)]
mod factored;
#[cfg(test)]
mod tests;

use model_dsl::equations::{Equations, Names};
use model_dsl::sheet::{Sheet, json, text};

pub use example::{Example, example};
pub use formula::{Formula, formula};
pub use published::Published;

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
    let sheet = || Sheet::new(equations, names);
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

/// The equations alone in LaTeX, without the document around them: blocks `align*` of amsmath, one
/// of the named brackets where there are any, then one for each direction.
pub fn latex_equations(equations: &Equations, names: Names) -> String {
    latex::equations(&Sheet::new(equations, names))
}

/// The page for a browser, with what was published about the machine beside what is derived.
pub fn page(equations: &Equations, names: Names, published: &[Published]) -> String {
    html::page(&Sheet::new(equations, names), equations, names, published)
}

/// The drawing of the chain that stands on the page, as an SVG file of its own.
pub fn drawing(equations: &Equations, names: Names) -> String {
    // On the page the drawing stands in a figure, which its rules name.
    let style = chain::STYLE.replace(".chain svg {", "svg {").replace(".chain ", "");
    let paper = "svg { background: var(--paper); }\n";
    chain::drawing(equations, names).file(&format!("{}{paper}{style}", pages::svg::COLOURS))
}
