//! The error in time of a step, from what its polynomial lacks.

use crate::hereditary::exponential_rule::ExponentialRule;
use crate::hereditary::history::History;

/// What the error in time of a step is measured by, besides the displacement.
#[derive(Clone, Copy)]
pub(crate) struct ErrorMeasure<'a> {
    /// Pressure at the end of the step tried, at its start, and at the start of the step before.
    pub(crate) pressure: [&'a [f64]; 3],
    /// v = K p at the end of the step tried.
    pub(crate) potential: &'a [f64],
    /// Which errors matter: that of the displacement where a force is given, and that of v where a motion is, which leaves the
    /// displacement in contact no error.
    pub(crate) matters: [bool; 2],
    /// The least means over the contact of displacement and v that errors are taken relative to.
    pub(crate) least: [f64; 2],
    /// By how much the rigid body above a cell advances in the step.
    pub(crate) advance: &'a dyn Fn(usize) -> f64,
    /// C(age)/C(Δ), by which an error in u grows in the end if those of the next steps are like it: a step answers a defect of v
    /// with the compliance of a step, all steps together with that of their age.
    pub(crate) amplification: f64,
    /// How far the defects so far agree in sign, 0 … 1.
    pub(crate) agreement: f64,
    /// An immediate dashpot answers a body that meets a cell with a finite pressure at once, however short the step: that counts
    /// in steps longer than this.
    pub(crate) resolution: f64,
}

/// What is known of the error in time of a step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TimeError {
    /// Relative to displacement or force; 0 where nothing is known.
    pub(crate) relative: f64,
    /// The greatest defect of v in a cell in contact, relative to the mean of v.
    pub(crate) greatest: f64,
    /// Means over the contact of displacement and v, weighted by the pressure.
    pub(crate) sizes: [f64; 2],
    /// Mean defect of v, and mean of its absolute value.
    pub(crate) defect: [f64; 2],
}

/// Share of the defect of a step that is left once the next has put it right, and of one that is not put right.
const CORRECTED: f64 = 0.4;
const CORRECTED_OF_DASHPOT: f64 = 1.2;
const NOT_CORRECTED: f64 = 0.25;
/// Rounding of a difference of displacements, relative to these.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Defects of cells that leave the contact count twice.
const LEFT: f64 = 2.0;
/// A force, and an immediate dashpot, answer a cell at the edge of the contact more than others: a rigid body presses hardest
/// there.
const EDGE: f64 = 3.0;
/// The kinks of cells that joined stay in the past, and those of one step and the next do not cancel.
const LASTING: f64 = 1.3;

impl History {
    /// The estimated error of the step tried; 0 where too few steps before it are known.
    ///
    /// With d_k the last difference, of the first degree k that u lacks on the step, and Γ_k what it would weigh, the defect of v
    /// is
    ///
    /// ½ Γ_k Σ p |d_k| / Σ p,
    ///
    /// weighted by the pressure: the greatest error over all cells is that of the kink of u at a moving edge, which carries no
    /// force. Cells that have just left, and have no weight, count by the greatest of them. Those that joined in this step count
    /// with what v lacks by the kink of u when the body met them. Relative to v, this is the error of a force under given motion.
    /// Under a given force, the error of u is c times it, or more if the defects of many steps add up.
    pub(crate) fn time_error(&self, measure: ErrorMeasure<'_>) -> TimeError {
        let Some(rule) = self.exponential_rule().filter(|rule| rule.remembers()) else { return TimeError::default() };
        let ErrorMeasure { potential, matters, least, .. } = measure;
        let weights = Weighting::new(measure.pressure, rule.has_dashpot());
        let (mut weight, mut sizes) = (0.0, [0.0; 2]);
        for (k, (&u, &v)) in self.displacement.trial.iter().zip(potential).enumerate() {
            let w = if weights.plain { weights.pressure[0][k] } else { weights.of(k) };
            weight += w;
            sizes = [sizes[0] + w * u.abs(), sizes[1] + w * v.abs()];
        }
        let means = sizes.map(|size| if weight > 0.0 { size / weight } else { 0.0 });
        let Defect { signed, smooth, kinks, greatest } = self.defect(rule, measure, &weights, weight);
        let edge = if rule.has_dashpot() { EDGE } else { 1.0 };
        let growth = 1.0 + measure.agreement * (measure.amplification - 1.0);
        let relative = [0, 1].map(|which| {
            let size = means[which].max(least[which]);
            // bodies apart have no force that could be wrong, but a surface
            let matters = if weights.pressed { matters[which] } else { which == 0 };
            let defect = if which == 0 {
                rule.compliance() * (edge * kinks).max(growth * smooth)
            } else {
                (EDGE * kinks).max(smooth)
            };
            // nothing over nothing is nothing, but overflow must not pass for accuracy
            if !matters || defect == 0.0 || size == 0.0 { 0.0 } else { defect / size }
        });
        let worst =
            if relative.iter().any(|error| error.is_nan()) { f64::INFINITY } else { relative[0].max(relative[1]) };
        let greatest = if greatest > 0.0 { greatest / means[1].max(least[1]) } else { 0.0 };
        TimeError {
            relative: worst,
            greatest,
            sizes: if weights.pressed { means } else { [0.0; 2] },
            defect: [signed, smooth],
        }
    }

    fn defect(
        &self,
        rule: &ExponentialRule,
        measure: ErrorMeasure<'_>,
        weights: &Weighting<'_>,
        weight: f64,
    ) -> Defect {
        if weight == 0.0 {
            return Defect::default();
        }
        let (lacking, missing) = rule.missing().unwrap_or((0, 0.0));
        let ErrorMeasure { pressure: [tried, now, before], advance, .. } = measure;
        let [first, second] = self.displacement.past.differences();
        let [to_first, to_second] = rule.tried.ratios;
        let (new, old) = (&self.displacement.trial, &self.displacement.now);
        let (mut signed, mut absolute, mut left, mut touching) = (0.0, 0.0, 0.0_f64, 0_usize);
        let (mut kinks, mut squares, mut sharpest, mut steepest) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        for k in 0..new.len() {
            let going_on = if lacking > 0 { to_first * first[k] } else { 0.0 };
            let bend = (new[k] - old[k]) - going_on;
            let last = if lacking < 3 { bend } else { bend - to_second * second[k] };
            // the rounding of u is no error in time
            let last = last.signum() * (last.abs() - ROUNDING * new[k].abs()).max(0.0);
            let touches = tried[k] > 0.0;
            touching += usize::from(touches);
            if touches && now[k] <= 0.0 {
                let jump = advance(k) - going_on;
                let (kink, widest) = (rule.kink(jump, bend), rule.kink(jump, 0.5 * jump));
                (kinks, squares) = (kinks + kink, squares + widest * widest);
                sharpest = sharpest.max(kink.abs()).max(widest.abs());
            } else {
                let w = if weights.plain { tried[k] } else { weights.of(k) };
                (signed, absolute) = (signed + w * last, absolute + w * last.abs());
                if touches {
                    steepest = steepest.max(last.abs());
                }
            }
            if !touches && (now[k] > 0.0 || before[k] > 0.0) {
                left = left.max(last.abs());
            }
        }
        let scale = if rule.corrects() {
            missing * if rule.has_dashpot() { CORRECTED_OF_DASHPOT } else { CORRECTED }
        } else if lacking == 0 {
            0.0
        } else {
            // the greatest of |s (s − Δ)| is Δ²/4, that of the error of u
            NOT_CORRECTED * 0.25 / rule.tried.span / rule.compliance()
        };
        let counts = !rule.has_dashpot() || rule.tried.dt > measure.resolution;
        let smooth = scale * (absolute / weight).max(if counts { LEFT * left } else { 0.0 });
        let kinks = if counts { kinks.abs().max(LASTING * squares.sqrt()) / touching.max(1) as f64 } else { 0.0 };
        Defect { signed: scale * signed / weight, smooth, kinks, greatest: sharpest.max(scale * steepest) }
    }
}

/// Mean defects of v.
#[derive(Default)]
struct Defect {
    signed: f64,
    /// In absolute value, of cells that are in contact or leave it.
    smooth: f64,
    /// By cells that joined.
    kinks: f64,
    /// The greatest of a cell.
    greatest: f64,
}

/// The weight of each cell in a mean over the contact.
struct Weighting<'a> {
    pressure: [&'a [f64]; 3],
    pressed: bool,
    was_pressed: bool,
    inside: bool,
    /// Whether the weight is the pressure.
    plain: bool,
}

impl<'a> Weighting<'a> {
    fn new(pressure: [&'a [f64]; 3], dashpot: bool) -> Weighting<'a> {
        let [tried, now, before] = pressure;
        let any = |pressure: &[f64]| pressure.iter().any(|&p| p > 0.0);
        // cells that join a dashpot have a finite pressure at once, and a kink
        let inside = dashpot && (0..tried.len()).any(|k| tried[k].min(now[k]).min(before[k]) > 0.0);
        let pressed = any(tried);
        Weighting { pressure, pressed, was_pressed: any(now), inside, plain: pressed && !inside }
    }

    fn of(&self, k: usize) -> f64 {
        let [tried, now, before] = self.pressure;
        match (self.pressed, self.was_pressed) {
            (true, _) if self.inside => tried[k].min(now[k]).min(before[k]),
            (true, _) => tried[k],
            (false, true) => now[k],
            // bodies apart: the surface recovers everywhere alike
            _ => 1.0,
        }
    }
}
