//! Elements of a drawing. In: names, attributes, coordinates in units of the drawing (x right, y down). Out: SVG markup.

use std::fmt::Write as _;

use crate::text::escape;

/// The colours of pages, for a drawing that is a file of its own: [`Drawing::file`]. They follow the reader's setting.
pub const COLOURS: &str = "\
svg { font: 12px system-ui, sans-serif; --ink: #1b1b1b; --paper: #fdfdfb; --line: #c9c9c2; --band: #f1f1ec; --quiet: #5a5a55;
  --one: #0072b2; --two: #c44e00; --three: #00795a; --four: #a8518a; }
@media (prefers-color-scheme: dark) {
  svg { --ink: #e8e6e1; --paper: #17181a; --line: #45474b; --band: #202225; --quiet: #a5a39d;
    --one: #56b4e9; --two: #f0a04b; --three: #2fc79b; --four: #dd9cc4; }
}
";

/// A drawing that is being made: elements are added from the back to the front.
#[derive(Clone, Debug)]
pub struct Drawing {
    width: f64,
    height: f64,
    title: String,
    description: String,
    body: String,
}

/// A number as it stands in an attribute: two decimals, no more zeros than needed. What is not finite becomes 0.
pub fn number(value: f64) -> String {
    let rounded = if value.is_finite() { (value * 100.0).round() / 100.0 } else { 0.0 };
    if rounded == 0.0 { "0".to_owned() } else { format!("{rounded}") }
}

impl Drawing {
    /// An empty drawing of a size; the title is what a reader without sight is told.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        Self { width, height, title: title.to_owned(), description: String::new(), body: String::new() }
    }

    /// What a reader without sight is told besides: what the drawing shows, in words.
    pub fn describe(&mut self, description: &str) {
        description.clone_into(&mut self.description);
    }

    /// Adds an element without content; attribute values are escaped.
    pub fn element(&mut self, name: &str, attributes: &[(&str, &str)]) {
        let attributes = written(attributes);
        let _ = writeln!(self.body, "<{name}{attributes}/>");
    }

    /// Adds text at a point.
    pub fn text(&mut self, (x, y): (f64, f64), class: &str, text: &str) {
        let (x, y) = (number(x), number(y));
        let attributes = written(&[("x", &x), ("y", &y), ("class", class)]);
        let _ = writeln!(self.body, "<text{attributes}>{}</text>", escape(text));
    }

    /// Adds markup that is finished already, such as a group of another drawing.
    pub fn raw(&mut self, markup: &str) {
        self.body.push_str(markup);
    }

    /// Adds another drawing with its upper left corner at a point.
    pub fn place(&mut self, (x, y): (f64, f64), other: &Self) {
        let (x, y) = (number(x), number(y));
        let _ = writeln!(self.body, "<g transform=\"translate({x} {y})\">\n{}</g>", other.body);
    }

    /// Width and height.
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// The drawing as an element of a page.
    pub fn inline(&self) -> String {
        format!("{}{}</svg>\n", self.head(""), self.body)
    }

    /// The drawing as a file of its own, with the style that it needs inside.
    pub fn file(&self, style: &str) -> String {
        let head = self.head(" xmlns=\"http://www.w3.org/2000/svg\"");
        format!("{head}<style>{style}</style>\n{}</svg>\n", self.body)
    }

    fn head(&self, namespace: &str) -> String {
        let (width, height, title) = (number(self.width), number(self.height), escape(&self.title));
        let described = match self.description.as_str() {
            "" => String::new(),
            description => format!("<desc>{}</desc>\n", escape(description)),
        };
        format!(
            "<svg{namespace} viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\">\n\
             <title>{title}</title>\n{described}"
        )
    }
}

fn written(attributes: &[(&str, &str)]) -> String {
    attributes.iter().fold(String::new(), |mut all, (name, value)| {
        let _ = write!(all, " {name}=\"{}\"", escape(value));
        all
    })
}

#[cfg(test)]
mod tests {
    use super::{COLOURS, Drawing, number};

    #[test]
    fn files_have_the_colours_of_pages() {
        let page = crate::shell::page("", "", "");
        let named: Vec<&str> =
            COLOURS.split([';', '{', '\n']).map(str::trim).filter(|rule| rule.starts_with("--")).collect();
        assert_eq!(named.len(), 18, "nine colours, light and dark");
        assert!(named.iter().all(|rule| page.contains(rule)), "{named:?}");
    }

    #[test]
    fn numbers_are_short_and_finite() {
        assert_eq!([1.0, -0.001, 2.345, f64::NAN].map(number), ["1", "0", "2.35", "0"]);
    }

    #[test]
    fn a_file_names_its_language_and_a_page_need_not() {
        let mut drawing = Drawing::new(10.0, 5.0, "a & b");
        drawing.text((1.0, 2.0), "label", "<x>");
        assert!(drawing.inline().starts_with("<svg viewBox=\"0 0 10 5\""));
        assert!(drawing.file("").contains("xmlns=") && drawing.file("").contains("&lt;x&gt;"));
    }
}
