//! Elastic contacts at a few levels, from which the pressure of a creeping one is superposed: as many as its error asks
//! for, which is measured.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::elastic::ElasticContact;
use crate::error::Result;
use crate::fields::report::StepReport;
use crate::load::{Load, Tilt};
use crate::solver::RigidMotion;
use crate::states::pressed::{Pressed, allowed_fall};
use crate::states::profile::Profile;

/// Parts of the levels at first: they are doubled until the field is as exact as asked.
const FIRST_PARTS: usize = 4;
/// Half of the levels err by so many times more than all of them, the order being 3/2.
const OF_HALF: f64 = 1.83;
/// Levels nearer than this are one.
pub(super) const NEAREST: f64 = 1e-6;

/// Elastic contacts of unit compliance, kept while a field is found.
#[derive(Debug)]
pub(super) struct Contacts {
    pub(super) elastic: ElasticContact,
    pub(super) tilt: [Tilt; 2],
    allowed_fall: f64,
    /// By ascending levels.
    kept: Vec<SolvedContact>,
    /// Elastic contacts solved since the last field, and their convolutions.
    pub(super) spent: [usize; 2],
    /// Set by another thread to end the contact under way.
    pub(super) cancelled: Option<Arc<AtomicBool>>,
}

/// An elastic contact at a level.
#[derive(Debug, Clone)]
pub(super) struct SolvedContact {
    pub(super) level: f64,
    pub(super) motion: RigidMotion,
    pub(super) area: f64,
    pressure: Pressed,
}

/// A profile, and the size against which its pressure is measured.
pub(super) type Weighted<'a> = (&'a Profile, f64);

/// What a superposition of profiles has at its levels.
pub(super) struct Superposition {
    /// By ascending levels.
    pub(super) solved: Vec<SolvedContact>,
    /// The fields of the profiles on the whole grid.
    pub(super) fields: Vec<Vec<f64>>,
    /// What the levels leave in the worst of them, in L1 over its size.
    pub(super) error: f64,
}

impl Contacts {
    pub(super) fn new(elastic: ElasticContact, tilt: [Tilt; 2], tolerance: f64) -> Contacts {
        let (allowed_fall, kept) = (allowed_fall(tolerance), Vec::new());
        Contacts { elastic, tilt, allowed_fall, kept, spent: [0; 2], cancelled: None }
    }

    pub(super) fn solve(&mut self, level: f64) -> Result<SolvedContact> {
        if let Some(kept) = self.kept.iter().find(|kept| kept.level == level) {
            return Ok(kept.clone());
        }
        let report = self.solve_under(Load::Force { normal: level, tilt: self.tilt })?;
        self.spent = [self.spent[0] + 1, self.spent[1] + report.convolutions];
        let fields = self.elastic.fields();
        let (motion, area) = (fields.motion(0), fields.contact_area());
        Ok(SolvedContact { level, motion, area, pressure: Pressed::new(fields.pressure()) })
    }

    /// Solves the elastic contact under a load.
    pub(super) fn solve_under(&mut self, load: Load) -> Result<StepReport> {
        match &self.cancelled {
            Some(flag) => self.elastic.solve_unless(flag, load),
            None => self.elastic.solve(load),
        }
    }

    /// Solves an elastic contact and keeps it.
    pub(super) fn keep(&mut self, level: f64) -> Result<SolvedContact> {
        let solved = self.solve(level)?;
        let at = self.kept.partition_point(|kept| kept.level < level);
        if self.kept.get(at).is_none_or(|kept| kept.level > level) {
            self.kept.insert(at, solved.clone());
        }
        Ok(solved)
    }

    /// Drops all contacts.
    pub(super) fn forget(&mut self) {
        self.kept.clear();
    }

    /// Nowhere may the pressure fall while the load grows.
    pub(super) fn check(&self, below: &SolvedContact, above: &SolvedContact) -> Result<()> {
        below.pressure.check_growth(&above.pressure, [below.level, above.level], self.allowed_fall)
    }

    /// Levels for profiles, the kept ones where these are near.
    fn levels(&self, profiles: &[Weighted<'_>], parts: usize) -> Vec<f64> {
        let mut wanted: Vec<f64> = profiles.iter().flat_map(|(profile, _)| profile.cuts(parts)).collect();
        wanted.sort_by(f64::total_cmp);
        wanted.dedup_by(|next, level| *next - *level < NEAREST * *next);
        let near = |k: usize| {
            let level = wanted[k];
            let Some(next) = wanted.get(k + 1) else { return level };
            let (below, above) = (k.checked_sub(1).map_or(0.5 * level, |k| wanted[k]), *next);
            let (from, to) = (0.5 * (below + level), 0.5 * (level + above));
            let inside = self.kept.iter().map(|kept| kept.level).filter(|kept| (from..to).contains(kept));
            inside.min_by(|a, b| (a - level).abs().total_cmp(&(b - level).abs())).unwrap_or(level)
        };
        (0..wanted.len()).map(near).collect()
    }

    /// The pressures of profiles, from so many levels that the error of each is at most `accuracy`; from every group
    /// for an accuracy of 0.
    pub(super) fn superpose(&mut self, profiles: &[Weighted<'_>], accuracy: f64) -> Result<Superposition> {
        let groups = profiles.iter().map(|(profile, _)| profile.len()).max().unwrap_or(0);
        let mut parts = if accuracy > 0.0 { FIRST_PARTS } else { groups };
        let mut last: Option<SolvedContact> = None;
        loop {
            let levels = self.levels(profiles, parts);
            let mut solved = Vec::with_capacity(levels.len());
            for (k, level) in levels.iter().enumerate() {
                // the last one is of this field alone
                let is_last = k + 1 == levels.len();
                solved.push(match last.take_if(|last| is_last && last.level == *level) {
                    Some(last) => last,
                    None if is_last => self.solve(*level)?,
                    None => self.keep(*level)?,
                });
            }
            let mut fields = Vec::new();
            let mut error = 0.0_f64;
            for (profile, size) in profiles {
                let all = self.field(profile, &solved, 1);
                if *size > 0.0 && parts < groups {
                    let half = self.field(profile, &solved, 2);
                    let off: f64 = all.iter().zip(&half).map(|(all, half)| (all - half).abs()).sum();
                    error = error.max(off * self.elastic.fields().grid().cell_area() / (OF_HALF * size));
                }
                fields.push(all);
            }
            if error <= accuracy || parts >= groups {
                solved.windows(2).try_for_each(|pair| self.check(&pair[0], &pair[1]))?;
                return Ok(Superposition { solved, fields, error });
            }
            last = solved.pop();
            parts *= 2;
        }
    }

    /// Σ w (p_e(l_i) − p_e(l_i−1)) = Σ (w_i − w_i+1) p_e(l_i), on every so many of the levels, the last one among them.
    fn field(&self, profile: &Profile, solved: &[SolvedContact], every: usize) -> Vec<f64> {
        let picked = || solved.iter().skip(solved.len().saturating_sub(1) % every).step_by(every);
        let levels: Vec<f64> = picked().map(|solved| solved.level).collect();
        let shares = profile.means(&levels);
        let mut field = vec![0.0; self.elastic.fields().grid().len()];
        for (k, solved) in picked().enumerate() {
            solved.pressure.add_to(shares[k] - shares.get(k + 1).unwrap_or(&0.0), &mut field);
        }
        field
    }
}
