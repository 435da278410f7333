//! The error in time of a step, from what its polynomial lacks.

use std::ops::Range;

use crate::hereditary::error_factors::ERROR_FACTORS;
use crate::hereditary::error_weight::Weight;
use crate::hereditary::exponential_rule::ExponentialRule;
use crate::hereditary::history::History;
use crate::hereditary::kink::Kinks;
use crate::hereditary::outlook::{Meeting, Outlook};
use crate::parallel::Rows;
use crate::sum::{ROUNDING, add, greatest, named_sums};

/// What the error in time of a step is measured by, besides the displacement.
#[derive(Clone, Copy)]
pub(crate) struct ErrorMeasure<'a> {
    /// Rows of the fields, with the reductions over all ranks.
    pub(crate) rows: &'a Rows,
    /// Pressure at the end of the step tried, at its start, and at the start of the step before.
    pub(crate) pressure: [&'a [f64]; 3],
    /// v = K p at the end of the step tried.
    pub(crate) potential: &'a [f64],
    /// Weights of the errors of u and of v: 1 and 0 under a given force, 0 and 1 under a given motion, which leaves u
    /// in contact no error.
    pub(crate) matters: [f64; 2],
    /// The maximum means over the contact of displacement and v, and the least that errors are taken relative to.
    pub(crate) greatest: [f64; 2],
    pub(crate) least: [f64; 2],
    /// The gap of the undeformed bodies.
    pub(crate) gap: &'a [f64],
    /// Whether a free body was pressed by nothing before the step.
    pub(crate) from_rest: bool,
    /// By how much the rigid body above a cell advances in the step.
    pub(crate) advance: &'a (dyn Fn(usize) -> f64 + Sync),
    /// C(age)/C(Δ), by which an error in u grows in the end if the next steps err alike: a step responds to a defect
    /// of v with the compliance of a step, all steps together with the compliance of their age.
    pub(crate) amplification: f64,
    /// The error of v that a unit of this defect of v leaves where a given approach follows a given force: the error
    /// of u at that moment, to which bodies respond as glass. 0 where no such switch is to come.
    pub(crate) on_switch: f64,
    /// The compliance in series with the bodies as they meet again ([`Meeting::give`]), 0 where a motion is given.
    pub(crate) give: f64,
    /// The run that the step belongs to.
    pub(crate) context: &'a Outlook,
}

impl ErrorMeasure<'_> {
    /// An error of the surface counts by the force with which the bodies meet it again, and where a spring gives way by
    /// their approach.
    fn of_meeting(&self, rule: &ExponentialRule) -> [f64; 2] {
        let (Meeting { stiffness, .. }, give) = (self.context.meeting, self.give);
        if !give.is_finite() {
            return [self.on_switch / rule.compliance(), 0.0];
        }
        // without an elastic response the force is unbounded at short times
        let glassy = if rule.has_dashpot() { stiffness.min(1.0 / rule.compliance()) } else { stiffness };
        let series = glassy / (1.0 + give * glassy);
        [series, give * series]
    }
}

/// What is known of the error in time of a step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TimeError {
    /// Relative to displacement or force; 0 where nothing is known.
    pub(crate) relative: f64,
    /// Whether it comes of cells that joined.
    pub(crate) by_kinks: bool,
    /// Means over the contact of displacement and v, weighted by the pressure.
    pub(crate) sizes: [f64; 2],
    /// Mean defect of v, and mean of its absolute value.
    pub(crate) defect: [f64; 2],
    /// Mean defect of v of the surface that bodies may come back to.
    pub(crate) surface: f64,
    /// What earlier steps have left, relative as the error of this one.
    pub(crate) lasting: f64,
}

impl History {
    /// The estimated error of the step tried; 0 where too few steps before it are known.
    ///
    /// With d_k the last difference, of the first degree k that u lacks on the step, and Γ_k what it would weigh, the
    /// defect of v is
    ///
    /// λ Γ_k Σ p |d_k| / Σ p, where λ is the share that is left once the next step has put this one right,
    ///
    /// weighted by the pressure: the maximum error over all cells is the error of the kink of u at a moving edge,
    /// which carries no force. Cells that have just left, and have no weight, count by the largest of them. Those
    /// that joined in this step count with what v lacks by the kink of u when the body met them. Relative to v, this
    /// is the error of a force under given motion. Under a given force, the error of u is c times it, or more if the
    /// defects of many steps add up.
    pub(crate) fn time_error(&self, measure: ErrorMeasure<'_>) -> TimeError {
        let (rule, context) = (self.rule(), measure.context);
        let dt = rule.tried.dt;
        if !rule.has_memory() || rule.has_dashpot() && dt <= context.beginning {
            return TimeError::default();
        }
        let weight = Weight::new(measure.rows, measure.pressure, rule.has_dashpot());
        let pressed = weight.is_of_a_contact();
        // the contact opened in a step without an error estimate: shorten the step until the opening is resolved
        if weight == Weight::PressureBefore
            && rule.missing().is_none()
            && context.resolution > 0.0
            && dt > context.resolution
        {
            return TimeError { relative: f64::INFINITY, ..TimeError::default() };
        }
        let sums = self.sums(rule, &measure, weight);
        if sums.weight == 0.0 {
            return TimeError::default();
        }
        let sizes = [sums.of_u, sums.of_v].map(|size| size / sums.weight);
        let scales = [0, 1].map(|which| sizes[which].max(measure.least[which]));
        let Defect { signed, smooth, kinks, surface: [surface, of_surface] } =
            sums.defect(rule, context.resolution, context.is_last);
        let kinks = if measure.from_rest { ERROR_FACTORS.from_rest * kinks } else { kinks };
        let edge = if rule.has_dashpot() { ERROR_FACTORS.edge } else { 1.0 };
        // bodies apart have no force that could be wrong, but a surface
        let matters = if pressed { measure.matters } else { [1.0, 0.0] };
        let whole =
            [scales[0].max(measure.greatest[0]), scales[1].max(measure.greatest[1]).max(context.greatest_on_switch)];
        let [in_contact, outside] = context.lasting;
        let lasting = relative(if pressed { in_contact } else { outside }, whole[0]);
        let lasting = if measure.matters[0] > 0.0 { lasting } else { 0.0 };
        let growth = 1.0 + context.agreement * (measure.amplification - 1.0);
        let kinks_of_u = (edge * kinks).max(sums.of_leaving(rule));
        let of_u = rule.compliance() * kinks_of_u.max(growth * smooth);
        let of_v = (ERROR_FACTORS.edge * kinks).max(smooth);
        let error_of_u = if matters[0] > 0.0 { relative(of_u, scales[0]) } else { 0.0 };
        let error_of_v = if matters[1] > 0.0 { matters[1] * relative(of_v, scales[1]) } else { 0.0 };
        let [of_force, of_approach] = measure.of_meeting(rule);
        let on_meeting = |u: f64| relative(of_force * u, whole[1]).max(relative(of_approach * u, whole[0]));
        let on_return = on_meeting(outside);
        let error_on_return = on_meeting(rule.compliance() * of_surface);
        let error_on_switch = if matters[0] > 0.0 { relative(measure.on_switch * smooth, whole[1]) } else { 0.0 };
        let error = error_of_u.max(error_of_v).max(error_on_switch);
        TimeError {
            relative: error.max(error_on_return),
            by_kinks: error >= error_on_return
                && error > error_on_switch
                && if error_of_u > error_of_v {
                    kinks_of_u > growth * smooth
                } else {
                    ERROR_FACTORS.edge * kinks > smooth
                },
            sizes: if pressed { sizes } else { [0.0; 2] },
            defect: [signed, smooth],
            surface,
            lasting: lasting.max(on_return),
        }
    }

    /// Sums over the cells of the step tried.
    fn sums(&self, rule: &ExponentialRule, measure: &ErrorMeasure<'_>, weight: Weight) -> Sums {
        let lacking = rule.missing().map_or(0, |(degree, _)| degree);
        let [first, second] = self.displacement.differences();
        let [to_first, to_second] = rule.tried.ratios;
        let (new, old) = (&self.displacement.trial, &self.displacement.now);
        let [tried, now, before] = measure.pressure;
        let kinks = Kinks::of(rule);
        let part = |cells: Range<usize>| {
            let mut sums = Sums::NOTHING;
            for k in cells {
                let (u, u_before, v) = (new[k], old[k], measure.potential[k]);
                let pressure = [tried[k], now[k], before[k]];
                let (w, [touches, touched, had_touched]) = (weight.of(pressure), pressure.map(|p| p > 0.0));
                let leaves = !touches && (touched || had_touched);
                let depth = (measure.context.meeting.depth - measure.gap[k]).max(0.0);
                sums.depth += depth;
                if w == 0.0 && !touches && !leaves && depth == 0.0 {
                    continue;
                }
                sums.weight += w;
                (sums.of_u, sums.of_v) = (sums.of_u + w * u.abs(), sums.of_v + w * v.abs());
                sums.touching += f64::from(u8::from(touches));
                sums.touched += f64::from(u8::from(touched));
                let going_on = if lacking > 0 { to_first * first[k] } else { 0.0 };
                let bend = (u - u_before) - going_on;
                if touches && !touched {
                    // u extrapolated through its last nodes
                    let expected = if lacking < 3 { going_on } else { going_on + to_second * second[k] };
                    let (jump, bend) = ((measure.advance)(k) - expected, (u - u_before) - expected);
                    let [kink, with_correction] = kinks.at_end(jump, bend);
                    let widest = greatest(&kinks.at_end(jump, 0.5 * jump));
                    sums.kinks = add(sums.kinks, [kink, with_correction, 0.0]);
                    sums.kinks_within = add(sums.kinks_within, kinks.within(jump, bend));
                    sums.squares += widest * widest;
                    continue;
                }
                let last = if lacking < 3 { bend } else { bend - to_second * second[k] };
                // the rounding of u is no error in time
                let size = (last.abs() - ROUNDING * u.abs()).max(0.0);
                (sums.signed, sums.absolute) = (sums.signed + w * size.copysign(last), sums.absolute + w * size);
                if !touches {
                    let surface = depth * size;
                    sums.surface += surface.copysign(last);
                    sums.absolute_surface += surface;
                }
                if leaves {
                    (sums.released, sums.fallen) = (sums.released + now[k], sums.fallen + before[k] - now[k]);
                    sums.left = sums.left.max(size);
                }
            }
            sums.numbers()
        };
        Sums::of(measure.rows.merge(part, |a, b| Sums::of(a).joined(Sums::of(b)).numbers()))
    }
}

/// The part of a whole; 0 where there is no whole. Overflow must not pass for accuracy.
fn relative(part: f64, whole: f64) -> f64 {
    let ratio = if part == 0.0 || whole == 0.0 { 0.0 } else { part / whole };
    if ratio.is_nan() { f64::INFINITY } else { ratio }
}

named_sums! {
    /// Sums over the cells, with their weights w.
    Sums {
        weight: +,
        /// Σ w |u|.
        of_u: +,
        /// Σ w |v|.
        of_v: +,
        /// Σ w d, where d is the last difference; cells that join do not count.
        signed: +,
        /// Σ w |d|.
        absolute: +,
        /// The largest |d| of cells that left the contact.
        left: max,
        /// Pressure of the cells that leave in this step, at its start, and by how much it fell in the step before.
        released: +,
        fallen: +,
        /// Number of cells in contact.
        touching: +,
        /// Number of cells in contact before the step.
        touched: +,
        /// Sums of what v lacks by kinks at the end of the step, by its polynomial and with its correction of the
        /// step before.
        kinks: modes,
        /// The same at ¼, ½ and ¾ of the step.
        kinks_within: modes,
        /// Sum of the squares of the most that v can lack by each kink.
        squares: +,
        /// Sum of the depths to which bodies may come back.
        depth: +,
        /// Sum, over cells out of contact, of these depths times d.
        surface: +,
        /// Sum, over cells out of contact, of these depths times |d|.
        absolute_surface: +,
    }
}

/// Mean defects of v.
struct Defect {
    signed: f64,
    /// In absolute value, of cells that are in contact or leave it.
    smooth: f64,
    /// By cells that joined.
    kinks: f64,
    /// Of a surface that bodies may come back to, and of its absolute value.
    surface: [f64; 2],
}

impl Sums {
    /// The error of v by the kink that u has where cells leave: cells that stay answer a force with a greater
    /// compliance, cells that leave follow the body no longer. The pressure of the cells that leave falls as in the
    /// step before, which tells when they do. A dashpot has no kink in u as long as v has no jump.
    fn of_leaving(&self, rule: &ExponentialRule) -> f64 {
        if self.released == 0.0 || rule.has_dashpot() || rule.missing().is_none() {
            return 0.0;
        }
        let fallen = rule.tried.ratios[0] * self.fallen;
        let since = if fallen > 0.0 { 1.0 - self.released / fallen } else { 0.0 };
        let bend = self.signed / self.weight;
        greatest(&Kinks::of(rule).at_end(bend / since.max(f64::EPSILON), bend))
    }

    fn defect(&self, rule: &ExponentialRule, resolution: f64, is_last: bool) -> Defect {
        let scale = match rule.missing() {
            Some((_, missing)) if rule.corrects() && rule.has_dashpot() => ERROR_FACTORS.corrected_of_dashpot * missing,
            Some((_, missing)) if rule.corrects() && !is_last => ERROR_FACTORS.corrected * missing,
            Some((_, missing)) if rule.corrects() => missing,
            // the greatest of |s (s − Δ)| is Δ²/4, as in the error of u
            Some(_) => ERROR_FACTORS.not_corrected * 0.25 / rule.tried.span / rule.compliance(),
            None => 0.0,
        };
        let counts = !rule.has_dashpot() || rule.tried.dt > resolution;
        // the remaining cells take the load of cells that leave
        let shed = if self.touching > 0.0 { (self.touched / self.touching).max(1.0) } else { 1.0 };
        let left = if counts { shed * self.left } else { 0.0 };
        let kinks = greatest(&self.kinks).max(greatest(&self.kinks_within)).max(self.squares.sqrt());
        let kinks = if counts { kinks } else { 0.0 };
        Defect {
            signed: scale * self.signed / self.weight,
            smooth: scale * (self.absolute / self.weight).max(left),
            kinks: kinks / self.touching.max(1.0),
            surface: [self.surface, self.absolute_surface]
                .map(|sum| if sum == 0.0 { 0.0 } else { scale * sum / self.depth }),
        }
    }
}
