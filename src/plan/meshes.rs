//! How elastic states, or a run, converge with the mesh.

use crate::Grid;
use crate::error::Result;
use crate::plan::difference::{Differences, greatest, relative};
use crate::plan::domain::{ContactSize, LEAST_ACROSS};
use crate::plan::error_law::{ErrorLaw, ORDERS};
use crate::plan::fields::PlannedField;
use crate::plan::scene::{Run, StepState};

/// Cells across the widest contact on the finest mesh that a plan computes, unless it could not be planned then.
const MOST_ACROSS: f64 = 128.0;
/// Most cells along a side of a domain in which the contact is small, for example far off the centre.
const MOST_TRIAL_CELLS: f64 = 2048.0;
/// Most cells along a side of a plan: more exceed the memory of a workstation.
pub(super) const MOST_PLANNED_CELLS: f64 = 8192.0;
/// A plan extrapolates to meshes at most this many times finer, unless `MOST_ACROSS` is reached.
const MAX_EXTRAPOLATION: f64 = 3.0;
/// Greatest difference of the greatest pressure that counts as second order, over the estimate from the neighbours of
/// the peak. A difference of second order is three times the error on the finer mesh.
const MAX_DIFFERENCE_OVER_PEAK: f64 = 4.0;
/// Least and greatest order of the error of a pressure field, at singular edges and at smooth rims, and the order at the rim itself.
const FIELD_ORDERS: [f64; 2] = [0.5, 1.5];
const RIM_ORDER: f64 = 0.5;
/// Upper limit of the power of the number of cells across with which the convolutions of a run grow.
const MAX_WORK_ORDER: f64 = 0.4;

/// What is asked of a mesh: its greatest errors of approach and force and of the other quantities, and whether the radius is one of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted {
    pub(super) main: f64,
    pub(super) others: f64,
    pub(super) area: bool,
    /// Of pressure fields; infinite where none are asked for.
    pub(super) fields: f64,
}

/// How the errors of a run fall with its mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Laws {
    /// Convergence of approach and force, and the first-order part of it.
    pub(super) main: ErrorLaw,
    pub(super) singular: ErrorLaw,
    /// Convergence of the greatest pressure of the run, and of the greatest at any time.
    pub(super) pressure: ErrorLaw,
    pub(super) pressure_over_time: ErrorLaw,
    /// What cells lose of a greatest pressure at a growing rim, besides.
    pub(super) at_rim: ErrorLaw,
    /// Convergence of the contact radius at any time.
    pub(super) radius: ErrorLaw,
    /// Convergence of pressure fields, and of the pressure at their rims.
    pub(super) field: ErrorLaw,
    pub(super) field_rim: ErrorLaw,
}

impl Laws {
    /// Cells across that leave no greater errors than wanted, of the pressure if it converges.
    pub(super) fn across_for(&self, wanted: &Wanted) -> f64 {
        let mains = [self.main, self.singular].map(|law| law.across_for(wanted.main));
        let of_rim = Some(self.at_rim.across).filter(|_| self.pressure.converges);
        let others = [Some(self.pressure).filter(|law| law.converges), wanted.area.then_some(self.radius)];
        let others = others.into_iter().flatten().map(|law| law.across_for(wanted.others));
        let of_fields = self.field.across_for(wanted.fields);
        others.chain(of_rim).chain(mains).fold(of_fields, f64::max)
    }

    /// Without a promise of the greatest pressure.
    pub(super) fn without_pressure(self) -> Laws {
        Laws { pressure: ErrorLaw::NONE, ..self }
    }
}

/// States on successive meshes, each twice as fine as the last. Cells are counted across the widest contact of the whole run.
pub(super) struct Meshes {
    /// Whether the shape has an edge, as a punch.
    pub(super) punch: bool,
    pub(super) across: f64,
    /// Differences between each mesh and the one before.
    pub(super) differences: Vec<Differences>,
    pub(super) finest: Run,
    /// Index of the state with the greatest pressure, if it is known.
    pub(super) highest: Option<usize>,
    /// Pressure fields, and their errors on each mesh but the coarsest.
    pub(super) fields: Vec<PlannedField>,
    pub(super) field_errors: Vec<[f64; 2]>,
    /// Error of the contact radius due to creep at the rim, on the coarsest mesh.
    pub(super) rim: f64,
    /// Errors of approach and force, and of the greatest pressure, over the errors of the states; `None` where no state has it.
    pub(super) force_amplification: f64,
    pub(super) pressure_amplification: Option<f64>,
    /// Power of the cells across with which the convolutions grow.
    pub(super) work_order: f64,
}

impl Meshes {
    /// The coarsest mesh.
    pub(super) fn coarsest(finest: Run, punch: bool) -> Meshes {
        Meshes {
            punch,
            across: LEAST_ACROSS,
            differences: Vec::new(),
            fields: Vec::new(),
            field_errors: Vec::new(),
            finest,
            highest: None,
            rim: 0.0,
            force_amplification: 1.0,
            pressure_amplification: Some(1.0),
            work_order: 0.0,
        }
    }

    /// Refines until the needed number of cells across is within the range of extrapolation; a plan may leave out the pressure where it
    /// needs more cells than a plan has. `states` computes the states on a mesh.
    pub(super) fn refine(
        mut self,
        size: &ContactSize,
        wanted: &Wanted,
        states: impl Fn(Grid) -> Result<Run>,
    ) -> Result<Meshes> {
        loop {
            self.across *= 2.0;
            let grid = size.grid(self.across)?;
            let [n1, n2] = grid.cells().map(|cells| cells as f64);
            let finer = states(grid)?;
            self.differences.push(Differences::between(&self.finest.states, &finer.states, self.highest));
            let growth = relative(finer.convolutions, self.finest.convolutions);
            self.work_order = growth.max(1.0).log2().min(MAX_WORK_ORDER);
            self.finest = finer;
            let of_fields = self.fields.iter().map(|field| field.errors(&self.finest, self.across));
            self.field_errors.extend(of_fields.reduce(|one, other| [0, 1].map(|which| one[which].max(other[which]))));
            let laws = self.laws();
            let reach = if self.differences.len() < 2 { 1.0 } else { MAX_EXTRAPOLATION };
            let sides = size.cells(laws.without_pressure().across_for(wanted));
            let can_be_planned = sides[0].max(sides[1]) <= MOST_PLANNED_CELLS;
            let last = self.across >= MOST_ACROSS && can_be_planned || 2.0 * n1.max(n2) > MOST_TRIAL_CELLS;
            if last || laws.across_for(wanted) <= reach * self.across {
                return Ok(self);
            }
        }
    }

    pub(super) fn laws(&self) -> Laws {
        let radius = ErrorLaw::by_cells(&self.each(|differences| differences.radius), self.across);
        Laws {
            main: self.main().times(self.force_amplification),
            singular: self.singular(),
            pressure: self.pressure_amplification.map_or(ErrorLaw::NONE, |factor| self.pressure().times(factor)),
            pressure_over_time: ErrorLaw::smooth(&self.each(|differences| differences.pressure_over_time), self.across),
            at_rim: ErrorLaw::ZERO,
            radius: ErrorLaw { error: radius.error.max(self.rim * LEAST_ACROSS / self.across), ..radius },
            field: self.field(0, FIELD_ORDERS),
            field_rim: self.field(1, [RIM_ORDER; 2]),
        }
    }

    /// Convergence of an error of the fields, by the errors on the last two meshes.
    fn field(&self, which: usize, [least, most]: [f64; 2]) -> ErrorLaw {
        let [.., error] = self.field_errors[..] else { return ErrorLaw::ZERO };
        let before = self.field_errors.iter().rev().nth(1).map_or(0.0, |before| before[which]);
        let order = (before / error[which]).log2().clamp(least, most);
        ErrorLaw { error: error[which], order, across: self.across, converges: true }
    }

    /// The differences of one quantity, from the coarsest mesh to the finest.
    fn each(&self, of: impl Fn(&Differences) -> f64) -> Vec<f64> {
        self.differences.iter().map(of).collect()
    }

    /// Convergence of approach and force; for a punch, whose rim is resolved to a cell, by fractions of a cell.
    fn main(&self) -> ErrorLaw {
        let law = if self.punch { ErrorLaw::by_cells } else { ErrorLaw::smooth };
        law(&self.each(|differences| differences.main), self.across)
    }

    /// First-order part of the error, estimated from the rim. Creep raises the pressure at a growing rim too, but at
    /// edges of the shape the pressure is raised from the start.
    fn singular(&self) -> ErrorLaw {
        let states = &self.finest.states;
        let deepest = greatest(states, |state| state.approach);
        let shares = states.iter().map(|state| state.singular * relative(state.approach.abs(), deepest));
        let touching = states.iter().filter(|state| state.force > 0.0);
        let lasts = self.punch || touching.map(|state| state.singular).fold(f64::INFINITY, f64::min) > 0.0;
        let error = if lasts { shares.fold(0.0, f64::max) } else { 0.0 };
        ErrorLaw { error, order: 1.0, across: self.across, converges: true }
    }

    /// Convergence of the greatest pressure, which requires that the finest mesh resolves the peak. Differences of a
    /// single number may be small or large by chance: where they agree with the estimate from the neighbours of the peak,
    /// the pressure is as smooth as in an elastic contact.
    fn pressure(&self) -> ErrorLaw {
        let pressure = self.each(|differences| differences.pressure);
        let law = ErrorLaw::smooth(&pressure, self.across);
        let highest = match self.highest {
            Some(highest) => self.finest.states.get(highest),
            None => self.finest.highest_resolved(),
        };
        let Some(peak) = highest.and_then(|state| state.peak) else {
            return ErrorLaw { converges: false, ..law };
        };
        if pressure.last().is_some_and(|&last| last <= MAX_DIFFERENCE_OVER_PEAK * peak) {
            let error = ErrorLaw::second_order(&pressure).max(peak);
            return ErrorLaw { error, order: ORDERS[1], converges: true, ..law };
        }
        law
    }
}

impl Run {
    /// The state with the greatest pressure of a run, if the contact was resolved from the start until then.
    fn highest_resolved(&self) -> Option<&StepState> {
        let highest = self.states.iter().enumerate().max_by(|a, b| a.1.pressure.total_cmp(&b.1.pressure));
        highest.filter(|(k, _)| self.states[..=*k].iter().all(|state| state.resolved)).map(|(_, state)| state)
    }
}
