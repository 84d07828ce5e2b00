//! A recording file to begin with. In: the names of a table's columns. Out: a recording file in which each column that has a known name
//! is a channel, and each other one a comment.

use std::path::Path;

use crate::failure::Failure;
use crate::load;

/// What a column is taken for, by the words of its name.
struct Guess {
    channel: String,
    unit: String,
}

/// Names of columns stand among the first lines, below what a program says of itself.
const MOST_LINES: usize = 100;

/// Words of names, and what they are about. The first that fits counts.
const WORDS: [(&[&str], Meaning); 8] = [
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
    (&["meas", "measured", "laser", "true", "tip", "probe"], Meaning::Measured),
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
    Load,
}

/// Units that stand in names of columns.
const UNITS: [&str; 18] = [
    "mm", "um", "nm", "m", "in", "deg", "mdeg", "arcsec", "rad", "mrad", "urad", "s", "ms", "us", "min",
    "degC", "K", "N",
];

/// The columns of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    /// Their names.
    pub names: Vec<String>,
    /// The line in which they stand, where it is not the first that is no comment.
    line: Option<usize>,
}

/// The columns of the table in a file: of Parquet and workbooks as they say, of a text the last line above the first row of numbers.
///
/// # Errors
///
/// A file that cannot be read, and one in which no names stand above numbers.
pub fn columns(data: &Path) -> Result<Columns, Failure> {
    if let Some(names) = ::recording::column_names(data).map_err(|error| Failure::wrong(error.to_string()))? {
        return Ok(Columns { names, line: None });
    }
    let head = load::head_of_file(data)?.map_or_else(|| load::bytes(data), Ok)?;
    let text = String::from_utf8_lossy(&head);
    of_text(&text).ok_or_else(|| {
        Failure::no(format!(
            "error: {} has no row of column names, separated by commas, semicolons or tabs, above its numbers\n\
             help: write the names above the first row of numbers, such as `t,x_cmd,y_cmd`, without a `#`",
            data.display()
        ))
    })
}

/// The columns of a text; nothing where no names stand above a row of numbers.
fn of_text(text: &str) -> Option<Columns> {
    let text = text.trim_start_matches('\u{feff}');
    let lines = text.lines().enumerate().take(MOST_LINES);
    let lines: Vec<(usize, &str)> = lines.filter(|(_, line)| !line.trim().is_empty()).collect();
    let data = lines.iter().position(|(_, line)| is_of_numbers(line))?;
    let above = lines.get(..data)?.iter().rev().find(|(_, line)| !line.starts_with("#unit"));
    let (number, header) = *above.filter(|(_, line)| !line.starts_with('#'))?;
    let separator = separator_of(lines.get(data)?.1)?;
    let names: Vec<String> =
        header.split(separator).map(|name| name.trim().trim_matches('"').to_owned()).collect();
    let first = lines.iter().find(|(_, line)| !line.starts_with('#'))?.0;
    Some(Columns { names, line: (first != number).then(|| number.saturating_add(1)) })
}

fn separator_of(line: &str) -> Option<char> {
    [',', ';', '\t'].into_iter().find(|separator| line.contains(*separator))
}

/// Whether most cells of a line are numbers. Dates and words may stand among them.
fn is_of_numbers(line: &str) -> bool {
    let Some(separator) = separator_of(line).filter(|_| !line.starts_with('#')) else { return false };
    let cells: Vec<&str> = line.split(separator).map(str::trim).filter(|cell| !cell.is_empty()).collect();
    let numbers = cells.iter().filter(|cell| cell.parse::<f64>().is_ok()).count();
    numbers > 0 && numbers.saturating_mul(2) >= cells.len()
}

/// Why a table makes no recording by itself, with a recording file for its columns; `None` where the file is no table.
#[must_use]
pub fn table_alone(data: &Path) -> Option<Failure> {
    let name = data.file_name().unwrap_or(data.as_os_str()).to_string_lossy();
    let text = recording(&name, &columns(data).ok()?, None);
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
    let guesses: Vec<Option<Guess>> = guessed(&columns.names);
    let data = match columns.line {
        Some(line) => format!("{{file: {}, header: {line}}}", quoted(data)),
        None => quoted(data),
    };
    let has = |kind: &str| guesses.iter().flatten().any(|guess| guess.channel.starts_with(kind));
    let instrument = if has("deviation") { "ballbar" } else { "position" };
    let mut text = format!(
        "# A recording file for Abbe: what the columns of a table mean. Check each line: the channels are guessed from the names.\n\
         recording: 1\n\
         # title: a line for people\n\
         machine: {}\n\
         # calibration: mill.yaml   # what is already known of the machine\n\
         instrument: {instrument}   # position, ballbar, linear, straightness, angular or probe\n\
         data: {data}\n\
         channels:\n",
        machine.unwrap_or("XYFZ   # a machine file, a shipped machine or a topology word")
    );
    for (column, guess) in columns.names.iter().zip(&guesses) {
        text += &channel(column, guess.as_ref());
    }
    if instrument == "ballbar" {
        text +=
            "setup: {center: [0 mm, 0 mm, 0 mm], radius: 100 mm}   # of the tool tip, tool offset included\n";
    }
    text
}

/// The line of a column.
fn channel(column: &str, guess: Option<&Guess>) -> String {
    match guess {
        Some(Guess { channel, unit }) if unit.is_empty() => {
            format!("  {channel}: {{column: {}}}\n", quoted(column))
        }
        Some(Guess { channel, unit }) => {
            format!("  {channel}: {{column: {}, unit: {unit}}}\n", quoted(column))
        }
        None => format!(
            "  # {}: the name suggests no channel; channels are command.x, measured.x, ...\n",
            quoted(column)
        ),
    }
}

/// What each column is taken for; a channel is given once.
fn guessed(columns: &[String]) -> Vec<Option<Guess>> {
    let mut taken: Vec<String> = Vec::new();
    let guess = |column: &String| {
        let guess = guess(column).filter(|guess| !taken.contains(&guess.channel))?;
        taken.push(guess.channel.clone());
        Some(guess)
    };
    columns.iter().map(guess).collect()
}

/// What a column is taken for by its name alone: an axis alone is a command.
fn guess(column: &str) -> Option<Guess> {
    let words = words(column);
    let unit =
        words.iter().rev().find_map(|word| UNITS.into_iter().find(|unit| unit.eq_ignore_ascii_case(word)));
    let axis = words.iter().find(|word| word.len() == 1 && "xyzuvwabc".contains(word.as_str()));
    let meaning = meaning(column, &words);
    let by_axis = |kind: &str, axis: &String| Guess {
        channel: format!("{kind}.{axis}"),
        unit: unit.unwrap_or(if "abc".contains(axis.as_str()) { "deg" } else { "mm" }).to_owned(),
    };
    let named = |kind: &str, default: &str| Guess {
        channel: format!("{kind}.{}", words.join("_")),
        unit: unit.unwrap_or(default).to_owned(),
    };
    match (meaning, axis) {
        (Some(Meaning::Time), _) => {
            Some(Guess { channel: "time".to_owned(), unit: unit.unwrap_or("s").to_owned() })
        }
        (Some(Meaning::Run), _) => Some(Guess { channel: "run".to_owned(), unit: String::new() }),
        (Some(Meaning::Temperature), _) => Some(named("temperature", "degC")),
        (Some(Meaning::Load), _) => Some(named("load", "N")),
        (Some(Meaning::Deviation), _) => {
            Some(Guess { channel: "deviation".to_owned(), unit: unit.unwrap_or("um").to_owned() })
        }
        (Some(Meaning::Command) | None, Some(axis)) => Some(by_axis("command", axis)),
        (Some(Meaning::Actual), Some(axis)) => Some(by_axis("actual", axis)),
        (Some(Meaning::Measured), Some(axis)) => Some(by_axis("measured", axis)),
        (_, None) => None,
    }
}

/// What a name is about. `T_spindle` and `T19` are temperatures, `t` and `t_s` are times.
fn meaning(column: &str, words: &[String]) -> Option<Meaning> {
    let after_t = column.strip_prefix('T').and_then(|rest| rest.chars().next());
    if after_t.is_some_and(|letter| letter == '_' || letter.is_ascii_digit()) {
        return Some(Meaning::Temperature);
    }
    let known = |(known, _): &&(&[&str], Meaning)| words.iter().any(|word| known.contains(&word.as_str()));
    WORDS.iter().find(known).map(|(_, meaning)| *meaning)
}

/// The words of a name: `X_cmd [mm]` is x, cmd, mm.
fn words(column: &str) -> Vec<String> {
    let parts = column.split(|letter: char| !letter.is_alphanumeric());
    parts.filter(|part| !part.is_empty()).map(str::to_lowercase).collect()
}

/// A name as YAML takes it: in quotes where it is more than a plain word.
fn quoted(name: &str) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || "_-./".contains(letter);
    let begins = name.starts_with(|letter: char| letter.is_alphabetic() || letter == '_' || letter == '/');
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

    use super::*;
    use crate::load;

    fn channels(first_line: &str) -> Vec<(String, String)> {
        let names: Vec<String> = first_line.split(';').map(str::to_owned).collect();
        let guesses = guessed(&names);
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
    fn names_stand_above_the_first_row_of_numbers() {
        let names = |text: &str| of_text(text).map(|columns| (columns.names.join("|"), columns.line));
        assert_eq!(names("t,x\n0,1\n"), Some(("t|x".to_owned(), None)));
        assert_eq!(names("# a program\n\nt;x\n#unit;s;mm\n0;1\n"), Some(("t|x".to_owned(), None)));
        assert_eq!(names("Spindle test, machine 3\nt,x\n0,1\n"), Some(("t|x".to_owned(), Some(2))));
        assert_eq!(names("when\tx\n2026-07-09T10:00:00\t1\n"), Some(("when|x".to_owned(), None)));
        for none in ["1,2\n3,4\n", "# t,x\n0,1\n", "recording: 1\ntitle: a, b\n", "", "just words, and more"]
        {
            assert_eq!(names(none), None, "{none}");
        }
    }

    #[test]
    fn a_ballbar_and_positions_are_read_as_they_are() {
        let equations = load::machine("XYFZ", None, &()).ok().unwrap().compiled.equations;
        for line in ["time,run,x_cmd,y_cmd,dev_um,'odd'", "t,x,measured x", "Zeit [s]\tX soll\tX ist\ttrue"] {
            let numbers: String =
                line.chars().map(|letter| if ",\t".contains(letter) { letter } else { '1' }).collect();
            let text = recording("my data.csv", &of_text(&format!("{line}\n{numbers}\n")).unwrap(), None);
            let source = SourceFile::new("recording.yaml", text);
            let mut diagnostics = Diagnostics::new();
            let root = yaml::read(&source, &mut diagnostics).unwrap();
            let header = ::recording::read_header(&root, &equations, &mut diagnostics);
            assert!(header.is_some() && diagnostics.is_empty(), "{line}: {diagnostics:?}\n{}", source.text());
        }
    }
}
