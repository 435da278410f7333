//! A contact: what it holds, and how it is put together.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use crate::Grid;
use crate::contact::builder::Builder;
#[cfg(feature = "checkpoint")]
use crate::contact::checkpoint::Built;
use crate::contact::follow::Progress;
use crate::contact::hull::Hull;
use crate::contact::loads::first_touch;
use crate::contact::region::Region;
use crate::contact::reside::Beyond;
use crate::contact::settings::{Settings, Solver};
use crate::contact::state::State;
use crate::geometry::Gap;
use crate::hereditary::History;
use crate::kernel::{InfluenceKernel, LocalKernel, Workspace};
use crate::rheology::Material;
use crate::solver::{ActiveSet, Freedom, PolonskyKeer, Solution};

/// A rigid indenter pressed onto a creeping half-space: the pressure between them, the area they touch
/// on, and how both change with time.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let grid = Grid::square(64, 4.0e-3)?;
/// let mut contact = ViscoelasticContact::builder(grid)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// contact.step(0.0, Load::force(1.0))?; // Δ = 0: the load jumps
/// let before = contact.contact_area();
/// contact.step(0.5, Load::force(1.0))?; // hold it
/// assert!(contact.contact_area() > before);
/// assert!((contact.force() - 1.0).abs() < 1e-12);
/// # Ok::<(), viscocontact::Error>(())
/// ```
///
/// Force and approach may take turns, from step to step:
///
/// ```
/// # use viscocontact::prelude::*;
/// # let mut contact = ViscoelasticContact::builder(Grid::square(64, 4.0e-3)?)
/// #     .geometry(&Sphere::new(10.0e-3)?)
/// #     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
/// #     .build()?;
/// contact.step(0.0, Load::force(1.0))?;
/// let depth = contact.approach();
/// contact.step(1.0, Load::approach(depth))?; // hold the approach: the force relaxes
/// assert!(contact.force() < 0.5);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone)]
pub struct ViscoelasticContact {
    pub(super) grid: Grid,
    pub(super) kernel: Arc<InfluenceKernel>,
    /// The part of the grid that is computed: every field below lives there, unless it says otherwise.
    pub(super) region: Region,
    pub(super) kernel_here: LocalKernel,
    pub(super) work: Workspace,
    /// What lies beyond; nothing if the region and its mirror images are the whole grid.
    pub(super) beyond: Option<Beyond>,
    /// What it was before the step being tried moved it to another region.
    pub(super) before_move: Option<Box<ViscoelasticContact>>,
    /// Room for the gap of a step along a path, and of what the path lies over; made by the first.
    pub(super) spare_gap: Vec<f64>,
    pub(super) spare_track: Vec<f64>,
    /// How far the indenter moves over the bodies in the step being tried \[cells\].
    pub(super) stride: [isize; 2],
    pub(super) settings: Settings,
    pub(super) solver: ContactSolver,
    pub(super) material: Material,
    pub(super) history: History,
    /// What it was built of: what tells scenes apart.
    #[cfg(feature = "checkpoint")]
    pub(super) built: Arc<Built>,
    /// How far the run had come that was saved and resumed, for the next to go on.
    pub(super) progress: Option<Box<Progress>>,
    /// Which contact it is, clones included, and which gap it has.
    pub(super) id: u64,
    pub(super) gap_id: u64,
    /// On the whole grid.
    pub(super) initial_gap: Gap,
    /// The part of it that is computed, if that is not all.
    pub(super) gap_here: Option<Gap>,
    /// Where loads may act, for each body; made when one is first free to tilt.
    pub(super) hulls: Vec<Option<Hull>>,

    pub(super) state: State,
    /// Pressure on the whole grid, if not all of it is computed.
    pub(super) shown: Vec<f64>,
    /// Displacement on the whole grid, once it was asked for.
    pub(super) whole_displacement: OnceLock<Vec<f64>>,
    /// The step being tried; thrown away if it fails.
    pub(super) trial: Solution,
    /// Between steps the displacement before the last one, which the history has yet to take in.
    pub(super) trial_displacement: Vec<f64>,
    pub(super) gap: Vec<f64>,
    pub(super) freedoms: Vec<Freedom>,
}

#[derive(Debug, Clone)]
pub(crate) enum ContactSolver {
    ActiveSet(Box<ActiveSet>),
    PolonskyKeer(PolonskyKeer),
}

/// A number that nothing else has in this process.
pub(super) fn next_id() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// What a builder puts together.
pub(crate) struct Parts {
    pub(crate) grid: Grid,
    /// Number of rigid bodies.
    pub(crate) bodies: usize,
    /// What is computed at first.
    pub(crate) region: Region,
    pub(crate) kernel: Arc<InfluenceKernel>,
    pub(crate) settings: Settings,
    pub(crate) initial_gap: Gap,
    pub(crate) material: Material,
    pub(crate) history: History,
}

impl ContactSolver {
    pub(super) fn new(solver: Solver, kernel: &LocalKernel, bodies: usize) -> ContactSolver {
        match solver {
            Solver::ActiveSet => ContactSolver::ActiveSet(Box::new(ActiveSet::new(kernel, bodies))),
            Solver::PolonskyKeer => ContactSolver::PolonskyKeer(PolonskyKeer::new(kernel.grid().len(), bodies)),
        }
    }
}

impl ViscoelasticContact {
    /// Starts to put a contact together on `grid`.
    pub fn builder(grid: Grid) -> Builder {
        Builder::new(grid)
    }

    pub(crate) fn new(parts: Parts) -> ViscoelasticContact {
        let Parts { grid, bodies, region, kernel, settings, initial_gap, material, mut history } = parts;
        #[cfg(feature = "checkpoint")]
        let built = Arc::new(Built::new(&material, &initial_gap, grid.cells()));
        let cells = region.len();
        history.undisturbed_on(region.cells());
        let kernel_here = kernel.on(region.grid(), region.folded());
        let beyond = match &history {
            History::Exponential(history) if !region.covers() => Some(Beyond::new(history, cells)),
            _ => None,
        };
        let nothing_free = Freedom { translation: false, tilt: [false; 2], point: [0.0; 2], total: 0.0 };
        let mut contact = ViscoelasticContact {
            work: kernel_here.workspace(),
            solver: ContactSolver::new(settings.solver, &kernel_here, bodies),
            kernel_here,
            gap_here: region.cut_gap(&initial_gap),
            region,
            beyond,
            before_move: None,
            spare_gap: Vec::new(),
            spare_track: Vec::new(),
            stride: [0; 2],
            shown: Vec::new(),
            whole_displacement: OnceLock::new(),
            hulls: vec![None; bodies],
            state: State::at_rest(cells, (0..bodies).map(|body| first_touch(&initial_gap, body)).collect()),
            trial: Solution::zero(cells, bodies),
            trial_displacement: vec![0.0; cells],
            gap: vec![0.0; cells],
            freedoms: vec![nothing_free; bodies],
            grid,
            kernel,
            settings,
            material,
            history,
            #[cfg(feature = "checkpoint")]
            built,
            progress: None,
            id: next_id(),
            gap_id: next_id(),
            initial_gap,
        };
        contact.survey();
        contact.show();
        contact
    }
}
