//! Tools that point elsewhere. In: a machine file that names the direction of its tool, and calibrations with tools. Out: the constants with
//! each tool, worked by hand, what is refused and where, and that what is written reads back.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

use abbe_model_dsl::calibration::{Calibration, MachineNames, read, write};
use abbe_model_dsl::compile;
use abbe_model_dsl::diagnostic::Diagnostics;
use abbe_model_dsl::source::SourceFile;
use abbe_model_dsl::yaml;

/// A head on B with tools that point anywhere; `offset` and the keys of the file differ.
fn names(offset: &str, keys: &str, direction: &str) -> MachineNames {
    let text = format!(
        "abbe: 1\nname: turret\n{keys}chain:\n  tool:\n    - {{slide: X, along: +X, origin: [X1, 0, 0]}}\n    - {{rotary: B, along: +B}}\n    \
         - {{tool: tip, offset: {offset}{direction}}}\n"
    );
    let mut diagnostics = Diagnostics::new();
    let compiled = compile(&SourceFile::new("machine.yaml", text.as_str()), &mut diagnostics);
    compiled.unwrap_or_else(|| panic!("{diagnostics:?}\n{text}")).equations.names()
}

fn pointing(offset: &str) -> MachineNames {
    names(offset, "orientation: true\n", ", direction: [It, Jt, Kt]")
}

/// A calibration with one tool T, and every finding as its code and the text that it points at.
fn calibrated(names: &MachineNames, tool: &str) -> (Option<Calibration>, Vec<(String, String)>) {
    let constants: Vec<String> = names.offsets().map(|(name, _)| format!("{name}: 1 mm")).collect();
    let constants = constants.join(", ");
    let text = format!(
        "calibration: 1\nmachine: turret\nconstants: {{{constants}}}\ntools: {{T: {tool}}}\nerrors: {{}}\n"
    );
    let (source, mut diagnostics) = (SourceFile::new("calibration.yaml", text.as_str()), Diagnostics::new());
    let root = yaml::read(&source, &mut diagnostics).unwrap();
    let calibration = read(&root, names, &mut diagnostics);
    let told = diagnostics.iter().map(|one| {
        assert!(one.help.is_some(), "{} says not what to write", one.code);
        (one.code.to_owned(), text[one.span.start..one.span.end].to_owned())
    });
    (calibration, told.collect())
}

/// The constants with the tool: X1, Xt, Yt, Zt, It, Jt, Kt.
fn with_tool(tool: &str) -> Vec<f64> {
    let names = pointing("[Xt, Yt, Zt]");
    let (calibration, told) = calibrated(&names, tool);
    assert_eq!(told, [], "{tool}");
    let calibration = calibration.unwrap();
    assert_eq!(calibration.constants, [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0]);
    let text = write(&calibration, &names);
    let root = yaml::read(&SourceFile::new("again.yaml", text.as_str()), &mut Diagnostics::new()).unwrap();
    let again = read(&root, &names, &mut Diagnostics::new()).unwrap_or_else(|| panic!("{text}"));
    assert_eq!(again.tools[0].constants, calibration.tools[0].constants, "{text}");
    calibration.tools[0].constants.clone()
}

/// Right angles are exact; anything else by hand.
#[test]
fn a_tool_points_as_it_says_and_stands_as_its_holder_does() {
    assert_eq!(with_tool("{Zt: 60 mm}"), [1.0, 1.0, 1.0, 60.0, 0.0, 0.0, 1.0]);
    assert_eq!(with_tool("{Zt: 60 mm, direction: [0, 3, 4]}"), [1.0, 1.0, 1.0, 60.0, 0.0, 0.6, 0.8]);
    // About X, Y goes to Z and Z to -Y.
    let turned = with_tool("{turned: {A: 90 deg}, Xt: 5 mm, Yt: 0 mm, Zt: 60 mm}");
    assert_eq!(turned, [1.0, 5.0, -60.0, 0.0, 0.0, -1.0, 0.0]);
    // About X first, then about Z, where X goes to Y and -Y to X.
    let turned = with_tool("{turned: {C: 90 deg, A: 90 deg}, Xt: 5 mm, Yt: 0 mm, Zt: 60 mm}");
    assert_eq!(turned, [1.0, 60.0, 5.0, 0.0, 1.0, 0.0, 0.0]);
    let turned = with_tool("{turned: {B: 30 deg}, Xt: 0 mm, Yt: 2 mm, Zt: 60 mm}");
    for (found, expected) in
        turned.into_iter().zip([1.0, 30.0, 2.0, 51.961524227066, 0.5, 0.0, 0.866025403784])
    {
        assert!((found - expected).abs() < 1e-11, "{found} {expected}");
    }
}

#[test]
fn a_tip_that_keeps_to_a_plane_turns_in_it() {
    let names = pointing("[Xt, 0, Zt]");
    let (calibration, told) = calibrated(&names, "{turned: {B: 90 deg}, Xt: 5 mm, Zt: 60 mm}");
    assert_eq!(told, []);
    assert_eq!(calibration.unwrap().tools[0].constants, [1.0, 60.0, -5.0, 1.0, 0.0, 0.0]);
    let (_, told) = calibrated(&names, "{turned: {A: 90 deg}, Xt: 5 mm, Zt: 60 mm}");
    assert_eq!(told, [("E0432".to_owned(), "turned".to_owned())]);
}

#[test]
fn what_no_tool_can_say_is_refused_where_it_stands() {
    let refused = |names: &MachineNames, tool: &str, at: &[(&str, &str)]| {
        let (calibration, told) = calibrated(names, tool);
        let told: Vec<_> = told.iter().map(|(code, at)| (code.as_str(), at.as_str())).collect();
        assert_eq!(told, at, "{tool}");
        assert!(calibration.is_none(), "{tool}");
    };
    let full = pointing("[Xt, Yt, Zt]");
    refused(&full, "{direction: [0, 0, 0]}", &[("E0432", "[0, 0, 0]")]);
    refused(&full, "{direction: [0, 1]}", &[("E0432", "[0, 1]")]);
    refused(&full, "{direction: [0, 1 mm, 0]}", &[("E0309", "mm")]);
    refused(&full, "{turned: {D: 90 deg}}", &[("E0432", "{D: 90 deg}")]);
    refused(&full, "{turned: 90 deg}", &[("E0432", "90 deg")]);
    refused(&full, "{turned: {A: 90}}", &[("E0306", "90")]);
    refused(&full, "{turned: {A: 90 deg}, direction: [1, 0, 0]}", &[("E0432", "direction")]);
    refused(&full, "{It: 1 mm}", &[("E0405", "It")]);
    // A coordinate that is a sum, and a constant that stands in two places.
    refused(&pointing("[Xt, Yt, Zt + 5]"), "{turned: {A: 90 deg}}", &[("E0432", "turned")]);
    refused(&pointing("[X1, Yt, Zt]"), "{turned: {A: 90 deg}}", &[("E0432", "turned")]);
    let plain = names("[Xt, Yt, Zt]", "", "");
    refused(&plain, "{direction: [0, 1, 0]}", &[("E0432", "direction")]);
    refused(&plain, "{turned: {A: 90 deg}}", &[("E0432", "turned")]);
}
