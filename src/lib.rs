//! Contact of viscoelastic bodies.
//!
//! An indenter is pressed onto a creeping body: pressure, contact area and approach over time, for any shape and load history. The rheology is
//! linear, its creep compliance concave after t = 0. Surfaces and creep may come from files.
//!
//! # The problem
//!
//! The gap h is the gap h_i before deformation, plus the surface displacement u, minus the approach ω and tilt α of the indenter. The
//! pressure p carries the force W and, where the tilt is free, its moments W e:
//!
//! ```text
//! h = h_i + u − ω − α·x,    p ≥ 0,    h ≥ 0,    p h = 0
//! W = ∬ p dx,    W e = ∬ p x dx
//! ```
//!
//! The displacement follows the pressure history through the contact creep compliance C(t):
//!
//! ```text
//! u(t) = ∫₀₋ᵗ C(t − s) d[K p(s)],    (K p)(x) = ∬ p(x′) / (π |x − x′|) dx′
//! ```
//!
//! Periodic bodies, line contacts in plane strain, layers ([`Layer`]) and user-defined bodies have another K
//! ([`InfluenceKernel`]).
//!
//! The discretisation follows S. Spinu, *The surface contact of viscoelastic materials, Part I* ([`paper`]).
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
//! | follow a load history, in fixed or adaptive steps | [`run::Contact::follow`] |
//! | load elastic bodies, without time | [`elastic::ElasticContact`] |
//! | read pressure, gap, patches, profiles | [`fields::Fields`] |
//! | reach a required accuracy, and measure it | [`study::Study`] |
//! | compute many materials on one surface | [`states`] |
//! | let surfaces attract each other | [`adhesion`] |
//! | slide and roll, in steps or steadily | [`motion`], [`sliding`] |
//! | read or generate a rough surface | [`geometry::HeightMap`], [`geometry::Rough`] |
//! | add a shape, a body or a history | [`geometry::Geometry`], [`rheology::Rheology`], [`load::LoadHistory`] |
//! | evaluate a state, write files for NumPy and ParaView | [`observe`], [`output`] |
//! | compare with closed forms | [`analytic`] |
//! | identify a modulus by indentation | the package `viscocontact-identify` |
//!
//! Guides with programs, in the order of use: [`guide::tour`], [`guide::curves`], [`guide::data`], [`guide::accuracy`],
//! [`guide::own_models`], [`guide::adhesion`], [`guide::elastic_states`], [`guide::friction`], [`guide::steady_motion`], [`guide::coupling`], [`guide::long_runs`], [`guide::results`].
//!
//! # Conventions
//!
//! * **Units**: SI: m, Pa, N, s.
//! * **Signs**: pressure is positive in compression, displacement into the bodies, the gap when open, the approach when pressed together.
//! * **Stress** below the surface ([`observe::Stress`]): tension positive, x3 the depth.
//! * **Coordinates**: x1 and x2 in the common plane, origin in the middle of the [`Grid`].
//! * **Fields**: one value per cell, row-major with x2 fastest: the cell `[i, j]` is entry `i * cells()[1] + j`.
//! * **Gap**: `+∞` where there is no surface, as outside the face of a punch.
//! * **Compliance**: J(t) is the shear creep compliance, J(0) = 1/G. C(t) is the contact creep compliance, 1/E* for an
//!   elastic body: J/4 if incompressible, (1 − ν) J/2 at a constant Poisson's ratio, larger with an elastic bulk
//!   ([`rheology::Material`]); the compliances of two bodies add up.
//! * **Kernel**: [`InfluenceKernel::convolve`] returns K p in Pa·m.
//! * **Datum** of the approach: the surface far from a half-space's contact, the mean of a periodic surface, the surface at a distance given
//!   with the kernel in line contacts, the undeformed surface of a layer on a rigid base.
//! * **Heights** of maps and rough surfaces are positive outward; the gap is the maximum height minus each height.
//! * **Motion**: a positive velocity moves the indenter over the creeping bodies along x1 or x2; the lateral force moves it.
//! * **Time**: bodies are undisturbed before t = 0. A step of length 0 is a jump of the load.
//!
//! # Cost
//!
//! A convolution of N cells transforms the zero-padded grid and back, O(N log N). A step of the default solver
//! takes <!-- figures convolutions per step -->3.1<!-- end --> convolution equivalents in the scene of the paper. Half
//! or a quarter of the cells is computed where gap and load are even ([`contact::Settings::symmetry`]), and none beyond
//! the reach of contact ([`contact::Settings::window`]).
//!
//! The history costs no transform, and one field per relaxation time. A rheology without an exact exponential
//! series is fitted by one at `build` ([`rheology::Rheology::series`]).
//!
//! Memory with one relaxation time: <!-- figures memory of the grid -->63 to 77<!-- end --> bytes per cell of the
//! grid where a quarter is computed, <!-- figures memory -->158 to 186<!-- end --> where all are,
//! and <!-- figures memory of a line -->370<!-- end --> in a line contact; each further time adds 8 per computed cell.
//! [`contact::Builder::memory`] returns the bytes beforehand.
//!
//! A step allocates nothing, except the first two of a run or under a tilting load, the first over the bodies or of several bodies, and steps
//! along a path, with attraction, where a window
//! grows, or temperature alters the rate of creep by many decades.
//!
//! # Co-simulation and long runs
//!
//! A failed step leaves the contact as it was, except that [`ViscoelasticContact::within_step`] has lost the start of the step before it. Iterative
//! callers return to a [`contact::Snapshot`]. A state saved to a file continues with the same bits. Results have the same bits for any number of
//! threads, and for any number of [ranks](parallel), which compute the whole grid as a contact without ranks does when [`contact::Settings::window`]
//! is false.
//!
//! # Features
//!
//! Without features the crate is the stepper with analytic shapes, materials, loads and runs. Everything else is behind
//! a feature, and `full` is all of these:
//!
//! | feature | adds |
//! |---|---|
//! | `adhesion` | [`adhesion`], [`contact::Builder::attraction`] |
//! | `analytic` | [`analytic`] |
//! | `checkpoint` | save and resume: [`ViscoelasticContact::save`], [`run::Run::autosave_to`] |
//! | `contacts` | runs of contacts of your own: [`run::Contact`] |
//! | `data` | [`rheology::Measurements`], [`rheology::MasterCurve`], [`rheology::library`], [`numeric::least_squares`] |
//! | `energies` | [`contact::EnergyBalance`] |
//! | `friction` | [`friction`]: partial slip, shear and torsion in space |
//! | `laws` | [`laws`]: laws for shapes, rheologies and histories, `proptest` strategies |
//! | `layers` | [`Layer`] |
//! | `motion` | [`motion`]: indenters that move along the surface, or over the bodies |
//! | `observe` | [`observe`]: patches, profiles, distributions, stiffness, error due to the mesh |
//! | `output` | [`output`]: CSV, VTK |
//! | `plot` | [`plot`]: PNG, SVG and GIF |
//! | `sliding` | [`sliding`] |
//! | `states` | [`states`] |
//! | `study` | [`study`] |
//! | `stress` | [`observe::SubsurfaceStress`] |
//! | `surfaces` | [`geometry::HeightMap`], [`geometry::Rough`], [`geometry::SurfaceStatistics`] |
//! | `temperature` | [`rheology::TimeTemperature`], [`rheology::TemperatureHistory`] |
//! | `text` | [`input`] |
//!
//! Beside them: `rayon` (default): threads, from 2¹⁵ computed cells on. `npy`: NPZ and NPY files. `x3p`: X3P height
//! maps. `serde`: serialised loads, settings, spectra and reports. `tracing`: events.
//!
//! # Limitations
//!
//! Surfaces are frictionless except on elastic states and in a [`friction::FrictionContact`] ([`guide::friction`]);
//! plasticity and finite deformation are outside the model; steps warn beyond small strains and slopes
//! ([`guide::accuracy`]). With attraction
//! there is one body on the whole grid ([`guide::adhesion`]). In time a [`Layer`] lies on a rigid base, or on one with the same creep function; bodies of several
//! layers need a spectrum or influence coefficients ([`InfluenceKernel::from_spectrum`]).

#![cfg_attr(docsrs, feature(doc_cfg))]
#![deny(missing_docs)]
#![forbid(unsafe_code)]
#![warn(missing_debug_implementations)]
#![cfg_attr(not(feature = "full"), allow(dead_code, unused_imports, reason = "rooms behind features use them"))]

#[macro_use]
mod values;

#[cfg(feature = "adhesion")]
pub mod adhesion;
#[cfg(feature = "analytic")]
pub mod analytic;
mod ascending;
mod attraction;
mod axis;
pub mod contact;
mod dense;
pub mod elastic;
mod equilibrium;
mod error;
mod extent;
#[cfg(any(feature = "analytic", feature = "friction", feature = "sliding", feature = "stress", feature = "surfaces"))]
mod fft;
pub mod fields;
#[cfg(any(feature = "checkpoint", feature = "output", feature = "sliding", feature = "states", feature = "text"))]
mod file;
#[cfg(feature = "friction")]
pub mod friction;
pub mod geometry;
mod grid;
mod traced;
// the programs of the guide run only with the features that they use
#[cfg(all(doc, any(not(doctest), all(feature = "full", feature = "npy"))))]
pub mod guide;
mod hereditary;
#[cfg(feature = "text")]
pub mod input;
mod kernel;
#[cfg(feature = "laws")]
pub mod laws;
mod linalg;
pub mod load;
mod memory;
pub mod motion;
pub mod numeric;
#[cfg(feature = "observe")]
pub mod observe;
#[cfg(feature = "output")]
pub mod output;
pub mod parallel;
#[cfg(doc)]
pub mod paper {
    #![doc = include_str!("../docs/paper.md")]

    use crate::*;
}
#[cfg(feature = "plot")]
pub mod plot;
mod quadrature;
pub mod rheology;
mod rounded;
pub mod run;
#[cfg(feature = "sliding")]
pub mod sliding;
mod solver;
#[cfg(feature = "states")]
pub mod states;
#[cfg(feature = "study")]
pub mod study;
mod sum;

pub use axis::Axis;
pub use contact::ViscoelasticContact;
pub use error::{Error, ErrorKind, OutputError, Refusal, Result, UserError};
pub use grid::Grid;
#[cfg(feature = "text")]
pub use input::{Delimiter, TextFormat};
#[cfg(feature = "layers")]
pub use kernel::Layer;
pub use kernel::{InfluenceKernel, Workspace};
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
    #[cfg(feature = "layers")]
    pub use crate::Layer;
    pub use crate::contact::{
        BodyState, Builder, Edge, Frame, Settings, Snapshot, StepError, StepReport, TimeRule, ViscoelasticContact,
        Warnings,
    };
    pub use crate::elastic::ElasticContact;
    pub use crate::fields::Fields;
    #[cfg(feature = "surfaces")]
    pub use crate::geometry::{Anisotropy, HeightMap, LengthUnit, Rough, RoughSpec, Roughness, SurfaceStatistics};
    pub use crate::geometry::{
        Cone, Cylinder, Ellipsoid, FlatPunch, FnGeometry, Geometry, Repeated, Shifted, Sphere, Wavy,
    };
    pub use crate::load::{FnHistory, Load, LoadHistory, Periodic, PiecewiseLinear, Ramp, Sinusoid, StepLoad, Tilt};
    #[cfg(feature = "motion")]
    pub use crate::motion::{FnPath, Straight, Travel};
    #[cfg(feature = "output")]
    pub use crate::output::{CsvHistory, Earlier, Field, FrameSeries, Metadata};
    #[cfg(feature = "data")]
    pub use crate::rheology::Measurements;
    pub use crate::rheology::{
        Burgers, Elastic, FnRheology, FractionalMaxwell, FractionalZener, GeneralizedKelvin, GeneralizedMaxwell,
        KelvinVoigt, Kww, LogCreep, Material, Maxwell, PowerLaw, Rheology, SlowCreep, Tension, Zener,
    };
    pub use crate::run::{Contact, Crossing, Run, Stepping, Times};
    #[cfg(feature = "sliding")]
    pub use crate::sliding::SteadySliding;
    #[cfg(feature = "states")]
    pub use crate::states::{ElasticStates, Reach, StatesContact, Sweep};
    #[cfg(feature = "study")]
    pub use crate::study::{Observable, Study};
    pub use crate::{Axis, Error, Grid, InfluenceKernel};
}

#[doc = include_str!("../README.md")]
#[cfg(all(doctest, feature = "full"))]
struct Readme;
