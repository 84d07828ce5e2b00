//! Archives for a SINUMERIK. In: a correction taken apart. Out: `$AA_ENC_COMP` of what each axis does to itself, and `$AN_CEC` of
//! what axes do to each other, the largest first, as many tables as the control has.

use std::fmt::Write;

use super::super::decimal::decimal;
use super::super::effects::{Effect, Effects, LEAST, Product};
use super::super::job::{File, Job, Written};
use super::super::nodes::{Spacing, is_a_turn};
use super::super::refused::Refused;
use super::control::{Sinumerik, controller};
use super::pieces::{Piece, Table};

/// The most points of a table.
const MOST: usize = 5000;

/// The archives of both compensations.
pub(in super::super) fn written(job: &Job<'_, '_>) -> Result<Written, Refused> {
    let control = controller(job)?;
    let effects = Effects::new(job.geometry, job.space)?;
    let all = nodes(job, &effects)?;
    let mut written = Written::default();
    let mut screws = String::from("%_N_AX_EEC_INI\nCHANDATA(1)\n");
    let mut pieces = Vec::new();
    for (source, nodes) in all.iter().enumerate() {
        for effect in effects.of(source, nodes)? {
            if effect.target == source {
                let base = effects.base.get(source).copied().unwrap_or_default();
                write_screw(&mut screws, &control, &effect, base);
                pieces.extend(Piece::own_rest(effect));
            } else {
                pieces.push(Piece::of(effect));
            }
        }
    }
    screws.push_str("M17\n");
    let about = "leadscrew error compensation of each axis, mean of both directions".to_owned();
    written.files.push(File { name: "eec.ini".to_owned(), axis: None, text: screws, about });
    written.loading = loading(&all);
    pieces.extend(together(&effects, &all)?.into_iter().map(Piece::Product));
    pieces.retain(|piece| piece.size() >= LEAST);
    cross(job, &control, pieces, &mut written);
    Ok(written)
}

/// The nodes of every axis.
fn nodes(job: &Job<'_, '_>, effects: &Effects<'_, '_>) -> Result<Vec<Vec<f64>>, Refused> {
    let spacing = Spacing { points: job.options.points, most: MOST };
    (0..job.space.ranges.len()).map(|axis| effects.nodes(axis)?.at_equal_steps(spacing)).collect()
}

fn together(effects: &Effects<'_, '_>, nodes: &[Vec<f64>]) -> Result<Vec<Product>, Refused> {
    let mut products = Vec::new();
    for (second, seconds) in nodes.iter().enumerate() {
        for (first, firsts) in nodes.iter().enumerate().take(second) {
            products.extend(effects.together([first, second], [firsts, seconds], LEAST)?);
        }
    }
    Ok(products)
}

fn loading(nodes: &[Vec<f64>]) -> Vec<String> {
    let most = nodes.iter().map(Vec::len).max().unwrap_or_default();
    vec![
        format!(
            "MD38000 $MA_MM_ENC_COMP_MAX_POINTS at least {most}; then run eec.ini, MD32700 $MA_ENC_COMP_ENABLE = 1"
        ),
        "a value of ENC_COMP moves its axis the opposite way: the values are errors, actual minus commanded"
            .to_owned(),
    ]
}

/// The cross tables that the control has room for; what they are is left out where the user does not say their sign.
fn cross(job: &Job<'_, '_>, control: &Sinumerik, mut pieces: Vec<Piece>, written: &mut Written) {
    pieces.sort_by(|one, other| other.size().total_cmp(&one.size()));
    let Some(sense) = job.options.sense else {
        if !pieces.is_empty() {
            written.left_out.push(format!(
                "{} pieces of cross compensation (CEC), the largest of {:.1} um: no public document says what a positive value \
                 means; find out with an indicator, then use --value error or --value correction",
                pieces.len(),
                pieces.first().map_or(0.0, Piece::size) * 1000.0
            ));
        }
        return;
    };
    let mut text = String::from("%_N_NC_CEC_INI\nCHANDATA(1)\n");
    let (mut index, mut left) = (0, Vec::new());
    for piece in &pieces {
        if index + piece.count() > job.options.tables {
            left.push(piece.size());
            continue;
        }
        for table in piece.tables(index, sense.sign()) {
            write_table(&mut text, control, index, &table);
            index += 1;
        }
    }
    text.push_str("M17\n");
    if let Some(largest) = left.first() {
        written.left_out.push(format!(
            "{} pieces of cross compensation, the largest of {:.1} um: the control has {} tables (--tables)",
            left.len(),
            largest * 1000.0,
            job.options.tables
        ));
    }
    if index > 0 {
        let about = format!("{index} tables of cross error compensation");
        written.files.push(File { name: "cec.ini".to_owned(), axis: None, text, about });
        written.loading.push(format!(
            "MD18342 $MN_MM_CEC_MAX_POINTS of tables 0 to {}; then run cec.ini, SD41300 $SN_CEC_TABLE_ENABLE = 1 for each, \
             MD32710 $MA_CEC_ENABLE = 1, MD32711 $MA_CEC_SCALING_SYSTEM_METRIC = 1",
            index - 1
        ));
    }
}

fn write_screw(text: &mut String, control: &Sinumerik, effect: &Effect, base: f64) {
    let Some(name) = control.names.get(effect.source) else { return };
    let unit = control.unit(effect.source);
    // A degree is worth more than a millimetre: of 1 m from the axis, a millionth of it is 17 nm.
    let decimals = if unit > 1.0 { 8 } else { 6 };
    for (point, correction) in effect.mean().iter().enumerate() {
        let error = decimal(-(correction + base) * unit, decimals);
        let _ = writeln!(text, "$AA_ENC_COMP[0,{point},{name}]={error}");
    }
    for (key, value) in ["STEP", "MIN", "MAX"].into_iter().zip(reach(&effect.nodes, unit)) {
        let _ = writeln!(text, "$AA_ENC_COMP_{key}[0,{name}]={value}");
    }
    let modulo = u8::from(unit > 1.0 && is_a_turn(&effect.nodes));
    let _ = writeln!(text, "$AA_ENC_COMP_IS_MODULO[0,{name}]={modulo}");
}

fn write_table(text: &mut String, control: &Sinumerik, index: usize, table: &Table<'_>) {
    let name = |axis: usize| control.names.get(axis).map_or("", String::as_str);
    let unit = control.unit(table.input);
    // What another table is multiplied by is a number of its own, and no correction.
    let of_output = if table.is_factor { 1.0 } else { control.unit(table.output) };
    for (point, value) in table.values.iter().enumerate() {
        let _ = writeln!(text, "$AN_CEC[{index},{point}]={}", decimal(value * of_output, 9));
    }
    let _ = writeln!(text, "$AN_CEC_INPUT_AXIS[{index}]=({})", name(table.input));
    let _ = writeln!(text, "$AN_CEC_OUTPUT_AXIS[{index}]=({})", name(table.output));
    for (key, value) in ["STEP", "MIN", "MAX"].into_iter().zip(reach(table.nodes, unit)) {
        let _ = writeln!(text, "$AN_CEC_{key}[{index}]={value}");
    }
    let _ = writeln!(text, "$AN_CEC_DIRECTION[{index}]={}", table.direction);
    let _ = writeln!(text, "$AN_CEC_MULT_BY_TABLE[{index}]={}", table.by);
    let modulo = u8::from(unit > 1.0 && is_a_turn(table.nodes));
    let _ = writeln!(text, "$AN_CEC_IS_MODULO[{index}]={modulo}");
}

/// The step, the first and the last place, in the unit of the archive.
fn reach(nodes: &[f64], unit: f64) -> [String; 3] {
    let (Some(first), Some(last)) = (nodes.first(), nodes.last()) else { return Default::default() };
    let intervals = f64::from(u32::try_from(nodes.len().max(2) - 1).unwrap_or(u32::MAX));
    [(last - first) / intervals, *first, *last].map(|length| decimal(length * unit, 6))
}
