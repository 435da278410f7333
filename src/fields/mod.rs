//! What is read of a contact of any kind: pressure, gap, displacement, motions, and what follows from them.

pub(crate) mod area;
mod body;
mod brought;
#[cfg(feature = "states")]
mod found;
mod kept;
#[cfg(feature = "motion")]
mod lateral;
mod local_rows;
pub(crate) mod mesh_error;
#[cfg(not(feature = "observe"))]
mod no_observe;
pub(crate) mod report;
mod shared_area;
pub(crate) mod view;

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

pub use body::BodyState;
pub use kept::KeptFields;
pub(crate) use view::{Surface, View};

use crate::attraction::Attraction;
use crate::equilibrium::{Frame, Ground, Held, Region, Settings};
use crate::error::{Result, Special, coverage, exact_length};
use crate::extent::Extent;
use crate::kernel::{InfluenceKernel, LocalKernel};
use crate::load::Load;
use crate::rheology::{Material, TemperatureHistory};
use crate::solver::RigidMotion;
use crate::{Grid, memory, sum};

/// Of bodies apart, the part of the work of separation that is left.
const UNDONE: f64 = 0.01;

/// The fields of a contact, and what follows from them: of a [`ViscoelasticContact`](crate::ViscoelasticContact), of an
/// [`ElasticContact`](crate::elastic::ElasticContact), of a steady motion, of a sample of a run. Files and pictures take it, or the
/// contact itself.
///
/// ```
/// use viscocontact::prelude::*;
///
/// /// Share of the grid that is closer than a micrometre.
/// fn near(fields: Fields<'_>) -> viscocontact::Result<f64> {
///     let mut gap = vec![0.0; fields.grid().len()];
///     fields.gap_into(&mut gap)?;
///     Ok(gap.iter().filter(|h| **h < 1.0e-6).count() as f64 / gap.len() as f64)
/// }
///
/// let (grid, ball) = (Grid::square(32, 2.0e-3)?, Sphere::new(10.0e-3)?);
/// let mut elastic = ElasticContact::builder(grid.clone()).geometry(&ball).modulus(4.0e6).build()?;
/// elastic.solve(Load::force(0.1))?;
/// let body = Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0)?);
/// let mut creeping = ViscoelasticContact::builder(grid).geometry(&ball).material(body).build()?;
/// creeping.step(10.0, Load::force(0.1))?;
/// assert!(near(creeping.fields())? > near(elastic.fields())?);
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct Fields<'a> {
    pub(crate) ground: &'a Ground,
    pub(crate) held: &'a Held,
    pub(crate) surface: Surface<'a>,
    pub(crate) view: &'a View,
    /// The kernel on the region that is computed, if it is at hand.
    pub(crate) kernel: Option<&'a LocalKernel>,
    pub(crate) about: About<'a>,
}

/// What files and pictures tell of a contact beside its fields.
#[derive(Clone, Copy, Default)]
pub(crate) struct About<'a> {
    pub(crate) time: Option<f64>,
    pub(crate) material: Option<&'a Material>,
    pub(crate) temperature: Option<&'a TemperatureHistory>,
}

impl fmt::Debug for Fields<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Fields { ground, held, .. } = self;
        let mut out = f.debug_struct("Fields");
        out.field("grid", &ground.grid).field("loads", &held.loads).field("motions", &held.current.motions);
        out.field("contact_cells", &held.current.contact_cells).finish_non_exhaustive()
    }
}

impl<'a> Fields<'a> {
    /// Time \[s\]; `None` of a contact that knows none.
    pub fn time(&self) -> Option<f64> {
        self.about.time
    }

    /// The grid of every field.
    pub fn grid(&self) -> &'a Grid {
        &self.ground.grid
    }

    /// The settings of the contact.
    pub fn settings(&self) -> &'a Settings {
        &self.ground.settings
    }

    /// The load on the first body.
    pub fn load(&self) -> Load {
        self.held.loads[0]
    }

    /// The influence kernel, to share with other contacts.
    pub fn kernel(&self) -> &'a Arc<InfluenceKernel> {
        &self.ground.kernel
    }

    /// Contact pressure \[Pa\], one value per cell, ≥ 0 (Eq. 2 of the [paper](crate::paper)); on the local
    /// [rows](Fields::rows) where ranks share them out.
    pub fn pressure(&self) -> &'a [f64] {
        self.view.pressure(self.held)
    }

    /// Composite normal surface displacement, positive into the bodies \[m\], one value per cell (Eq. 10 of the
    /// [paper](crate::paper)); on the local [rows](Fields::rows) where ranks share them out.
    ///
    /// With [`Settings::window`](crate::contact::Settings::window) the first call after a step costs a convolution on
    /// the whole grid, and memory for its result.
    pub fn displacement(&self) -> &'a [f64] {
        self.view.displacement(self.ground, &self.held.region, self.surface)
    }

    /// Writes the gap between the deformed bodies, Eq. 1 of the [paper](crate::paper), into `out` \[m\]: zero in
    /// contact to within the tolerance, +∞ where the indenter has no surface.
    ///
    /// # Errors
    /// If `out` does not hold one value per cell, or there is no memory for the displacement on the whole grid, where
    /// only a region is computed.
    pub fn gap_into(&self, out: &mut [f64]) -> Result<()> {
        let (Ground { grid, kernel, .. }, Held { region, .. }) = (self.ground, self.held);
        exact_length("gap", out.len(), region.shown_len())?;
        if region.is_shared() {
            let own = (0..region.len()).map(|k| self.gap_of(k));
            region.show(&own.collect::<Vec<_>>(), out);
            return Ok(());
        }
        if !region.is_shown() && !self.view.has_displacement() {
            let whole = Region::whole(grid, region.folded());
            let [kernel, ..] = kernel.bytes(&whole.rows(), whole.folded());
            let fields = 8 * (grid.len() + 2 * whole.len()) as u128;
            memory::check("the displacement on the whole grid", kernel + fields)?;
        }
        let n2 = grid.cells()[1];
        for (k, (h, &u)) in out.iter_mut().zip(self.displacement()).enumerate() {
            *h = self.gap_under(k, u, grid.center(k / n2, k % n2));
        }
        Ok(())
    }

    /// The gap at a cell of the region that is computed.
    pub(crate) fn gap_of(&self, k: usize) -> f64 {
        let Held { region, indenter, .. } = self.held;
        self.gap_under(indenter.index(self.grid(), region, k), self.surface.own[k], region.center(k))
    }

    /// The gap above a displacement `u` at an index of the initial gap, whose cell has this centre.
    fn gap_under(&self, at: usize, u: f64, center: [f64; 2]) -> f64 {
        let Held { indenter, current, .. } = self.held;
        let initial = indenter.gap();
        let RigidMotion { approach, tilt } = current.motions[initial.owner(at)];
        initial.above[at] + u - RigidMotion { approach: approach - initial.datum, tilt }.at(center)
    }

    /// Whether the bodies are apart: no cell is in contact, and where surfaces attract each other
    /// ([`Builder::attraction`](crate::contact::Builder::attraction)) 99 % of the work of separation is done at the
    /// narrowest gap. Surfaces without a cell in contact still pull.
    pub fn is_separated(&self) -> bool {
        let far = |law: &Arc<dyn Attraction>| {
            let narrowest = self.gap().map(|gap| gap.into_iter().fold(f64::INFINITY, f64::min).max(0.0));
            narrowest.is_ok_and(|gap| law.energy(gap) <= UNDONE * law.work())
        };
        self.contact_cells() == 0 && self.ground.attraction.as_ref().is_none_or(far)
    }

    /// Rigid-body approach ω of the (first) body, at the origin of the grid \[m\]. Without load, the approach at first
    /// touch.
    pub fn approach(&self) -> f64 {
        self.held.current.motions[0].approach
    }

    /// Tilt (α1, α2) of the (first) body \[rad\]: it lowers the surface by ω + α1 x1 + α2 x2.
    pub fn tilt(&self) -> [f64; 2] {
        self.held.current.motions[0].tilt
    }

    /// Total normal force Σ p ΔA on all bodies \[N\], Eq. 4 of the [paper](crate::paper); < 0 where attraction pulls
    /// harder than the wall presses.
    pub fn force(&self) -> f64 {
        let Held { region, current, .. } = self.held;
        current.sum * region.cell_area()
    }

    /// Moments of the whole pressure about the origin, \[∬ p x1, ∬ p x2\] \[N·m\], Eq. 5 of the [paper](crate::paper).
    pub fn moment(&self) -> [f64; 2] {
        self.sums(|_| true).1
    }

    /// Number of cells in contact (p > 0).
    pub fn contact_cells(&self) -> usize {
        self.held.current.contact_cells
    }

    /// The smallest rectangle of cells of the whole grid that holds the contact; `None` without contact.
    pub(crate) fn extent_of_contact(&self) -> Option<Extent> {
        let Held { region, current, .. } = self.held;
        region.reach(&current.solution.pressure)
    }

    /// Number of rigid bodies.
    pub fn bodies(&self) -> usize {
        self.ground.bodies
    }

    /// The state of the rigid body of this index, in the order of the builder; `None` if there are fewer bodies.
    pub fn body(&self, body: usize) -> Option<BodyState> {
        let Held { indenter, current, .. } = self.held;
        let RigidMotion { approach, tilt } = *current.motions.get(body)?;
        let (force, moment, contact_cells) = self.sums(|k| indenter.gap().owner(k) == body);
        Some(BodyState { approach, tilt, force, moment, contact_cells })
    }

    /// Force, moments and number of cells in contact over the cells for which `counts` holds. Where surfaces attract
    /// each other, there is one body, and all its cells pull.
    fn sums(&self, counts: impl Fn(usize) -> bool + Sync) -> (f64, [f64; 2], usize) {
        let Held { region, current, .. } = self.held;
        let (grid, pressure, [_, m2]) = (region.grid(), &current.solution.pressure, region.cells());
        let n2 = self.ground.grid.cells()[1];
        let part = |band: Range<usize>| {
            let mut sums = [0.0; 4];
            for i in band.start / m2..band.end / m2 {
                let (mut force, mut moment) = (0.0, 0.0);
                let [row, first] = region.cell(i * m2);
                let counted = |j: &usize| pressure[i * m2 + j] > 0.0 && counts(row * n2 + first + j);
                for j in (0..m2).filter(counted) {
                    let p = pressure[i * m2 + j];
                    (force, moment, sums[3]) = (force + p, moment + p * grid.coordinate(1, j), sums[3] + 1.0);
                }
                let pulling = current.solution.attraction.get(i * m2..(i + 1) * m2).unwrap_or_default();
                for (j, s) in pulling.iter().enumerate() {
                    (force, moment) = (force - s, moment - s * grid.coordinate(1, j));
                }
                sums = [sums[0] + force, sums[1] + force * grid.coordinate(0, i), sums[2] + moment, sums[3]];
            }
            sums
        };
        let [force, moment1, moment2, cells] = region.rows().merge(part, sum::add);
        let area = region.cell_area();
        // the moments of mirror images cancel
        let moment = |axis: usize, sum: f64| if region.folded()[axis] { 0.0 } else { sum * area };
        (force * area, [moment(0, moment1), moment(1, moment2)], region.images() * cells as usize)
    }

    /// The attraction between the surfaces ([`Builder::attraction`](crate::contact::Builder::attraction)).
    pub fn attraction(&self) -> Option<&'a dyn Attraction> {
        self.ground.attraction.as_deref()
    }

    /// Writes the net traction between the bodies into `out` \[Pa\], one value per cell: the
    /// [pressure](Fields::pressure) of the wall less the attraction, < 0 where the bodies pull at each other. It
    /// carries the force, and displaces the bodies.
    ///
    /// # Errors
    /// If `out` does not hold one value per cell.
    pub fn traction_into(&self, out: &mut [f64]) -> Result<()> {
        let Held { region, current, .. } = self.held;
        exact_length("traction", out.len(), region.shown_len())?;
        if current.solution.attraction.is_empty() {
            out.copy_from_slice(self.pressure());
        } else {
            region.show(&current.solution.attraction, out);
            out.iter_mut().zip(self.pressure()).for_each(|(traction, pressure)| *traction = pressure - *traction);
        }
        Ok(())
    }

    /// The attraction on the whole grid, which ranks do not share out; `None` without.
    pub(crate) fn attraction_on_grid(&self) -> Option<Vec<f64>> {
        let Held { region, current, .. } = self.held;
        (!current.solution.attraction.is_empty()).then(|| {
            let mut out = vec![0.0; region.shown_len()];
            region.show(&current.solution.attraction, &mut out);
            out
        })
    }

    /// Refuses what this contact does not cover.
    pub(crate) fn covers(&self, case: coverage::Case) -> Result<()> {
        case.refuse_if(|special| match special {
            Special::Attraction => self.ground.attraction.is_some(),
            Special::SteadyMotion | Special::Friction | Special::OwnContact => false,
            Special::Ranks => self.held.region.is_shared(),
            Special::FixedToBodies => self.ground.settings.frame == Frame::Bodies,
            Special::FixedToIndenter => self.ground.settings.frame == Frame::Indenter,
        })
    }
}
