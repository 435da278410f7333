//! Where the work of a load goes.

use std::sync::Arc;

use crate::contact::stepper::ViscoelasticContact;
use crate::contact::{PassReport, State, StepReport, Warnings};
use crate::error::{Result, count_within, coverage, within};
use crate::hereditary::BranchEnergies;
use crate::load::{Load, Tilt};
use crate::rounded::rounded;

/// A step whose work the forces at its ends do not tell to what [counts](PassReport::noticed) is looked at in parts, as
/// far as to a sixteenth of it.
const HALVINGS: u32 = 4;
/// A step whose balance is off by more than this part of the energies is divided, and its parts are by their share of
/// it, as far as to a 256th of the step: a pull-off within one takes about as many.
const UNBALANCED: f64 = 5e-3;
const MOST_HALVINGS: u32 = 8;

/// Follows what the load of a contact does, and what the bodies store and dissipate of it.
///
/// The bodies are springs and dashpots in every cell: the branches of their generalized Maxwell model, each driven by
/// the displacement and by the tractions. What the springs store and the dashpots dissipate follows from these
/// fields, not from the balance, whose [imbalance](Energies::imbalance) shows the error of the steps: of second order
/// in their length. The work of the load is ∫ F dδ + ∫ M dα, by the mean of force and moment over each step. A step
/// that is so long that its balance is off by more than 0.5 % of the energies, as where a fast pull-off lies within
/// it, is computed again in parts, in a copy of the contact, as far as to a 256th of it; what is still off is the
/// imbalance, of which [`Energies::warning`] warns. In a step of length zero bodies answer elastically, and its work
/// is what they store and lose. Where surfaces attract each other, the energy of the attraction is stored too; the
/// bodies come from far apart in the first step, whose work is what becomes of it, too; and steps with
/// [`Warnings::JUMP`] lose [`PassReport::released`](crate::contact::PassReport::released). Beside a jump the force leaves every polynomial: where the forces at both ends
/// of a step do not tell its work, the step is computed again in parts, in a copy of the contact, whose work and
/// losses count.
///
/// Two fields for each relaxation time and eight more are kept, 8 bytes a cell each, and where surfaces attract each
/// other the contact at the end of the step before; a step costs as many products, far less than the step of the
/// contact, and with [`Settings::window`](crate::contact::Settings::window) a convolution on the whole grid. Lateral
/// forces of an indenter that moves along a path do work that is not counted.
///
/// ```
/// use viscocontact::contact::EnergyBalance;
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(48, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Zener::relaxing(4.0e6, 1.0e6, 1.0)?))
///     .build()?;
/// let mut balance = EnergyBalance::new(&contact)?;
/// // pressed for a second, and held for ten
/// let load = Ramp::new(Load::approach(0.0), Load::approach(1.0e-4), 1.0)?;
/// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-3), 11.0);
/// while let Some(report) = run.next_step()? {
///     balance.record(run.contact(), &report)?;
/// }
/// let energies = balance.energies();
/// assert!(energies.viscous > 0.3 * energies.work);
/// assert!(energies.imbalance().abs() < 0.01 * energies.work);
/// # Ok::<(), Error>(())
/// ```
///
/// In a [`CsvHistory`](crate::output::CsvHistory), [`EnergyBalance::COLUMNS`] name the columns, and
/// [`Energies::values`] fill them.
#[derive(Debug, Clone)]
pub struct EnergyBalance {
    branches: BranchEnergies,
    energies: Energies,
    /// Reduced time, force, moments, approach and tilts at the end of the step recorded last.
    reduced_time: f64,
    pushed: [f64; 3],
    moved: [f64; 3],
    traction: Vec<f64>,
    gap: Vec<f64>,
    /// Whether the bodies have yet to come from far apart.
    far_apart: bool,
    /// The contact at the end of the step recorded last, where surfaces attract each other: adaptive steps consist of
    /// two there.
    last: Option<Box<ViscoelasticContact>>,
}

/// The work of a load since the bodies were undisturbed, and what became of it \[J\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Energies {
    /// Work of the load; where surfaces attract each other, from bodies far apart.
    pub work: f64,
    /// What the bodies and the attraction store: they would give it back in a motion so fast that nothing creeps.
    pub stored: f64,
    /// What the bodies dissipated while they crept.
    pub viscous: f64,
    /// What was lost as surfaces snapped together and apart.
    pub lost: f64,
}

impl Energies {
    /// The values of [`EnergyBalance::COLUMNS`].
    pub fn values(&self) -> [f64; 4] {
        [self.work, self.stored, self.viscous, self.lost]
    }

    /// Work less what became of it: the error of the steps \[J\].
    pub fn imbalance(&self) -> f64 {
        self.work - self.stored - self.viscous - self.lost
    }

    /// A warning where the imbalance is more than 5 % of the energies, with its number and the remedy. That it is
    /// less does not show that each of them is as accurate: with the tolerance of a run they converge.
    pub fn warning(&self) -> Option<String> {
        let (off, whole) = (self.imbalance(), self.size());
        let off_by = || {
            let [off, percent] = [off, 100.0 * off.abs() / whole].map(|number| rounded(number, 3));
            format!(
                "the energies are out of balance by {off} J, {percent} % of them: take shorter steps (Run::stop_at)"
            )
        };
        (off.abs() > 0.05 * whole).then(off_by)
    }

    /// The sum of what is stored and what is gone, at least the work.
    fn size(&self) -> f64 {
        self.work.abs().max(self.stored.abs() + self.viscous.abs() + self.lost.abs())
    }
}

impl EnergyBalance {
    /// Names of the columns of energies in a [`CsvHistory`](crate::output::CsvHistory).
    pub const COLUMNS: [&str; 4] = ["work [J]", "stored energy [J]", "viscous energy [J]", "energy lost in jumps [J]"];

    /// A balance that begins with undisturbed bodies, before the first step of their contact.
    ///
    /// # Errors
    /// If steps were taken, there are several rigid bodies, [ranks](crate::parallel) share out the rows, the bodies
    /// move under the grid ([`Frame::Indenter`](crate::contact::Frame::Indenter)), or their material has no
    /// exponential series ([`Material::fitted`](crate::rheology::Material::fitted) gives it one).
    pub fn new(contact: &ViscoelasticContact) -> Result<EnergyBalance> {
        contact.covers(coverage::ENERGIES)?;
        let cells = contact.grid().len();
        count_within(
            "rigid bodies of an energy balance",
            contact.fields().bodies(),
            contact.fields().bodies() == 1,
            "1",
        )?;
        let before = "0, before any step";
        within("time at which an energy balance begins", contact.time(), contact.time() == 0.0, before)?;
        let moved = crate::sum::greatest(contact.fields().displacement());
        within("displacement where an energy balance begins", moved, moved == 0.0, before)?;
        let creep = contact.material().spectrum_for("an energy balance")?;
        Ok(EnergyBalance {
            branches: BranchEnergies::new(&creep, cells),
            energies: Energies::default(),
            reduced_time: contact.reduced_time(),
            pushed: [0.0; 3],
            moved: contact.load_and_motion()[1],
            traction: vec![0.0; cells],
            gap: vec![0.0; cells],
            far_apart: contact.fields().attraction().is_some(),
            last: None,
        })
    }

    /// Takes in the step taken last: call it once after each.
    ///
    /// # Errors
    /// If there is no memory for the fields on the whole grid.
    pub fn record(&mut self, contact: &ViscoelasticContact, report: &StepReport) -> Result<Energies> {
        let jumped = report.warnings.contains(Warnings::JUMP);
        let (last, halvings) = (self.last.take(), if jumped { HALVINGS } else { MOST_HALVINGS });
        self.take_in((last.as_deref(), contact), report.dt, jumped, halvings)?;
        self.last = contact.fields().attraction().is_some().then(|| Box::new(contact.clone()));
        Ok(self.energies)
    }

    /// Takes in a step of length `dt` from the contact `before` it, which the contact itself may know: if its work is
    /// not known, or its balance is off, in halves, and halves of halves, so many times.
    fn take_in(
        &mut self,
        (before, contact): (Option<&ViscoelasticContact>, &ViscoelasticContact),
        dt: f64,
        jumped: bool,
        halvings: u32,
    ) -> Result<Energies> {
        if dt == 0.0 || halvings == 0 || self.far_apart || !(before.is_some() || self.starts_with(contact)) {
            return self.take_in_whole(contact, dt, jumped);
        }
        let (mut in_halves, is_inexact) = (self.clone(), self.is_inexact(contact));
        if !is_inexact {
            self.take_in_whole(contact, dt, jumped)?;
            let off = self.energies.imbalance() - in_halves.energies.imbalance();
            let share = 0.5_f64.powi((MOST_HALVINGS - halvings) as i32);
            if jumped || off.abs() <= UNBALANCED * share * self.energies.size() {
                return Ok(self.energies);
            }
        }
        // another indenter since then: only the step itself knows both
        let is_same = |before: &&ViscoelasticContact| {
            let [one, other] = [before, contact].map(|at| &at.computation.state.held.indenter);
            Arc::ptr_eq(one, other)
        };
        let before = before.filter(is_same);
        let left = if is_inexact { halvings.min(HALVINGS) } else { halvings } - 1;
        if in_halves.take_in_halves((before, contact), left).is_ok_and(|same_end| same_end) {
            *self = in_halves;
        } else if is_inexact {
            self.take_in_whole(contact, dt, jumped)?;
        }
        Ok(self.energies)
    }

    fn take_in_whole(&mut self, contact: &ViscoelasticContact, dt: f64, jumped: bool) -> Result<Energies> {
        let area = contact.grid().cell_area();
        contact.fields().traction_into(&mut self.traction)?;
        let reduced = contact.reduced_time() - self.reduced_time;
        let [stored, dissipated] =
            self.branches.step(reduced, contact.fields().displacement(), &self.traction).map(|sum| area * sum);
        let stored = stored + self.attracted(contact)?;
        let lost = contact.passes().filter(|_| jumped).map_or(0.0, |passes| passes.released);
        let [pushed, moved] = contact.load_and_motion();
        let [from, to] = [(self.pushed, self.moved), (pushed, moved)].map(|end| about_load_point(contact, end));
        let [before, after] = if jumped { ends_of_jump(contact, from, to.0) } else { [from.0, to.0] };
        let work = match dt {
            _ if std::mem::take(&mut self.far_apart) => stored + dissipated + lost,
            0.0 => stored - self.energies.stored + lost,
            _ => (0..3).map(|k| 0.5 * (before[k] + after[k]) * (to.1[k] - from.1[k])).sum(),
        };
        let Energies { work: worked, viscous, lost: lost_before, .. } = self.energies;
        let (viscous, lost) = (viscous + dissipated, lost_before + lost);
        self.energies = Energies { work: worked + work, stored, viscous, lost };
        (self.pushed, self.moved, self.reduced_time) = (pushed, moved, contact.reduced_time());
        Ok(self.energies)
    }

    /// The energies at the end of the step recorded last.
    pub fn energies(&self) -> Energies {
        self.energies
    }

    /// Whether the last step began where the balance is, and can be taken again.
    fn starts_with(&self, contact: &ViscoelasticContact) -> bool {
        let State { history, start, .. } = &contact.computation.state;
        history.start_is_kept() && start.clock.reduced_time == self.reduced_time
    }

    /// Whether the work of the last step is not known from the forces at its ends.
    fn is_inexact(&self, contact: &ViscoelasticContact) -> bool {
        let Some((attraction, passes)) = contact.fields().attraction().zip(contact.passes()) else { return false };
        let of_cell = contact.grid().cell_area() * attraction.energy(0.0);
        passes.unaccounted.abs() > PassReport::noticed(self.energies.stored.abs(), of_cell)
    }

    /// Takes in the last step in two halves, each computed again; returns whether they end where the step did.
    fn take_in_halves(
        &mut self,
        (before, contact): (Option<&ViscoelasticContact>, &ViscoelasticContact),
        halvings: u32,
    ) -> Result<bool> {
        let (end, load) = (&contact.computation.state, contact.fields().load());
        let start = before.map_or(&end.previous, |before| &before.computation.state.held.current);
        let mut part = match before {
            Some(before) => before.clone(),
            None => contact.within_step(end.start.clock.time)?,
        };
        let half = 0.5 * (contact.time() - part.time());
        let (middle, tolerance) = (contact.time() - half, contact.settings().tolerance());
        for (time, load) in [(middle, part.load_like(0, &load).towards(&load, 0.5)), (contact.time(), load)] {
            part.take_part(time, &[load], tolerance, end.start.interpolant)?;
            self.take_in_half(&part, half, halvings)?;
        }
        Ok(!part.is_elsewhere([start, &end.held.current]))
    }

    fn take_in_half(&mut self, part: &ViscoelasticContact, dt: f64, halvings: u32) -> Result<Energies> {
        let may_jump = part.passes().is_some_and(|passes| passes.may_jump(0.0));
        let jumped = may_jump && self.starts_with(part) && self.is_inexact(part);
        self.take_in((None, part), dt, jumped, halvings)
    }

    /// Energy of the attraction \[J\], 0 for bodies far apart.
    fn attracted(&mut self, contact: &ViscoelasticContact) -> Result<f64> {
        let Some(attraction) = contact.fields().attraction() else { return Ok(0.0) };
        contact.fields().gap_into(&mut self.gap)?;
        let energies = self.gap.iter().filter(|gap| gap.is_finite()).map(|gap| attraction.energy(gap.max(0.0)));
        Ok(-contact.grid().cell_area() * energies.sum::<f64>())
    }
}

/// Force and moments, and approach and tilts, about the point about which a body is free to tilt.
type AtLoadPoint = ([f64; 3], [f64; 3]);

fn about_load_point(contact: &ViscoelasticContact, ([force, m1, m2], [approach, t1, t2]): AtLoadPoint) -> AtLoadPoint {
    let [x1, x2] = contact.fields().load().tilt().map(|tilt| if let Tilt::Free { at } = tilt { at } else { 0.0 });
    ([force, m1 - x1 * force, m2 - x2 * force], [approach + t1 * x1 + t2 * x2, t1, t2])
}

/// Force and moments at the beginning and at the end of the motion in a step with a jump, which is at its end: what is
/// released belongs to the load there. So a given motion is over before the jump, and what the load leaves free moves
/// under the load of the end.
fn ends_of_jump(contact: &ViscoelasticContact, (before, moved): AtLoadPoint, after: [f64; 3]) -> [[f64; 3]; 2] {
    let load = contact.fields().load();
    let is_given = |k: usize| match (k, load) {
        (0, load) => matches!(load, Load::Approach { .. }),
        (k, load) => matches!(load.tilt()[k - 1], Tilt::Fixed(_)),
    };
    let end = [0, 1, 2].map(|k| if is_given(k) { before[k] } else { after[k] });
    let held = match load {
        Load::Spring { stiffness, drive, .. } => stiffness * (drive - moved[0]),
        _ => end[0],
    };
    [[held, end[1], end[2]], end]
}
