//! Tables side by side.
//!
//! In: random tables with the same nodes, and positions on and off them. Out: a bundle that reads what its tables read, to the last
//! bit; refusals of what does not lie side by side.

use abbe_runtime::{
    Bundle, Compensator, Direction, ErrorMotion, ErrorMotions, Kinematics, MotionReader, Sample, Table,
    TableError, Term, TermState, Values, Work,
};
use proptest::prelude::*;

/// A machine of two axes whose error is its three error motions.
struct Three;

impl Kinematics for Three {
    fn axes(&self) -> usize {
        2
    }

    fn travels(&self) -> &[usize] {
        &[]
    }

    fn motions(&self) -> usize {
        3
    }

    fn error(&self, _position: &[f64], _travel: &[f64], motions: &[f64]) -> [f64; 3] {
        motions.try_into().unwrap_or([f64::NAN; 3])
    }

    fn directions(&self, _position: &[f64], directions: &mut [[f64; 3]]) {
        directions.fill([0.0; 3]);
    }
}

/// Three error motions of one table each, read side by side.
struct Beside<'a, const ROWS: usize> {
    bundle: Bundle<3, ROWS>,
    motions: [ErrorMotion<'a>; 3],
}

impl<const ROWS: usize> ErrorMotions for Beside<'_, ROWS> {
    type Values<'k> = [f64; 3];

    fn motions(&self) -> &[ErrorMotion<'_>] {
        &self.motions
    }

    fn read(&self, mut from: MotionReader<'_>, _kept: &mut [f64]) -> Option<[f64; 3]> {
        let values = from.bundle(&self.bundle)?;
        Some(values.map(|value| from.known(value)))
    }
}

/// The error of three motions at a place, by bits.
fn error<M: ErrorMotions + ?Sized>(motions: &M, position: [f64; 2], direction: [Direction; 2]) -> [u64; 3] {
    let (mut states, mut directions, mut values) = ([TermState::default(); 3], [[0.0; 3]; 2], [0.0; 3]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let mut compensator = Compensator::with_calibration(&Three, motions, &mut states, work).unwrap();
    let sample = Sample {
        position: &position,
        travel: &[],
        direction: &direction,
        velocity: &[],
        temperature: &[],
        time_step: 0.001,
    };
    compensator.error(&sample).unwrap().map(f64::to_bits)
}

/// Tables over one axis.
#[derive(Clone, Debug)]
struct Tables {
    axis: usize,
    start: f64,
    step: f64,
    /// For each its curves, and whether there are two.
    curves: [(Vec<f64>, Vec<f64>, bool); 3],
}

impl Tables {
    fn any(nodes: usize) -> impl Strategy<Value = Self> {
        let curve = || prop::collection::vec(-1.0..1.0_f64, nodes);
        let curves = prop::array::uniform3((curve(), curve(), any::<bool>()));
        let step = (0.5..40.0_f64, any::<bool>()).prop_map(|(step, falls)| if falls { -step } else { step });
        (0..2_usize, -90.0..90.0_f64, step, curves).prop_map(|(axis, start, step, curves)| Self {
            axis,
            start,
            step,
            curves,
        })
    }

    fn terms(&self) -> [Term<'_>; 3] {
        self.curves.each_ref().map(|(forward, reverse, directed)| {
            let values =
                if *directed { Values::Directed { forward, reverse } } else { Values::Both(forward) };
            Term::Table { axis: self.axis, table: Table::uniform(self.start, self.step, values).unwrap() }
        })
    }

    /// Whether a bundle reads at a place what its tables read.
    fn agree<const ROWS: usize>(&self, position: [f64; 2], direction: [Direction; 2]) -> bool {
        let terms = self.terms();
        let motions = terms.each_ref().map(|term| ErrorMotion { terms: std::slice::from_ref(term) });
        let bundle: Bundle<3, ROWS> = Bundle::new(terms.each_ref()).unwrap();
        let beside = Beside { bundle, motions };
        error(&beside, position, direction) == error(&motions[..], position, direction)
    }

    /// A position that lies so many steps behind the first node, on each axis.
    fn at(&self, steps: f64, other: f64) -> [f64; 2] {
        let mut position = [other; 2];
        position[self.axis] = self.start + steps * self.step;
        position
    }
}

fn directions() -> impl Strategy<Value = [Direction; 2]> {
    prop::array::uniform2(prop_oneof![Just(Direction::Positive), Just(Direction::Negative)])
}

/// Steps behind the first of four nodes: between nodes, on them, beyond them and far away.
fn steps() -> impl Strategy<Value = f64> {
    prop_oneof![-1.0..4.0_f64, (-1..5_i32).prop_map(f64::from), Just(-1e300), Just(1e300)]
}

proptest! {
    #[test]
    fn a_bundle_reads_what_its_tables_read(
        tables in Tables::any(4), steps in steps(), other in -50.0..50.0_f64, directions in directions(),
    ) {
        prop_assert!(tables.agree::<4>(tables.at(steps, other), directions));
    }

    #[test]
    fn so_does_one_of_a_single_node(
        tables in Tables::any(1), steps in steps(), other in -50.0..50.0_f64, directions in directions(),
    ) {
        prop_assert!(tables.agree::<1>(tables.at(steps, other), directions));
    }
}

#[test]
fn what_does_not_lie_side_by_side_is_refused() {
    let values = &[0.0, 0.002, 0.003];
    let uniform = |axis, start, step, values| Term::Table {
        axis,
        table: Table::uniform(start, step, Values::Both(values)).unwrap(),
    };
    let first = uniform(0, 10.0, 50.0, values);
    let listed =
        Term::Table { axis: 0, table: Table::at(&[10.0, 60.0, 110.0], Values::Both(values)).unwrap() };
    let pair = |other: &Term<'_>| Bundle::<2, 3>::new([&first, other]).map(|_| ());
    assert_eq!(pair(&uniform(0, 10.0, 50.0, &[1.0; 3])), Ok(()));
    for other in [
        uniform(1, 10.0, 50.0, values),
        uniform(0, 10.5, 50.0, values),
        uniform(0, 10.0, 50.5, values),
        uniform(0, 10.0, 50.0, &values[..2]),
        listed,
        Term::Constant { value: 0.001 },
    ] {
        assert_eq!(pair(&other), Err(TableError::Unlike { index: 1 }), "{other:?}");
    }
    assert_eq!(Bundle::<1, 3>::new([&listed]), Err(TableError::Unlike { index: 0 }));
    assert_eq!(Bundle::<1, 2>::new([&first]), Err(TableError::Lengths { expected: 3, found: 2 }));
    assert_eq!(Bundle::<1, 4>::new([&first]), Err(TableError::Lengths { expected: 3, found: 4 }));
    assert_eq!(Bundle::<0, 3>::new([]), Err(TableError::Empty));
}
