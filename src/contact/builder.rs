//! Puts the parts of a contact together.

use std::sync::Arc;

use crate::Grid;
use crate::contact::settings::{Settings, Solver, TimeRule};
use crate::contact::stepper::{ContactSolver, ViscoelasticContact};
use crate::error::{Error, Result};
use crate::geometry::{Gap, Geometry, evaluate};
use crate::hereditary::{Direct, Exponential, History, Weighting};
use crate::kernel::InfluenceKernel;
use crate::rheology::Material;
use crate::solver::{ActiveSet, PolonskyKeer};

/// Collects what a [`ViscoelasticContact`] is made of; see [`ViscoelasticContact::builder`].
#[derive(Debug, Clone)]
#[must_use = "a builder does nothing until it is built"]
pub struct Builder {
    grid: Grid,
    /// The gap field of each rigid body.
    gaps: Vec<Vec<f64>>,
    material: Option<Material>,
    kernel: Option<Arc<InfluenceKernel>>,
    settings: Settings,
}

impl Builder {
    pub(crate) fn new(grid: Grid) -> Builder {
        Builder { grid, gaps: Vec::new(), material: None, kernel: None, settings: Settings::default() }
    }

    /// The shape of the rigid body: the gap before the bodies deform. Required; evaluated here, errors are
    /// reported by [`Builder::build`]. Replaces what was given before.
    pub fn geometry(mut self, geometry: &dyn Geometry) -> Builder {
        self.gaps = vec![evaluate(geometry, &self.grid)];
        self
    }

    /// A further rigid body on the same creeping one, with a force, approach and tilt of its own: see
    /// [`ViscoelasticContact::step_each`]. Gaps are measured from the same plane; a cell can be touched by one
    /// body only, the one whose gap is lowest there.
    pub fn another_body(mut self, geometry: &dyn Geometry) -> Builder {
        self.gaps.push(evaluate(geometry, &self.grid));
        self
    }

    /// The material of the creeping body; the other one is rigid. Required.
    pub fn material(mut self, material: Material) -> Builder {
        self.material = Some(material);
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
    /// If geometry or material is missing, a gap is NaN or −∞ or none is finite, a setting is out of
    /// range, the kernel was made for another grid, the exponential rule was chosen for a rheology
    /// without a series, or the rectangle rule for one without elastic response.
    pub fn build(self) -> Result<ViscoelasticContact> {
        let Builder { grid, gaps, material, kernel, settings } = self;
        settings.validate()?;
        if gaps.is_empty() {
            return Err(Error::Missing { part: "geometry" });
        }
        if gaps.len() > usize::from(u16::MAX) {
            return Err(Error::CountOutOfRange { field: "rigid bodies", value: gaps.len(), allowed: "65535 at most" });
        }
        let (bodies, gap) = (gaps.len(), Gap::new(&gaps, &grid)?);
        let material = material.ok_or(Error::Missing { part: "material" })?;
        let history = history(&material, settings.time_rule, grid.len())?;
        let kernel = match kernel {
            Some(kernel) if *kernel.grid() != grid => {
                return Err(Error::KernelMismatch { kernel: kernel.grid().clone(), contact: grid });
            }
            Some(kernel) => kernel,
            None => Arc::new(InfluenceKernel::half_space(&grid)?),
        };
        let solver = match settings.solver {
            Solver::ActiveSet => ContactSolver::ActiveSet(Box::new(ActiveSet::new(&grid, bodies))),
            Solver::PolonskyKeer => ContactSolver::PolonskyKeer(PolonskyKeer::new(grid.len(), bodies)),
        };
        Ok(ViscoelasticContact::new(grid, bodies, kernel, settings, gap, history, solver))
    }
}

/// The home of the past that a time rule needs.
fn history(material: &Material, rule: TimeRule, cells: usize) -> Result<History> {
    let glassy = material.creep_compliance(0.0);
    if !(glassy.is_finite() && glassy >= 0.0) {
        return Err(Error::InvalidCompliance { time: 0.0, value: glassy, previous: 0.0 });
    }
    let direct = |weighting| Ok(History::Direct(Direct::new(material.clone(), weighting)));
    match (rule, material.contact_spectrum()?) {
        (TimeRule::Automatic | TimeRule::Exponential, Some(creep)) => {
            Ok(History::Exponential(Exponential::new(&creep, cells)))
        }
        (TimeRule::Exponential, None) => Err(material.no_series()),
        (TimeRule::Rectangle, _) if glassy == 0.0 => {
            Err(Error::NoElasticResponse { time: 0.0, what: "the rectangle rule" })
        }
        (TimeRule::Rectangle, _) => direct(Weighting::End),
        (TimeRule::Backward, _) | (TimeRule::Automatic, None) => direct(Weighting::Start),
    }
}
