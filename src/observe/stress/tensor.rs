//! The stress at a point, and its scalars: a new one is a method here, and `output/stress.rs` lists those that files
//! hold.

use std::ops::{Add, AddAssign, Mul};

/// Sweeps of the Jacobi iteration: it converges quadratically, a matrix of order 3 in four or five.
const MOST_SWEEPS: usize = 12;

/// The stress at a point below the surface \[Pa\]: x1 and x2 as on the grid, x3 the depth. Tension is positive, so
/// that s33 at the surface is minus the contact pressure.
///
/// ```
/// use viscocontact::observe::Stress;
///
/// let stress = Stress::new([-1.0e6, -1.0e6, -3.0e6], [0.0; 3]);
/// assert_eq!(stress.principal(), [-1.0e6, -1.0e6, -3.0e6]);
/// assert_eq!(stress.tresca(), 2.0e6);
/// assert_eq!(stress.von_mises(), 2.0e6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[expect(clippy::exhaustive_structs, reason = "a symmetric tensor has six components")]
pub struct Stress {
    /// σ11.
    pub s11: f64,
    /// σ22.
    pub s22: f64,
    /// σ33, along the depth.
    pub s33: f64,
    /// σ12.
    pub s12: f64,
    /// σ13.
    pub s13: f64,
    /// σ23.
    pub s23: f64,
}

impl Stress {
    /// The stress with the normal components 11, 22, 33 and the shear components 12, 13, 23 \[Pa\].
    pub fn new(normal: [f64; 3], shear: [f64; 3]) -> Stress {
        let ([s11, s22, s33], [s12, s13, s23]) = (normal, shear);
        Stress { s11, s22, s33, s12, s13, s23 }
    }

    fn of(components: [f64; 6]) -> Stress {
        let [s11, s22, s33, s12, s13, s23] = components;
        Stress { s11, s22, s33, s12, s13, s23 }
    }

    /// The components 11, 22, 33, 12, 13, 23 \[Pa\].
    pub fn components(&self) -> [f64; 6] {
        [self.s11, self.s22, self.s33, self.s12, self.s13, self.s23]
    }

    /// The mean normal stress (σ11 + σ22 + σ33)/3 \[Pa\], negative in compression.
    pub fn mean(&self) -> f64 {
        (self.s11 + self.s22 + self.s33) / 3.0
    }

    /// The von Mises stress √(½[(σ11 − σ22)² + (σ22 − σ33)² + (σ33 − σ11)²] + 3[σ12² + σ13² + σ23²]) \[Pa\].
    pub fn von_mises(&self) -> f64 {
        let [a, b, c] = [self.s11 - self.s22, self.s22 - self.s33, self.s33 - self.s11];
        let shear = self.s12 * self.s12 + self.s13 * self.s13 + self.s23 * self.s23;
        (0.5 * (a * a + b * b + c * c) + 3.0 * shear).sqrt()
    }

    /// The Tresca stress \[Pa\]: the difference of the largest and the smallest principal stress, twice the largest
    /// shear stress on any plane.
    pub fn tresca(&self) -> f64 {
        let [greatest, _, least] = self.principal();
        greatest - least
    }

    /// The principal stresses \[Pa\], the largest (most tensile) first.
    ///
    /// By Jacobi's rotations, which are right to rounding of the maximum component however close the principal
    /// stresses are. The formula by an arc cosine loses half of the digits where two of them coincide, as they do on
    /// the axis below every round contact.
    pub fn principal(&self) -> [f64; 3] {
        let mut diagonal = [self.s11, self.s22, self.s33];
        // the components 23, 13, 12: each opposite to the axis of its index
        let mut shear = [self.s23, self.s13, self.s12];
        for _ in 0..MOST_SWEEPS {
            if shear == [0.0; 3] {
                break;
            }
            for axis in 0..3 {
                let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
                let off = shear[axis];
                let difference = diagonal[q] - diagonal[p];
                // a rotation of a negligible component changes nothing
                if off == 0.0 || off.abs() < f64::EPSILON * f64::EPSILON * difference.abs() {
                    shear[axis] = 0.0;
                    continue;
                }
                // the smaller root of t² + 2θt − 1 (J. H. Wilkinson, The Algebraic Eigenvalue Problem, 1965)
                let theta = 0.5 * difference / off;
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                (diagonal[p], diagonal[q]) = (diagonal[p] - t * off, diagonal[q] + t * off);
                let (of_q, of_p) = (shear[p], shear[q]);
                // shear[q] joins axis and p, shear[p] joins axis and q
                (shear[q], shear[p]) = (c * of_p - s * of_q, s * of_p + c * of_q);
                shear[axis] = 0.0;
            }
        }
        diagonal.sort_by(|a, b| b.total_cmp(a));
        diagonal
    }
}

impl Add for Stress {
    type Output = Stress;

    fn add(self, other: Stress) -> Stress {
        let (own, other) = (self.components(), other.components());
        Stress::of([0, 1, 2, 3, 4, 5].map(|k| own[k] + other[k]))
    }
}

impl AddAssign for Stress {
    fn add_assign(&mut self, other: Stress) {
        *self = *self + other;
    }
}

impl Mul<Stress> for f64 {
    type Output = Stress;

    fn mul(self, stress: Stress) -> Stress {
        Stress::of(stress.components().map(|component| self * component))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stress with these principal values, along axes turned by three angles.
    fn turned(principal: [f64; 3], angles: [f64; 3]) -> Stress {
        let mut m = [[principal[0], 0.0, 0.0], [0.0, principal[1], 0.0], [0.0, 0.0, principal[2]]];
        for (axis, angle) in angles.into_iter().enumerate() {
            let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
            let (s, c) = angle.sin_cos();
            for row in &mut m {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let [rows_p, rows_q] = [m[p], m[q]];
            m[p] = [0, 1, 2].map(|k| c * rows_p[k] - s * rows_q[k]);
            m[q] = [0, 1, 2].map(|k| s * rows_p[k] + c * rows_q[k]);
        }
        Stress::new([m[0][0], m[1][1], m[2][2]], [m[0][1], m[0][2], m[1][2]])
    }

    #[test]
    fn principal_stresses_of_turned_axes() {
        for principal in [
            [3.0, 1.0, -2.0],
            [1.0, 1.0, -1.0],
            [1.0, 1.0 - 1e-9, -1.0],
            [2.0, -1.0, -1.0 - 1e-13],
            [5.0, 5.0, 5.0],
            [1.0, 1e-12, -1e-12],
            [0.0, 0.0, -1.0],
        ] {
            for angles in [[0.0; 3], [0.3, 0.0, 0.0], [0.7, -1.2, 2.1], [1e-9, 0.5, 3.0], [0.785, 0.785, 0.785]] {
                let stress = turned(principal, angles);
                let found = stress.principal();
                for (found, exact) in found.iter().zip(principal) {
                    assert!((found - exact).abs() < 4e-15 * 5.0, "{principal:?} {angles:?}: {found:e}");
                }
                let [a, b, c] = principal;
                assert!((stress.tresca() - (a - c)).abs() < 1e-14);
                let mises = (0.5 * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2))).sqrt();
                assert!((stress.von_mises() - mises).abs() < 2e-14, "{mises}");
                assert!((stress.mean() - (a + b + c) / 3.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn extreme_and_missing_values_do_not_hang() {
        assert!(Stress::new([f64::NAN; 3], [1.0; 3]).principal().iter().any(|value| value.is_nan()));
        let pure = Stress::new([0.0; 3], [1e-300, 0.0, 0.0]);
        assert_eq!(pure.principal(), [1e-300, 0.0, -1e-300]);
        assert_eq!(Stress::default().principal(), [0.0; 3]);
    }

    #[test]
    fn stresses_add_up() {
        let stress = Stress::new([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]);
        assert_eq!((2.0 * stress + stress).components(), [3.0, 6.0, 9.0, 12.0, 15.0, 18.0]);
    }
}
