//! The page around what is shown. In: a title, a style of the page's own and its body. Out: the whole HTML file.

use crate::text::escape;

/// Colours by light, dark and print. Those of series are near those of Okabe and Ito, which people with any colour vision
/// tell apart; dashes and marks tell them too: see `plot`.
pub(crate) const COLOURS: &str = "\
:root { color-scheme: light dark; --ink: #1b1b1b; --paper: #fdfdfb; --line: #c9c9c2; --band: #f1f1ec; --quiet: #5a5a55;
  --one: #0072b2; --two: #c44e00; --three: #00795a; --four: #a8518a; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8e6e1; --paper: #17181a; --line: #45474b; --band: #202225; --quiet: #a5a39d;
    --one: #56b4e9; --two: #f0a04b; --three: #2fc79b; --four: #dd9cc4; }
}
@media print {
  :root { color-scheme: light; --ink: #000; --paper: #fff; --line: #999; --band: #eee; --quiet: #333;
    --one: #0072b2; --two: #c44e00; --three: #00795a; --four: #a8518a; }
}
";

/// Letters and print, alike on all pages.
const STYLE: &str = "\
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2rem 1.25rem 4rem; max-width: 70rem; color: var(--ink); background: var(--paper);
  font: 1rem/1.55 system-ui, sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.15rem; margin: 2.25rem 0 .5rem; padding-bottom: .2rem; border-bottom: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.25rem 0 .4rem; }
p, li { max-width: 46rem; }
.source, .none { color: var(--quiet); }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .35rem .7rem .35rem 0; border-bottom: 1px solid var(--line); }
thead th { background: var(--band); }
thead th:first-child, tbody td:first-child { padding-left: .5rem; }
figure { margin: 1rem 0; }
figcaption { color: var(--quiet); font-size: .92rem; max-width: 46rem; }
svg { display: block; max-width: 100%; height: auto; font: 12px system-ui, sans-serif; }
@media print {
  body { max-width: none; padding: 0; }
  figure, article, tr { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
}
";

/// The whole file. `title` is text; `style` (further rules) and `body` are markup already.
pub fn page(title: &str, style: &str, body: &str) -> String {
    let title = escape(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{COLOURS}{STYLE}{style}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}
