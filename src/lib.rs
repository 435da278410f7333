//! Contact of viscoelastic bodies: the pressure between an indenter and a creeping half-space, the area on which they
//! touch, and how both change with time, for any geometry, any load history and any linear rheology, measured
//! ones included.
//!
//! # The problem
//!
//! The gap between the deformed bodies is the gap before they deform, plus the displacement $u$ of the
//! surface, less the approach $\omega$ and tilt $\alpha$ of the indenter. Where they touch there is pressure and
//! no gap, elsewhere a gap and no pressure, and the pressure carries the force $W$ and its moments, as far as
//! the tilt is free:
//!
//! $$ h = h_i + u - \omega - \alpha \cdot x, \qquad p \ge 0, \quad h \ge 0, \quad p\,h = 0, \qquad
//!    W = \iint p \,dx, \quad W e = \iint p\,x \,dx $$
//!
//! The displacement remembers every earlier pressure through the contact creep compliance $C(t)$:
//!
//! $$ u(t) = \int_{0^-}^t C(t-s)\, d\left[K p(s)\right], \qquad
//!    (K p)(x) = \iint \frac{p(x')}{\pi\,|x-x'|}\,dx' $$
//!
//! Bodies that are periodic, line contacts in plane strain, and bodies of the user's own have another $K$
//! ([`InfluenceKernel`]).
//!
//! Pressure and contact area are unknown, and both change even when the force does not. The discretisation follows S. Spinu,
//! *The surface contact of viscoelastic materials, Part I*; time rule and solver go beyond it.
//!
//! # A simulation
//!
//! ```
//! use viscocontact::prelude::*;
//!
//! let grid = Grid::square(64, 4.0e-3)?;                          // 64 × 64 cells on 4 mm × 4 mm
//! let mut contact = ViscoelasticContact::builder(grid)
//!     .geometry(&Sphere::new(10.0e-3)?)                          // anything that is `Geometry`
//!     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
//!     .build()?;
//! contact.step(0.0, Load::force(1.0))?;                          // Δ = 0: the load jumps
//! for _ in 0..10 {
//!     let report = contact.step(0.2, Load::force(1.0))?;         // hold it
//!     println!("{:.2} s  {:.3} mm²", report.time, contact.contact_area() * 1e6);
//! }
//! # Ok::<(), viscocontact::Error>(())
//! ```
//!
//! A caller who wants to drive every step uses [`ViscoelasticContact::step`]; one who has a load history
//! uses [`ViscoelasticContact::follow`], with fixed steps or steps chosen by their error; one who knows how accurate the answer
//! must be lets a [`plan::Plan`] choose domain, mesh and steps. Shapes, bodies and histories of your own implement
//! [`geometry::Geometry`], [`rheology::Rheology`] and [`load::LoadHistory`]. [`analytic`] has reference
//! solutions.
//!
//! Real surfaces are read from files ([`geometry::HeightMap`]) or made at random ([`geometry::Rough`]). Indenters slide and
//! roll: [`motion`]. What a state tells is in [`observe`], and [`output`] writes it to files that NumPy and ParaView open.
//!
//! # Conventions
//!
//! * **Units**: SI throughout: m, Pa, N, s. The same scene in other units gives the same answer.
//! * **Signs**: pressure is positive in compression, displacement positive into the bodies, the gap
//!   positive when open; the approach grows as the bodies are pressed together.
//! * **Coordinates**: x1 and x2 in the common plane, origin in the middle of the [`Grid`].
//! * **Fields**: one value a cell, constant over the cell, row-major with x2 fastest: the cell `[i, j]` is
//!   entry `i * cells()[1] + j`.
//! * **Gap**: `+∞` means that there is nothing to touch, as off the face of a punch.
//! * **Compliance**: J(t) is the shear creep compliance, J(0) = 1/G. C(t) is the contact creep compliance, 1/E*
//!   for an elastic body: J/4 if incompressible, (1 − ν) J/2 at a constant Poisson's ratio,
//!   more with an elastic bulk ([`rheology::Material`]); two bodies add up.
//! * **Kernel**: [`InfluenceKernel::convolve`] returns K p in Pa·m; no factor of the transform is left over.
//! * **Datum**: on a half-space the approach is measured from the surface far away. On bodies periodic along both axes it is measured
//!   from the mean of the surface, in line contacts from the surface at a distance that is given with the kernel.
//! * **Heights** of maps and rough surfaces are positive out of the body that has them; the gap is the highest less each.
//! * **Motion**: displacements are those of the creeping bodies, which an indenter moves over with positive velocity along x1 or x2;
//!   the lateral force is the one that moves it.
//! * **Time**: bodies are undisturbed before t = 0. A step of length 0 is a jump of the load.
//!
//! # What costs what
//!
//! A convolution of N cells is one forward and one inverse real transform of the zero-padded grid,
//! O(N log N). Periodic bodies are not padded, and cost a third; a line of N × 1 cells is transformed as the line it is. A step of the default solver takes 3 to 5 of them on the scenes of the README at 256² cells, and
//! a scene without tilt does no work for it. Where gap and load are even in x1, x2 or both, half or a quarter of the cells is
//! computed ([`contact::Settings::symmetry`]); where contact cannot reach, nothing is ([`contact::Settings::window`]); what a step
//! takes, in every way there is, stands in `docs/performance.md`. Its history costs no transform: one field a relaxation time, however many
//! steps came before; thirty of them make a step of 256² cells 1.05 to 1.15 times as long as one. A rheology without an exact
//! exponential series has one fitted ([`rheology::Rheology::series`]), about two relaxation times a decade for an error
//! of 1e-4, in a tenth of a second. Memory: about 175 bytes a computed cell (360 of a line
//! contact, whose transforms' tables are as long as itself), and 8 for each further relaxation time, 16 where the grid follows the indenter
//! (an elastic bulk doubles their number); [`contact::Builder::memory`] tells it before a contact is built, and what there is no memory
//! for is an error ([`Error::OutOfMemory`]), not the end of the process; a step allocates nothing, save the first one
//! that takes time, if it has to fit a series, and those in which a window grows.
//!
//! # Co-simulation, and runs that last
//!
//! A step that fails leaves no trace, and may be tried again, shorter or under another load. A caller that iterates takes a
//! [`contact::Snapshot`], tries steps and restores it, without allocating. With the feature `checkpoint` the whole state goes to a file
//! and back; the steps that follow are the same to the last bit.
//!
//! # Features
//!
//! `checkpoint`: the state to a file and back ([`contact::Follow`]`::keeping`, `ViscoelasticContact::save` and `resume`).
//!
//! `csv` (on by default): tables of measured data from CSV files.
//!
//! `laws`: strategies of `proptest` for the tests of those who write a rheology, a geometry or a load history (`laws`).
//!
//! `npy`: fields to NPZ and NPY files, height maps from and to NPY files.
//!
//! `plot`: pictures of contacts and runs as PNG files and animated GIFs, with a font of their own.
//!
//! `vtk`: fields to VTK image data, a time series that ParaView opens.
//!
//! `x3p`: height maps from X3P files (ISO 25178-72).
//!
//! `tracing`: events of the `tracing` crate: steps accepted, rejected and failed, regions moved, series fitted.
//!
//! `rayon` (on by default): grids of 2¹⁵ computed cells or more are shared between the threads of the
//! pool a contact is built in. The answer does not depend on their number, bit by bit.
//!
//! # Not here
//!
//! Friction, adhesion, plasticity and finite deformation are outside the model: small strains and slopes, smooth normal contact.
//! Layers are bodies of the user's own: what a pressure does to them is given, not computed
//! ([`InfluenceKernel::from_coefficients`], [`InfluenceKernel::from_spectrum`]).
//!
//! # Beside other programs
//!
//! [Tamaas](https://gitlab.com/tamaas/tamaas) (C++ and Python) computes rough contacts, most of them periodic, with plasticity, adhesion and
//! friction, and has a solver for generalized Maxwell bodies;
//! [ContactMechanics](https://github.com/ContactEngineering/ContactMechanics) (Python) elastic half-spaces, periodic or not, with
//! contact plasticity, and adhesion in a package of its own; [CONTACT](https://www.kalkersoftware.org) (Fortran) rolling and sliding with
//! friction, conformal and transient, also of viscoelastic bodies. What they have of friction, adhesion and plasticity is not here. What
//! is here: any linear rheology, measured or fitted, in a recursion of second order whose cost does not grow with the number of steps;
//! eccentric loads that tilt; steps chosen by their error; all of it as a typed library that another program drives step by step.
//! How well it does is in `docs/validation.md` and `docs/accuracy.md`, claim by claim.

#![deny(missing_docs)]
#![forbid(unsafe_code)]
#![warn(missing_debug_implementations)]

pub mod analytic;
pub mod contact;
mod error;
mod events;
#[cfg(any(feature = "checkpoint", feature = "csv", feature = "npy", feature = "plot", feature = "vtk"))]
mod file;
pub mod geometry;
mod grid;
mod hereditary;
mod kernel;
#[cfg(feature = "laws")]
pub mod laws;
mod linalg;
pub mod load;
mod memory;
pub mod motion;
pub mod observe;
pub mod output;
pub mod plan;
#[cfg(feature = "plot")]
pub mod plot;
mod quadrature;
pub mod rheology;
mod solver;
mod sum;

pub use contact::ViscoelasticContact;
pub use error::{Convergence, Error, Result, Trend};
pub use grid::Grid;
pub use kernel::{InfluenceKernel, Workspace};

/// Everything a scene is written with.
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
        BodyState, Builder, Edge, Follow, Frame, Settings, Snapshot, Solver, SteadyMotion, StepReport, Stepping,
        TimeRule, ViscoelasticContact, Warning,
    };
    pub use crate::geometry::{
        Anisotropy, Cone, Cylinder, Ellipsoid, FlatPunch, FnGeometry, Form, Geometry, HeightMap, LengthUnit, Repeated,
        Rough, RoughSpec, Roughness, Shifted, Sphere, Sum, SurfaceStatistics, Wavy,
    };
    pub use crate::load::{FnHistory, Load, LoadHistory, PiecewiseLinear, Ramp, Sinusoid, StepLoad, Tilt};
    pub use crate::motion::{FnPath, Path, Straight, Travel};
    pub use crate::plan::{Accuracy, Plan};
    pub use crate::rheology::{
        Burgers, Elastic, FnRheology, FractionalMaxwell, FractionalZener, GeneralizedKelvin, GeneralizedMaxwell,
        KelvinVoigt, Kww, LogCreep, Material, Maxwell, PowerLaw, Rheology, SlowCreep, TabulatedCreep, TabulatedDynamic,
        TabulatedRelaxation, Zener,
    };
    pub use crate::{Error, Grid, InfluenceKernel, Result};
}

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
