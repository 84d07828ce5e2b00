//! Options that are one word of several. In: a word. Out: which of them.

use clap::ValueEnum;
use diagnosis::diagnosis::Verdict;

/// When text for people is coloured.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Color {
    /// On a terminal that supports colours.
    Auto,
    /// Also in files and pipes.
    Always,
    /// Never.
    Never,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Format {
    /// Plain text, for comparison with a printed report.
    Text,
    /// LaTeX, to include in a document.
    Latex,
    /// One self-contained page with MathML.
    Html,
    /// The schema abbe-equations/1.
    Json,
    /// A batch file for Maxima.
    Maxima,
    /// A module for Python, with numbers, NumPy arrays or SymPy symbols.
    Python,
    /// The drawing of the chain alone, as a picture.
    Svg,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum ReportFormat {
    /// For a person at a terminal.
    Text,
    /// The schema abbe-diagnosis/1.
    Json,
    /// One self-contained page.
    Html,
}

/// The verdicts of a diagnosis.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum VerdictName {
    /// The recordings cannot decide.
    Undecided,
    /// Nothing systematic above the noise.
    Adequate,
    /// Findings, or faults of the files, explain the systematic residuals.
    LeftOutPhysics,
    /// Systematic residuals remain that no term fits.
    Unexplained,
    /// Runs disagree by more than any model of the state can explain.
    NotRepeatable,
}

impl VerdictName {
    /// The verdict of that name.
    pub(crate) fn verdict(self) -> Verdict {
        match self {
            Self::Undecided => Verdict::Undecided,
            Self::Adequate => Verdict::Adequate,
            Self::LeftOutPhysics => Verdict::LeftOutPhysics,
            Self::Unexplained => Verdict::Unexplained,
            Self::NotRepeatable => Verdict::NotRepeatable,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Names {
    /// EXX, EBZ, EC0Y.
    Iso,
    /// The symbols of the machine file.
    Symbols,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum UpdateMethod {
    /// The pseudo-inverse of the scaled system: the smallest change in scaled coefficients.
    Svd,
    /// Least squares regularised towards the present calibration, with the strength from generalised cross-validation.
    Ridge,
    /// Only the coefficients that are worth their penalty; all others stay the same.
    Select,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum CalibrateFormat {
    /// For a person at a terminal.
    Text,
    /// The schema abbe-calibrate/1.
    Json,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum UpdateFormat {
    /// For a person at a terminal.
    Text,
    /// The schema abbe-update/1.
    Json,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum FleetFormat {
    /// For a person at a terminal.
    Text,
    /// The schema abbe-fleet/1.
    Json,
    /// One self-contained page.
    Html,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum LimitsFormat {
    /// For a person at a terminal.
    Text,
    /// The schema abbe-limits/1.
    Json,
    /// One self-contained page with the curves.
    Html,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum EvaluationFormat {
    /// For a person at a terminal.
    Text,
    /// The schema abbe-evaluation/1.
    Json,
    /// One self-contained page with the diagrams of the standards.
    Html,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ExportFormat {
    /// LinuxCNC: screw compensation, COMP_FILE.
    Linuxcnc,
    /// ISG kernel and Beckhoff: volumetric compensation, ISG CSV.
    Isg,
    /// Etalon Exchange Format, variant Vendor.
    Etalon,
    /// Siemens SINUMERIK: ENC_COMP and CEC.
    Sinumerik,
    /// HEIDENHAIN: .COM tables.
    Heidenhain,
    /// Delta Tau PMAC: DEFINE COMP and DEFINE BLCOMP.
    Pmac,
    /// Marlin: skew and bed mesh, M852 and M421.
    Marlin,
    /// Klipper: profiles of skew and bed mesh.
    Klipper,
    /// RepRapFirmware: skew and bed mesh, M556 and heightmap.csv.
    Reprap,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum ExportValue {
    /// The error, actual minus commanded: a positive number moves the axis in its negative direction.
    Error,
    /// The value added to the command.
    Correction,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum LinearUnit {
    /// Millimetres.
    Mm,
    /// Inches.
    In,
}
