//! The page for a browser. In: a sheet, the equations behind it and what was published. Out: one HTML file with its style
//! inside: no script, nothing fetched.

mod worked;

use pages::text::escape;

use super::mathml::{arm, equation, letter, part};
use super::published::{self, Published};
use super::reach;
use super::{chain, example};
use model_dsl::algebra::Axis;
use model_dsl::equations::{Equations, Names};
use model_dsl::sheet::{MotionEntry, Sheet, SheetRow};

const STYLE: &str = "\
.source { margin-top: 0; }
.word { font-size: 2.6rem; line-height: 1.1; letter-spacing: .12em; font-weight: 600; margin: .6rem 0 0; }
.word span { color: var(--quiet); font-weight: 400; }
.motions { font-size: .92rem; }
.motions th { white-space: nowrap; }
.motions td:nth-child(3) { min-width: 8rem; }
@media print { .motions { font-size: .58rem; } .motions td:nth-child(3) { min-width: 0; } }
math { font-size: 1.08em; font-family: 'STIX Two Math', 'Cambria Math', 'Latin Modern Math', math, serif; }
math[display=block] { width: max-content; margin: .6rem 0; }
@media print { math { font-size: .85em; } }
mtable.equation mtd { padding: .18em .2em; text-align: left; }
mtable.equation mtd:first-child { text-align: right; }
mtable.lines mtd { padding: .05em 0; text-align: left; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .2rem 1rem; margin: .8rem 0 0; }
dt { color: var(--quiet); }
dd { margin: 0; }
";

const SYMBOLS: &str = "A double arrow is a slide; its solid head shows the direction in which the programmed position grows. An \
    arc is a rotary axis; its head shows the direction in which the programmed angle grows. A broken circle is a spindle, which \
    rotates freely. A weld is a body that does not move relative to the one before it. The frame of each link is drawn beside \
    it: right-handed, parallel to that of the bed while all rotary axes are at zero, with X to the right, Z upwards and Y into \
    the page. The numbers on a connection are the offset of the frame above it, in the frame below. Error motions are listed at \
    their links: displacements, rotations and alignment.";

/// The whole page.
pub(super) fn page(sheet: &Sheet, equations: &Equations, names: Names, published: &[Published]) -> String {
    let source = sheet.source.as_ref();
    let source = source.map(|text| format!("<p class=\"source\">Source: {}</p>\n", escape(text)));
    let rows = sheet.rows.iter().map(direction).chain([orientation(sheet)]).collect::<String>();
    let title = sheet.heading();
    let body = format!(
        "<h1>{}</h1>\n{}<h2>The chain</h2>\n{}{}{rows}\
         <h2>Error motions and their lever arms</h2>\n{}\
         <h2>Positions and constants</h2>\n{}{}\
         <h2>Conventions in force</h2>\n{}{}",
        escape(&title),
        source.unwrap_or_default(),
        the_chain(sheet, equations, names),
        brackets(sheet),
        motions(sheet, equations),
        quantities(sheet),
        agreement(published),
        conventions(sheet),
        example(equations).map(|example| worked::section(sheet, equations, &example)).unwrap_or_default(),
    );
    pages::shell::page(&title, &format!("{STYLE}{}", chain::STYLE), &body)
}

fn the_chain(sheet: &Sheet, equations: &Equations, names: Names) -> String {
    let word = chain::word(equations).replace('F', "<span>F</span>");
    format!(
        "<p class=\"word\">{word}</p>\n<p class=\"source\">The axes from the part to the tool; F is the bed.</p>\n\
         <p>{}</p>\n<figure class=\"chain\">\n{}<figcaption>{SYMBOLS}</figcaption>\n</figure>\n",
        escape(&sheet.chain.join(" ")),
        chain::drawing(equations, names).inline(),
    )
}

fn brackets(sheet: &Sheet) -> String {
    if sheet.brackets.is_empty() {
        return String::new();
    }
    let equations: String = sheet.brackets.iter().map(equation).collect();
    format!(
        "<h2>Brackets with a name</h2>\n<p>Each of them occurs more than once below.</p>\n<div class=\"wide\">\n{equations}</div>\n"
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

/// The direction of the tool, where it is derived.
fn orientation(sheet: &Sheet) -> String {
    if sheet.orientation.is_empty() {
        return String::new();
    }
    let rows = sheet.orientation.iter().flat_map(|row| [&row.position, &row.error]);
    let equations: String = rows.map(equation).collect();
    format!(
        "<h2>Direction of the tool</h2>\n<p>The direction from the tip towards the spindle, in the part's frame. Its error is in rad.</p>\n\
         <div class=\"wide\">\n{equations}</div>\n"
    )
}

fn motions(sheet: &Sheet, equations: &Equations) -> String {
    let arms: String = sheet.rows.iter().map(|row| format!("<th>Arm in {}</th>", row.direction)).collect();
    let entries = sheet.motions.iter().zip(reach::cancelled(equations)).enumerate();
    let aimed = reach::aimed(equations);
    let rows: String = entries
        .map(|(number, (entry, cancelled))| {
            let tilted: Vec<char> = reach::tilted(equations, number).collect();
            let reached = reach::reached(equations, number);
            let aimed = aimed.as_ref().and_then(|aimed| aimed.get(number).copied());
            let words = reach::words(&reached, &cancelled, &tilted, aimed);
            motion(entry, &reached, &tilted, &words)
        })
        .collect();
    let of_tool = direction_of_tool(equations);
    format!(
        "<div class=\"wide\"><table class=\"motions\">\n<thead><tr><th>Symbol</th><th>ISO 230-1</th><th>Meaning</th>\
         <th>Unit</th><th>Reaches</th><th>Compensable</th>{arms}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n\
         <p>An error motion is compensable if slides can cancel it at the tip, or if rotary axes can cancel it in their own \
         angles or in the direction of the tool. Abbe reports the others and does not correct them. This column is about \
         geometry; the calibration determines which terms of a motion a controller knows in time (E0425).{of_tool}</p>\n"
    )
}

/// What becomes of the direction of the tool, where it is derived.
fn direction_of_tool(equations: &Equations) -> String {
    if equations.orientation.is_empty() {
        return String::new();
    }
    let axes = equations.aiming().into_iter().filter_map(|axis| equations.axes.get(axis));
    let axes: Vec<&str> = axes.map(|axis| axis.letter.as_str()).collect();
    let corrected = match axes.as_slice() {
        [] => "which no axis corrects".to_owned(),
        [axis] => format!("which {axis} corrects as far as it rotates the tool"),
        axes => format!("which {} correct", axes.join(" and ")),
    };
    format!(" I, J and K are the direction of the tool, {corrected}.")
}

fn motion(motion: &MotionEntry, reached: &[Axis], tilted: &[char], compensable: &str) -> String {
    let against = if motion.against_iso { " (counted against the ISO sense)" } else { "" };
    let cell = |found: &Option<model_dsl::sheet::Expression>| match found {
        Some(found) => format!("<td>{}</td>", arm(found)),
        None => "<td class=\"none\">none</td>".to_owned(),
    };
    let arms: String = motion.arms.iter().map(cell).collect();
    let tip = reached.iter().map(|axis| axis.letter());
    let directions: Vec<String> = tip.chain(tilted.iter().copied()).map(String::from).collect();
    format!(
        "<tr><td>{}</td><td>{}</td><td>{}{against}</td><td>{}</td><td>{}</td><td>{}</td>{arms}</tr>\n",
        letter(&motion.letter),
        escape(&motion.iso),
        escape(&motion.meaning),
        motion.unit,
        directions.join(", "),
        compensable,
    )
}

fn quantities(sheet: &Sheet) -> String {
    let row = |entry: &model_dsl::sheet::QuantityEntry| {
        let (letter, meaning) = (letter(&entry.letter), escape(&entry.meaning));
        format!("<tr><td>{letter}</td><td>{meaning}</td><td>{}</td></tr>\n", escape(&entry.value))
    };
    let rows: String = sheet.quantities.iter().map(row).collect();
    format!(
        "<div class=\"wide\"><table>\n<thead><tr><th>Symbol</th><th>Meaning</th><th>Value</th></tr></thead>\n\
         <tbody>\n{rows}</tbody>\n</table></div>\n"
    )
}

fn agreement(published: &[Published]) -> String {
    if published.is_empty() {
        return String::new();
    }
    let sections: String = published.iter().map(published::section).collect();
    format!("<h2>Agreement with published equations</h2>\n{sections}")
}

fn conventions(sheet: &Sheet) -> String {
    let items: String =
        sheet.conventions.iter().map(|sentence| format!("<li>{}</li>\n", escape(sentence))).collect();
    format!("<ul>\n{items}</ul>\n")
}
