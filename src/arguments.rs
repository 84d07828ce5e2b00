//! The arguments of the command line. In: words. Out: one command with its options.

mod choices;
mod examples;
mod fleet;
mod values;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use workshop::updated::{Datum, datum};

pub(crate) use choices::{
    CalibrateFormat, Color, EvaluationFormat, ExportFormat, ExportValue, Format, LimitsFormat, LinearUnit,
    Names, ReportFormat, UpdateFormat, UpdateMethod, VerdictName,
};
pub(crate) use fleet::{Fleet, FleetAdd, FleetCommand, FleetRun, FleetShow};
use values::{name, non_negative, place, range};

use crate::target::Target;

/// Compiles a machine tool's kinematic chain into its error equations and compensation code.
#[derive(Parser)]
#[command(name = "abbe", version, arg_required_else_help = true, max_term_width = 100, after_help = examples::ABBE)]
pub(crate) struct Arguments {
    /// Whether words for people are coloured. `auto`: where a terminal shows them, unless NO_COLOR is set.
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t = Color::Auto)]
    pub(crate) color: Color,
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Derive the error equations of a machine.
    #[command(after_help = examples::DERIVE)]
    Derive(Derive),
    /// Compare a machine's equations with a published set, term by term.
    #[command(after_help = examples::CHECK)]
    Check(Check),
    /// Print the Rust code that a machine file compiles to.
    #[command(after_help = examples::EXPAND)]
    Expand(Expand),
    /// Read positions (CSV) and write the predicted errors and the compensated positions.
    #[command(after_help = examples::COMPENSATE)]
    Compensate(Compensate),
    /// Find what the model of a machine leaves out, from recordings of the real one.
    #[command(after_help = examples::DIAGNOSE)]
    Diagnose(Diagnose),
    /// Tell what a recording could show: from which size on each effect would be found in it.
    #[command(after_help = examples::LIMITS)]
    Limits(Limits),
    /// Tell what a path would show that was not driven yet, and what to drive besides.
    #[command(after_help = examples::PLAN)]
    Plan(Plan),
    /// Write the recording that a calibration predicts: an exact machine, its instrument and their noise.
    #[command(after_help = examples::SIMULATE)]
    Simulate(Simulate),
    /// Make a calibration from instruments' files (lasers, levels, straightedges), or from what a controller corrects already.
    #[command(after_help = examples::CALIBRATE)]
    Calibrate(Calibrate),
    /// Change the coefficients of a calibration to what measured parts show.
    #[command(after_help = examples::UPDATE)]
    Update(Update),
    /// Give the standard figures of positioning and of circles from a recording (ISO 230-2, ISO 230-4).
    #[command(after_help = examples::EVALUATE)]
    Evaluate(Evaluate),
    /// Diagnose the recordings of many machines over years, once each, and tell what changed.
    #[command(after_help = examples::FLEET)]
    Fleet(Fleet),
    /// Write the files that a controller loads, and tell what they cannot carry.
    #[command(after_help = examples::EXPORT)]
    Export(Export),
    /// Write a commented file to start from: of a machine, a calibration, a recording, a set-up or a path.
    #[command(after_help = examples::NEW)]
    New(New),
    /// Explain a diagnostic code, a term, an error motion, a topology word or a word of the glossary; alone: list them.
    #[command(after_help = examples::EXPLAIN)]
    Explain(Explain),
    /// Print the completions of a shell for this command line.
    #[command(after_help = examples::COMPLETIONS)]
    Completions(Completions),
    /// Print the manual page, or write the pages of all commands into a folder.
    #[command(after_help = examples::MAN)]
    Man(Man),
}

#[derive(Args)]
pub(crate) struct Derive {
    /// A machine file, the name of a shipped machine, or a topology word such as XYFZ.
    pub(crate) machine: String,
    /// How to write the equations.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// Which names to print: those of ISO 230-1, or the machine file's symbols.
    #[arg(long, value_enum, default_value_t = Names::Symbols)]
    pub(crate) names: Names,
    /// Where the result goes.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Check {
    /// A machine file, the name of a shipped machine, or a topology word.
    pub(crate) machine: String,
    /// A file of equations.
    pub(crate) equations: PathBuf,
    /// Where the result goes.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Expand {
    /// A machine file, the name of a shipped machine, or a topology word.
    pub(crate) machine: String,
    /// Compile in a calibration of the machine as well: the numbers of a specimen become constants.
    #[arg(long, value_name = "FILE", conflicts_with = "c_abi")]
    pub(crate) calibration: Option<PathBuf>,
    /// Add what a library for controllers in C needs: a crate of type `staticlib` or `cdylib` that has this code and the
    /// crates abbe-runtime and abbe-c offers them the functions of `abbe.h`.
    #[arg(long)]
    pub(crate) c_abi: bool,
    /// Where the result goes.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Diagnose {
    /// Recordings of one machine, fitted together.
    #[arg(required = true, value_name = "RECORDING")]
    pub(crate) recordings: Vec<PathBuf>,
    /// How to write the diagnosis.
    #[arg(long, value_enum, default_value_t = ReportFormat::Text)]
    pub(crate) format: ReportFormat,
    /// Write the known calibration with the findings added; a file that is there is replaced as a whole.
    #[arg(long, value_name = "FILE")]
    pub(crate) write_calibration: Option<PathBuf>,
    /// A recording of the same machine that is not fitted: the findings are tested on it.
    #[arg(long, value_name = "RECORDING")]
    pub(crate) holdout: Option<PathBuf>,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
    /// End with status 1 where the verdict is one of these, with commas between them.
    #[arg(long, value_name = "VERDICTS", value_enum, value_delimiter = ',')]
    pub(crate) fail_on: Vec<VerdictName>,
    /// Where the result goes.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Limits {
    /// A recording.
    pub(crate) recording: PathBuf,
    /// Try which extra passes would tell apart what this recording cannot.
    #[arg(long)]
    pub(crate) passes: bool,
    /// What is asked, and how it is told.
    #[command(flatten)]
    pub(crate) asked: Asked,
}

#[derive(Args)]
pub(crate) struct Plan {
    /// A path file: where the axes would go, the instrument that would measure them, and its noise.
    pub(crate) path: PathBuf,
    /// A machine file, the name of a shipped machine, or a topology word; its constants are those of the file.
    #[arg(long, required_unless_present = "calibration", conflicts_with = "calibration")]
    pub(crate) machine: Option<String>,
    /// The calibration file of the machine, in place of the machine: its known errors.
    #[arg(long, value_name = "FILE")]
    pub(crate) calibration: Option<PathBuf>,
    /// What is asked, and how it is told.
    #[command(flatten)]
    pub(crate) asked: Asked,
}

/// What is asked of a recording or a path, and how it is told.
#[derive(Args)]
pub(crate) struct Asked {
    /// Ask for these alone: kinds (backlash), error motions (EXX) or axes (X), with commas between them.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
    /// The most diagnoses for each effect; most limits are known to 12 % after a dozen, and end there.
    #[arg(long, default_value_t = 40, value_parser = clap::value_parser!(u16).range(4..=1000))]
    pub(crate) trials: u16,
    /// The seed of signs, places and phases; the same seed gives the same limits.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// How to write what was found.
    #[arg(long, value_enum, default_value_t = LimitsFormat::Text)]
    pub(crate) format: LimitsFormat,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Where the result goes.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Compensate {
    /// The calibration file of the machine.
    pub(crate) calibration: PathBuf,
    /// How far an axis must move back before its direction counts as turned: mm, or deg for a
    /// rotary axis. It concerns axes without a `dir_` column.
    #[arg(long, default_value_t = 0.001, value_parser = non_negative)]
    pub(crate) hysteresis: f64,
    /// Take the tools of LinuxCNC's table (tool.tbl) in place of the calibration's own.
    #[arg(long, value_name = "FILE")]
    pub(crate) tools: Option<PathBuf>,
    /// The unit of the offsets in that table.
    #[arg(long, value_enum, default_value_t = LinearUnit::Mm, requires = "tools")]
    pub(crate) tools_unit: LinearUnit,
    /// The tool of rows that name none, and of the map: one of the calibration's tools, or of that table.
    #[arg(long, value_name = "NAME")]
    pub(crate) tool: Option<String>,
    /// Leave rows out that cannot be read or compensated, and count them on standard error.
    #[arg(long)]
    pub(crate) skip_bad: bool,
    /// Tell on standard error how long the errors are without compensation and with it, and how far the tool leans where its direction is derived.
    #[arg(long)]
    pub(crate) summary: bool,
    /// Leave terms out that no controller can compensate in real time, naming each on standard error.
    #[arg(long)]
    pub(crate) leave_out_uncompensable: bool,
    /// Draw the predicted error over the workspace, as SVG: over the tables of the calibration, or the positions read.
    #[arg(long, value_name = "FILE")]
    pub(crate) map: Option<PathBuf>,
    /// Replace a map that is there already.
    #[arg(long, requires = "map")]
    pub(crate) force: bool,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct Simulate {
    /// The calibration file of the machine: its true errors.
    pub(crate) calibration: PathBuf,
    /// A path file: where the axes go, and what measures them. Or a recording, which is then replayed.
    pub(crate) path: PathBuf,
    /// The folder for `recording.yaml` and `data.csv`; or the recording's own file, whose data get its name.
    #[arg(long, default_value = ".")]
    pub(crate) output: PathBuf,
    /// The seed of the noise, in place of the path file's; the same seed gives the same bytes.
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// The calibration that the recording names as known; what it lacks is concealed.
    #[arg(long)]
    pub(crate) known: Option<PathBuf>,
    /// Draw the path and what is read over time, as SVG.
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Replace files that are there already.
    #[arg(long)]
    pub(crate) force: bool,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct Calibrate {
    /// The set-up file, which names the machine and for each measurement or correction its file. Given files of instruments or
    /// controllers instead, the command says what a set-up of them must hold.
    #[arg(required = true, value_name = "SETUP")]
    pub(crate) files: Vec<PathBuf>,
    /// The calibration file to write.
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Replace a file that is there already.
    #[arg(long)]
    pub(crate) force: bool,
    /// How to write the report.
    #[arg(long, value_enum, default_value_t = CalibrateFormat::Text)]
    pub(crate) format: CalibrateFormat,
}

#[derive(Args)]
pub(crate) struct Update {
    /// The calibration file whose coefficients are to be changed.
    pub(crate) calibration: PathBuf,
    /// Recordings of measured parts of that machine, by a probe with normals or as positions.
    #[arg(required = true, value_name = "MEASUREMENTS")]
    pub(crate) measurements: Vec<PathBuf>,
    /// The new calibration file.
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Replace a file that is there already.
    #[arg(long)]
    pub(crate) force: bool,
    /// How the coefficients are found.
    #[arg(long, value_enum, default_value_t = UpdateMethod::Svd)]
    pub(crate) method: UpdateMethod,
    /// The share of the matrix's norm up to which singular values count as zero; readings times 2.2e-16 by default.
    #[arg(long, value_parser = non_negative)]
    pub(crate) tolerance: Option<f64>,
    /// Where the zero of a part is free: `free` in all directions, `turned` where the part may lie turned too, `none`, or some
    /// such as `z` or `x,z`.
    #[arg(long, default_value = "free", value_parser = datum)]
    pub(crate) datum: Datum,
    /// The parts were made with this calibration's compensation switched on.
    #[arg(long)]
    pub(crate) compensated: bool,
    /// How to write the report.
    #[arg(long, value_enum, default_value_t = UpdateFormat::Text)]
    pub(crate) format: UpdateFormat,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct Evaluate {
    /// A recording: stations approached from both sides, or circles. Or a set-up file of one measurement, or a laser's file.
    pub(crate) recording: PathBuf,
    /// The tool that was in the machine: one of the tools of the calibration that the recording names.
    #[arg(long, value_name = "NAME")]
    pub(crate) tool: Option<String>,
    /// How to write the figures.
    #[arg(long, value_enum, default_value_t = EvaluationFormat::Text)]
    pub(crate) format: EvaluationFormat,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Where the result goes.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Export {
    /// Whose files.
    #[arg(value_enum)]
    pub(crate) format: ExportFormat,
    /// The calibration file of the machine.
    pub(crate) calibration: PathBuf,
    /// The tool that the files are for: one of the calibration's tools; by default its constants themselves.
    #[arg(long, value_name = "NAME")]
    pub(crate) tool: Option<String>,
    /// The folder for the files.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub(crate) output: PathBuf,
    /// Replace files that are there already.
    #[arg(long)]
    pub(crate) force: bool,
    /// Write nothing: tell what the controller takes from this file, and what it loses. For LinuxCNC with the axis, as
    /// in X=x.comp; may be given several times.
    #[arg(long, value_name = "[AXIS=]FILE", conflicts_with_all = ["output", "force"])]
    pub(crate) check: Vec<String>,
    /// How far an axis goes, mm or deg, as in X=0:500; by default as far as the calibration's tables.
    #[arg(long, value_name = "AXIS=FROM:TO", value_parser = range)]
    pub(crate) range: Vec<(String, [f64; 2])>,
    /// Where an axis stands while the tables of others are made, mm or deg, as in Z=120; by default in the middle.
    #[arg(long, value_name = "AXIS=PLACE", value_parser = place)]
    pub(crate) at: Vec<(String, f64)>,
    /// So many points in each table, evenly spaced; by default the calibration's own, and more where something is curved.
    #[arg(long)]
    pub(crate) points: Option<usize>,
    /// What a number of a table is, where no public document of the controller says it (Sinumerik's CEC, HEIDENHAIN).
    #[arg(long, value_enum)]
    pub(crate) value: Option<ExportValue>,
    /// Leave terms out that no controller can compensate in real time, naming each on standard error.
    #[arg(long)]
    pub(crate) leave_out_uncompensable: bool,
    /// LinuxCNC: COMP_FILE_TYPE; by default 1.
    #[arg(long = "type", value_name = "TYPE", value_parser = clap::value_parser!(u8).range(0..=1))]
    pub(crate) kind: Option<u8>,
    /// LinuxCNC: the machine's unit of length; by default mm.
    #[arg(long, value_enum)]
    pub(crate) unit: Option<LinearUnit>,
    /// Sinumerik: the number of tables that CEC has; by default 8.
    #[arg(long)]
    pub(crate) tables: Option<usize>,
    /// Sinumerik, HEIDENHAIN, PMAC: the controller's name of an axis, or its motor's number, as in X=MX1.
    #[arg(long, value_name = "AXIS=NAME", value_parser = name)]
    pub(crate) name: Vec<(String, String)>,
    /// PMAC: counts of an axis's motor for a mm, or for a degree of a rotary axis, as in X=10000.
    #[arg(long, value_name = "AXIS=COUNTS", value_parser = place)]
    pub(crate) counts: Vec<(String, f64)>,
}

#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct New {
    /// The kind of file; a topology word alone is a machine.
    #[command(subcommand)]
    pub(crate) file: Option<NewFile>,
    /// A topology word: axes that carry the part, F for the bed, axes that carry the tool.
    #[arg(required = true)]
    pub(crate) topology: Option<String>,
    /// The file to write; by default it is printed.
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Replace a file that is there already.
    #[arg(long, global = true, requires = "output")]
    pub(crate) force: bool,
}

#[derive(Subcommand)]
pub(crate) enum NewFile {
    /// A machine file of a topology word, with its chain written out.
    #[command(after_help = examples::NEW_MACHINE)]
    Machine {
        /// Axes that carry the part, F for the bed, axes that carry the tool.
        topology: String,
    },
    /// A calibration file with every constant and error motion of a machine, all zero.
    #[command(after_help = examples::NEW_CALIBRATION)]
    Calibration {
        /// A machine file, the name of a shipped machine, or a topology word such as XYFZ.
        machine: String,
    },
    /// A recording file for the columns of a table.
    #[command(after_help = examples::NEW_RECORDING)]
    Recording {
        /// The table: its first line has the names of the columns.
        data: PathBuf,
        /// The machine that was recorded.
        #[arg(long)]
        machine: Option<String>,
    },
    /// A set-up file for the files of instruments and controllers, which `abbe calibrate` reads.
    #[command(after_help = examples::NEW_SETUP)]
    Setup {
        /// The files.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// A path file for a machine, which `abbe simulate` and `abbe plan` drive.
    #[command(after_help = examples::NEW_PATH)]
    Path {
        /// A machine file, the name of a shipped machine, or a topology word such as XYFZ.
        machine: String,
    },
}

#[derive(Args)]
pub(crate) struct Explain {
    /// A code such as E0307, a term such as backlash, an error motion such as EX0C, a topology word such as XYFZ, or a word of the
    /// guide's glossary such as squareness.
    #[arg(value_name = "CODE|TERM|MOTION|WORD")]
    pub(crate) name: Option<String>,
    /// Where the result goes.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Completions {
    /// The shell.
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

#[derive(Args)]
pub(crate) struct Man {
    /// The folder for abbe.1, abbe-derive.1, ...; it is made where it is missing.
    #[arg(long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
}
