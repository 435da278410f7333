//! The first time within a step at which bodies touch or part, or a force begins or ends.

use crate::error::Result;
use crate::run::passage::{AT_START, Passage, Span};
use crate::run::progress::SAME_TIME;

impl Passage {
    /// Whether the load ever falls below that at the start.
    pub(crate) fn falls(&self) -> bool {
        self.points.iter().any(|point| point.1 < self.marks[0])
    }

    /// The first time within the step, apart from its start and its end, at which bodies that touch
    /// at its start part, or that are apart touch: where `load` passes `surface`, the depth that
    /// touches a surface that nothing presses on at a time, which only falls. Where they touch,
    /// they overlap by at most `overshoot`; where they part, they are apart by as much.
    pub(crate) fn first_event(
        &self,
        mut touch: bool,
        overshoot: f64,
        surface: &mut impl FnMut(f64) -> Result<f64>,
        load: &mut impl FnMut(f64) -> Result<f64>,
    ) -> Result<Option<f64>> {
        let Span { now, end } = self.span();
        let (near, mut from) = (now + AT_START * (end - now), 0);
        while let Some(k) = self.first_other(touch, from, self.points.len() - 1, surface)? {
            let (mut low, (mut high, mut there)) = (self.points[k - 1].0, self.points[k]);
            there -= surface(high)?;
            while high > near && there.abs() > overshoot {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                let over = load(middle)? - surface(middle)?;
                if (over > 0.0) == touch { low = middle } else { (high, there) = (middle, over) }
            }
            if near < high && high < end - SAME_TIME * (end - now) {
                return Ok(Some(high));
            }
            (touch, from) = (!touch, k);
        }
        Ok(None)
    }

    /// The number of the first point after `from`, up to `to`, at which the bodies are apart if
    /// they `touch`, or touch if they are apart. Loads of all points and the surface at one end of
    /// them tell at once that there is none; else one half is looked at after the other.
    fn first_other(
        &self,
        touch: bool,
        from: usize,
        to: usize,
        surface: &mut impl FnMut(f64) -> Result<f64>,
    ) -> Result<Option<usize>> {
        if from == to {
            return Ok(None);
        }
        let loads = self.points[from + 1..=to].iter().map(|point| point.1);
        let none = match touch {
            true => loads.fold(f64::INFINITY, f64::min) > surface(self.points[from + 1].0)?,
            false => loads.fold(f64::NEG_INFINITY, f64::max) <= surface(self.points[to].0)?,
        };
        if none || to == from + 1 {
            return Ok((!none).then_some(to));
        }
        let middle = from + (to - from) / 2;
        match self.first_other(touch, from, middle, surface)? {
            None => self.first_other(touch, middle, to, surface),
            found => Ok(found),
        }
    }

    /// The first time within the step at which a force ends that acts at its start, or begins: the
    /// last one without force.
    pub(crate) fn first_change_of_force(&self, load: &mut impl FnMut(f64) -> Result<f64>) -> Result<Option<f64>> {
        let (Span { now, end }, mut presses) = (self.span(), self.marks[0] > 0.0);
        let near = now + SAME_TIME * (end - now);
        for pair in self.points.windows(2) {
            let [mut low, mut high] = [pair[0].0, pair[1].0];
            if (pair[1].1 > 0.0) == presses {
                continue;
            }
            while high > near {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                if (load(middle)? > 0.0) == presses { low = middle } else { high = middle }
            }
            presses = !presses;
            let event = if presses { low } else { high };
            if near < event && event < end - SAME_TIME * (end - now) {
                return Ok(Some(event));
            }
        }
        Ok(None)
    }
}
