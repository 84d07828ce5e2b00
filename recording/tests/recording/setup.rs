//! Instruments as they were set up, and what is derived where it is evident.

use abbe_recording::{Header, Instrument, Line, PartDatum};

use crate::common::{header, recording};

/// A recording of a deviation with all axes commanded.
fn with(machine: &str, commands: &str, instrument: &str, unit: &str, setup: &str) -> Header {
    let commands: String = commands
        .split_whitespace()
        .map(|axis| {
            let unit = if "abc".contains(axis) { "deg" } else { "mm" };
            format!("  command.{axis}: {{column: {axis}, unit: {unit}}}\n")
        })
        .collect();
    header(&format!(
        "recording: 1\nmachine: {machine}\ninstrument: {instrument}\ndata: d.csv\nchannels:\n  time: {{column: t, unit: s}}\n{commands}  deviation: {{column: d, unit: {unit}}}\nsetup: {setup}\n"
    ))
}

#[test]
fn a_ballbar_is_in_millimetres() {
    let header = with("XYFZ", "x y", "ballbar", "um", "{center: [1 in, 2 cm, -3 mm], radius: 100000 um}");
    let Instrument::Ballbar { center, radius } = header.instrument else { panic!() };
    assert_eq!((center, radius), ([25.4, 20.0, -3.0], 100.0));
}

/// Positive motion of an axis moves the tool relative to the part along its letter, whichever of the two moves.
#[test]
fn a_linear_instrument_reads_along_its_axis() {
    for (machine, letter, direction) in
        [("XYFZ", "X", [1.0, 0.0, 0.0]), ("FXYZ", "Y", [0.0, 1.0, 0.0]), ("lathe", "Z", [0.0, 0.0, 1.0])]
    {
        let axes: &str = if machine == "lathe" { "x z" } else { "x y z" };
        let number = axes.split(' ').position(|axis| axis.eq_ignore_ascii_case(letter));
        let header = with(machine, axes, "linear", "mm", &format!("{{axis: {letter}}}"));
        assert_eq!(header.instrument, Instrument::Linear(Line { axis: number, direction }));
        // The axis follows from the direction too.
        let header = with(machine, axes, "linear", "mm", &format!("{{direction: {letter}}}"));
        assert_eq!(header.instrument, Instrument::Linear(Line { axis: number, direction }));
        let header =
            with(machine, axes, "linear", "mm", &format!("{{axis: {letter}, direction: -{letter}}}"));
        let against = direction.map(|component: f64| 0.0 - component);
        assert_eq!(header.instrument, Instrument::Linear(Line { axis: number, direction: against }));
    }
    // One axis that moves needs no name, and a diagonal has none.
    let stage = with("FX", "x", "linear", "mm", "{}");
    assert_eq!(stage.instrument, Instrument::Linear(Line { axis: Some(0), direction: [1.0, 0.0, 0.0] }));
    let diagonal = with("XYFZ", "x y z", "linear", "mm", "{direction: [3, 4, 0]}");
    assert_eq!(diagonal.instrument, Instrument::Linear(Line { axis: None, direction: [0.6, 0.8, 0.0] }));
}

#[test]
fn straightness_reads_across() {
    let header = with("XYFZ", "x y z", "straightness", "um", "{axis: X, direction: -Z}");
    assert_eq!(
        header.instrument,
        Instrument::Straightness(Line { axis: Some(0), direction: [0.0, 0.0, -1.0] })
    );
    let header = with("XYFZ", "y", "straightness", "um", "{direction: X}");
    assert_eq!(
        header.instrument,
        Instrument::Straightness(Line { axis: Some(1), direction: [1.0, 0.0, 0.0] })
    );
    let header = with("XYFZ", "x y", "straightness", "um", "{direction: Z}");
    assert_eq!(header.instrument, Instrument::Straightness(Line { axis: None, direction: [0.0, 0.0, 1.0] }));
}

#[test]
fn an_angle_is_about_a_direction() {
    for written in ["B", "Y", "+B", "[0, 2, 0]"] {
        let header = with("XYFZ", "x", "angular", "arcsec", &format!("{{axis: X, direction: {written}}}"));
        assert_eq!(header.instrument, Instrument::Angular { axis: Some(0), about: [0.0, 1.0, 0.0] });
    }
    // A rotary axis turns about itself unless another direction is read.
    for setup in ["{}", "{axis: C}", "{axis: C, direction: C}"] {
        let header = with("FC", "c", "angular", "urad", setup);
        assert_eq!(
            header.instrument,
            Instrument::Angular { axis: Some(0), about: [0.0, 0.0, 1.0] },
            "{setup}"
        );
    }
    let tilt = with("FC", "c", "angular", "urad", "{axis: C, direction: -A}");
    assert_eq!(tilt.instrument, Instrument::Angular { axis: Some(0), about: [-1.0, 0.0, 0.0] });
}

#[test]
fn a_probe_has_normals_of_length_one() {
    let one = with("XYFZ", "x y z", "probe", "um", "{direction: [0, 3, 4]}");
    let read = one.read_csv("d.csv", "t,x,y,z,d\n0,1,2,3,4\n1,1,2,3,5\n".as_bytes()).unwrap();
    assert_eq!(read.instrument, Instrument::Probe);
    assert_eq!(read.normal.unwrap(), [vec![0.0; 2], vec![0.6; 2], vec![0.8; 2]]);
    let text = "recording: 1
machine: lathe
instrument: probe
data: d.csv
channels:
  time: {column: t, unit: s}
  deviation: {column: d, unit: um}
  normal.x: {column: nx}
  normal.z: {column: nz}
";
    let read = recording(text, "t,d,nx,nz\n0,5,3,4\n1,5,0,-1\n2,,,1\n").unwrap();
    let [x, y, z] = read.normal.unwrap();
    assert_eq!((&x[..2], &y[..2], &z[..2]), (&[0.6, 0.0][..], &[0.0, 0.0][..], &[0.8, -1.0][..]));
    assert!(x[2].is_nan() && y[2].is_nan() && z[2].is_nan());
    assert_eq!(read.notes.len(), 1, "{:?}", read.notes);
    assert_eq!(read.deviation.unwrap()[..2], [0.005, 0.005]);
    let error = recording(text, "t,d,nx,nz\n0,5,0,0\n").unwrap_err();
    assert!(error.to_string().contains("length zero"), "{error}");
}

#[test]
fn the_datum_of_a_part_is_free_where_it_says_so() {
    let part = |setup: &str| {
        let text = format!(
            "recording: 1\nmachine: XYFZ\ninstrument: position\ndata: d.csv\nchannels:\n  time: {{column: t, unit: s}}\n  \
             command.x: {{column: x, unit: mm}}\n  measured.x: {{column: mx, unit: mm}}\n{setup}"
        );
        recording(&text, "t,x,mx\n0,1,2\n").unwrap().datum
    };
    assert_eq!(part("setup: {datum: free}\n"), PartDatum::Free);
    assert_eq!(part("setup: {datum: fixed}\n"), PartDatum::Fixed);
    assert_eq!([part("setup: {}\n"), part("")], [PartDatum::Unsaid; 2]);
    let probed = with("XYFZ", "x y z", "probe", "um", "{direction: Z, datum: free}");
    assert!(probed.datum == PartDatum::Free && probed.normal == Some([0.0, 0.0, 1.0]));
}
