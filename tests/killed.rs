//! A diagnosis that is killed: what it writes is there whole, as it was before, or not at all.
//!
//! In: a small recording, and moments drawn by chance. Out: after each kill, the file that `--write-calibration` names is the one
//! that was there, or the one that an undisturbed run writes. Nothing can be done about what is redirected from standard output.
//! More kills than the usual ones:
//!
//! ```text
//! ABBE_KILLS=100 cargo test --release --test abbe killed
//! ```

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use std::{env, fs, thread};

use simulation::noise::Source;

use crate::shipped::root;

/// How often it is killed, where nobody asks for more.
const KILLS: usize = 20;

/// A diagnosis of the shipped recording that writes a calibration.
fn begun(target: &Path, format: &str) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    command.args(["diagnose", "recordings/postech-ballbar/recording.yaml", "--format", format, "--quiet"]);
    command.arg("--write-calibration").arg(target).current_dir(root());
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// What an undisturbed run writes, and how long it takes.
fn undisturbed(target: &Path, format: &str) -> (String, Duration) {
    let begin = Instant::now();
    assert!(begun(target, format).wait().unwrap().success());
    (fs::read_to_string(target).unwrap(), begin.elapsed())
}

#[test]
fn a_killed_diagnosis_leaves_no_half_written_calibration() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("killed");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let target = folder.join("improved.yaml");
    let kills = env::var("ABBE_KILLS").map_or(KILLS, |kills| kills.parse().unwrap());
    let mut moments = Source::new(7, "kills");
    let whole = ["json", "html"].map(|format| undisturbed(&target, format));
    for number in 0..kills {
        let (format, (complete, time)) = (["json", "html"][number % 2], &whole[number % 2]);
        // In turn over a file that was there, and where none is.
        let before = (number % 4 < 2).then(|| "what was there\n".to_owned());
        let _ = fs::remove_file(&target);
        if let Some(before) = &before {
            fs::write(&target, before).unwrap();
        }
        let mut child = begun(&target, format);
        // Two of three near the end, where it writes.
        let share = moments.uniform();
        thread::sleep(time.mul_f64(if number % 3 == 0 { share } else { 0.85 + 0.2 * share }));
        let _ = child.kill();
        child.wait().unwrap();
        let after = fs::read_to_string(&target).ok();
        assert!(after == before || after.as_ref() == Some(complete), "kill {number}: {after:?}");
    }
}
