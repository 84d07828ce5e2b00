//! Pictures that are files of their own: the map of `abbe compensate` and the plot of `abbe simulate`. In: small machines
//! whose errors are known in closed form. Out: what the drawings say and show, and that nothing is written in vain.

use std::fs;
use std::path::{Path, PathBuf};

use crate::cli::{Run, abbe};

/// X is longer by 0.05 um/mm, and 40 urad stand between X and Y.
const CALIBRATION: &str = "calibration: 1\nmachine: xyfz-mill\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\nerrors:\n  EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.05]}}]\n  EC0Y: 40 urad\n";

/// Two corners of 500 mm by 300 mm by 100 mm.
const CORNERS: &str = "x,y,z\n0,0,-100\n500,300,0\n";

const PATH: &str = "path: 1\ntitle: circle <of> & more\nat: {X: 250 mm, Y: 150 mm, Z: -50 mm}\ncircle: {plane: XY, radius: 100 mm}\nfeed: 1000 mm/min\nrate: 20 Hz\ninstrument: ballbar\nnoise: 1 um\nseed: 1\n";

/// An empty folder of a test's own with its files.
fn folder(test: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("pictures").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("known.yaml"), CALIBRATION).unwrap();
    fs::write(folder.join("path.yaml"), PATH).unwrap();
    folder
}

fn at(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_owned()
}

/// The drawing that a run wrote: one whose marks are closed in order, and that has no number that is none.
fn drawing(run: &Run, path: &str) -> String {
    assert_eq!(run.status, 0, "{}", run.err);
    let drawing = fs::read_to_string(path).unwrap();
    assert!(drawing.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""), "{path}");
    let mut open: Vec<&str> = Vec::new();
    for mark in drawing.split('<').skip(1).map(|piece| piece.split_once('>').unwrap().0) {
        match mark.strip_prefix('/') {
            Some(closed) => assert_eq!(open.pop(), Some(closed)),
            None if mark.ends_with('/') => {}
            None => open.push(mark.split_whitespace().next().unwrap()),
        }
    }
    assert!(open.is_empty(), "{open:?}");
    for part in ["NaN", "inf\"", "<script", "url(", "@import", "href"] {
        assert!(!drawing.contains(part), "{part}");
    }
    drawing
}

fn map(folder: &Path, input: &str, more: &[&str]) -> Run {
    let (known, map) = (at(folder, "known.yaml"), at(folder, "map.svg"));
    abbe(&[&["compensate", &known, "--map", &map], more].concat(), input)
}

#[test]
fn a_map_has_three_slices_of_each_plane_and_says_how_long_the_errors_are() {
    let folder = folder("map");
    let run = map(&folder, CORNERS, &[]);
    let drawing = drawing(&run, &at(&folder, "map.svg"));
    assert!(run.out.starts_with("x,y,z,error_x,"), "the rows come out as without a map");
    for title in [
        "Error in X and Y at Z \u{2212}100 mm (least)",
        "Error in X and Y at Z \u{2212}50 mm (middle)",
        "Error in X and Z at Y 300 mm (greatest)",
        "Error in Y and Z at X 250 mm (middle)",
    ] {
        let ascii = title.replace('\u{2212}', "-");
        assert!(drawing.contains(title) || drawing.contains(&ascii), "{title}");
    }
    assert_eq!(drawing.matches(">Error in ").count(), 9);
    // At Y 0 the scale alone: 25 um at X 500. At Y 300 the square takes 12 um off: from -12 um to 13 um. Of Y and Z neither
    // has an error.
    let of =
        |title: &str| drawing.split(title).nth(1).unwrap().split("position of").next().unwrap().to_owned();
    assert!(of("Error in X and Z at Y 0 mm").contains("25.0 \u{b5}m"));
    assert!(of("Error in X and Z at Y 300 mm").contains("13.0 \u{b5}m"));
    assert!(of("Error in Y and Z at X 500 mm").contains("No error in this plane"));
    assert!(drawing.contains(":1</text>") && drawing.contains("bar: 20 \u{b5}m of error"));
}

#[test]
fn arrows_are_as_long_as_their_magnification_says() {
    let folder = folder("arrows");
    let run = map(&folder, CORNERS, &[]);
    let drawing = drawing(&run, &at(&folder, "map.svg"));
    // In the slice of X and Z at Y 0 the error at X 500 is 25 um; the bar shows 20 um.
    let slice =
        drawing.split("Error in X and Z at Y 0 mm").nth(1).unwrap().split("Error in ").next().unwrap();
    let lengths = |class: &str| -> Vec<f64> {
        let path =
            slice.rsplit(&format!("class=\"{class}\" d=\"")).next().unwrap().split('"').next().unwrap();
        let pieces = path.split('M').filter_map(|piece| {
            let places: Vec<Vec<f64>> = piece
                .split('L')
                .map(|place| place.split(' ').filter_map(|number| number.parse().ok()).collect())
                .collect();
            let [from, to, ..] = places.as_slice() else { return None };
            Some((to.first()? - from.first()?).hypot(to.get(1)? - from.get(1)?))
        });
        pieces.collect()
    };
    let longest = |all: Vec<f64>| all.into_iter().fold(0.0, f64::max);
    let (arrow, bar) = (longest(lengths("l c1")), longest(lengths("l ci")));
    assert!((arrow / bar - 25.0 / 20.0).abs() < 0.02, "{arrow} {bar}");
}

#[test]
fn tables_say_how_far_the_workspace_goes() {
    let folder = folder("tables");
    let table = "calibration: 1\nmachine: FX\nerrors:\n  EXX: [{table: {axis: X, start: 10 mm, step: 20 mm, unit: um, values: [0, 5, 3]}}]\n";
    fs::write(folder.join("known.yaml"), table).unwrap();
    let run = map(&folder, "x\n0\n400\n", &[]);
    let drawing = drawing(&run, &at(&folder, "map.svg"));
    assert!(drawing.contains("Error along X") && drawing.contains(">position of X, mm<"));
    assert!(drawing.contains(">50</text>") && !drawing.contains(">400</text>"), "from 10 to 50 mm");
    // A header alone is enough where there are tables.
    assert_eq!(map(&folder, "x\n", &["--force"]).status, 0);
}

#[test]
fn no_map_is_drawn_over_nothing_or_over_what_is_there() {
    let folder = folder("refused");
    let none = map(&folder, "x,y,z\n1,2,3\n", &[]);
    assert_eq!(none.status, 1);
    assert!(none.err.contains("two opposite corners"), "{}", none.err);
    assert!(!folder.join("map.svg").exists());
    fs::write(folder.join("map.svg"), "mine").unwrap();
    let there = map(&folder, CORNERS, &[]);
    assert_eq!((there.status, there.out.as_str()), (2, ""), "nothing is done at all");
    assert!(there.err.contains("already exists") && there.err.contains("--force"), "{}", there.err);
    assert_eq!(fs::read_to_string(folder.join("map.svg")).unwrap(), "mine");
    drawing(&map(&folder, CORNERS, &["--force"]), &at(&folder, "map.svg"));
    let known = at(&folder, "known.yaml");
    for (target, said) in [
        (known.clone(), "one of the files that this command"),
        (at(&folder, "no/such/map.svg"), "does not exist"),
        (at(&folder, ""), "is a folder"),
    ] {
        let run = abbe(&["compensate", &known, "--map", &target, "--force"], CORNERS);
        assert_eq!(run.status, 2, "{target}");
        assert!(run.err.contains(said), "{target}: {}", run.err);
    }
    assert_eq!(fs::read_to_string(&known).unwrap(), CALIBRATION);
    // A bad row ends the command before there is a map.
    fs::remove_file(folder.join("map.svg")).unwrap();
    assert_eq!(map(&folder, "x,y,z\n0,0,-100\nx,0,0\n", &[]).status, 1);
    assert!(!folder.join("map.svg").exists());
}

#[test]
fn a_simulation_shows_its_path_in_each_plane_and_its_readings() {
    let folder = folder("plot");
    let (known, path) = (at(&folder, "known.yaml"), at(&folder, "path.yaml"));
    let (output, plot) = (at(&folder, "new"), at(&folder, "new/plot.svg"));
    let simulate = |plot: &str, more: &[&str]| {
        abbe(&[&["simulate", &known, &path, "--output", &output, "--plot", plot], more].concat(), "")
    };
    // The folder of the recording is made, and the picture may stand in it.
    let drawing = drawing(&simulate(&plot, &[]), &plot);
    for part in [
        "<title>circle &lt;of&gt; &amp; more</title>",
        "Path in X and Y",
        "Path in X and Z",
        "Path in Y and Z",
        ">deviation</text>",
        ">time, s</text>",
        ">reading, \u{b5}m</text>",
        ">as read</text>",
        ">without noise</text>",
    ] {
        assert!(drawing.contains(part), "{part}");
    }
    let again = simulate(&plot, &[]);
    assert_eq!(again.status, 2);
    let data = at(&folder, "new/data.csv");
    let own = simulate(&data, &["--force"]);
    assert_eq!(own.status, 2);
    assert!(own.err.contains("one of the files that this command"), "{}", own.err);
    assert!(fs::read_to_string(&data).unwrap().starts_with("t_s,run,"), "the data stand as they were");
    // Nor over the data of a recording that is driven again.
    let recording = at(&folder, "new/recording.yaml");
    let again =
        ["simulate", &known, &recording, "--output", &at(&folder, "again"), "--force", "--plot", &data];
    assert_eq!(abbe(&again, "").status, 2);
    assert!(fs::read_to_string(&data).unwrap().starts_with("t_s,run,"), "the data stand as they were");
}

#[test]
fn a_circle_is_drawn_round() {
    let folder = folder("round");
    let (known, path, plot) = (at(&folder, "known.yaml"), at(&folder, "path.yaml"), at(&folder, "plot.svg"));
    let output = at(&folder, "out");
    let run = abbe(&["simulate", &known, &path, "--output", &output, "--plot", &plot], "");
    let drawing = drawing(&run, &plot);
    let slice = drawing.split("Path in X and Y").nth(1).unwrap();
    let path = slice.split("class=\"l c1\" d=\"").nth(1).unwrap().split('"').next().unwrap();
    let places: Vec<(f64, f64)> = path
        .split(['M', 'L'])
        .filter_map(|place| place.split_once(' '))
        .filter_map(|(x, y)| Some((x.parse().ok()?, y.parse().ok()?)))
        .collect();
    let reach = |of: fn(&(f64, f64)) -> f64| {
        let all = places.iter().map(of);
        all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
    };
    let (wide, high) = (reach(|place| place.0), reach(|place| place.1));
    assert!(places.len() > 100 && wide > 50.0 && (wide / high - 1.0).abs() < 0.01, "{wide} {high}");
}
