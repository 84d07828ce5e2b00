//! Examples for the end of each command's help. In: nothing. Out: at least two examples for each command, each with its purpose.
//!
//! `tests/examples.rs` runs all of them, one after the other, in the folder of the repository. A path with a folder is a file of the
//! repository. A bare name is a file that an earlier example wrote, or a file of the user, for which the test provides one.

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
        => "Compare published equations of a lathe with the derived ones; the status is 1 if they disagree.",
    "abbe check machines/printer-skew.yaml published/printer-skew.eqs" => "Compare the skew correction of a printer's firmware.",
};

pub(crate) const EXPAND: &str = examples! {
    "abbe expand XYFZ" => "The Rust code of a mill, the same as from `machine!` or a build script.",
    "abbe expand postech-mill --calibration calibrations/postech-mill.yaml --output mill.rs"
        => "The same with the numbers of one specimen compiled in.",
    "abbe expand postech-mill --f32 --output mill-f32.rs" => "The mill for a controller whose processor has no doubles.",
};

pub(crate) const COMPENSATE: &str = examples! {
    "abbe compensate calibrations/postech-mill.yaml --summary < calibrations/postech-points.csv"
        => "The errors at seven points, the positions to command instead, and the error that remains.",
    "echo x,y,z | abbe compensate calibrations/postech-mill.yaml --map map.svg"
        => "A picture of the errors over the workspace; the header is enough as a table of points.",
};

pub(crate) const DIAGNOSE: &str = examples! {
    "abbe diagnose recordings/servo-rest/recording.yaml" => "The findings of a recording, as text.",
    "abbe diagnose recordings/postech-ballbar/recording.yaml --write-calibration improved.yaml"
        => "A calibration with the findings, ready for compensation.",
};

pub(crate) const LIMITS: &str = examples! {
    "abbe limits recording.yaml" => "The size from which each effect would be found in your recording.",
    "abbe limits recording.yaml --only backlash --trials 10 --format html --output limits.html"
        => "A quick look at one kind, as a page with curves.",
};

pub(crate) const PLAN: &str = examples! {
    "abbe plan path.yaml --machine FX" => "The detection limits of a planned path, and suggested extra passes.",
    "abbe plan path.yaml --machine FX --only EXX --trials 10" => "A quick look at one error motion.",
};

pub(crate) const SIMULATE: &str = examples! {
    "abbe simulate calibrations/postech-mill.yaml recordings/postech-ballbar/path.yaml --output ballbar"
        => "The recording of a ballbar test of a mill, in the folder `ballbar`.",
    "abbe simulate stage.yaml path.yaml --output stage --plot stage.svg"
        => "The recording of your own path, with a picture of path and readings.",
};

pub(crate) const CALIBRATE: &str = examples! {
    "abbe calibrate recordings/xyfz-mill-laser/setup.yaml" => "The report on the files of a laser and an indicator.",
    "abbe calibrate recordings/xyfz-mill-laser/setup.yaml --output mill.yaml" => "The report and the calibration.",
};

pub(crate) const UPDATE: &str = examples! {
    "abbe update calibrations/postech-mill.yaml part.yaml --output new.yaml"
        => "A calibration whose coefficients fit the part measured in part.yaml.",
    "abbe update calibrations/postech-mill.yaml part.yaml --method ridge --datum turned"
        => "Only the report, by ridge regression, for a part that was measured on another machine.",
};

pub(crate) const EVALUATE: &str = examples! {
    "abbe evaluate recordings/xyfz-mill-laser/x-linear.rtl" => "Positioning by ISO 230-2, from the file of a laser.",
    "abbe evaluate recordings/postech-ballbar/recording.yaml --format html --output circles.html"
        => "Circles by ISO 230-4, as a page with diagrams.",
};

pub(crate) const FLEET: &str = examples! {
    "abbe fleet run" => "Diagnose the recordings in `fleet.yaml` that have no result yet.",
    "abbe fleet show" => "The state of each machine, and what changed.",
};

pub(crate) const FLEET_RUN: &str = examples! {
    "abbe fleet run fleet.yaml --pages" => "Diagnose all recordings without a result, and write a page for each.",
    "abbe fleet run fleet.yaml --shard 3/16" => "The third of sixteen parts, for computers that share the folder.",
    "abbe fleet run fleet.yaml --list" => "The remaining jobs, for a scheduler.",
};

pub(crate) const FLEET_ADD: &str = examples! {
    "abbe fleet add results-2" => "Add results of the same recordings from another computer.",
    "abbe fleet add results-2 results-3 --fleet fleet.yaml" => "Add the results of two computers.",
};

pub(crate) const FLEET_SHOW: &str = examples! {
    "abbe fleet show fleet.yaml" => "The alarms, then one line per machine.",
    "abbe fleet show fleet.yaml --output pages" => "A page of the fleet, and one for each machine.",
};

pub(crate) const EXPORT: &str = examples! {
    "abbe export linuxcnc calibrations/postech-mill.yaml"
        => "The screw tables of LinuxCNC, and how much error they leave at the tool.",
    "abbe export isg calibrations/postech-mill.yaml --output ." => "All error motions, for TwinCAT.",
    "abbe export linuxcnc calibrations/postech-mill.yaml --check X=x.comp" => "Check how the controller reads an existing file.",
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
    "abbe new recording recordings/postech-ballbar/data.csv" => "A recording file derived from the column names; check each line.",
    "abbe new recording recordings/servo-rest/data.csv --machine FC --output servo.yaml"
        => "The same for a known machine.",
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
    "abbe explain E0307" => "A code: what is wrong, a file that causes it, and the corrected file.",
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
