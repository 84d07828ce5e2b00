//! A single slide, as generated code would have it, and calibrations of it in files.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use abbe_c::{AxisOfMachine, CompiledMachine, ConstantOfMachine, Controller, MotionOfMachine, load};
use abbe_runtime::Kinematics;

/// The machine file that the slide is compiled from.
pub(crate) const MACHINE: &str = "abbe: 1\nname: stage\ntopology: FX\nsensitive: [X]\n";

/// The topology FX in the direction X: `EXX + Zt*EBX - Yt*ECX`.
#[derive(Clone, Copy)]
pub(crate) struct Stage {
    constants: [f64; 3],
}

impl Kinematics for Stage {
    fn axes(&self) -> usize {
        1
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        3
    }
    fn error(&self, _: &[f64], _: &[f64], motions: &[f64]) -> [f64; 3] {
        let [_, yt, zt] = self.constants;
        match motions {
            [exx, ebx, ecx] => [exx + zt * ebx - yt * ecx, 0.0, 0.0],
            _ => [f64::NAN; 3],
        }
    }
    fn directions(&self, _: &[f64], directions: &mut [[f64; 3]]) {
        directions.fill([1.0, 0.0, 0.0]);
    }
}

impl CompiledMachine for Stage {
    const NAME: &'static str = "stage";
    const CONSTANTS: &'static [ConstantOfMachine] = &[("Xt", None), ("Yt", None), ("Zt", None)];
    const AXES: &'static [AxisOfMachine] = &[("X", false)];
    const MOTIONS: &'static [MotionOfMachine] =
        &[("EXX", false, Some("X"), true), ("EBX", true, Some("X"), false), ("ECX", true, Some("X"), false)];
    const EQUATIONS: &'static str = "what no machine file says";

    fn with_constants(constants: &[f64]) -> Option<Self> {
        Some(Self { constants: constants.try_into().ok()? })
    }
}

/// A folder that goes away.
pub(crate) struct Folder(PathBuf);

impl Folder {
    /// A new one.
    pub(crate) fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("abbe-c-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        fs::create_dir(&path).unwrap();
        Self(path)
    }

    /// Writes a file in it.
    pub(crate) fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, text).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The text of a calibration of the slide.
pub(crate) fn calibration(rest: &str) -> String {
    format!("calibration: 1\nmachine: stage\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 100 mm}}\n{rest}")
}

/// The controller of a slide with a calibration.
pub(crate) fn controller(rest: &str) -> Controller {
    let folder = Folder::new();
    loaded(&folder.file("stage.yaml", &calibration(rest))).unwrap_or_else(|why| panic!("{why}"))
}

/// The controller of a slide with the calibration in a file.
pub(crate) fn loaded(path: &Path) -> Result<Controller, String> {
    load::<Stage>(path).map(|loaded| loaded.controller)
}
