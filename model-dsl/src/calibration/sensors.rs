//! Temperature sensors: the ones that a calibration reads, and the ones that it derives from them.

use super::fields::{Fields, keys, word};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::yaml::Node;
use std::collections::{BTreeMap, VecDeque};

/// All sensors of a calibration, each after those that it is derived from; terms name them by their index here.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Sensors {
    list: Vec<Sensor>,
    by_name: BTreeMap<String, usize>,
}

/// One sensor.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Sensor {
    /// Its name, and where the file speaks of it first.
    pub name: Spanned<String>,
    /// Where its temperature comes from.
    pub kind: SensorKind,
    /// Whether a term needs it, itself or through a derived sensor.
    pub used: bool,
}

/// Where a sensor's temperature comes from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum SensorKind {
    /// From a channel: the column `T_<name>` or the recording's channel `temperature.<name>`.
    Input,
    /// The mean of other sensors.
    Mean(Vec<usize>),
    /// The value that another sensor had when the recording began.
    Initial(usize),
}

impl Sensors {
    /// The sensors in an order in which each stands after those that it is derived from.
    pub fn iter(&self) -> std::slice::Iter<'_, Sensor> {
        self.list.iter()
    }

    /// Inputs of these names, in their order, each of which a term reads.
    pub fn named<'n>(names: impl IntoIterator<Item = &'n str>) -> Self {
        let mut sensors = Self::default();
        for name in names {
            sensors.reference(&Spanned::new(name.to_owned(), Span::default()));
        }
        sensors
    }

    /// How many there are, inputs and derived ones.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The index of a sensor.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// The sensors that the terms need a channel for, with their indices, in order.
    pub fn inputs(&self) -> impl Iterator<Item = (usize, &Sensor)> {
        let all = self.list.iter().enumerate();
        all.filter(|(_, sensor)| sensor.used && sensor.kind == SensorKind::Input)
    }

    /// The index of a sensor that a term uses; a name not met before is an input.
    pub(super) fn reference(&mut self, name: &Spanned<String>) -> usize {
        let index = self.intern(name);
        self.mark_used(index);
        index
    }

    /// The index of a sensor; a name not met before is an input.
    pub(super) fn intern(&mut self, name: &Spanned<String>) -> usize {
        match self.index(&name.value) {
            Some(index) => index,
            None => self.add(Sensor { name: name.clone(), kind: SensorKind::Input, used: false }),
        }
    }

    fn add(&mut self, sensor: Sensor) -> usize {
        let index = self.list.len();
        self.by_name.insert(sensor.name.value.clone(), index);
        self.list.push(sensor);
        index
    }

    /// Marks a sensor as used, and those that it is derived from.
    pub(super) fn mark_used(&mut self, index: usize) {
        let mut open = vec![index];
        while let Some(index) = open.pop() {
            let Some(sensor) = self.list.get_mut(index).filter(|sensor| !sensor.used) else {
                continue;
            };
            sensor.used = true;
            match &sensor.kind {
                SensorKind::Input => {}
                SensorKind::Mean(sources) => open.extend(sources),
                SensorKind::Initial(source) => open.push(*source),
            }
        }
    }

    /// Warns of every derived sensor that no term uses (W0401).
    pub(super) fn warn_unused(&self, diagnostics: &mut Diagnostics) {
        let unused = self.list.iter().filter(|sensor| !sensor.used && sensor.kind != SensorKind::Input);
        diagnostics.extend(unused.map(|sensor| {
            let message = format!("no term uses the derived sensor `{}`", sensor.name.value);
            Diagnostic::warning("W0401", sensor.name.span, message).help("use it in a term, or leave it out")
        }));
    }
}

/// The temperatures of all sensors, kept up to date from those of the inputs.
#[derive(Clone, Debug)]
pub struct SensorReadings<'s> {
    sensors: &'s Sensors,
    values: Vec<f64>,
    first: Vec<f64>,
    /// Whether sensors that no term reads are left out.
    of_terms: bool,
}

impl<'s> SensorReadings<'s> {
    /// Readings before the first sample: all NaN.
    pub fn new(sensors: &'s Sensors) -> Self {
        let unknown = vec![f64::NAN; sensors.len()];
        Self { sensors, first: unknown.clone(), values: unknown, of_terms: false }
    }

    /// [`new`](Self::new) for the terms alone: a sensor that none of them reads has no channel, and is 0 degC.
    pub fn of_terms(sensors: &'s Sensors) -> Self {
        Self { of_terms: true, ..Self::new(sensors) }
    }

    /// Takes one sample and gives the temperature in degC of every sensor, in the order of [`Sensors::iter`].
    ///
    /// `inputs` tells the temperature of an input by its index; NaN stands for a missing one, and makes what is derived
    /// from it NaN too. The initial value of a sensor is its first that is not NaN.
    pub fn update(&mut self, mut inputs: impl FnMut(usize) -> f64) -> &[f64] {
        for (index, sensor) in self.sensors.iter().enumerate() {
            let value = match &sensor.kind {
                _ if self.of_terms && !sensor.used => 0.0,
                SensorKind::Input => inputs(index),
                SensorKind::Mean(sources) => self.mean(sources),
                SensorKind::Initial(source) => read(&self.first, *source),
            };
            if let Some(slot) = self.values.get_mut(index) {
                *slot = value;
            }
            if let Some(first) = self.first.get_mut(index).filter(|first| first.is_nan()) {
                *first = value;
            }
        }
        &self.values
    }

    fn mean(&self, sources: &[usize]) -> f64 {
        let sum: f64 = sources.iter().map(|&source| read(&self.values, source)).sum();
        sum / sources.len() as f64
    }
}

fn read(values: &[f64], index: usize) -> f64 {
    values.get(index).copied().unwrap_or(f64::NAN)
}

/// A derived sensor as it is written, its sources not looked up yet.
struct Derived {
    name: Spanned<String>,
    sources: Vec<Spanned<String>>,
    mean: bool,
}

/// Reads the block `sensors`.
pub(super) fn read_derived(node: &Node, diagnostics: &mut Diagnostics) -> Sensors {
    let Some(entries) = node.entries() else {
        let message = format!("`sensors` must be a mapping of derived sensors, found {}", node.kind_name());
        let help = "write `{body: {mean: [T10, T21]}}`; plain sensors need no entry";
        diagnostics.push(Diagnostic::error("E0404", node.span, message).help(help));
        return Sensors::default();
    };
    let derived = entries.iter().filter_map(|(name, node)| read_one(name, node, diagnostics));
    let derived = derived.collect();
    ordered(derived, diagnostics)
}

fn read_one(name: &Spanned<String>, node: &Node, diagnostics: &mut Diagnostics) -> Option<Derived> {
    let what = format!("the derived sensor `{}`", name.value);
    let wording = keys(&what);
    let fields = Fields::open(node, name.span, wording, &["mean", "initial"], diagnostics)?;
    let (sources, mean) = match (fields.get("mean"), fields.get("initial")) {
        (Some(mean), None) => (read_mean(mean, &what, diagnostics)?, true),
        (None, Some(initial)) => {
            let of = format!("`initial` of {what}");
            (vec![word(initial, &of, diagnostics)?], false)
        }
        _ => {
            let message = format!("{what} must be either a `mean` or an `initial`");
            let help = "write `{mean: [T10, T21]}` or `{initial: T19}`";
            diagnostics.push(Diagnostic::error("E0422", name.span, message).help(help));
            return None;
        }
    };
    Some(Derived { name: name.clone(), sources, mean })
}

fn read_mean(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<Vec<Spanned<String>>> {
    let items = node.items().unwrap_or(&[]);
    if items.is_empty() {
        let message = format!("`mean` of {what} names no sensor");
        let help = "write a list of sensors: `mean: [T10, T21]`";
        diagnostics.push(Diagnostic::error("E0422", node.span, message).help(help));
        return None;
    }
    let of = format!("an entry of `mean` of {what}");
    let read: Vec<_> = items.iter().map(|item| word(item, &of, diagnostics)).collect();
    read.into_iter().collect()
}

/// Puts derived sensors after their sources; reports those that are derived from themselves (E0423).
fn ordered(derived: Vec<Derived>, diagnostics: &mut Diagnostics) -> Sensors {
    let indices: BTreeMap<&str, usize> =
        derived.iter().enumerate().map(|(index, one)| (one.name.value.as_str(), index)).collect();
    let mut waiting_for = vec![0_usize; derived.len()];
    let mut needed_by = vec![Vec::new(); derived.len()];
    for (index, one) in derived.iter().enumerate() {
        let sources = one.sources.iter().filter_map(|source| indices.get(source.value.as_str()));
        for &source in sources {
            if let (Some(count), Some(list)) = (waiting_for.get_mut(index), needed_by.get_mut(source)) {
                *count += 1;
                list.push(index);
            }
        }
    }
    let mut sensors = Sensors::default();
    let ready = |(index, count): (usize, &usize)| (*count == 0).then_some(index);
    let mut queue: VecDeque<usize> = waiting_for.iter().enumerate().filter_map(ready).collect();
    while let Some(index) = queue.pop_front() {
        if let Some(one) = derived.get(index) {
            add_derived(one, &mut sensors);
        }
        for &next in needed_by.get(index).into_iter().flatten() {
            if let Some(count) = waiting_for.get_mut(next) {
                *count -= 1;
                if *count == 0 {
                    queue.push_back(next);
                }
            }
        }
    }
    let stuck = derived.iter().zip(&waiting_for).filter(|(_, count)| **count > 0);
    diagnostics.extend(stuck.map(|(one, _)| cycle(&one.name)));
    sensors
}

fn add_derived(one: &Derived, sensors: &mut Sensors) {
    let sources: Vec<usize> = one.sources.iter().map(|source| sensors.intern(source)).collect();
    let kind = match sources.first() {
        Some(&source) if !one.mean => SensorKind::Initial(source),
        _ => SensorKind::Mean(sources),
    };
    sensors.add(Sensor { name: one.name.clone(), kind, used: false });
}

fn cycle(name: &Spanned<String>) -> Diagnostic {
    let message = format!("`{}`, or a sensor that it is made of, is derived from itself", name.value);
    let help = "derive sensors from channels, and give a derived sensor another name than a channel";
    Diagnostic::error("E0423", name.span, message).help(help)
}
