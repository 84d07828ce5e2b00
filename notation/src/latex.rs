//! LaTeX. In: a sheet. Out: a document with the equations, the lists of motions and of constants, to be printed or quoted in a paper.

use model_dsl::sheet::{
    Angle, Base, Function, Letter, Number, Sheet, Signs, Statement, Writer, pieces, text::Plain, wrap,
};

/// The widest line of an equation, measured in characters of plain text.
const WIDTH: usize = 84;

struct Latex;

impl Writer for Latex {
    fn signs(&self) -> &'static Signs {
        &Signs { plus: " + ", minus: " - ", leading_minus: "-", times: "\\,", open: "(", close: ")" }
    }

    fn letter(&self, letter: &Letter) -> String {
        let base = match &letter.base {
            Base::Letter(one) => one.to_string(),
            Base::Word(word) => format!("\\mathrm{{{}}}", escape(word)),
            Base::Greek(greek) => format!("\\{}", greek.command),
        };
        let difference = if letter.difference { "\\Delta " } else { "" };
        match &letter.subscript {
            Some(subscript) => format!("{difference}{base}_{{\\mathrm{{{}}}}}", escape(subscript)),
            None => format!("{difference}{base}"),
        }
    }

    fn number(&self, number: &Number) -> String {
        match (&number.decimal, &number.denominator) {
            (Some(decimal), _) => decimal.clone(),
            (None, Some(denominator)) => format!("\\tfrac{{{}}}{{{denominator}}}", number.numerator),
            (None, None) => number.numerator.clone(),
        }
    }

    fn power(&self, base: &str, exponent: u32) -> String {
        format!("{{{base}}}^{{{exponent}}}")
    }

    fn function(&self, function: Function, argument: &str) -> String {
        format!("\\{}({argument})", function.word())
    }

    fn angle(&self, angle: &Angle) -> String {
        format!("{}^{{\\circ}}", self.number(&angle.degrees))
    }
}

/// The whole document.
pub(super) fn page(sheet: &Sheet) -> String {
    let mut text = String::from(
        "\\documentclass[10pt]{article}\n\\usepackage[utf8]{inputenc}\n\\usepackage[T1]{fontenc}\n\
         \\usepackage[a4paper,margin=20mm]{geometry}\n\\usepackage{amsmath,longtable}\n\\allowdisplaybreaks\n\
         \\setlength{\\parindent}{0pt}\n\\begin{document}\n",
    );
    text.push_str(&format!("\\section*{{{}}}\n", escape(&sheet.heading())));
    if let Some(source) = &sheet.source {
        text.push_str(&format!("Source: {}\n\n", escape(source)));
    }
    text.push_str(&format!("{}\n", escape(&sheet.chain.join(" "))));
    text.push_str(&equations(sheet));
    text.push_str(&motions(sheet));
    text.push_str(&quantities(sheet));
    text.push_str("\\begin{itemize}\n");
    for sentence in &sheet.conventions {
        text.push_str(&format!("\\item {}\n", escape(sentence)));
    }
    text.push_str("\\end{itemize}\n\\end{document}\n");
    text
}

/// The equations alone: a block `align*` of the named brackets where there are any, then one for each direction.
pub(super) fn equations(sheet: &Sheet) -> String {
    let brackets = (!sheet.brackets.is_empty()).then(|| sheet.brackets.iter().map(equation).collect());
    let rows = sheet.rows.iter().chain(&sheet.orientation);
    let rows = rows.map(|row| vec![equation(&row.position), equation(&row.error)]);
    brackets.into_iter().chain(rows).map(|block: Vec<String>| aligned(&block)).collect()
}

/// Equations below each other.
fn aligned(equations: &[String]) -> String {
    format!("\\begin{{align*}}\n{}\n\\end{{align*}}\n", equations.join(" \\\\\n"))
}

/// One equation of an `align*`, broken where its plain text would be too wide.
fn equation(statement: &Statement) -> String {
    let written = pieces(&Latex, &statement.right);
    let plain = pieces(&Plain, &statement.right);
    let mut text = format!("{} &=", Latex.letter(&statement.left));
    for (number, line) in wrap::lines(&plain, WIDTH).iter().enumerate() {
        let indent = if line.inside { "\\qquad" } else { "\\quad" };
        let head = if number == 0 { " ".to_owned() } else { format!(" \\\\\n&{indent}") };
        text.push_str(&format!("{head}{}", wrap::join(&written, line)));
    }
    text
}

fn motions(sheet: &Sheet) -> String {
    let row = |motion: &model_dsl::sheet::MotionEntry| {
        let against = if motion.against_iso { "; counted against the ISO sense" } else { "" };
        let letter = Latex.letter(&motion.letter);
        let (iso, meaning) = (escape(&motion.iso), escape(&motion.meaning));
        format!("${letter}$ & {iso} & {} & {meaning}{against} \\\\\n", motion.unit)
    };
    let rows: String = sheet.motions.iter().map(row).collect();
    format!("\\begin{{longtable}}{{@{{}}lllp{{0.6\\textwidth}}@{{}}}}\n{rows}\\end{{longtable}}\n")
}

fn quantities(sheet: &Sheet) -> String {
    let row = |entry: &model_dsl::sheet::QuantityEntry| {
        format!("${}$ & {} \\\\\n", Latex.letter(&entry.letter), escape(&entry.meaning))
    };
    let rows: String = sheet.quantities.iter().map(row).collect();
    format!("\\begin{{longtable}}{{@{{}}lp{{0.8\\textwidth}}@{{}}}}\n{rows}\\end{{longtable}}\n")
}

/// Text outside of formulas: marks of LaTeX as it prints them.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        match character {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => escaped.extend(['\\', character]),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '\\' => escaped.push_str("\\textbackslash{}"),
            other => escaped.push(other),
        }
    }
    escaped
}
