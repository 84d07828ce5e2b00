//! What to look at in a machine where an effect grew, stepped or appeared. In: a term's name in calibration files. Out: the parts that
//! people check first.

use model_dsl::calibration::TermKind;

/// Where wear, damage or a wrong setting of this kind comes from, most usual first: a clause. `None` for a name that is no term.
pub fn look_at(term: &str) -> Option<&'static str> {
    Some(match TermKind::of_name(term)? {
        TermKind::Backlash => {
            "the preload of nut, gear or belt, the bearing that holds the screw, and the coupling"
        }
        TermKind::ReversalSpike => {
            "the friction of the guides, their lubrication and wipers, and the friction compensation of the drive"
        }
        TermKind::Cyclic => {
            "parts that rotate or repeat with this period: the screw and its bearings, a gear or worm, the lines of a scale"
        }
        TermKind::Vibration => {
            "sources that run at this frequency: spindle, fan, pump, and equipment near the machine"
        }
        TermKind::Constant | TermKind::Step => {
            "the alignment of the guides: levelling, the bolts of the foundation, a collision"
        }
        TermKind::Polynomial | TermKind::Table | TermKind::Coupling => {
            "the guides and the scale of the axis: wear in the part used most, fastening, levelling"
        }
        TermKind::Lag | TermKind::Acceleration | TermKind::Delay => {
            "the gains and the feed-forward of the position loop, and the load on the axis"
        }
        TermKind::Expansion | TermKind::Growth | TermKind::Drift => {
            "the heat balance of the machine: cooling, the warm-up before the test, the place of the sensor"
        }
        TermKind::Compliance => "clamps, bearings and guides that yield under the load",
        TermKind::Product => "the states that its factors name: the effect needs all of them",
    })
}
