//! Which part of the grid a contact is computed on, and how it moves to a larger one.

use std::borrow::Cow;
use std::f64::consts::PI;

use crate::contact::extent::Extent;
use crate::contact::loads::lowered;
use crate::contact::memory::Footprint;
use crate::contact::region::Region;
use crate::contact::viscoelastic::{ContactSolver, ViscoelasticContact};
use crate::error::Result;
use crate::events;
use crate::geometry::Gap;
use crate::hereditary::{Exponential, History};
use crate::load::{Load, Tilt};
use crate::solver::{Freedom, Modes, Solution};

/// Cells a region holds beyond those that contact may reach, so that it need not grow every step.
const MARGIN: f64 = 0.1;
/// A region that would be larger than this part of the grid is all of it.
pub(super) const WORTH_IT: f64 = 0.7;
/// Bisections for the approach at first contact, an estimate.
const HALVINGS: usize = 24;

/// What the displacement beyond the region, should it ever be asked for, is made of: u = K U, where U follows u's own
/// recursion, K and the memory of the bodies being linear. U ≥ 0, and zero wherever there never was contact.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Beyond {
    history: Exponential,
    /// U.
    pub(super) strength: Vec<f64>,
    /// U of the step being tried; between steps that before the last one.
    pub(super) trial: Vec<f64>,
    /// The lowest of the initial gaps beyond the region, above the datum.
    lowest: f64,
}

impl Beyond {
    pub(super) fn new(history: &Exponential, cells: usize) -> Beyond {
        let mut history = history.clone();
        history.undisturbed_on(cells);
        Beyond { history, strength: vec![0.0; cells], trial: vec![0.0; cells], lowest: f64::NEG_INFINITY }
    }

    /// Takes over another's values, in its own memory.
    pub(super) fn copy_from(&mut self, other: &Beyond) {
        self.history.copy_from(&other.history);
        self.strength.clone_from(&other.strength);
        self.trial.clone_from(&other.trial);
        self.lowest = other.lowest;
    }

    /// Whether its fields are of so many cells.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self, cells: usize) -> bool {
        self.history.fits(cells) && [self.strength.len(), self.trial.len()] == [cells; 2]
    }

    /// U at the end of a step of compliance `c` under `pressure`; the same rule was found fit for u.
    pub(super) fn advance(&mut self, dt: f64, c: f64, pressure: &[f64]) {
        self.history.predict(dt, &self.strength, &mut self.trial);
        self.trial.iter_mut().zip(pressure).for_each(|(strength, &p)| *strength += c * p);
    }

    pub(super) fn commit(&mut self) {
        self.history.commit();
        std::mem::swap(&mut self.strength, &mut self.trial);
    }
}

impl ViscoelasticContact {
    /// Sees to it that `loads` suit the region: symmetric where it is folded, and their first contact within it.
    ///
    /// # Errors
    /// If there is no memory for the region that does.
    pub(super) fn make_room(&mut self, dt: f64, loads: &[Load]) -> Result<()> {
        let upright = |axis: usize| {
            loads.iter().all(|load| match load.tilt()[axis] {
                Tilt::Fixed(angle) => angle == 0.0,
                Tilt::Free { at } => at == 0.0,
            })
        };
        let folded = self.region.folded();
        // nor does anything stay even that moves
        let still = [0, 1].map(|axis| folded[axis] && upright(axis) && self.stride[axis] == 0);
        if still != folded {
            let region = self.unfolded(still);
            self.check_room(&region)?;
            self.keep_for_failure();
            self.reside(region);
        }
        if self.beyond.is_some() && self.is_undisturbed() && !self.state.placed {
            self.place(dt, loads)?;
        }
        Ok(())
    }

    /// Refuses to move to a region that there is no memory for, beside the state that is kept in case the step fails.
    pub(super) fn check_room(&self, region: &Region) -> Result<()> {
        let (grid, bodies) = (&self.grid, self.state.loads.len());
        let footprint = Footprint {
            all: grid.len(),
            bodies,
            settings: &self.settings,
            kernel: &self.kernel,
            history: &self.history,
        };
        footprint.check(region.computed(), footprint.on(self.region.computed()).total())
    }

    /// The region without the symmetry of all but the axes that are `still` folded.
    pub(super) fn unfolded(&self, still: [bool; 2]) -> Region {
        if self.region.covers() {
            Region::whole(&self.grid, still)
        } else {
            let mut held = self.region.extent();
            for axis in (0..2).filter(|&axis| self.region.folded()[axis] && !still[axis]) {
                held.low[axis] = self.grid.cells()[axis] - 1 - held.high[axis];
            }
            Region::around(&self.grid, still, held, 0.0)
        }
    }

    /// Chooses the region of a first contact by an estimate of how deep the bodies sink in.
    fn place(&mut self, dt: f64, loads: &[Load]) -> Result<()> {
        let mut touched: Option<Extent> = None;
        for (body, load) in loads.iter().enumerate() {
            let free_tilt = |axis: usize| matches!(load.tilt()[axis], Tilt::Free { .. }) && !self.region.folded()[axis];
            let motion = lowered(load, self.initial_gap.datum);
            let motion = match *load {
                Load::Force { normal: 0.0, .. } => continue,
                _ if free_tilt(0) || free_tilt(1) => [f64::INFINITY, 0.0, 0.0],
                Load::Force { normal, .. } => [self.estimate_depth(dt, body, normal), motion[1], motion[2]],
                Load::Approach { .. } => motion,
            };
            touched = Extent::hull(touched.into_iter().chain(self.cells_below(body, motion, |_| 0.0)));
        }
        if let Some(touched) = touched {
            let lowest = Region::lowest_cells(&self.grid, &self.initial_gap, loads.len());
            let region = self.region_for(lowest.with(touched));
            self.check_room(&region)?;
            self.keep_for_failure();
            self.state.placed = true;
            self.reside(region);
        }
        Ok(())
    }

    /// A depth at which a body pressed by `normal` about comes to rest, above the datum: twice that of the level at
    /// which the gap has risen by a²/2R, see the cold start of the solver.
    fn estimate_depth(&self, dt: f64, body: usize, normal: f64) -> f64 {
        let gap = &self.initial_gap;
        let heights =
            || gap.above.iter().enumerate().filter(|(k, h)| h.is_finite() && gap.owner(*k) == body).map(|(_, h)| *h);
        let lowest = heights().fold(f64::INFINITY, f64::min);
        let (mut low, mut high) = (lowest, heights().fold(lowest, f64::max));
        let force = 0.375 * PI.sqrt() * self.material.contact_compliance(dt) * normal;
        let rise =
            |level: f64| force / (heights().filter(|&h| h <= level).count() as f64 * self.grid.cell_area()).sqrt();
        if high - lowest < rise(high) {
            return lowest + 2.0 * rise(high); // all of it is pressed
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if middle - lowest < rise(middle) { low = middle } else { high = middle }
        }
        lowest + 2.0 * (high - lowest)
    }

    /// The least rectangle of cells where the undeformed gap of a body lowered by `motion`, and filled by `under`, is
    /// negative; none of the region's own, if it is in use.
    fn cells_below(&self, body: usize, motion: [f64; 3], under: impl Fn([f64; 2]) -> f64) -> Option<Extent> {
        let ([n1, n2], gap) = (self.grid.cells(), &self.initial_gap);
        let start = [0, 1].map(|axis| if self.region.folded()[axis] { self.grid.cells()[axis] / 2 } else { 0 });
        let mut below: Option<Extent> = None;
        for i in start[0]..n1 {
            for j in start[1]..n2 {
                let (k, x) = (i * n2 + j, self.grid.center(i, j));
                let depth = motion[0] + motion[1] * x[0] + motion[2] * x[1] - gap.above[k];
                if depth <= 0.0 || gap.owner(k) != body || (self.state.placed && self.region.find([i, j]).is_some()) {
                    continue;
                }
                if depth > under(x) {
                    let cell = Extent::of([i, j]);
                    below = Some(below.map_or(cell, |below| below.with(cell)));
                }
            }
        }
        below
    }

    fn region_for(&self, held: Extent) -> Region {
        let whole = Region::whole(&self.grid, self.region.folded());
        let region = Region::around(&self.grid, self.region.folded(), held, MARGIN);
        if region.len() as f64 > WORTH_IT * whole.len() as f64 { whole } else { region }
    }

    /// After a step was tried: a larger region, if the bodies might touch beyond this one.
    ///
    /// No convolution is needed to rule that out. With pressures ≥ 0 and creep that never recedes, u ≥ 0 everywhere,
    /// and more than that: K of a total U within a distance ρ of a point is nowhere below ∫U/(π (r + ρ)).
    pub(super) fn outgrown(&self, loads: &[Load]) -> Option<Region> {
        let beyond = self.beyond.as_ref()?;
        let [l1, l2] = self.grid.lengths();
        let motions = || loads.iter().enumerate().map(|(body, load)| self.trial_motion(body, load));
        let deepest = |m: [f64; 3]| m[0] + 0.5 * (m[1].abs() * l1 + m[2].abs() * l2);
        if motions().all(|motion| deepest(motion) <= beyond.lowest) {
            return None;
        }
        let (grid, folded) = (self.region.grid(), self.region.folded());
        let [m1, m2] = grid.cells();
        let (first, last) = (grid.center(0, 0), grid.center(m1 - 1, m2 - 1));
        let centre = [0, 1].map(|axis| if folded[axis] { 0.0 } else { 0.5 * (first[axis] + last[axis]) });
        let distance = |x: [f64; 2]| (x[0] - centre[0]).hypot(x[1] - centre[1]);
        let [side1, side2] = grid.spacing();
        let (mut total, mut radius) = (0.0, 0.0_f64);
        for (k, &strength) in beyond.trial.iter().enumerate().filter(|(_, strength)| **strength > 0.0) {
            total += strength;
            radius = radius.max(distance(grid.center(k / m2, k % m2)));
        }
        let radius = radius + 0.5 * side1.hypot(side2);
        let source = total * grid.cell_area() * self.region.images() as f64 / PI;
        let under = |x: [f64; 2]| source / (distance(x) + radius);
        let touched = motions().enumerate().filter_map(|(body, motion)| self.cells_below(body, motion, under));
        Extent::hull(touched).map(|touched| self.region_for(self.region.extent().with(touched)))
    }

    /// (ω, α1, α2) of a body in the step being tried, ω from the datum.
    pub(super) fn trial_motion(&self, body: usize, load: &Load) -> [f64; 3] {
        let free = Modes::new(self.region.grid(), self.freedoms[body]).physical(self.trial.motions[body]);
        let held = lowered(load, self.initial_gap.datum);
        [held[0] + free.approach, held[1] + free.tilt[0], held[2] + free.tilt[1]]
    }

    /// Keeps the state as it is on the old region, for the case that the step does not succeed.
    pub(super) fn keep_for_failure(&mut self) {
        if self.before_move.is_none() {
            self.before_move = Some(Box::new(self.clone()));
        }
    }

    /// Goes back to where the state was before a step that did not succeed.
    pub(super) fn move_back(&mut self) {
        if let Some(before) = self.before_move.take() {
            let counts = self.trial.counts;
            *self = *before;
            self.trial.counts = counts; // the work was done
        }
    }

    /// Moves to another region: what is new there of displacement and history is computed from U.
    pub(super) fn reside(&mut self, region: Region) {
        self.history.settle(&self.trial_displacement, &self.state.displacement);
        let old = self.occupy(region);
        events::moved(old.cells(), self.region.cells());
        let cells = self.region.len();

        // a field of its own on all cells of the new region: known on the old one, elsewhere K of a source
        let region = self.region.clone();
        let (kernel, work) = (&self.kernel_here, &mut self.work);
        let mut induce = |own: &[f64], source: Option<&[f64]>| -> Vec<f64> {
            let mut far = vec![0.0; cells];
            if let Some(source) = source.filter(|source| source.iter().any(|&s| s != 0.0)) {
                kernel.apply(&old.carry(source, &region, |_| 0.0), &mut far, work);
            }
            old.carry(own, &region, |k| far[k])
        };
        let mut beyond = self.beyond.take();
        if let Some(beyond) = &mut beyond {
            let Beyond { history, strength, trial, .. } = beyond;
            history.settle(trial, strength);
        }
        let source = beyond.as_ref();
        self.trial_displacement = induce(&self.trial_displacement, source.map(|beyond| &beyond.trial[..]));
        self.state.displacement = induce(&self.state.displacement, source.map(|beyond| &beyond.strength[..]));
        match &mut self.history {
            History::Exponential(history) => history.carry(old.len(), cells, |i, own| {
                let source = source.map(|beyond| beyond.history.branch(i, old.len()));
                induce(&own, source.as_deref())
            }),
            History::Direct(history) => history.carry(|own| old.carry(own, &region, |_| 0.0)),
            History::Unfitted(history) => history.carry(cells),
            History::Sources(history) => history.carry(region.cells(), |own| old.carry(own, &region, |_| 0.0)),
        }
        for state in [&mut self.state.current, &mut self.state.previous] {
            let potential = induce(&state.potential, Some(&state.pressure));
            let pressure = old.carry(&state.pressure, &region, |_| 0.0);
            *state = Solution { pressure, potential, motions: std::mem::take(&mut state.motions), ..*state };
        }
        self.beyond = beyond.filter(|_| !region.covers()).map(|mut beyond| {
            let plain = |own: &[f64]| old.carry(own, &region, |_| 0.0);
            beyond.history.carry(old.len(), cells, |_, own| plain(&own));
            (beyond.strength, beyond.trial) = (plain(&beyond.strength), plain(&beyond.trial));
            beyond
        });
        self.survey();
        self.show();
    }

    /// Makes all that belongs to a region, but for the state there; returns the one before.
    pub(super) fn occupy(&mut self, region: Region) -> Region {
        let old = std::mem::replace(&mut self.region, region);
        let (cells, bodies) = (self.region.len(), self.state.loads.len());
        self.kernel_here = self.kernel.on(self.region.grid(), self.region.folded());
        self.work = self.kernel_here.workspace();
        self.gap_here = self.region.cut_gap(&self.initial_gap);
        self.solver = ContactSolver::new(self.settings.solver, &self.kernel_here, bodies);
        self.trial = Solution::zero(cells, bodies);
        self.gap = vec![0.0; cells];
        if self.region.is_whole() {
            self.shown = Vec::new();
        }
        // what lies beyond a smaller region is of the larger one
        self.shown.fill(0.0);
        old
    }

    /// Looks up the lowest gap beyond the region.
    pub(super) fn survey(&mut self) {
        if let Some(beyond) = &mut self.beyond {
            let n2 = self.grid.cells()[1];
            let gaps = self.initial_gap.above.iter().enumerate();
            let outside = gaps.filter(|(k, _)| self.region.find([k / n2, k % n2]).is_none());
            beyond.lowest = outside.map(|(_, &h)| h).fold(f64::INFINITY, f64::min);
        }
    }

    /// Brings what users see up to date with the state.
    pub(super) fn show(&mut self) {
        self.whole_displacement.take();
        if !self.region.is_whole() {
            self.shown.resize(self.grid.len(), 0.0);
            self.region.spread(&self.state.current.pressure, &mut self.shown);
        }
    }

    /// A field on the whole grid from one of the region; beyond it is K of its source, or zero if there is none.
    pub(super) fn on_the_whole_grid<'a>(&self, own: &'a [f64], source: Option<&[f64]>) -> Cow<'a, [f64]> {
        if self.region.is_whole() {
            return Cow::Borrowed(own);
        }
        let mut whole = vec![0.0; self.grid.len()];
        if let Some(source) = source {
            let all = Region::whole(&self.grid, self.region.folded());
            let kernel = self.kernel.on(all.grid(), all.folded());
            let mut far = vec![0.0; all.len()];
            kernel.apply(&self.region.carry(source, &all, |_| 0.0), &mut far, &mut kernel.workspace());
            all.spread(&far, &mut whole);
        }
        self.region.spread(own, &mut whole);
        Cow::Owned(whole)
    }
}

/// Axes about whose middle the gap is even, bit by bit.
pub(super) fn symmetry(gap: &Gap, cells: [usize; 2]) -> [bool; 2] {
    even_axes(cells, |k, mirror| gap.above[k] == gap.above[mirror] && gap.owner(k) == gap.owner(mirror))
}

/// Axes of an even number of cells about whose middle every cell is `alike` its mirror image.
pub(super) fn even_axes([n1, n2]: [usize; 2], alike: impl Fn(usize, usize) -> bool) -> [bool; 2] {
    let rows = |i: usize| (0..n2).all(|j| alike(i * n2 + j, (n1 - 1 - i) * n2 + j));
    let columns = |i: usize| (0..n2 / 2).all(|j| alike(i * n2 + j, i * n2 + n2 - 1 - j));
    [n1.is_multiple_of(2) && (0..n1 / 2).all(rows), n2.is_multiple_of(2) && (0..n1).all(columns)]
}

/// What is left free of a body whose tilt about a folded axis cannot but vanish.
pub(super) fn upright(freedom: Freedom, folded: [bool; 2]) -> Freedom {
    Freedom { tilt: [0, 1].map(|axis| freedom.tilt[axis] && !folded[axis]), ..freedom }
}
