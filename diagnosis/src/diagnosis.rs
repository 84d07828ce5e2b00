//! The diagnosis: what is said of a machine and its recordings, before it is put into words or JSON.

use model_dsl::calibration::{CalibratedTerm, Calibration, TermKind};
use model_dsl::equations::Equations;
use model_dsl::machine::ElementKind;
use notation::Formula;

use crate::pictures::Pictures;
use crate::traces::Trace;

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Diagnosis {
    /// The machine's name.
    pub machine: String,
    /// The recordings that were fitted together, in order.
    pub recordings: Vec<Summary>,
    /// The verdict.
    pub verdict: Verdict,
    /// Why nothing at all can be decided from these recordings, a whole sentence, where that is so: the verdict then says
    /// nothing, and there are no figures and no findings.
    pub undecidable: Option<String>,
    /// The noise: what stands above it is systematic.
    pub noise: NoiseSummary,
    /// The residual of the calibration alone, its free zeros fitted.
    pub before: Residual,
    /// The residual with the findings.
    pub after: Residual,
    /// What of the calibration's residual comes back, before any name: for each channel the states that predict it in units to
    /// which they were not fitted.
    pub returns: Vec<Returning>,
    /// The channels of which nothing comes back.
    pub nothing_returns: Vec<NothingReturns>,
    /// Faults of the files, in the order in which they were found. All that follows is worked out with them mended.
    pub model: Vec<Change>,
    /// The files with the faults mended, where there are any.
    pub mended: Option<Mended>,
    /// The physics that was left out, in order of share.
    pub findings: Vec<Finding>,
    /// Settings of the instruments that the data demand, the zeros apart.
    pub settings: Vec<SettingFinding>,
    /// What stands above the noise and no term explains.
    pub unexplained: Option<Unexplained>,
    /// How far runs under the same state differ, where they differ by more than the noise.
    pub repeatability: Option<Repeatability>,
    /// What cannot be decided from these recordings: whole sentences, each with its reason.
    pub undecided: Vec<String>,
    /// Where nothing was found: from which size on effects would have been, at most three of them.
    pub denied: Vec<Denied>,
    /// How many terms were tried that the recordings tell apart, waves aside.
    pub candidates: usize,
    /// What can be drawn of it, where that was asked for.
    pub pictures: Option<Pictures>,
    /// Every sample beside what the model says of it, recording by recording and channel by channel, where that was asked for.
    pub traces: Vec<Trace>,
}

impl Diagnosis {
    /// The file of a recording, by its number.
    pub(crate) fn file_of(&self, recording: usize) -> Option<&str> {
        self.recordings.get(recording).map(|summary| summary.file.as_str())
    }
}

/// One recording in a few figures.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// The recording file.
    pub file: String,
    /// Its title.
    pub title: Option<String>,
    /// `position`, `ballbar`, ...
    pub instrument: &'static str,
    /// Rows of data.
    pub rows: usize,
    /// Samples that were used, of all channels.
    pub samples: usize,
    /// Samples that are missing.
    pub missing: usize,
    /// Samples that were left out as outliers.
    pub outliers: usize,
    /// Runs.
    pub runs: usize,
    /// What was held out, in words: "run 3", "every fourth of 12 blocks of time".
    pub held_out: String,
}

/// The verdict of a diagnosis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Verdict {
    /// The recordings, or how they were set up, cannot tell.
    Undecided,
    /// Nothing systematic above the noise.
    #[default]
    Adequate,
    /// Findings explain what is systematic.
    LeftOutPhysics,
    /// Something systematic is left that no term fits.
    Unexplained,
    /// Runs disagree by more than any model of the state could give.
    NotRepeatable,
}

impl Verdict {
    /// The word of the contract.
    pub fn word(self) -> &'static str {
        match self {
            Self::Undecided => "undecided",
            Self::Adequate => "adequate",
            Self::LeftOutPhysics => "left-out-physics",
            Self::Unexplained => "unexplained",
            Self::NotRepeatable => "not-repeatable",
        }
    }
}

/// The noise of the outside instrument's channels together; of the drives' where there is no instrument.
#[derive(Clone, Debug, Default)]
pub struct NoiseSummary {
    /// Root mean square.
    pub value: f64,
    /// `mm`, `rad` or `deg`.
    pub unit: &'static str,
    /// Its white part.
    pub white: f64,
    /// Its wandering part.
    pub wander: f64,
    /// The correlation time of the wandering part, s.
    pub time_constant: f64,
}

/// The size of what a model leaves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Residual {
    /// Root mean square over all samples.
    pub rms: f64,
    /// Root mean square over the samples that were held out; `None` where nothing could be.
    pub holdout_rms: Option<f64>,
    /// `mm`, `rad` or `deg`.
    pub unit: &'static str,
}

/// What of one channel some function of states predicts, whatever the function is.
#[derive(Clone, Debug, Default)]
pub struct Returning {
    /// The recording, by number.
    pub recording: usize,
    /// The channel's name in it.
    pub channel: String,
    /// The states, in words: `position and direction of X`.
    pub state: String,
    /// The share of the residual's variance that they predict in units to which they were not fitted.
    pub share: f64,
    /// The root mean square of what they leave: no model of these states can leave less.
    pub left: f64,
    /// `mm`, `rad` or `deg`.
    pub unit: &'static str,
}

/// A channel of which nothing comes back.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NothingReturns {
    /// The recording, by number.
    pub recording: usize,
    /// The channel's name in it.
    pub channel: String,
    /// Whether any state comes by more than once: where none does, it cannot be told.
    pub driven_twice: bool,
}

/// A fault of a file: what to change in it.
#[derive(Clone, Debug)]
pub struct Change {
    /// The file that is wrong.
    pub file: WrongFile,
    /// Its name.
    pub name: String,
    /// The line where the fault stands, counted from 1, where it is known.
    pub line: Option<usize>,
    /// Where in the file: `errors.EBX`, `constants.Zt`, `topology`.
    pub path: String,
    /// What kind of change it is: `sign`, `unit`, `size`, `mirror`, `shift`, `axis`, `directions`, `exchange`, `motion`, `value`,
    /// `order`, `reference`, `sensors`, `scale`, `columns`.
    pub change: &'static str,
    /// The other place, where two are exchanged or one is moved: `errors.EZX`.
    pub with: Option<String>,
    /// What seems to be wrong, a clause: `EBX in the calibration has the wrong sign`.
    pub fault: String,
    /// What to do about it, a clause.
    pub remedy: String,
    /// The number that the recordings give: a factor, a shift, a constant.
    pub amount: Option<Parameter>,
    /// The share of the variance above the noise that the change explains, beside the physics that is found with it.
    pub share: f64,
    /// The held-out rms with the change, and without it, the same physics fitted to both.
    pub evidence: Evidence,
    /// Other faults that explain as much.
    pub alternatives: Vec<String>,
}

/// A file that is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrongFile {
    /// The machine file, or the topology word.
    Machine,
    /// The calibration.
    Calibration,
    /// A recording, by number: its channels or its instrument.
    Recording(usize),
}

/// The files with their faults mended.
#[derive(Clone, Debug)]
pub struct Mended {
    /// The calibration.
    pub calibration: Calibration,
    /// The equations that it is for.
    pub equations: Equations,
    /// The topology word of the machine, if it has one.
    pub word: Option<String>,
}

/// A form for which there is no name: a term times factors, or an event.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Form {
    /// Its equation.
    pub equation: Formula,
    /// How large it is where, in a sentence.
    pub words: String,
    /// What machines have that depends on each of its factors.
    pub physics: Vec<&'static str>,
}

/// A term of an error motion that the calibration lacks.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The error motion's name: `EYY`.
    pub motion: String,
    /// Its number in the equations.
    pub motion_number: usize,
    /// What the motion is, in words.
    pub motion_meaning: String,
    /// The term's name.
    pub term: &'static str,
    /// The parameters, named as in calibration files.
    pub parameters: Vec<Parameter>,
    /// How far it goes over the travel, where no single parameter says that.
    pub over_travel: Option<OverTravel>,
    /// Its part of the explainable held-out variance.
    pub share: f64,
    /// Where it acts.
    pub location: Location,
    /// What it does to the held-out data.
    pub evidence: Evidence,
    /// Other names for what these recordings show.
    pub alternatives: Vec<Alternative>,
    /// What the term is, physically: one or two sentences.
    pub explanation: String,
    /// Of a wave along an axis: the elements of the axis whose period, or a whole fraction of it, is the wave's.
    pub repeats_with: Vec<Repeats>,
    /// Whether a controller can compensate it in real time.
    pub compensable: bool,
    /// The term as the calibration takes it; its sensors go by the numbers in [`Finding::sensors`].
    pub calibrated: CalibratedTerm,
    /// What form it has, where no term of the vocabulary has a name for it.
    pub form: Option<Form>,
    /// The sensors that it and its factors read: their numbers in [`Finding::calibrated`], and their names.
    pub sensors: Vec<(usize, String)>,
}

impl Finding {
    /// Which term of the vocabulary it is.
    pub fn kind(&self) -> TermKind {
        self.calibrated.kind()
    }

    /// The name of the sensor that the term itself reads.
    pub fn sensor(&self) -> Option<&str> {
        let number = self.calibrated.sensor()?;
        self.sensors.iter().find(|(known, _)| *known == number).map(|(_, name)| name.as_str())
    }

    /// The term with each of its sensors under the number that another calibration gives to its name.
    pub fn calibrated_in(&self, known: &mut Calibration) -> CalibratedTerm {
        let numbers: Vec<(usize, usize)> =
            self.sensors.iter().map(|(number, name)| (*number, known.sensor(name))).collect();
        let renumbered =
            |sensor: usize| numbers.iter().find(|(old, _)| *old == sensor).map_or(sensor, |(_, new)| *new);
        let mut term = self.calibrated.clone();
        if let Some(sensor) = term.sensor() {
            term = term.with_sensor(renumbered(sensor));
        }
        term.with_factors(|factor| match factor.sensor() {
            Some(sensor) => factor.with_sensor(renumbered(sensor)),
            None => factor,
        })
    }
}

/// An element of an axis that a wave repeats with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeats {
    /// What it is.
    pub element: ElementKind,
    /// The travel for one turn of it, or from line to line.
    pub period: f64,
    /// `mm`, `deg` or `rad`.
    pub unit: &'static str,
    /// How often the wave comes in that: 1, 2, ...
    pub harmonic: u32,
}

/// How far an effect goes over the travel of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct OverTravel {
    /// The letter of the axis.
    pub axis: String,
    /// From its lowest to its highest value, never below zero; the interval allows for what the coefficients have in common.
    pub range: Estimate,
}

/// One parameter of a finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name in calibration files.
    pub name: &'static str,
    /// Its value.
    pub value: ParameterValue,
}

impl Parameter {
    /// The fitted numbers in it, each by its name: `lost_motion`; `coefficients[1]` of a list, whose first number is that of the term's
    /// [first power](TermKind::first_power).
    pub fn estimates(&self, kind: TermKind) -> Vec<(String, Estimate)> {
        match &self.value {
            ParameterValue::Fitted(estimate) => vec![(self.name.to_owned(), estimate.clone())],
            ParameterValue::List(list) => {
                let named = |(power, estimate): (usize, &Estimate)| {
                    (format!("{}[{power}]", self.name), estimate.clone())
                };
                (kind.first_power()..).zip(list).map(named).collect()
            }
            ParameterValue::Name(_) | ParameterValue::Places(..) | ParameterValue::Given(..) => Vec::new(),
        }
    }
}

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterValue {
    /// The name of an axis, a sensor or a load.
    Name(String),
    /// Numbers that are not fitted, such as the nodes of a table, with their unit.
    Places(Vec<f64>, &'static str),
    /// A number that is not fitted, such as a reference temperature, with its unit.
    Given(f64, String),
    /// A fitted number.
    Fitted(Estimate),
    /// Several fitted numbers: the coefficients of a polynomial from power 0 on (of a coupling from power 1 on).
    List(Vec<Estimate>),
}

/// A fitted number with its 95 % interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// The ends of the interval; both the value itself where the recordings say nothing about it.
    pub ci95: (f64, f64),
    /// The unit, `mm`, `1/s`, `rad/mm^2`; empty for a pure number.
    pub unit: String,
}

/// Where a finding acts.
#[derive(Clone, Debug, Default)]
pub struct Location {
    /// The link.
    pub link: String,
    /// `drive`, `transmission`, `structure` or `unknown`.
    pub side: &'static str,
    /// The state on which it depends: `position`, `direction`, `velocity`, `time`, `temperature`, ...
    pub state: &'static str,
    /// Where it shows, in words.
    pub detail: String,
    /// The interval to which it is confined.
    pub interval: Option<Interval>,
    /// Whether the drive's own feedback shows it, as the model has it that was fitted.
    pub at_drive: bool,
    /// Whether it acts inside the position loop of the axis, which answers it: friction of the drive, a load on it.
    pub inside_loop: bool,
}

/// A stretch of a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Interval {
    /// What it is a stretch of.
    pub of: IntervalOf,
    /// Where it begins and ends.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// The unit of both.
    pub unit: &'static str,
}

/// What an interval is a stretch of.
#[derive(Clone, Debug, PartialEq)]
pub enum IntervalOf {
    /// The position of the axis of this letter.
    Axis(String),
    /// Frequency.
    Frequency,
}

/// What a finding does to held-out data.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    /// The held-out rms with all findings.
    pub with: f64,
    /// The held-out rms when the others are fitted without this one.
    pub without: f64,
    /// The unit of both.
    pub unit: &'static str,
    /// The letter of the axis on whose drive's own feedback it is counted; `None`: on what the diagnosis counts throughout.
    pub drive: Option<String>,
}

/// Another name for what the recordings show.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// The error motion; `instrument` for a setting of the instrument.
    pub motion: String,
    /// The term.
    pub term: &'static str,
    /// The measurement that would tell them apart.
    pub separate_by: String,
}

/// A setting of an instrument that the data demand.
#[derive(Clone, Debug)]
pub struct SettingFinding {
    /// The recording, by number.
    pub recording: usize,
    /// The setting's name: `eccentricity`, `radius`, `cosine`, `clock`.
    pub term: &'static str,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Other names for it.
    pub alternatives: Vec<Alternative>,
}

/// An effect that an adequate model denies: above this size it would have been found in nine of ten cases.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Denied {
    /// The error motion.
    pub motion: String,
    /// The term.
    pub term: &'static str,
    /// The period of a wave, and its unit.
    pub period: Option<(f64, &'static str)>,
    /// The size: lost motion, constant or amplitude.
    pub above: f64,
    /// `mm`, `rad` or `deg`.
    pub unit: &'static str,
}

/// What stands above the noise and no term explains.
#[derive(Clone, Debug, Default)]
pub struct Unexplained {
    /// The link whose state it follows, where one does.
    pub link: Option<String>,
    /// The channel or direction in which it shows: `measured.z`.
    pub direction: String,
    /// The state that it follows: `position`, `time`, `frequency`.
    pub state: &'static str,
    /// The interval to which it is confined.
    pub interval: Option<Interval>,
    /// Its root mean square where it shows, and its unit.
    pub rms: f64,
    /// `mm`, `rad` or `deg`.
    pub unit: &'static str,
    /// What it looks like, in words.
    pub detail: String,
    /// The name of an error motion of which a table could stand for it.
    pub table_of: Option<String>,
}

/// How far runs under the same state differ.
#[derive(Clone, Debug, Default)]
pub struct Repeatability {
    /// Standard deviation from run to run.
    pub between_runs: f64,
    /// What the noise within runs would give.
    pub expected: f64,
    /// `mm`, `rad` or `deg`.
    pub unit: &'static str,
    /// Whether time, temperature or order explains it, in words.
    pub detail: String,
}
