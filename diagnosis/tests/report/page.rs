//! The page: what the text says, in well-formed HTML that fetches nothing; it begins as the text begins, and its first plot is of
//! what comes back.

use abbe_diagnosis::diagnosis::{Diagnosis, NothingReturns, Returning, Summary};
use abbe_diagnosis::pictures::*;
use abbe_diagnosis::report::{self, Origin};

use crate::cases;

/// The page without its plots and marks, each run of white space as one space.
fn read(page: &str) -> String {
    let body = page.split("<body>").nth(1).unwrap();
    let mut pieces = body.split("<figure>");
    let first = pieces.next().unwrap().to_owned();
    let body = pieces.fold(first, |body, piece| body + piece.split_once("</figure>").unwrap().1);
    let text: String = body
        .split('<')
        .map(|piece| piece.split_once('>').map_or(piece, |(_, text)| text))
        .collect::<Vec<_>>()
        .join(" ");
    let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
    text.replace('\u{b1}', "+-").replace('\u{b5}', "u").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The words of the text without the rules and the numbers of lists.
fn words(text: &str) -> Vec<&str> {
    let numbered = |word: &str| word.strip_suffix('.').is_some_and(|word| word.parse::<usize>().is_ok());
    text.split_whitespace().filter(|word| !word.starts_with("---") && !numbered(word)).collect()
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

#[test]
fn the_page_begins_with_the_summary_of_the_text() {
    for (name, diagnosis) in drawn() {
        let (page, text) = (report::html(&diagnosis, &Origin::default()), report::text(&diagnosis));
        let (summary, _) = page.split_once("<section>").unwrap();
        // Everything above the first heading, which is the line above the first rule.
        let (above, _) = text.split_once("\n---").unwrap();
        let (above, _) = above.rsplit_once('\n').unwrap();
        let words = |text: &str| -> Vec<String> {
            text.split_whitespace().map(|word| word.trim_end_matches('.').to_owned()).collect()
        };
        assert_eq!(words(&read(summary)), words(above), "{name}");
    }
}

/// The numbers that the bars of a drawing have for an attribute.
fn of_bars(drawing: &str, name: &str) -> Vec<f64> {
    let bars = drawing.split('<').filter(|mark| mark.starts_with("rect class=\"m "));
    let number = |mark: &str| {
        let (_, rest) = mark.split_once(&format!(" {name}=\"")).unwrap();
        rest.split_once('"').unwrap().0.parse::<f64>().unwrap()
    };
    bars.map(number).collect()
}

#[test]
fn the_first_plot_shows_the_shares_of_the_json() {
    let diagnosis = Diagnosis { pictures: Some(pictures(0.0015)), ..cases::two_findings() };
    let page = report::html(&diagnosis, &Origin::default());
    let first = page.split("<figure>").nth(1).unwrap().split("</figure>").next().unwrap();
    let json: serde_json::Value = serde_json::from_str(&report::json(&diagnosis)).unwrap();
    let shares: Vec<f64> =
        json["returns"].as_array().unwrap().iter().map(|one| one["share"].as_f64().unwrap()).collect();
    assert_eq!(shares.len(), 2);
    let (from, wide) = (of_bars(first, "x"), of_bars(first, "width"));
    let whole = from[2] + wide[2] - from[0];
    for (bar, share) in shares.iter().enumerate() {
        let end = (from[bar] + wide[bar] - from[0]) / whole;
        assert!(
            (end - share).abs() < 1e-3 && (from[bar + 1] - from[bar] - wide[bar]).abs() < 0.03,
            "{first}"
        );
    }
    // 83 %, then 15.1 % more, which leaves 1.9 %: 1.7 um.
    for said in [
        "<title>What comes back</title>",
        "<desc>measured.y: direction of Y 83.0 %; temperature spindle 15.1 %; does not come back 1.90 %, 1.7 \u{b5}m rms.</desc>",
        ">direction of Y: 83.0 %</text>",
        ">temperature spindle: 15.1 %</text>",
        ">does not come back: 1.90 %, 1.7 \u{b5}m rms</text>",
        ">share of the residual's variance, %</text>",
    ] {
        let first = first.replace("&#39;", "'");
        assert!(first.contains(said), "{said}: {first}");
    }
}

#[test]
fn where_nothing_comes_back_a_sentence_says_why_and_nothing_is_drawn() {
    let nothing = |channel: &str, driven_twice| NothingReturns {
        recording: 0,
        channel: channel.to_owned(),
        driven_twice,
    };
    let of = |nothing_returns, undecidable: Option<&str>| {
        let undecidable = undecidable.map(str::to_owned);
        report::html(&Diagnosis { nothing_returns, undecidable, ..cases::adequate() }, &Origin::default())
    };
    let cases = [
        (
            of(vec![nothing("measured.x", true), nothing("measured.z", true)], None),
            "measured.x, measured.z: nothing comes back; no state predicts more of the residual than chance.",
        ),
        (
            of(vec![nothing("deviation", false)], None),
            "deviation: it is unknown what comes back, because nothing was driven twice.",
        ),
        (
            of(Vec::new(), Some("A clock stands still.")),
            "No search was made for it, because these recordings decide nothing.",
        ),
    ];
    for (page, sentence) in cases {
        assert!(page.contains(sentence) && !page.contains("<figure>"), "{sentence}: {page}");
    }
}

#[test]
fn with_several_recordings_a_channel_is_told_with_its_recording() {
    let mut diagnosis = cases::two_findings();
    diagnosis.recordings.push(Summary { file: "second.yaml".to_owned(), ..Summary::default() });
    diagnosis.returns.push(Returning { recording: 1, ..cases::returning("velocity of Y", 0.4, 0.002) });
    let page = report::html(&diagnosis, &Origin::default());
    assert_eq!(page.matches(">measured.y of second.yaml</text>").count(), 1);
    assert!(
        page.contains("measured.y of second.yaml: 40 % of the residual comes back with the velocity of Y")
    );
    diagnosis.returns =
        (0..20).map(|recording| Returning { recording, ..diagnosis.returns[0].clone() }).collect();
    assert!(
        report::html(&diagnosis, &Origin::default()).contains("8 more channels are described only in words")
    );
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
