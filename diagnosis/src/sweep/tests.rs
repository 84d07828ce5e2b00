//! Sweeping against least squares by singular values.

use nalgebra::DVector;

use super::*;
use crate::testing::normals;

const ROWS: usize = 60;

/// Columns of very different length, the last but one the sum of two others; and a response.
fn columns() -> DMatrix<f64> {
    let numbers = normals(31, ROWS * 7);
    let scales = [1.0, 1e-6, 300.0, 0.02, 5.0, 1.0, 1.0];
    let mut columns = DMatrix::from_fn(ROWS, 7, |row, column| numbers[column * ROWS + row] * scales[column]);
    let sum = columns.column(0) * 2.0 - columns.column(2);
    columns.set_column(5, &sum);
    let response = columns.column(6) + columns.column(0) * 1.5 + columns.column(3) * 40.0;
    columns.set_column(6, &response);
    columns
}

fn swept() -> Swept {
    let columns = columns();
    Swept::new(&(columns.transpose() * &columns))
}

/// Coefficients and remaining sum of squares of the response on these columns.
fn least_squares(of: &[usize]) -> (DVector<f64>, f64) {
    let all = columns();
    let (design, response) = (all.select_columns(of), all.column(6).into_owned());
    let lengths: Vec<f64> = design.column_iter().map(|column| column.norm()).collect();
    let unit = DMatrix::from_fn(ROWS, of.len(), |row, column| design[(row, column)] / lengths[column]);
    let scaled = unit.svd(true, true).solve(&response, 1e-12).unwrap();
    let coefficients = DVector::from_fn(of.len(), |row, _| scaled[row] / lengths[row]);
    let left = &response - &design * &coefficients;
    (coefficients, left.norm_squared())
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-8 * a.abs().max(b.abs()) + 1e-12
}

#[test]
fn coefficients_and_remainder_are_those_of_least_squares() {
    let mut swept = swept();
    let mut taken = Vec::new();
    for column in [2, 0, 4, 1, 3] {
        assert!(swept.take(column));
        taken.push(column);
        let (coefficients, left) = least_squares(&taken);
        for (place, column) in taken.iter().enumerate() {
            assert!(near(swept.coefficient(*column), coefficients[place]), "{column} of {taken:?}");
        }
        assert!(near(swept.remaining(), left));
    }
    swept.drop(0);
    let (coefficients, left) = least_squares(&[2, 4, 1, 3]);
    assert!(near(swept.coefficient(3), coefficients[3]) && near(swept.remaining(), left));
    assert_eq!(swept.coefficient(0), 0.0);
}

#[test]
fn the_covariance_is_the_inverse_of_the_products() {
    let mut swept = swept();
    let of = [0, 1, 3, 4];
    of.iter().for_each(|column| assert!(swept.take(*column)));
    let design = columns().select_columns(&of);
    let inverse = (design.transpose() * &design).try_inverse().unwrap();
    for (row, a) in of.iter().enumerate() {
        for (column, b) in of.iter().enumerate() {
            assert!(near(swept.covariance(*a, *b), inverse[(row, column)]), "{a} {b}");
        }
    }
    assert_eq!(swept.covariance(0, 2), 0.0);
}

#[test]
fn what_others_hold_is_not_taken() {
    let mut swept = swept();
    assert!(swept.take(0) && swept.take(2));
    let before = swept.remaining();
    assert!(swept.independence(5) < 1e-12);
    assert!(!swept.take(5) && !swept.has(5));
    assert_eq!((swept.remaining(), swept.coefficient(5)), (before, 0.0));
    assert_eq!(swept.promise(&[5]), (0.0, 0));
    // A column of nothing and one that is taken already are not taken either.
    assert!(!swept.take(0));
    let zero = DMatrix::from_diagonal(&DVector::from_vec(vec![0.0, 1.0, 1.0]));
    let mut swept = Swept::new(&zero);
    assert!(!swept.take(0) && swept.take(1));
}

#[test]
fn dropping_undoes_taking() {
    let mut swept = swept();
    swept.take(3);
    let before = swept.clone();
    for column in [1, 4, 0] {
        swept.take(column);
    }
    for column in [4, 0, 1] {
        swept.drop(column);
    }
    assert!((&swept.matrix - &before.matrix).amax() < 1e-10 * before.matrix.amax());
    assert_eq!(swept.taken, before.taken);
    swept.drop(1);
    assert_eq!(swept.taken, before.taken, "what is not in cannot be dropped");
}

#[test]
fn promise_and_worth_are_what_taking_and_dropping_do() {
    let groups: [&[usize]; 6] = [&[0], &[3], &[0, 3], &[1, 2, 4], &[0, 2, 5], &[5, 0, 1, 2]];
    for inside in [vec![], vec![4], vec![1, 3]] {
        let mut start = swept();
        inside.iter().for_each(|column| assert!(start.take(*column)));
        for group in groups {
            if group.iter().any(|column| inside.contains(column)) {
                continue;
            }
            let mut taken = start.clone();
            let rank = group.iter().filter(|column| taken.take(**column)).count();
            let (gain, promised) = start.promise(group);
            assert!(near(gain, start.remaining() - taken.remaining()), "{group:?} beside {inside:?}");
            assert_eq!(promised, rank, "{group:?} beside {inside:?}");
            assert!(
                near(taken.worth(group), start.remaining() - taken.remaining()),
                "{group:?} in {inside:?}"
            );
        }
    }
    assert_eq!(swept().promise(&[]), (0.0, 0));
    assert_eq!(swept().worth(&[0, 1]), 0.0, "what is not in is worth nothing");
}

#[test]
fn independence_likeness_and_sign_are_of_what_the_others_leave() {
    let mut swept = swept();
    swept.take(0);
    swept.take(3);
    let all = columns();
    let rest = |column: usize| {
        let base = all.select_columns(&[0, 3]);
        let of = all.column(column).into_owned();
        let fit = base.clone().svd(true, true).solve(&of, 1e-14).unwrap();
        of - base * fit
    };
    for (a, b) in [(1, 2), (2, 4), (2, 5)] {
        let (x, y) = (rest(a), rest(b));
        assert!(near(swept.independence(a), x.norm_squared() / all.column(a).norm_squared()), "{a}");
        assert!((swept.likeness(a, b) - x.dot(&y) / (x.norm() * y.norm())).abs() < 1e-9, "{a} {b}");
    }
    let mut with = swept.clone();
    assert!(with.take(4));
    assert_eq!(swept.sign(4), with.coefficient(4).signum());
}

#[test]
fn energy_is_the_length_of_a_sum_as_far_as_the_swept_columns_leave_it() {
    let mut swept = swept();
    swept.take(0);
    swept.take(3);
    let all = columns();
    let of = [1, 2, 4];
    let coefficients = [7e5, -0.02, 1.5];
    let sum = all.select_columns(&of) * DVector::from_row_slice(&coefficients);
    let base = all.select_columns(&[0, 3]);
    let left = &sum - &base * base.clone().svd(true, true).solve(&sum, 1e-14).unwrap();
    assert!(near(swept.energy(&of, &coefficients), left.norm_squared()));
}

#[test]
fn the_determinant_is_that_of_the_columns_that_are_in() {
    let all = columns();
    let mut swept = swept();
    assert_eq!(swept.log_determinant(), 0.0);
    let of = |columns: &[usize]| {
        let chosen = all.select_columns(columns);
        let lengths: Vec<f64> = chosen.column_iter().map(|column| column.norm()).collect();
        let unit =
            DMatrix::from_fn(ROWS, columns.len(), |row, column| chosen[(row, column)] / lengths[column]);
        let sizes: f64 = lengths.iter().map(|length| 2.0 * length.ln()).sum();
        (unit.transpose() * unit).determinant().ln() + sizes
    };
    for column in [0, 1, 3] {
        swept.take(column);
    }
    assert!(near(swept.log_determinant(), of(&[0, 1, 3])));
    swept.drop(1);
    assert!(near(swept.log_determinant(), of(&[0, 3])));
    // A column that the others hold is not taken in.
    swept.take(2);
    swept.take(5);
    assert!(near(swept.log_determinant(), of(&[0, 2, 3])));
}
