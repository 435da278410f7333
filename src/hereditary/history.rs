//! State of the hereditary integral, for every time rule.

use crate::error::{Error, Result};
use crate::hereditary::direct_sum::{DirectSum, Weighting};
use crate::hereditary::exponential::Exponential;
use crate::hereditary::moving_frame::MovingFrame;
use crate::hereditary::remembered_field::RememberedField;
use crate::kernel::{LocalKernel, Workspace};
use crate::rheology::{CreepSpectrum, Material};

/// The displacement of a contact and what the bodies remember of its past.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct History {
    displacement: RememberedField<Recursion>,
    /// Where only a window of the grid is computed, the field U whose convolution K U is the displacement elsewhere.
    /// U ≥ 0, and zero wherever there never was contact.
    far: Option<RememberedField>,
    /// Whether the trial of the displacement is that before the last step, cell by cell.
    before_is_kept: bool,
}

/// How the displacement follows from its past.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
enum Recursion {
    Exponential(Exponential),
    DirectSum(DirectSum),
    MovingFrame(Box<MovingFrame>),
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

/// Inputs of a time rule besides the past.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HistoryInputs<'a> {
    pub(crate) material: &'a Material,
    /// Bytes that a direct sum may fill with its past.
    pub(crate) history_limit: usize,
}

/// Carries fields to other cells.
pub(crate) trait Transfer {
    /// The cells they are carried to.
    fn cells(&self) -> [usize; 2];

    /// Whether they cover the whole grid, mirror images included.
    fn covers(&self) -> bool;

    /// A field that is zero wherever it was not computed.
    fn confined(&self, own: &[f64]) -> Vec<f64>;

    /// A field that is the convolution of `source` wherever it was not computed; zero without a source.
    fn induced(&mut self, own: &[f64], source: Option<&[f64]>) -> Vec<f64>;
}

impl Recursion {
    /// Without a past, on so many cells.
    fn undisturbed_on(&self, cells: [usize; 2]) -> Recursion {
        match self {
            Recursion::Exponential(own) => Recursion::Exponential(own.undisturbed_on(cells[0] * cells[1])),
            Recursion::DirectSum(own) => Recursion::DirectSum(own.without_increments()),
            Recursion::MovingFrame(own) => Recursion::MovingFrame(Box::new(own.undisturbed_on(cells))),
        }
    }

    fn copy_from(&mut self, other: &Recursion) {
        match (self, other) {
            (Recursion::Exponential(own), Recursion::Exponential(other)) => own.copy_from(other),
            (Recursion::MovingFrame(own), Recursion::MovingFrame(other)) => own.copy_from(other),
            (own, other) => *own = other.clone(),
        }
    }

    /// Whether it is the rule of another, on these cells.
    #[cfg(feature = "checkpoint")]
    fn fits(&self, other: &Recursion, cells: [usize; 2]) -> bool {
        let count = cells[0] * cells[1];
        match (self, other) {
            (Recursion::Exponential(own), Recursion::Exponential(other)) => own.fits(other, count),
            (Recursion::DirectSum(own), Recursion::DirectSum(other)) => own.fits(other, count),
            (Recursion::MovingFrame(own), Recursion::MovingFrame(other)) => own.fits(other, cells),
            _ => false,
        }
    }
}

impl History {
    fn new(recursion: Recursion) -> History {
        History { displacement: RememberedField::undisturbed(recursion, 0), far: None, before_is_kept: true }
    }

    /// Undisturbed bodies with contact compliance `creep`, by the exponential rule; on no cells yet.
    pub(crate) fn exponential(creep: &CreepSpectrum) -> History {
        History::new(Recursion::Exponential(Exponential::new(creep, 0)))
    }

    /// Undisturbed bodies, by a direct sum over all steps; on no cells yet.
    pub(crate) fn direct_sum(weighting: Weighting) -> History {
        History::new(Recursion::DirectSum(DirectSum::new(weighting)))
    }

    /// Undisturbed bodies that move under the grid, by the exponential rule; on no cells yet.
    pub(crate) fn moving_frame(creep: &CreepSpectrum, periodic: [bool; 2]) -> History {
        History::new(Recursion::MovingFrame(Box::new(MovingFrame::new(creep, periodic))))
    }

    /// The same bodies, undisturbed, on so many cells; with a far field where these are a `window` of the grid.
    pub(crate) fn undisturbed_on(&self, cells: [usize; 2], window: bool) -> History {
        let (count, recursion) = (cells[0] * cells[1], self.displacement.recursion.undisturbed_on(cells));
        let far = match &recursion {
            Recursion::Exponential(own) if window => Some(RememberedField::undisturbed(own.clone(), count)),
            _ => None,
        };
        History { displacement: RememberedField::undisturbed(recursion, count), far, before_is_kept: true }
    }

    /// Whether the displacement outside a window of the grid can be found.
    pub(crate) fn has_far_field(&self) -> bool {
        matches!(self.displacement.recursion, Recursion::Exponential(_))
    }

    /// Whether each step adds a field to the past.
    pub(crate) fn grows(&self) -> bool {
        matches!(self.displacement.recursion, Recursion::DirectSum(_))
    }

    /// Bytes per cell of an undisturbed past, besides the displacement; a far field takes as much again, and two fields.
    pub(crate) fn bytes_per_cell(&self) -> usize {
        match &self.displacement.recursion {
            Recursion::Exponential(own) => own.bytes_per_cell(),
            Recursion::DirectSum(_) => 0,
            Recursion::MovingFrame(own) => own.bytes_per_cell(),
        }
    }

    /// The displacement \[m\].
    pub(crate) fn displacement(&self) -> &[f64] {
        &self.displacement.now
    }

    /// The displacement at the end of the step being tried: u_old once it is predicted, u once the bodies responded.
    pub(crate) fn trial(&self) -> &[f64] {
        &self.displacement.trial
    }

    /// The displacement before the last step, unless a step was tried in the meantime or the bodies moved.
    pub(crate) fn displacement_before(&self) -> Option<&[f64]> {
        self.before_is_kept.then(|| self.trial())
    }

    /// The source U of the far field, if only a window is computed.
    pub(crate) fn far_source(&self) -> Option<&[f64]> {
        self.far.as_ref().map(|far| &far.now[..])
    }

    /// The same at the end of the step being tried; between steps, before the last one.
    pub(crate) fn far_trial(&self) -> Option<&[f64]> {
        self.far.as_ref().map(|far| &far.trial[..])
    }

    /// Whether the displacement itself is part of the past, rather than computed anew from v.
    pub(crate) fn integrates_displacement(&self) -> bool {
        match &self.displacement.recursion {
            Recursion::Exponential(own) => own.remembers(),
            Recursion::DirectSum(_) => false,
            Recursion::MovingFrame(own) => own.remembers(),
        }
    }

    /// Whether the surface in contact stays, from step to step, exactly on a body whose motion is prescribed.
    pub(crate) fn follows_body_exactly(&self) -> bool {
        self.has_far_field() && self.integrates_displacement()
    }

    /// Predicts u = u_old + c K p at the end of a step: u_old is written to the trial. Returns c, which is 0 in jumps of
    /// bodies without elastic response, and the number of convolutions taken.
    pub(crate) fn predict(
        &mut self,
        step: Interval,
        inputs: HistoryInputs<'_>,
        kernel: &LocalKernel,
        work: &mut Workspace,
    ) -> Result<(f64, usize)> {
        self.before_is_kept = false;
        let RememberedField { recursion, now, trial } = &mut self.displacement;
        match recursion {
            Recursion::Exponential(own) => {
                self.far.iter_mut().for_each(|far| _ = far.predict(step.dt));
                Ok((own.predict(step.dt, now, trial), 0))
            }
            Recursion::DirectSum(own) => {
                let c = own.predict((step.time, step.dt), inputs.material, inputs.history_limit, trial)?;
                if c == 0.0 {
                    trial.copy_from_slice(now); // the sum is the same but for rounding
                }
                Ok((c, 0))
            }
            Recursion::MovingFrame(own) => {
                let c = own.predict(step.dt, step.stride);
                if !own.remembers() {
                    trial.fill(0.0);
                    return Ok((c, 0));
                }
                let [source, remainder] = own.predicted();
                kernel.apply(source, trial, work);
                trial.iter_mut().zip(remainder).for_each(|(u_old, &e)| *u_old += e);
                Ok((c, 1))
            }
        }
    }

    /// Adds the response to the pressure found for the step, and v = K p; `displace` turns u_old, given the displacement at
    /// the start of the step, into the displacement at its end.
    pub(crate) fn respond(
        &mut self,
        c: f64,
        [pressure, potential]: [&[f64]; 2],
        displace: impl FnOnce(&[f64], &mut [f64]),
    ) {
        let RememberedField { recursion, now, trial } = &mut self.displacement;
        self.far.iter_mut().for_each(|far| far.add(c, pressure));
        if let Recursion::MovingFrame(own) = recursion {
            own.respond(c, pressure, trial, potential);
            displace(now, trial);
            own.add_displacement(trial);
        } else {
            displace(now, trial);
        }
    }

    /// c (E∞ u + Σ e^(−z_i) q_i), by which a free displacement recedes in the step predicted last: calls `take` with it for
    /// each cell that is `wanted`. Only the exponential rule knows it.
    pub(crate) fn recovery(&self, c: f64, wanted: impl Fn(usize) -> bool, take: impl FnMut(usize, f64)) {
        if let Recursion::Exponential(own) = &self.displacement.recursion {
            own.recovery(c, &self.displacement.now, wanted, take);
        }
    }

    /// Accepts the step predicted last, in which v = K p went from one field to the other; `touched` tells whether
    /// anything has ever been displaced.
    pub(crate) fn commit(&mut self, step: Interval, potential: [&[f64]; 2], touched: bool) {
        self.far.iter_mut().for_each(RememberedField::commit);
        let RememberedField { recursion, now, trial } = &mut self.displacement;
        match recursion {
            Recursion::Exponential(own) => own.commit(),
            Recursion::DirectSum(own) if touched => own.commit((step.time, step.dt), potential),
            Recursion::DirectSum(_) => {}
            Recursion::MovingFrame(own) => own.commit(step.stride),
        }
        std::mem::swap(now, trial);
        // under bodies that moved, the field before the step belongs to other places
        self.before_is_kept = step.stride == [0; 2];
    }

    /// The same past on other cells. The displacement before the last step stays behind.
    pub(crate) fn carried(&mut self, transfer: &mut impl Transfer) -> History {
        let cells = transfer.cells();
        let RememberedField { recursion, now, trial } = &mut self.displacement;
        self.far.iter_mut().for_each(RememberedField::settle);
        let far = self.far.as_ref();
        let recursion = match recursion {
            Recursion::Exponential(own) => {
                own.settle(trial, now);
                Recursion::Exponential(own.carried(cells[0] * cells[1], now.len(), |i, branch| {
                    transfer.induced(branch, far.map(|far| far.recursion.branch(i, now.len())).as_deref())
                }))
            }
            Recursion::DirectSum(own) => Recursion::DirectSum(own.carried(|own| transfer.confined(own))),
            Recursion::MovingFrame(own) => {
                Recursion::MovingFrame(Box::new(own.carried(cells, |own| transfer.confined(own))))
            }
        };
        let now = transfer.induced(now, far.map(|far| &far.now[..]));
        let far = far.filter(|_| !transfer.covers()).map(|far| far.carried(now.len(), |own| transfer.confined(own)));
        let displacement = RememberedField { recursion, trial: vec![0.0; now.len()], now };
        History { displacement, far, before_is_kept: false }
    }

    /// Copies another without reallocating where both have the same rule and cells, and no direct sum grows.
    pub(crate) fn copy_from(&mut self, other: &History) {
        self.before_is_kept = other.before_is_kept;
        self.displacement.recursion.copy_from(&other.displacement.recursion);
        self.displacement.copy_fields_from(&other.displacement);
        match (&mut self.far, &other.far) {
            (Some(own), Some(other)) => own.copy_from(other),
            (own, other) => *own = other.clone(),
        }
    }

    /// Whether it follows the same rule as another, on these cells, a `window` of the grid or all of it: a file may hold
    /// anything.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &History, cells: [usize; 2], window: bool) -> bool {
        let own = &self.displacement.recursion;
        own.fits(&other.displacement.recursion, cells)
            && self.displacement.has_cells(cells[0] * cells[1])
            && self.far.is_some() == window
            && self.far.as_ref().is_none_or(|far| match own {
                Recursion::Exponential(own) => far.fits(own, cells[0] * cells[1]),
                _ => false,
            })
    }
}

/// The error of a jump that bodies without elastic response cannot follow.
pub(crate) fn no_elastic_response(time: f64) -> Error {
    let what = "a jump of the load that changes the pressure (ramp the load over a short time instead)";
    Error::NoElasticResponse { time, what }
}
