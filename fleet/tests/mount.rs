//! Six nights of a real telescope mount. In: recordings beside the repository. Out: nothing, or where what is followed is not what is known
//! of it: its worm turns once in 2 deg and draws a wave of 2.0 to 2.6 arcsec in each night, and nothing changed.

use std::fs;
use std::path::Path;

use abbe_fleet::{file, run};
use recording::Moment;

#[test]
fn a_mount_whose_worm_stays_raises_no_alarm() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/fleet");
    let Ok(shared) = shared.canonicalize() else {
        eprintln!("skipped: the recordings of the mount are not beside the repository");
        return;
    };
    let folder = std::env::temp_dir().join(format!("abbe-fleet-mount-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let glob = shared.join("*/recording.yaml");
    let text = format!(
        "fleet: 1\nmachines: {{mount: {{recordings: \"{}\", time: YYYY-MM-DD_hhmmss}}}}\n",
        glob.display()
    );
    fs::write(folder.join("fleet.yaml"), text).unwrap();
    let fleet = file::read(&folder.join("fleet.yaml"), &()).ok().unwrap();
    assert_eq!(run::all(&fleet, (None, false), &(), &|_| {}).ok().unwrap().followed, 23);
    let history = abbe_fleet::history(&fleet, Moment::read("2026-09-01").unwrap(), &()).ok().unwrap();
    fs::remove_dir_all(&folder).unwrap();
    assert!(history.alarms.is_empty(), "{:#?}", history.alarms);
    let is_worm = |effect: &str| {
        let period = effect.split(' ').rev().nth(1).and_then(|period| period.parse::<f64>().ok());
        effect.starts_with("ECC cyclic") && period.is_some_and(|period| (period - 2.0).abs() < 0.05)
    };
    let worm = history.machines[0].series.iter().find(|followed| is_worm(&followed.series.effect)).unwrap();
    assert_eq!(worm.series.points.len(), 23, "it is followed in every session");
    // Both ends of the series are what its owner's logs give, 2.0 to 2.6 arcsec, with the scatter from session to session, and no end
    // might as well be nothing.
    let change = worm.change.as_ref().unwrap();
    for (value, half) in [change.before, change.after].map(|(value, half)| (3600.0 * value, 3600.0 * half)) {
        assert!(half < value && value - half <= 2.6 && value + half >= 2.0, "{value} +- {half} arcsec");
    }
    let mut sizes: Vec<f64> = worm.series.points.iter().map(|point| 3600.0 * point.value).collect();
    sizes.sort_by(f64::total_cmp);
    assert!((2.0..=2.6).contains(&sizes[11]), "the middle of all sessions: {} arcsec", sizes[11]);
}
