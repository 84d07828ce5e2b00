//! Plots of a diagnosis. In: what comes back, and its pictures. Out: the first plot of the page, of what comes back; sections of
//! the page: what each finding does, then what each recording shows; every plot with a caption that tells what is to be seen in it.

mod circle;
mod over;
mod position;
mod returns;
mod sizes;
mod spectrum;

use pages::plot::{Axis, Draw, Look, Plot, Series, Tone, thin};
use pages::text::printed;

use crate::diagnosis::Diagnosis;
use crate::pictures::{ChannelPicture, Picture, Pictures};

/// A plot with its caption.
pub(super) struct Figure {
    plot: Box<dyn Plot>,
    caption: String,
}

impl Figure {
    pub(super) fn new(plot: impl Plot + 'static, caption: impl Into<String>) -> Self {
        Self { plot: Box::new(plot), caption: caption.into() }
    }

    fn html(&self) -> String {
        let caption = match self.caption.as_str() {
            "" => String::new(),
            caption => format!("<figcaption>{}</figcaption>\n", printed(caption)),
        };
        format!("<figure>\n{}{caption}</figure>\n", self.plot.draw().inline())
    }
}

/// What comes back; nothing where nothing does.
pub(super) fn returns(diagnosis: &Diagnosis) -> String {
    grid(&returns::figures(diagnosis))
}

/// All other plots; nothing where there are no pictures.
pub(super) fn sections(diagnosis: &Diagnosis) -> String {
    let Some(pictures) = &diagnosis.pictures else { return String::new() };
    let mut captions = Captions::default();
    let heading = if diagnosis.findings.is_empty() {
        "Residuals"
    } else {
        "The size of each finding, and the residuals"
    };
    let mut all = section(heading, &sizes::figures(diagnosis, pictures));
    for picture in &pictures.recordings {
        all += &recording(diagnosis, pictures, picture, &mut captions);
    }
    let more = diagnosis.recordings.len().saturating_sub(pictures.recordings.len());
    if more > 0 {
        all += &format!(
            "<p class=\"none\">{more} more recordings contribute to the findings and are not drawn.</p>\n"
        );
    }
    all
}

fn recording(
    diagnosis: &Diagnosis,
    pictures: &Pictures,
    picture: &Picture,
    captions: &mut Captions,
) -> String {
    let name = diagnosis.file_of(picture.recording).unwrap_or_default();
    let heading = match pictures.recordings.len() {
        1 => "What the recording shows".to_owned(),
        _ => format!("What {name} shows"),
    };
    let mut body = grid(&circle::figures(picture, captions));
    for channel in ordered(diagnosis, picture) {
        let title = if channel.name == "deviation" {
            format!("deviation: {}", channel.title)
        } else {
            format!("{}: {}", channel.name.split(',').next().unwrap_or_default(), channel.title)
        };
        body += &format!(
            "<h3>{}</h3>\n<p class=\"source\">{}</p>\n",
            printed(&title),
            printed(&shown(diagnosis, channel))
        );
        let mut figures = position::figures(diagnosis, channel, captions);
        if aside(diagnosis, pictures, channel) {
            figures.push(over::time(channel, captions));
        } else {
            figures.extend(over::figures(channel, captions));
            figures.extend(spectrum::figures(diagnosis, channel, captions));
        }
        body += &grid(&figures);
    }
    if picture.of > picture.channels.len() {
        let more = picture.of - picture.channels.len();
        body += &format!(
            "<p class=\"none\">{more} more channels contribute to the findings and are not drawn.</p>\n"
        );
    }
    format!("<section>\n<h2>{}</h2>\n{body}</section>\n", printed(&heading))
}

/// The channels: first the one in which something unexplained shows, then those that the findings change.
fn ordered<'p>(diagnosis: &Diagnosis, picture: &'p Picture) -> Vec<&'p ChannelPicture> {
    let mut channels: Vec<&ChannelPicture> = picture.channels.iter().collect();
    channels.sort_by_key(|channel| (!holds_unexplained(diagnosis, channel), channel.unchanged));
    channels
}

fn holds_unexplained(diagnosis: &Diagnosis, channel: &ChannelPicture) -> bool {
    diagnosis.unexplained.as_ref().is_some_and(|unexplained| unexplained.direction == channel.name)
}

/// Whether a channel has nothing to do with what was found, so that few plots of it are enough.
fn aside(diagnosis: &Diagnosis, pictures: &Pictures, channel: &ChannelPicture) -> bool {
    let elsewhere = diagnosis.unexplained.is_some() || !pictures.unchanged();
    channel.unchanged && elsewhere && !holds_unexplained(diagnosis, channel)
}

/// How many samples are drawn, and what hollow marks are.
fn shown(diagnosis: &Diagnosis, channel: &ChannelPicture) -> String {
    let drawn = channel.shown.outlier.iter().filter(|outlier| !**outlier).count();
    let mut sentences = vec![match thin::told(drawn, channel.samples) {
        Some(told) => {
            format!("{told}, evenly spread over time, with the extremes.")
        }
        None => format!("All {} samples are shown.", channel.samples),
    }];
    if channel.shown.held_out.iter().any(|held_out| *held_out) {
        sentences.push("Hollow marks: held out, not fitted.".to_owned());
    }
    if channel.unchanged && !diagnosis.findings.is_empty() {
        sentences.push("The findings change nothing here.".to_owned());
    }
    if !channel.unchanged && diagnosis.repeatability.is_some() {
        sentences.push("After: every run has its own zero, because runs do not repeat.".to_owned());
    }
    if channel.outliers > 0 {
        sentences.push(format!("Outliers left out: {}.", channel.outliers));
    }
    sentences.join(" ")
}

fn section(heading: &str, figures: &[Figure]) -> String {
    if figures.is_empty() {
        return String::new();
    }
    format!("<section>\n<h2>{}</h2>\n{}</section>\n", printed(heading), grid(figures))
}

fn grid(figures: &[Figure]) -> String {
    if figures.is_empty() {
        return String::new();
    }
    format!("<div class=\"plots\">\n{}</div>\n", figures.iter().map(Figure::html).collect::<String>())
}

/// Captions that explain: each stands once on a page.
#[derive(Default)]
pub(super) struct Captions(Vec<&'static str>);

impl Captions {
    /// The caption, the first time.
    fn once(&mut self, caption: &'static str) -> &'static str {
        if self.0.contains(&caption) {
            return "";
        }
        self.0.push(caption);
        caption
    }
}

/// What is left, before or after.
pub(super) struct Side {
    pub(super) name: &'static str,
    pub(super) look: Look,
    pub(super) after: bool,
}

impl Side {
    fn of<'v, T>(&self, before: &'v [T], after: &'v [T]) -> &'v [T] {
        if self.after { after } else { before }
    }
}

/// What is drawn of a channel: what is left before and after; once where the findings change nothing that could be seen.
pub(super) fn sides(channel: &ChannelPicture) -> Vec<Side> {
    if channel.unchanged {
        return vec![Side { name: LEFT, look: Look::of(0), after: true }];
    }
    let before = Side { name: "before", look: Look::of(0), after: false };
    vec![before, Side { name: "after", look: Look::of(1), after: true }]
}

/// The name of what is left.
pub(super) const LEFT: &str = "residual";

/// The axis of what is left; where a few samples lie much farther out than all others, it ends before them.
pub(super) fn residual(channel: &ChannelPicture, reach: f64) -> Axis {
    Axis::new(LEFT, channel.unit).within(-reach, reach)
}

/// Points of one kind as two series: filled where fitted and hollow where held out. One of them has the name.
pub(super) fn marked(
    name: &str,
    look: Look,
    points: impl Iterator<Item = ((f64, f64), bool)>,
) -> Vec<Series> {
    let (held_out, fitted): (Vec<_>, Vec<_>) = points.partition(|(_, held_out)| *held_out);
    let points = |of: Vec<((f64, f64), bool)>| of.into_iter().map(|(point, _)| point).collect::<Vec<_>>();
    let (held_out, fitted) = (points(held_out), points(fitted));
    let mut series = Vec::new();
    let hollow = if fitted.is_empty() { name } else { "" };
    if !fitted.is_empty() {
        series.push(Series::new(name, look, Draw::Marks, fitted));
    }
    if !held_out.is_empty() {
        series.push(Series::new(hollow, look, Draw::Hollow, held_out));
    }
    series
}

/// The look of outliers.
pub(super) fn outlying() -> Look {
    Look::of(5).toned(Tone::Ink)
}
