//! Frictionless contact of viscoelastic bodies, for tribologists, and for engineers who couple a contact to other programs.
//!
//! An indenter is pressed onto a creeping body. The crate computes the pressure between them, the contact area and the
//! approach, and how they evolve in time. Geometry and load history are arbitrary. The rheology is linear, with a creep
//! compliance that is concave after t = 0. Surfaces and creep may be measured ones, read from files.
//!
//! # The problem
//!
//! The gap h between the deformed bodies is the gap h_i before deformation, plus the surface displacement u, minus the
//! approach ω and tilt α of the indenter. Inside the contact there is pressure p and no gap, outside a gap and no
//! pressure. The pressure carries the force W and, where the tilt is free, its moments W e:
//!
//! ```text
//! h = h_i + u − ω − α·x,    p ≥ 0,    h ≥ 0,    p h = 0
//! W = ∬ p dx,    W e = ∬ p x dx
//! ```
//!
//! The displacement depends on the whole pressure history through the contact creep compliance C(t):
//!
//! ```text
//! u(t) = ∫₀₋ᵗ C(t − s) d[K p(s)],    (K p)(x) = ∬ p(x′) / (π |x − x′|) dx′
//! ```
//!
//! Periodic bodies, line contacts in plane strain, layers ([`Layer`]) and user-defined bodies have another K
//! ([`InfluenceKernel`]).
//!
//! The discretisation follows S. Spinu, *The surface contact of viscoelastic materials, Part I*; the page [`paper`] lists
//! where its equations and figures are implemented.
//!
//! # A simulation
//!
//! ```
//! use viscocontact::prelude::*;
//!
//! let grid = Grid::square(64, 4.0e-3)?;                          // 64 × 64 cells on 4 mm × 4 mm
//! let mut contact = ViscoelasticContact::builder(grid)
//!     .geometry(&Sphere::new(10.0e-3)?)                          // anything that is `Geometry`
//!     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
//!     .build()?;
//! contact.step(0.0, Load::force(1.0))?;                          // Δ = 0: the load jumps
//! for _ in 0..10 {
//!     let report = contact.step(0.2, Load::force(1.0))?;         // hold it
//!     println!("{:.2} s  {:.3} mm²", report.time, contact.contact_area() * 1e6);
//! }
//! # Ok::<(), viscocontact::Error>(())
//! ```
//!
//! | to | use |
//! |---|---|
//! | drive every step | [`ViscoelasticContact::step`] |
//! | follow a load history, in fixed or adaptive steps | [`ViscoelasticContact::follow`] |
//! | reach a required accuracy | [`plan::Plan`]: domain, mesh and steps |
//! | compute many materials, histories or temperatures on one surface | [`states`] |
//! | let surfaces attract each other | [`adhesion`] |
//! | slide and roll, in steps or as a steady state | [`motion`], [`sliding`] |
//! | read a measured surface, or generate a rough one | [`geometry::HeightMap`], [`geometry::Rough`] |
//! | add a shape, a body or a history | [`geometry::Geometry`], [`rheology::Rheology`], [`load::LoadHistory`] |
//! | evaluate a state, and write files for NumPy and ParaView | [`observe`], [`output`] |
//! | compare with closed forms | [`analytic`] |
//! | identify a modulus from a measured indentation | the package `viscocontact-identify` |
//!
//! Guides with programs, in the order of use: [`guide::tour`], [`guide::curves`], [`guide::data`], [`guide::accuracy`],
//! [`guide::own_models`], [`guide::adhesion`], [`guide::elastic_states`], [`guide::steady_motion`], [`guide::coupling`], [`guide::long_runs`], [`guide::results`].
//!
//! # Conventions
//!
//! * **Units**: SI throughout: m, Pa, N, s. The same scene in other units gives the same result.
//! * **Signs**: pressure is positive in compression, displacement positive into the bodies, the gap positive when open;
//!   the approach grows as the bodies are pressed together.
//! * **Stress** below the surface ([`observe::Stress`]): tension positive, x3 the depth.
//! * **Coordinates**: x1 and x2 in the common plane, origin in the middle of the [`Grid`].
//! * **Fields**: one value per cell, constant over the cell, row-major with x2 fastest: the cell `[i, j]` is entry
//!   `i * cells()[1] + j`.
//! * **Gap**: `+∞` means that there is no surface to touch, as outside the face of a punch.
//! * **Compliance**: J(t) is the shear creep compliance, J(0) = 1/G. C(t) is the contact creep compliance, 1/E* for an
//!   elastic body: J/4 if incompressible, (1 − ν) J/2 at a constant Poisson's ratio, larger with an elastic bulk
//!   ([`rheology::Material`]); the compliances of two bodies add up.
//! * **Kernel**: [`InfluenceKernel::convolve`] returns K p in Pa·m; no factor of the transform remains.
//! * **Datum**: on a half-space the approach is measured from the surface far away; on bodies periodic along both axes
//!   from the mean of the surface; in line contacts from the surface at a distance given with the kernel; on a layer on a
//!   rigid base from its undeformed surface, in all of these.
//! * **Heights** of maps and rough surfaces are positive outward; the gap is the greatest height minus each height.
//! * **Motion**: displacements belong to the creeping bodies. A positive velocity moves the indenter over them along
//!   x1 or x2; the lateral force is the force that moves it.
//! * **Time**: bodies are undisturbed before t = 0. A step of length 0 is a jump of the load.
//!
//! # Cost
//!
//! A convolution of N cells is one forward and one inverse real transform of the zero-padded grid, O(N log N). A step of the
//! default solver takes <!-- figures convolutions per step -->3.1<!-- end --> convolution equivalents (a transform without padding is a quarter of one) in the scene of the
//! paper. Where gap and load are even in x1, x2 or both, half or a quarter of the cells is computed
//! ([`contact::Settings::symmetry`]); on half-spaces, cells that contact cannot reach are not computed
//! ([`contact::Settings::window`]).
//!
//! The history costs no transform: one field per relaxation time, independent of the number of earlier steps. A
//! rheology without an exact exponential series is fitted by one when the contact is built, with about two relaxation times per
//! decade ([`rheology::Rheology::series`]).
//!
//! Memory with one relaxation time: <!-- figures memory of the grid -->63 to 77<!-- end --> bytes per cell of the grid where a quarter is
//! computed, <!-- figures memory -->158 to 186<!-- end --> where all are, <!-- figures memory of a line -->370<!-- end --> in a line contact, and 8 for each computed
//! cell and further relaxation time. [`contact::Builder::memory`] returns it before a contact is built; if it does not fit, `build` returns
//! [`Error::OutOfMemory`].
//!
//! A step of the default rule allocates nothing, except the first two of a run, along a path, under a tilting load or an attraction; one in
//! which a window grows; and one in which a changing temperature alters the rate of creep by many decades.
//!
//! # Co-simulation and long runs
//!
//! A failed step leaves no trace and may be tried again, shorter or under another load. A caller that iterates takes a
//! [`contact::Snapshot`], tries steps and restores it, without allocating. With the feature `checkpoint` the whole
//! state is saved to a file and resumed; the following steps are bitwise identical. Results do not depend on the number of
//! threads or [ranks](parallel), bit by bit.
//!
//! # Features
//!
//! `rayon` (on by default): threads of the pool in which the contact is built, for grids of 2¹⁵ computed cells or more.
//! `checkpoint`: `ViscoelasticContact::save` and `resume`, [`run::Run`]`::autosave_to`. `plot`: PNG, SVG and GIF. `npy`: NPZ and
//! NPY files. `x3p`: height maps from X3P files. `serde`: serialised loads, settings, spectra, reports and estimates. `laws`:
//! `proptest` strategies. `tracing`: events.
//!
//! # Limitations
//!
//! Friction, plasticity and finite deformation are outside the model: it covers frictionless normal contact at small strains and
//! slopes. Steps warn beyond ([`guide::accuracy`] lists the warnings). With attraction there is one body on the whole grid
//! ([`guide::adhesion`] lists what is refused). A [`Layer`] lies on a rigid base, or on a base with the same creep function (in steady motions on any: [`sliding`]); bodies of several layers need
//! influence coefficients or a spectrum from the user ([`InfluenceKernel::from_coefficients`], [`InfluenceKernel::from_spectrum`]).

#![cfg_attr(docsrs, feature(doc_cfg))]
#![deny(missing_docs)]
#![forbid(unsafe_code)]
#![warn(missing_debug_implementations)]

#[macro_use]
mod values;

pub mod adhesion;
pub mod analytic;
mod ascending;
mod axis;
pub mod contact;
mod error;
mod events;
mod extent;
mod fft;
mod file;
pub mod geometry;
mod grid;
// the programs of the guide run only with the features that they use
#[cfg(all(doc, any(not(doctest), all(feature = "checkpoint", feature = "npy", feature = "plot"))))]
pub mod guide;
mod hereditary;
pub mod input;
mod kernel;
#[cfg(feature = "laws")]
pub mod laws;
mod linalg;
pub mod load;
mod memory;
pub mod motion;
pub mod numeric;
pub mod observe;
pub mod output;
pub mod parallel;
#[cfg(doc)]
pub mod paper {
    #![doc = include_str!("../docs/paper.md")]

    use crate::*;
}
pub mod plan;
#[cfg(feature = "plot")]
pub mod plot;
mod quadrature;
pub mod rheology;
mod rounded;
pub mod run;

pub mod sliding;
mod solver;
pub mod states;
mod sum;

pub use axis::Axis;
pub use contact::ViscoelasticContact;
pub use error::{
    Convergence, Error, ErrorKind, FileError, KernelError, OutputError, Result, TextError, Trend, UserError,
};
pub use grid::Grid;
pub use input::{Delimiter, TextFormat};
pub use kernel::{InfluenceKernel, Layer, Workspace};
/// The crate of the complex numbers of moduli and compliances.
pub use num_complex;

/// The types for writing a scene, except for names with another common meaning: [`geometry::Sum`], [`geometry::Form`],
/// [`motion::Path`] and [`Result`] are imported from their modules.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let grid = Grid::square(16, 1.0e-3)?;
/// # let _ = grid;
/// # Ok::<(), Error>(())
/// ```
pub mod prelude {
    pub use crate::contact::{
        BodyState, Builder, Contact, Edge, Frame, Settings, Snapshot, Solver, StepError, StepReport, TimeRule,
        ViscoelasticContact, Warnings,
    };
    pub use crate::geometry::{
        Anisotropy, Cone, Cylinder, Ellipsoid, FlatPunch, FnGeometry, Geometry, HeightMap, LengthUnit, Repeated, Rough,
        RoughSpec, Roughness, Shifted, Sphere, SurfaceStatistics, Wavy,
    };
    pub use crate::load::{FnHistory, Load, LoadHistory, Periodic, PiecewiseLinear, Ramp, Sinusoid, StepLoad, Tilt};
    pub use crate::motion::{FnPath, Straight, Travel};
    pub use crate::output::CsvHistory;
    pub use crate::output::{Field, FrameSeries, Metadata};
    pub use crate::plan::{Accuracy, Plan};
    pub use crate::rheology::{
        Burgers, Elastic, FnRheology, FractionalMaxwell, FractionalZener, GeneralizedKelvin, GeneralizedMaxwell,
        KelvinVoigt, Kww, LogCreep, Material, Maxwell, Measurements, PowerLaw, Rheology, SlowCreep, Tension, Zener,
    };
    pub use crate::run::{Crossing, Run, SteadyMotion, Stepping, Times};
    pub use crate::sliding::SteadySliding;
    pub use crate::states::{ElasticStates, Reach, StatesContact, Sweep};
    pub use crate::{Axis, Error, Grid, InfluenceKernel, Layer};
}

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
