//! The machines that come with the program, and what was published about them. In: a name, or a machine file. Out: the
//! text of the machine file; the file of printed equations.

/// The names of the shipped machines with their files.
pub const MACHINES: [(&str, &str); 16] = [
    ("cai-wafer-grinder", include_str!("../../machines/cai-wafer-grinder.yaml")),
    ("excello-921", include_str!("../../machines/excello-921.yaml")),
    ("fxyz-mill", include_str!("../../machines/fxyz-mill.yaml")),
    ("head-table-5axis", include_str!("../../machines/head-table-5axis.yaml")),
    ("linuxcnc-xyzac-trt", include_str!("../../machines/linuxcnc-xyzac-trt.yaml")),
    ("linuxcnc-xyzbc-trt", include_str!("../../machines/linuxcnc-xyzbc-trt.yaml")),
    ("msl-moving-bridge", include_str!("../../machines/msl-moving-bridge.yaml")),
    ("msl-moving-table", include_str!("../../machines/msl-moving-table.yaml")),
    ("nist-turning-center", include_str!("../../machines/nist-turning-center.yaml")),
    ("nutating-head-5axis", include_str!("../../machines/nutating-head-5axis.yaml")),
    ("postech-mill", include_str!("../../machines/postech-mill.yaml")),
    ("printer-skew", include_str!("../../machines/printer-skew.yaml")),
    ("trunnion-5axis", include_str!("../../machines/trunnion-5axis.yaml")),
    ("xfyz-mill", include_str!("../../machines/xfyz-mill.yaml")),
    ("xyfz-mill", include_str!("../../machines/xyfz-mill.yaml")),
    ("xyzf-mill", include_str!("../../machines/xyzf-mill.yaml")),
];

/// The text of a shipped machine file.
pub fn machine(name: &str) -> Option<&'static str> {
    MACHINES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// The equations in print of some shipped machines: the machine, the name of their file, their text.
const PUBLISHED: [(&str, &str, &str); 9] = [
    ("excello-921", "published/excello-921.eqs", include_str!("../../published/excello-921.eqs")),
    (
        "nist-turning-center",
        "published/nist-turning-center.eqs",
        include_str!("../../published/nist-turning-center.eqs"),
    ),
    ("postech-mill", "published/postech-carriage.eqs", include_str!("../../published/postech-carriage.eqs")),
    (
        "cai-wafer-grinder",
        "published/cai-wafer-grinder.eqs",
        include_str!("../../published/cai-wafer-grinder.eqs"),
    ),
    (
        "linuxcnc-xyzac-trt",
        "published/linuxcnc-xyzac-trt.eqs",
        include_str!("../../published/linuxcnc-xyzac-trt.eqs"),
    ),
    (
        "linuxcnc-xyzbc-trt",
        "published/linuxcnc-xyzbc-trt.eqs",
        include_str!("../../published/linuxcnc-xyzbc-trt.eqs"),
    ),
    (
        "msl-moving-bridge",
        "published/msl-moving-bridge.eqs",
        include_str!("../../published/msl-moving-bridge.eqs"),
    ),
    (
        "msl-moving-table",
        "published/msl-moving-table.eqs",
        include_str!("../../published/msl-moving-table.eqs"),
    ),
    ("printer-skew", "published/printer-skew.eqs", include_str!("../../published/printer-skew.eqs")),
];

/// The name and the text of the equations that were published about a machine, where its file is a shipped one, word for
/// word: a copy that was changed is another machine.
pub fn published(machine_file: &str) -> Option<(&'static str, &'static str)> {
    let (name, _) = MACHINES.iter().find(|(_, text)| *text == machine_file)?;
    PUBLISHED.iter().find(|(machine, ..)| machine == name).map(|(_, file, text)| (*file, *text))
}
