//! Groups of levels merge where their pasts are nearly one, so that long runs have few.

use crate::states::curve::ElasticStates;
use crate::states::levels::{Group, Levels};

/// Groups are merged when there are so many more, as a part of those after the last time, and these in any case.
const MORE: [usize; 2] = [16, 8];
/// The error of merging is relative to the force that the groups below carry and to their depth. This is the least of
/// both that counts, as a part of the whole force and depth.
const LEAST: f64 = 1e-4;

/// Share of the error that merging uses: the contact area errs by up to ten times as much as the depth.
const SHARE: f64 = 0.9;
/// Share of the error for the depth of held groups and the force of free ones. A merged group keeps the force or the
/// depth: weighted by the other widths its mean strain is another, and these errors of all groups add up where the
/// load falls far at once.
const OTHER: f64 = 0.07;

impl Levels {
    /// Merges neighbours, both held or both free, where a later step that ends within the merged group errs by at
    /// most about `error`, in depth and in force, relative to those with a cut at its top. Let A be the greatest
    /// difference of the strains of both: what a cut inside leaves out is a profile of slope 2 A over the sum of both
    /// widths, so it errs by A/4 times this sum. Held groups keep their force, free ones the depth.
    pub(in crate::states) fn merge(&mut self, states: &ElasticStates, error: f64) {
        let Some(last) = self.groups.last().copied().filter(|_| self.groups.len() >= self.merge_from) else { return };
        let (held, reach, compliance) = (self.held(), states.reach(), self.history.rule().compliance());
        // of (1 − W) Δl, the force over the compliance of a step that cuts there
        let carried_by = |levels: &Levels, k: usize| {
            let Group { top, traction, .. } = levels.groups[k];
            let part = if k < held { traction * compliance } else { 1.0 - levels.history.displacements()[k] };
            part * (top - levels.bottom(k).0)
        };
        let width = |levels: &Levels, k: usize| {
            let ((bottom, lower), Group { top, motions, .. }) = (levels.bottom(k), levels.groups[k]);
            let turned = (0..2).map(|axis| (motions.tilt[axis] - lower.tilt[axis]).abs()).sum::<f64>();
            [top - bottom, motions.depth - lower.depth + reach * turned]
        };
        let least = LEAST * (0..self.groups.len()).map(|k| carried_by(self, k)).sum::<f64>();
        let (mut kept, mut carried) = (0, 0.0);
        for k in 0..self.groups.len() {
            carried += carried_by(self, k);
            let (group, own) = (self.groups[k], width(self, k));
            if kept > 0 && k != held {
                let before = width(self, kept - 1);
                let [level, depth] = [0, 1].map(|axis| before[axis] + own[axis]);
                let deep = group.motions.depth.max(LEAST * last.motions.depth);
                let shares = [own[0] / level, own[1] / depth];
                let apart = (shares[0] - shares[1]).abs();
                let most = error * (4.0 * SHARE * (carried.max(least) / level).min(deep / depth)).min(OTHER / apart);
                if self.history.differ_at_most(kept - 1, k, most) {
                    let share = shares[usize::from(k >= held)];
                    self.history.mix(kept - 1, k, share);
                    let into = &mut self.groups[kept - 1];
                    let traction = into.traction + share * (group.traction - into.traction);
                    let shear = into.shear + share * (group.shear - into.shear);
                    *into = Group { traction, shear, ..group };
                    continue;
                }
            }
            self.groups[kept] = group;
            self.history.copy_within(k, kept);
            kept += 1;
        }
        self.groups.truncate(kept);
        self.history.truncate(kept);
        self.merge_from = kept + kept / MORE[0] + MORE[1];
    }
}
