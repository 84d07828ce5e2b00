//! The page for a browser. In: a sheet. Out: one HTML file with its style inside: no script, nothing fetched.

use super::mathml::{arm, equation, escape, letter, part};
use super::sheet::{MotionEntry, Sheet, SheetRow};

const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1b1b1b; --paper: #fdfdfb; --line: #c9c9c2; --band: #f1f1ec; --quiet: #5a5a55; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8e6e1; --paper: #17181a; --line: #45474b; --band: #202225; --quiet: #a5a39d; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2rem 1.25rem 4rem; max-width: 70rem; color: var(--ink); background: var(--paper);
  font: 1rem/1.55 system-ui, sans-serif; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 .25rem; }
h2 { font-size: 1.15rem; margin: 2.25rem 0 .5rem; padding-bottom: .2rem; border-bottom: 1px solid var(--line); }
p, li { max-width: 46rem; }
.source { color: var(--quiet); margin-top: 0; }
.wide { overflow-x: auto; }
math { font-size: 1.08em; font-family: 'STIX Two Math', 'Cambria Math', 'Latin Modern Math', math, serif; }
math[display=block] { width: max-content; margin: .6rem 0; }
mtable.equation mtd { padding: .18em .2em; text-align: left; }
mtable.equation mtd:first-child { text-align: right; }
mtable.lines mtd { padding: .05em 0; text-align: left; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .2rem 1rem; margin: .8rem 0 0; }
dt { color: var(--quiet); }
dd { margin: 0; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .35rem .7rem .35rem 0; border-bottom: 1px solid var(--line); }
thead th { position: sticky; top: 0; background: var(--band); }
thead th:first-child, tbody td:first-child { padding-left: .5rem; }
.none { color: var(--quiet); }
@media print { body { max-width: none; } thead th { position: static; } }
";

/// The whole page.
pub(super) fn page(sheet: &Sheet) -> String {
    let heading = escape(&sheet.heading());
    let source = sheet.source.as_ref();
    let source = source.map(|text| format!("<p class=\"source\">Source: {}</p>\n", escape(text)));
    let rows: String = sheet.rows.iter().map(direction).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{heading}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{heading}</h1>\n{}\
         <h2>The chain</h2>\n<p>{}</p>\n{rows}\
         <h2>Error motions and their lever arms</h2>\n{}\
         <h2>Positions and constants</h2>\n{}\
         <h2>Conventions in force</h2>\n{}</body>\n</html>\n",
        source.unwrap_or_default(),
        escape(&sheet.chain.join(" ")),
        motions(sheet),
        quantities(sheet),
        conventions(sheet),
    )
}

fn direction(row: &SheetRow) -> String {
    format!(
        "<h2>Direction {}</h2>\n<div class=\"wide\">\n{}{}<dl>\n<dt>Nominal position</dt><dd>{}</dd>\n\
         <dt>Offsets</dt><dd>{}</dd>\n<dt>Error</dt><dd>{}</dd>\n</dl>\n</div>\n",
        row.direction,
        equation(&row.position),
        equation(&row.error),
        part(&row.nominal),
        part(&row.offsets),
        letter(&row.error.left),
    )
}

fn motions(sheet: &Sheet) -> String {
    let arms: String = sheet.rows.iter().map(|row| format!("<th>Arm in {}</th>", row.direction)).collect();
    let rows: String = sheet.motions.iter().map(motion).collect();
    format!(
        "<div class=\"wide\"><table>\n<thead><tr><th>Symbol</th><th>ISO 230-1</th><th>Meaning</th><th>Unit</th>\
         {arms}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
    )
}

fn motion(motion: &MotionEntry) -> String {
    let against = if motion.against_iso { " (counted against the ISO sense)" } else { "" };
    let cell = |found: &Option<super::tree::Expression>| match found {
        Some(found) => format!("<td>{}</td>", arm(found)),
        None => "<td class=\"none\">none</td>".to_owned(),
    };
    let arms: String = motion.arms.iter().map(cell).collect();
    format!(
        "<tr><td>{}</td><td>{}</td><td>{}{against}</td><td>{}</td>{arms}</tr>\n",
        letter(&motion.letter),
        escape(&motion.iso),
        escape(&motion.meaning),
        motion.unit
    )
}

fn quantities(sheet: &Sheet) -> String {
    let row = |entry: &super::sheet::QuantityEntry| {
        format!("<tr><td>{}</td><td>{}</td></tr>\n", letter(&entry.letter), escape(&entry.meaning))
    };
    let rows: String = sheet.quantities.iter().map(row).collect();
    format!(
        "<div class=\"wide\"><table>\n<thead><tr><th>Symbol</th><th>Meaning</th></tr></thead>\n<tbody>\n{rows}\
         </tbody>\n</table></div>\n"
    )
}

fn conventions(sheet: &Sheet) -> String {
    let items: String =
        sheet.conventions.iter().map(|sentence| format!("<li>{}</li>\n", escape(sentence))).collect();
    format!("<ul>\n{items}</ul>\n")
}
