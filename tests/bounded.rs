//! Hostile machine files. In: texts that are huge, deep, or grow when expanded. Out: an error in bounded time, never a hang.

use std::fmt::Write;
use std::time::{Duration, Instant};

use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::SourceFile;

/// Generous for an unoptimised build on a busy computer; what grows without bound takes hours.
const LONG: Duration = Duration::from_secs(20);

/// The codes of the errors that a text gives; it must give one, and soon, and be rendered soon and briefly.
fn refused(text: String) -> Vec<&'static str> {
    let begun = Instant::now();
    let source = SourceFile::new("machine.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let compiled = model_dsl::compile(&source, &mut diagnostics);
    let told = render(&source, &diagnostics, false);
    assert!(compiled.is_none() && diagnostics.has_errors());
    assert!(begun.elapsed() < LONG, "took {:?}", begun.elapsed());
    assert!(told.len() < 100_000, "{} bytes of findings", told.len());
    diagnostics.iter().map(|finding| finding.code).collect()
}

#[test]
fn ten_megabytes() {
    let comment = "# a comment that goes on and on\n".repeat(10 * 1024 * 1024 / 32);
    assert_eq!(refused(format!("abbe: 1\nname: stage\ntopology: FX\n{comment}")), ["E0003"]);
}

#[test]
fn seven_megabytes_of_unknown_keys() {
    let mut text = String::from("abbe: 1\nname: stage\ntopology: FX\n");
    for number in 0..500_000 {
        writeln!(text, "key{number}: 1").unwrap();
    }
    assert_eq!(refused(text), ["E0004"]);
}

#[test]
fn a_hundred_thousand_unknown_keys() {
    let mut text = String::from("abbe: 1\nname: stage\ntopology: FX\n");
    for number in 0..90_000 {
        writeln!(text, "k{number}: 1").unwrap();
    }
    refused(text);
}

#[test]
fn ten_thousand_deep() {
    for (open, close) in [("[", "]"), ("{a: ", "}")] {
        let text = format!("abbe: 1\nname: {}{}\n", open.repeat(10_000), close.repeat(10_000));
        assert_eq!(refused(text), ["E0004"]);
    }
    let mut blocks = String::from("abbe: 1\nname:\n");
    for depth in 1..10_000 {
        writeln!(blocks, "{}a:", " ".repeat(depth % 300)).unwrap();
    }
    refused(blocks);
    let dashes = format!("abbe: 1\nname:\n  {}x\n", "- ".repeat(10_000));
    assert_eq!(refused(dashes), ["E0004"]);
}

#[test]
fn ten_thousand_open_brackets() {
    refused("[".repeat(10_000));
    refused("{".repeat(10_000));
    refused("- ".repeat(10_000));
    refused("? ".repeat(10_000));
}

#[test]
fn alias_bomb() {
    let mut text = String::from("abbe: 1\nname: stage\na0: &a0 [x, x, x, x, x, x, x, x, x, x]\n");
    for level in 1..12 {
        let before = level - 1;
        let all = vec![format!("*a{before}"); 10].join(", ");
        writeln!(text, "a{level}: &a{level} [{all}]").unwrap();
    }
    assert!(refused(text).contains(&"E0004"));
}

#[test]
fn expression_bombs() {
    let file = |coordinate: &str| {
        format!(
            "abbe: 1\nname: stage\nchain:\n  tool:\n    - {{slide: X, along: +X, origin: [\"{coordinate}\", 0, 0]}}\n    - tool: tip\n"
        )
    };
    assert_eq!(refused(file(&"(".repeat(100_000))), ["E0118"]);
    assert_eq!(refused(file(&"-".repeat(100_000))), ["E0118"]);
    assert_eq!(refused(file("(a+b+c+d+e+f+g+h+i+j+k+l+m+n)^16")), ["E0118"]);
    assert_eq!(refused(file("1e999999999")), ["E0118"]);
    assert_eq!(refused(file(&"9".repeat(1_000_000))), ["E0118"]);
}

/// What a file of equations expands to, in one equation or in many.
#[test]
fn equation_bombs() {
    let machine = model_dsl::compile_word("XYFZ", &mut Diagnostics::new()).unwrap();
    let code = |text: String| {
        let begun = Instant::now();
        let source = SourceFile::new("equations.eqs", text);
        let mut diagnostics = Diagnostics::new();
        let report = model_dsl::check::check(&machine.machine, &machine.equations, &source, &mut diagnostics);
        assert!(report.is_none() && begun.elapsed() < LONG, "took {:?}", begun.elapsed());
        diagnostics.iter().map(|finding| finding.code).next_back()
    };
    assert_eq!(code(format!("dPx = x{}\n", "*sin(x)".repeat(20_000))), Some("E0503"));
    assert_eq!(code(format!("dPx = x{}\n", "*(x + y + z)".repeat(60))), Some("E0503"));
    assert_eq!(code(format!("dPx = {}x{}\n", "(".repeat(50_000), ")".repeat(50_000))), Some("E0503"));
    let many: String = (0..2_000).map(|number| format!("[s{number}]\ndPx = (x + y + z + Xt)^12\n")).collect();
    assert_eq!(code(many), Some("E0503"));
    assert_eq!(code("# a page of a book\n".repeat(100_000)), Some("E0003"));
}

/// Each coordinate alone is small enough to read; together they must not keep the compiler busy for minutes.
#[test]
fn coordinates_that_expand() {
    let mut text = String::from("abbe: 1\nname: stage\nchain:\n  tool:\n    - {slide: X, along: +X}\n");
    for (number, signs) in
        ["++++", "+++-", "++-+", "++--", "+-++", "+-+-", "+--+", "+---"].into_iter().enumerate()
    {
        let signs: Vec<char> = signs.chars().collect();
        let sum = |last: &str| format!("(a{}b{}c{}d{}{last})^12", signs[0], signs[1], signs[2], signs[3]);
        writeln!(
            text,
            "    - {{fixed: N{number}, origin: [\"{}\", \"{}\", \"{}\"], errors: [EBN{number}]}}",
            sum("e"),
            sum("f"),
            sum("g")
        )
        .unwrap();
    }
    text.push_str("    - {tool: tip}\n");
    let codes = refused(text);
    assert!(codes.iter().all(|code| *code == "E0118"), "{codes:?}");
}
