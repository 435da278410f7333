//! Times in ascending order, and values at them.

use crate::error::{Result, finite, in_order, least_length};

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
