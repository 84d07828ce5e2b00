//! A small simulated shop: what is planted in it is raised, nothing else is, and intervals hold the truth.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test, whose shop is its own")]

#[path = "../src/chance.rs"]
mod chance;
#[path = "../examples/fleet-proof/judged.rs"]
mod judged;
#[path = "../examples/fleet-proof/shop.rs"]
mod shop;

use std::fs;

use abbe_fleet::run::{self, Shard};
use abbe_fleet::{file, report};

#[test]
fn planted_changes_are_raised_and_nothing_else_is() {
    let folder = std::env::temp_dir().join(format!("abbe-fleet-proof-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let shop = shop::Shop { machines: 6, weeks: 14, seed: 5 };
    shop.write(&folder);
    // A recording that cannot be read does not end the run.
    fs::write(folder.join("mill-06/2026-03-01.yaml"), "recording: 1\nmachine: nothing\n").unwrap();
    let fleet = file::read(&folder.join("fleet.yaml"), &()).ok().unwrap();
    // Two parts, and then the rest: what one part did, no other does again.
    let part = |part| run::all(&fleet, (Some(Shard { part, of: 2 }), false), &(), &|_| {}).ok().unwrap();
    let (one, two) = (part(1), part(2));
    assert_eq!((one.diagnosed + two.diagnosed, one.errors.max(two.errors)), (6 * 14, 1));
    let rest = run::all(&fleet, (None, false), &(), &|_| {}).ok().unwrap();
    assert_eq!((rest.diagnosed, rest.waiting), (0, 0));
    assert_eq!(one.followed + two.followed + rest.followed, 6 * 14 + 1);
    assert_eq!(run::all(&fleet, (None, false), &(), &|_| {}).ok().unwrap().followed, 0);
    let judged = judged::judged(shop, &fleet);
    for (number, raised) in judged.raised.iter().enumerate() {
        let ((size, half), truth) = (raised.size, shop.planted(number));
        assert!(raised.week.is_some() && !raised.sentence.is_empty(), "{}: {judged:?}", raised.what);
        // Three changes: that all three intervals are twice too narrow is chance in none of ten thousand.
        assert!(
            (size - truth).abs() <= 2.0 * half && half < truth / 4.0,
            "{size} +- {half} for {truth}: {raised:?}"
        );
    }
    let kinds: Vec<&str> = judged.raised.iter().map(|raised| raised.kind).collect();
    assert_eq!(kinds, ["trend", "trend", "step"]);
    // The step is told at its week, and its effect is found in no recording before.
    assert_eq!((judged.raised[2].from, judged.raised[2].claimed.0), (shop.step(), 0));
    assert!(judged.raised[2].claimed.1 > 0);
    // Its week is counted from 1, and none knows of it before.
    assert!(judged.raised[2].week > Some(shop.step()));
    assert!(judged.other.is_empty(), "{judged:?}");
    // Of those that hold 93 to 97 of a hundred.
    let (held, all) = judged.held;
    let cases = u32::try_from(all).unwrap();
    let (least, most) = (chance::bounds(cases, 0.93).0, chance::bounds(cases, 0.97).1);
    assert!(all > 200 && (least..=most).contains(&held), "{held} of {all}, from {least} to {most}");
    let history = abbe_fleet::history(&fleet, shop.time(20), &()).ok().unwrap();
    let text = report::text(&history, 100);
    assert!(text.contains("mill-06: ") && report::json(&history).contains("no machine `nothing`"), "{text}");
    fs::remove_dir_all(&folder).unwrap();
}
