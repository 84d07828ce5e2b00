//! What the texts of quantities mean, and which part of a wrong one is wrong.

use super::*;
use crate::diagnostic::Diagnostics;
use crate::source::SourceFile;
use crate::yaml;

fn value(text: &str) -> (f64, String) {
    let quantity = parse_quantity(text).expect(text);
    (quantity.value, quantity.kind_name())
}

fn close(text: &str, expected: f64, kind: &str) {
    let (value, name) = value(text);
    assert!((value - expected).abs() <= expected.abs() * 1e-14, "{text}: {value}");
    assert_eq!(name, kind, "{text}");
}

#[test]
fn every_unit_has_its_size() {
    for (text, expected) in [("2 mm", 2.0), ("2 um", 2e-3), ("2 nm", 2e-6), ("2 m", 2000.0), ("2 cm", 20.0)] {
        close(text, expected, "a length");
    }
    for (text, expected) in [("2 in", 50.8), ("2 mil", 0.0508), ("2 uin", 50.8e-6), ("2 \u{b5}in", 50.8e-6)] {
        close(text, expected, "a length");
    }
    for (text, expected) in [("2 \u{b5}m", 2e-3), ("2 \u{3bc}m", 2e-3), ("2\u{3bc}in", 50.8e-6)] {
        close(text, expected, "a length");
    }
    let degree = std::f64::consts::PI / 180.0;
    for (text, expected) in [("2 rad", 2.0), ("2 mrad", 2e-3), ("2 urad", 2e-6), ("2 \u{b5}rad", 2e-6)] {
        close(text, expected, "an angle");
    }
    for (text, expected) in
        [("3 deg", degree * 3.0), ("180 arcmin", degree * 3.0), ("10800 arcsec", degree * 3.0)]
    {
        close(text, expected, "an angle");
    }
    for (text, expected) in [("2 s", 2.0), ("2 ms", 2e-3), ("2 min", 120.0)] {
        close(text, expected, "a time");
    }
    for (text, expected) in [("16.28 1/s", 16.28), ("50 Hz", 50.0), ("60 1/min", 1.0)] {
        close(text, expected, "a frequency");
    }
    for (text, kind) in
        [("2 N", "a force"), ("2 V", "a voltage"), ("2 A", "a current"), ("2 %", "a percentage")]
    {
        close(text, 2.0, kind);
    }
    close("2 count", 2.0, "a count");
    close("2 counts", 2.0, "a count");
}

#[test]
fn ratios_are_counted_out() {
    close("100 um/m", 1e-4, "a ratio");
    close("3 um/K", 3e-3, "a length per temperature");
    close("11.5 um/m/K", 11.5e-6, "a ratio per temperature");
    close("9 um/degF", 16.2e-3, "a length per temperature");
    close("600 mm/min", 10.0, "a length per time");
    close("2 mm/s", 2.0, "a length per time");
    close("60 in/min", 25.4, "a length per time");
    close("0.063 mil/in", 63e-6, "a ratio");
    close("2 urad / K", 2e-6, "an angle per temperature");
    close("400 1/s^2", 400.0, "a ratio per time squared");
    close("400 1/s/s", 400.0, "a ratio per time squared");
    close("9.81 m/s\u{b2}", 9810.0, "a length per time squared");
}

#[test]
fn products_stand_above_the_line() {
    close("20 mK.s/mm", 0.02, "a time temperature per length");
    close("20 K*s/mm", 20.0, "a time temperature per length");
    close("3 um.s", 3e-3, "a length time");
    close("2 N . m", 2000.0, "a length force");
    // Only there: what follows a line is divided by, and a product of it would be read in two ways.
    assert_eq!(parse_unit("um/N.K").expect_err("no unit").code, "E0304");
    assert_eq!(parse_unit("um.").expect_err("no unit").code, "E0305");
    assert_eq!(parse_unit(".s").expect_err("no unit").code, "E0305");
}

#[test]
fn temperatures_alone_know_their_zero() {
    assert_eq!(value("20 degC").0, 20.0);
    assert_eq!(value("68 degF").0, 20.0);
    assert_eq!(value("293.15 K").0, 20.0);
    assert_eq!(value("-40 \u{b0}F").0, -40.0);
    let in_ratio = parse_unit("um/K").expect("a unit");
    assert_eq!((in_ratio.offset, parse_unit("K").expect("a unit").offset), (0.0, -273.15));
}

#[test]
fn numbers_are_read_as_people_write_them() {
    for (text, expected) in
        [("2", 2.0), ("+2", 2.0), ("-.5", -0.5), ("5.", 5.0), ("1e-3", 1e-3), ("1E+3", 1e3), (" 007 ", 7.0)]
    {
        assert_eq!(parse_number(text), Ok(expected), "{text}");
        assert!(parse_quantity(text).expect(text).is_bare());
    }
    assert_eq!(value("10um").0, 0.01);
    assert_eq!(value("1e-3mm").0, 1e-3);
}

fn wrong(text: &str) -> (&'static str, String, String) {
    let error = parse_quantity(text).expect_err(text);
    let part = text.get(error.range.clone()).expect("a part").to_owned();
    (error.code, part, error.help.unwrap_or_default())
}

fn expect(text: &str, code: &str, part: &str, help: &str) {
    let (found, under, advice) = wrong(text);
    assert_eq!((found, under.as_str()), (code, part), "{text}");
    assert!(advice.contains(help), "{text}: {advice}");
}

#[test]
fn wrong_numbers_are_located() {
    expect("ten um", "E0301", "ten um", "10 um");
    expect("", "E0301", "", "10 um");
    expect(". mm", "E0301", ". mm", "10 um");
    expect(" \u{2212}5 um", "E0301", "\u{2212}5 um", "`-`");
    expect("1,5 mm", "E0303", "1,5", "`1.5`");
    expect("-12,25", "E0303", "-12,25", "`-12.25`");
    expect("nan mm", "E0302", "nan mm", "measured");
    expect("-.inf", "E0302", "-.inf", "measured");
    expect("1e999 mm", "E0302", "1e999", "");
    expect("1e308 m", "E0302", "1e308 m", "");
}

#[test]
fn wrong_units_are_located() {
    expect("10 micron", "E0304", "micron", "`um`");
    expect("10 MM", "E0304", "MM", "`mm`");
    expect("10 \u{b5}mm", "E0304", "\u{b5}mm", "`");
    expect("20 C", "E0304", "C", "`degC`");
    expect("20 degc", "E0304", "degc", "`degC`");
    expect("10 arcsecs", "E0304", "arcsecs", "`arcsec`");
    expect("10 furlong", "E0304", "furlong", "use one of the units mm");
    expect("11 um/mtr/K", "E0304", "mtr", "");
    expect("10 1", "E0305", "1", "1/s");
    expect("10 um/", "E0305", "", "1/s");
    expect("10 /s", "E0305", "", "1/s");
    expect("10 mm/s^9", "E0305", "s^9", "s^2");
    expect("10 mm/s^x", "E0305", "s^x", "s^2");
}

fn findings(text: &str, read: impl Fn(&yaml::Node, &mut Diagnostics)) -> Vec<(&'static str, String, String)> {
    let source = SourceFile::new("a.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let node = yaml::read(&source, &mut diagnostics).expect("a tree");
    read(node.get("a").expect("a value"), &mut diagnostics);
    let found = diagnostics.iter();
    found.map(|one| (one.code, source.slice(one.span).to_owned(), one.message.clone())).collect()
}

fn one(code: &'static str, part: &str, message: &str) -> Vec<(&'static str, String, String)> {
    vec![(code, part.to_owned(), message.to_owned())]
}

#[test]
fn kinds_are_compared_at_the_unit() {
    let step = |text: &str| {
        findings(text, |node, all| assert_eq!(read(node, Dimension::LENGTH, "the step", all), None))
    };
    let message = "the step must be a length, but `arcsec` is an angle";
    assert_eq!(step("\u{b5}: \u{b5}\na: 5 arcsec\n"), one("E0307", "arcsec", message));
    assert_eq!(step("a: \"5 arcsec\"\n"), one("E0307", "arcsec", message));
    assert_eq!(step("a: 5 um/m\n"), one("E0307", "um/m", "the step must be a length, but `um/m` is a ratio"));
    assert_eq!(step("a: 5\n"), one("E0306", "5", "the step needs a unit: it is a length"));
    assert_eq!(step("a: 5 \u{b5}q\n"), one("E0304", "\u{b5}q", "unknown unit `\u{b5}q`"));
    let list = "the step must be a length such as `10 mm`, found a list";
    assert_eq!(step("a: [5 mm]\n"), one("E0308", "[5 mm]", list));
    let nothing = "the step must be a length such as `10 mm`, found nothing";
    assert_eq!(step("a:\n"), one("E0308", "a", nothing));
}

#[test]
fn bare_numbers_and_units_are_read_from_nodes() {
    let number =
        |text: &str| findings(text, |node, all| assert_eq!(read_number(node, "an entry", all), None));
    let message = "an entry takes no unit here";
    assert_eq!(number("a: 5 mm\n"), one("E0309", "mm", message));
    assert_eq!(number("a: .nan\n")[0].0, "E0302");
    assert_eq!(number("a: 5 oops\n"), one("E0301", "5 oops", "`5 oops` is not a number"));
    assert_eq!(number("a: {}\n")[0].0, "E0308");
    let unit = |text: &str| findings(text, |node, all| assert_eq!(read_unit(node, "the unit", all), None));
    assert_eq!(unit("a: 5 mm\n")[0].0, "E0304");
    assert_eq!(unit("a: [um]\n")[0].0, "E0308");
    assert_eq!(unit("a: um/\n")[0].0, "E0305");
}

#[test]
fn an_unknown_unit_is_answered_with_one_of_the_kind_that_is_needed() {
    let help = |text: &str, kind: Dimension| {
        let source = SourceFile::new("a.yaml", text);
        let mut diagnostics = Diagnostics::new();
        let node = yaml::read(&source, &mut diagnostics).expect("a tree");
        assert_eq!(read(node.get("a").expect("a value"), kind, "it", &mut diagnostics), None);
        diagnostics.iter().filter_map(|one| one.help.clone()).collect::<String>()
    };
    assert_eq!(help("a: '25\"'\n", Dimension::LENGTH), "did you mean `in`?");
    assert_eq!(help("a: '25\"'\n", Dimension::ANGLE), "did you mean `arcsec`?");
    assert_eq!(help("a: 2 kg\n", Dimension::LENGTH), "use a unit such as `mm`");
    assert_eq!(help("a: 2 micron\n", Dimension::LENGTH), "did you mean `um`?");
    assert_eq!(help("a: 2 arcsecs\n", Dimension::ANGLE), "did you mean `arcsec`?");
}
