//! The page: what the text says, in well-formed HTML that fetches nothing.

use diagnosis::diagnosis::Diagnosis;
use diagnosis::pictures::*;
use diagnosis::report::{self, Origin};

use crate::cases;

/// The page without its marks, each run of white space as one space.
fn read(page: &str) -> String {
    let body = page.split("<body>").nth(1).unwrap();
    let text: String = body
        .split('<')
        .map(|piece| piece.split_once('>').map_or(piece, |(_, text)| text))
        .collect::<Vec<_>>()
        .join(" ");
    let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
    text.replace('\u{b1}', "+-").replace('\u{b5}', "u").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The words of the text without the rules, the numbers of lists and the table that says again what stands below it.
fn words(text: &str) -> Vec<&str> {
    let table = |part: &&str| part.starts_with("motion ");
    let numbered = |word: &str| word.strip_suffix('.').is_some_and(|word| word.parse::<usize>().is_ok());
    let words = text.split("\n\n").filter(|part| !table(part)).flat_map(str::split_whitespace);
    words.filter(|word| !word.starts_with("---") && !numbered(word)).collect()
}

#[test]
fn the_page_says_what_the_text_says() {
    for (name, diagnosis) in cases::all() {
        let (page, text) = (read(&report::html(&diagnosis, &Origin::default())), report::text(&diagnosis));
        let page: Vec<&str> = page.split_whitespace().map(|word| word.trim_end_matches('.')).collect();
        let text: Vec<&str> = words(&text).into_iter().map(|word| word.trim_end_matches('.')).collect();
        assert_eq!(page, text, "{name}");
    }
}

/// Pictures with all that can be drawn: numbers as they are, and numbers that no page may show.
fn pictures(of: f64) -> Pictures {
    let column = || vec![0.001, of, -0.002, 0.0];
    let line = || Spectrum {
        before: vec![(1.0, 0.001), (2.0, of)],
        after: vec![(of, 0.0)],
        found: vec![(of, "cyclic of <E>".to_owned())],
    };
    let track = || Track { name: "body <1>".to_owned(), unit: "degC".to_owned(), values: column() };
    let axis = AxisTrack {
        letter: "X".to_owned(),
        unit: "mm",
        position: column(),
        direction: vec![1.0, -1.0, of, 1.0],
        velocity: column(),
    };
    let shown = Samples {
        time: column(),
        run: vec![1, 1, 2, 2],
        before: column(),
        after: column(),
        held_out: vec![false, true, false, true],
        outlier: vec![false, false, false, true],
        axes: vec![axis],
        temperatures: vec![track()],
        loads: vec![track()],
    };
    let run = |run| RunMean { run, mean: (0.001, of), rms: (of, of), held_out: run == 2 };
    let channel = ChannelPicture {
        name: "measured.x".to_owned(),
        title: "tool tip in X".to_owned(),
        unit: "mm",
        counts: true,
        samples: 4000,
        outliers: 1,
        rms: (of, of),
        unchanged: false,
        reach: (of, 0.01),
        shown,
        runs: vec![run(1), run(2), run(i64::MAX)],
        over_time: Some(line()),
        over_position: vec![PositionSpectrum { axis: "X".to_owned(), unit: "mm", spectrum: line() }],
    };
    let pass = Pass {
        run: 1,
        against_the_clock: true,
        held_out: true,
        points: vec![[0.0, 0.001, of, 0.0], [of; 4]],
    };
    let circle =
        Circle { radius: of, directions: ["+X".to_owned(), "+Y".to_owned()], passes: vec![pass], of: 200 };
    Pictures {
        recordings: vec![Picture { recording: 0, channels: vec![channel], of: 3, circle: Some(circle) }],
        contributions: vec![Contribution { rms: of, max: 0.003 }; 2],
        distributions: vec![Distribution {
            after: true,
            held_out: false,
            edges: vec![-1.0, of, 1.0],
            counts: vec![1, 0],
            beyond: 7,
        }],
    }
}

/// Every case without plots, and with plots of sound and of hostile numbers.
fn drawn() -> Vec<(String, Diagnosis)> {
    let mut all = Vec::new();
    for (name, diagnosis) in cases::all() {
        for of in [0.0015, f64::NAN, f64::INFINITY, -1e308, 5e-324] {
            all.push((
                format!("{name}, {of:e}"),
                Diagnosis { pictures: Some(pictures(of)), ..diagnosis.clone() },
            ));
        }
        all.push((name.to_owned(), diagnosis));
    }
    all
}

#[test]
fn no_number_that_is_none_reaches_the_page() {
    for (name, diagnosis) in drawn() {
        let page = report::html(&diagnosis, &Origin::default());
        for wrong in ["NaN", "inf ", "inf\"", ">inf", "<script", "http", "src=", "<E>", "<1>"] {
            assert!(!page.contains(wrong), "{name}: {wrong}");
        }
    }
}

#[test]
fn plots_stand_between_what_was_found_and_what_is_open() {
    let diagnosis = Diagnosis { pictures: Some(pictures(0.0015)), ..cases::two_findings() };
    let origin =
        Origin { command: "abbe diagnose a&b.yaml", program: "abbe 9", change: "--- known\n+  - <x>\n" };
    let page = report::html(&diagnosis, &origin);
    let places: Vec<usize> = [
        "What was left out",
        "Contributions",
        "What the recording shows",
        "<h2>Recordings",
        "+  - &lt;x&gt;",
        "abbe diagnose a&amp;b.yaml",
    ]
    .map(|part| page.find(part).unwrap_or_else(|| panic!("{part}")))
    .to_vec();
    assert!(places.is_sorted(), "{places:?}");
    for said in [
        "one of 200 passes",
        "2 more channels",
        "Hollow marks: held out",
        "Outliers left out: 1",
        "beyond the axis: 7 after",
        "4000 samples shown",
    ] {
        assert!(page.contains(said), "{said}");
    }
}

#[test]
fn every_mark_is_closed_in_order() {
    for (name, diagnosis) in drawn() {
        let page = report::html(&diagnosis, &Origin::default());
        let mut open: Vec<String> = Vec::new();
        for mark in page.split('<').skip(1).map(|piece| piece.split_once('>').unwrap().0) {
            match (mark.strip_prefix('/'), mark.split_whitespace().next().unwrap()) {
                (Some(closed), _) => assert_eq!(open.pop().as_deref(), Some(closed), "{name}"),
                (None, "!DOCTYPE" | "meta") => {}
                _ if mark.ends_with('/') => {}
                (None, opened) => open.push(opened.to_owned()),
            }
        }
        assert!(open.is_empty(), "{name}: {open:?}");
    }
}

#[test]
fn it_fetches_and_runs_nothing() {
    let page = report::html(&cases::two_findings(), &Origin::default());
    for part in ["<script", "http", "src=", "href=", "url(", "@import"] {
        assert!(!page.contains(part), "{part}");
    }
}

#[test]
fn a_name_is_text_and_no_mark() {
    let mut diagnosis = cases::two_findings();
    diagnosis.recordings[0].file = "<b onclick=\"x\">&.yaml".to_owned();
    let page = report::html(&diagnosis, &Origin::default());
    assert!(page.contains("&lt;b onclick=&quot;x&quot;&gt;&amp;.yaml"));
    assert!(!page.contains("<b "));
}
