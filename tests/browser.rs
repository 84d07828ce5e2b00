//! The pages as a browser lays them out. In: pages of `derive`, `diagnose`, `evaluate` and `fleet`, opened in a Chromium without a
//! window. Out: that formulas are laid out and plots drawn, that no page is wider than a telephone, and that nothing is
//! fetched and nothing complains. Where no Chromium is installed the test is skipped with a line.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::beside::skipped;
use crate::cli::abbe;
use crate::shipped::root;

/// A browser that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(90);

/// The page is this wide, in pixels: a telephone.
const WIDTH: f64 = 400.0;

/// What the browser measures, as JSON in an element of its own. The formula is one whose layout is known: it shows whether the
/// browser lays formulas out at all.
const MEASURE: &str = r#"
<math id="probe"><mfrac><mi>a</mi><mi>b</mi></mfrac></math>
<script>
const box = (element) => element.getBoundingClientRect();
const all = (selector) => [...document.querySelectorAll(selector)];
const empty = (element) => box(element).width <= 0 || box(element).height <= 0;
const name = (element) => element.tagName + '.' + (element.getAttribute('class') || '') + ' ' + (element.textContent || '').trim().slice(0, 40);
const above = (fraction) => box(fraction.children[0]).bottom <= box(fraction.children[1]).top + 1;
const below = (index) => box(index.children[1]).bottom > box(index.children[0]).bottom - 1;
const extent = (shape) => { const own = shape.getBBox(); return own.width + own.height; };
const measure = () => ({
  width: window.innerWidth,
  scroll: document.documentElement.scrollWidth,
  wider: all('main *').filter((own) => !own.closest('.wide') && !own.closest('svg') && box(own).right > window.innerWidth + 1).map(name),
  cut: all('table.recordings th, table.recordings td').filter((own) => box(own).right > window.innerWidth + 1).map(name),
  formulas: all('main math').length,
  emptyFormulas: all('main math').filter(empty).map(name),
  letters: all('main math mi').length,
  emptyLetters: all('main math mi').filter((own) => own.textContent.trim() && empty(own)).map(name),
  fractions: all('mfrac').length,
  unstacked: all('mfrac').filter((own) => !above(own)).map(name),
  raised: all('main msub').filter((own) => !below(own)).map(name),
  drawings: all('main svg').length,
  emptyDrawings: all('main svg').filter(empty).map(name),
  bare: all('main svg').filter((own) => ![...own.querySelectorAll('path, rect, circle, line, polyline')].some((shape) => extent(shape) > 20)).map(name),
  emptyTexts: all('main svg text').filter((own) => own.textContent.trim() && empty(own)).map(name),
  outside: all('main svg').flatMap((own) => [...own.querySelectorAll('text')].filter((text) => box(text).right > box(own).right + 3 || box(text).left < box(own).left - 3)).map(name),
  fetched: performance.getEntriesByType('resource').map((entry) => entry.name),
});
// When everything that the page may ask for has come or failed.
window.addEventListener('load', () => setTimeout(() => {
  parent.document.getElementById('measured').textContent = JSON.stringify(measure());
}, 0));
</script>
"#;

/// The browser's program; nothing, with a line, where none is installed.
fn chromium() -> Option<&'static str> {
    let runs = |name: &&str| {
        let run = Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        run.is_ok_and(|status| status.success())
    };
    let installed = ["chromium", "chromium-browser", "google-chrome"].into_iter().find(runs);
    if installed.is_none() {
        skipped("no Chromium is installed (on Debian: apt-get install chromium)");
    }
    installed
}

/// What a browser shows of a page, and what it complains of.
fn opened(browser: &str, folder: &Path, page: &str) -> (Value, Vec<String>) {
    let file = folder.join("page.html");
    // No window is as narrow as a telephone, but a frame is.
    let page = page.replacen("</body>", &format!("{MEASURE}</body>"), 1);
    let page = page.replace('&', "&amp;").replace('"', "&quot;");
    let frame =
        format!("<iframe srcdoc=\"{page}\" width=\"{WIDTH}\" height=\"3000\" style=\"border: 0\"></iframe>");
    fs::write(&file, format!("<!DOCTYPE html>\n<pre id=\"measured\"></pre>\n{frame}\n")).unwrap();
    let (shown, said) = (folder.join("shown.html"), folder.join("said.txt"));
    let mut child = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--host-resolver-rules=MAP * ~NOTFOUND",
            "--enable-logging=stderr",
            "--window-size=1000,3000",
        ])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .args(["--dump-dom", &format!("file://{}", file.display())])
        .stdin(Stdio::null())
        .stdout(File::create(&shown).unwrap())
        .stderr(File::create(&said).unwrap())
        .spawn()
        .unwrap();
    let began = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if began.elapsed() > PATIENCE {
            let _ = child.kill();
            let _ = child.wait();
            panic!(
                "{browser} hangs on {}: {}",
                file.display(),
                fs::read_to_string(&said).unwrap_or_default()
            );
        }
        thread::sleep(Duration::from_millis(50));
    }
    let shown = fs::read_to_string(&shown).unwrap();
    let said = String::from_utf8_lossy(&fs::read(&said).unwrap()).into_owned();
    let json = shown.split_once("<pre id=\"measured\">").and_then(|(_, rest)| rest.split_once("</pre>"));
    let (json, _) = json.unwrap_or_else(|| panic!("{browser} did not measure {}: {said}", file.display()));
    let json = json.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
    let complaints = said.lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned).collect();
    (serde_json::from_str(&json).unwrap(), complaints)
}

/// Every page with a name, and whether it must have formulas and drawings.
fn pages(folder: &Path) -> Vec<(String, String, bool, bool)> {
    let page = |name: &str, arguments: &[&str], formulas, drawings| {
        let run = abbe(arguments, "");
        assert_eq!(run.status, 0, "{name}: {}", run.err);
        (name.to_owned(), run.out, formulas, drawings)
    };
    let circle = "recordings/postech-ballbar/recording.yaml";
    let mut all: Vec<_> = ["excello-921", "nist-turning-center", "postech-mill", "XYZFAC"]
        .iter()
        .map(|machine| page(machine, &["derive", machine, "--format", "html"], true, false))
        .collect();
    all.push(page("diagnose", &["diagnose", circle, "--format", "html", "--quiet"], false, true));
    all.push(page("evaluate a circle", &["evaluate", circle, "--format", "html"], false, true));
    let stations = stations(folder);
    all.push(page("evaluate stations", &["evaluate", &stations, "--format", "html"], false, true));
    all.push(page("fleet", &["fleet", "show", &fleet(folder), "--format", "html"], false, true));
    all
}

/// A fleet of the shipped recordings with their results.
fn fleet(folder: &Path) -> String {
    let recordings = root().join("recordings");
    let file = folder.join("fleet.yaml");
    let globs =
        ["guided-mount-*/recording.yaml", "postech-ballbar/recording.yaml", "postech-ballbar/path.yaml"];
    let globs = globs.map(|glob| format!("\"{}\"", recordings.join(glob).display())).join(", ");
    let text = format!(
        "fleet: 1\nmachines:\n  a machine with a long name & <marks>: {{kind: any, recordings: [{globs}]}}\n"
    );
    fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap().to_owned();
    let run = abbe(&["fleet", "run", &file, "--quiet"], "");
    assert_eq!(run.status, 0, "{}", run.err);
    file
}

/// A recording of stations of a mill.
fn stations(folder: &Path) -> String {
    let path = "path: 1\nat: {Y: 140 mm, Z: -50 mm}\nline: {axis: X, from: 50 mm, to: 450 mm, overrun: 2 mm, stations: {count: 11, dwell: 4 s}}\nfeed: 2 m/min\nruns: 5\ninstrument: position\nnoise: 1 um\nseed: 1\n";
    let (path_file, output) = (folder.join("path.yaml"), folder.join("stations"));
    fs::write(&path_file, path).unwrap();
    let true_machine = root().join("recordings/postech-ballbar/true.yaml");
    let words = [&true_machine, &path_file, &output].map(|path| path.to_str().unwrap());
    let run = abbe(&["simulate", words[0], words[1], "--output", words[2], "--force"], "");
    assert_eq!(run.status, 0, "{}", run.err);
    output.join("recording.yaml").to_str().unwrap().to_owned()
}

#[test]
fn every_page_is_laid_out_on_a_telephone_and_asks_nobody() {
    let Some(browser) = chromium() else { return };
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("browser");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    for (name, page, formulas, drawings) in pages(&folder) {
        for part in ["<script", "src=", "url(", "@import", "<link", "<iframe"] {
            assert!(!page.contains(part), "{name} has {part}");
        }
        let (seen, complaints) = opened(browser, &folder, &page);
        assert!(complaints.is_empty(), "{name}: {complaints:#?}");
        let count = |key: &str| seen[key].as_f64().unwrap_or_else(|| panic!("{name} has no {key}: {seen}"));
        assert!((count("width") - WIDTH).abs() < 1.0, "{name}: the window is {} wide", count("width"));
        assert!(count("scroll") <= count("width"), "{name} is wider than its window: {seen:#}");
        for none in [
            "wider",
            "cut",
            "emptyFormulas",
            "emptyLetters",
            "unstacked",
            "raised",
            "emptyDrawings",
            "bare",
            "emptyTexts",
            "outside",
            "fetched",
        ] {
            assert_eq!(seen[none].as_array().map(Vec::len), Some(0), "{name}, {none}: {:#}", seen[none]);
        }
        assert!(count("fractions") >= 1.0, "the known fraction is there");
        assert!(!formulas || count("formulas") >= 3.0 && count("letters") >= 10.0, "{name}: {seen:#}");
        assert!(!drawings || count("drawings") >= 2.0, "{name}: {seen:#}");
    }
}

/// The measuring itself: a page in which everything is wrong at once.
#[test]
fn what_is_wrong_with_a_page_is_seen() {
    let Some(browser) = chromium() else { return };
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("browser-faults");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let page = "<!DOCTYPE html><html><body><main><div style=\"width: 900px\">wide</div>\
        <div class=\"wide\" style=\"overflow-x: auto\"><div style=\"width: 900px\">may be wide</div></div>\
        <math style=\"display: none\"><mi>x</mi></math>\
        <math><mfrac style=\"display: flex\"><mi>a</mi><mi>b</mi></mfrac></math>\
        <div class=\"wide\"><table class=\"recordings\"><tr><td style=\"min-width: 900px\">cut</td></tr></table></div>\
        <svg width=\"100\" height=\"50\"><text x=\"90\" y=\"20\">beyond its edge</text></svg>\
        <svg width=\"0\" height=\"0\"></svg><img src=\"http://abbe.invalid/x.png\">\
        <script>console.error('complaint')</script></main></body></html>";
    let (seen, complaints) = opened(browser, &folder, page);
    assert!(complaints.iter().any(|line| line.contains("complaint")), "{complaints:?}");
    for fault in ["cut", "emptyFormulas", "unstacked", "emptyDrawings", "bare", "outside", "fetched"] {
        assert_ne!(seen[fault].as_array().map(Vec::len), Some(0), "{fault}: {seen:#}");
    }
    let wider: Vec<&str> = seen["wider"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(wider.iter().any(|name| name.ends_with(" wide")), "{wider:?}");
    assert!(wider.iter().all(|name| !name.contains("may be")), "{wider:?}");
    assert!(seen["scroll"].as_f64() > Some(WIDTH));
}
