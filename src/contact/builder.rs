//! Builds a contact from its parts.

use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::Grid;
#[cfg(feature = "checkpoint")]
use crate::contact::checkpoint::built::Built;
use crate::contact::domain::Domain;
use crate::contact::footprint::{Computed, Footprint, Memory, symmetry_of};
use crate::contact::indenter::Indenter;
use crate::contact::scene::Scene;
use crate::contact::settings::{Settings, TimeRule};
use crate::contact::state::State;
use crate::contact::time_rule::{history_by, windowed};
use crate::contact::times::Times;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::contact::window::region::Region;
use crate::error::{Error, KernelError, Result};
use crate::geometry::{Gap, Geometry, evaluate};
use crate::hereditary;
use crate::kernel::InfluenceKernel;
use crate::load::LoadHistory;
use crate::rheology::Material;

/// The parts of a [`ViscoelasticContact`]; see [`ViscoelasticContact::builder`].
#[derive(Debug, Clone)]
#[must_use = "a builder does nothing until it is built"]
pub struct Builder {
    grid: Grid,
    /// The gap of each rigid body, if there was memory for it.
    gaps: Vec<Result<Vec<f64>>>,
    material: Option<Material>,
    counter_body: Option<Material>,
    times: Option<Times>,
    kernel: Option<Arc<InfluenceKernel>>,
    settings: Settings,
}

impl ViscoelasticContact {
    /// A builder for a contact on `grid`.
    pub fn builder(grid: Grid) -> Builder {
        Builder::new(grid)
    }
}

impl Builder {
    fn new(grid: Grid) -> Builder {
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

    /// The material of the creeping body. Required. The other body is rigid unless [`Builder::counter_body`] gives its
    /// material.
    pub fn material(mut self, material: Material) -> Builder {
        self.material = Some(material);
        self
    }

    /// The material of the other body, the one with the shape: elastic or creeping too. Both surfaces then
    /// deform: u is the sum of their displacements, and C(t) that of their compliances.
    pub fn counter_body(mut self, material: Material) -> Builder {
        self.counter_body = Some(material);
        self
    }

    /// The loading times \[s\] over which the material is needed, from the shortest that matters to the end of the scene,
    /// both after the load first acts. Rheologies without an exact exponential series
    /// ([`PowerLaw`](crate::rheology::PowerLaw), closures) cannot be built without it: their series is fitted over these
    /// times to within [`Settings::series_tolerance`], and a step that ends later fails with [`Error::BeyondMaterial`]. All
    /// others ignore it.
    ///
    /// The creep up to the shortest time counts as immediate, so that bodies without elastic response can start with a jump
    /// of the load.
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
        self.times = Some(Times::new(times));
        self
    }

    /// [`Builder::times`] of a run along `history` that ends at `until` \[s\]: from a millionth of the shortest time between
    /// two corners of the load, or of the whole run if there are none, to its end, as far as the material is known.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let ramp = Ramp::new(Load::force(0.0), Load::force(0.5), 1.0)?;
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(PowerLaw::new(1.0e-6, 1.0, 0.3)?))
    ///     .times_of(&ramp, 10.0)
    ///     .build()?;
    /// let mut run = contact.follow(&ramp, Stepping::fixed(0.5), 10.0);
    /// while run.next_step()?.is_some() {}
    /// assert!((contact.force() - 0.5).abs() < 1.0e-12);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn times_of(self, history: &dyn LoadHistory, until: f64) -> Builder {
        Builder { times: Some(Times::of_run(history, until)), ..self }
    }

    /// An influence kernel to share with other contacts on the same grid; without one,
    /// [`InfluenceKernel::half_space`] is made.
    pub fn kernel(mut self, kernel: Arc<InfluenceKernel>) -> Builder {
        self.kernel = Some(kernel);
        self
    }

    /// Settings other than the defaults.
    pub fn settings(mut self, settings: Settings) -> Builder {
        self.settings = settings;
        self
    }

    /// Makes the contact: undisturbed bodies at time 0, without load.
    ///
    /// # Errors
    /// If geometry or material is missing, a gap is NaN or −∞ or none is finite, a rheology is known until NaN, a setting is
    /// out of range, the kernel was made for another grid or cannot be made for its cells
    /// ([`InfluenceKernel::half_space`]), or the rectangle rule was chosen for a rheology without elastic response.
    ///
    /// If a rheology without an exact series is given no [`Builder::times`] ([`Error::NoExponentialSeries`]), no series is
    /// within the tolerance, or the times span more than 50 decades.
    ///
    /// If there is not enough memory ([`Error::OutOfMemory`], before any is taken; systems that overcommit memory, as Linux
    /// does, may grant more than is free), or more than 2³² − 1 cells would be computed.
    pub fn build(mut self) -> Result<ViscoelasticContact> {
        self.settings.validate()?;
        let bodies = self.bodies()?;
        let gaps = std::mem::take(&mut self.gaps).into_iter().collect::<Result<_>>()?;
        let indenter = Indenter::new(Gap::new(gaps, &self.grid)?, bodies);
        let (material, kernel, history) = self.parts()?;
        let Builder { grid, settings, .. } = self;
        let folded = if settings.symmetry { indenter.even_axes(&grid) } else { [false; 2] };
        let region = if windowed(&settings, &history, &kernel) {
            // without load, each body is above the cell that it would touch first
            Region::first_touched(&grid, folded, indenter.gap(), bodies)
        } else {
            Region::whole(&grid, folded)
        };
        let footprint = Footprint { all: grid.len(), bodies, settings: &settings, kernel: &kernel, history: &history };
        footprint.check(Computed::on(&region), 0)?;
        let scene = Scene {
            #[cfg(feature = "checkpoint")]
            built: Built::new(indenter.gap(), grid.cells()),
            grid,
            kernel,
            material,
            settings,
            bodies,
        };
        let history = history.undisturbed_on(region.cells(), !region.covers());
        let state = State::at_rest(Arc::new(indenter), region, history);
        let domain = Domain::new(&scene, state);
        Ok(ViscoelasticContact::new(scene, domain))
    }

    /// The memory that the contact will take; no field is allocated to find out. The cells that are computed follow from the
    /// symmetry of the gap ([`Settings::symmetry`]); with [`Settings::window`] the figure is that of the largest window. A
    /// load that breaks the symmetry makes the contact compute the mirror images too: set symmetry to false for what that
    /// takes. Where there is not even memory for the gap, it counts as asymmetric.
    ///
    /// A series of the material over [`Builder::times`] is fitted for it, in a tenth of a second. Threads are those of the
    /// pool in which it is called.
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
    /// // more than any machine has: reported, and rejected
    /// assert!(scene(1 << 25)?.memory()?.total() > 1 << 57);
    /// assert!(matches!(scene(1 << 25)?.build(), Err(Error::OutOfMemory { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Builder::build`], except for invalid gaps and for memory.
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

    /// Material, kernel, and the memory of the bodies on no cells yet.
    fn parts(&self) -> Result<(Material, Arc<InfluenceKernel>, hereditary::History)> {
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
        if let Some(times) = &self.times
            && self.settings.time_rule == TimeRule::Exponential
        {
            material = times.fit(&material, self.settings.series_tolerance)?;
        }
        let history = history_by(&self.settings, &material, kernel.periodic_axes())?;
        Ok((material, kernel, history))
    }
}
