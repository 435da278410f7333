//! How the steps of a contact of a user's own are judged.

#[cfg(feature = "checkpoint")]
use std::path::Path;

use crate::contact::StepReport;
use crate::error::Result;
use crate::load::{Load, LoadHistory};
use crate::run::Contact;
#[cfg(feature = "checkpoint")]
use crate::run::doubled::SavedRun;
use crate::run::doubled::judge::{FIRST_STEP, Judge, Record, SMALL, Tries, WITHOUT_ORDER};
use crate::run::passage::{Passage, Span};

/// Part of the tolerance that the steps of a run share by their length, and each step beside that by its length over
/// the time since the last jump or corner: the sum over a run of any number of steps is bounded.
const OF_RUN: f64 = 0.5;
const OF_DECADE: f64 = 0.03;

/// Nothing is known of the contact but the difference of two outcomes, and nothing of its rule in time but that its
/// order is one at least: the halves err by no more than they differ from the whole.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Plain;

impl<C: Contact> Judge<C> for Plain {
    const ORDER: f64 = 2.0;

    fn size(_: &C, load: Load) -> Result<f64> {
        Ok(load.main())
    }

    fn begins_anew(before: &C, after: &C) -> bool {
        before.is_separated() && !after.is_separated()
    }

    fn aim(record: &Record<Plain>, _: &C, Span { now, end }: Span, corner: f64) -> f64 {
        let (run, since) = (record.until - record.start, end - corner);
        record.tolerance * (end - now) * (OF_RUN / run + OF_DECADE / since)
    }

    /// A top of the load within the step of bodies that are apart: what happens there might not show at its end.
    fn event(_: &Record<Plain>, contact: &C, _: &dyn LoadHistory, passage: &Passage, _: &mut C) -> Result<Option<f64>> {
        Ok(if contact.is_separated() { passage.first_top() } else { None })
    }

    fn error(
        record: &Record<Plain>,
        contact: &C,
        tries: &mut Tries<C>,
        _: &dyn LoadHistory,
        Span { now, end }: Span,
        _: &StepReport,
    ) -> Result<f64> {
        let Tries { whole, halves, middle } = tries;
        let apart = contact.is_separated();
        let changes = middle.is_separated() != apart || halves.is_separated() != apart;
        let scales = [halves.approach(), halves.force()].map(f64::abs);
        let over = |(off, (scale, greatest)): (f64, (f64, f64))| {
            if off == 0.0 { 0.0 } else { off / scale.max(SMALL * greatest) }
        };
        let (off, unseen) = (whole.difference(halves), halves.unseen([contact, middle]));
        let off = [0, 1].map(|k| off[k] + unseen[k].max(0.0));
        let parts = off.into_iter().zip(scales.into_iter().zip(record.greatest)).map(over);
        let worst = parts.fold(0.0, |worst, part| if part.is_nan() { f64::INFINITY } else { part.max(worst) });
        // what begins from nothing is off by a part of itself, however short the step is: one that all longer ones were
        // rejected for is accepted
        let since = (end - record.corner).max(FIRST_STEP * (record.until - now));
        if worst.is_finite() && end - now <= FIRST_STEP * since && Self::begins_anew(contact, halves) {
            return Ok(0.0);
        }
        Ok(if changes { WITHOUT_ORDER } else { 1.0 } * worst)
    }

    #[cfg(feature = "checkpoint")]
    fn save(contact: &C, run: SavedRun<Plain>, path: &Path) -> Result<()> {
        contact.save_run(run, path)
    }

    fn greatest(record: &Record<Plain>, halves: &C) -> [f64; 2] {
        let own = if halves.is_separated() {
            [0.0, halves.force().abs()]
        } else {
            [halves.approach(), halves.force()].map(f64::abs)
        };
        [0, 1].map(|k| record.greatest[k].max(own[k]))
    }
}
