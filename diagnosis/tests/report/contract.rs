//! The object `abbe-diagnosis/1`, read back and held against its contract.

use abbe_diagnosis::diagnosis::{Diagnosis, Interval, IntervalOf, OverTravel, Parameter, ParameterValue};
use abbe_diagnosis::report;
use serde_json::{Value, json};

use crate::cases;

fn parsed(diagnosis: &Diagnosis) -> Value {
    serde_json::from_str(&report::json(diagnosis)).unwrap()
}

/// Every key of the contract stands in the object with the same value; others may stand beside them.
fn holds(found: &Value, contract: &Value, at: &str) {
    match contract {
        Value::Object(keys) => {
            for (key, wanted) in keys {
                let value = found.get(key).unwrap_or_else(|| panic!("{at}.{key} is missing"));
                holds(value, wanted, &format!("{at}.{key}"));
            }
        }
        Value::Array(items) => {
            let list = found.as_array().unwrap_or_else(|| panic!("{at} is no list"));
            assert_eq!(list.len(), items.len(), "{at}");
            for (k, (found, wanted)) in list.iter().zip(items).enumerate() {
                holds(found, wanted, &format!("{at}[{k}]"));
            }
        }
        Value::Number(wanted) => {
            let (found, wanted) = (found.as_f64().unwrap(), wanted.as_f64().unwrap());
            assert!((found - wanted).abs() <= 1e-12 * wanted.abs(), "{at}: {found}, not {wanted}");
        }
        other => assert_eq!(found, other, "{at}"),
    }
}

#[test]
fn the_example_of_the_contract() {
    holds(
        &parsed(&cases::two_findings()),
        &json!({"schema": "abbe-diagnosis/1",
            "verdict": "left-out-physics",
            "noise": {"value": 0.0005, "unit": "mm"},
            "before": {"rms": 0.0123, "holdout_rms": 0.0125, "unit": "mm"},
            "after":  {"rms": 0.0005, "holdout_rms": 0.0006, "unit": "mm"},
            "findings": [
              {"motion": "EYY", "term": "backlash",
               "parameters": {"lost_motion": {"value": 0.0098, "ci95": [0.0095, 0.0101], "unit": "mm"}},
               "share": 0.83,
               "where": {"link": "Y", "side": "transmission", "state": "direction",
                         "detail": "jumps at every reversal of y, both repeats"},
               "evidence": "removing it raises the held-out rms from 0.60 um to 5.1 um",
               "indistinguishable_from": []},
              {"motion": "EXX", "term": "expansion",
               "parameters": {"sensor": "scale",
                              "coefficient": {"value": 7.18e-6, "ci95": [7.128e-6, 7.232e-6], "unit": "1/K"},
                              "reference": {"value": 20.0, "unit": "degC"}},
               "share": 0.13,
               "where": {"link": "X", "side": "unknown", "state": "temperature"},
               "indistinguishable_from": [
                 {"motion": "EXX", "term": "expansion", "separate_by": "move EXX's axis while the others stand"},
                 {"motion": "EZZ", "term": "expansion"}, {"motion": "EXZ", "term": "expansion"},
                 {"motion": "EYX", "term": "expansion"}]}],
            "instrument": [{"term": "eccentricity", "recording": "circle.yaml",
                "parameters": {"x": {"value": -0.00657, "ci95": [-0.00668, -0.00646], "unit": "mm"},
                               "y": {"value": 0.00336, "ci95": [0.00326, 0.00346], "unit": "mm"}}}],
            "unexplained": null}),
        "",
    );
}

#[test]
fn nothing_left_out_is_said_with_empty_lists() {
    let contract = json!({"verdict": "adequate", "findings": [], "instrument": [], "unexplained": null,
        "repeatability": null, "undecided": [],
        "noise": {"white": 0.0004, "wander": 0.0003, "time_constant": 12.0},
        "recordings": [{"file": "circle.yaml", "title": "circle r 75 mm", "instrument": "position", "rows": 7299,
            "runs": 3, "samples": 14595, "missing": 3, "outliers": 1, "held_out": "run 3"}]});
    holds(&parsed(&cases::adequate()), &contract, "");
}

#[test]
fn a_fault_of_a_file_says_where_and_what_to_change() {
    let contract = json!({"model": [
        {"file": "calibration.yaml", "line": 14, "path": "errors.EBX", "change": "sign",
         "parameters": {"factor": {"value": -0.998, "ci95": [-1.01, -0.986], "unit": ""}}, "share": 0.97,
         "fault": "EBX has the wrong sign", "remedy": "change the sign of its values",
         "evidence_rms": {"with": 0.0006, "without": 0.0031, "unit": "mm"},
         "indistinguishable_from": ["the reading of circle.yaml has the wrong sign"]},
        {"file": "FXYZ", "path": "topology", "change": "order", "with": "XFYZ", "share": null}]});
    let found = parsed(&cases::wrong_files());
    holds(&found, &contract, "");
    assert!(found["model"][1].get("line").is_none() && found["model"][1].get("parameters").is_none());
    assert_eq!(parsed(&cases::two_findings())["model"], json!([]));
}

#[test]
fn what_is_unexplained_says_where() {
    let interval = json!({"axis": "X", "from": 174.67, "to": 200.98, "unit": "mm"});
    let contract = json!({"verdict": "unexplained", "findings": [], "unexplained": {
        "link": "X", "direction": "measured.z", "state": "position", "interval": interval,
        "where": {"link": "X", "state": "position", "interval": interval},
        "rms": 0.0052, "unit": "mm", "table_of": "EZX",
        "detail": "a dip of 8.8 um in both directions and all runs"}});
    holds(&parsed(&cases::unexplained()), &contract, "");
}

#[test]
fn frequency_stands_in_place_of_an_axis() {
    let mut diagnosis = cases::unexplained();
    let unexplained = diagnosis.unexplained.as_mut().unwrap();
    unexplained.interval = Some(Interval { of: IntervalOf::Frequency, from: 3.0, to: 5.0, unit: "Hz" });
    let interval = json!({"axis": "frequency", "from": 3.0, "to": 5.0, "unit": "Hz"});
    holds(&parsed(&diagnosis), &json!({"unexplained": {"interval": interval}}), "");
}

#[test]
fn a_finding_that_is_confined_has_its_interval_and_others_have_none() {
    let mut diagnosis = cases::two_findings();
    let of = IntervalOf::Axis("Y".to_owned());
    diagnosis.findings[0].location.interval = Some(Interval { of, from: 212.0, to: 236.0, unit: "mm" });
    let found = parsed(&diagnosis);
    let interval = json!({"axis": "Y", "from": 212.0, "to": 236.0, "unit": "mm"});
    assert_eq!(found["findings"][0]["where"]["interval"], interval);
    assert!(found["findings"][1]["where"].get("interval").is_none());
}

#[test]
fn a_wave_has_the_elements_that_it_repeats_with_and_other_findings_have_none() {
    let contract = json!({"findings": [{"term": "cyclic", "repeats_with": [
        {"element": "worm", "period": {"value": 2.0, "unit": "deg"}, "harmonic": 1}]}]});
    holds(&parsed(&cases::worm()), &contract, "");
    for diagnosis in [cases::wave(Vec::new()), cases::two_findings()] {
        let found = parsed(&diagnosis);
        assert!(found["findings"][0].get("repeats_with").is_none());
    }
}

#[test]
fn runs_that_disagree_and_a_clock() {
    let contract = json!({"verdict": "not-repeatable", "findings": [],
        "repeatability": {"between_runs": 0.0071, "expected": 0.0001, "unit": "mm"}});
    holds(&parsed(&cases::not_repeatable()), &contract, "");
    let contract = json!({"verdict": "left-out-physics", "findings": [], "instrument": [
        {"term": "clock", "parameters": {"offset": {"value": 0.0123, "ci95": [0.0121, 0.0125], "unit": "s"}},
         "indistinguishable_from": [{"motion": "EXX", "term": "lag", "separate_by": "record at two feeds"}]}]});
    holds(&parsed(&cases::clock_only()), &contract, "");
}

#[test]
fn coefficients_are_a_list_of_numbers() {
    let mut diagnosis = cases::two_findings();
    let list = vec![cases::estimate(0.001, 0.0001, "mm"), cases::estimate(2e-5, 1e-6, "")];
    diagnosis.findings[0].parameters =
        vec![cases::word("axis", "Y"), Parameter { name: "coefficients", value: ParameterValue::List(list) }];
    let contract = json!({"axis": "Y", "coefficients": [
        {"value": 0.001, "ci95": [0.0009, 0.0011], "unit": "mm"},
        {"value": 2e-5, "ci95": [1.9e-5, 2.1e-5], "unit": ""}]});
    holds(&parsed(&diagnosis)["findings"][0]["parameters"], &contract, "parameters");
}

#[test]
fn an_interval_is_low_then_high_and_what_is_no_number_is_null() {
    let mut diagnosis = cases::two_findings();
    let mut turned = cases::estimate(1.0, 0.5, "mm");
    turned.ci95 = (1.5, 0.5);
    let unknown = cases::estimate(f64::NAN, f64::INFINITY, "mm");
    diagnosis.findings[0].parameters = vec![
        Parameter { name: "lost_motion", value: ParameterValue::Fitted(turned) },
        Parameter { name: "wind_up", value: ParameterValue::Fitted(unknown) },
    ];
    diagnosis.noise.value = f64::NAN;
    diagnosis.after.holdout_rms = None;
    diagnosis.findings[0].evidence.without = f64::INFINITY;
    let found = parsed(&diagnosis);
    assert_eq!(found["findings"][0]["parameters"]["lost_motion"]["ci95"], json!([0.5, 1.5]));
    let unknown = json!({"value": null, "ci95": [null, null], "unit": "mm"});
    assert_eq!(found["findings"][0]["parameters"]["wind_up"], unknown);
    assert_eq!(found["findings"][0]["evidence_rms"]["without"], Value::Null);
    assert!(found["findings"][0]["evidence"].as_str().is_some());
    assert_eq!((&found["noise"]["value"], &found["after"]["holdout_rms"]), (&Value::Null, &Value::Null));
}

/// The keys of an object and of all objects in it; of a list, those of its first entry.
fn keys(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(entries) => {
            for (key, value) in entries {
                found.push(format!("{at}.{key}"));
                keys(value, &format!("{at}.{key}"), found);
            }
        }
        Value::Array(items) => items.iter().take(1).for_each(|first| keys(first, at, found)),
        _ => {}
    }
}

#[test]
fn the_manual_shows_every_key() {
    let manual = include_str!("../../../docs/reference/diagnosis.md");
    let example = manual.split("```json").nth(1).unwrap().split("```").next().unwrap();
    let mut diagnosis = cases::two_findings();
    diagnosis.findings[0].alternatives = cases::clock_only().settings[0].alternatives.clone();
    diagnosis.settings[0].parameters.truncate(1);
    diagnosis.model = vec![cases::sign()];
    let (mut shown, mut written) = (Vec::new(), Vec::new());
    keys(&serde_json::from_str(example).unwrap(), "", &mut shown);
    keys(&parsed(&diagnosis), "", &mut written);
    shown.sort();
    written.sort();
    assert_eq!(shown, written);
}

#[test]
fn the_range_over_the_travel_is_a_fitted_number_of_an_axis() {
    let mut diagnosis = cases::two_findings();
    assert!(parsed(&diagnosis)["findings"][0].get("over_travel").is_none());
    diagnosis.findings[0].over_travel =
        Some(OverTravel { axis: "Y".to_owned(), range: cases::estimate(0.0098, 0.0011, "mm") });
    holds(
        &parsed(&diagnosis)["findings"][0],
        &json!({"over_travel": {"axis": "Y", "value": 0.0098, "ci95": [0.0087, 0.0109], "unit": "mm"}}),
        "finding",
    );
}
