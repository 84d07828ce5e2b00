//! A recording file to begin with. In: the names of a table's columns. Out: a recording file in which each column that has a known name
//! is a channel, and each other one a comment.

use std::path::Path;

use model_dsl::quantity::{Dimension, parse_unit, unit_in_name, unit_name, unit_of_word};

use super::table::Columns;
use crate::failure::Failure;

/// What a column is taken for, by the words of its name.
struct Guess {
    channel: String,
    unit: String,
    /// Whether the name tells a unit that is none, or not one of such a channel.
    unknown: bool,
}

/// Words of names, and what they are about. The first that fits counts.
const WORDS: [(&[&str], Meaning); 9] = [
    (&["time", "t", "timestamp", "zeit", "seconds"], Meaning::Time),
    (&["run", "cycle", "lap", "repeat", "pass"], Meaning::Run),
    (&["temp", "temperature", "degc"], Meaning::Temperature),
    (&["dev", "deviation", "dr", "ballbar"], Meaning::Deviation),
    (
        &[
            "cmd",
            "command",
            "commanded",
            "set",
            "setpoint",
            "target",
            "ref",
            "demand",
            "soll",
            "desired",
            "prog",
        ],
        Meaning::Command,
    ),
    (&["act", "actual", "enc", "encoder", "feedback", "fbk", "fb", "ist", "drive"], Meaning::Actual),
    (&["laser", "probe", "reading", "readings", "indicator", "interferometer"], Meaning::Reading),
    (&["meas", "measured", "true", "tip"], Meaning::Measured),
    (&["load", "torque", "current", "force"], Meaning::Load),
];

#[derive(Clone, Copy, PartialEq)]
enum Meaning {
    Time,
    Run,
    Temperature,
    Deviation,
    Command,
    Actual,
    Measured,
    /// A position where an axis is named, else a deviation.
    Reading,
    Load,
}

/// Why a table makes no recording by itself, with a recording file for its columns; `None` where the file is no table.
#[must_use]
pub fn table_alone(data: &Path) -> Option<Failure> {
    let name = data.file_name().unwrap_or(data.as_os_str()).to_string_lossy();
    let text = recording(&name, &super::columns(data).ok()?, None);
    let text: String = text.lines().map(|line| format!("    {line}\n")).collect();
    Some(Failure::wrong(format!(
        "error: {} is a table, which does not say what its columns mean\n\
         help: write a recording file and give that instead (`abbe new recording` writes one), for example\n\n{text}",
        data.display()
    )))
}

/// A commented recording file for a table with these columns; `machine` names the machine, where it is known.
#[must_use]
pub fn recording(data: &str, columns: &Columns, machine: Option<&str>) -> String {
    let guesses: Vec<Option<Guess>> = guessed(columns);
    let (instrument, setup) = instrument(&guesses);
    let mut text = format!(
        "# A recording file for Abbe: what the columns of a table mean. Check each line: the channels are guessed from the names.\n\
         recording: 1\n\
         # title: a line for people\n\
         machine: {}\n\
         # calibration: mill.yaml   # what is already known of the machine\n\
         instrument: {instrument}\n\
         data: {}\n\
         channels:\n",
        machine.unwrap_or("XYFZ   # a machine file, a shipped machine or a topology word"),
        table(data, columns)
    );
    if !guesses.iter().flatten().any(|guess| guess.channel == "time") {
        text += NO_TIME;
    }
    for (column, guess) in columns.names.iter().zip(&guesses) {
        text += &channel(column, guess.as_ref());
    }
    text + setup
}

/// What a recording file needs that no column seems to hold.
const NO_TIME: &str = "  # time: {column: ..., unit: s}   # needed, but no column seems to be a time; if rows follow at equal steps: time: {every: 1 s}\n";

/// The value of `data`: the file, and what it does not tell itself.
fn table(data: &str, columns: &Columns) -> String {
    let header = columns.line.map(|line| format!(", header: {line}"));
    let separator = columns.spaced.then(|| ", separator: spaces".to_owned());
    let decimal = columns.decimal_comma.then(|| ", decimal: \",\"".to_owned());
    let form: String = [header, separator, decimal].into_iter().flatten().collect();
    if form.is_empty() { quoted(data) } else { format!("{{file: {}{form}}}", quoted(data)) }
}

/// The instrument that such channels are of, with what is to be checked, and its set-up.
fn instrument(guesses: &[Option<Guess>]) -> (&'static str, &'static str) {
    let all = || guesses.iter().flatten();
    let moved: Vec<&str> = all().filter_map(|guess| guess.channel.strip_prefix("command.")).collect();
    let Some(deviation) = all().find(|guess| guess.channel == "deviation") else {
        return ("position   # position, ballbar, linear, straightness, angular or probe", "");
    };
    let angle = parse_unit(&deviation.unit).is_ok_and(|unit| unit.dimension == Dimension::ANGLE);
    match moved.as_slice() {
        _ if angle => (
            "angular   # a level, an autocollimator or the angular optics of a laser",
            "setup: {direction: B}   # the axis of rotation that it reads: A, B or C for X, Y or Z\n",
        ),
        [axis] if "abc".contains(axis) => (
            "probe   # a displacement while a rotary axis turns",
            "setup: {direction: Z}   # the direction in which it reads\n",
        ),
        // Two axes or more move together on a circle.
        [_, _, ..] => (
            "ballbar   # position, ballbar, linear, straightness, angular or probe",
            "setup: {center: [0 mm, 0 mm, 0 mm], radius: 100 mm}   # of the tool tip, tool offset included\n",
        ),
        _ => (
            "linear   # a laser along the axis that moves; straightness for a reading across it",
            "# setup: {axis: X}   # the axis that moves; with straightness also direction: Y, in which it reads\n",
        ),
    }
}

/// The line of a column.
fn channel(column: &str, guess: Option<&Guess>) -> String {
    let Some(Guess { channel, unit, unknown }) = guess else {
        return format!(
            "  # {}: the name suggests no channel of this instrument; channels are command.x, measured.x, ...\n",
            quoted(column)
        );
    };
    let unit = if unit.is_empty() { String::new() } else { format!(", unit: {}", quoted(unit)) };
    let doubt = if *unknown { "   # the unit in the table is none that fits; check it" } else { "" };
    format!("  {channel}: {{column: {}{unit}}}{doubt}\n", quoted(column))
}

/// What each column is taken for; a channel is given once. Beside measured positions no instrument has a deviation.
fn guessed(columns: &Columns) -> Vec<Option<Guess>> {
    let mut taken: Vec<String> = Vec::new();
    let guess = |(number, column): (usize, &String)| {
        let unit = columns.units.get(number).filter(|unit| !unit.is_empty());
        let date = columns.dates.get(number).is_some_and(|date| *date);
        let guess = if date { Some(dates()) } else { guess(column, unit.map(String::as_str)) };
        let guess = guess.filter(|guess| !taken.contains(&guess.channel))?;
        taken.push(guess.channel.clone());
        Some(guess)
    };
    let guesses: Vec<Option<Guess>> = columns.names.iter().enumerate().map(guess).collect();
    let positions = taken.iter().any(|channel| channel.starts_with("measured."));
    let fits = |guess: &Guess| !(positions && guess.channel == "deviation");
    guesses.into_iter().map(|guess| guess.filter(fits)).collect()
}

/// What a column of dates is.
fn dates() -> Guess {
    Guess { channel: "time".to_owned(), unit: "date".to_owned(), unknown: false }
}

/// What a column is taken for by its name and its unit in the row of units: an axis alone is a command.
fn guess(column: &str, below: Option<&str>) -> Option<Guess> {
    let words = words(column);
    let axis = words.iter().find(|word| word.len() == 1 && "xyzuvwabc".contains(word.as_str()));
    let turns = axis.is_some_and(|axis| "abc".contains(axis.as_str()));
    let of = |channel: String, kinds: &[Dimension], default: &str| {
        let unit = match below {
            Some(below) => Some(below).filter(|unit| is_of(unit, kinds)).map(str::to_owned),
            None => unit_of(column, kinds),
        };
        let unknown = unit.is_none() && (below.is_some() || unit_in_name(column).is_some());
        Guess { channel, unit: unit.unwrap_or_else(|| default.to_owned()), unknown }
    };
    let by_axis = |kind: &str, axis: &String| {
        let (own, default) = if turns { (Dimension::ANGLE, "deg") } else { (Dimension::LENGTH, "mm") };
        of(format!("{kind}.{axis}"), &[own], default)
    };
    let named = |kind: &str, kinds: &[Dimension], default: &str| {
        of(format!("{kind}.{}", words.join("_")), kinds, default)
    };
    let deviation = || of("deviation".to_owned(), &[Dimension::LENGTH, Dimension::ANGLE], "um");
    match (meaning(column, &words)?, axis) {
        (Meaning::Time, _) => Some(of("time".to_owned(), &[Dimension::TIME], "s")),
        (Meaning::Run, _) => Some(Guess { channel: "run".to_owned(), unit: String::new(), unknown: false }),
        (Meaning::Temperature, _) => Some(named("temperature", &[Dimension::TEMPERATURE], "degC")),
        (Meaning::Load, _) => Some(named("load", &LOADS, "N")),
        (Meaning::Deviation, _) | (Meaning::Reading, None) => Some(deviation()),
        (Meaning::Command, Some(axis)) => Some(by_axis("command", axis)),
        (Meaning::Actual, Some(axis)) => Some(by_axis("actual", axis)),
        (Meaning::Measured | Meaning::Reading, Some(axis)) => Some(by_axis("measured", axis)),
        (_, None) => None,
    }
}

/// The kinds of unit that a load may have.
const LOADS: [Dimension; 5] =
    [Dimension::FORCE, Dimension::VOLTAGE, Dimension::CURRENT, Dimension::PERCENT, Dimension::COUNT];

/// Whether a text is a unit of one of some kinds.
fn is_of(unit: &str, kinds: &[Dimension]) -> bool {
    parse_unit(unit).is_ok_and(|unit| kinds.contains(&unit.dimension))
}

/// The unit that a name tells, of one of some kinds: in brackets, `X [mm]`, as a word, `x_mm`, or as a sign at its end, `load %`.
fn unit_of(column: &str, kinds: &[Dimension]) -> Option<String> {
    let fits = |unit: &&str| is_of(unit, kinds);
    if let Some((_, unit)) = unit_in_name(column) {
        let known = Some(unit).filter(fits).or_else(|| unit_of_word(unit));
        return known.filter(fits).map(str::to_owned);
    }
    if column.trim_end().ends_with('%') {
        return Some("%").filter(fits).map(str::to_owned);
    }
    // A short word counts only if it names a unit; a longer one may be what people call one.
    let told = |word: &str| if word.chars().count() > 3 { unit_of_word(word) } else { unit_name(word) };
    let words: Vec<&str> = column.split(|letter: char| !letter.is_alphanumeric()).collect();
    words.into_iter().rev().filter_map(told).find(fits).map(str::to_owned)
}

/// What a name is about. `T_spindle` and `T19` are temperatures, `t` and `t_s` are times.
fn meaning(column: &str, words: &[String]) -> Option<Meaning> {
    let after_t = column.strip_prefix('T').and_then(|rest| rest.chars().next());
    if after_t.is_some_and(|letter| letter == '_' || letter.is_ascii_digit()) {
        return Some(Meaning::Temperature);
    }
    let known = |(known, _): &&(&[&str], Meaning)| words.iter().any(|word| known.contains(&word.as_str()));
    let axis = words.iter().any(|word| word.len() == 1 && "xyzuvwabc".contains(word.as_str()));
    let named = WORDS.iter().find(known).map(|(_, meaning)| *meaning);
    named.or_else(|| axis.then_some(Meaning::Command))
}

/// The words of a name: `X_cmd [mm]` is x, cmd, mm.
fn words(column: &str) -> Vec<String> {
    let parts = column.split(|letter: char| !letter.is_alphanumeric());
    parts.filter(|part| !part.is_empty()).map(str::to_lowercase).collect()
}

/// A name as YAML takes it: in quotes where it is more than a plain word.
pub(super) fn quoted(name: &str) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || "_-./".contains(letter);
    let path = name.strip_prefix("../").or_else(|| name.strip_prefix("./")).is_some();
    let begins =
        path || name.starts_with(|letter: char| letter.is_alphabetic() || letter == '_' || letter == '/');
    let keyword =
        ["true", "false", "null", "yes", "no", "on", "off", "y", "n"].contains(&name.to_lowercase().as_str());
    if begins && !keyword && name.chars().all(plain) {
        return name.to_owned();
    }
    format!("'{}'", name.replace('\'', "''"))
}

#[cfg(test)]
mod tests {
    use model_dsl::diagnostic::Diagnostics;
    use model_dsl::source::SourceFile;
    use model_dsl::yaml;

    use super::super::table::of_text;
    use super::*;
    use crate::load;

    fn channels(first_line: &str) -> Vec<(String, String)> {
        let names: Vec<String> = first_line.split(';').map(str::to_owned).collect();
        let columns = Columns { names, ..of_text("t,x\n0,1\n").unwrap() };
        let guesses = guessed(&columns);
        guesses.into_iter().flatten().map(|guess| (guess.channel, guess.unit)).collect()
    }

    #[test]
    fn columns_are_known_by_the_words_of_their_names() {
        let known = channels("t_s;X_cmd [mm];y cmd;Laser X (um);T_spindle;temp_spindle_degC;foo");
        let known: Vec<(&str, &str)> =
            known.iter().map(|(name, unit)| (name.as_str(), unit.as_str())).collect();
        assert_eq!(
            known,
            [
                ("time", "s"),
                ("command.x", "mm"),
                ("command.y", "mm"),
                ("measured.x", "um"),
                ("temperature.t_spindle", "degC"),
                ("temperature.temp_spindle_degc", "degC"),
            ]
        );
    }

    #[test]
    fn a_unit_in_a_name_is_taken_if_it_fits() {
        let known =
            channels("t [h];Deviation [mil];A_cmd [arcmin];V cmd;T1 [degF];x act [inch];Y_act_MM;load [A]");
        let units: Vec<&str> = known.iter().map(|(_, unit)| unit.as_str()).collect();
        assert_eq!(units, ["h", "mil", "arcmin", "mm", "degF", "in", "mm", "A"]);
        let reading = channels("Laser reading (um)");
        assert_eq!(reading, [("deviation".to_owned(), "um".to_owned())]);
        let text = recording("d.csv", &of_text("t,Deviation [V]\n0,1\n").unwrap(), None);
        assert!(text.contains("unit: um}   # the unit in the table is none that fits"), "{text}");
        let load = channels("Spindle load %;load_2");
        let units: Vec<&str> = load.iter().map(|(_, unit)| unit.as_str()).collect();
        assert_eq!(units, ["%", "N"]);
    }

    #[test]
    fn the_row_of_units_and_the_form_of_the_times_count() {
        let of = |text: &str| recording("d.csv", &of_text(text).unwrap(), None);
        for mark in ["#unit", "# Units", "# laser\n#UNIT"] {
            let text = of(&format!("t,run,x,dev\n{mark},s,,mm,in\n0,1,0,0.1\n"));
            assert!(text.contains("  deviation: {column: dev, unit: in}\n"), "{text}");
        }
        let wrong = of("t,x,dev\n#unit,s,mm,degC\n0,0,0.1\n");
        assert!(wrong.contains("unit: um}   # the unit in the table is none that fits"), "{wrong}");
        let dates = of("timestamp,Xact,execution\n2026-03-01T08:00:00.000Z,99.9,ACTIVE\n");
        assert!(dates.contains("  time: {column: timestamp, unit: date}\n"), "{dates}");
    }

    #[test]
    fn what_no_column_holds_is_said() {
        let text = recording("d.csv", &of_text("x,deviation\n0,1\n").unwrap(), None);
        assert!(text.contains("# time: {column: ..., unit: s}   # needed"), "{text}");
        let text = recording("d.csv", &of_text("t;x\n0;0,5\n").unwrap(), None);
        assert!(
            text.contains("data: {file: d.csv, decimal: \",\"}\n") && !text.contains("# needed"),
            "{text}"
        );
    }

    #[test]
    fn each_recording_is_read_as_it_is() {
        let equations = load::machine("XYFZC", None, &()).ok().unwrap().compiled.equations;
        for (line, instrument) in [
            ("t,x,measured x,load [%]", "position"),
            ("time,run,x_cmd,y_cmd,dev_um,'odd'", "ballbar"),
            ("t,x,measured x", "position"),
            ("Zeit [s]\tX soll\tX ist\ttrue", "position"),
            ("t,x,deviation", "linear"),
            ("t;x;Laser reading (um)", "linear"),
            ("t,x,deviation [arcsec]", "angular"),
            ("t,c,deviation", "probe"),
            ("t,x,laser x,deviation", "position"),
        ] {
            let numbers: String =
                line.chars().map(|letter| if ",;\t".contains(letter) { letter } else { '1' }).collect();
            let text =
                recording("my data.csv", &of_text(&format!("{line}\n{numbers}\n")).unwrap(), Some("XYFZC"));
            assert!(text.contains(&format!("\ninstrument: {instrument}")), "{line}: {text}");
            let source = SourceFile::new("recording.yaml", text);
            let mut diagnostics = Diagnostics::new();
            let root = yaml::read(&source, &mut diagnostics).unwrap();
            let header = ::recording::read_header(&root, &equations, &mut diagnostics);
            assert!(header.is_some() && diagnostics.is_empty(), "{line}: {diagnostics:?}\n{}", source.text());
        }
    }
}
