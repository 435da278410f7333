//! State of the hereditary integral.

use crate::hereditary::exponential_rule::ExponentialRule;
use crate::hereditary::field::Field;
use crate::hereditary::interval::{HistoryInputs, Interval};
use crate::hereditary::moving_frame::MovingFrame;
use crate::hereditary::remembered_field::RememberedField;
use crate::kernel::{LocalKernel, Workspace};
use crate::rheology::CreepSpectrum;

/// The displacement of a contact and the memory of its past.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct History {
    rule: ExponentialRule,
    pub(super) displacement: RememberedField,
    /// Where only a window of the grid is computed, the field U whose convolution K U is the displacement elsewhere.
    /// Zero wherever there never was contact.
    far: Option<RememberedField>,
    /// Where the bodies move under the grid, the past of the pressure, whose convolution is the displacement.
    frame: Option<MovingFrame>,
    /// Whether the start of the last step is kept: the trial of each field, and what the past has yet to take in.
    start_is_kept: bool,
}

clone_by_fields! { History { rule, displacement, far, frame, start_is_kept } }

impl History {
    fn new(rule: ExponentialRule, displacement: RememberedField, frame: Option<MovingFrame>) -> History {
        History { rule, displacement, far: None, frame, start_is_kept: false }
    }

    /// Undisturbed bodies with contact compliance `creep`, by the exponential rule; on no cells yet.
    pub(crate) fn exponential(creep: &CreepSpectrum) -> History {
        let rule = ExponentialRule::new(creep);
        let displacement = RememberedField::on_no_cells(&rule, rule.branches());
        History::new(rule, displacement, None)
    }

    /// Undisturbed bodies that move under the grid, by the exponential rule; on no cells yet.
    pub(crate) fn moving_frame(creep: &CreepSpectrum, periodic: [bool; 2]) -> History {
        let rule = ExponentialRule::new(creep);
        let frame = MovingFrame::new(RememberedField::on_no_cells(&rule, rule.branches()), periodic);
        let displacement = RememberedField::on_no_cells(&rule, 0);
        History::new(rule, displacement, Some(frame))
    }

    /// A copy on other cells, a `window` of the grid or all of it. `map` gives its fields, one for each field here.
    pub(crate) fn map(&self, cells: [usize; 2], window: bool, map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> History {
        let History { rule, displacement, far, frame, start_is_kept } = self;
        History {
            rule: rule.clone(),
            displacement: displacement.map(far.as_ref(), map),
            far: far.as_ref().filter(|_| window).map(|far| far.map(None, map)),
            frame: frame.as_ref().map(|frame| frame.map(cells, map)),
            start_is_kept: *start_is_kept,
        }
    }

    /// A copy without values, with a far field for a `window` of the grid.
    pub(crate) fn layout(&self, window: bool) -> History {
        let layout = self.map([0; 2], false, &mut |_| Vec::new());
        let far = (window && self.has_far_field()).then(|| layout.displacement.clone());
        History { far, ..layout }
    }

    /// How many values it has for each cell.
    pub(crate) fn values_per_cell(&self) -> usize {
        let mut values = 0;
        self.map([0; 2], true, &mut |field| {
            values += field.per_cell;
            Vec::new()
        });
        values
    }

    /// Whether the displacement outside a window of the grid can be found.
    pub(crate) fn has_far_field(&self) -> bool {
        self.frame.is_none()
    }

    /// The recursion that the displacement follows.
    pub(crate) fn rule(&self) -> &ExponentialRule {
        &self.rule
    }

    /// The past does not determine how the displacement continues, as after a corner of the load.
    pub(crate) fn reset_differences(&mut self) {
        self.rule.reset_differences();
    }

    /// The rule, and all fields that follow the recursion of the displacement.
    fn parts(&mut self) -> (&mut ExponentialRule, impl Iterator<Item = &mut RememberedField>) {
        let History { rule, displacement, far, frame, .. } = self;
        let of_frame = frame.iter_mut().flat_map(MovingFrame::fields_mut);
        (rule, [displacement].into_iter().chain(far).chain(of_frame))
    }

    /// The displacement \[m\].
    pub(crate) fn displacement(&self) -> &[f64] {
        &self.displacement.now
    }

    /// The displacement at the end of the step being tried: u_old once it is predicted, u once the bodies responded.
    pub(crate) fn tried_displacement(&self) -> &[f64] {
        &self.displacement.trial
    }

    /// Whether [`History::roll_back`] can return to the start of the last step: not once another step was tried, nor
    /// where the bodies moved.
    pub(crate) fn start_is_kept(&self) -> bool {
        self.start_is_kept
    }

    /// Gives up the start of the last step.
    pub(crate) fn forget_start(&mut self) {
        self.start_is_kept = false;
    }

    /// Returns to the start of the last step, which must be kept.
    pub(crate) fn roll_back(&mut self) {
        self.start_is_kept = false;
        let (rule, fields) = self.parts();
        rule.roll_back();
        fields.for_each(RememberedField::roll_back);
    }

    /// The change of the displacement in the last step, once the next is predicted; none where it is not kept.
    pub(crate) fn last_change(&self) -> Option<&[f64]> {
        Some(self.displacement.differences()[0]).filter(|change| !change.is_empty())
    }

    /// The source U of the far field, if only a window is computed.
    pub(crate) fn far_source(&self) -> Option<&[f64]> {
        self.far.as_ref().map(|far| &far.now[..])
    }

    /// The source U at the end of the step being tried; between steps, before the last one.
    pub(crate) fn tried_far_source(&self) -> Option<&[f64]> {
        self.far.as_ref().map(|far| &far.trial[..])
    }

    /// Whether the displacement itself is part of the past, rather than computed anew from v.
    pub(crate) fn integrates_displacement(&self) -> bool {
        self.rule.has_memory()
    }

    /// Whether the surface in contact stays, from step to step, exactly on a body whose motion is prescribed.
    pub(crate) fn follows_body_exactly(&self) -> bool {
        self.has_far_field() && self.integrates_displacement()
    }

    /// Predicts u = u_old + c K p at the end of a step: u_old is written to the trial. Returns c, which is 0 in jumps
    /// of bodies without elastic response, and the number of convolutions taken.
    pub(crate) fn predict(
        &mut self,
        step: Interval,
        inputs: HistoryInputs,
        kernel: &LocalKernel,
        work: &mut Workspace,
    ) -> (f64, usize) {
        self.start_is_kept = false;
        let History { rule, displacement, far, frame, .. } = self;
        rule.compute_weights(step.dt, step.interpolant);
        if let Some(frame) = frame {
            let convolutions = frame.predict(rule, step.stride, inputs.least_side, displacement, (kernel, work));
            return (rule.compliance(), convolutions);
        }
        // the sign of u is no criterion where pressures raise the surface
        let sign_counts = !kernel.whole.raises() && !inputs.pulls;
        displacement.predict_non_negative(rule, inputs.least_side, kernel.rows(), || sign_counts);
        far.iter_mut().for_each(|far| far.predict(rule));
        (rule.compliance(), 0)
    }

    /// Adds the response to the pressure found for the step, and v = K p; `displace` turns u_old, given the
    /// displacement at the start of the step, into the displacement at its end.
    pub(crate) fn respond(
        &mut self,
        c: f64,
        [pressure, potential]: [&[f64]; 2],
        displace: impl FnOnce(&[f64], &mut [f64]),
    ) {
        let RememberedField { now, trial, .. } = &mut self.displacement;
        self.far.iter_mut().for_each(|far| far.add(c, pressure));
        if let Some(frame) = &mut self.frame {
            frame.respond(c, pressure, trial, potential);
            displace(now, trial);
            frame.add_displacement(trial);
        } else {
            displace(now, trial);
        }
    }

    /// Whether the sources of a moving frame have reached the edge behind a motion.
    pub(crate) fn has_left(&self, axis: usize, is_forward: bool) -> bool {
        self.frame.as_ref().is_some_and(|frame| frame.has_left(axis, is_forward))
    }

    /// u − u_old, by which a free displacement recedes in the step predicted last: calls `take` with it for each cell
    /// that is `wanted`; none where the bodies move.
    pub(crate) fn recovery(&self, wanted: impl Fn(usize) -> bool, mut take: impl FnMut(usize, f64)) {
        if self.frame.is_some() {
            return;
        }
        let own = &self.rule;
        let (held, now) = (own.compliance() * own.equilibrium(), &self.displacement.now);
        self.displacement.recovery(&own.tried, wanted, |k, by_past| take(k, held * now[k] + by_past));
    }

    /// Accepts the step predicted last.
    pub(crate) fn commit(&mut self, step: Interval) {
        if let Some(frame) = self.frame.as_mut().filter(|_| step.stride != [0; 2]) {
            frame.shift_start(step.stride, &mut self.displacement);
        }
        let (rule, fields) = self.parts();
        rule.commit();
        fields.for_each(RememberedField::commit);
        // under bodies that moved, the field before the step belongs to other places
        self.start_is_kept = step.stride == [0; 2];
    }

    /// Lets the past take in the last step, whose start is given up.
    pub(crate) fn apply_pending_step(&mut self) {
        self.start_is_kept = false;
        let (rule, fields) = self.parts();
        fields.for_each(|field| field.apply_pending_step(rule));
    }

    /// Whether it follows the same rule as another, on these cells, a `window` of the grid or all of it: a file may
    /// hold anything.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &History, cells: [usize; 2], window: bool) -> bool {
        let kept = self.rule.kept();
        let mut fields = std::iter::once(&self.displacement).chain(&self.far);
        let frame_fits = match (&self.frame, &other.frame) {
            (Some(own), Some(other)) => own.fits(other, kept, cells),
            (own, other) => own.is_none() && other.is_none(),
        };
        self.rule.fits(&other.rule)
            && frame_fits
            && fields.all(|field| field.fits(&other.displacement, kept))
            && self.far.is_some() == (window && self.has_far_field())
    }
}
