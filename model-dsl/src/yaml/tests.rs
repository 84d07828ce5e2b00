//! What is read from YAML text, and what is refused and where.

use super::*;
use crate::diagnostic::Diagnostics;
use crate::source::SourceFile;
use std::time::{Duration, Instant};

fn read_text(text: &str) -> (Option<Node>, Vec<(&'static str, String)>) {
    let source = SourceFile::new("test.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let node = read(&source, &mut diagnostics);
    let found = diagnostics.iter();
    let found = found.map(|one| (one.code, source.slice(one.span).to_owned()));
    (node, found.collect())
}

fn good(text: &str) -> Node {
    let (node, found) = read_text(text);
    assert_eq!(found, []);
    node.expect("a tree")
}

fn codes(text: &str) -> Vec<(&'static str, String)> {
    read_text(text).1
}

fn one(code: &'static str, text: &str) -> Vec<(&'static str, String)> {
    vec![(code, text.to_owned())]
}

#[test]
fn scalars_stay_as_written() {
    let node = good("[0.10, +X, 1e-3, yes, \"a b\", 'it''s', 0x10, -.5]");
    let texts: Vec<_> = node.items().expect("a list").iter().map(Node::text).collect();
    let expected = ["0.10", "+X", "1e-3", "yes", "a b", "it's", "0x10", "-.5"];
    assert_eq!(texts, expected.map(Some));
}

#[test]
fn quoted_scalars_are_known_as_such() {
    let node = good("[a, 'a', \"a\", \"~\", ~, null, ]");
    let quoted = node.items().expect("a list").iter().map(|item| match &item.kind {
        NodeKind::Scalar(scalar) => Some(scalar.quoted),
        _ => None,
    });
    let expected = [Some(false), Some(true), Some(true), Some(true), None, None];
    assert_eq!(quoted.collect::<Vec<_>>(), expected);
}

#[test]
fn spans_are_bytes_behind_characters_of_many_bytes() {
    let text = "\u{feff}µm: 'ü'\r\nb: [ü, 10 µm]  # ü\r\nc:\n  d: 1\n\n  e:\n  - 2  \n";
    let source = SourceFile::new("a", text);
    let node = read(&source, &mut Diagnostics::new()).expect("a tree");
    let shown = node.entries().expect("a mapping").iter();
    let shown: Vec<_> =
        shown.map(|(key, value)| (source.slice(key.span), source.slice(value.span))).collect();
    assert_eq!(shown, [("µm", "'ü'"), ("b", "[ü, 10 µm]"), ("c", "d: 1\n\n  e:\n  - 2")]);
    assert_eq!(source.slice(node.span).len(), text.len() - 3 - 3);
}

#[test]
fn a_value_left_out_stands_at_its_key() {
    let node = good("a:\nb: 1\n");
    let value = node.get("a").expect("a");
    assert_eq!((value.span, &value.kind), (Span::new(0, 1), &NodeKind::Null));
    assert_eq!(value.kind_name(), "nothing");
    assert_eq!(node.get("z"), None);
}

#[test]
fn parts_of_scalars_have_places() {
    let text = "a: 10 µm\nb: \"10 µm\"\nc: \"1\\u0030 um\"\n";
    let source = SourceFile::new("a", text);
    let node = read(&source, &mut Diagnostics::new()).expect("a tree");
    let part = |key: &str| source.slice(node.get(key).expect("key").part(3..6)).to_owned();
    assert_eq!([part("a"), part("b")], ["µm", "µm"]);
    assert_eq!(part("c"), "\"1\\u0030 um\"");
}

#[test]
fn a_long_folded_text_is_one_scalar() {
    let node = good("a: |\n  one\n  two\nb: >-\n  three\n  four\n");
    assert_eq!(node.get("a").and_then(Node::text), Some("one\ntwo\n"));
    assert_eq!(node.get("b").and_then(Node::text), Some("three four"));
}

#[test]
fn what_is_not_yaml_is_located() {
    assert_eq!(codes("a: [1\nb: 2\n"), one("E0001", ":"));
    assert_eq!(codes("a: [1\n"), one("E0001", "["));
    assert_eq!(codes("a: 1\n\tb: 2\n"), one("E0001", "1"));
    assert_eq!(codes("a:\n\tb: 2\n"), one("E0001", "b"));
    assert_eq!(codes("a: \"open\n")[0].0, "E0001");
    assert_eq!(codes("a: b: c\n")[0].0, "E0001");
    assert_eq!(codes("a: }\n"), one("E0001", "}"));
}

#[test]
fn a_comma_with_nothing_before_it_is_told_as_such() {
    for (text, column) in [("a: [0, 4, , 13]\n", 11), ("a: {b: 1, , c: 2}\n", 11)] {
        let source = SourceFile::new("a", text);
        let mut diagnostics = Diagnostics::new();
        read(&source, &mut diagnostics);
        let finding = diagnostics.iter().next().expect("a finding");
        assert_eq!(source.line_column(finding.span.start), (1, column), "{text}");
        assert_eq!(finding.message, "this is not YAML: nothing is given before this comma", "{text}");
    }
}

#[test]
fn an_open_bracket_is_shown_beside_the_place_where_reading_failed() {
    let source = SourceFile::new("a", "a: [1\nb: 2\n");
    let mut diagnostics = Diagnostics::new();
    read(&source, &mut diagnostics);
    let finding = diagnostics.iter().next().expect("a finding");
    assert_eq!(source.line_column(finding.span.start), (2, 2));
    assert_eq!(source.line_column(finding.secondary[0].0.start), (1, 4));
}

#[test]
fn empty_files_are_told() {
    for text in ["", "\n\n", "# a comment\n", "---\n", "\u{feff}", "~"] {
        assert_eq!(codes(text), one("E0002", ""), "{text:?}");
    }
}

#[test]
fn every_duplicate_key_is_told_with_both_places() {
    let text = "a: 1\nb: {c: 1, c: 2, c: 3}\na: 4\n'a': 5\n";
    let source = SourceFile::new("a", text);
    let mut diagnostics = Diagnostics::new();
    let node = read(&source, &mut diagnostics).expect("a tree");
    let places = diagnostics.iter().map(|one| (one.code, one.span.start, one.secondary[0].0.start));
    let expected = [("E0005", 15, 9), ("E0005", 21, 9), ("E0005", 27, 0), ("E0005", 32, 0)];
    assert_eq!(places.collect::<Vec<_>>(), expected);
    assert_eq!(node.get("a").and_then(Node::text), Some("1"));
}

#[test]
fn keys_must_be_names() {
    assert_eq!(codes("[a]: 1\nb: 2\n"), one("E0006", "[a]"));
    assert_eq!(codes("{a: 1}: 1\n"), one("E0006", "{a: 1}"));
    assert_eq!(codes("~: 1\n"), one("E0006", "~"));
}

#[test]
fn one_document_only() {
    assert_eq!(codes("a: 1\n---\na: 2\n"), one("E0007", "---"));
    good("---\na: 1\n...\n");
}

#[test]
fn aliases_and_tags_are_refused_wherever_they_stand() {
    let text = "a: &x 1\nb: *x\nc: *unknown\n*x : 3\n";
    let found = codes(text);
    let aliases: Vec<_> = found.iter().filter(|one| one.0 == "E0004").map(|one| one.1.as_str()).collect();
    assert_eq!(aliases, ["*x", "*unknown", "*x"]);
    assert_eq!(codes("a: !thing 1\n"), one("E0008", "!thing"));
    assert_eq!(codes("a: !!str 1\n"), one("E0008", "!!str"));
}

/// Ends soon, with a finding of the code first. The bound is loose: tests run unoptimised beside others.
fn bounded(text: &str, code: &str) {
    let start = Instant::now();
    let (node, found) = read_text(text);
    let spent = start.elapsed();
    assert!(node.is_none());
    assert!(found.len() <= 100 && found[0].0 == code, "{} {:?}", found.len(), found[0].0);
    assert!(spent < Duration::from_secs(10), "{spent:?}");
}

#[test]
fn billions_of_laughs_are_refused() {
    let mut text = "a0: &a0 [lol, lol]\n".to_owned();
    for level in 1..40 {
        let before = format!("*a{}", level - 1);
        text += &format!("a{level}: &a{level} [{before}, {before}, {before}]\n");
    }
    bounded(&text, "E0004");
}

#[test]
fn deep_nesting_is_refused() {
    bounded(&"[".repeat(10_000), "E0004");
    bounded(&"{a: ".repeat(10_000), "E0004");
    bounded(&"- ".repeat(10_000), "E0004");
    let indented = (0..2_000).map(|level| format!("{}a:\n", " ".repeat(level)));
    bounded(&indented.collect::<String>(), "E0004");
    let inner = "[".repeat(MAX_DEPTH) + &"]".repeat(MAX_DEPTH);
    good(&inner);
}

#[test]
fn large_files_are_refused() {
    bounded(&"# a\n".repeat(2_500_001), "E0003");
    bounded(&"x".repeat(10_000_000), "E0003");
    bounded(&"- 1\n".repeat(2_000_000), "E0004");
    bounded(&format!("[{}]", "1,".repeat(4_000_000)), "E0004");
    bounded(&"a: 1\n".repeat(1_600_000), "E0005");
}

#[test]
fn long_single_values_are_read_in_time() {
    let start = Instant::now();
    let long = "x".repeat(4_000_000);
    good(&format!("a: {long}\n"));
    good(&format!("a: \"{long}\"\n"));
    good(&format!("a: 1 # {long}\n"));
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
}
