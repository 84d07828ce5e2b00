//! The text on a terminal: a table of the findings that fits, and colour that changes no word.

use abbe_diagnosis::diagnosis::{Diagnosis, ParameterValue};
use abbe_diagnosis::report::{self, Terminal};

use crate::cases;

/// The text without what only sets it off.
fn without_codes(text: &str) -> String {
    let mut pieces = text.split('\u{1b}');
    let first = pieces.next().unwrap_or_default().to_owned();
    pieces.fold(first, |all, piece| all + piece.split_once('m').unwrap().1)
}

/// The lines of the table, its head first.
fn table(diagnosis: &Diagnosis, columns: usize) -> Vec<String> {
    let text = report::text_on(diagnosis, Terminal { columns, color: false });
    let part = text.split("\n\n").find(|part| part.starts_with("motion "));
    part.map_or(Vec::new(), |part| part.lines().map(str::to_owned).collect())
}

#[test]
fn each_finding_has_its_line_with_the_interval_and_what_the_held_out_data_say() {
    let table = table(&cases::two_findings(), 100);
    let cells = |line: &str| {
        line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(cells(&table[0]), ["motion", "term", "how much", "share", "held-out rms"]);
    assert_eq!(
        cells(&table[1]),
        ["EYY", "backlash", "lost motion 9.80 +- 0.30 um", "83 %", "5.1 -> 0.60 um"]
    );
    assert_eq!(
        cells(&table[2]),
        ["EXX", "expansion", "coefficient 7.180 +- 0.052 ppm/K", "13 %", "1.2 -> 0.60 um"]
    );
    assert_eq!(table.len(), 3);
    assert!(self::table(&cases::adequate(), 100).is_empty(), "nothing was found");
}

#[test]
fn every_width_is_kept_and_the_last_columns_give_way_first() {
    let mut diagnosis = cases::two_findings();
    let long = diagnosis.findings[0].parameters[0].value.clone();
    let ParameterValue::Fitted(one) = long else { panic!("a fitted number") };
    diagnosis.findings[0].term = "table";
    diagnosis.findings[0].parameters = vec![abbe_diagnosis::diagnosis::Parameter {
        name: "values",
        value: ParameterValue::List(vec![one; 30]),
    }];
    let mut heads = Vec::new();
    for columns in [100, 80, 60, 50, 40] {
        let lines = table(&diagnosis, columns);
        let widest = lines.iter().map(|line| line.chars().count()).max().unwrap();
        assert!(widest <= columns, "{widest} in {columns}: {lines:#?}");
        let amount: String = lines.join(" ");
        assert!(["30", "numbers", "within"].iter().all(|word| amount.contains(word)), "{lines:#?}");
        heads.push(lines[0].clone());
    }
    assert!(heads[0].contains("held-out rms") && heads[0].contains("share"));
    assert!(heads[4].contains("how much") && !heads[4].contains("held-out rms"));
    // What is narrower or wider than any terminal.
    for columns in [0, 7, usize::MAX] {
        assert!(!table(&diagnosis, columns).is_empty());
    }
}

#[test]
fn colour_changes_no_word() {
    for (name, diagnosis) in cases::all() {
        let plain = report::text(&diagnosis);
        let colored = report::text_on(&diagnosis, Terminal { color: true, ..Terminal::default() });
        assert!(!plain.contains('\u{1b}'), "{name}");
        assert!(colored.contains('\u{1b}'), "{name}");
        assert_eq!(without_codes(&colored), plain, "{name}");
        // What is switched on is switched off again, the last of all too.
        assert!(colored.rsplit('\u{1b}').next().unwrap().starts_with("[0m"), "{name}");
    }
}
