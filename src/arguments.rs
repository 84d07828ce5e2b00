//! The arguments of the command line. In: words. Out: one command with its options.

mod choices;
mod examples;
mod fleet;
mod values;

use std::path::PathBuf;

use clap::{ArgGroup, Args, Parser, Subcommand};
use clap_complete::Shell;
use workshop::updated::{Datum, datum};

pub(crate) use choices::{
    CalibrateFormat, Color, EvaluationFormat, ExportFormat, ExportValue, FleetFormat, Format, LimitsFormat,
    LinearUnit, Names, ReportFormat, UpdateFormat, UpdateMethod, VerdictName,
};
pub(crate) use fleet::{Fleet, FleetAdd, FleetCommand, FleetRun, FleetShow};
use values::{count, name, non_negative, place, range, whole};

use crate::target::Target;

/// More points or tables than any controller has.
const MOST_POINTS: u64 = 1_000_000;

/// Compiles a machine tool's kinematic chain into its error equations and compensation code.
#[derive(Parser)]
#[command(name = "abbe", version, arg_required_else_help = true, max_term_width = 100, after_help = examples::ABBE)]
pub(crate) struct Arguments {
    /// Colour the text for people. `auto`: only on a terminal, and not if NO_COLOR is set.
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
    /// Find out from recordings of the real machine what its model leaves out.
    #[command(after_help = examples::DIAGNOSE)]
    Diagnose(Diagnose),
    /// Report the detection limits of a recording: the size from which each effect would be found in it.
    #[command(after_help = examples::LIMITS)]
    Limits(Limits),
    /// Report the detection limits of a path before it is driven, and suggest further passes.
    #[command(after_help = examples::PLAN)]
    Plan(Plan),
    /// Write the recording that a calibration predicts, with an exact machine, an instrument and noise.
    #[command(after_help = examples::SIMULATE)]
    Simulate(Simulate),
    /// Make a calibration from files of instruments (lasers, levels, straightedges), or from the existing corrections of a controller.
    #[command(after_help = examples::CALIBRATE)]
    Calibrate(Calibrate),
    /// Update the coefficients of a calibration from measured parts.
    #[command(after_help = examples::UPDATE)]
    Update(Update),
    /// Compute the standard figures of positioning and circles from a recording (ISO 230-2, ISO 230-4, ISO 230-6).
    #[command(after_help = examples::EVALUATE)]
    Evaluate(Evaluate),
    /// Diagnose the recordings of many machines over years, each of them once, and report what changed.
    #[command(after_help = examples::FLEET)]
    Fleet(Fleet),
    /// Write the files that a controller loads, and report what they cannot express.
    #[command(after_help = examples::EXPORT)]
    Export(Export),
    /// Write a commented template: a machine, calibration, recording, set-up or path file.
    #[command(after_help = examples::NEW)]
    New(New),
    /// Explain a diagnostic code, a term, an error motion, a topology word or a word of the glossary; without a name, list them.
    #[command(after_help = examples::EXPLAIN)]
    Explain(Explain),
    /// Print the completions of this command line for a shell.
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
    /// The names to print: those of ISO 230-1, or the machine file's symbols.
    #[arg(long, value_enum, default_value_t = Names::Symbols)]
    pub(crate) names: Names,
    /// Where to write the result.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Check {
    /// A machine file, the name of a shipped machine, or a topology word.
    pub(crate) machine: String,
    /// A file of equations.
    pub(crate) equations: PathBuf,
    /// Where to write the result.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Expand {
    /// A machine file, the name of a shipped machine, or a topology word.
    pub(crate) machine: String,
    /// Also compile in a calibration of the machine: the numbers of one specimen become constants.
    #[arg(long, value_name = "FILE", conflicts_with = "c_abi")]
    pub(crate) calibration: Option<PathBuf>,
    /// Add the code for a library for controllers in C: a crate of type `staticlib` or `cdylib` with this code and the
    /// crates abbe-runtime and abbe-c provides the functions of `abbe.h`.
    #[arg(long)]
    pub(crate) c_abi: bool,
    /// Write numbers of 32 bits, for a controller whose processor knows no others: code over `abbe_runtime::single`, which
    /// is there with the feature `single` of abbe-runtime.
    #[arg(long, conflicts_with = "c_abi")]
    pub(crate) f32: bool,
    /// Where to write the result.
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
    /// Write the known calibration with the findings added; an existing file is replaced as a whole.
    #[arg(long, value_name = "FILE")]
    pub(crate) write_calibration: Option<PathBuf>,
    /// A recording of the same machine that is not fitted but used to test the findings.
    #[arg(long, value_name = "RECORDING")]
    pub(crate) holdout: Option<PathBuf>,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Exit with status 1 if the verdict is one of these, separated by commas.
    #[arg(long, value_name = "VERDICTS", value_enum, value_delimiter = ',')]
    pub(crate) fail_on: Vec<VerdictName>,
    /// Where to write the result.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Limits {
    /// A recording.
    pub(crate) recording: PathBuf,
    /// Find extra passes that would separate effects that this recording cannot separate.
    #[arg(long)]
    pub(crate) passes: bool,
    /// The effects to test, and the form of the result.
    #[command(flatten)]
    pub(crate) asked: Asked,
}

#[derive(Args)]
#[command(group(ArgGroup::new("known").required(true).args(["machine", "calibration"])))]
pub(crate) struct Plan {
    /// A path file: where the axes would go, the instrument that would measure them, and its noise.
    pub(crate) path: PathBuf,
    /// A machine file, the name of a shipped machine, or a topology word; its constants are those of the file.
    #[arg(long)]
    pub(crate) machine: Option<String>,
    /// The calibration file of the machine, with its known errors, instead of the machine.
    #[arg(long, value_name = "FILE")]
    pub(crate) calibration: Option<PathBuf>,
    /// The effects to test, and the form of the result.
    #[command(flatten)]
    pub(crate) asked: Asked,
}

/// The effects to test in a recording or a path, and the form of the result.
#[derive(Args)]
pub(crate) struct Asked {
    /// Test only these: kinds (backlash), error motions (EXX) or axes (X), separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
    /// The maximum number of diagnoses for each effect; most limits reach an accuracy of 12 % after a dozen and stop there.
    #[arg(long, default_value_t = 40, value_parser = whole::<u16>(4, 1000), allow_negative_numbers = true)]
    pub(crate) trials: u16,
    /// The seed of signs, places and phases; the same seed gives the same limits.
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>(0, u64::MAX), allow_negative_numbers = true)]
    pub(crate) seed: u64,
    /// How to write the result.
    #[arg(long, value_enum, default_value_t = LimitsFormat::Text)]
    pub(crate) format: LimitsFormat,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Where to write the result.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Compensate {
    /// The calibration file of the machine.
    pub(crate) calibration: PathBuf,
    /// Positions, which come from standard input and from no file.
    #[arg(hide = true)]
    pub(crate) positions: Option<PathBuf>,
    /// How far an axis must move back before it counts as reversed: mm, or deg for a
    /// rotary axis. Only for axes without a `dir_` column.
    #[arg(long, default_value_t = 0.001, value_parser = non_negative, allow_negative_numbers = true)]
    pub(crate) hysteresis: f64,
    /// Use the tools of LinuxCNC's table (tool.tbl) instead of the calibration's tools.
    #[arg(long, value_name = "FILE")]
    pub(crate) tools: Option<PathBuf>,
    /// The unit of the offsets in that table.
    #[arg(long, value_enum, default_value_t = LinearUnit::Mm, requires = "tools")]
    pub(crate) tools_unit: LinearUnit,
    /// The tool for the map and for rows that name none: one of the calibration's tools, or of that table.
    #[arg(long, value_name = "NAME")]
    pub(crate) tool: Option<String>,
    /// Leave out rows that cannot be read or compensated, and report their number on standard error.
    #[arg(long)]
    pub(crate) skip_bad: bool,
    /// Report on standard error the size of the errors without and with compensation and, if the direction of the tool is derived, its error.
    #[arg(long)]
    pub(crate) summary: bool,
    /// Leave out terms that no controller can compensate in real time, and name each on standard error.
    #[arg(long)]
    pub(crate) leave_out_uncompensable: bool,
    /// Draw the predicted error over the workspace, as SVG: over the tables of the calibration, or the positions read.
    #[arg(long, value_name = "FILE")]
    pub(crate) map: Option<PathBuf>,
    /// Replace an existing map.
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
    /// The folder for `recording.yaml` and `data.csv`, or the name of the recording file, which the data file then shares.
    #[arg(long, default_value = ".")]
    pub(crate) output: PathBuf,
    /// The seed of the noise, instead of that of the path file; the same seed gives the same bytes.
    #[arg(long, value_parser = whole::<u64>(0, u64::MAX), allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    /// The calibration that the recording names as known; errors that it lacks are concealed.
    #[arg(long)]
    pub(crate) known: Option<PathBuf>,
    /// Draw the path and the readings over time, as SVG.
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Replace existing files.
    #[arg(long)]
    pub(crate) force: bool,
    /// Show no progress.
    #[arg(long)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct Calibrate {
    /// The set-up file, which names the machine and the file of each measurement or correction. If you give files of instruments
    /// or controllers instead, the command shows the set-up file that they need.
    #[arg(required = true, value_name = "SETUP")]
    pub(crate) files: Vec<PathBuf>,
    /// The calibration file to write.
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long)]
    pub(crate) force: bool,
    /// How to write the report.
    #[arg(long, value_enum, default_value_t = CalibrateFormat::Text)]
    pub(crate) format: CalibrateFormat,
}

#[derive(Args)]
pub(crate) struct Update {
    /// The calibration file to update.
    pub(crate) calibration: PathBuf,
    /// Recordings of parts of that machine, measured with a probe along normals or as positions.
    #[arg(required = true, value_name = "MEASUREMENTS")]
    pub(crate) measurements: Vec<PathBuf>,
    /// The new calibration file.
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long)]
    pub(crate) force: bool,
    /// How to solve for the coefficients.
    #[arg(long, value_enum, default_value_t = UpdateMethod::Svd)]
    pub(crate) method: UpdateMethod,
    /// The share of the matrix's norm up to which singular values count as zero; by default the number of readings times 2.2e-16.
    #[arg(long, value_parser = non_negative, allow_negative_numbers = true)]
    pub(crate) tolerance: Option<f64>,
    /// The directions in which the zero of a part is free: `free` (all), `turned` (all, and the part may be rotated), `none`, or
    /// some, such as `z` or `x,z`.
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
    /// Where to write the result.
    #[command(flatten)]
    pub(crate) target: Target,
}

#[derive(Args)]
pub(crate) struct Export {
    /// The controller.
    #[arg(value_enum)]
    pub(crate) format: ExportFormat,
    /// The calibration file of the machine.
    pub(crate) calibration: PathBuf,
    /// The tool for which the files are made: one of the calibration's tools; by default the constants of the calibration.
    #[arg(long, value_name = "NAME")]
    pub(crate) tool: Option<String>,
    /// The folder for the files.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub(crate) output: PathBuf,
    /// Replace existing files.
    #[arg(long)]
    pub(crate) force: bool,
    /// Write nothing; report what the controller reads from this file and what is lost. For LinuxCNC, give the axis as in
    /// X=x.comp. May be repeated.
    #[arg(long, value_name = "[AXIS=]FILE", conflicts_with_all = ["output", "force"])]
    pub(crate) check: Vec<String>,
    /// The travel of an axis, mm or deg, as in X=0:500; by default that of the calibration's tables.
    #[arg(long, value_name = "AXIS=FROM:TO", value_parser = range)]
    pub(crate) range: Vec<(String, [f64; 2])>,
    /// The position of an axis for the tables of the others, mm or deg, as in Z=120; by default the middle of its travel.
    #[arg(long, value_name = "AXIS=PLACE", value_parser = place)]
    pub(crate) at: Vec<(String, f64)>,
    /// The number of evenly spaced points in each table; by default those of the calibration, and more where an error is curved.
    #[arg(long, value_parser = whole::<usize>(2, MOST_POINTS), allow_negative_numbers = true)]
    pub(crate) points: Option<usize>,
    /// The meaning of a number in a table, if no public document of the controller defines it (Sinumerik's CEC, HEIDENHAIN).
    #[arg(long, value_enum)]
    pub(crate) value: Option<ExportValue>,
    /// Leave out terms that no controller can compensate in real time, and name each on standard error.
    #[arg(long)]
    pub(crate) leave_out_uncompensable: bool,
    /// LinuxCNC: COMP_FILE_TYPE; by default 1.
    #[arg(long = "type", value_name = "TYPE", value_parser = whole::<u8>(0, 1), allow_negative_numbers = true)]
    pub(crate) kind: Option<u8>,
    /// LinuxCNC: the machine's unit of length; by default mm.
    #[arg(long, value_enum)]
    pub(crate) unit: Option<LinearUnit>,
    /// Sinumerik: the number of tables that CEC has; by default 8.
    #[arg(long, value_parser = whole::<usize>(1, MOST_POINTS), allow_negative_numbers = true)]
    pub(crate) tables: Option<usize>,
    /// Sinumerik, HEIDENHAIN, PMAC: the controller's name of an axis, or its motor's number, as in X=MX1.
    #[arg(long, value_name = "AXIS=NAME", value_parser = name)]
    pub(crate) name: Vec<(String, String)>,
    /// PMAC: counts of an axis's motor per mm, or per degree of a rotary axis, as in X=10000.
    #[arg(long, value_name = "AXIS=COUNTS", value_parser = count)]
    pub(crate) counts: Vec<(String, f64)>,
}

#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct New {
    /// The kind of file; a topology word alone gives a machine file.
    #[command(subcommand)]
    pub(crate) file: Option<NewFile>,
    /// A topology word: axes that carry the part, F for the bed, axes that carry the tool.
    #[arg(required = true)]
    pub(crate) topology: Option<String>,
    /// The file to write; by default it is printed.
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long, global = true, requires = "output")]
    pub(crate) force: bool,
}

#[derive(Subcommand)]
pub(crate) enum NewFile {
    /// A machine file for a topology word, with its chain written out.
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
        /// The table, whose first line has the names of the columns.
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
    /// Where to write the result.
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
    /// The folder for abbe.1, abbe-derive.1, ...; it is created if it does not exist.
    #[arg(long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
}
