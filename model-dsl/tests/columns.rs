//! Whole columns against single rows. In: the shipped machines, every pair of axes as a topology word, and random
//! positions. Out: that both ways give the same bits, and what columns of unlike lengths give.

#![expect(
    clippy::unwrap_used,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

use std::path::Path;

use abbe_model_dsl::diagnostic::Diagnostics;
use abbe_model_dsl::equations::Equations;
use abbe_model_dsl::program::Interpreter;
use abbe_model_dsl::source::SourceFile;
use abbe_model_dsl::{compile, compile_word};
use proptest::prelude::*;

/// The shipped machines, and words in which rotary axes stand on either side.
fn machines() -> Vec<Equations> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let shipped = paths.into_iter().map(|path| {
        let source = SourceFile::new("machine.yaml", std::fs::read_to_string(path).unwrap());
        compile(&source, &mut Diagnostics::new()).unwrap().equations
    });
    let words = ["FX", "FC", "CFX", "BCFXYZA"];
    let words = words.map(|word| compile_word(word, &mut Diagnostics::new()).unwrap().equations);
    shipped.chain(words).collect()
}

/// Columns cut from one stream of numbers.
fn columns(numbers: &[f64], count: usize, rows: usize, skip: usize) -> Vec<Vec<f64>> {
    let mut stream = numbers.iter().copied().cycle().skip(skip);
    (0..count).map(|_| stream.by_ref().take(rows).collect()).collect()
}

fn row(columns: &[Vec<f64>], number: usize) -> Vec<f64> {
    columns.iter().map(|column| column[number]).collect()
}

fn slices(columns: &[Vec<f64>]) -> Vec<&[f64]> {
    columns.iter().map(Vec::as_slice).collect()
}

fn bits(values: [f64; 3]) -> [u64; 3] {
    values.map(f64::to_bits)
}

fn bits_of_row(columns: &[Vec<f64>; 3], number: usize) -> [u64; 3] {
    columns.each_ref().map(|column| column[number].to_bits())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn columns_have_the_bits_of_rows(numbers in prop::collection::vec(-700.0..700.0_f64, 97), rows in 1..40_usize) {
        for equations in machines() {
            let constants: Vec<f64> = numbers.iter().copied().take(equations.constants.len()).collect();
            let interpreter = Interpreter::new(&equations, &constants);
            let positions = columns(&numbers, equations.axes.len(), rows, 11);
            let travels = columns(&numbers, equations.travels.len(), rows, 5);
            let (position_slices, travel_slices) = (slices(&positions), slices(&travels));
            let nominal = interpreter.nominal_columns(&position_slices);
            let levers = interpreter.lever_columns(&position_slices, &travel_slices);
            let turns = interpreter.turn_columns(&position_slices, &travel_slices);
            prop_assert_eq!((levers.len(), turns.len()), (equations.motions.len(), equations.motions.len()));
            let values = interpreter.lever_values(&position_slices, &travel_slices);
            for (triple, levers) in values.iter().zip(&levers) {
                for (column, lever) in triple.iter().zip(levers) {
                    prop_assert!((0..rows).all(|row| column.at(row).to_bits() == lever[row].to_bits()));
                }
            }
            let written: Vec<_> = values.into_iter().map(|triple| triple.map(|column| column.written_out(rows))).collect();
            prop_assert_eq!(&written, &levers);
            for number in 0..rows {
                let (position, travel) = (row(&positions, number), row(&travels, number));
                prop_assert_eq!(bits_of_row(&nominal, number), bits(interpreter.nominal(&position)));
                for (columns, lever) in levers.iter().zip(interpreter.levers(&position, &travel)) {
                    prop_assert_eq!(bits_of_row(columns, number), bits(lever));
                }
                for (columns, turn) in turns.iter().zip(interpreter.turns(&position, &travel)) {
                    prop_assert_eq!(bits_of_row(columns, number), bits(turn));
                }
            }
        }
    }
}

#[test]
fn every_column_has_all_rows_even_where_nothing_changes() {
    let stage = compile_word("FX", &mut Diagnostics::new()).unwrap().equations;
    let interpreter = Interpreter::new(&stage, &[0.0, 0.0, 5.0]);
    let levers = interpreter.lever_columns(&[&[1.0, 2.0, 3.0, 4.0]], &[]);
    let pitch = stage.motions.iter().position(|motion| motion.name == "EBX").unwrap();
    assert_eq!(levers[pitch], [vec![5.0; 4], vec![0.0; 4], vec![0.0; 4]]);
    assert_eq!(interpreter.nominal_columns(&[&[1.0, 2.0]]), [vec![1.0, 2.0], vec![0.0; 2], vec![5.0; 2]]);
}

#[test]
fn what_a_column_lacks_is_no_number() {
    let mill = compile_word("XFY", &mut Diagnostics::new()).unwrap().equations;
    let interpreter = Interpreter::new(&mill, &[0.0; 3]);
    let [x, y, _] = interpreter.nominal_columns(&[&[1.0, 2.0], &[7.0]]);
    assert_eq!(x, [1.0, 2.0]);
    assert!(y[0] == 7.0 && y[1].is_nan());
    let [x, y, _] = interpreter.nominal_columns(&[&[1.0, 2.0]]);
    assert_eq!(x, [1.0, 2.0]);
    assert!(y.iter().all(|value| value.is_nan()) && y.len() == 2);
    assert_eq!(interpreter.nominal_columns(&[]), [const { Vec::new() }; 3]);
}
