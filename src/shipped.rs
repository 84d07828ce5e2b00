//! The machines that come with the program. In: a name. Out: the text of its machine file.

/// The names of the shipped machines with their files.
pub(crate) const MACHINES: [(&str, &str); 9] = [
    ("excello-921", include_str!("../machines/excello-921.yaml")),
    ("fxyz-mill", include_str!("../machines/fxyz-mill.yaml")),
    ("head-table-5axis", include_str!("../machines/head-table-5axis.yaml")),
    ("nist-turning-center", include_str!("../machines/nist-turning-center.yaml")),
    ("postech-mill", include_str!("../machines/postech-mill.yaml")),
    ("trunnion-5axis", include_str!("../machines/trunnion-5axis.yaml")),
    ("xfyz-mill", include_str!("../machines/xfyz-mill.yaml")),
    ("xyfz-mill", include_str!("../machines/xyfz-mill.yaml")),
    ("xyzf-mill", include_str!("../machines/xyzf-mill.yaml")),
];

/// The text of a shipped machine file.
pub(crate) fn machine(name: &str) -> Option<&'static str> {
    MACHINES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
