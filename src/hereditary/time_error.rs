//! The error in time of a step, from what its polynomial lacks.

use std::ops::Range;

use crate::hereditary::exponential_rule::ExponentialRule;
use crate::hereditary::history::History;
use crate::ranks::Rows;

/// What the error in time of a step is measured by, besides the displacement.
#[derive(Clone, Copy)]
pub(crate) struct ErrorMeasure<'a> {
    /// What joins the rows of the fields with those of other ranks.
    pub(crate) rows: &'a Rows,
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
    pub(crate) advance: &'a (dyn Fn(usize) -> f64 + Sync),
    /// C(age)/C(Δ), by which an error in u grows in the end if those of the next steps are like it: a step answers a defect of v
    /// with the compliance of a step, all steps together with that of their age.
    pub(crate) amplification: f64,
    /// How far the defects so far agree in sign, 0 … 1.
    pub(crate) agreement: f64,
    /// An immediate dashpot answers a body that meets a cell with a finite pressure at once, however short the step: that counts
    /// in steps longer than this.
    pub(crate) resolution: f64,
    /// In steps shorter than this, a body with an immediate dashpot hardly moves.
    pub(crate) beginning: f64,
}

/// What is known of the error in time of a step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TimeError {
    /// Relative to displacement or force; 0 where nothing is known.
    pub(crate) relative: f64,
    /// Whether it comes of cells that joined.
    pub(crate) by_kinks: bool,
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
    /// λ Γ_k Σ p |d_k| / Σ p, where λ is the share that is left once the next step has put this one right,
    ///
    /// weighted by the pressure: the greatest error over all cells is that of the kink of u at a moving edge, which carries no
    /// force. Cells that have just left, and have no weight, count by the greatest of them. Those that joined in this step count
    /// with what v lacks by the kink of u when the body met them. Relative to v, this is the error of a force under given motion.
    /// Under a given force, the error of u is c times it, or more if the defects of many steps add up.
    pub(crate) fn time_error(&self, measure: ErrorMeasure<'_>) -> TimeError {
        let Some(rule) = self.exponential_rule().filter(|rule| rule.remembers()) else { return TimeError::default() };
        let dt = rule.tried.dt;
        if rule.has_dashpot() && dt <= measure.beginning {
            return TimeError::default();
        }
        let weight = Weight::new(measure.rows, measure.pressure, rule.has_dashpot());
        let pressed = weight.is_of_a_contact();
        // a contact that opened in a step of which nothing can be told: it has to be seen to open
        if weight == Weight::PressureBefore
            && rule.missing().is_none()
            && measure.resolution > 0.0
            && dt > measure.resolution
        {
            return TimeError { relative: f64::INFINITY, ..TimeError::default() };
        }
        let sums = self.sums(rule, &measure, weight);
        if sums.weight == 0.0 {
            return TimeError::default();
        }
        let sizes = sums.sizes.map(|size| size / sums.weight);
        let scales = [0, 1].map(|which| sizes[which].max(measure.least[which]));
        let Defect { signed, smooth, kinks, greatest } = sums.defect(rule, measure.resolution);
        let edge = if rule.has_dashpot() { EDGE } else { 1.0 };
        let growth = 1.0 + measure.agreement * (measure.amplification - 1.0);
        let of_u = rule.compliance() * (edge * kinks).max(growth * smooth);
        let of_v = (EDGE * kinks).max(smooth);
        // bodies apart have no force that could be wrong, but a surface
        let [u_matters, v_matters] = if pressed { measure.matters } else { [true, false] };
        let error_of_u = if u_matters { relative(of_u, scales[0]) } else { 0.0 };
        let error_of_v = if v_matters { relative(of_v, scales[1]) } else { 0.0 };
        TimeError {
            relative: error_of_u.max(error_of_v),
            by_kinks: if error_of_u > error_of_v { edge * kinks > growth * smooth } else { EDGE * kinks > smooth },
            greatest: relative(greatest, scales[1]),
            sizes: if pressed { sizes } else { [0.0; 2] },
            defect: [signed, smooth],
        }
    }

    /// Sums over the cells of the step tried.
    fn sums(&self, rule: &ExponentialRule, measure: &ErrorMeasure<'_>, weight: Weight) -> Sums {
        let lacking = rule.missing().map_or(0, |(degree, _)| degree);
        let [first, second] = self.displacement.past.differences();
        let [to_first, to_second] = rule.tried.ratios;
        let (new, old) = (&self.displacement.trial, &self.displacement.now);
        let [tried, now, before] = measure.pressure;
        let part = |cells: Range<usize>| {
            let mut sums = Sums::default();
            for k in cells {
                let (u, u_before, v) = (new[k], old[k], measure.potential[k]);
                let pressure = [tried[k], now[k], before[k]];
                let (w, [touches, touched, had_touched]) = (weight.of(pressure), pressure.map(|p| p > 0.0));
                let leaves = !touches && (touched || had_touched);
                if w == 0.0 && !touches && !leaves {
                    continue;
                }
                sums.weight += w;
                sums.sizes = [sums.sizes[0] + w * u.abs(), sums.sizes[1] + w * v.abs()];
                sums.touching += usize::from(touches);
                let going_on = if lacking > 0 { to_first * first[k] } else { 0.0 };
                let bend = (u - u_before) - going_on;
                if touches && !touched {
                    let jump = (measure.advance)(k) - going_on;
                    let (kink, widest) = (rule.kink(jump, bend), rule.kink(jump, 0.5 * jump));
                    (sums.kinks, sums.squares) = (sums.kinks + kink, sums.squares + widest * widest);
                    sums.sharpest = sums.sharpest.max(kink.abs()).max(widest.abs());
                    continue;
                }
                let last = if lacking < 3 { bend } else { bend - to_second * second[k] };
                // the rounding of u is no error in time
                let size = (last.abs() - ROUNDING * u.abs()).max(0.0);
                (sums.signed, sums.absolute) = (sums.signed + w * size.copysign(last), sums.absolute + w * size);
                if touches {
                    sums.steepest = sums.steepest.max(size);
                } else if leaves {
                    sums.left = sums.left.max(size);
                }
            }
            sums.numbers()
        };
        Sums::of(measure.rows.merge(part, |a, b| Sums::of(a).merge(Sums::of(b)).numbers()))
    }
}

/// The part of a whole; 0 where there is no whole. Overflow must not pass for accuracy.
fn relative(part: f64, whole: f64) -> f64 {
    let ratio = if part == 0.0 || whole == 0.0 { 0.0 } else { part / whole };
    if ratio.is_nan() { f64::INFINITY } else { ratio }
}

/// Sums over the cells, with their weights w.
#[derive(Default)]
struct Sums {
    weight: f64,
    /// Of w |u| and w |v|.
    sizes: [f64; 2],
    /// Of w d and w |d|, where d is the last difference; cells that join do not count.
    signed: f64,
    absolute: f64,
    /// The greatest |d| of cells in contact, and of those that left it.
    steepest: f64,
    left: f64,
    /// Cells in contact.
    touching: usize,
    /// Of what v lacks by kinks, of the squares of the most that it can lack, and the greatest of either.
    kinks: f64,
    squares: f64,
    sharpest: f64,
}

/// Mean defects of v.
struct Defect {
    signed: f64,
    /// In absolute value, of cells that are in contact or leave it.
    smooth: f64,
    /// By cells that joined.
    kinks: f64,
    /// The greatest of a cell.
    greatest: f64,
}

impl Sums {
    fn numbers(self) -> [f64; 11] {
        let Sums { weight, sizes, signed, absolute, steepest, left, touching, kinks, squares, sharpest } = self;
        let [size, other] = sizes;
        [weight, size, other, signed, absolute, steepest, left, touching as f64, kinks, squares, sharpest]
    }

    fn of(numbers: [f64; 11]) -> Sums {
        let [weight, size, other, signed, absolute, steepest, left, touching, kinks, squares, sharpest] = numbers;
        let (sizes, touching) = ([size, other], touching as usize);
        Sums { weight, sizes, signed, absolute, steepest, left, touching, kinks, squares, sharpest }
    }

    fn merge(self, other: Sums) -> Sums {
        Sums {
            weight: self.weight + other.weight,
            sizes: [0, 1].map(|which| self.sizes[which] + other.sizes[which]),
            signed: self.signed + other.signed,
            absolute: self.absolute + other.absolute,
            steepest: self.steepest.max(other.steepest),
            left: self.left.max(other.left),
            touching: self.touching + other.touching,
            kinks: self.kinks + other.kinks,
            squares: self.squares + other.squares,
            sharpest: self.sharpest.max(other.sharpest),
        }
    }

    fn defect(&self, rule: &ExponentialRule, resolution: f64) -> Defect {
        let scale = match rule.missing() {
            Some((_, missing)) if rule.corrects() && rule.has_dashpot() => CORRECTED_OF_DASHPOT * missing,
            Some((_, missing)) if rule.corrects() => CORRECTED * missing,
            // the greatest of |s (s − Δ)| is Δ²/4, that of the error of u
            Some(_) => NOT_CORRECTED * 0.25 / rule.tried.span / rule.compliance(),
            None => 0.0,
        };
        let counts = !rule.has_dashpot() || rule.tried.dt > resolution;
        let left = if counts { LEFT * self.left } else { 0.0 };
        let kinks = if counts { self.kinks.abs().max(LASTING * self.squares.sqrt()) } else { 0.0 };
        Defect {
            signed: scale * self.signed / self.weight,
            smooth: scale * (self.absolute / self.weight).max(left),
            kinks: kinks / self.touching.max(1) as f64,
            greatest: self.sharpest.max(scale * self.steepest),
        }
    }
}

/// The weight of a cell in a mean.
#[derive(Clone, Copy, PartialEq)]
enum Weight {
    Pressure,
    /// The least pressure of the last steps: cells that join a dashpot have a finite pressure at once, and a kink.
    LeastPressure,
    /// Of bodies that parted in this step.
    PressureBefore,
    /// Of bodies apart: the surface recovers everywhere alike.
    Even,
}

impl Weight {
    fn new(rows: &Rows, pressure: [&[f64]; 3], dashpot: bool) -> Weight {
        let [tried, now, _] = pressure;
        let [pressed, was_pressed] = [tried, now].map(|pressure| rows.any(pressure.iter().any(|&p| p > 0.0)));
        let inside = || rows.any((0..tried.len()).any(|k| least(pressure.map(|p| p[k])) > 0.0));
        match (pressed, was_pressed) {
            (true, true) if dashpot && inside() => Weight::LeastPressure,
            (true, _) => Weight::Pressure,
            (false, true) => Weight::PressureBefore,
            (false, false) => Weight::Even,
        }
    }

    fn of(self, pressure: [f64; 3]) -> f64 {
        match self {
            Weight::Pressure => pressure[0],
            Weight::LeastPressure => least(pressure),
            Weight::PressureBefore => pressure[1],
            Weight::Even => 1.0,
        }
    }

    fn is_of_a_contact(self) -> bool {
        matches!(self, Weight::Pressure | Weight::LeastPressure)
    }
}

fn least([tried, now, before]: [f64; 3]) -> f64 {
    tried.min(now).min(before)
}
