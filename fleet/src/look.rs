//! What to look at. In: the term of an effect that changed. Out: the parts of a machine that people check first.

/// Where wear, damage or a wrong setting of this kind comes from, most usual first: a clause.
pub(crate) fn look(term: &str) -> &'static str {
    match term {
        "backlash" => "the preload of nut, gear or belt, the bearing that holds the screw, and the coupling",
        "reversal-spike" => {
            "the friction of the guides, their lubrication and wipers, and the friction compensation of the drive"
        }
        "cyclic" => {
            "what turns or repeats with this period: the screw and its bearings, a gear or worm, the lines of a scale"
        }
        "vibration" => "what runs at this frequency: spindle, fan, pump, and what stands near the machine",
        "constant" => "the alignment of the guides: levelling, the bolts of the foundation, a collision",
        "polynomial" | "table" | "coupling" => {
            "the guides and the scale of the axis: wear where it is used most, fastening, levelling"
        }
        "lag" | "acceleration" | "delay" => {
            "the gains and the feedforward of the position loop, and what the axis carries"
        }
        "expansion" | "growth" | "drift" => {
            "what warms the machine: cooling, the warm-up before the test, the place of the sensor"
        }
        "compliance" => "clamps, bearings and guides that give way under the load",
        "product" => "what its factors name: the effect acts where all of them do",
        _ => "the instrument, how it is mounted, and what stands near the machine",
    }
}
