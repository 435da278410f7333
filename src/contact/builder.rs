//! Puts the parts of a contact together.

use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::Grid;
use crate::contact::memory::{Footprint, Memory, symmetry_of};
use crate::contact::region::Region;
use crate::contact::reside::symmetry;
use crate::contact::settings::{Frame, Settings, TimeRule};
use crate::contact::viscoelastic::{Parts, ViscoelasticContact};
use crate::error::{Error, KernelError, Result};
use crate::geometry::{Gap, Geometry, evaluate};
use crate::hereditary::{Direct, Exponential, History, Sources, Unfitted, Weighting};
use crate::kernel::InfluenceKernel;
use crate::rheology::Material;

/// Collects what a [`ViscoelasticContact`] is made of; see [`ViscoelasticContact::builder`].
#[derive(Debug, Clone)]
#[must_use = "a builder does nothing until it is built"]
pub struct Builder {
    grid: Grid,
    /// The gap field of each rigid body, if there was memory for it.
    gaps: Vec<Result<Vec<f64>>>,
    material: Option<Material>,
    counter_body: Option<Material>,
    times: Option<RangeInclusive<f64>>,
    kernel: Option<Arc<InfluenceKernel>>,
    settings: Settings,
}

impl Builder {
    pub(crate) fn new(grid: Grid) -> Builder {
        Builder {
            grid,
            gaps: Vec::new(),
            material: None,
            counter_body: None,
            times: None,
            kernel: None,
            settings: Settings::default(),
        }
    }

    /// The shape of the rigid body: the gap before the bodies deform. Required; evaluated here, errors are
    /// reported by [`Builder::build`]. Replaces what was given before.
    pub fn geometry(mut self, geometry: &dyn Geometry) -> Builder {
        self.gaps.clear();
        self.another_body(geometry)
    }

    /// A further rigid body on the same creeping one, with a force, approach and tilt of its own: see
    /// [`ViscoelasticContact::step_each`]. Gaps are measured from the same plane; a cell can be touched by one
    /// body only, the one whose gap is lowest there.
    pub fn another_body(mut self, geometry: &dyn Geometry) -> Builder {
        self.gaps.push(evaluate(geometry, &self.grid));
        self
    }

    /// The material of the creeping body. Required. The other body is rigid, unless
    /// [`Builder::counter_body`] says what it is made of.
    pub fn material(mut self, material: Material) -> Builder {
        self.material = Some(material);
        self
    }

    /// The material of the other body, the one with the shape: elastic or creeping too. Both surfaces then give
    /// way, u is the sum of their displacements, and C(t) that of their compliances.
    pub fn counter_body(mut self, material: Material) -> Builder {
        self.counter_body = Some(material);
        self
    }

    /// The times \[s\] over which the material is wanted, from the shortest that matters to the end of the
    /// scene, both after the load first acts. Only rheologies without an exact exponential series
    /// ([`PowerLaw`](crate::rheology::PowerLaw), closures) look at it: their series is fitted over these times to
    /// within [`Settings::series_tolerance`], and a step that ends later fails with
    /// [`Error::BeyondMaterial`].
    ///
    /// Without it, the first step that takes time decides, here of length Δ: from Δ/100 to 10⁶ Δ, or to the end of the run if
    /// [`ViscoelasticContact::follow`] knows a later one. A body without elastic response can then not start with a
    /// jump of the load that presses it; with it, what it has crept by the shortest time counts as immediate.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(PowerLaw::new(1.0e-6, 1.0, 0.3)?))
    ///     .times(1.0e-2..=1.0e2)
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// contact.step(1.0, Load::force(0.5))?;
    /// let fit = contact.material().fit_reports().next().unwrap();
    /// assert!(fit.max_misfit() <= 1.0e-4);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn times(mut self, times: RangeInclusive<f64>) -> Builder {
        self.times = Some(times);
        self
    }

    /// An influence kernel to share with other contacts on the same grid; without one,
    /// [`InfluenceKernel::half_space`] is made.
    pub fn kernel(mut self, kernel: Arc<InfluenceKernel>) -> Builder {
        self.kernel = Some(kernel);
        self
    }

    /// Choices other than the defaults.
    pub fn settings(mut self, settings: Settings) -> Builder {
        self.settings = settings;
        self
    }

    /// Makes the contact: undisturbed bodies at time 0, without load.
    ///
    /// # Errors
    /// If geometry or material is missing, a gap is NaN or −∞ or none is finite, a rheology is known until NaN, a setting is out of range, the kernel was made
    /// for another grid, there is none for its cells ([`InfluenceKernel::half_space`]), no series of the material over
    /// [`Builder::times`] is within the tolerance, these are more than 50 decades, or the rectangle rule was chosen for a
    /// rheology without elastic response. If there is no memory for it: [`Error::OutOfMemory`], before any is taken; a scene that
    /// would fit the machine, but not beside what else runs there, may be granted all the same by systems that promise more
    /// than they have, as Linux does. If more than 2³² − 1 cells would be computed.
    pub fn build(mut self) -> Result<ViscoelasticContact> {
        self.settings.validate()?;
        let bodies = self.bodies()?;
        let gaps = std::mem::take(&mut self.gaps).into_iter().collect::<Result<_>>()?;
        let initial_gap = Gap::new(gaps, &self.grid)?;
        let (material, kernel, history) = self.parts()?;
        let Builder { grid, settings, .. } = self;
        let folded = if settings.symmetry { symmetry(&initial_gap, grid.cells()) } else { [false; 2] };
        let region = if windowed(&settings, &history, &kernel) {
            // without load, each body is above the cell that it would touch first
            Region::first_touched(&grid, folded, &initial_gap, bodies)
        } else {
            Region::whole(&grid, folded)
        };
        let footprint = Footprint { all: grid.len(), bodies, settings: &settings, kernel: &kernel, history: &history };
        footprint.check(region.computed(), 0)?;
        Ok(ViscoelasticContact::new(Parts { grid, bodies, region, kernel, settings, initial_gap, material, history }))
    }

    /// What the contact takes, before it is built: no field is made for it. Which cells are computed follows from the gap, as
    /// [`Settings::symmetry`] does; with [`Settings::window`] it is the most that the contact can take when its
    /// window has grown. A load that breaks the symmetry has the cells computed that were its mirror images: for what
    /// that takes, set it to false. Where there is not even memory for the gap, it counts as not symmetric.
    ///
    /// A series of the material over [`Builder::times`] is fitted for it, in a tenth of a second. Threads are those of the pool that it
    /// is called in.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let scene = |cells: usize| {
    ///     Ok::<_, Error>(ViscoelasticContact::builder(Grid::square(cells, 4.0e-3)?)
    ///         .geometry(&Sphere::new(10.0e-3)?)
    ///         .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?)))
    /// };
    /// let memory = scene(256)?.memory()?;
    /// assert_eq!(memory.computed_cells, 128 * 128);
    /// assert!(memory.total() < 6_000_000, "{memory}");
    /// // more than any machine has: told, and refused
    /// assert!(scene(1 << 25)?.memory()?.total() > 1 << 57);
    /// assert!(matches!(scene(1 << 25)?.build(), Err(Error::OutOfMemory { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Builder::build`], but for what is wrong with a gap, and for memory.
    pub fn memory(&self) -> Result<Memory> {
        self.settings.validate()?;
        let bodies = self.bodies()?;
        let (_, kernel, history) = self.parts()?;
        let (settings, cells) = (&self.settings, self.grid.cells());
        let gaps: Option<Vec<_>> = self.gaps.iter().map(|gap| gap.as_ref().ok()).collect();
        let folded = gaps.filter(|_| settings.symmetry).map_or([false; 2], |gaps| symmetry_of(&gaps, cells));
        let footprint = Footprint { all: self.grid.len(), bodies, settings, kernel: &kernel, history: &history };
        Ok(footprint.most(cells, folded, windowed(settings, &history, &kernel)))
    }

    /// Number of rigid bodies.
    fn bodies(&self) -> Result<usize> {
        match self.gaps.len() {
            0 => Err(Error::Missing { part: "geometry" }),
            bodies if bodies > usize::from(u16::MAX) => {
                Err(Error::CountOutOfRange { field: "rigid bodies", value: bodies, allowed: "65535 at most" })
            }
            bodies => Ok(bodies),
        }
    }

    /// Material, kernel and past, as far as they are known before a step.
    fn parts(&self) -> Result<(Material, Arc<InfluenceKernel>, History)> {
        let mut material = self.material.clone().ok_or(Error::Missing { part: "material" })?;
        if let Some(other) = self.counter_body.clone() {
            material = material.against(other);
        }
        material.validate()?;
        let kernel = match &self.kernel {
            Some(kernel) if *kernel.grid() != self.grid => {
                let [kernel, contact] = [kernel.grid(), &self.grid].map(|grid| (grid.cells(), grid.spacing()));
                return Err(KernelError::WrongGrid { kernel, contact }.into());
            }
            Some(kernel) => Arc::clone(kernel),
            None => Arc::new(InfluenceKernel::half_space(&self.grid)?),
        };
        let history = history(&mut material, self.times.clone(), &self.settings, kernel.periodic_axes())?;
        Ok((material, kernel, history))
    }
}

/// Whether only a part of the grid is computed. Elsewhere than on a half-space nothing is known of the displacement beyond
/// a window.
fn windowed(settings: &Settings, history: &History, kernel: &InfluenceKernel) -> bool {
    settings.window && matches!(history, History::Exponential(_)) && kernel.is_half_space()
}

/// The home of the past that a time rule needs, on no cells yet; `material` is fitted if there is a need and its times are known.
fn history(
    material: &mut Material,
    times: Option<RangeInclusive<f64>>,
    settings: &Settings,
    periodic: [bool; 2],
) -> Result<History> {
    let glassy = material.checked_compliance(0.0, (0.0, 0.0))?;
    let direct = |weighting| Ok(History::Direct(Direct::new(material.clone(), weighting, settings.history_limit)));
    match settings.time_rule {
        TimeRule::Rectangle | TimeRule::Backward if settings.frame == Frame::Indenter => {
            return Err(Error::WrongFrame { what: "a direct sum" });
        }
        TimeRule::Rectangle if glassy == 0.0 => {
            return Err(Error::NoElasticResponse { time: 0.0, what: "the rectangle rule" });
        }
        TimeRule::Rectangle => return direct(Weighting::End),
        TimeRule::Backward => return direct(Weighting::Start),
        TimeRule::Automatic | TimeRule::Exponential => {}
    }
    if let Some(times) = times {
        *material = material.fitted(times, settings.series_tolerance)?;
    }
    Ok(match material.contact_spectrum()? {
        Some(creep) if settings.frame == Frame::Indenter => History::Sources(Box::new(Sources::new(&creep, periodic))),
        None if settings.frame == Frame::Indenter => return Err(material.no_series("Frame::Indenter")),
        Some(creep) => History::Exponential(Exponential::new(&creep, 0)),
        None => History::Unfitted(Box::new(Unfitted::new(material.clone(), settings.series_tolerance))),
    })
}
