//! The gallery. In: `docs/gallery.md`, whose commands are run as those of the guide are. Out: its pictures in `docs/gallery`, each of
//! which is what its command draws: `gallery/NAME.svg` is the file `NAME.svg` that a command wrote, or the first drawing on the page
//! `NAME.html`, and `gallery/NAME-4.svg` the fourth, with the style of that page.
//!
//! `ABBE_WRITE_PICTURES=1` writes the pictures again; without it a picture that is out of date fails.

use std::fs;
use std::path::Path;

use super::{follow_page, links, table};
use crate::shipped::root;

/// What a drawing of a page needs to stand alone: the ground on which it is drawn.
const GROUND: &str = "svg { background: var(--paper); }\n";

/// A drawing of a page, counted from 1, as a file of its own.
fn cut_out(page: &str, nth: usize) -> String {
    let style = page.split("<style>").nth(1).unwrap().split("</style>").next().unwrap();
    let drawing = page.split("<svg").nth(nth).unwrap().split("</svg>").next().unwrap();
    let (head, body) = drawing.split_once('>').unwrap();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\"{head}>\n<style>{style}{GROUND}</style>\n{}\n</svg>\n",
        body.trim()
    )
}

fn drawn(folder: &Path, name: &str) -> String {
    if let Ok(file) = fs::read_to_string(folder.join(format!("{name}.svg"))) {
        return file;
    }
    let numbered = name.rsplit_once('-').and_then(|(page, nth)| Some((page, nth.parse().ok()?)));
    let (page, nth) = numbered.unwrap_or((name, 1));
    let text = fs::read_to_string(folder.join(format!("{page}.html")));
    cut_out(
        &text.unwrap_or_else(|_| panic!("no command of docs/gallery.md writes {name}.svg or {page}.html")),
        nth,
    )
}

#[test]
fn pictures_of_the_gallery_are_what_its_commands_draw() {
    follow_page("gallery", "docs/gallery.md");
    let folder = table().join("gallery");
    if !folder.exists() {
        // Without a shell no page is followed, and that was said.
        return;
    }
    let page = fs::read_to_string(root().join("docs/gallery.md")).unwrap();
    let targets = links::targets(&page);
    let names = targets.iter().filter_map(|target| target.strip_prefix("gallery/")?.strip_suffix(".svg"));
    let (mut stale, mut counted) = (Vec::new(), 0);
    for name in names {
        counted += 1;
        let (path, picture) = (root().join(format!("docs/gallery/{name}.svg")), drawn(&folder, name));
        if std::env::var_os("ABBE_WRITE_PICTURES").is_some_and(|value| value == "1") {
            fs::write(&path, &picture).unwrap();
        } else if fs::read_to_string(&path).unwrap_or_default() != picture {
            stale.push(name);
        }
    }
    assert!(counted > 15, "{counted} pictures were found");
    assert!(stale.is_empty(), "out of date: {stale:?}; ABBE_WRITE_PICTURES=1 draws them again");
}
