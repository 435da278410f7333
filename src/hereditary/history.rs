//! State of the hereditary integral, for every time rule.

use educe::Educe;

use crate::error::Result;
use crate::hereditary::direct_sum::{DirectSum, Weighting};
use crate::hereditary::exponential_rule::ExponentialRule;
use crate::hereditary::field::Field;
use crate::hereditary::interval::Interval;
use crate::hereditary::moving_frame::MovingFrame;
use crate::hereditary::remembered_field::RememberedField;
use crate::kernel::{LocalKernel, Workspace};
use crate::rheology::{CreepSpectrum, Material};

/// The displacement of a contact and the memory of its past.
#[derive(Debug, Educe)]
#[educe(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct History {
    rule: Rule,
    pub(super) displacement: RememberedField,
    /// Where only a window of the grid is computed, the field U whose convolution K U is the displacement elsewhere.
    /// Zero wherever there never was contact.
    far: Option<RememberedField>,
    /// Whether the start of the last step is kept: the trial of each field, and what the past has yet to take in.
    start_is_kept: bool,
}

/// How the displacement follows from its past.
#[derive(Debug, Educe)]
#[educe(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
enum Rule {
    /// By the past of the displacement itself.
    Exponential(ExponentialRule),
    /// By the past of the pressure, whose convolution is the displacement.
    MovingFrame(ExponentialRule, Box<MovingFrame>),
    DirectSum(DirectSum),
}

/// Inputs of a time rule besides the past.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HistoryInputs<'a> {
    pub(crate) material: &'a Material,
    /// Bytes that a direct sum may fill with its past.
    pub(crate) history_limit: usize,
    /// The shorter side of a cell \[m\].
    pub(crate) least_side: f64,
}

impl Rule {
    /// The same rule on other cells, whose fields are what `map` makes of these.
    fn map(&self, cells: [usize; 2], map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> Rule {
        match self {
            Rule::Exponential(own) => Rule::Exponential(own.clone()),
            Rule::MovingFrame(own, frame) => Rule::MovingFrame(own.clone(), Box::new(frame.map(cells, map))),
            Rule::DirectSum(own) => Rule::DirectSum(own.map(map)),
        }
    }

    /// The exponential rule, if it is that.
    fn exponential(&self) -> Option<&ExponentialRule> {
        match self {
            Rule::Exponential(own) | Rule::MovingFrame(own, _) => Some(own),
            Rule::DirectSum(_) => None,
        }
    }

    /// Whether it is the rule of another, on these cells.
    #[cfg(feature = "checkpoint")]
    fn fits(&self, other: &Rule, cells: [usize; 2]) -> bool {
        match (self, other) {
            (Rule::Exponential(own), Rule::Exponential(other)) => own.fits(other),
            (Rule::MovingFrame(own, frame), Rule::MovingFrame(other, other_frame)) => {
                own.fits(other) && frame.fits(other_frame, own.kept(), cells)
            }
            (Rule::DirectSum(own), Rule::DirectSum(other)) => own.fits(other),
            _ => false,
        }
    }
}

impl History {
    fn new(rule: Rule, displacement: RememberedField) -> History {
        History { rule, displacement, far: None, start_is_kept: false }
    }

    /// Undisturbed bodies with contact compliance `creep`, by the exponential rule; on no cells yet.
    pub(crate) fn exponential(creep: &CreepSpectrum) -> History {
        let rule = ExponentialRule::new(creep);
        let displacement = RememberedField::on_no_cells(&rule, rule.branches());
        History::new(Rule::Exponential(rule), displacement)
    }

    /// Undisturbed bodies, by a direct sum over all steps; on no cells yet.
    pub(crate) fn direct_sum(weighting: Weighting) -> History {
        History::new(Rule::DirectSum(DirectSum::new(weighting)), RememberedField::new(0, 0))
    }

    /// Undisturbed bodies that move under the grid, by the exponential rule; on no cells yet.
    pub(crate) fn moving_frame(creep: &CreepSpectrum, periodic: [bool; 2]) -> History {
        let rule = ExponentialRule::new(creep);
        let frame = MovingFrame::new(RememberedField::on_no_cells(&rule, rule.branches()), periodic);
        let displacement = RememberedField::on_no_cells(&rule, 0);
        History::new(Rule::MovingFrame(rule, Box::new(frame)), displacement)
    }

    /// The same history on other cells, a `window` of the grid or all of it, whose fields are what `map` makes of these.
    pub(crate) fn map(&self, cells: [usize; 2], window: bool, map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> History {
        let History { rule, displacement, far, start_is_kept } = self;
        History {
            rule: rule.map(cells, map),
            displacement: displacement.map(far.as_ref(), map),
            far: far.as_ref().filter(|_| window).map(|far| far.map(None, map)),
            start_is_kept: *start_is_kept,
        }
    }

    /// The same history on no cells, with a far field where they are to be a `window` of the grid.
    fn layout(&self, window: bool) -> History {
        let layout = self.map([0; 2], false, &mut |_| Vec::new());
        let far = (window && self.has_far_field()).then(|| layout.displacement.clone());
        History { far, ..layout }
    }

    /// The same bodies, undisturbed, on so many cells; with a far field where these are a `window` of the grid.
    pub(crate) fn undisturbed_on(&self, cells: [usize; 2], window: bool) -> History {
        let count = cells[0] * cells[1];
        self.layout(window).map(cells, window, &mut |field| vec![0.0; count * field.per_cell])
    }

    /// How many values [`History::undisturbed_on`] allocates for each cell.
    pub(crate) fn values_per_cell(&self, window: bool) -> usize {
        let mut values = 0;
        self.layout(window).map([0; 2], window, &mut |field| {
            values += field.per_cell;
            Vec::new()
        });
        values
    }

    /// Whether the displacement outside a window of the grid can be found.
    pub(crate) fn has_far_field(&self) -> bool {
        matches!(self.rule, Rule::Exponential(_))
    }

    /// Whether each step adds a field to the past.
    pub(crate) fn grows(&self) -> bool {
        matches!(self.rule, Rule::DirectSum(_))
    }

    /// The exponential rule, if the history follows it.
    pub(crate) fn exponential_rule(&self) -> Option<&ExponentialRule> {
        self.rule.exponential()
    }

    /// The past does not determine how the displacement continues, as after a corner of the load.
    pub(crate) fn reset_differences(&mut self) {
        if let Rule::Exponential(own) | Rule::MovingFrame(own, _) = &mut self.rule {
            own.reset_differences();
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

    /// Whether [`History::roll_back`] can return to the start of the last step: not once another step was tried, nor where the
    /// bodies moved.
    pub(crate) fn start_is_kept(&self) -> bool {
        self.start_is_kept
    }

    /// Gives up the start of the last step.
    pub(crate) fn forget_start(&mut self) {
        self.start_is_kept = false;
    }

    /// Returns to the start of the last step, which must be kept; `touched` is true if the step was taken into a direct sum.
    pub(crate) fn roll_back(&mut self, touched: bool) {
        let History { rule, displacement, far, start_is_kept } = self;
        far.iter_mut().for_each(RememberedField::roll_back);
        match rule {
            Rule::Exponential(own) => {
                own.roll_back();
                displacement.roll_back();
            }
            Rule::MovingFrame(own, frame) => {
                own.roll_back();
                frame.roll_back(displacement);
            }
            Rule::DirectSum(own) => {
                if touched {
                    own.roll_back();
                }
                displacement.roll_back();
            }
        }
        *start_is_kept = false;
    }

    /// The change of the displacement in the last step, once the next is predicted; none where it is not kept.
    pub(crate) fn last_change(&self) -> Option<&[f64]> {
        Some(self.displacement.past.differences()[0]).filter(|change| !change.is_empty())
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
        self.rule.exponential().is_some_and(ExponentialRule::has_memory)
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
        self.start_is_kept = false;
        let History { rule, displacement, far, .. } = self;
        match rule {
            Rule::Exponential(own) => {
                // the sign of u is no criterion where pressures raise the surface
                let sign_counts = || !kernel.raises();
                let step = (step.dt, step.interpolant);
                displacement.predict_non_negative(own, step, inputs.least_side, kernel.rows(), sign_counts);
                far.iter_mut().for_each(|far| far.predict(own));
                Ok((own.compliance(), 0))
            }
            Rule::MovingFrame(own, frame) => {
                own.compute_weights(step.dt, step.interpolant);
                displacement.apply_pending_step(own);
                if !own.has_memory() {
                    frame.predict(own, step.stride);
                    displacement.trial.fill(0.0);
                    return Ok((own.compliance(), 0));
                }
                let mut convolutions = 0;
                loop {
                    frame.predict(own, step.stride);
                    let ([source, remainder], trial) = (frame.predicted(), &mut displacement.trial);
                    kernel.apply(source, trial, work);
                    trial.iter_mut().zip(remainder).for_each(|(u_old, &e)| *u_old += e);
                    convolutions += 1;
                    let falls_below_zero =
                        own.has_less() && displacement.falls_below_zero(own, inputs.least_side, kernel.rows());
                    if !falls_below_zero || kernel.raises() {
                        return Ok((own.compliance(), convolutions));
                    }
                    own.reduce_order();
                }
            }
            Rule::DirectSum(own) => {
                let RememberedField { now, trial, .. } = displacement;
                let (c, convolutions) = own.predict(step, inputs, (kernel, work), trial)?;
                if c == 0.0 {
                    trial.copy_from_slice(now); // the sum is the same but for rounding
                }
                Ok((c, convolutions))
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
        let RememberedField { now, trial, .. } = &mut self.displacement;
        self.far.iter_mut().for_each(|far| far.add(c, pressure));
        if let Rule::MovingFrame(_, frame) = &mut self.rule {
            frame.respond(c, pressure, trial, potential);
            displace(now, trial);
            frame.add_displacement(trial);
        } else {
            displace(now, trial);
        }
    }

    /// u − u_old, by which a free displacement recedes in the step predicted last: calls `take` with it for each cell that is
    /// `wanted`. Only the exponential rule has it.
    pub(crate) fn recovery(&self, wanted: impl Fn(usize) -> bool, mut take: impl FnMut(usize, f64)) {
        let Rule::Exponential(own) = &self.rule else { return };
        let RememberedField { past, now, .. } = &self.displacement;
        let held = own.compliance() * own.equilibrium();
        past.recovery(&own.tried, now.len(), wanted, |k, by_past| take(k, held * now[k] + by_past));
    }

    /// Accepts the step predicted last, given p and v = K p, each at its start and at its end; `touched` is true if
    /// anything has ever been displaced.
    pub(crate) fn commit(&mut self, step: Interval, pressed: [[&[f64]; 2]; 2], touched: bool) {
        let History { rule, displacement, far, .. } = self;
        far.iter_mut().for_each(RememberedField::commit);
        match rule {
            Rule::Exponential(own) => {
                own.commit();
                displacement.commit();
            }
            Rule::MovingFrame(own, frame) => {
                own.commit();
                frame.commit(step.stride, displacement);
            }
            Rule::DirectSum(own) => {
                if touched {
                    own.commit((step.reduced, step.dt), pressed);
                }
                displacement.commit();
            }
        }
        // under bodies that moved, the field before the step belongs to other places
        self.start_is_kept = step.stride == [0; 2];
    }

    /// Lets the past take in the last step, whose start is given up.
    pub(crate) fn apply_pending_step(&mut self) {
        let History { rule, displacement, far, start_is_kept } = self;
        *start_is_kept = false;
        let (Rule::Exponential(own) | Rule::MovingFrame(own, _)) = &*rule else { return };
        displacement.apply_pending_step(own);
        far.iter_mut().for_each(|far| far.apply_pending_step(own));
        if let Rule::MovingFrame(own, frame) = rule {
            frame.apply_pending_step(own);
        }
    }

    /// Whether it follows the same rule as another, on these cells, a `window` of the grid or all of it: a file may hold
    /// anything.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &History, cells: [usize; 2], window: bool) -> bool {
        let kept = self.rule.exponential().map_or(0, ExponentialRule::kept);
        let mut fields = std::iter::once(&self.displacement).chain(&self.far);
        self.rule.fits(&other.rule, cells)
            && fields.all(|field| field.past.fits(&other.displacement.past, kept))
            && self.far.is_some() == (window && self.has_far_field())
    }
}
