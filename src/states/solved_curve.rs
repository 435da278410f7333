//! The curve δ(l) of a surface through elastic contacts that are solved as it needs them.

use std::sync::Arc;

use crate::error::Result;
use crate::load::Tilt;
use crate::solver::RigidMotion;
use crate::states::contacts::{Contacts, NEAREST, SolvedContact};
use crate::states::curve::ElasticStates;

/// The slope of the curve turns by so much of the maximum turn where contacts are added.
const OF_GREATEST_TURN: f64 = 0.25;
/// Levels of the curve beyond its last one, over that.
const BEYOND: f64 = 16.0;

/// Elastic contacts, and the curve through them.
#[derive(Debug)]
pub(super) struct SolvedCurve {
    pub(super) contacts: Contacts,
    /// Level, depth and area of the elastic contacts that the curve goes through.
    rows: Vec<[f64; 3]>,
    /// Whether all loads are forces, under which levels do not depend on the depth.
    pub(super) by_force: bool,
    rest: f64,
}

impl SolvedCurve {
    pub(super) fn new(contacts: Contacts, by_force: bool, rest: f64) -> SolvedCurve {
        SolvedCurve { contacts, rows: Vec::new(), by_force, rest }
    }

    /// Adds an elastic contact to the curve.
    pub(super) fn add(&mut self, SolvedContact { level, motion, area, .. }: &SolvedContact) {
        let depth = if self.by_force { level.powf(2.0 / 3.0) } else { motion.approach - self.rest };
        let at = self.rows.partition_point(|row| row[0] < *level);
        let is_new = |row: &[f64; 3]| (row[0] / level - 1.0).abs() > NEAREST && (row[1] > depth) == (row[0] > *level);
        let fits = self.rows[at.saturating_sub(1)..].iter().take(2).all(is_new);
        if fits && depth > 0.0 {
            self.rows.insert(at, [*level, depth, *area]);
        }
    }

    /// δ(l) through every so many of the elastic contacts, from the `first` on, and both ends, with the slopes of
    /// parabolas of the logarithms.
    pub(super) fn through(&self, every: usize, first: usize) -> Result<Arc<ElasticStates>> {
        let end = self.rows.len() - 1;
        let is_kept = |k: &usize| (k + first).is_multiple_of(every) || *k == 0 || *k == end;
        let rows: Vec<[f64; 3]> = (0..=end).filter(is_kept).map(|k| self.rows[k]).collect();
        let slope = |k: usize| {
            let chord = |k: usize| {
                let [a, b] = [rows[k], rows[k + 1]];
                let width = (b[0] / a[0]).ln();
                ((b[1] / a[1]).ln() / width, width)
            };
            let last = rows.len() - 1;
            let ((below, left), (above, right)) = (chord(k.saturating_sub(1).min(last - 1)), chord(k.min(last - 1)));
            (below * right + above * left) / (left + right)
        };
        let row = |k: usize| {
            let ([level, depth, area], slope) = (rows[k], slope(k));
            (level, self.rest + depth, level / (depth * slope), area)
        };
        let last = rows.len() - 1;
        let ([level, depth, area], power) = (rows[last], slope(last));
        let (ratio, beyond) = (BEYOND.powf(power), BEYOND * level);
        let end = (beyond, self.rest + depth * ratio, beyond / (depth * ratio * power), area * ratio);
        let rows = (0..=last).map(row).chain([end]);
        let rest = RigidMotion { approach: self.rest, tilt: [0.0; 2] };
        let mut states = ElasticStates::from_rows(rows, rest, [Tilt::Fixed(0.0); 2])?;
        Arc::make_mut(&mut states).tilt = self.contacts.tilt;
        Ok(states)
    }

    /// Adds at most so many elastic contacts in the middle of others where the slope of the curve changes most: where
    /// cells join. Returns their number.
    pub(super) fn refine(&mut self, most_added: usize) -> Result<usize> {
        let width = |k: usize| (self.rows[k + 1][0] / self.rows[k][0]).ln();
        let slope = |k: usize| (self.rows[k + 1][1] / self.rows[k][1]).ln() / width(k);
        let last = self.rows.len() - 2;
        // the depth by which the slope turns
        let turn = |k: usize| {
            let beside = [k.saturating_sub(1), (k + 1).min(last)].map(|other| (slope(other) - slope(k)).abs());
            beside[0].max(beside[1]) * width(k) * self.rows[k + 1][1]
        };
        let turns: Vec<f64> = (0..=last).map(turn).collect();
        let most = turns.iter().copied().fold(0.0, f64::max);
        let middle = |k: usize| (self.rows[k][0] * self.rows[k + 1][0]).sqrt();
        let mut turning: Vec<usize> = (0..=last).filter(|k| turns[*k] >= OF_GREATEST_TURN * most).collect();
        turning.sort_by(|a, b| turns[*b].total_cmp(&turns[*a]));
        turning.truncate(most_added);
        let middles: Vec<f64> = turning.into_iter().map(middle).collect();
        for level in &middles {
            let solved = self.contacts.keep(*level)?;
            self.add(&solved);
        }
        Ok(middles.len())
    }
}
