//! The shape of the bodies: the gap between them before they deform.
//!
//! | shape | initial gap |
//! |---|---|
//! | [`Sphere`] | (x1² + x2²) / 2R |
//! | [`Ellipsoid`] | x1²/2R1 + x2²/2R2 |
//! | [`Cylinder`] | x1² / 2R, its axis along x2 |
//! | [`Cone`] | r tan β |
//! | [`FlatPunch`] | 0 on the face, +∞ off it |
//! | [`Wavy`] | A (1 − cos 2πx1/λ), or the sum of two such waves |
//! | [`HeightMap`] | a measured surface |
//! | [`Rough`] | a random self-affine surface |
//! | [`Sum`] | superposed shapes, such as roughness on a sphere |
//! | [`Shifted`] | another shape, shifted in the plane |
//! | [`Repeated`] | another shape, repeated periodically |
//! | [`FnGeometry`] | any closure of (x1, x2) |

mod cone;
mod cylinder;
mod ellipsoid;
mod flat_punch;
mod function;
#[cfg(feature = "laws")]
pub mod laws;
mod repeated;
mod shifted;
mod sphere;
mod sum;
#[cfg(feature = "surfaces")]
mod surfaces;
mod waves;
mod wavy;

pub use cone::Cone;
pub use cylinder::Cylinder;
pub use ellipsoid::Ellipsoid;
pub use flat_punch::FlatPunch;
pub use function::FnGeometry;
pub use repeated::Repeated;
pub use shifted::Shifted;
pub use sphere::Sphere;
pub use sum::Sum;
pub(crate) use sum::added;
#[cfg(feature = "surfaces")]
pub use surfaces::*;
pub(crate) use waves::Missed;
pub use waves::Waves;
pub use wavy::Wavy;

use std::fmt::Debug;

use crate::error::{Error, Result, UserError, or_failure_of};
use crate::{Grid, memory};

/// The gap between the undeformed bodies at zero approach.
///
/// Only differences matter: a constant added to the gap is added to the approach.
///
/// ```
/// use viscocontact::{Grid, geometry::Geometry};
///
/// /// A ridge along x2.
/// #[derive(Debug)]
/// struct Ridge;
///
/// impl Geometry for Ridge {
///     fn initial_gap(&self, x1: f64, _x2: f64) -> f64 {
///         x1.abs()
///     }
/// }
///
/// let grid = Grid::square(2, 2.0)?;
/// let mut gap = vec![0.0; grid.len()];
/// Ridge.fill_gap(&grid, &mut gap);
/// assert_eq!(gap, [0.5; 4]);
/// # Ok::<(), viscocontact::Error>(())
/// ```
pub trait Geometry: Debug + Send + Sync {
    /// Gap at the point (x1, x2) \[m\], h_i in Eq. 1 of the [paper](crate::paper); `+∞` where there is nothing to
    /// touch. NaN and −∞ are errors wherever a geometry is used.
    fn initial_gap(&self, x1: f64, x2: f64) -> f64;

    /// Writes the gap at every cell centre of `grid` into `gap` \[m\], which has one value per cell. Where
    /// [ranks](crate::parallel) share a contact, `grid` holds the local rows: [`Grid::center`] gives their positions.
    ///
    /// It is the shape that is not shifted: override [`fill_gap_at`](Geometry::fill_gap_at) instead.
    ///
    /// # Panics
    /// If `gap` is not of length [`Grid::len`].
    fn fill_gap(&self, grid: &Grid, gap: &mut [f64]) {
        self.fill_gap_at(grid, [0.0; 2], gap);
    }

    /// As [`fill_gap`](Geometry::fill_gap), for the shape with its origin shifted to the point `by` \[m\].
    ///
    /// Override it if a whole field is cheaper than its points one by one, or can be shifted more accurately, such as
    /// the Fourier series of a periodic surface.
    ///
    /// # Panics
    /// If `gap` is not of length [`Grid::len`].
    fn fill_gap_at(&self, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
        fill_by_points(self, grid, by, gap);
    }

    /// Why a value was none, of a gap that can fail ([`FnGeometry::fallible`]): such a value is NaN.
    fn failure(&self) -> Option<UserError> {
        None
    }

    /// Periods and shortest waves of the shape and of its parts, for the warnings of contacts whose grid does not
    /// hold them ([`Warnings::OTHER_PERIOD`](crate::contact::Warnings::OTHER_PERIOD),
    /// [`Warnings::SHORT_WAVES`](crate::contact::Warnings::SHORT_WAVES)). By default none are told.
    fn waves(&self) -> Vec<Waves> {
        Vec::new()
    }
}

/// Writes the gap of the shifted shape at the cell centres, one by one.
fn fill_by_points<G: Geometry + ?Sized>(shape: &G, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
    assert_eq!(gap.len(), grid.len(), "gap must have one value per cell");
    let [_, n2] = grid.cells();
    for (i, row) in gap.chunks_exact_mut(n2).enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            let [x1, x2] = grid.center(i, j);
            *value = shape.initial_gap(x1 - by[0], x2 - by[1]);
        }
    }
}

/// Implements [`Geometry`] for references and pointers, so that shapes can be borrowed, owned, shared or chosen at
/// run time.
macro_rules! forward_geometry {
    ($($pointer:ty),*) => {$(
        forward! {
            Geometry, (<T> self: $pointer => **self),
            initial_gap(x1: f64, x2: f64) -> f64;
            fill_gap(grid: &Grid, gap: &mut [f64]);
            fill_gap_at(grid: &Grid, by: [f64; 2], gap: &mut [f64]);
            failure() -> Option<UserError>;
            waves() -> Vec<Waves>;
        }
    )*};
}
forward_geometry!(&T, Box<T>, std::sync::Arc<T>);

/// The gap field of the rigid bodies, relative to its minimum: heights that are large compared with the indentation
/// cost no digits.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Gap {
    /// Minimum of the gap \[m\].
    pub(crate) datum: f64,
    /// Gap of each cell above the minimum \[m\]; 0 in at least one cell, +∞ where there is nothing to touch.
    pub(crate) above: Vec<f64>,
    /// The body of each cell, the lowest one there; `None` for a single body.
    pub(crate) owner: Option<Vec<u16>>,
}

/// The gap of a geometry on every cell, unchecked.
///
/// # Errors
/// If there is no memory for it and for the pressure, which every contact on the grid needs as well.
pub(crate) fn evaluate(geometry: &dyn Geometry, grid: &Grid) -> Result<Vec<f64>> {
    // checked before filling a field that could not be used
    memory::check("gap and pressure of a contact", 16 * grid.len() as u128)?;
    let mut gap = memory::field("the gap of a contact", grid.len(), f64::INFINITY)?;
    let fill = || {
        // a rank may have no rows
        if !gap.is_empty() {
            geometry.fill_gap(grid, &mut gap);
        }
        Ok(gap)
    };
    or_failure_of(|| geometry.failure(), fill)
}

/// Refuses NaN and −∞.
fn check(gap: &[f64], grid: &Grid) -> Result<()> {
    match gap.iter().position(|h| h.is_nan() || *h == f64::NEG_INFINITY) {
        Some(k) => {
            let cell = [k / grid.cells()[1], k % grid.cells()[1]];
            Err(Error::InvalidGap { cell, position: grid.center(cell[0], cell[1]), value: gap[k] })
        }
        None => Ok(()),
    }
}

impl Gap {
    /// Combines the gap fields of the bodies and checks them: no NaN, no −∞, and each body has something to touch.
    pub(crate) fn new(bodies: Vec<Vec<f64>>, grid: &Grid) -> Result<Gap> {
        let count = bodies.len();
        bodies.iter().try_for_each(|own| check(own, grid))?;
        let mut bodies = bodies.into_iter();
        // the field of the first body is reused
        let mut above = bodies.next().unwrap_or_default();
        let mut owner = match count {
            0 | 1 => None,
            _ => Some(memory::field("the body of each cell", grid.len(), 0_u16)?),
        };
        for (body, own) in (1..).zip(bodies) {
            for (k, &h) in own.iter().enumerate() {
                if h < above[k] {
                    above[k] = h;
                    if let Some(owner) = &mut owner {
                        owner[k] = body;
                    }
                }
            }
        }
        for body in 0..count {
            let touches =
                |k: &usize| above[*k].is_finite() && owner.as_ref().is_none_or(|o| usize::from(o[*k]) == body);
            if (0..grid.len()).find(touches).is_none() {
                return Err(Error::NothingToTouch { body, cells: grid.len() });
            }
        }
        let datum = above.iter().copied().fold(f64::INFINITY, f64::min);
        above.iter_mut().for_each(|h| *h -= datum);
        Ok(Gap { datum, above, owner })
    }

    /// The body of cell `k`.
    pub(crate) fn owner(&self, k: usize) -> usize {
        self.owner.as_ref().map_or(0, |owner| owner[k].into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_match_their_formulas() {
        let (x, y) = (0.3, -0.4);
        let cases: [(&dyn Geometry, f64); 7] = [
            (&Sphere::new(2.0).unwrap(), 0.25 / 4.0),
            (&Ellipsoid::new(2.0, 5.0).unwrap(), 0.09 / 4.0 + 0.16 / 10.0),
            (&Cylinder::new(2.0).unwrap(), 0.09 / 4.0),
            (&Cone::new(0.1).unwrap(), 0.05),
            (&FlatPunch::circular(0.51).unwrap(), 0.0),
            (&FlatPunch::rectangular([0.7, 0.7]).unwrap(), f64::INFINITY),
            (&FnGeometry::new(|x1, x2| x1 * x2), -0.12),
        ];
        for (shape, expected) in cases {
            let gap = shape.initial_gap(x, y);
            assert!(gap == expected || (gap - expected).abs() < 1e-15, "{shape:?}: {gap}");
        }
    }

    #[test]
    fn shifted_shapes_are_shifted() {
        let shifted = Shifted::new(Sphere::new(1.0).unwrap(), [0.5, -0.25]).unwrap();
        assert_eq!(shifted.initial_gap(0.5, -0.25), 0.0);
        assert_eq!(shifted.initial_gap(1.5, -0.25), 0.5);
    }

    #[test]
    fn bad_shapes_are_refused_by_name() {
        let field = |error: Error| match error {
            Error::OutOfRange { field, .. } => field,
            other => panic!("unexpected {other}"),
        };
        assert_eq!(field(Sphere::new(0.0).unwrap_err()), "sphere radius");
        assert_eq!(field(Ellipsoid::new(1.0, f64::NAN).unwrap_err()), "radius of curvature along x2");
        assert_eq!(field(Cylinder::new(-1.0).unwrap_err()), "cylinder radius");
        assert_eq!(field(Cone::new(f64::INFINITY).unwrap_err()), "cone slope tan β");
        assert_eq!(field(FlatPunch::circular(-1.0).unwrap_err()), "punch radius");
        assert_eq!(field(FlatPunch::rectangular([1.0, 0.0]).unwrap_err()), "punch side along x2");
        let sphere = Sphere::new(1.0).unwrap();
        assert_eq!(field(Shifted::new(sphere, [f64::NAN, 0.0]).unwrap_err()), "shift along x1");
    }

    #[test]
    fn bad_gaps_are_located() {
        let grid = Grid::new([2, 3], [2.0, 3.0]).unwrap();
        let joined = |bodies: &[&dyn Geometry]| {
            Gap::new(bodies.iter().map(|body| evaluate(*body, &grid).unwrap()).collect(), &grid)
        };
        let hole = FnGeometry::new(|x1, x2| if x1 > 0.0 && x2 > 0.0 { f64::NAN } else { 0.0 });
        let Error::InvalidGap { cell, position, value } = joined(&[&hole]).unwrap_err() else { panic!() };
        assert_eq!((cell, position), ([1, 2], [0.5, 1.0]));
        assert!(value.is_nan());
        let abyss = FnGeometry::new(|_, _| f64::NEG_INFINITY);
        assert!(matches!(joined(&[&abyss]), Err(Error::InvalidGap { cell: [0, 0], .. })));
        let nothing = FnGeometry::new(|_, _| f64::INFINITY);
        assert_eq!(joined(&[&nothing]), Err(Error::NothingToTouch { body: 0, cells: 6 }));
        let under = FnGeometry::new(|_, _| 1.0);
        assert_eq!(joined(&[&FnGeometry::new(|_, _| 0.0), &under]), Err(Error::NothingToTouch { body: 1, cells: 6 }));
    }
}
