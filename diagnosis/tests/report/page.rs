//! The page: what the text says, in well-formed HTML that fetches nothing.

use diagnosis::report;

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
    text.replace('\u{b1}', "+-").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The words of the text without the rules and the numbers of lists.
fn words(text: &str) -> Vec<&str> {
    let numbered = |word: &str| word.strip_suffix('.').is_some_and(|word| word.parse::<usize>().is_ok());
    text.split_whitespace().filter(|word| !word.starts_with("---") && !numbered(word)).collect()
}

#[test]
fn the_page_says_what_the_text_says() {
    for (name, diagnosis) in cases::all() {
        let (page, text) = (read(&report::html(&diagnosis)), report::text(&diagnosis));
        let page: Vec<&str> = page.split_whitespace().map(|word| word.trim_end_matches('.')).collect();
        let text: Vec<&str> = words(&text).into_iter().map(|word| word.trim_end_matches('.')).collect();
        assert_eq!(page, text, "{name}");
    }
}

#[test]
fn every_mark_is_closed_in_order() {
    for (name, diagnosis) in cases::all() {
        let page = report::html(&diagnosis);
        let mut open: Vec<String> = Vec::new();
        for mark in page.split('<').skip(1).map(|piece| piece.split_once('>').unwrap().0) {
            match (mark.strip_prefix('/'), mark.split_whitespace().next().unwrap()) {
                (Some(closed), _) => assert_eq!(open.pop().as_deref(), Some(closed), "{name}"),
                (None, "!DOCTYPE" | "meta") => {}
                (None, opened) => open.push(opened.to_owned()),
            }
        }
        assert!(open.is_empty(), "{name}: {open:?}");
    }
}

#[test]
fn it_fetches_and_runs_nothing() {
    let page = report::html(&cases::two_findings());
    for part in ["<script", "http", "src=", "href=", "url(", "@import"] {
        assert!(!page.contains(part), "{part}");
    }
}

#[test]
fn a_name_is_text_and_no_mark() {
    let mut diagnosis = cases::two_findings();
    diagnosis.recordings[0].file = "<b onclick=\"x\">&.yaml".to_owned();
    let page = report::html(&diagnosis);
    assert!(page.contains("&lt;b onclick=&quot;x&quot;&gt;&amp;.yaml"));
    assert!(!page.contains("<b "));
}
