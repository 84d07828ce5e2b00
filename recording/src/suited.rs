//! Whether the channels suit the instrument: what it takes, and that it measures anything.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::{Span, Spanned};

use super::channel::{ChannelKind, Channels};
use super::setup::Kind;

/// Reports channels that the instrument does not take (E0612) and the lack of one that measures (E0613).
pub(super) fn check_suited(
    instrument: Spanned<Kind>,
    key: Span,
    channels: &Channels,
    diagnostics: &mut Diagnostics,
) {
    let foreign = channels.known.iter().filter(|channel| !takes(instrument.value, &channel.kind));
    let foreign: Vec<_> = foreign.collect();
    for channel in &foreign {
        let message = format!(
            "`{}` is not a channel of the instrument `{}`",
            channel.name.value,
            instrument.value.name()
        );
        let mistake = Diagnostic::error("E0612", channel.name.span, message);
        let mistake = mistake.also(instrument.span, "the instrument");
        diagnostics.push(mistake.help(help_for_foreign(&channel.kind)));
    }
    // A channel with a mistake of its own may be the one that measures.
    let all_understood = channels.known.len() == channels.names.len();
    let measures = channels.known.iter().any(|channel| measures(instrument.value, &channel.kind));
    if all_understood && foreign.is_empty() && !measures {
        diagnostics.push(nothing_measured(instrument.value, key));
    }
}

fn takes(instrument: Kind, channel: &ChannelKind) -> bool {
    match channel {
        ChannelKind::Deviation => instrument != Kind::Position,
        ChannelKind::Measured(_) | ChannelKind::MeasuredAngle(_) => instrument == Kind::Position,
        ChannelKind::Normal(_) => instrument == Kind::Probe,
        _ => true,
    }
}

fn measures(instrument: Kind, channel: &ChannelKind) -> bool {
    match channel {
        ChannelKind::Deviation => true,
        ChannelKind::Measured(_) | ChannelKind::MeasuredAngle(_) | ChannelKind::Actual(_) => {
            instrument == Kind::Position
        }
        _ => false,
    }
}

fn help_for_foreign(channel: &ChannelKind) -> &'static str {
    match channel {
        ChannelKind::Deviation => {
            "use `deviation` with ballbar, linear, straightness, angular and probe, and `measured.x` with `position`"
        }
        ChannelKind::Normal(_) => "use normals only with `probe`; list unused columns under `extra`",
        _ => "use `deviation` for the reading of this instrument; list unused columns under `extra`",
    }
}

fn nothing_measured(instrument: Kind, key: Span) -> Diagnostic {
    match instrument {
        Kind::Position => Diagnostic::error("E0613", key, "no channel measures anything")
            .help("add a channel such as `measured.x`, or the drive's own `actual.x`"),
        other => {
            let message = format!("the instrument `{}` needs the channel `deviation`", other.name());
            let unit = if other == Kind::Angular { "urad" } else { "mm" };
            let help = format!("add `deviation: {{column: ..., unit: {unit}}}`, its reading");
            Diagnostic::error("E0613", key, message).help(help)
        }
    }
}
