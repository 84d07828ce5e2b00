//! `abbe fleet show`: what changed in a fleet. In: its results. Out: text, JSON, one page, or a folder of pages.

use std::fs;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use fleet::file::Fleet;
use fleet::history::{History, history};
use fleet::report::{json, page, pages, text};
use recording::Moment;
use workshop::failure::Failure;
use workshop::named::relative;
use workshop::origin::word;
use workshop::written;

use crate::arguments::{FleetFormat, FleetShow};
use crate::output::{Person, print, terminal};

/// Runs the command. Status 1 where there is no result at all.
pub(super) fn run(arguments: &FleetShow) -> Result<(), Failure> {
    let fleet = super::read(&arguments.fleet)?;
    let known = history(&fleet, arguments.until.unwrap_or_else(now), &Person::default())?;
    if known.machines.iter().all(|machine| machine.recordings.is_empty()) {
        if let Some(until) = arguments.until
            && let Some(first) = first(&fleet)?
        {
            let help = "help: name a later day";
            let text = format!(
                "error: no recording with a result was made until {until}; the first is of {first}\n{help}"
            );
            return Err(Failure::no(text));
        }
        let help = "help: `abbe fleet run` diagnoses the recordings first";
        return Err(Failure::no(format!("error: {} contains no result\n{help}", fleet.results.display())));
    }
    let command = command(arguments);
    if let Some(folder) = &arguments.output {
        return write(&known, folder, &command);
    }
    print(&match arguments.format {
        FleetFormat::Text => text(&known, terminal().columns),
        FleetFormat::Json => json(&known),
        FleetFormat::Html => page(&known, &command),
    })
}

/// When the first recording that has a result was made; nothing where none has.
fn first(fleet: &Fleet) -> Result<Option<Moment>, Failure> {
    let Some(end) = Moment::read("9999-12-31T23:59:59") else { return Ok(None) };
    let all = history(fleet, end, &())?.machines;
    Ok(all.iter().filter_map(|machine| machine.recordings.first()).map(|entry| entry.time).min())
}

/// The moment it is; the last one that is known of a clock that is not set.
fn now() -> Moment {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    i64::try_from(since).ok().and_then(Moment::new).unwrap_or_else(Moment::first)
}

fn write(history: &History, folder: &Path, command: &str) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|error| written::cannot_write(folder, &error))?;
    let link = |page: &Path| relative(folder, page).ok().map(|link| link.replace('%', "%25"));
    pages(history, command, &link)
        .files
        .iter()
        .try_for_each(|(name, text)| written::whole(&folder.join(name), text))
}

/// The command that makes the pages again.
fn command(arguments: &FleetShow) -> String {
    let until = arguments.until.map(|until| format!(" --until {until}")).unwrap_or_default();
    let (fleet, folder) = (word(&arguments.fleet), arguments.output.as_deref().map(word));
    match folder {
        Some(folder) => format!("abbe fleet show {fleet}{until} --output {folder}"),
        None => format!("abbe fleet show {fleet}{until} --format html > fleet.html"),
    }
}
