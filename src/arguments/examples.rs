//! Examples of the commands, which stand at the end of their help. In: nothing. Out: for each command its examples, two at least,
//! each with what it is for.
//!
//! All of them run in the folder of the repository, one after the other: `tests/examples.rs`. A file in a folder is the repository's. A
//! bare name is a file that an example has written, or a file of the user's, for which the test has one of its own.

/// The text of examples: a command line, then what it gives.
macro_rules! examples {
    ($($command:literal => $what:literal),+ $(,)?) => {
        concat!("Examples (files in folders are those of Abbe's repository):\n", $("\n  ", $command, "\n      ", $what),+)
    };
}

pub(crate) const ABBE: &str = examples! {
    "abbe derive XYFZ" => "The error equations of a mill: X on Y carry the part, Z carries the tool.",
    "abbe diagnose recordings/servo-rest/recording.yaml" => "What a recording of a real machine shows.",
    "abbe explain squareness" => "A word of these pages.",
};

pub(crate) const DERIVE: &str = examples! {
    "abbe derive XYFZ" => "The equations of a topology word: X on Y carry the part, Z carries the tool.",
    "abbe derive machines/trunnion-5axis.yaml --format html --output trunnion.html"
        => "A page with the drawing of the chain, the equations, and what each error motion reaches.",
    "abbe derive trunnion-5axis --format svg --output trunnion.svg" => "The drawing of the chain alone.",
};

pub(crate) const CHECK: &str = examples! {
    "abbe check excello-921 published/excello-921.eqs"
        => "A published set of equations of a lathe against the derived ones; status 1 where they disagree.",
    "abbe check machines/printer-skew.yaml published/printer-skew.eqs" => "The skew of a printer's firmware.",
};

pub(crate) const EXPAND: &str = examples! {
    "abbe expand XYFZ" => "The Rust code of a mill, as `machine!` and a build script get it.",
    "abbe expand postech-mill --calibration calibrations/postech-mill.yaml --output mill.rs"
        => "The same with the numbers of one specimen compiled in.",
};

pub(crate) const COMPENSATE: &str = examples! {
    "abbe compensate calibrations/postech-mill.yaml --summary < calibrations/postech-points.csv"
        => "The errors at seven points, what to command instead, and how much that takes away.",
    "echo x,y,z | abbe compensate calibrations/postech-mill.yaml --map map.svg"
        => "A picture of the errors over the workspace; of points it needs the header alone.",
};

pub(crate) const DIAGNOSE: &str = examples! {
    "abbe diagnose recordings/servo-rest/recording.yaml" => "What a recording shows, for a person.",
    "abbe diagnose recordings/postech-ballbar/recording.yaml --write-calibration improved.yaml"
        => "The known calibration with what was found, to compensate with.",
};

pub(crate) const LIMITS: &str = examples! {
    "abbe limits recording.yaml" => "From which size on each effect would be found in a recording of yours.",
    "abbe limits recording.yaml --only backlash --trials 10 --format html --output limits.html"
        => "A quick look at one kind, as a page with curves.",
};

pub(crate) const PLAN: &str = examples! {
    "abbe plan path.yaml --machine FX" => "What a path would show that was not driven yet, and what to drive besides.",
    "abbe plan path.yaml --machine FX --only EXX --trials 10" => "A quick look at one error motion.",
};

pub(crate) const SIMULATE: &str = examples! {
    "abbe simulate calibrations/postech-mill.yaml recordings/postech-ballbar/path.yaml --output ballbar"
        => "The recording of a ballbar test of a mill, in the folder `ballbar`.",
    "abbe simulate stage.yaml path.yaml --output stage --plot stage.svg"
        => "That of a path of yours, and a picture of it and of the readings.",
};

pub(crate) const CALIBRATE: &str = examples! {
    "abbe calibrate recordings/xyfz-mill-laser/setup.yaml" => "The report: what the files of a laser and of an indicator give.",
    "abbe calibrate recordings/xyfz-mill-laser/setup.yaml --output mill.yaml" => "The calibration as well.",
};

pub(crate) const UPDATE: &str = examples! {
    "abbe update calibrations/postech-mill.yaml part.yaml --output new.yaml"
        => "A calibration whose coefficients fit the part that part.yaml measures.",
    "abbe update calibrations/postech-mill.yaml part.yaml --method ridge --datum turned"
        => "The report alone, of another method, for a part that was measured on another machine.",
};

pub(crate) const EVALUATE: &str = examples! {
    "abbe evaluate recordings/xyfz-mill-laser/x-linear.rtl" => "Positioning after ISO 230-2, from a laser's file.",
    "abbe evaluate recordings/postech-ballbar/recording.yaml --format html --output circles.html"
        => "Circles after ISO 230-4, as a page with diagrams.",
};

pub(crate) const FLEET: &str = examples! {
    "abbe fleet run" => "Diagnoses the recordings that `fleet.yaml` names and that have no result yet.",
    "abbe fleet show" => "How each machine is, and what changed.",
};

pub(crate) const FLEET_RUN: &str = examples! {
    "abbe fleet run fleet.yaml --pages" => "Every recording that has no result yet, and the page of each diagnosis.",
    "abbe fleet run fleet.yaml --shard 3/16" => "The third of sixteen parts, for computers that share the folder.",
    "abbe fleet run fleet.yaml --list" => "What is still to be done, for a scheduler.",
};

pub(crate) const FLEET_ADD: &str = examples! {
    "abbe fleet add results-2" => "Results of the same recordings, made on another computer.",
    "abbe fleet add results-2 results-3 --fleet fleet.yaml" => "Those of two computers.",
};

pub(crate) const FLEET_SHOW: &str = examples! {
    "abbe fleet show fleet.yaml" => "Alarms, then a line a machine.",
    "abbe fleet show fleet.yaml --output pages" => "The page of the fleet, and one of each machine.",
};

pub(crate) const EXPORT: &str = examples! {
    "abbe export linuxcnc calibrations/postech-mill.yaml"
        => "The screw tables of LinuxCNC, and how much error they leave at the tool.",
    "abbe export isg calibrations/postech-mill.yaml --output ." => "All error motions, for TwinCAT.",
    "abbe export linuxcnc calibrations/postech-mill.yaml --check X=x.comp" => "What the controller makes of a file.",
};

pub(crate) const NEW: &str = examples! {
    "abbe new XYFZ --output mill-1.yaml" => "A machine file with the chain of a topology word.",
    "abbe new calibration mill-1.yaml --output mill-1-known.yaml" => "A calibration of that machine, all zero.",
};

pub(crate) const NEW_MACHINE: &str = examples! {
    "abbe new machine XYFZ" => "A mill: X on Y carry the part, Z carries the tool.",
    "abbe new machine CAFXYZ --output five.yaml" => "Two rotary axes under the part, three slides behind the tool.",
};

pub(crate) const NEW_CALIBRATION: &str = examples! {
    "abbe new calibration XYFZ" => "Every constant and error motion of a topology word, all zero.",
    "abbe new calibration machines/trunnion-5axis.yaml --output trunnion.yaml" => "Those of a machine file.",
};

pub(crate) const NEW_RECORDING: &str = examples! {
    "abbe new recording recordings/postech-ballbar/data.csv" => "What the names of the columns tell; check each line.",
    "abbe new recording recordings/servo-rest/data.csv --machine FC --output servo.yaml"
        => "A recording of a machine that is known.",
};

pub(crate) const NEW_SETUP: &str = examples! {
    "abbe new setup recordings/xyfz-mill-laser/x-linear.rtl" => "A set-up for a file of a laser.",
    "abbe new setup recordings/xyfz-mill-laser/*.rtl --output setup.yaml" => "A set-up for two files.",
};

pub(crate) const NEW_PATH: &str = examples! {
    "abbe new path XYFZ" => "A circle in the plane of X and Y.",
    "abbe new path machines/excello-921.yaml --output lathe-path.yaml" => "A circle of a lathe.",
};

pub(crate) const EXPLAIN: &str = examples! {
    "abbe explain E0307" => "A code: what is wrong, a file that gives it, and that file mended.",
    "abbe explain backlash" => "A term: what it is, how a recording shows it, how to measure and remove it.",
    "abbe explain EX0C" => "An error motion, in any spelling.",
    "abbe explain gantry" => "A word of the guide's glossary.",
};

pub(crate) const COMPLETIONS: &str = examples! {
    "abbe completions bash > abbe.bash" => "For bash: put it into ~/.local/share/bash-completion/completions.",
    "abbe completions zsh > _abbe" => "For zsh: put it into a folder of `fpath`.",
};

pub(crate) const MAN: &str = examples! {
    "abbe man > abbe.1" => "The page of the program; `man ./abbe.1` shows it.",
    "abbe man --output man1" => "A page for each command, in the folder `man1`.",
};
