//! Frictionless contact of viscoelastic bodies, for tribologists, and for engineers who couple a contact to other programs.
//!
//! An indenter is pressed onto a creeping half-space. The crate computes the pressure between them, the contact area and the
//! approach, and how they evolve in time. Geometry and load history are arbitrary, the rheology is linear with a creep compliance that is
//! concave after t = 0; measured surfaces and measured creep are read from files.
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
//! Pressure and contact area are unknown, and both change even under a constant force. The discretisation follows S. Spinu,
//! *The surface contact of viscoelastic materials, Part I*; time rule and solver go beyond it. The page [`paper`] lists
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
//! To drive every step yourself, use [`ViscoelasticContact::step`]. For a load history, use
//! [`ViscoelasticContact::follow`], with fixed steps or steps chosen by their error. For a required accuracy, let a
//! [`plan::Plan`] choose domain, mesh and steps. Your own shapes, bodies and histories implement
//! [`geometry::Geometry`], [`rheology::Rheology`] and [`load::LoadHistory`]. [`analytic`] has reference solutions.
//!
//! Real surfaces are read from files ([`geometry::HeightMap`]) or generated at random ([`geometry::Rough`]). Indenters
//! slide and roll: [`motion`]. [`observe`] evaluates a state, and [`output`] writes it to files that NumPy and ParaView
//! open.
//!
//! Pages to read next, with programs to start from: [`guide::tour`], [`guide::curves`], [`guide::data`], [`guide::accuracy`],
//! [`guide::own_models`], [`guide::adhesion`], [`guide::elastic_states`], [`guide::steady_motion`], [`guide::coupling`] to other integrators, [`guide::long_runs`] and
//! [`guide::results`]. The package `viscocontact-identify` finds the modulus over time of a measured indentation.
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
//! A convolution of N cells is one forward and one inverse real transform of the zero-padded grid, O(N log N). Periodic
//! bodies are not padded and cost a third; a line of N × 1 cells is transformed in one dimension. A step of the default
//! solver takes <!-- figures convolutions per step -->3.1<!-- end --> convolution equivalents (a transform without padding is a quarter of one) in the scene of the paper; tilts cost nothing in
//! a scene without them. Where gap and load are even in x1, x2 or both, only half or a quarter of the cells is computed
//! ([`contact::Settings::symmetry`]); on half-spaces, cells that contact cannot reach are not computed at all
//! ([`contact::Settings::window`]). `docs/performance.md` gives the cost of a step with each method.
//!
//! The history costs no transform: one field per relaxation time, independent of the number of earlier steps. Thirty
//! relaxation times make a step of 256² cells about a tenth longer than one where a quarter is computed, a third longer on the whole grid. A rheology without an exact
//! exponential series is fitted by one when the contact is built ([`rheology::Rheology::series`]): about two relaxation
//! times per decade for an error of 1e-4, in a tenth of a second.
//!
//! Memory with one relaxation time: <!-- figures memory of the grid -->63 to 77<!-- end --> bytes per cell of the grid where a quarter is
//! computed, <!-- figures memory -->158 to 186<!-- end --> where all are, 16 more for each computed cell where threads share a contact
//! (<!-- figures memory of a line -->370<!-- end --> for a line contact, whose transform tables are as long as the line), and 8 for each
//! computed cell and further relaxation time, 16 where the grid follows the indenter (an elastic bulk doubles their number). [`contact::Builder::memory`] returns it before a contact is built; insufficient memory for it is an error
//! ([`Error::OutOfMemory`]) and does not abort the process. A step of the default rule allocates nothing, except the
//! first two of a run, along a path, under a tilting load or an attraction; one in which a window grows; and one in which a changing
//! temperature alters the rate of creep by many decades. `docs/performance.md` has the threads.
//!
//! # Co-simulation and long runs
//!
//! A failed step leaves no trace and may be tried again, shorter or under another load. A caller that iterates takes a
//! [`contact::Snapshot`], tries steps and restores it, without allocating. With the feature `checkpoint` the whole
//! state is saved to a file and resumed; the following steps are bitwise identical.
//!
//! # Features
//!
//! `checkpoint`: saves the state to a file and resumes from it ([`run::Run`]`::autosave_to`,
//! `ViscoelasticContact::save` and `resume`).
//!
//! `laws`: `proptest` strategies for testing your own rheologies, geometries and load histories (`laws`).
//!
//! `npy`: fields to NPZ and NPY files, height maps from and to NPY files.
//!
//! `plot`: pictures of contacts and runs as PNG and SVG files, and animated GIFs, with a built-in font.
//!
//! `x3p`: height maps from X3P files (ISO 25178-72).
//!
//! `serde`: `Serialize` and `Deserialize` for the description of a run, [`load::Load`], [`contact::Settings`],
//! [`run::Stepping`], [`geometry::RoughSpec`], spectra and their parts, and for its results: reports, error estimates, observations,
//! statistics. Part of `checkpoint`.
//!
//! `tracing`: events of the `tracing` crate: steps accepted, rejected and failed, regions moved, series fitted.
//!
//! `rayon` (on by default): grids of 2¹⁵ computed cells or more are shared between the threads of the pool in which the
//! contact is built. The result is bitwise independent of the number of threads.
//!
//! # Limitations
//!
//! Friction, plasticity and finite deformation are outside the model: it covers frictionless normal contact
//! at small strains and slopes: steps warn beyond ([`guide::accuracy`] lists the warnings). Surfaces may
//! attract each other ([`contact::Builder::attraction`]): one body on the whole grid ([`guide::adhesion`] lists what is refused). A [`Layer`] lies on a rigid base, or on one
//! that creeps as it does (in steady motions on any: [`sliding`]); bodies of several layers need their own influence coefficients or spectrum from the user
//! ([`InfluenceKernel::from_coefficients`], [`InfluenceKernel::from_spectrum`]).
//!
//! # Related programs
//!
//! [Tamaas](https://gitlab.com/tamaas/tamaas) (C++ and Python) computes rough contacts, mostly periodic, with
//! plasticity, adhesion and friction, and has a solver for generalized Maxwell bodies.
//! [ContactMechanics](https://github.com/ContactEngineering/ContactMechanics) (Python) computes elastic half-spaces,
//! periodic or not, with contact plasticity; adhesion is in a separate package.
//! [CONTACT](https://www.kalkersoftware.org) (Fortran) computes rolling and sliding with friction, conformal and
//! transient, also of viscoelastic bodies. Their friction and plasticity are not available here. This crate
//! offers any concave creep, measured or fitted, in a recursion whose cost does not grow with the number of steps, of
//! third order in given steps and fourth in steps chosen by their error (second at cells that join); eccentric loads
//! that tilt; all of it as a typed library that another program drives step by step. Its accuracy is given claim by
//! claim in `docs/validation.md` and `docs/accuracy.md`.

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
