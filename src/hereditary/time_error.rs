//! The error in time of a step, from what its polynomial lacks.

use crate::hereditary::exponential_rule::ExponentialRule;
use crate::hereditary::history::History;

/// What the error in time of a step is measured by, besides the displacement.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ErrorMeasure<'a> {
    /// Pressure at the end of the step tried, at its start, and at the start of the step before.
    pub(crate) pressure: [&'a [f64]; 3],
    /// The least mean displacement in contact \[m\] that an error is taken relative to.
    pub(crate) least: f64,
    /// C(age)/C(Δ), by which an error in u grows in the end if no later step puts it right: the next steps answer it with the
    /// compliance of a step, the surface with that of its age.
    pub(crate) amplification: f64,
}

/// What is known of the error in time of a step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TimeError {
    /// Relative to the displacement; 0 where nothing is known.
    pub(crate) relative: f64,
    /// Mean displacement in contact, weighted by the pressure \[m\].
    pub(crate) displacement: f64,
}

/// Share of the defect of a step that is left once the next has put it right, and of one that is not put right.
const CORRECTED: f64 = 0.5;
const NOT_CORRECTED: f64 = 0.25;
/// Cells that leave or join the contact kink: their defects count twice.
const KINK: f64 = 2.0;
/// An immediate dashpot answers an error of the slope, which no later step undoes at once: it counts with the amplification,
/// up to this.
const MAX_AMPLIFICATION: f64 = 5.0;

impl History {
    /// The estimated error of the step tried; 0 where too few steps before it are known.
    ///
    /// With d_k the last difference, of the first degree k that u lacks on the step, Γ_k what it would weigh,
    ///
    /// e = ½ c Γ_k Σ p |d_k| / Σ p |u|,
    ///
    /// weighted by the pressure: the greatest error over all cells is that of the kink of u at a moving edge, which carries no
    /// force. Cells that have just left, and have no weight, count by the greatest of them, and cells that joined or left in
    /// this step, where u has a kink, by their second difference.
    pub(crate) fn time_error(&self, measure: ErrorMeasure<'_>) -> TimeError {
        let Some(rule) = self.exponential_rule().filter(|rule| rule.remembers()) else { return TimeError::default() };
        let (relative, displacement) = self.defect(rule, measure);
        // overflow must not pass for accuracy
        TimeError { relative: if relative.is_nan() { f64::INFINITY } else { relative }, displacement }
    }

    fn defect(&self, rule: &ExponentialRule, measure: ErrorMeasure<'_>) -> (f64, f64) {
        let missing = rule.missing();
        let ErrorMeasure { pressure: [tried, now, before], least, amplification } = measure;
        let any = |pressure: &[f64]| pressure.iter().any(|&p| p > 0.0);
        let pressed = [any(tried), any(now)];
        let dashpot = rule.has_dashpot();
        // cells that join a dashpot have a finite pressure at once, and a kink
        let inside = dashpot && (0..tried.len()).any(|k| tried[k].min(now[k]).min(before[k]) > 0.0);
        let weight = |k: usize| match pressed {
            [true, _] if inside => tried[k].min(now[k]).min(before[k]),
            [true, _] => tried[k],
            [false, true] => now[k],
            // bodies apart: the surface recovers everywhere alike
            _ => 1.0,
        };
        let [first, second] = self.displacement.past.differences();
        let [to_first, to_second] = rule.tried.ratios;
        let (new, old) = (&self.displacement.trial, &self.displacement.now);
        let mut sums = Sums::default();
        for k in 0..new.len() {
            let w = weight(k);
            sums.weight += w;
            sums.size += w * new[k].abs();
            let Some((lacking, _)) = missing else { continue };
            let bend = (new[k] - old[k]) - to_first * first[k];
            let last = if lacking == 2 { bend } else { bend - to_second * second[k] };
            sums.last += w * last.abs();
            let touches = tried[k] > 0.0;
            if touches != (now[k] > 0.0) {
                sums.kinks += tried[k].max(now[k]) * bend.abs();
            }
            if !touches && (now[k] > 0.0 || before[k] > 0.0) {
                sums.left = sums.left.max(last.abs());
            }
        }
        let mean = if sums.weight > 0.0 && pressed[0] { sums.size / sums.weight } else { 0.0 };
        let size = sums.size.max(least * sums.weight);
        let Some((_, defect)) = missing.filter(|_| size > 0.0) else { return (0.0, mean) };
        if !rule.corrects() {
            // the greatest of |s (s − Δ)| is Δ²/4
            return (NOT_CORRECTED * amplification * 0.25 * sums.last / rule.tried.span / size, mean);
        }
        let smooth = CORRECTED * defect * sums.last.max(KINK * sums.left * sums.weight) / size;
        if dashpot {
            return (smooth * amplification.clamp(1.0, MAX_AMPLIFICATION), mean);
        }
        (smooth.max(KINK * rule.kinked() * sums.kinks / size), mean)
    }
}

#[derive(Default)]
struct Sums {
    weight: f64,
    /// Σ w |u|.
    size: f64,
    /// Σ w |d_k|.
    last: f64,
    /// The same of the second differences of cells that joined or left.
    kinks: f64,
    /// The greatest |d_k| of cells that left.
    left: f64,
}
