//! The arguments of `abbe fleet`. In: words. Out: one of its commands with its options.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use fleet::run::Shard;
use recording::Moment;

use super::{FleetFormat, examples};

#[derive(Args)]
pub(crate) struct Fleet {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: FleetCommand,
}

#[derive(Subcommand)]
pub(crate) enum FleetCommand {
    /// Diagnose the recordings without a result, and follow each finding through all recordings of its machine.
    #[command(after_help = examples::FLEET_RUN)]
    Run(FleetRun),
    /// Add results that were made elsewhere from the same recordings.
    #[command(after_help = examples::FLEET_ADD)]
    Add(FleetAdd),
    /// Report the state of each machine, what changed, and what to check.
    #[command(after_help = examples::FLEET_SHOW)]
    Show(FleetShow),
}

#[derive(Args)]
pub(crate) struct FleetRun {
    /// The fleet file, which says where the recordings of each machine are.
    #[arg(default_value = "fleet.yaml")]
    pub(crate) fleet: PathBuf,
    /// Do one part of the jobs, as in 3/16, for several computers that share the folder.
    #[arg(long, value_name = "PART/OF", value_parser = shard)]
    pub(crate) shard: Option<Shard>,
    /// Do nothing; print the remaining jobs as JSON, one per line.
    #[arg(long)]
    pub(crate) list: bool,
    /// Do one job that --list printed, by its name. May be repeated.
    #[arg(long, value_name = "JOB", conflicts_with_all = ["shard", "list"])]
    pub(crate) job: Vec<String>,
    /// Also write the page of each diagnosis, to which the pages of the fleet link. Takes longer.
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
    /// How to write the report.
    #[arg(long, value_enum, default_value_t = FleetFormat::Text)]
    pub(crate) format: FleetFormat,
    /// Write the page of the fleet and a page for each machine into this folder.
    #[arg(long, value_name = "FOLDER", conflicts_with = "format")]
    pub(crate) output: Option<PathBuf>,
    /// Report what was known at the end of this day, as in 2026-06-30; by default today.
    #[arg(long, value_name = "DATE", value_parser = moment)]
    pub(crate) until: Option<Moment>,
}

/// A moment; of a day alone its last one, since what was recorded on it belongs to it.
fn moment(text: &str) -> Result<Moment, String> {
    Moment::read(&format!("{}T23:59:59", text.trim()))
        .or_else(|| Moment::read(text))
        .ok_or_else(|| "write a day such as 2026-06-30, or 2026-06-30T12:00 with the time".to_owned())
}

fn shard(text: &str) -> Result<Shard, String> {
    Shard::read(text).ok_or_else(|| "write a part such as 3/16, from 1/16 to 16/16".to_owned())
}
