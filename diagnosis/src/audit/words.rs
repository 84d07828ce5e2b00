//! Changes in words: what is wrong with which file, and what to do about it.
//!
//! In: a fault that was told, with its amount. Out: a [`Change`].

use model_dsl::calibration::{CalibratedTerm, Calibration};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use super::fault::{FACTORS, Factor, Fault, Scope, TermAt};
use super::{Rest, Suspect, changed};
use crate::Inputs;
use crate::certainty::WIDTH_95;
use crate::diagnosis::{Change, Estimate, Evidence, Parameter, ParameterValue, Residual, WrongFile};

/// What is told of a suspect. `rest` is the amount of it that was left, `sizes` are the residuals without the change and with it, and the
/// noise is that of the recordings.
pub(crate) fn change(
    suspect: &Suspect,
    rest: Rest,
    inputs: &Inputs<'_>,
    (sizes, noise): ([Residual; 2], f64),
) -> Change {
    let words = Words { inputs, equations: inputs.equations, known: inputs.calibration };
    let named = factor(&suspect.fault, suspect.amount);
    let (fault, remedy) = words.of(&suspect.fault, named, suspect.amount);
    let [without, with] = sizes.map(|residual| residual.holdout_rms.unwrap_or(residual.rms));
    let above = |rms: f64| (rms * rms - noise * noise).max(0.0);
    let path = words.path(&suspect.fault);
    let file = file(&suspect.fault);
    Change {
        file,
        name: words.file(file),
        line: words.line(file, &path),
        path,
        change: kind(&suspect.fault, named),
        with: words.other(&suspect.fault),
        fault,
        remedy,
        amount: words.amount(suspect, rest),
        share: 1.0 - above(with) / above(without),
        evidence: Evidence { with, without, unit: sizes[1].unit, drive: None },
        alternatives: suspect
            .others
            .iter()
            .map(|(other, amount)| words.of(other, factor(other, *amount), *amount).0)
            .collect(),
    }
}

/// The named factor of an amount, if it has one.
fn factor(fault: &Fault, amount: f64) -> Option<Factor> {
    let same = |factor: &&Factor| fault.is_factor() && (factor.value - 1.0 - amount).abs() < 1e-9;
    FACTORS.iter().find(same).copied()
}

fn file(fault: &Fault) -> WrongFile {
    match fault {
        Fault::Order(_) => WrongFile::Machine,
        Fault::Scale { recording } => WrongFile::Recording(*recording),
        Fault::Sensors { .. } => WrongFile::Recording(0),
        _ => WrongFile::Calibration,
    }
}

/// The word for a kind of change.
fn kind(fault: &Fault, named: Option<Factor>) -> &'static str {
    match fault {
        Fault::Size(_) => named.map_or("size", |factor| factor.name),
        Fault::Scale { .. } => named.map_or("scale", |factor| factor.name),
        Fault::Mirror(_) => "mirror",
        Fault::Shift { .. } | Fault::Slip { .. } => "shift",
        Fault::Axis { .. } => "axis",
        Fault::Directions(_) => "directions",
        Fault::Exchange { .. } => "exchange",
        Fault::Moved { .. } => "motion",
        Fault::Constant(_) => "value",
        Fault::Order(_) => "order",
        Fault::Reference => "reference",
        Fault::Sensors { .. } => "sensors",
    }
}

/// The words of one set of files.
struct Words<'w> {
    inputs: &'w Inputs<'w>,
    equations: &'w Equations,
    known: Option<&'w Calibration>,
}

impl Words<'_> {
    /// What is wrong, and what to do about it.
    fn of(&self, fault: &Fault, named: Option<Factor>, amount: f64) -> (String, String) {
        match fault {
            Fault::Size(scope) => self.sized(&self.scope(*scope), named, amount),
            Fault::Scale { recording } => {
                let file =
                    self.inputs.recordings.get(*recording).map_or("", |recording| recording.file.as_str());
                // Readings that are too large by a factor have to be multiplied by the other one.
                let mended = 1.0 / (1.0 + amount) - 1.0;
                self.sized(
                    &format!("the reading of {file}"),
                    named.and_then(|_| factor(fault, mended)),
                    mended,
                )
            }
            Fault::Mirror(at) => (
                format!("{} is entered from the wrong end", self.term(*at)),
                "reverse the order of its values".to_owned(),
            ),
            Fault::Shift { at, .. } => (
                format!("{} is at the wrong place of its axis", self.term(*at)),
                "shift its nodes".to_owned(),
            ),
            Fault::Slip { at, nodes } => {
                let (where_to, how) =
                    if *nodes > 0 { ("low", "one step higher") } else { ("high", "one step lower") };
                (
                    format!("the values of {} are one node too {where_to} on the axis", self.term(*at)),
                    format!("start its nodes {how}"),
                )
            }
            Fault::Axis { of, named, read } => {
                let [named, read] = [*named, *read].map(|axis| &self.equations.axes[axis].letter);
                (
                    format!("{} names the axis {named}, but its values follow {read}", self.term(*of)),
                    format!("write `axis: {read}` there"),
                )
            }
            Fault::Directions(at) => (
                format!("the two directions of {} are swapped", self.term(*at)),
                "swap `forward` and `reverse`".to_owned(),
            ),
            Fault::Exchange { one, other } => {
                let [one, other] = [*one, *other].map(|motion| &self.equations.motions[motion].name);
                (
                    format!("{one} and {other} are under the wrong error motions: they are swapped"),
                    format!("swap the terms of {one} and {other}"),
                )
            }
            Fault::Moved { from, to } => {
                let [from, to] = [*from, *to].map(|motion| &self.equations.motions[motion].name);
                (
                    format!("the terms of {from} are under the wrong error motion: they belong to {to}"),
                    format!("write {to} instead of {from}"),
                )
            }
            Fault::Constant(number) => (
                format!("the constant {} has the wrong value", self.equations.constants[*number].name),
                "correct the value, or measure it".to_owned(),
            ),
            Fault::Order(word) => {
                let old = self.inputs.chains.map_or("", |chains| chains.word);
                (
                    format!(
                        "the topology is {word}, not {old}: an axis of the chain has the wrong place or the wrong branch"
                    ),
                    format!("write the topology {word}"),
                )
            }
            Fault::Reference => (
                "the reference temperature of the thermal terms is wrong".to_owned(),
                "correct `reference`".to_owned(),
            ),
            Fault::Sensors { one, other } => {
                let [one, other] = [*one, *other].map(|sensor| self.sensor(sensor));
                (
                    format!("the temperature sensors {one} and {other} are swapped"),
                    format!(
                        "swap the columns of temperature.{one} and temperature.{other} in the recordings, or swap the two names \
                         in the calibration if they are wrong there"
                    ),
                )
            }
        }
    }

    /// Numbers with a wrong factor.
    fn sized(&self, what: &str, named: Option<Factor>, amount: f64) -> (String, String) {
        match named {
            Some(Factor { name: "sign", .. }) => {
                (format!("{what} has the wrong sign"), "change the sign of its values".to_owned())
            }
            Some(factor) => (
                format!("{what} has the wrong {}: {}", factor.name, factor.meaning),
                format!("multiply its values by {}", number(1.0 + amount)),
            ),
            None => (
                format!("{what} has the wrong size"),
                format!("multiply its values by {}, or measure it again", number(1.0 + amount)),
            ),
        }
    }

    fn scope(&self, scope: Scope) -> String {
        match scope {
            Scope::Term(at) => self.term(at),
            Scope::Motion(motion) => self.equations.motions[motion].name.clone(),
            Scope::Axis(axis) => format!("every error motion of {}", self.equations.axes[axis].letter),
            Scope::Angles => "every angular error motion".to_owned(),
            Scope::Everything => "every number".to_owned(),
        }
    }

    /// A term by its motion, with its name where the motion has several.
    fn term(&self, at: TermAt) -> String {
        let motion = &self.equations.motions[at.motion].name;
        match self.terms(at.motion) {
            terms if terms.len() > 1 => {
                let name = terms.get(at.place).map_or("", |term| term.name());
                format!("the {name} of {motion}")
            }
            _ => motion.clone(),
        }
    }

    fn terms(&self, motion: usize) -> Vec<&CalibratedTerm> {
        let known = self.known.map(|known| known.terms(motion)).unwrap_or_default();
        known.iter().map(|term| &term.value).collect()
    }

    fn sensor(&self, number: usize) -> &str {
        self.known.map_or("", |known| changed::sensor(known, number))
    }

    /// Where in its file the fault stands.
    fn path(&self, fault: &Fault) -> String {
        match fault {
            Fault::Size(Scope::Term(at))
            | Fault::Mirror(at)
            | Fault::Shift { at, .. }
            | Fault::Slip { at, .. }
            | Fault::Directions(at)
            | Fault::Axis { of: at, .. } => self.term_path(*at),
            Fault::Size(Scope::Motion(motion)) => self.motion_path(*motion),
            Fault::Exchange { one: motion, .. } | Fault::Moved { from: motion, .. } => {
                self.motion_path(*motion)
            }
            Fault::Size(_) | Fault::Reference => "errors".to_owned(),
            Fault::Constant(number) => format!("constants.{}", self.equations.constants[*number].name),
            Fault::Order(_) => "topology".to_owned(),
            Fault::Scale { .. } => "channels.deviation".to_owned(),
            Fault::Sensors { one, .. } => format!("channels.temperature.{}", self.sensor(*one)),
        }
    }

    fn motion_path(&self, motion: usize) -> String {
        format!("errors.{}", self.equations.motions[motion].name)
    }

    fn term_path(&self, at: TermAt) -> String {
        let motion = self.motion_path(at.motion);
        if self.terms(at.motion).len() > 1 { format!("{motion}[{}]", at.place) } else { motion }
    }

    /// The other place, where two are exchanged or one is moved.
    fn other(&self, fault: &Fault) -> Option<String> {
        match fault {
            Fault::Exchange { other, .. } | Fault::Moved { to: other, .. } => Some(self.motion_path(*other)),
            Fault::Axis { read, .. } => Some(self.equations.axes[*read].letter.clone()),
            Fault::Sensors { other, .. } => Some(format!("channels.temperature.{}", self.sensor(*other))),
            Fault::Order(word) => Some(word.clone()),
            _ => None,
        }
    }

    /// The name of a file.
    fn file(&self, file: WrongFile) -> String {
        match file {
            WrongFile::Machine => {
                self.inputs.chains.map_or("the machine file", |chains| chains.file).to_owned()
            }
            WrongFile::Calibration => {
                self.inputs.calibration_file.map_or("the calibration", SourceFile::name).to_owned()
            }
            WrongFile::Recording(number) => {
                self.inputs.recordings.get(number).map_or("", |recording| recording.file.as_str()).to_owned()
            }
        }
    }

    /// The line of the calibration's file in which a path begins.
    fn line(&self, file: WrongFile, path: &str) -> Option<usize> {
        let source = self.inputs.calibration_file.filter(|_| file == WrongFile::Calibration)?;
        let root = yaml::read(source, &mut Diagnostics::new())?;
        let (block, name) = path.split_once('.').unwrap_or((path, ""));
        let block = root.get(block)?;
        let name = name.split('[').next().unwrap_or_default();
        let place = block.get(name).map_or(block.span, |node| node.span);
        Some(source.line_column(place.start).0)
    }

    /// What the recordings give for the number that is wrong, in the units of files.
    fn amount(&self, suspect: &Suspect, rest: Rest) -> Option<Parameter> {
        let (name, zero, unit) = match suspect.fault {
            Fault::Size(_) | Fault::Scale { .. } => ("factor", 1.0, ""),
            Fault::Shift { at, .. } => ("shift", 0.0, self.position_unit(at)),
            Fault::Constant(number) => {
                ("value", self.known.and_then(|known| known.constants.get(number).copied())?, "mm")
            }
            Fault::Reference => ("shift", 0.0, "K"),
            _ => return None,
        };
        let each = if suspect.fault.is_factor() { 1.0 + suspect.amount } else { 1.0 };
        let value = zero + suspect.with(rest.amount).amount;
        let half = (WIDTH_95 * each * rest.deviation).abs();
        let estimate = Estimate { value, ci95: (value - half, value + half), unit: unit.to_owned() };
        Some(Parameter { name, value: ParameterValue::Fitted(estimate) })
    }

    fn position_unit(&self, at: TermAt) -> &'static str {
        let axis = self.terms(at.motion).get(at.place).and_then(|term| term.axis());
        let rotary = axis.is_some_and(|axis| self.equations.axes[axis].rotary);
        if rotary { "rad" } else { "mm" }
    }
}

/// A factor with as many digits as tell it apart.
fn number(value: f64) -> String {
    format!("{:.4}", value).trim_end_matches('0').trim_end_matches('.').to_owned()
}
