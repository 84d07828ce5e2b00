//! How a part lies on the machine that measures it.
//!
//! In: places of the part's frame. Out: where the measuring machine finds them. A part that is clamped anew lies displaced and turned
//! against its frame, and that says nothing of the machine it was made on.

use nalgebra::{Rotation3, Vector3};

/// The part lies turned about the origin of its frame, and then displaced.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Datum {
    /// Along X, Y and Z, mm.
    pub displacement: [f64; 3],
    /// The rotation vector, right-handed, rad: small angles are those about X, Y and Z.
    pub rotation: [f64; 3],
}

impl Datum {
    /// Where a place of the part is found, mm.
    pub(crate) fn found(&self, place: Vector3<f64>) -> Vector3<f64> {
        Rotation3::from_scaled_axis(Vector3::from(self.rotation)) * place + Vector3::from(self.displacement)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_turned_right_handed_and_then_displaced() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let datum = Datum { displacement: [0.0, 0.5, -1.0], rotation: [0.0, 0.0, quarter] };
        let found = datum.found(Vector3::new(100.0, 20.0, 7.0));
        assert!((found - Vector3::new(-20.0, 100.5, 6.0)).norm() < 1e-12, "{found}");
        assert_eq!(Datum::default().found(Vector3::new(1.0, 2.0, 3.0)), Vector3::new(1.0, 2.0, 3.0));
    }
}
