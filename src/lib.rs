//! Contact of viscoelastic bodies.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod analytic;
pub mod contact;
mod error;
pub mod geometry;
mod grid;
mod hereditary;
mod kernel;
pub mod load;
mod quadrature;
pub mod rheology;
mod solver;

pub use contact::ViscoelasticContact;
pub use error::{Error, Result};
pub use grid::Grid;
pub use kernel::{InfluenceKernel, Workspace};

/// Everything a scene is written with.
pub mod prelude {
    pub use crate::contact::{
        Builder, Edge, Follow, Settings, Solver, StepReport, Stepping, TimeRule, ViscoelasticContact,
    };
    pub use crate::geometry::{Cone, Cylinder, Ellipsoid, FlatPunch, FnGeometry, Geometry, Shifted, Sphere};
    pub use crate::load::{FnHistory, Load, LoadHistory, PiecewiseLinear, Ramp, Sinusoid, StepLoad};
    pub use crate::rheology::{
        Burgers, Elastic, FnRheology, GeneralizedKelvin, GeneralizedMaxwell, KelvinVoigt, Material, Maxwell, Rheology,
        Zener,
    };
    pub use crate::{Error, Grid, InfluenceKernel, Result};
}
