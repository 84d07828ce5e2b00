//! Machines to be recorded. In: random choices. Out: a compiled machine with its constants, its travels, and the errors that
//! are known of it, as large and as smooth as those of real machines.

use std::f64::consts::TAU;

use model_dsl::calibration::{
    CalibratedTerm, Calibration, Curve, CurveNodes, CurveValues, MachineNames, read, write,
};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Motion;
use model_dsl::source::SourceFile;
use model_dsl::{Compiled, compile, compile_word, yaml};

use crate::draw::Draw;

/// A machine that can be recorded: mm, rad.
pub(crate) struct Bench {
    /// Its name as recordings have it.
    pub(crate) name: &'static str,
    pub(crate) compiled: Compiled,
    pub(crate) names: MachineNames,
    pub(crate) constants: Vec<f64>,
    /// The range of each axis.
    pub(crate) travels: Vec<[f64; 2]>,
    /// Where each axis stands when nothing moves it.
    pub(crate) home: Vec<f64>,
}

const MACHINES: [(&str, f64); 10] = [
    ("xyfz-mill", 4.0),
    ("fxyz-mill", 4.0),
    ("xfyz-mill", 4.0),
    ("xyzf-mill", 4.0),
    ("excello-921", 3.0),
    ("nist-turning-center", 2.0),
    ("FX", 1.5),
    ("FC", 2.0),
    ("trunnion-5axis", 1.0),
    ("head-table-5axis", 1.0),
];

impl Bench {
    /// One of the machines.
    pub(crate) fn draw(draw: &mut Draw) -> Self {
        let name = draw.weighted(&MACHINES);
        let compiled = compiled(name);
        let names = compiled.equations.names();
        let travels: Vec<[f64; 2]> = names.axes.iter().map(|axis| travel(name, &axis.letter)).collect();
        let constants = names.constants.iter().map(|(constant, default)| match default {
            Some(default) => *default,
            None => offset(name, constant, draw),
        });
        let constants = constants.collect();
        let home = travels.iter().zip(&names.axes).map(|([low, high], axis)| match axis.rotary {
            true => 0.0,
            false => (low + (high - low) * draw.between(0.35, 0.65)).round(),
        });
        let home = home.collect();
        Self { name, compiled, names, constants, travels, home }
    }

    /// The slides.
    pub(crate) fn slides(&self) -> Vec<usize> {
        (0..self.names.axes.len()).filter(|axis| !self.names.axes[*axis].rotary).collect()
    }

    /// The rotary axes.
    pub(crate) fn rotaries(&self) -> Vec<usize> {
        (0..self.names.axes.len()).filter(|axis| self.names.axes[*axis].rotary).collect()
    }

    /// The directions that are compensated.
    pub(crate) fn sensitive(&self) -> [bool; 3] {
        let mut sensitive = [false; 3];
        for row in &self.compiled.equations.rows {
            sensitive[row.direction.index()] = true;
        }
        sensitive
    }

    /// The motion that is an axis's own: EXX of X.
    pub(crate) fn own(&self, axis: usize) -> Option<usize> {
        let letter = &self.names.axes[axis].letter;
        self.names.motion(&format!("E{letter}{letter}"))
    }

    /// The motions, with their numbers.
    pub(crate) fn motions(&self) -> impl Iterator<Item = (usize, &Motion)> {
        self.compiled.equations.motions.iter().enumerate()
    }

    /// What is known of the machine. `sensor` is one that the known expansion may read; between stops that alone are
    /// recorded no lag can be reckoned, so that none is known then.
    pub(crate) fn known(&self, draw: &mut Draw, sensor: Option<&str>, stops: bool) -> Calibration {
        let mut known = Calibration::new(self.name, self.constants.clone());
        let whole = draw.chance(0.8);
        let mut terms = Vec::new();
        for (number, motion) in self.motions() {
            if self.names.axes.len() == 1 && draw.chance(0.5) || !whole && draw.chance(0.6) {
                continue;
            }
            terms.extend(self.known_term(number, motion, draw).map(|term| (number, term)));
        }
        for axis in 0..self.names.axes.len() {
            let Some(own) = self.own(axis) else { continue };
            if draw.chance(0.15) {
                let size = if self.names.axes[axis].rotary { 40e-6 } else { 0.005 };
                let lost_motion = draw.between(0.3, 1.0) * size;
                terms.push((own, CalibratedTerm::Backlash { axis, lost_motion, wind_up: 0.0 }));
            }
        }
        if draw.chance(0.2) && !stops {
            let gain = draw.ratio(20.0, 90.0);
            for axis in self.slides() {
                let gain = gain * draw.between(0.97, 1.03);
                terms.extend(
                    self.own(axis).map(|own| (own, CalibratedTerm::Lag { axis, gain, frequency: 0.0 })),
                );
            }
        }
        if let Some(name) = sensor.filter(|_| draw.chance(0.25)) {
            let sensor = known.sensor(name);
            let axis = draw.pick(&self.slides());
            let coefficient = draw.between(4e-6, 11e-6);
            let term = CalibratedTerm::Expansion { axis, sensor, coefficient, reference: 20.0 };
            terms.extend(self.own(axis).map(|own| (own, term)));
        }
        self.reread(&known.with(&terms))
    }

    fn known_term(&self, number: usize, motion: &Motion, draw: &mut Draw) -> Option<CalibratedTerm> {
        if motion.alignment {
            let size = if motion.angular { 70e-6 } else { 0.02 };
            return draw.chance(0.6).then(|| CalibratedTerm::Constant { value: draw.between(-size, size) });
        }
        let axis = motion.axis?;
        let [low, high] = self.travels[axis];
        let own = self.own(axis) == Some(number);
        let size = match (motion.angular, own) {
            (true, false) => 15e-6,
            (true, true) => 30e-6,
            (false, true) => 0.008,
            (false, false) => 0.0027,
        };
        let nodes = 12_usize;
        let size = draw.between(0.6, 1.0) * size;
        let mut values = draw.curve(nodes, size);
        if own {
            let rise = draw.between(-2.0, 2.0) * size;
            let along = |node: usize| rise * node as f64 / (nodes - 1) as f64;
            values.iter_mut().enumerate().for_each(|(node, value)| *value += along(node));
        }
        let nodes = CurveNodes::Uniform { start: low, step: (high - low) / (nodes - 1) as f64 };
        Some(CalibratedTerm::Table { axis, curve: Curve::new(nodes, CurveValues::Both(values)) })
    }

    /// The calibration as it comes back from its file.
    fn reread(&self, calibration: &Calibration) -> Calibration {
        let text = write(calibration, &self.names);
        let mut findings = Diagnostics::new();
        let root = yaml::read(&SourceFile::new("calibration.yaml", text), &mut findings).unwrap();
        read(&root, &self.names, &mut findings).expect("a written calibration can be read")
    }
}

fn compiled(name: &str) -> Compiled {
    let text = match name {
        "xyfz-mill" => include_str!("../../machines/xyfz-mill.yaml"),
        "fxyz-mill" => include_str!("../../machines/fxyz-mill.yaml"),
        "xfyz-mill" => include_str!("../../machines/xfyz-mill.yaml"),
        "xyzf-mill" => include_str!("../../machines/xyzf-mill.yaml"),
        "excello-921" => include_str!("../../machines/excello-921.yaml"),
        "nist-turning-center" => include_str!("../../machines/nist-turning-center.yaml"),
        "trunnion-5axis" => include_str!("../../machines/trunnion-5axis.yaml"),
        "head-table-5axis" => include_str!("../../machines/head-table-5axis.yaml"),
        word => return compile_word(word, &mut Diagnostics::new()).unwrap(),
    };
    compile(&SourceFile::new(name, text), &mut Diagnostics::new()).unwrap()
}

fn travel(machine: &str, axis: &str) -> [f64; 2] {
    match (machine, axis) {
        ("FX" | "excello-921", "X") => [0.0, 500.0],
        ("excello-921", "Z") => [0.0, 300.0],
        ("nist-turning-center", "X") => [0.0, 250.0],
        ("nist-turning-center", "Z") => [0.0, 600.0],
        ("trunnion-5axis" | "head-table-5axis", "X" | "Y") => [-200.0, 200.0],
        ("trunnion-5axis" | "head-table-5axis", "Z") => [-50.0, 150.0],
        (_, "X") => [0.0, 550.0],
        (_, "Y") => [0.0, 280.0],
        (_, "Z") => [-110.0, 0.0],
        (_, "A" | "B") => [-1.0, 1.0],
        _ => [0.0, TAU],
    }
}

/// The value of a constant, mm.
fn offset(machine: &str, constant: &str, draw: &mut Draw) -> f64 {
    match (machine, constant) {
        ("nist-turning-center", "X1") => -148.0,
        ("nist-turning-center", "Z1") => -43.0,
        ("nist-turning-center", "X2") => 30.0,
        ("nist-turning-center", "Z2") => -26.0,
        ("nist-turning-center", "X4") => -35.0,
        ("nist-turning-center", "Z4") => 30.0,
        ("nist-turning-center", "X5") => -386.0,
        ("excello-921", "X1") => 100.0,
        ("excello-921", "Z1") => -700.0,
        ("excello-921", "X2") => 150.0,
        ("excello-921", "Xt") => 80.0,
        ("excello-921", "Zt") => -120.0,
        ("trunnion-5axis", "Za" | "Zc") | ("head-table-5axis", "Zc" | "Zb") => {
            draw.between(-80.0, -20.0).round()
        }
        (_, "Zt" | "L") => draw.between(80.0, 200.0).round(),
        _ => 0.0,
    }
}
