//! The load histories that a run follows.

use std::sync::Arc;

use crate::error::{Error, Refusal, Result};
use crate::load::{Load, LoadHistory};
use crate::run::{Contact, OwnedOrBorrowed};

/// The load history of a body. The owned one borrows nothing: after its last use a run no longer borrows its contact,
/// even before the run is dropped.
pub(super) type RunHistory<'a> = OwnedOrBorrowed<&'a dyn LoadHistory, Box<dyn LoadHistory>>;

/// One load history for each rigid body, in their order.
#[derive(Debug)]
pub struct Histories<'a> {
    first: RunHistory<'a>,
    others: Vec<RunHistory<'a>>,
}

impl<'a> Histories<'a> {
    pub(super) fn one(first: RunHistory<'a>) -> Histories<'a> {
        Histories { first, others: Vec::new() }
    }

    /// `None` of no histories.
    pub(super) fn new(histories: Vec<RunHistory<'a>>) -> Option<Histories<'a>> {
        let mut histories = histories.into_iter();
        Some(Histories { first: histories.next()?, others: histories.collect() })
    }

    /// That of the first body.
    pub(crate) fn first(&self) -> &dyn LoadHistory {
        borrowed(&self.first)
    }

    pub(super) fn each(&self) -> impl Iterator<Item = &dyn LoadHistory> {
        std::iter::once(&self.first).chain(&self.others).map(borrowed)
    }

    pub(super) fn count(&self) -> usize {
        1 + self.others.len()
    }

    /// Puts a load of each into `loads`, those along the surface last; `load` learns whether it may pull.
    pub(super) fn loads<C: Contact>(
        &self,
        loads: &mut Vec<Load>,
        contact: &C,
        load: impl Fn(&dyn LoadHistory, bool) -> Result<Load>,
    ) -> Result<()> {
        loads.clear();
        for history in self.each() {
            loads.push(load(history, contact.attracts())?);
        }
        for along in contact.lateral() {
            loads.push(load(&**along, true).map_err(Error::along)?);
        }
        Ok(())
    }

    /// The first breakpoint of any after `now`, those of what acts along the surface too; infinite if there is none.
    pub(super) fn next_breakpoint(&self, now: f64, along: &[Arc<dyn LoadHistory>]) -> Result<f64> {
        self.each().chain(along.iter().map(|along| &**along)).try_fold(f64::INFINITY, |first, history| {
            let next = history.next_breakpoint(now).unwrap_or(f64::INFINITY);
            if next <= now || next.is_nan() {
                let what = format!("the load history returned {next} s as the first breakpoint after t = {now} s");
                let remedy = ": it must be later; compare times with the breakpoints themselves (guide::own_models)";
                return Err(Refusal::value("load_invalid_breakpoint", what, remedy).into());
            }
            Ok(first.min(next))
        })
    }
}

fn borrowed<'h>(history: &'h RunHistory<'_>) -> &'h dyn LoadHistory {
    match history {
        OwnedOrBorrowed::Borrowed(history) => *history,
        OwnedOrBorrowed::Owned(history) => &**history,
    }
}
