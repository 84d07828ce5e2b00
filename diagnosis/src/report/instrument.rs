//! Settings of the instruments in words. In: those that the data demand. Out: an item each.

use super::finding::alternatives;
use super::item::Item;
use super::parameter;
use super::physics::title;
use crate::diagnosis::{Diagnosis, SettingFinding};
use crate::terms::SettingKind;

/// All settings, in order.
pub(super) fn items(diagnosis: &Diagnosis) -> Vec<Item> {
    diagnosis.settings.iter().map(|setting| item(setting, diagnosis)).collect()
}

fn item(setting: &SettingFinding, diagnosis: &Diagnosis) -> Item {
    let recording = diagnosis.recordings.get(setting.recording);
    let heading = match recording.filter(|_| diagnosis.recordings.len() > 1) {
        Some(recording) => format!("{} in {}", title(setting.term), recording.file),
        None => title(setting.term),
    };
    Item::new(
        heading,
        [
            ("what", vec![meaning(setting.term).to_owned()]),
            ("how much", parameter::lines(&setting.parameters, 0)),
            ("or else", alternatives(&setting.alternatives)),
            ("compensation", vec!["None: it belongs to the recording, not to the machine.".to_owned()]),
        ],
    )
}

fn meaning(term: &str) -> &'static str {
    match SettingKind::of_name(term) {
        Some(SettingKind::Eccentricity) => "The true centre minus the centre declared in the set-up.",
        Some(SettingKind::Radius) => "The instrument is longer or shorter than declared in the set-up.",
        Some(SettingKind::Cosine) => {
            "The beam is at an angle to the motion, so every length reads too short."
        }
        Some(SettingKind::Clock) => {
            "The instrument's clock has an offset: at each time it shows an earlier state."
        }
        Some(SettingKind::Datum) => {
            "The part was rotated when it was measured, right-handed about X (a), Y (b) and Z (c) of its frame; a probed part \
             was also displaced (x, y, z)."
        }
        Some(SettingKind::Offset) | None => "",
    }
}
