//! The parts that a contact is built from.

pub(in crate::contact) mod build;
pub(in crate::contact) mod memory;
mod shared_gap;

use std::ops::{Range, RangeInclusive};
use std::sync::Arc;

use crate::Grid;
use crate::attraction::Attraction;
use crate::contact::{Settings, ViscoelasticContact};
use crate::error::Result;
use crate::geometry::{Geometry, Waves, evaluate};
use crate::kernel::InfluenceKernel;
use crate::load::LoadHistory;
use crate::motion::CounterMotion;
use crate::parallel::{Ranks, Rows};
use crate::rheology::{Material, TemperatureHistory};

/// Ratio of the shortest time of a run to the shortest time between corners of its load.
const SHORTEST_PART: f64 = 1e-6;
/// Number of corners of the load that are compared.
const MAX_CORNERS: usize = 1000;

/// The parts of a [`ViscoelasticContact`]; see [`ViscoelasticContact::builder`].
#[derive(Debug, Clone)]
#[must_use = "a builder does nothing until it is built"]
pub struct Builder {
    pub(crate) grid: Grid,
    /// The gap of each rigid body.
    pub(crate) gaps: Vec<LocalGap>,
    /// The waves of all of them.
    pub(crate) waves: Vec<Waves>,
    pub(crate) material: Option<Material>,
    pub(crate) counter_body: Option<Material>,
    /// What a creeping counter-body does in a steady motion.
    pub(crate) counter_motion: Option<CounterMotion>,
    pub(crate) times: Option<RunTimes>,
    pub(crate) temperature: Option<TemperatureHistory>,
    pub(crate) attraction: Option<Arc<dyn Attraction>>,
    pub(crate) kernel: Option<Arc<InfluenceKernel>>,
    pub(crate) settings: Settings,
    pub(crate) ranks: Option<Arc<dyn Ranks>>,
}

/// Rows of the grid, and a gap on them if there was memory for it.
pub(crate) type LocalGap = (Range<usize>, Result<Vec<f64>>);

impl ViscoelasticContact {
    /// A builder for a contact on `grid`.
    pub fn builder(grid: Grid) -> Builder {
        Builder {
            grid,
            gaps: Vec::new(),
            waves: Vec::new(),
            material: None,
            counter_body: None,
            counter_motion: None,
            times: None,
            temperature: None,
            attraction: None,
            kernel: None,
            settings: Settings::default(),
            ranks: None,
        }
    }
}

impl Builder {
    /// The shape of the rigid body: the gap before the bodies deform. Required; evaluated here, errors are
    /// reported by [`Builder::build`]. Replaces the shapes given before.
    pub fn geometry(mut self, geometry: &dyn Geometry) -> Builder {
        self.gaps.clear();
        self.waves.clear();
        self.another_body(geometry)
    }

    /// A further rigid body on the same creeping body, with a force, approach and tilt of its own: see
    /// [`ViscoelasticContact::step`]. Gaps are measured from the same plane; a cell can be touched by one
    /// body only, the one whose gap is lowest there.
    pub fn another_body(mut self, geometry: &dyn Geometry) -> Builder {
        let cells = self.grid.cells();
        let rows = self.ranks.as_ref().map_or(0..cells[0], |ranks| Rows::of_rank(cells, Arc::clone(ranks)).own());
        let gap = evaluate(geometry, &self.grid.part([rows.start, 0], [rows.len(), cells[1]]));
        self.gaps.push((rows, gap));
        self.waves.extend(geometry.waves());
        self
    }

    /// The material of the creeping body. Required. The other body is rigid unless [`Builder::counter_body`] gives its
    /// material.
    pub fn material(self, material: Material) -> Builder {
        Builder { material: Some(material), ..self }
    }

    /// The material of the other body, the one with the shape: elastic or creeping too. Both surfaces then
    /// deform: u is the sum of their displacements, and C(t) the sum of their compliances.
    pub fn counter_body(self, material: Material) -> Builder {
        Builder { counter_body: Some(material), ..self }
    }

    /// The loading times \[s\] over which the material is needed, from the shortest that matters to the end of the
    /// scene, both after the load first acts. Rheologies without an exact exponential series
    /// ([`PowerLaw`](crate::rheology::PowerLaw), closures) cannot be built without it: their series is fitted over
    /// these times to within [`Settings::series_tolerance`], and a step that ends later fails with
    /// [`StepError::BeyondMaterial`](crate::contact::StepError::BeyondMaterial). All others ignore it.
    ///
    /// The creep up to the shortest time counts as immediate, so that bodies without elastic response can start with
    /// a jump of the load.
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
    pub fn times(self, times: RangeInclusive<f64>) -> Builder {
        Builder { times: Some(RunTimes { range: times, of_run: false }), ..self }
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
        Builder { times: Some(RunTimes::of_run(history, until)), ..self }
    }

    /// A temperature that changes: all material then creeps in reduced time, ξ = ∫ dt/a_T(T(t)), with its times at
    /// the reference temperature of the law. The times of [`Builder::times`] and
    /// [`StepError::BeyondMaterial`](crate::contact::StepError::BeyondMaterial) are reduced times;
    /// [`Builder::times_of`] takes them from the run. A scene without one costs nothing more.
    ///
    /// A step fails where the temperature is outside the range of the law.
    pub fn temperature(self, history: TemperatureHistory) -> Builder {
        Builder { temperature: Some(history), ..self }
    }

    /// An influence kernel, or an [`Arc`] of one that other contacts on the same grid share; without one,
    /// [`InfluenceKernel::half_space`] is made.
    pub fn kernel(self, kernel: impl Into<Arc<InfluenceKernel>>) -> Builder {
        Builder { kernel: Some(kernel.into()), ..self }
    }

    /// Settings other than the defaults.
    pub fn settings(self, settings: Settings) -> Builder {
        Builder { settings, ..self }
    }

    /// The [ranks](crate::parallel) that share out the rows of the contact, each of which builds it from the same
    /// parts. Without it, this process computes all of it.
    ///
    /// Geometries given after this call are evaluated on the local rows alone; geometries before it on the whole
    /// grid, 8 bytes a cell.
    pub fn ranks(self, ranks: Arc<dyn Ranks>) -> Builder {
        Builder { ranks: Some(ranks), ..self }
    }
}

/// The times over which the series of a material is fitted.
#[derive(Debug, Clone)]
pub(crate) struct RunTimes {
    pub(super) range: RangeInclusive<f64>,
    /// Whether the times come from a run; a run fails where the material is not known.
    pub(super) of_run: bool,
}

impl RunTimes {
    /// The times of a run along `history` to the time `until`.
    pub(in crate::contact) fn of_run(history: &dyn LoadHistory, until: f64) -> RunTimes {
        let corners = history.breakpoints(0.0).take(MAX_CORNERS).take_while(|&next| next < until);
        let (shortest, _) = corners.fold((until, 0.0), |(least, corner), next| (f64::min(least, next - corner), next));
        RunTimes { range: SHORTEST_PART * shortest..=until, of_run: true }
    }

    /// The material, with a series over these times if it has no exact series.
    pub(in crate::contact) fn fit(
        &self,
        material: &Material,
        temperature: Option<&TemperatureHistory>,
        tolerance: f64,
    ) -> Result<Material> {
        let (mut first, mut last) = (*self.range.start(), *self.range.end());
        if self.of_run {
            if let Some(history) = temperature {
                (first, last) = (first * history.slowest(last)?, history.reduced_time(0.0, last)?);
            }
            last = last.min(material.known_until()).max(first);
        }
        material.fitted(first..=last, tolerance)
    }
}
