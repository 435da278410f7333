//! Times in ascending order, and values at them.

use crate::error::{Result, count_within, finite, in_order, least_length, positive};

/// Finite times \[s\], ascending: breakpoints, corners, times to stop at.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ascending(Vec<f64>);

impl Ascending {
    /// Adds `times` in any order; `field` names them in the error of one that is not finite.
    pub(crate) fn add(&mut self, field: &'static str, times: &[f64]) -> Result<()> {
        for &time in times {
            self.0.push(finite(field, time)?);
        }
        self.0.sort_by(f64::total_cmp);
        self.0.dedup();
        Ok(())
    }

    /// The first of the times after `time`.
    pub(crate) fn after(&self, time: f64) -> Option<f64> {
        self.0.get(self.0.partition_point(|&own| own <= time)).copied()
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.0
    }
}

/// Times at which the steps of a run end ([`Run::stop_at`](crate::run::Run::stop_at)) or its states are sampled
/// ([`Run::sample_at`](crate::run::Run::sample_at)): given ones, evenly spaced ones, or so many in each decade.
/// Arrays, vectors and slices of times \[s\] are times, too.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))?;
/// let load = StepLoad::new(Load::force(0.5))?;
/// let run = contact.follow(&load, Stepping::adaptive(1.0e-3), 10.0);
/// let mut run = run.stop_at([1.0, 5.0])?.sample_at(Times::decades(1.0e-2, 10).and(Times::every(0.5)))?;
/// while run.next_step()?.is_some() {}
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Times {
    given: Vec<f64>,
    rules: Vec<Rule>,
}

impl Times {
    /// The multiples of an `interval` \[s\] from the start of the run.
    pub fn every(interval: f64) -> Times {
        Times { rules: vec![Rule::Every(interval)], ..Times::default() }
    }

    /// The time `first` \[s\] after the start of the run, and `per_decade` times, 1 to 1000, in each decade beyond.
    pub fn decades(first: f64, per_decade: usize) -> Times {
        Times { rules: vec![Rule::Decades(first, per_decade)], ..Times::default() }
    }

    /// The same with the given ones among them as `map` has them.
    pub(crate) fn map_given(mut self, map: impl Fn(f64) -> Result<f64>) -> Result<Times> {
        self.given.iter_mut().try_for_each(|time| map(*time).map(|mapped| *time = mapped))?;
        Ok(self)
    }

    /// Both.
    #[must_use]
    pub fn and(mut self, other: impl Into<Times>) -> Times {
        let Times { given, rules } = other.into();
        self.given.extend(given);
        self.rules.extend(rules);
        self
    }
}

/// In any order.
impl<T: AsRef<[f64]> + ?Sized> From<&T> for Times {
    fn from(times: &T) -> Times {
        Times { given: times.as_ref().to_vec(), rules: Vec::new() }
    }
}

impl<const N: usize> From<[f64; N]> for Times {
    fn from(times: [f64; N]) -> Times {
        Times::from(&times)
    }
}

impl From<Vec<f64>> for Times {
    fn from(given: Vec<f64>) -> Times {
        Times { given, rules: Vec::new() }
    }
}

/// The [`Times`] of a run.
#[derive(Debug, Clone, Default)]
pub(crate) struct Schedule {
    times: Ascending,
    rules: Vec<(f64, Rule)>,
}

/// Endless times, counted from an origin.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rule {
    /// Multiples of an interval, from 1 on.
    Every(f64),
    /// The first, and a number for each decade.
    Decades(f64, usize),
}

/// Maximum number of times per decade: more are closer than plots resolve.
const MOST_PER_DECADE: usize = 1000;

impl Schedule {
    /// Adds times of a run that starts at `origin`.
    pub(crate) fn add(&mut self, times: Times, origin: f64) -> Result<()> {
        self.times.add("time to stop at or to sample", &times.given)?;
        for rule in times.rules {
            match rule {
                Rule::Every(interval) => drop(positive("interval of times", interval)?),
                Rule::Decades(first, per_decade) => {
                    positive("first of the times in decades", first)?;
                    let is_allowed = (1..=MOST_PER_DECADE).contains(&per_decade);
                    count_within("times per decade", per_decade, is_allowed, "1 to 1000")?;
                }
            }
            self.rules.push((origin, rule));
        }
        Ok(())
    }

    /// The first of the times after `time`.
    pub(crate) fn after(&self, time: f64) -> Option<f64> {
        let of_rules = self.rules.iter().map(|(origin, rule)| rule.after(*origin, time));
        of_rules.chain(self.times.after(time)).min_by(f64::total_cmp)
    }
}

impl Rule {
    /// The time of this number, from 0 on.
    fn time(self, origin: f64, number: f64) -> f64 {
        match self {
            Rule::Every(interval) => origin + (number + 1.0) * interval,
            Rule::Decades(first, per_decade) => {
                let per_decade = per_decade as f64;
                let decade = (number / per_decade).floor();
                origin + first * 10f64.powi(decade as i32) * 10f64.powf(number / per_decade - decade)
            }
        }
    }

    fn after(self, origin: f64, time: f64) -> f64 {
        let about = match self {
            Rule::Every(interval) => (time - origin) / interval - 1.0,
            Rule::Decades(first, per_decade) => per_decade as f64 * ((time - origin) / first).log10(),
        };
        // NaN of a time before the origin is the first
        let mut number = (about.floor() - 1.0).max(0.0);
        // the number is right but for rounding, unless times lie closer than f64 resolves
        for _ in 0..4 {
            let next = self.time(origin, number);
            if next > time {
                return next;
            }
            number += 1.0;
        }
        time.next_up()
    }
}

/// Values at finite times \[s\] that do not decrease: interpolated in between, constant before the first and after the
/// last. Two entries at the same time are a jump.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TimeTable<T>(Vec<(f64, T)>);

impl<T: Copy> TimeTable<T> {
    /// A table of at least `least` > 0 entries; errors name the `table` and its `times`.
    pub(crate) fn new([table, times]: [&'static str; 2], entries: &[(f64, T)], least: usize) -> Result<TimeTable<T>> {
        least_length(table, entries.len(), least)?;
        entries.iter().try_for_each(|&(time, _)| finite(times, time).map(drop))?;
        in_order(times, entries.iter().map(|entry| entry.0), "not decrease", |previous, value| value >= previous)?;
        Ok(TimeTable(entries.to_vec()))
    }

    pub(crate) fn as_slice(&self) -> &[(f64, T)] {
        &self.0
    }

    /// The value at `time`, after a jump; `mix` interpolates two values by the share of the second.
    pub(crate) fn at(&self, time: f64, mix: impl Fn(T, T, f64) -> T) -> T {
        self.interpolated(self.0.partition_point(|entry| entry.0 <= time), time, mix)
    }

    /// The value at `time`, before a jump.
    pub(crate) fn before(&self, time: f64, mix: impl Fn(T, T, f64) -> T) -> T {
        self.interpolated(self.0.partition_point(|entry| entry.0 < time), time, mix)
    }

    fn interpolated(&self, next: usize, time: f64, mix: impl Fn(T, T, f64) -> T) -> T {
        let (start, from) = self.0[next.saturating_sub(1)];
        match self.0.get(next) {
            Some(&(end, to)) if end > start => mix(from, to, (time - start) / (end - start)),
            _ => from,
        }
    }

    /// The first of the times after `time`.
    pub(crate) fn after(&self, time: f64) -> Option<f64> {
        self.0.get(self.0.partition_point(|entry| entry.0 <= time)).map(|entry| entry.0)
    }

    /// Whether the value is constant from `time` to the next entry.
    pub(crate) fn is_constant_after(&self, time: f64) -> bool
    where
        T: PartialEq,
    {
        let next = self.0.partition_point(|entry| entry.0 <= time);
        self.0.get(next).is_none_or(|entry| entry.1 == self.0[next.saturating_sub(1)].1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schedules_have_every_time_once_and_in_order() {
        let mut schedule = Schedule::default();
        let given = Times::from(&[0.35, -1.0, 7.0]);
        schedule.add(given.and(Times::every(0.1)).and(Times::decades(1e-3, 2)), 0.0).unwrap();
        let (mut time, mut found) = (-2.0, Vec::new());
        while let Some(next) = schedule.after(time).filter(|next| *next < 0.45) {
            assert!(next > time);
            found.push(next);
            time = next;
        }
        let root = 10f64.sqrt();
        // 0.1 is both a multiple and a decade, and 0.3 = 3 × 0.1 is the multiple nearest to it
        let expected =
            [-1.0, 1e-3, 1e-3 * root, 1e-2, 1e-2 * root, 0.1, 0.2, 0.30000000000000004, 0.1 * root, 0.35, 0.4];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-15, "{found} {expected}");
        }
        // the times do not depend on how one comes to them
        for k in 0..1000 {
            let time = 1e-4 * f64::from(k);
            let next = schedule.after(time).unwrap();
            assert_eq!(schedule.after(next.next_down()), Some(next));
        }
        assert!(schedule.after(1e300).unwrap() > 1e300);
        assert_eq!(schedule.add(Times::every(0.0), 0.0).unwrap_err().kind(), crate::ErrorKind::Value);
        assert_eq!(schedule.add(Times::decades(1.0, 0), 0.0).unwrap_err().kind(), crate::ErrorKind::Value);
        assert!(Schedule::default().after(0.0).is_none());
    }
}
