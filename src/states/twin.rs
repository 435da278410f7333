//! How few levels give a pressure to an accuracy.
//!
//! A pressure is ∫ w dp_e over the levels that are held. One mean w between two cuts errs by ∫ (w − w̄) dp_e, which
//! depends on the shape only weakly: in L1 over the force it is k Δw Δl √(Δl/l)/F, k = 0.05 to 0.15. So the same cuts
//! of the same w on a Hertz ball and on a cone, whose elastic pressures are known, tell the error before an elastic
//! contact is solved. Cuts are dense as (|dw/dl|/√l)^(2/5), which makes the errors between them equal.

use std::f64::consts::PI;

/// k of the first attempt, and growth of the number of cuts until the twins agree.
const FIRST_SHARE: f64 = 0.02;
const GROWTH: f64 = 1.15;
/// Number of radii at which the pressures of twins are compared, dense at the rim.
const RADII: usize = 256;
/// Groups whose tractions differ by less, over the mean traction, are one in the pressure of a twin.
const SAME: f64 = 1e-9;

/// The elastic pressures of a body at a level, by the squared radius.
type Twin = fn(f64, f64) -> f64;

/// Hertz ball with l = a³, and cone with l = a².
const TWINS: [Twin; 2] = [
    |level, square| 1.5 / PI * (level.powf(2.0 / 3.0) - square).max(0.0).sqrt(),
    |level, square| (level / square).max(1.0).sqrt().acosh() / PI,
];

/// A density over the levels: w of the pressure, or W of the displacement, constant in each group.
#[derive(Debug, Clone, Default)]
pub(crate) struct Profile {
    /// Top of each group, and the integral of the density up to there.
    tops: Vec<(f64, f64)>,
}

impl Profile {
    /// From the top and the density of each group, by ascending levels.
    pub(crate) fn new(groups: impl IntoIterator<Item = (f64, f64)>) -> Profile {
        let (mut bottom, mut sum) = (0.0, 0.0);
        let tops = groups.into_iter().filter_map(|(top, density)| {
            sum += density * (top - bottom);
            (top > bottom).then(|| {
                bottom = top;
                (top, sum)
            })
        });
        Profile { tops: tops.collect() }
    }

    /// The integral over all levels.
    pub(crate) fn total(&self) -> f64 {
        self.tops.last().map_or(0.0, |last| last.1)
    }

    /// The greatest level.
    pub(crate) fn top(&self) -> f64 {
        self.tops.last().map_or(0.0, |last| last.0)
    }

    /// The mean density above a level, and at least in the last group, times the greatest level, over the total: by
    /// how many times errors of the greatest levels count.
    pub(crate) fn amplification(&self, level: f64) -> f64 {
        let [.., (last, _), (top, total)] = self.tops[..] else { return 1.0 };
        let below = last.min(level);
        top * (total - self.integral(below)) / (total * (top - below))
    }

    /// The density in the last group; 0 where there is none.
    pub(crate) fn density(&self) -> f64 {
        let top = self.top();
        if top > 0.0 { self.amplification(top) * self.total() / top } else { 0.0 }
    }

    /// The integral up to a level.
    fn integral(&self, level: f64) -> f64 {
        let k = self.tops.partition_point(|top| top.0 < level);
        let (bottom, below) = k.checked_sub(1).map_or((0.0, 0.0), |k| self.tops[k]);
        self.tops.get(k).map_or(below, |(top, sum)| below + (sum - below) * (level - bottom) / (top - bottom))
    }

    /// The mean density below each of these levels and above the one before.
    pub(crate) fn means(&self, levels: &[f64]) -> impl Iterator<Item = (f64, f64)> {
        let (mut bottom, mut sum) = (0.0, 0.0);
        levels.iter().map(move |&level| {
            let (width, before) = (level - bottom, std::mem::replace(&mut sum, self.integral(level)));
            bottom = level;
            (level, (sum - before) / width)
        })
    }

    /// Levels at which a cut leaves an error of at most `accuracy`, in L1 over `size`, on both twins; and this error.
    /// All groups for an accuracy of 0.
    pub(crate) fn cuts(&self, size: f64, accuracy: f64) -> (Vec<f64>, f64) {
        let all = || self.tops.iter().map(|top| top.0);
        let (size, count) = (size.max(self.total()), self.tops.len());
        if count < 3 || accuracy == 0.0 || size == 0.0 {
            return (all().collect(), 0.0);
        }
        let density = |k: usize| {
            let [before, (bottom, below), (top, sum)] =
                [k.checked_sub(2).map_or((0.0, 0.0), |k| self.tops[k]), self.tops[k - 1], self.tops[k]];
            let jump = (sum - below) / (top - bottom) - (below - before.1) / (bottom - before.0);
            let slope = jump.abs() / (0.5 * (top - before.0));
            (top - bottom) * (slope / (size * top.sqrt())).powf(0.4)
        };
        let shares: Vec<f64> = (1..count).map(density).collect();
        let whole: f64 = shares.iter().sum();
        let comparison = Comparison::new(self, size);
        let mut parts = (FIRST_SHARE * whole.powf(2.5) / accuracy).powf(2.0 / 3.0).max(1.0).ceil();
        while parts < count as f64 {
            let (mut sum, mut next) = (0.0, 1.0);
            let is_cut = |k: usize| {
                sum += k.checked_sub(1).map_or(0.0, |k| shares[k]) * parts / whole;
                let passed = sum >= next * (1.0 - SAME);
                next = if passed { sum.floor() + 1.0 } else { next };
                passed || k == 0 || k + 1 == count
            };
            let picked: Vec<bool> = (0..count).map(is_cut).collect();
            let levels: Vec<f64> = all().zip(picked).filter(|(_, is_cut)| *is_cut).map(|(level, _)| level).collect();
            let error = comparison.distance(&Profile::new(self.means(&levels)));
            if error <= accuracy {
                return (levels, error);
            }
            parts = (GROWTH * parts).ceil();
        }
        (all().collect(), 0.0)
    }

    /// How far another density is from this, in L1 over `size`: the greater distance of the pressures of the twins.
    pub(crate) fn distance(&self, other: &Profile, size: f64) -> f64 {
        let top = self.top().max(other.top());
        if top > 0.0 && size > 0.0 { Comparison::up_to(self, top, size).distance(other) } else { 0.0 }
    }
}

/// The pressures of both twins.
struct Comparison {
    top: f64,
    size: f64,
    pressures: [Vec<f64>; 2],
}

impl Comparison {
    fn new(of: &Profile, size: f64) -> Comparison {
        Comparison::up_to(of, of.top(), size)
    }

    fn up_to(of: &Profile, top: f64, size: f64) -> Comparison {
        Comparison { top, size, pressures: [0, 1].map(|k| pressure(of, k, top)) }
    }

    fn distance(&self, other: &Profile) -> f64 {
        let of = |k: usize| {
            let other = pressure(other, k, self.top);
            // 2π r dr = 2π a² s ds for r² = a² (1 − s²)
            let pairs = self.pressures[k].iter().zip(&other).enumerate();
            let sum: f64 = pairs.map(|(k, (own, other))| place(k) * (own - other).abs()).sum();
            2.0 * PI * greatest_square(k, self.top) * sum / (RADII as f64 * self.size)
        };
        of(0).max(of(1))
    }
}

/// s of a radius: r² = a² (1 − s²).
fn place(k: usize) -> f64 {
    (k as f64 + 0.5) / RADII as f64
}

/// a² of a twin at a level.
fn greatest_square(twin: usize, level: f64) -> f64 {
    if twin == 0 { level.powf(2.0 / 3.0) } else { level }
}

/// Σ w Δp = Σ (w_i − w_i+1) p_e(l_i) of a twin at its radii.
fn pressure(of: &Profile, twin: usize, top: f64) -> Vec<f64> {
    let (square, mean) = (greatest_square(twin, top), of.total() / of.top().max(f64::MIN_POSITIVE));
    let mut field = vec![0.0; RADII];
    let (mut above, mut index) = (0.0, of.tops.len());
    while index > 0 {
        index -= 1;
        let (level, sum) = of.tops[index];
        let (bottom, below) = index.checked_sub(1).map_or((0.0, 0.0), |k| of.tops[k]);
        let density = (sum - below) / (level - bottom);
        if (density - above).abs() > SAME * mean {
            let weight = density - above;
            for (k, pressure) in field.iter_mut().enumerate() {
                *pressure += weight * TWINS[twin](level, square * (1.0 - place(k).powi(2)));
            }
            above = density;
        }
    }
    field
}
