//! For tests of your own rheologies, geometries, load histories and attractions: the laws that each must obey, and
//! random models to test with. Feature `laws`.
//!
//! | model | its laws | random valid models |
//! |---|---|---|
//! | [`Rheology`](crate::rheology::Rheology) | [`rheology`] | [`strategies::rheologies`], [`strategies::spectra`] |
//! | [`Geometry`](crate::geometry::Geometry) | [`geometry`] | [`strategies::geometries`], [`strategies::height_maps`] |
//! | [`LoadHistory`](crate::load::LoadHistory) | [`load`] | [`strategies::histories`], [`strategies::loads`] |
//! | [`Attraction`](crate::adhesion::Attraction) | [`adhesion`] | [`strategies::attractions`] |
//! | a whole contact | | [`strategies::scenarios`] |
//!
//! The strategies implement [`proptest`](https://docs.rs/proptest)'s trait. The models of the crate are tested
//! with the same functions.
//!
//! ```
//! use proptest::prelude::*;
//! use viscocontact::Grid;
//! use viscocontact::geometry::Geometry;
//! use viscocontact::laws;
//!
//! /// A groove along x2.
//! #[derive(Debug)]
//! struct Groove { width: f64 }
//!
//! impl Geometry for Groove {
//!     fn initial_gap(&self, x1: f64, _: f64) -> f64 {
//!         if x1.abs() < self.width { 1.0e-6 } else { 0.0 }
//!     }
//! }
//!
//! proptest!(|(width in 0.1..0.4_f64, cells in 8_usize..24)| {
//!     let grid = Grid::square(cells, 1.0).unwrap();
//!     laws::geometry::all(&Groove { width }, &grid).map_err(|broken| TestCaseError::fail(broken.to_string()))?;
//! });
//! ```

pub mod strategies;

pub use crate::adhesion::laws as adhesion;
pub use crate::geometry::laws as geometry;
pub use crate::load::laws as load;
pub use crate::rheology::laws as rheology;
/// The crate of the strategies, in the version of this crate.
pub use proptest;
pub use strategies::Scenario;
