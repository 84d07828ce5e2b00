//! What the user says of a controller. In: words of the command line. Out: a format and its options.

/// Whose files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// LinuxCNC: `[JOINT_n] COMP_FILE`.
    LinuxCnc,
    /// ISG kernel and Beckhoff: volumetric compensation, ISG CSV.
    Isg,
    /// Etalon Exchange, variant Vendor, which the ISG kernel reads too.
    Etalon,
    /// Siemens SINUMERIK: `$AA_ENC_COMP` and `$AN_CEC`.
    Sinumerik,
    /// HEIDENHAIN: `.COM`, as a TNC 640 has it.
    Heidenhain,
    /// Delta Tau PMAC: `DEFINE COMP` and `DEFINE BLCOMP`.
    Pmac,
    /// Marlin: `M852` and `M421`.
    Marlin,
    /// Klipper: saved profiles of a skew and of a bed mesh.
    Klipper,
    /// RepRapFirmware: `M556` and `heightmap.csv`.
    RepRap,
}

/// What a controller does with a number of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// It is the error, actual minus commanded: the controller moves the other way.
    Error,
    /// It is added to the command.
    Correction,
}

impl Sense {
    /// What a correction is multiplied by to be the number.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Error => -1.0,
            Self::Correction => 1.0,
        }
    }
}

/// What the user says of the controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The number of points of a table, evenly spaced.
    pub points: Option<usize>,
    /// LinuxCNC: the type of its files.
    pub kind: Kind,
    /// LinuxCNC: its unit of length.
    pub unit: Unit,
    /// What a number is, where no public document says it.
    pub sense: Option<Sense>,
    /// The number of cross tables that the controller has.
    pub tables: usize,
    /// The controller's name of an axis, or its motor's number, by axis letter.
    pub names: Vec<(String, String)>,
    /// PMAC: counts of a motor for a mm, by axis letter.
    pub counts: Vec<(String, f64)>,
}

impl Options {
    /// The controller's name of an axis, where the user says one.
    pub(super) fn name(&self, letter: &str) -> Option<&str> {
        self.names.iter().find(|(said, _)| said == letter).map(|(_, name)| name.as_str())
    }
}

/// What the second and third number of a triplet are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// `COMP_FILE_TYPE = 0`: where the joint really is, coming forward and in reverse.
    Actual,
    /// `COMP_FILE_TYPE = 1`: what is added to the command.
    #[default]
    Trim,
}

/// The machine's unit of length (`[TRAJ] LINEAR_UNITS`), in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit(pub f64);

impl Unit {
    /// The millimetre.
    pub const MM: Self = Self(1.0);
    /// The inch.
    pub const INCH: Self = Self(25.4);
    /// The degree of a joint that turns, in rad.
    pub const DEGREE: Self = Self(std::f64::consts::PI / 180.0);

    /// Numbers in inches or degrees need two decimals more for the same nanometre, that of a degree 1 m from its axis.
    pub(super) fn decimals(self) -> usize {
        if self == Self::MM { 6 } else { 8 }
    }
}
