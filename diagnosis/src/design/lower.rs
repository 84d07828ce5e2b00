//! Products of columns with one another: the half of a symmetric matrix below its diagonal.
//!
//! In: columns, stretch by stretch, with their places among all columns; those that are zero everywhere need not come. Out: the
//! matrix of the products of all of them. The half above the diagonal has the same numbers and is copied at the end; the half
//! below is worked out in strips, which do not depend on one another.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::course::{STRETCH, pieces};
use crate::parallel;

/// Sums of products.
pub(crate) struct Lower {
    /// The products of all columns, but for those of the present ones.
    whole: DMatrix<f64>,
    /// The places of the columns that come at present.
    places: Vec<usize>,
    strips: Vec<Strip>,
}

/// The products of a range of the present columns with all from its first one on.
struct Strip {
    across: Range<usize>,
    products: DMatrix<f64>,
}

/// Columns in a strip: few enough that the half below the diagonal is little more than half the work, and enough that each column
/// is read seldom.
const STRIP: usize = 32;

/// Products of so few columns are summed up in another way, by which the last digit may differ.
pub(super) const NARROW: usize = 5;

impl Lower {
    /// Nothing added yet.
    pub(crate) fn new(size: usize) -> Self {
        Self { whole: DMatrix::zeros(size, size), places: Vec::new(), strips: Vec::new() }
    }

    /// Adds the products of some rows of the columns at these places, in their order, one stretch after another.
    pub(crate) fn add(&mut self, columns: &DMatrix<f64>, places: &[usize]) {
        if self.places != places {
            self.put_back();
            self.pick(places);
        }
        let stretches: Vec<DMatrix<f64>> =
            pieces(0..columns.nrows(), STRETCH).map(|rows| transposed(columns, rows)).collect();
        parallel::each(&mut self.strips, columns.len() * STRIP, |strip| {
            let mut from = 0;
            for stretch in &stretches {
                let down = stretch.rows(strip.across.start, strip.products.nrows());
                let corner = (from, strip.across.start);
                let across = columns.view(corner, (stretch.ncols(), strip.across.len()));
                strip.products.gemm(1.0, &down, &across, 1.0);
                from += stretch.ncols();
            }
        });
    }

    /// The whole matrix; sums begin anew.
    pub(crate) fn take(&mut self) -> DMatrix<f64> {
        self.put_back();
        let size = self.whole.nrows();
        let mut taken = std::mem::replace(&mut self.whole, DMatrix::zeros(size, size));
        taken.fill_upper_triangle_with_lower_triangle();
        for strip in &mut self.strips {
            strip.products.fill(0.0);
        }
        taken
    }

    /// Puts the products of the present columns where they belong.
    fn put_back(&mut self) {
        for strip in &self.strips {
            for (column, across) in strip.across.clone().enumerate() {
                for row in column..strip.products.nrows() {
                    let place = (self.places[strip.across.start + row], self.places[across]);
                    self.whole[place] = strip.products[(row, column)];
                }
            }
        }
    }

    /// Goes on with columns at other places.
    fn pick(&mut self, places: &[usize]) {
        let of = |(row, column): (usize, usize)| {
            let (row, column) = (places[row], places[column]);
            self.whole[(row.max(column), row.min(column))]
        };
        let strip = |across: Range<usize>| {
            let first = across.start;
            let products = DMatrix::from_fn(places.len() - first, across.len(), |row, column| {
                of((first + row, first + column))
            });
            Strip { across, products }
        };
        self.strips = strips(places.len()).map(strip).collect();
        self.places = places.to_vec();
    }
}

/// Ranges of columns. None is shorter than the others but a single one, so that none is narrow where the whole is not.
fn strips(size: usize) -> impl Iterator<Item = Range<usize>> {
    let count = (size / STRIP).max(1);
    let end = move |number: usize| if number + 1 == count { size } else { (number + 1) * STRIP };
    (0..count).map(move |number| number * STRIP..end(number))
}

/// Some rows as columns. Eight rows at a time: what is read and what is written then both stay at hand.
fn transposed(columns: &DMatrix<f64>, rows: Range<usize>) -> DMatrix<f64> {
    let (height, width) = (columns.nrows(), columns.ncols());
    let mut transposed = DMatrix::zeros(width, rows.len());
    for (eight, from) in transposed.as_mut_slice().chunks_mut(8 * width).zip(rows.step_by(8)) {
        for (number, column) in columns.as_slice().chunks_exact(height).enumerate() {
            for (row, value) in eight.chunks_exact_mut(width).zip(&column[from..]) {
                row[number] = *value;
            }
        }
    }
    transposed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normals;

    /// Numbers of all sizes.
    fn columns(rows: usize, size: usize) -> DMatrix<f64> {
        let values = normals(5, rows * size);
        let scale = |column: usize| 10_f64.powi(i32::try_from(column % 7).unwrap() - 3);
        DMatrix::from_fn(rows, size, |row, column| values[row * size + column] * scale(column))
    }

    /// Adds the products of all columns at once, stretch by stretch.
    fn add(whole: &mut DMatrix<f64>, columns: &DMatrix<f64>) {
        for stretch in pieces(0..columns.nrows(), STRETCH) {
            let part = columns.rows(stretch.start, stretch.len()).into_owned();
            whole.gemm(1.0, &part.transpose(), &part, 1.0);
        }
    }

    #[test]
    fn strips_give_the_bits_of_the_whole_product() {
        for (rows, size) in [(1000, 3), (700, 7), (256, 31), (5, 40), (600, 65), (513, 100), (2000, 131)] {
            let columns = columns(rows, size);
            let places: Vec<usize> = (0..size).collect();
            let (mut lower, mut whole) = (Lower::new(size), DMatrix::zeros(size, size));
            for _ in 0..2 {
                lower.add(&columns, &places);
                add(&mut whole, &columns);
            }
            assert_eq!(lower.take(), whole, "{rows} rows, {size} columns");
            assert_eq!(lower.take(), DMatrix::zeros(size, size));
            lower.add(&columns, &places);
            let mut again = DMatrix::zeros(size, size);
            add(&mut again, &columns);
            assert_eq!(lower.take(), again, "sums begin anew");
        }
    }

    #[test]
    fn columns_that_are_zero_need_not_come() {
        let (rows, size) = (700, 90);
        let columns = columns(rows, size);
        let (mut lower, mut whole) = (Lower::new(size), DMatrix::zeros(size, size));
        for every in [3, 2, 5, 1, 3] {
            let places: Vec<usize> = (0..size).filter(|column| column % every == 0).collect();
            lower.add(&columns.select_columns(&places), &places);
            let zeroed =
                DMatrix::from_fn(
                    rows,
                    size,
                    |row, column| if column % every == 0 { columns[(row, column)] } else { 0.0 },
                );
            add(&mut whole, &zeroed);
        }
        assert_eq!(lower.take(), whole);
    }

    #[test]
    fn rows_become_columns() {
        for (rows, size) in [(1, 1), (8, 3), (23, 7), (300, 12)] {
            let columns = columns(rows, size);
            assert_eq!(transposed(&columns, 0..rows), columns.transpose());
            assert_eq!(transposed(&columns, rows / 3..rows), columns.rows_range(rows / 3..).transpose());
        }
    }
}
