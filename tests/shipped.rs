//! The shipped machines as the oracle sees them: described a second time, by hand, from their sources and the page of the
//! format. In: nothing. Out: descriptions to hold the files of `machines/` against.

use std::fs;
use std::path::PathBuf;

use model_dsl::compile;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;

use crate::oracle::{ErrorMotion, Kind, Link, Machine, Shape};
use crate::random::of_word;

/// A shipped machine.
pub(crate) struct Shipped {
    /// The name of its file.
    pub(crate) name: &'static str,
    /// Its description, by hand.
    pub(crate) described: fn() -> Machine,
}

/// All of `machines/`.
pub(crate) const SHIPPED: &[Shipped] = &[
    Shipped { name: "cai-wafer-grinder", described: wafer_grinder },
    Shipped { name: "excello-921", described: excello },
    Shipped { name: "fxyz-mill", described: || of_word("FXYZ") },
    Shipped { name: "head-table-5axis", described: head_table },
    Shipped { name: "linuxcnc-xyzac-trt", described: || tilting_table('A') },
    Shipped { name: "linuxcnc-xyzbc-trt", described: || tilting_table('B') },
    Shipped { name: "msl-moving-bridge", described: || of_word("FYXZ") },
    Shipped { name: "msl-moving-table", described: || of_word("XFYZ") },
    Shipped { name: "nist-turning-center", described: nist },
    Shipped { name: "nutating-head-5axis", described: nutating_head },
    Shipped { name: "postech-mill", described: postech },
    Shipped { name: "printer-skew", described: printer },
    Shipped { name: "trunnion-5axis", described: trunnion },
    Shipped { name: "xfyz-mill", described: || of_word("XFYZ") },
    Shipped { name: "xyfz-mill", described: || of_word("XYFZ") },
    Shipped { name: "xyzf-mill", described: || of_word("XYZF") },
];

impl Shipped {
    /// The text of its file.
    pub(crate) fn text(&self) -> String {
        let path = root().join("machines").join(format!("{}.yaml", self.name));
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }
}

/// The one of that name.
pub(crate) fn shipped(name: &str) -> &'static Shipped {
    SHIPPED.iter().find(|shipped| shipped.name == name).unwrap_or_else(|| panic!("{name} is not shipped"))
}

/// The root of the repository.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn all_of_them_are_described() {
    let files = fs::read_dir(root().join("machines")).unwrap().map(|entry| entry.unwrap().file_name());
    let mut files: Vec<String> =
        files.map(|name| name.into_string().unwrap()).filter(|name| name.ends_with(".yaml")).collect();
    files.sort();
    let described: Vec<String> = SHIPPED.iter().map(|shipped| format!("{}.yaml", shipped.name)).collect();
    assert_eq!(files, described);
}

/// Tables and polynomials of a motion are over this axis, where a calibration names no other.
#[test]
fn a_motion_has_the_axis_after_which_its_link_is_called() {
    for shipped in SHIPPED {
        let source = SourceFile::new(shipped.name, shipped.text());
        let equations = compile(&source, &mut Diagnostics::new()).unwrap().equations;
        for motion in &equations.motions {
            let axis = motion.axis.map(|axis| equations.axes[axis].letter.clone());
            let programmed = equations.axes.iter().any(|axis| axis.letter == motion.link);
            assert_eq!(axis, programmed.then(|| motion.link.clone()), "{} {}", shipped.name, motion.name);
        }
    }
}

fn link(kind: Kind, id: &str, along: &str, origin: [&str; 3]) -> Link {
    let direction = along.trim_start_matches(['+', '-']);
    let along_number =
        ["X", "Y", "Z", "A", "B", "C"].iter().position(|letter| *letter == direction).unwrap_or(2) % 3;
    let coordinate = |name: &str| match name.strip_prefix('-') {
        _ if name == "0" => Vec::new(),
        Some(name) => vec![(-1.0, Some(name.to_owned()))],
        None => vec![(1.0, Some(name.to_owned()))],
    };
    let origin = origin.map(coordinate);
    Link {
        kind,
        id: id.to_owned(),
        along: along_number,
        backwards: along.starts_with('-'),
        origin,
        turned: [0; 3],
        bed: None,
        errors: None,
    }
}

/// A slide or a rotary axis of a letter, its errors as usual.
pub(crate) fn axis(letter: char, along: &str, origin: [&str; 3]) -> Link {
    let kind = if "ABC".contains(letter) { Kind::Rotary(letter) } else { Kind::Slide(letter) };
    link(kind, &letter.to_string(), along, origin)
}

/// The tool.
pub(crate) fn tip(id: &str, offset: [&str; 3]) -> Link {
    link(Kind::Tool, id, "", offset)
}

/// Error motions by name with symbols; `-` before a symbol counts against the ISO sense, `@` names a travel.
pub(crate) fn with(mut link: Link, names: &[(&str, &str)]) -> Link {
    let errors = names.iter().map(|(name, symbol)| {
        let (symbol, travel) =
            symbol.split_once('@').map_or((*symbol, None), |(symbol, travel)| (symbol, Some(travel)));
        let middle = name.strip_suffix(link.id.as_str()).expect("an error motion of this link");
        let letter = "XYZABC".find(&middle[1..2]).expect("a direction");
        let shape = match (letter < 3, middle.ends_with('0')) {
            (true, false) => Shape::Linear,
            (false, false) => Shape::Angular,
            (true, true) => Shape::Offset,
            (false, true) => Shape::Alignment,
        };
        ErrorMotion {
            opposite: symbol.starts_with('-'),
            symbol: Some(symbol.trim_start_matches('-').to_owned()),
            travel: travel.map(str::to_owned),
            ..ErrorMotion::plain(shape, letter % 3)
        }
    });
    link.errors = Some(errors.collect());
    link
}

/// The Excello report: Z carries the part, X the tool.
fn excello() -> Machine {
    let z = with(
        axis('Z', "+Z", ["X1", "0", "Z1"]),
        &[("EXZ", "dxz"), ("EZZ", "dzz"), ("EBZ", "eyz"), ("EB0Z", "beta")],
    );
    let x = with(
        axis('X', "+X", ["X2", "0", "0"]),
        &[("EXX", "dxx"), ("EZX", "dzx"), ("EBX", "eyx"), ("EB0X", "alpha")],
    );
    Machine {
        sensitive: [true, false, true],
        relative: false,
        pointing: false,
        bed: false,
        workpiece: vec![z],
        tool: vec![x, tip("tip", ["Xt", "0", "Zt"])],
    }
}

/// NISTIR 6722, appendix A.1.
fn nist() -> Machine {
    let all = |id: &str, small: &str| -> Vec<(String, String)> {
        let one = |(iso, own): (&str, &str)| (format!("{iso}{id}"), format!("{own}{small}"));
        [("EX", "dx"), ("EY", "dy"), ("EZ", "dz"), ("EA", "ex"), ("EB", "ey"), ("EC", "ez")].map(one).to_vec()
    };
    let listed = |link: Link, names: Vec<(String, String)>| {
        let names: Vec<(&str, &str)> =
            names.iter().map(|(name, symbol)| (name.as_str(), symbol.as_str())).collect();
        with(link, &names)
    };
    let pair = |name: &str, symbol: &str| (name.to_owned(), symbol.to_owned());
    let spindle = listed(link(Kind::Spindle, "S", "+Z", ["X5", "0", "Z5"]), all("S", "s")[..5].to_vec());
    let part = listed(link(Kind::Part, "W", "", ["0", "0", "0"]), all("W", "w")[..3].to_vec());
    let z = listed(axis('Z', "+Z", ["X1", "0", "Z1"]), [all("Z", "z"), vec![pair("EB0Z", "ap@dz")]].concat());
    let x =
        listed(axis('X', "+X", ["X2", "0", "Z2"]), [all("X", "x"), vec![pair("EB0X", "-ao@dx")]].concat());
    let turret = listed(link(Kind::Fixed, "T", "", ["0", "0", "0"]), all("T", "t"));
    let cutter = listed(tip("C", ["X4", "0", "Z4"]), all("C", "c")[..3].to_vec());
    Machine {
        sensitive: [true; 3],
        relative: false,
        pointing: false,
        bed: false,
        workpiece: vec![spindle, part],
        tool: vec![z, x, turret, cutter],
    }
}

/// The mill of POSTECH: XYFZ, the motions read from the part, the squarenesses referred to Z.
fn postech() -> Machine {
    let six = |id: &str| ["EX", "EY", "EZ", "EA", "EB", "EC"].map(|letters| format!("{letters}{id}"));
    let listed = |link: Link, more: &[&str]| {
        let id = link.id.clone();
        let own = six(&id);
        let names: Vec<(&str, &str)> =
            own.iter().map(String::as_str).chain(more.iter().copied()).map(|name| (name, name)).collect();
        with(link, &names)
    };
    Machine {
        sensitive: [true; 3],
        relative: true,
        pointing: false,
        bed: false,
        workpiece: vec![
            listed(axis('Y', "-Y", ["0", "0", "0"]), &["EC0Y", "EA0Y"]),
            listed(axis('X', "-X", ["0", "0", "0"]), &["EB0X"]),
        ],
        tool: vec![listed(axis('Z', "+Z", ["0", "0", "0"]), &[]), tip("tip", ["Xt", "Yt", "Zt"])],
    }
}

/// The part turns on C, C on the trunnion A.
fn trunnion() -> Machine {
    Machine {
        workpiece: vec![axis('A', "-A", ["0", "Ya", "Za"]), axis('C', "-C", ["Xc", "Yc", "Zc"])],
        tool: vec![
            axis('X', "+X", ["0", "0", "0"]),
            axis('Y', "+Y", ["0", "0", "0"]),
            axis('Z', "+Z", ["0", "0", "0"]),
            tip("tip", ["Xt", "Yt", "Zt"]),
        ],
        ..of_word("FX")
    }
}

/// The tool tilts on B, the part turns on C.
fn head_table() -> Machine {
    Machine {
        workpiece: vec![axis('X', "-X", ["0", "0", "0"]), axis('C', "-C", ["Xc", "Yc", "Zc"])],
        tool: vec![
            axis('Y', "+Y", ["0", "0", "0"]),
            axis('Z', "+Z", ["0", "0", "0"]),
            axis('B', "+B", ["Xb", "Yb", "Zb"]),
            tip("tip", ["0", "0", "-L"]),
        ],
        ..of_word("FX")
    }
}

/// The axis of B leans by 45 degrees from Y towards Z.
fn nutating_head() -> Machine {
    let mut machine = head_table();
    if let Some(head) = machine.tool.get_mut(2) {
        head.turned = [450, 0, 0];
    }
    machine
}

/// LinuxCNC's trunnions: C stands on A or B, whose axis passes that of C; only the axes' own positions are wrong.
fn tilting_table(tilt: char) -> Machine {
    let (along, offset) = if tilt == 'A' { ("+A", "Yo") } else { ("+B", "Xo") };
    let own = |letter: char| format!("E{letter}{letter}");
    let one = |link: Link, letter: char| with(link, &[(own(letter).as_str(), own(letter).as_str())]);
    let mut swivel = one(axis(tilt, along, ["Xr", "Yr", "Zr"]), tilt);
    let across = usize::from(tilt == 'A');
    for (at, name) in [(across, offset), (2, "Zo")] {
        swivel.origin[at].push((1.0, Some(name.to_owned())));
    }
    let back = format!("-{offset}");
    let mut table = ["0", "0", "-Zo"];
    table[across] = &back;
    let mut part = link(Kind::Part, "blank", "", ["-Xr", "-Yr", "-Zr"]);
    part.origin[2].push((-1.0, Some("Lt".to_owned())));
    let slide = |letter: char, along: &str| one(axis(letter, along, ["0", "0", "0"]), letter);
    Machine {
        workpiece: vec![swivel, one(axis('C', "+C", table), 'C'), part],
        tool: vec![slide('X', "+X"), slide('Y', "+Y"), slide('Z', "+Z"), tip("tip", ["0", "0", "-Lt"])],
        ..of_word("FX")
    }
}

/// A printer that is not square.
fn printer() -> Machine {
    let zero = ["0", "0", "0"];
    Machine {
        tool: vec![
            with(axis('X', "+X", zero), &[]),
            with(axis('Y', "+Y", zero), &[("EC0Y", "EC0Y")]),
            with(axis('Z', "+Z", zero), &[("EA0Z", "EA0Z"), ("EB0Z", "EB0Z")]),
            tip("nozzle", zero),
        ],
        ..of_word("FX")
    }
}

/// Cai's grinder: the wafer turns on C, C rides on X; the wheel turns freely on Z.
fn wafer_grinder() -> Machine {
    let all = |id: &str, small: &str, alignments: &[(&str, &str)]| -> Vec<(String, String)> {
        let motions =
            [("EX", "dx"), ("EY", "dy"), ("EZ", "dz"), ("EA", "ex"), ("EB", "ey"), ("EC", "ez")].into_iter();
        let six = motions.map(|(iso, own)| (format!("{iso}{id}"), format!("{own}{small}")));
        let more = alignments.iter().map(|(iso, own)| (format!("{iso}{id}"), (*own).to_owned()));
        let free = ["C", "S"].contains(&id);
        six.filter(|(iso, _)| !free || !iso.starts_with("EC")).chain(more).collect()
    };
    let listed = |link: Link, small: &str, alignments: &[(&str, &str)]| {
        let names = all(&link.id.clone(), small, alignments);
        with(link, &names.iter().map(|(iso, own)| (iso.as_str(), own.as_str())).collect::<Vec<_>>())
    };
    let zero = ["0", "0", "0"];
    let mut z = listed(axis('Z', "+Z", zero), "z", &[("EB0", "eta")]);
    z.errors.iter_mut().flatten().last().expect("eta").rotates = true;
    let wheel = link(Kind::Spindle, "S", "+Z", zero);
    Machine {
        workpiece: vec![
            listed(axis('X', "+X", zero), "x", &[]),
            listed(axis('C', "+C", zero), "c2", &[("EA0", "azoc2"), ("EB0", "bzoc2")]),
        ],
        tool: vec![
            z,
            listed(wheel, "c1", &[("EA0", "azoc1"), ("EB0", "bzoc1")]),
            tip("grain", ["Xt", "Yt", "0"]),
        ],
        ..of_word("FX")
    }
}
