//! The density of a pressure over the levels of its elastic contacts.

/// Groups whose share of all cuts is at least this less than a whole one end a part.
const SAME: f64 = 1e-9;

/// A density over the levels: w of the pressure, or W of the displacement, constant in each group.
#[derive(Debug, Clone, Default)]
pub(super) struct Profile {
    /// Top of each group, and the integral of the density up to there.
    tops: Vec<(f64, f64)>,
}

impl Profile {
    /// From the top and the density of each group, by ascending levels.
    pub(super) fn new(groups: impl IntoIterator<Item = (f64, f64)>) -> Profile {
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
    pub(super) fn total(&self) -> f64 {
        self.tops.last().map_or(0.0, |last| last.1)
    }

    /// The greatest level.
    pub(super) fn top(&self) -> f64 {
        self.tops.last().map_or(0.0, |last| last.0)
    }

    /// Number of groups.
    pub(super) fn len(&self) -> usize {
        self.tops.len()
    }

    /// The integral up to a level.
    fn integral(&self, level: f64) -> f64 {
        let k = self.tops.partition_point(|top| top.0 < level);
        let (bottom, below) = k.checked_sub(1).map_or((0.0, 0.0), |k| self.tops[k]);
        self.tops.get(k).map_or(below, |(top, sum)| below + (sum - below) * (level - bottom) / (top - bottom))
    }

    /// The mean density below each of these levels and above the one before.
    pub(super) fn means(&self, levels: &[f64]) -> Vec<f64> {
        let (mut bottom, mut sum) = (0.0, 0.0);
        let mean = |&level: &f64| {
            let (width, before) = (level - bottom, std::mem::replace(&mut sum, self.integral(level)));
            bottom = level;
            (sum - before) / width
        };
        levels.iter().map(mean).collect()
    }

    /// A bound of the difference, in L1, of two pressures by the means between these levels: ∫ |δw| dl, as the
    /// pressure of an elastic contact grows by dl in L1.
    pub(super) fn distance(&self, other: &Profile, levels: &[f64]) -> f64 {
        let (mut below, mut sum) = (0.0, 0.0);
        let top = self.top().max(other.top());
        for level in levels.iter().copied().filter(|level| *level < top).chain([top]) {
            let difference = self.integral(level) - other.integral(level);
            sum += f64::abs(difference - std::mem::replace(&mut below, difference));
        }
        sum
    }

    /// The tops of the first and the last group, and those of about so many parts between which a mean density errs
    /// alike: one mean between two levels errs by ∫ (w − w̄) dp_e, k Δw Δl √(Δl/l) in L1, where k depends on the shape
    /// but little.
    pub(super) fn cuts(&self, parts: usize) -> Vec<f64> {
        let count = self.tops.len();
        if count < 3 || parts >= count {
            return self.tops.iter().map(|top| top.0).collect();
        }
        let share = |k: usize| {
            let [before, (bottom, below), (top, sum)] =
                [k.checked_sub(2).map_or((0.0, 0.0), |k| self.tops[k]), self.tops[k - 1], self.tops[k]];
            let jump = (sum - below) / (top - bottom) - (below - before.1) / (bottom - before.0);
            let slope = jump.abs() / (0.5 * (top - before.0));
            (top - bottom) * (slope / top.sqrt()).powf(0.4)
        };
        let shares: Vec<f64> = std::iter::once(0.0).chain((1..count).map(share)).collect();
        let whole: f64 = shares.iter().sum();
        let (mut sum, mut next) = (0.0, 1.0);
        let mut is_cut = |k: usize| {
            sum += shares[k] * parts as f64 / whole;
            let passed = sum >= next * (1.0 - SAME);
            next = if passed { f64::floor(sum) + 1.0 } else { next };
            passed || k == 0 || k + 1 == count
        };
        (0..count).filter(|k| is_cut(*k)).map(|k| self.tops[k].0).collect()
    }
}
