//! Tests of the notation: what a reader must find in each format.

use super::{Format, print};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::{Equations, Names};
use model_dsl::sheet::error_lines;
use model_dsl::source::SourceFile;

/// All forms of whole equations.
const FORMATS: [Format; 6] =
    [Format::Text, Format::Latex, Format::Html, Format::Json, Format::Maxima, Format::Python];

/// The names of all shipped machines.
pub(super) fn machines() -> Vec<String> {
    let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../machines")).expect("a folder");
    let files = folder.map(|entry| entry.expect("a file").path());
    let machines = files.filter(|path| path.extension().is_some_and(|extension| extension == "yaml"));
    let name = |path: std::path::PathBuf| path.file_stem().expect("a name").to_string_lossy().into_owned();
    let names: Vec<String> = machines.map(name).collect();
    assert!(names.len() > 10, "{names:?}");
    names
}

/// The equations of a shipped machine.
pub(super) fn equations(name: &str) -> Equations {
    let path = format!("{}/../machines/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    let source = SourceFile::new(name, std::fs::read_to_string(path).expect("a shipped machine"));
    let mut diagnostics = Diagnostics::new();
    model_dsl::compile(&source, &mut diagnostics).expect("a valid machine").equations
}

/// The turned squareness of the turning centre: +X travel goes towards -Z by EB0X, and towards +Z by ao.
#[test]
fn a_symbol_counted_against_iso_has_the_opposite_arm_of_its_name() {
    let of = |format, names| print(&equations("nist-turning-center"), format, names);
    let lines = |names| error_lines(&equations("nist-turning-center"), names).join("\n");
    let [symbols, iso] = [Names::Symbols, Names::Iso].map(lines);
    assert!(symbols.contains("+ dx*ao"), "{symbols}");
    assert!(iso.contains("- dx*EB0X"), "{iso}");
    let told = "Counted against the sense of ISO 230-1: ao.";
    assert!(of(Format::Text, Names::Symbols).contains(told));
    assert!(!of(Format::Text, Names::Iso).contains("ounted against"));
    assert!(!of(Format::Latex, Names::Iso).contains("ounted against"));
    // JSON says the arm of the name under either.
    for names in [Names::Symbols, Names::Iso] {
        assert!(
            of(Format::Json, names)
                .contains(r#"{"motion": "EB0X", "symbol": "ao", "arm": "-dx", "symbol_sign": -1}"#)
        );
    }
}

#[test]
fn every_format_prints_every_machine() {
    for name in machines() {
        let equations = equations(&name);
        for format in FORMATS {
            let text = print(&equations, format, Names::Iso);
            assert!(text.contains(&name), "{name} as {format:?}");
            assert_eq!(text, print(&equations, format, Names::Iso), "{name} as {format:?} is the same twice");
        }
    }
}

#[test]
fn the_page_stands_alone_and_its_elements_close() {
    for name in machines() {
        let page = print(&equations(&name), Format::Html, Names::Symbols);
        for forbidden in ["<script", "http", "src=", "href=", "@import", "url("] {
            assert!(!page.contains(forbidden), "{name} holds {forbidden}");
        }
        assert_closed(&page);
    }
}

/// Every element closes, in the order in which it was opened; those of HTML without content need not.
fn assert_closed(page: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in page.split('<').skip(1).map(|piece| piece.split('>').next().expect("a first piece")) {
        let name = tag.trim_start_matches('/').split([' ', '\n']).next().expect("a first piece");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "after {open:?}");
        } else if !tag.ends_with('/') && !["!DOCTYPE", "meta", "br"].contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?} do not close");
}

#[test]
fn latex_has_letters_with_subscripts() {
    let page = print(&equations("excello-921"), Format::Latex, Names::Symbols);
    let error = "\\Delta P_{\\mathrm{x}} &= \\delta_{\\mathrm{xx}} - \\delta_{\\mathrm{xz}} + \
                 Z_{\\mathrm{t}}\\,\\varepsilon_{\\mathrm{yx}} + (z + Z_{\\mathrm{1}} - Z_{\\mathrm{t}})\\,\
                 \\varepsilon_{\\mathrm{yz}} - z\\,\\beta";
    assert!(page.contains(error), "{page}");
}

#[test]
fn hostile_words_stay_words() {
    let mut equations = equations("excello-921");
    equations.title = Some("</title><script>x</script> 100% & \"so\" */ $x_1$ \\".to_owned());
    equations.machine = "a\"b\\c\u{1}".to_owned();
    assert!(!print(&equations, Format::Html, Names::Iso).contains("<script"));
    assert!(print(&equations, Format::Json, Names::Iso).contains(r#""machine": "a\"b\\c\u0001""#));
    assert!(
        print(&equations, Format::Latex, Names::Iso)
            .contains("100\\% \\& \"so\" */ \\$x\\_1\\$ \\textbackslash{}")
    );
    assert!(print(&equations, Format::Maxima, Names::Iso).contains("* / $x_1$"));
}

/// A slide that turns with all error motions, and the tip of the tool in its frame.
const TIP_IN_THE_FRAME: &str =
    "chain: {tool: [{slide: X, along: +X, errors: [EXX, EAX, EBX, ECX]}, {tool: tip, offset: [0, 0, 0]}]}";

/// The equations of a machine, the direction of its tool among them.
fn with_direction(topology: &str) -> Equations {
    let text = format!("abbe: 1\nname: machine\norientation: true\n{topology}");
    model_dsl::compile(&SourceFile::new("machine.yaml", text), &mut Diagnostics::new())
        .expect("a machine")
        .equations
}

#[test]
fn the_direction_of_the_tool_is_printed_where_it_is_derived() {
    let head = with_direction("topology: FB\n");
    assert!(print(&head, Format::Maxima, Names::Symbols).contains("\nI : sin(b) + dI$\n"));
    assert!(print(&head, Format::Latex, Names::Symbols).contains("K &= \\cos(b) + \\Delta K"));
    let page = print(&head, Format::Html, Names::Symbols);
    assert!(page.contains("<h2>Direction of the tool</h2>"));
    // EBB moves a tip at [Xt, Yt, Zt] in X and Z, and turns the tool in these directions.
    assert!(page.contains("<td>rad</td><td>X, Z, I, K</td><td>yes</td>"), "{page}");
    let page = print(&with_direction(TIP_IN_THE_FRAME), Format::Html, Names::Symbols);
    assert!(page.contains("<td>rad</td><td>J</td><td>no</td>"), "no slide turns a tool: {page}");
    let plain = model_dsl::compile_word("FB", &mut Diagnostics::new()).expect("a word").equations;
    for format in FORMATS {
        let text = print(&plain, format, Names::Symbols);
        let told = ["dI", "Direction of the tool", "orientation", "direction_error", "Delta I"];
        assert!(!told.iter().any(|word| text.contains(word)), "{format:?}");
    }
}

/// What a drive says serves a diagnosis, and is in no equation.
#[test]
fn a_drive_changes_no_format() {
    let mill = |drive: &str| {
        let text = format!("abbe: 1\nname: mill\ntopology: CXFY\n{drive}");
        model_dsl::compile(&SourceFile::new("mill.yaml", text), &mut Diagnostics::new())
            .expect("a mill")
            .equations
    };
    let (bare, driven) = (mill(""), mill("drive: {X: {pitch: 10 mm, ratio: 2}, C: {teeth: 90}}"));
    for format in FORMATS {
        assert_eq!(print(&bare, format, Names::Iso), print(&driven, format, Names::Iso), "{format:?}");
    }
}
