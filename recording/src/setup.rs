//! How the instrument was set up.
//!
//! In: the mapping `setup`, the machine's equations and the channels. Out: an [`Instrument`] in mm and unit vectors of the
//! part's frame. What is evident is derived: a linear instrument reads along its axis, a rotary axis turns about itself.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::fields::Fields;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::{Span, Spanned};
use model_dsl::yaml::Node;

use super::channel::{ChannelKind, Channels, insensitive, no_axis};
use super::direction::{dot, own_direction, read_direction};
use super::words::{FORM, keys, word};
use super::{Instrument, Line, PartDatum};

/// The instruments by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Position,
    Ballbar,
    Linear,
    Straightness,
    Angular,
    Probe,
}

impl Kind {
    /// All of them.
    pub(super) const ALL: [Self; 6] =
        [Self::Position, Self::Ballbar, Self::Linear, Self::Straightness, Self::Angular, Self::Probe];

    /// The name in recording files.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Ballbar => "ballbar",
            Self::Linear => "linear",
            Self::Straightness => "straightness",
            Self::Angular => "angular",
            Self::Probe => "probe",
        }
    }

    /// The keys of its set-up.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Position => &["datum"],
            Self::Ballbar => &["center", "radius"],
            Self::Linear | Self::Straightness | Self::Angular => &["axis", "direction"],
            Self::Probe => &["axis", "direction", "datum"],
        }
    }
}

/// The keys of all set-ups.
const KEYS: [&str; 5] = ["center", "radius", "axis", "direction", "datum"];

/// The sine of 5 degrees: how far a direction may be off the one that it must have.
const OBLIQUE: f64 = 0.087;

/// An instrument as it was set up.
pub(super) struct Setup {
    /// The instrument.
    pub(super) instrument: Instrument,
    /// The direction of all readings of a probe, where no channels give it.
    pub(super) normal: Option<[f64; 3]>,
    /// What is said of how the part lies where it was measured.
    pub(super) datum: PartDatum,
}

/// What the set-up of each instrument is read from.
struct Context<'c> {
    instrument: Spanned<Kind>,
    fields: Option<Fields<'c>>,
    /// Where a missing key is reported.
    place: Span,
    equations: &'c Equations,
    channels: &'c Channels,
}

/// Reads the set-up of an instrument; every finding is reported.
pub(super) fn read_setup(
    recording: &Fields<'_>,
    instrument: Spanned<Kind>,
    equations: &Equations,
    channels: &Channels,
    diagnostics: &mut Diagnostics,
) -> Option<Setup> {
    let entry = recording.entry("setup");
    let fields = match entry {
        Some((key, node)) => Some(Fields::open(node, key.span, keys("`setup`"), &KEYS, diagnostics)?),
        None => None,
    };
    let place = entry.map_or(instrument.span, |(key, _)| key.span);
    let context = Context { instrument, fields, place, equations, channels };
    context.refuse_foreign(entry.map(|(_, node)| node), diagnostics);
    let datum = context.datum(diagnostics)?;
    let plain = |instrument| Some(Setup { instrument, normal: None, datum });
    match instrument.value {
        Kind::Position => plain(Instrument::Position),
        Kind::Ballbar => plain(context.ballbar(diagnostics)?),
        Kind::Linear => plain(Instrument::Linear(context.linear(diagnostics)?)),
        Kind::Straightness => plain(Instrument::Straightness(context.straightness(diagnostics)?)),
        Kind::Angular => plain(context.angular(diagnostics)?),
        Kind::Probe => context.probe(datum, diagnostics),
    }
}

impl<'c> Context<'c> {
    /// Reports keys that belong to other instruments (E0616).
    fn refuse_foreign(&self, setup: Option<&Node>, diagnostics: &mut Diagnostics) {
        let own = self.instrument.value.keys();
        let entries = setup.and_then(Node::entries).unwrap_or(&[]).iter();
        let foreign = entries
            .map(|(key, _)| key)
            .filter(|key| KEYS.contains(&key.value.as_str()) && !own.contains(&key.value.as_str()));
        for key in foreign {
            let name = self.instrument.value.name();
            let message = format!("the set-up of the instrument `{name}` has no `{}`", key.value);
            let help = match own {
                ["datum"] => "leave it out; the only key of its set-up is `datum`".to_owned(),
                _ => format!("the keys of its set-up are {}", quoted(own)),
            };
            diagnostics.push(Diagnostic::error("E0616", key.span, message).help(help));
        }
    }

    fn get(&self, key: &str) -> Option<&'c Node> {
        self.fields.and_then(|fields| fields.get(key))
    }

    /// Reports that a key is missing (E0615).
    fn missing(&self, key: &str, help: &str, diagnostics: &mut Diagnostics) {
        let message = format!("the instrument `{}` needs `{key}` in `setup`", self.instrument.value.name());
        diagnostics.push(Diagnostic::error("E0615", self.place, message).help(help));
    }

    /// How the part lies (`datum: free` or `fixed`); nothing at all after a finding.
    fn datum(&self, diagnostics: &mut Diagnostics) -> Option<PartDatum> {
        let own = self.instrument.value.keys().contains(&"datum");
        let Some(node) = self.get("datum").filter(|_| own) else { return Some(PartDatum::Unsaid) };
        let written = word(node, "`datum`", diagnostics)?;
        let datum = match written.value.as_str() {
            "free" => PartDatum::Free,
            "fixed" => PartDatum::Fixed,
            other => {
                let message = format!("`datum` must be `free` or `fixed`, found `{other}`");
                let help = "write `datum: free` if the part was clamped anew, or `datum: fixed` if it stayed clamped as it was made";
                diagnostics.push(Diagnostic::error(FORM, written.span, message).help(help));
                return None;
            }
        };
        let places = |channel: &ChannelKind| matches!(channel, ChannelKind::Measured(_));
        let seen = self.instrument.value == Kind::Probe
            || self.channels.known.iter().any(|channel| places(&channel.kind));
        if !seen {
            let message = "`datum` is for a part, but no channel measures one";
            let mistake = Diagnostic::error("E0618", written.span, message);
            diagnostics
                .push(mistake.help("add the channel `measured.x`, `.y` or `.z`, or leave `datum` out"));
            return None;
        }
        Some(datum)
    }

    fn ballbar(&self, diagnostics: &mut Diagnostics) -> Option<Instrument> {
        let center = match self.get("center") {
            Some(node) => read_center(node, diagnostics),
            None => {
                let help = "add `center: [275 mm, 140 mm, -50 mm]`, the fixed ball in the part's frame";
                self.missing("center", help, diagnostics);
                None
            }
        };
        let radius = match self.get("radius") {
            Some(node) => read_radius(node, diagnostics),
            None => {
                self.missing("radius", "add `radius: 150 mm`, the nominal length of the bar", diagnostics);
                None
            }
        };
        Some(Instrument::Ballbar { center: center?, radius: radius? })
    }

    fn linear(&self, diagnostics: &mut Diagnostics) -> Option<Line> {
        let axis = self.axis(diagnostics)?;
        self.slides_only(axis.as_ref(), diagnostics)?;
        let axis = axis.map(|axis| axis.value);
        let Some(direction) = self.direction(diagnostics)? else {
            let axis = axis.or_else(|| self.only_commanded(false));
            let own = axis.and_then(|axis| own_direction(self.equations, axis));
            if own.is_none() {
                let help = "add `axis: X`, the axis that moves, or `direction: [1, 1, 0]` along a diagonal";
                self.missing("axis", help, diagnostics);
            }
            return own.map(|direction| Line { axis, direction });
        };
        let along = |axis: usize| {
            own_direction(self.equations, axis)
                .is_some_and(|own| dot(own, direction.value).abs() > (1.0 - OBLIQUE * OBLIQUE).sqrt())
        };
        if let Some(axis) = axis.filter(|axis| !along(*axis)) {
            let letter = self.letter(axis);
            let message = format!("a linear instrument on axis {letter} must read along {letter}");
            let help = "leave `direction` out, leave `axis` out for a diagonal, or use the instrument `straightness`";
            diagnostics.push(Diagnostic::error("E0618", direction.span, message).help(help));
            return None;
        }
        let axis = axis.or_else(|| only(self.axes(false).filter(|axis| along(*axis))));
        self.seen(direction, diagnostics)?;
        Some(Line { axis, direction: direction.value })
    }

    fn straightness(&self, diagnostics: &mut Diagnostics) -> Option<Line> {
        let axis = self.axis(diagnostics)?;
        self.slides_only(axis.as_ref(), diagnostics)?;
        let axis = axis.map(|axis| axis.value).or_else(|| self.only_commanded(false));
        let Some(direction) = self.direction(diagnostics)? else {
            self.missing("direction", "add `direction: Y`, across the axis that moves", diagnostics);
            return None;
        };
        let own = axis.and_then(|axis| own_direction(self.equations, axis));
        if let (Some(axis), Some(own)) = (axis, own)
            && dot(own, direction.value).abs() > OBLIQUE
        {
            let letter = self.letter(axis);
            let message = format!("the straightness of axis {letter} must be read across {letter}");
            let help =
                format!("give a direction at right angles to {letter}, or use the instrument `linear`");
            diagnostics.push(Diagnostic::error("E0618", direction.span, message).help(help));
            return None;
        }
        self.seen(direction, diagnostics)?;
        Some(Line { axis, direction: direction.value })
    }

    fn angular(&self, diagnostics: &mut Diagnostics) -> Option<Instrument> {
        let axis = self.axis(diagnostics)?.map(|axis| axis.value);
        if let Some(direction) = self.direction(diagnostics)? {
            return Some(Instrument::Angular { axis, about: direction.value });
        }
        let axis = axis.or_else(|| self.only_commanded(true));
        let turns = axis.filter(|axis| self.equations.axes.get(*axis).is_some_and(|axis| axis.rotary));
        match turns.and_then(|axis| own_direction(self.equations, axis)) {
            Some(about) => Some(Instrument::Angular { axis, about }),
            None => {
                let help = "add the axis of rotation, such as `direction: B`: A, B or C for X, Y or Z";
                self.missing("direction", help, diagnostics);
                None
            }
        }
    }

    /// A probe's direction: from channels or from the set-up, and not from both.
    fn probe(&self, datum: PartDatum, diagnostics: &mut Diagnostics) -> Option<Setup> {
        self.axis(diagnostics)?;
        let direction = self.direction(diagnostics)?;
        let normals =
            self.channels.known.iter().filter(|channel| matches!(channel.kind, ChannelKind::Normal(_)));
        let first = normals.into_iter().next();
        // What is there wrongly is not missing.
        let named = |name: &str| self.channels.names.iter().any(|known| known == name);
        let setup = |normal| Some(Setup { instrument: Instrument::Probe, normal, datum });
        match (direction, first) {
            (Some(direction), Some(normal)) => {
                let message = "a probe has both a `direction` and channels such as `normal.x`";
                let mistake = Diagnostic::error("E0618", direction.span, message);
                let mistake = mistake.also(normal.name.span, "a normal for each row here");
                diagnostics.push(mistake.help("leave one of them out"));
                None
            }
            (Some(direction), None) => {
                self.seen(direction, diagnostics)?;
                setup(Some(direction.value))
            }
            (None, None) if self.channels.names.iter().any(|name| name.starts_with("normal.")) => None,
            (None, None) => {
                let message = "a probe needs the normals of the surface";
                let mistake = Diagnostic::error("E0614", self.instrument.span, message);
                let help = "add the channels `normal.x`, `normal.y` and `normal.z`, or `setup: {direction: Z}` if all normals are the same";
                diagnostics.push(mistake.help(help));
                None
            }
            (None, Some(first)) => {
                let rows = self.equations.rows.iter();
                let normals =
                    rows.map(|row| format!("normal.{}", row.direction.letter().to_ascii_lowercase()));
                let lacking = normals.filter(|name| !named(name)).map(|name| format!("`{name}`"));
                let lacking: Vec<String> = lacking.collect();
                if lacking.is_empty() {
                    return setup(None);
                }
                let message = format!("the normals lack {}", lacking.join(" and "));
                let mistake = Diagnostic::error("E0614", first.name.span, message);
                diagnostics.push(mistake.help("a normal needs a component in each sensitive direction"));
                None
            }
        }
    }

    /// The axis that the set-up names; nothing at all after a finding.
    fn axis(&self, diagnostics: &mut Diagnostics) -> Option<Option<Spanned<usize>>> {
        let Some(node) = self.get("axis") else { return Some(None) };
        let letter = word(node, "`axis`", diagnostics)?;
        let found = self.equations.axes.iter().position(|axis| axis.letter == letter.value);
        if found.is_none() {
            diagnostics.push(no_axis(letter.span, &letter.value, true, self.equations));
        }
        Some(Some(Spanned::new(found?, letter.span)))
    }

    /// The direction that the set-up gives; nothing at all after a finding.
    fn direction(&self, diagnostics: &mut Diagnostics) -> Option<Option<Spanned<[f64; 3]>>> {
        let Some(node) = self.get("direction") else { return Some(None) };
        read_direction(node, self.instrument.value == Kind::Angular, diagnostics).map(Some)
    }

    fn slides_only(&self, axis: Option<&Spanned<usize>>, diagnostics: &mut Diagnostics) -> Option<()> {
        let rotary = axis.filter(|axis| self.equations.axes.get(axis.value).is_some_and(|axis| axis.rotary));
        let Some(axis) = rotary else { return Some(()) };
        let name = self.instrument.value.name();
        let message = format!(
            "the instrument `{name}` is for a slide, but {} is a rotary axis",
            self.letter(axis.value)
        );
        let help = "use `angular` for its rotation, or `probe` for a displacement while it rotates";
        diagnostics.push(Diagnostic::error("E0618", axis.span, message).help(help));
        None
    }

    /// Reports a direction of which the machine's equations do not tell the whole (E0608).
    fn seen(&self, direction: Spanned<[f64; 3]>, diagnostics: &mut Diagnostics) -> Option<()> {
        let sensitive = |index: usize| self.equations.rows.iter().any(|row| row.direction.index() == index);
        let mut components = ["X", "Y", "Z"].into_iter().zip(direction.value).enumerate();
        let unseen = components.find(|(index, (_, size))| size.abs() > 1e-9 && !sensitive(*index));
        let Some((_, (letter, _))) = unseen else { return Some(()) };
        diagnostics.push(insensitive(direction.span, letter, self.equations));
        None
    }

    /// The one axis that has a command, among the slides or among all.
    fn only_commanded(&self, rotary_too: bool) -> Option<usize> {
        let commanded = |axis: &usize| {
            self.channels.known.iter().any(|channel| channel.kind == ChannelKind::Command(*axis))
        };
        only(self.axes(rotary_too).filter(commanded))
    }

    fn axes(&self, rotary_too: bool) -> impl Iterator<Item = usize> {
        let axes = self.equations.axes.iter().enumerate();
        axes.filter(move |(_, axis)| (rotary_too || !axis.rotary) && !axis.is_motor())
            .map(|(number, _)| number)
    }

    fn letter(&self, axis: usize) -> &str {
        self.equations.axes.get(axis).map_or("", |axis| axis.letter.as_str())
    }
}

/// The only item; nothing where there are more, or none.
fn only<T>(mut items: impl Iterator<Item = T>) -> Option<T> {
    let first = items.next();
    first.filter(|_| items.next().is_none())
}

fn read_center(node: &Node, diagnostics: &mut Diagnostics) -> Option<[f64; 3]> {
    let items = node.items().unwrap_or(&[]);
    let [x, y, z] = items else {
        let found = match node.items() {
            Some(items) => format!("a list of {}", items.len()),
            None => node.kind_name().to_owned(),
        };
        let message = format!("`center` must be a point with three coordinates, found {found}");
        let help =
            "write all three, such as `[275 mm, 140 mm, -50 mm]`, even if a direction is not sensitive";
        diagnostics.push(Diagnostic::error(FORM, node.span, message).help(help));
        return None;
    };
    let mut read = |node, what| quantity::read(node, Dimension::LENGTH, what, diagnostics);
    let (x, y, z) = (read(x, "the centre's X"), read(y, "the centre's Y"), read(z, "the centre's Z"));
    Some([x?.value, y?.value, z?.value])
}

fn read_radius(node: &Node, diagnostics: &mut Diagnostics) -> Option<f64> {
    let radius = quantity::read(node, Dimension::LENGTH, "`radius`", diagnostics)?;
    if radius.value > 0.0 {
        return Some(radius.value);
    }
    let mistake = Diagnostic::error("E0621", radius.span, "`radius` must be greater than zero");
    diagnostics.push(mistake.help("write the nominal length of the bar, such as `150 mm`"));
    None
}

/// Keys as words of a sentence.
fn quoted(keys: &[&str]) -> String {
    let words: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
    words.join(" and ")
}
