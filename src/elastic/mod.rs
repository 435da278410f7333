//! Elastic contacts: rigid bodies on an elastic body, without time.
//!
//! [`ElasticContact`] finds pressure, contact and motions under a load: the contact problem that every step of a creeping contact
//! solves, with a compliance that stays. Solutions follow each other as loads do: each begins from the one before, so
//! that a sweep over loads costs a few convolutions a load.
//!
//! One's own step loop stands on it, too: a creeping body whose history no series describes has at each step a
//! compliance, and a surface that the past has displaced ([`ElasticContact::set_surface`]).

mod builder;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub use builder::ElasticBuilder;

use crate::equilibrium::constraints::{acceptable, below_full_contact, converged, find_free_motions, validate_loads};
use crate::equilibrium::guess::initial_guess;
use crate::equilibrium::indenter::even_axes;
use crate::equilibrium::pressed::Pressed;
use crate::equilibrium::spring::{guess_forces, solve_with_springs};
use crate::equilibrium::window::fields::transfer_by_role;
use crate::equilibrium::window::growth::{OnRegion, solve_on_growing_region};
use crate::equilibrium::window::placement::{outgrown, region_for};
use crate::equilibrium::{Figures, Ground, Held, Indenter, Region, Request, RigidBodies, Trial, Window};
use crate::equilibrium::{modulus_of_no_solid, windowed};
use crate::error::{Result, exact_length, finite};
use crate::fields::report::StepReport;
use crate::fields::{About, Fields, Surface, View};
use crate::load::Load;
use crate::parallel::in_pool;
use crate::solver::Stop;
use crate::{Grid, memory};

/// Rigid bodies pressed onto an elastic body: pressure, contact area and motions under a load.
///
/// ```
/// use viscocontact::elastic::ElasticContact;
/// use viscocontact::prelude::*;
///
/// let mut contact = ElasticContact::builder(Grid::square(64, 3.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .modulus(4.0e6) // E* = E/(1 − ν²) in Pa
///     .build()?;
/// for force in [0.1, 0.2, 0.4] {
///     let report = contact.solve(Load::force(force))?;
///     println!("{report}");
/// }
/// let hertz = 3.0 * 0.4 * 10.0e-3 / (4.0 * 4.0e6_f64); // a³
/// let area = std::f64::consts::PI * hertz.powf(2.0 / 3.0);
/// assert!((contact.fields().contact_area() / area - 1.0).abs() < 5.0e-3);
/// # Ok::<(), Error>(())
/// ```
///
/// Several bodies, free tilts and springs are loads and shapes as in a
/// [`ViscoelasticContact`](crate::ViscoelasticContact), and
/// [`Fields`] is what is read of either.
#[derive(Debug, Clone)]
pub struct ElasticContact {
    ground: Arc<Ground>,
    /// C of u = u_old + C K p \[1/Pa\].
    compliance: f64,
    own: Solver,
    view: View,
}

/// An equilibrium on its region, with what computes there. A solution that needs a larger region continues in a copy.
#[derive(Debug, Clone)]
struct Solver {
    held: Held,
    window: Window,
    trial: Trial,
    /// The displacement before any pressure, if there is one.
    before: Option<Vec<f64>>,
    displacement: Vec<f64>,
}

/// A load on an elastic body of compliance `c`.
#[derive(Clone, Copy)]
struct Asked<'a> {
    ground: &'a Ground,
    request: Request<'a>,
    c: f64,
}

impl ElasticContact {
    /// A builder for a contact on `grid`.
    pub fn builder(grid: Grid) -> ElasticBuilder {
        ElasticBuilder::new(grid)
    }

    pub(crate) fn new(ground: Arc<Ground>, compliance: f64, indenter: Arc<Indenter>) -> Result<ElasticContact> {
        let folded = if ground.settings.symmetry { indenter.even_axes(&ground.grid) } else { [false; 2] };
        let region = ground.first_region(folded, &indenter, windowed(&ground));
        ground.check_cells(&region)?;
        memory::check("the contact", ElasticContact::bytes(&ground, &region).into())?;
        let own = Solver::new(&ground, Held::at_rest(indenter, region), None);
        let mut view = View::default();
        view.refresh(&own.held);
        Ok(ElasticContact { ground, compliance, own, view })
    }

    /// Bytes of a contact that computes a region.
    fn bytes(ground: &Ground, region: &Region) -> u64 {
        let [grid, solver, kernel] = ground.bytes_on(region);
        // p and v that are held, and the displacement
        grid + solver + kernel + (Trial::BYTES_PER_CELL + 24) as u64 * region.len() as u64
    }

    /// Finds the equilibrium under one [`Load`], or a load for each rigid body in the order of the builder: from the
    /// last one, which a failure leaves as it is. A solution after a similar load costs about five convolutions.
    ///
    /// ```
    /// use viscocontact::elastic::ElasticContact;
    /// use viscocontact::prelude::*;
    ///
    /// // a punch that may tilt is pressed beside its middle
    /// let mut contact = ElasticContact::builder(Grid::square(64, 3.0e-3)?)
    ///     .geometry(&FlatPunch::circular(1.0e-3)?)
    ///     .modulus(1.0e6)
    ///     .build()?;
    /// contact.solve(Load::eccentric_force(1.0, [0.2e-3, 0.0]))?;
    /// assert!(contact.fields().tilt()[0] > 0.0);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If a force is negative, a number not finite, a force acts where it would topple the body, contact reaches the
    /// edge of the grid (unless [`Edge::Allow`](crate::contact::Edge::Allow)), an approach closes every gap of
    /// periodic bodies, a layer on a rigid base is pressed through, the solver does not converge, there is no memory
    /// for the cells that the contact reaches, or there is not one load for each body.
    pub fn solve(&mut self, loads: impl AsRef<[Load]>) -> Result<StepReport> {
        self.solve_to(self.ground.settings.tolerance, None, loads.as_ref())
    }

    /// [`ElasticContact::solve`], ended within an iteration where another thread sets `cancelled`.
    ///
    /// # Errors
    /// As [`ElasticContact::solve`], and [`Error::Cancelled`](crate::Error::Cancelled).
    pub fn solve_unless(&mut self, cancelled: &AtomicBool, loads: impl AsRef<[Load]>) -> Result<StepReport> {
        self.solve_to(self.ground.settings.tolerance, Some(cancelled), loads.as_ref())
    }

    fn solve_to(&mut self, tolerance: f64, cancelled: Option<&AtomicBool>, loads: &[Load]) -> Result<StepReport> {
        let indenter = &Arc::clone(&self.own.held.indenter);
        let request = Request { time: 0.0, length: 0.0, loads, indenter, tolerance, cancelled };
        let (ground, c, mut larger) = (&*self.ground, self.compliance, None);
        let asked = Asked { ground, request, c };
        let sum = in_pool(self.own.held.region.len(), || compute(&mut self.own, &mut larger, asked))?;
        if let Some(larger) = larger {
            self.own = *larger;
        }
        let pressed = self.own.accept(ground, request, c, sum);
        self.view.refresh(&self.own.held);
        Ok(self.report(&pressed))
    }

    /// The report of a jump at time 0.
    fn report(&self, pressed: &Pressed) -> StepReport {
        let (ground, Solver { held, .. }) = (&self.ground, &self.own);
        let modulus = modulus_of_no_solid(self.compliance);
        let figures = Figures { modulus, ..held.figures(ground, pressed) };
        let warnings = held.warnings(ground, pressed.reach, &figures);
        StepReport { warnings, figures, ..StepReport::solved(self.fields()) }
    }

    /// The displacement \[m\] that the surface has before any pressure, positive into the bodies, one value per cell:
    /// the next solution adds C K p to it. Fields keep those of the last solution until then. All of the grid is
    /// computed from here on, but for mirror images.
    ///
    /// # Errors
    /// If there is not one finite value per cell, or no memory for all cells. The surface then stays as it is.
    pub fn set_surface(&mut self, displacement: &[f64]) -> Result<()> {
        let grid = &self.ground.grid;
        exact_length("displacement of the surface", displacement.len(), grid.len())?;
        displacement.iter().try_for_each(|u| finite("displacement of the surface", *u).map(drop))?;
        let even = even_axes(grid.cells(), |k, mirror| displacement[k] == displacement[mirror]);
        let folded = self.own.held.region.folded();
        let region = Region::whole(grid, [0, 1].map(|axis| folded[axis] && even[axis]));
        let before = Some(region.cut(displacement).collect());
        if region == self.own.held.region {
            self.own.before = before;
        } else {
            let mut own = self.own.transferred_to(&self.ground, region)?;
            if own.before.is_none() {
                // fields keep the last solution, beyond the old region as well
                let potential = &own.held.current.solution.potential;
                own.displacement = potential.iter().map(|v| self.compliance * v).collect();
            }
            self.own = *own;
            self.own.before = before;
            self.view.refresh(&self.own.held);
        }
        Ok(())
    }

    /// Its fields, and what follows from them.
    pub fn fields(&self) -> Fields<'_> {
        let (ground, Solver { held, window, displacement, before, .. }) = (&*self.ground, &self.own);
        let far = before.is_none().then_some((self.compliance, &held.current.solution.pressure[..]));
        let surface = Surface { own: displacement, far };
        Fields { ground, held, surface, view: &self.view, kernel: Some(&window.kernel), about: About::default() }
    }

    /// The contact modulus E* \[Pa\].
    pub fn modulus(&self) -> f64 {
        1.0 / self.compliance
    }

    /// Whether the heights of the shapes are so far from 0 that their rounding counts, over the depth of the contact.
    pub(crate) fn heights_are_lost(&self) -> bool {
        self.own.held.heights_are_lost(&self.ground)
    }
}

impl<'a> From<&'a ElasticContact> for Fields<'a> {
    fn from(contact: &'a ElasticContact) -> Fields<'a> {
        contact.fields()
    }
}

/// Solves in `own`, or in a copy on a `larger` region. Returns Σ p.
fn compute(own: &mut Solver, larger: &mut Option<Box<Solver>>, asked: Asked<'_>) -> Result<f64> {
    let Asked { ground, request, c } = asked;
    validate_loads(ground, request)?;
    let is_windowed = own.before.is_none() && !own.held.region.covers();
    let placed = region_for(ground, &own.held, request, [false; 2], is_windowed.then_some(c))?;
    solve_on_growing_region(ground, own, larger, placed, asked)
}

impl Solver {
    fn new(ground: &Ground, held: Held, before: Option<Vec<f64>>) -> Solver {
        let window = Window::new(ground, &held.region, &held.indenter);
        let cells = held.region.len();
        Solver { window, trial: Trial::new(cells, ground.bodies), before, displacement: vec![0.0; cells], held }
    }

    /// A copy on another region, on which it holds the same equilibrium.
    fn transferred_to(&mut self, ground: &Ground, region: Region) -> Result<Box<Solver>> {
        ground.check_cells(&region)?;
        let besides = ElasticContact::bytes(ground, &self.held.region);
        memory::check("the contact", u128::from(ElasticContact::bytes(ground, &region)) + u128::from(besides))?;
        let mut window = Window::new(ground, &region, &self.held.indenter);
        let mut transfer = transfer_by_role(&self.held.region, &region, &mut window);
        let mut held = self.held.map(&region, false, &mut transfer);
        drop(transfer);
        let displacement = self.held.region.transfer(&self.displacement, &region, |_| 0.0);
        let before = self.before.as_ref().map(|before| self.held.region.transfer(before, &region, |_| 0.0));
        held.sum_up();
        Ok(Box::new(Solver { trial: Trial::new(region.len(), ground.bodies), held, window, before, displacement }))
    }

    /// Makes the trial the equilibrium; returns where it presses.
    fn accept(&mut self, ground: &Ground, request: Request<'_>, c: f64, sum: f64) -> Pressed {
        let Solver { held, trial, before, displacement, .. } = self;
        let pressed = Pressed::by(&trial.solution.pressure, ground, &held.region, request.indenter);
        held.take(trial, request, sum, pressed.cells);
        held.extrapolation.accept(0.0, sum, trial.reach);
        let potential = &held.current.solution.potential;
        match before {
            Some(before) => before.iter().zip(potential).zip(displacement).for_each(|((b, v), u)| *u = b + c * v),
            None => potential.iter().zip(displacement).for_each(|(v, u)| *u = 0.0 + c * v),
        }
        pressed
    }
}

impl OnRegion for Solver {
    type Asked<'a> = Asked<'a>;

    fn held(&mut self) -> &mut Held {
        &mut self.held
    }

    fn solve(&mut self, Asked { ground, request, c }: Asked<'_>) -> Result<()> {
        let Solver { held, window, trial, before, .. } = self;
        find_free_motions(ground, &held.region, request, &mut trial.free);

        // h = hi + u_old + c K p − ω − α·x, with the prescribed parts of ω and α
        let bodies = RigidBodies { request, region: &held.region, start: None };
        bodies.fill_gap(window.gap(request.indenter), before.as_deref(), &mut trial.gap);
        below_full_contact(window, trial, request)?;

        // p ≥ 0, h ≥ 0, p h = 0, with force and moments in balance
        let Request { tolerance, cancelled, .. } = request;
        let stop = Stop { tolerance, max_iterations: ground.settings.max_iterations, cancelled };
        let prescribed = bodies.greatest_motion(&ground.grid);
        guess_forces(ground, held, window.gap(request.indenter), request, c, trial);
        initial_guess(held, (&held.current, 0.0), window, trial, request, c);
        let solve = |trial: &mut Trial| window.solve(request.indenter, c, prescribed, stop, trial);
        let outcome = solve_with_springs(ground, held, request, c, trial, solve);
        converged(outcome, ground, &trial.solution, request)
    }

    fn outgrown(&self, Asked { ground, request, c }: Asked<'_>) -> Option<Region> {
        let Solver { held, window, trial, .. } = self;
        if held.region.covers() {
            return None;
        }
        outgrown(ground, held, window, trial, request, (c, &trial.solution.pressure))
    }

    fn acceptable(&self, Asked { ground, request, c }: Asked<'_>) -> Result<f64> {
        let Solver { held, trial, before, .. } = self;
        let rows = held.region.rows();
        let displaced =
            c * rows.sum(&trial.solution.potential) + before.as_ref().map_or(0.0, |before| rows.sum(before));
        acceptable(ground, held, displaced, trial, request)
    }

    fn transferred_to(&mut self, Asked { ground, .. }: Asked<'_>, region: Region) -> Result<Box<Solver>> {
        self.transferred_to(ground, region)
    }
}
