//! Homogeneous transformation matrices (HTMs) over the first-order ring.
//!
//! In: translations, large rotations (exact sine and cosine) and small rotations. Out:
//! products and inverses to first order. `a.then(&b)` is the matrix product `A B`: the frame
//! of `b` seen from the frame that `a` is seen from, read as `T_0b = T_0a T_ab`.

use super::{FirstOrder, Name, Polynomial, Rational, Symbol, sine_and_cosine};

/// A coordinate direction of a frame, or the rotation about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// The first direction.
    X,
    /// The second direction.
    Y,
    /// The third direction.
    Z,
}

impl Axis {
    /// The three directions in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }

    /// The next direction in the cycle X, Y, Z, X: `a` and `a.next()` turn into `a.next().next()`.
    pub fn next(self) -> Self {
        match self {
            Self::X => Self::Y,
            Self::Y => Self::Z,
            Self::Z => Self::X,
        }
    }

    /// `X`, `Y` or `Z`.
    pub fn letter(self) -> char {
        match self {
            Self::X => 'X',
            Self::Y => 'Y',
            Self::Z => 'Z',
        }
    }

    /// The letter of a direction vector's part along this direction, as programs of controllers have it: `I`, `J` or `K`.
    pub fn direction_letter(self) -> char {
        match self {
            Self::X => 'I',
            Self::Y => 'J',
            Self::Z => 'K',
        }
    }

    /// The letter of the rotation about this direction: `A`, `B` or `C`.
    pub fn rotation_letter(self) -> char {
        match self {
            Self::X => 'A',
            Self::Y => 'B',
            Self::Z => 'C',
        }
    }
}

type Matrix = [[FirstOrder; 3]; 3];
type Vector = [FirstOrder; 3];

/// A rigid displacement to first order: a rotation and a translation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Htm {
    rotation: Matrix,
    translation: Vector,
}

impl Htm {
    /// No displacement.
    pub fn identity() -> Self {
        Self { rotation: identity(), translation: Vector::default() }
    }

    /// A pure translation.
    pub fn translation(translation: Vector) -> Self {
        Self { rotation: identity(), translation }
    }

    /// A large rotation about one direction by the position `name` of a rotary axis,
    /// counted with `sign` (+1 right-handed, -1 left-handed); sine and cosine stay exact.
    pub fn rotation(axis: Axis, name: &Name, sign: i64) -> Self {
        let cosine = Polynomial::symbol(Symbol::Cos(name.clone()));
        let sine = &Polynomial::symbol(Symbol::Sin(name.clone())) * &Polynomial::integer(sign);
        Self::turned_by(axis, sine, cosine)
    }

    /// A rotation about one direction by an angle that never changes: deg, right-handed.
    pub fn fixed_rotation(axis: Axis, degrees: &Rational) -> Self {
        let (sine, cosine) = sine_and_cosine(degrees);
        Self::turned_by(axis, sine, cosine)
    }

    fn turned_by(axis: Axis, sine: Polynomial, cosine: Polynomial) -> Self {
        let (sine, cosine) = (FirstOrder::nominal(sine), FirstOrder::nominal(cosine));
        let (u, v) = (axis.next().index(), axis.next().next().index());
        let mut rotation = identity();
        rotation[u][u] = cosine.clone();
        rotation[v][v] = cosine;
        rotation[u][v] = -&sine;
        rotation[v][u] = sine;
        Self { rotation, translation: Vector::default() }
    }

    /// A small displacement: first-order rotations about X, Y, Z (right-handed, the active
    /// sense: `1 + [e]x`, equation (3-9) of the Excello report) and a translation.
    pub fn small(rotations: Vector, translation: Vector) -> Self {
        let mut rotation = identity();
        for axis in Axis::ALL {
            let (u, v) = (axis.next().index(), axis.next().next().index());
            let angle = &rotations[axis.index()];
            rotation[u][v] = &rotation[u][v] + &-angle;
            rotation[v][u] = &rotation[v][u] + angle;
        }
        Self { rotation, translation }
    }

    /// The product `self other`: first-order, exact in the nominal part.
    pub fn then(&self, other: &Self) -> Self {
        let rotation = std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                sum_of_three(|k| &self.rotation[row][k] * &other.rotation[k][column])
            })
        });
        Self { rotation, translation: self.place(&other.translation) }
    }

    /// The inverse: the transposed rotation, and the translation turned back.
    pub fn inverse(&self) -> Self {
        let rotation: Matrix =
            std::array::from_fn(|row| std::array::from_fn(|column| self.rotation[column][row].clone()));
        let back = Self { rotation, translation: Vector::default() };
        let translation = back.place(&self.translation).each_ref().map(|entry| -entry);
        Self { translation, ..back }
    }

    /// Where a point given in the inner frame stands in the outer one.
    pub fn place(&self, point: &Vector) -> Vector {
        let carried = self.carry(point);
        std::array::from_fn(|row| &carried[row] + &self.translation[row])
    }

    /// A vector of the inner frame in the outer one, which has no place: a direction.
    pub fn carry(&self, vector: &Vector) -> Vector {
        std::array::from_fn(|row| sum_of_three(|k| &self.rotation[row][k] * &vector[k]))
    }

    /// A small vector of the inner frame, all of it error, in the directions of the outer one.
    pub fn turned(&self, small: &Vector) -> Vector {
        let nominal = self.rotation.each_ref().map(|row| row.each_ref().map(undisturbed));
        std::array::from_fn(|row| sum_of_three(|k| &nominal[row][k] * &small[k]))
    }

    /// The position of the inner origin in the outer frame.
    pub fn origin(&self) -> &Vector {
        &self.translation
    }

    /// The small rotation of the inner frame by the errors, as a vector in the outer frame: rad about X, Y, Z,
    /// right-handed, the skew part of `dR transpose(R)`. It has no nominal part.
    pub fn turn(&self) -> Vector {
        let back = self.rotation.each_ref().map(|row| row.each_ref().map(undisturbed));
        Axis::ALL.map(|about| {
            let (u, v) = (about.next().index(), about.next().next().index());
            // Its nominal part vanishes by itself: rows of an exact rotation are at right angles.
            sum_of_three(|k| &self.rotation[v][k] * &back[u][k])
        })
    }

    /// The entry of the 4x4 matrix, rows and columns from 0; `None` outside it.
    pub fn entry(&self, row: usize, column: usize) -> Option<FirstOrder> {
        match (row, column) {
            (0..=2, 0..=2) => Some(self.rotation[row][column].clone()),
            (0..=2, 3) => Some(self.translation[row].clone()),
            (3, 0..=2) => Some(FirstOrder::default()),
            (3, 3) => Some(FirstOrder::nominal(Polynomial::one())),
            _ => None,
        }
    }
}

/// The same without errors.
fn undisturbed(entry: &FirstOrder) -> FirstOrder {
    FirstOrder::nominal(entry.nominal_part().clone())
}

fn identity() -> Matrix {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| FirstOrder::nominal(Polynomial::integer(i64::from(row == column))))
    })
}

fn sum_of_three(entry: impl Fn(usize) -> FirstOrder) -> FirstOrder {
    &(&entry(0) + &entry(1)) + &entry(2)
}
