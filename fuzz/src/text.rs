//! What all kinds of files have in common. In: bytes, findings, the names of machines. Out: a source file as the program
//! reads it; findings that are held to their promise; compiled machines.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::{SourceFile, Span};
use model_dsl::{Compiled, compile, compile_word};

/// Longer findings are no help to anybody.
const LONG: usize = 200_000;

/// The bytes as a file of text; nothing where they are none, which the program says before it reads on.
pub(crate) fn source(bytes: &[u8]) -> Option<SourceFile> {
    let text = std::str::from_utf8(bytes).ok()?;
    Some(SourceFile::new("file.yaml", text))
}

/// Every place that a finding names is one of the file, and the findings can be shown.
pub(crate) fn findings_hold(source: &SourceFile, diagnostics: &Diagnostics) {
    let within = |span: Span| source.text().get(span.start..span.end).is_some();
    for finding in diagnostics {
        assert!(within(finding.span), "{finding:?} is not within the file");
        for (span, _) in &finding.secondary {
            assert!(within(*span), "{finding:?} has a place that is not within the file");
        }
        assert!(!finding.code.is_empty() && !finding.message.is_empty(), "{finding:?} says nothing");
    }
    let shown = render(source, diagnostics, false);
    assert!(shown.len() < LONG, "{} bytes of findings", shown.len());
    assert!(!shown.contains('\u{1b}'), "a file's own escape sequence reaches the terminal");
}

/// Machines that the files of the search may name, besides topology words.
const MACHINES: [(&str, &str); 4] = [
    ("excello-921", include_str!("../../machines/excello-921.yaml")),
    ("nist-turning-center", include_str!("../../machines/nist-turning-center.yaml")),
    ("postech-mill", include_str!("../../machines/postech-mill.yaml")),
    ("trunnion-5axis", include_str!("../../machines/trunnion-5axis.yaml")),
];

thread_local! {
    static KNOWN: RefCell<BTreeMap<String, Rc<Compiled>>> = const { RefCell::new(BTreeMap::new()) };
}

/// The machine of this name, or else a mill, so that the search goes on behind the name.
pub(crate) fn machine(name: &str) -> Rc<Compiled> {
    let known = KNOWN.with_borrow(|known| known.get(name).cloned());
    known.unwrap_or_else(|| {
        let made = made(name).unwrap_or_else(|| machine("XYFZ"));
        KNOWN.with_borrow_mut(|known| {
            // Names are without end; those that come later are compiled again.
            if known.len() < 256 {
                known.insert(name.to_owned(), Rc::clone(&made));
            }
        });
        made
    })
}

fn made(name: &str) -> Option<Rc<Compiled>> {
    let mut diagnostics = Diagnostics::new();
    let shipped = MACHINES.iter().find(|(known, _)| *known == name);
    let compiled = match shipped {
        Some((_, text)) => compile(&SourceFile::new(name, *text), &mut diagnostics),
        None => compile_word(name, &mut diagnostics),
    };
    compiled.map(Rc::new)
}
