//! The arguments of `abbe fleet`. In: words. Out: one of its commands with its options.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use fleet::run::Shard;
use recording::Moment;

use super::{LimitsFormat, examples};

#[derive(Args)]
pub(crate) struct Fleet {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: FleetCommand,
}

#[derive(Subcommand)]
pub(crate) enum FleetCommand {
    /// Diagnose the recordings that have no result yet, and follow what was found in any of them in all of their machine.
    #[command(after_help = examples::FLEET_RUN)]
    Run(FleetRun),
    /// Take over results that were made elsewhere from the same recordings.
    #[command(after_help = examples::FLEET_ADD)]
    Add(FleetAdd),
    /// Tell how each machine is, what changed, and what to look at.
    #[command(after_help = examples::FLEET_SHOW)]
    Show(FleetShow),
}

#[derive(Args)]
pub(crate) struct FleetRun {
    /// The fleet file, which says where the recordings of each machine are.
    #[arg(default_value = "fleet.yaml")]
    pub(crate) fleet: PathBuf,
    /// Do one of several parts of the jobs, as in 3/16: for several computers that share the folder.
    #[arg(long, value_name = "PART/OF", value_parser = shard)]
    pub(crate) shard: Option<Shard>,
    /// Do nothing: print the jobs that are still to be done, one a line, as JSON.
    #[arg(long)]
    pub(crate) list: bool,
    /// Do one job that --list printed, by its name; may be given several times.
    #[arg(long, value_name = "JOB", conflicts_with_all = ["shard", "list"])]
    pub(crate) job: Vec<String>,
    /// Write the page of each diagnosis as well, to which the pages of the fleet refer; it takes longer.
    #[arg(long, conflicts_with = "list")]
    pub(crate) pages: bool,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct FleetAdd {
    /// Folders of results.
    #[arg(required = true, value_name = "RESULTS")]
    pub(crate) results: Vec<PathBuf>,
    /// The fleet file, which says where the recordings of each machine are.
    #[arg(long, value_name = "FILE", default_value = "fleet.yaml")]
    pub(crate) fleet: PathBuf,
}

#[derive(Args)]
pub(crate) struct FleetShow {
    /// The fleet file, which says where the results are.
    #[arg(default_value = "fleet.yaml")]
    pub(crate) fleet: PathBuf,
    /// How to write it.
    #[arg(long, value_enum, default_value_t = LimitsFormat::Text)]
    pub(crate) format: LimitsFormat,
    /// Write the page of the fleet and a page for each machine into this folder.
    #[arg(long, value_name = "FOLDER", conflicts_with = "format")]
    pub(crate) output: Option<PathBuf>,
    /// Tell what was known at the end of this day, as in 2026-06-30; by default today.
    #[arg(long, value_name = "DATE", value_parser = moment)]
    pub(crate) until: Option<Moment>,
}

/// A moment; of a day alone its last one, since what was recorded on it belongs to it.
fn moment(text: &str) -> Result<Moment, String> {
    Moment::read(&format!("{}T23:59:59", text.trim()))
        .or_else(|| Moment::read(text))
        .ok_or_else(|| "a day is written as 2026-06-30, or 2026-06-30T12:00 with the time".to_owned())
}

fn shard(text: &str) -> Result<Shard, String> {
    Shard::read(text).ok_or_else(|| "a part is written as 3/16, from 1/16 to 16/16".to_owned())
}
