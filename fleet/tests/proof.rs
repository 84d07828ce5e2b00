//! A small simulated shop: what is planted in it is raised, nothing else is, and intervals hold the truth.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test, whose shop is its own")]

#[path = "../examples/fleet-proof/judged.rs"]
mod judged;
#[path = "../examples/fleet-proof/shop.rs"]
mod shop;

use std::fs;

use fleet::run::{self, Shard};
use fleet::{file, report};

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
    assert_eq!(one.diagnosed + two.diagnosed, 6 * 14 + 1);
    let rest = run::all(&fleet, (None, false), &(), &|_| {}).ok().unwrap();
    assert_eq!((rest.diagnosed, rest.waiting), (0, 0));
    assert_eq!(one.followed + two.followed + rest.followed, 6 * 14 + 1);
    assert_eq!(run::all(&fleet, (None, false), &(), &|_| {}).ok().unwrap().followed, 0);
    let judged = judged::judged(shop, &fleet);
    assert!(judged.raised.iter().all(|(_, week, _)| week.is_some()), "{judged:?}");
    assert!(judged.other.is_empty(), "{judged:?}");
    let (held, all) = judged.held;
    // Of 95 % of 200 and more, less than 91 % come once in 1e3.
    assert!(all > 200 && held * 100 > all * 91, "{held} of {all}");
    let history = fleet::history(&fleet, shop.time(20), &()).ok().unwrap();
    let text = report::text(&history, 100);
    assert!(text.contains("mill-06: ") && report::json(&history).contains("no machine `nothing`"), "{text}");
    fs::remove_dir_all(&folder).unwrap();
}
