//! What the bodies remember, by whichever time rule.

use crate::error::{Error, Result};
use crate::hereditary::direct_sum::{DirectSum, Weighting};
use crate::hereditary::moving_frame::MovingFrame;
use crate::hereditary::remembered_field::RememberedField;
use crate::kernel::{LocalKernel, Workspace};
use crate::rheology::{CreepSpectrum, Material};

/// The displacement of a contact and what the bodies remember of its past.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Memory {
    past: Past,
    /// Whether the trial is the displacement before the last step, cell by cell.
    before_is_kept: bool,
}

#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
enum Past {
    Exponential {
        displacement: RememberedField,
        /// Where only a window of the grid is computed, the field U whose convolution K U is the displacement elsewhere.
        /// U ≥ 0, and zero wherever there never was contact.
        far: Option<RememberedField>,
    },
    DirectSum(RememberedField<DirectSum>),
    MovingFrame(Box<RememberedField<MovingFrame>>),
}

/// A time step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval {
    /// Its end \[s\].
    pub(crate) time: f64,
    /// Its length \[s\], 0 for a jump.
    pub(crate) dt: f64,
    /// By how many cells the bodies move under the grid.
    pub(crate) stride: [isize; 2],
}

/// What a time rule may look at, besides the past.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bodies<'a> {
    pub(crate) material: &'a Material,
    /// Bytes that a direct sum may fill with its past.
    pub(crate) history_limit: usize,
}

/// Carries fields to other cells.
pub(crate) trait Transfer {
    /// The cells they are carried to.
    fn cells(&self) -> [usize; 2];

    /// Whether these are all that there are, mirror images included.
    fn covers(&self) -> bool;

    /// A field that is zero wherever it was not computed.
    fn confined(&self, own: &[f64]) -> Vec<f64>;

    /// A field that is the convolution of `source` wherever it was not computed; zero without a source.
    fn induced(&mut self, own: &[f64], source: Option<&[f64]>) -> Vec<f64>;
}

impl Memory {
    fn new(past: Past) -> Memory {
        Memory { past, before_is_kept: true }
    }

    /// Undisturbed bodies with contact compliance `creep`, by the exponential rule; on no cells yet.
    pub(crate) fn exponential(creep: &CreepSpectrum) -> Memory {
        Memory::new(Past::Exponential { displacement: RememberedField::new(creep, 0), far: None })
    }

    /// Undisturbed bodies, by a direct sum over all steps; on no cells yet.
    pub(crate) fn direct_sum(weighting: Weighting) -> Memory {
        Memory::new(Past::DirectSum(RememberedField::undisturbed(DirectSum::new(weighting), 0)))
    }

    /// Undisturbed bodies that move under the grid, by the exponential rule; on no cells yet.
    pub(crate) fn moving_frame(creep: &CreepSpectrum, periodic: [bool; 2]) -> Memory {
        Memory::new(Past::MovingFrame(Box::new(RememberedField::undisturbed(MovingFrame::new(creep, periodic), 0))))
    }

    /// The same bodies, undisturbed, on so many cells; with a far field where these are a `window` of the grid.
    pub(crate) fn undisturbed_on(&self, cells: [usize; 2], window: bool) -> Memory {
        let count = cells[0] * cells[1];
        Memory::new(match &self.past {
            Past::Exponential { displacement, .. } => {
                let displacement = displacement.undisturbed_on(count);
                Past::Exponential { far: window.then(|| displacement.clone()), displacement }
            }
            Past::DirectSum(displacement) => {
                Past::DirectSum(RememberedField::undisturbed(displacement.recursion.without_increments(), count))
            }
            Past::MovingFrame(displacement) => {
                let frame = displacement.recursion.undisturbed_on(cells);
                Past::MovingFrame(Box::new(RememberedField::undisturbed(frame, count)))
            }
        })
    }

    /// Whether the displacement outside a window of the grid can be found.
    pub(crate) fn has_far_field(&self) -> bool {
        matches!(self.past, Past::Exponential { .. })
    }

    /// Whether each step adds a field to the past.
    pub(crate) fn grows(&self) -> bool {
        matches!(self.past, Past::DirectSum(_))
    }

    /// Bytes per cell of an undisturbed past, besides the displacement; a far field takes as much again, and two fields.
    pub(crate) fn bytes_per_cell(&self) -> usize {
        match &self.past {
            Past::Exponential { displacement, .. } => displacement.bytes_per_cell(),
            Past::DirectSum(_) => 0,
            Past::MovingFrame(displacement) => displacement.recursion.bytes_per_cell(),
        }
    }

    /// The displacement \[m\].
    pub(crate) fn displacement(&self) -> &[f64] {
        match &self.past {
            Past::Exponential { displacement, .. } => displacement.now(),
            Past::DirectSum(displacement) => displacement.now(),
            Past::MovingFrame(displacement) => displacement.now(),
        }
    }

    /// The displacement at the end of the step being tried: u_old once it is predicted, u once the bodies responded.
    pub(crate) fn trial(&self) -> &[f64] {
        match &self.past {
            Past::Exponential { displacement, .. } => displacement.trial(),
            Past::DirectSum(displacement) => displacement.trial(),
            Past::MovingFrame(displacement) => displacement.trial(),
        }
    }

    /// The displacement before the last step, unless a step was tried in the meantime or the bodies moved.
    pub(crate) fn displacement_before(&self) -> Option<&[f64]> {
        self.before_is_kept.then(|| self.trial())
    }

    fn far(&self) -> Option<&RememberedField> {
        if let Past::Exponential { far, .. } = &self.past { far.as_ref() } else { None }
    }

    /// The source U of the far field, if only a window is computed.
    pub(crate) fn far_source(&self) -> Option<&[f64]> {
        self.far().map(RememberedField::now)
    }

    /// The same at the end of the step being tried; between steps, before the last one.
    pub(crate) fn far_trial(&self) -> Option<&[f64]> {
        self.far().map(RememberedField::trial)
    }

    /// Whether the displacement itself is part of the past, rather than computed anew from v.
    pub(crate) fn integrates_displacement(&self) -> bool {
        match &self.past {
            Past::Exponential { displacement, .. } => displacement.recursion.remembers(),
            Past::DirectSum(_) => false,
            Past::MovingFrame(displacement) => displacement.recursion.remembers(),
        }
    }

    /// Whether the surface in contact stays, from step to step, exactly on a body whose motion is prescribed.
    pub(crate) fn follows_body_exactly(&self) -> bool {
        matches!(self.past, Past::Exponential { .. }) && self.integrates_displacement()
    }

    /// Predicts u = u_old + c K p at the end of a step: u_old is written to the trial; returned are c, which is 0 in jumps
    /// of bodies without elastic response, and the number of convolutions taken.
    pub(crate) fn predict(
        &mut self,
        step: Interval,
        bodies: Bodies<'_>,
        kernel: &LocalKernel,
        work: &mut Workspace,
    ) -> Result<(f64, usize)> {
        self.before_is_kept = false;
        match &mut self.past {
            Past::Exponential { displacement, far } => {
                if let Some(far) = far {
                    far.predict(step.dt);
                }
                Ok((displacement.predict(step.dt), 0))
            }
            Past::DirectSum(RememberedField { recursion, now, trial }) => {
                let c = recursion.predict((step.time, step.dt), bodies.material, bodies.history_limit, trial)?;
                if c == 0.0 {
                    trial.copy_from_slice(now); // the sum is the same but for rounding
                }
                Ok((c, 0))
            }
            Past::MovingFrame(displacement) => {
                let RememberedField { recursion, trial, .. } = &mut **displacement;
                let c = recursion.predict(step.dt, step.stride);
                if !recursion.remembers() {
                    trial.fill(0.0);
                    return Ok((c, 0));
                }
                let [source, remainder] = recursion.predicted();
                kernel.apply(source, trial, work);
                trial.iter_mut().zip(remainder).for_each(|(u_old, &e)| *u_old += e);
                Ok((c, 1))
            }
        }
    }

    /// Takes in the pressure found for the step, and v = K p; `displace` turns u_old, given the displacement at the start
    /// of the step, into the displacement at its end.
    pub(crate) fn respond(
        &mut self,
        c: f64,
        [pressure, potential]: [&[f64]; 2],
        displace: impl FnOnce(&[f64], &mut [f64]),
    ) {
        match &mut self.past {
            Past::Exponential { displacement, far } => {
                if let Some(far) = far {
                    far.add(c, pressure);
                }
                let (now, trial) = displacement.now_and_trial();
                displace(now, trial);
            }
            Past::DirectSum(displacement) => {
                let (now, trial) = displacement.now_and_trial();
                displace(now, trial);
            }
            Past::MovingFrame(displacement) => {
                let RememberedField { recursion, now, trial } = &mut **displacement;
                recursion.respond(c, pressure, trial, potential);
                displace(now, trial);
                recursion.add_displacement(trial);
            }
        }
    }

    /// c (E∞ u + Σ e^(−z_i) q_i), by how much a displacement that is left free recedes in the step predicted last: calls
    /// `take` with it for each cell that is `wanted`. Nothing is known of it by rules other than the exponential one.
    pub(crate) fn recovery(&self, c: f64, wanted: impl Fn(usize) -> bool, take: impl FnMut(usize, f64)) {
        if let Past::Exponential { displacement, .. } = &self.past {
            displacement.recursion.recovery(c, displacement.now(), wanted, take);
        }
    }

    /// Accepts the step predicted last, in which v = K p went from one field to the other; `touched` tells whether
    /// anything has ever been displaced.
    pub(crate) fn commit(&mut self, step: Interval, potential: [&[f64]; 2], touched: bool) {
        match &mut self.past {
            Past::Exponential { displacement, far } => {
                displacement.commit();
                far.iter_mut().for_each(RememberedField::commit);
            }
            Past::DirectSum(RememberedField { recursion, now, trial }) => {
                if touched {
                    recursion.commit((step.time, step.dt), potential);
                }
                std::mem::swap(now, trial);
            }
            Past::MovingFrame(displacement) => {
                let RememberedField { recursion, now, trial } = &mut **displacement;
                recursion.commit(step.stride);
                std::mem::swap(now, trial);
            }
        }
        // under bodies that moved, the field before the step belongs to other places
        self.before_is_kept = step.stride == [0; 2];
    }

    /// The same past on other cells. The displacement before the last step stays behind.
    pub(crate) fn carried(&mut self, transfer: &mut impl Transfer) -> Memory {
        let [n1, n2] = transfer.cells();
        let past = match &mut self.past {
            Past::Exponential { displacement, far } => {
                displacement.settle();
                far.iter_mut().for_each(RememberedField::settle);
                let far = far.as_ref();
                let displacement = displacement
                    .carried(n1 * n2, |part, own| transfer.induced(own, far.map(|far| far.part(part)).as_deref()));
                let far = far.filter(|_| !transfer.covers());
                let far = far.map(|far| far.carried(n1 * n2, |_, own| transfer.confined(own)));
                Past::Exponential { displacement, far }
            }
            Past::DirectSum(RememberedField { recursion, now, .. }) => Past::DirectSum(RememberedField {
                recursion: recursion.carried(|own| transfer.confined(own)),
                now: transfer.induced(now, None),
                trial: vec![0.0; n1 * n2],
            }),
            Past::MovingFrame(displacement) => Past::MovingFrame(Box::new(RememberedField {
                recursion: displacement.recursion.carried([n1, n2], |own| transfer.confined(own)),
                now: transfer.induced(&displacement.now, None),
                trial: vec![0.0; n1 * n2],
            })),
        };
        Memory { past, before_is_kept: false }
    }

    /// Copies another without reallocating where both have the same rule and cells, and no direct sum grows.
    pub(crate) fn copy_from(&mut self, other: &Memory) {
        self.before_is_kept = other.before_is_kept;
        match (&mut self.past, &other.past) {
            (Past::Exponential { displacement, far: None }, Past::Exponential { displacement: other, far: None }) => {
                displacement.copy_from(other)
            }
            (
                Past::Exponential { displacement, far: Some(far) },
                Past::Exponential { displacement: other, far: Some(other_far) },
            ) => {
                displacement.copy_from(other);
                far.copy_from(other_far);
            }
            (Past::MovingFrame(own), Past::MovingFrame(other)) => {
                own.recursion.copy_from(&other.recursion);
                own.copy_fields_from(other);
            }
            (own, other) => *own = other.clone(),
        }
    }

    /// Whether it follows the same rule as another, on these cells: a file may hold anything.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &Memory, cells: [usize; 2]) -> bool {
        let count = cells[0] * cells[1];
        std::mem::discriminant(&self.past) == std::mem::discriminant(&other.past)
            && match &self.past {
                Past::Exponential { displacement, far } => {
                    displacement.fits(count) && far.as_ref().is_none_or(|far| far.fits(count))
                }
                Past::DirectSum(displacement) => displacement.has_cells(count) && displacement.recursion.fits(count),
                Past::MovingFrame(displacement) => displacement.has_cells(count) && displacement.recursion.fits(cells),
            }
    }
}

/// The error of a jump that bodies without elastic response cannot follow.
pub(crate) fn no_elastic_response(time: f64) -> Error {
    let what = "a jump of the load that changes the pressure (ramp the load over a short time instead)";
    Error::NoElasticResponse { time, what }
}
