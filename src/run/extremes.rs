//! The maximum of a quantity within a step.

use crate::error::{Result, finite};
use crate::run::Contact;
use crate::run::follow::Run;

/// Equal parts of a step at whose ends a quantity is looked at, ...
const PARTS: usize = 8;
/// ... and halvings of the parts beside the maximum: the peak of a pull-off is a thousandth of a long step.
const HALVINGS: usize = 12;
/// The maximum is found to this part of the range of the quantity in the step.
const ACCURACY: f64 = 1e-3;

impl<C: Contact> Run<'_, C> {
    /// The time \[s\] of the maximum of a quantity within the last step, and the maximum; pass the negative for the
    /// minimum. Adaptive steps are as long as approach or force at their *ends* allow: the maximum pull of a
    /// pull-off, the peak of a pressure mostly lie within one.
    ///
    /// The quantity is looked at at eight equal parts of the step, and beside the maximum twice as often until it
    /// changes by less than a thousandth of its range in the step. Each look costs a contact problem and a copy of
    /// the contact, as a [sample](Run::within_step) does. A peak is missed where it lies between two looks that do
    /// not show it.
    ///
    /// ```
    /// use viscocontact::adhesion::ExponentialAttraction;
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 3.0e-3)?)
    ///     .geometry(&Sphere::new(5.0e-3)?)
    ///     .material(Material::incompressible(Zener::relaxing(60.0e3, 20.0e3, 1.0)?))
    ///     .attraction(ExponentialAttraction::new(0.1, 60.0e-6)?)
    ///     .build()?;
    /// let drawn_off = Ramp::new(Load::approach(20.0e-6), Load::approach(-0.5e-3), 0.1)?;
    /// let mut run = contact.follow(&drawn_off, Stepping::adaptive(1.0e-2), 0.1);
    /// let (mut greatest, mut at_ends) = (0.0_f64, 0.0_f64);
    /// while let Some(report) = run.next_step()? {
    ///     let (_, pull) = run.max_within_step(|contact| -contact.force())?;
    ///     (greatest, at_ends) = (greatest.max(pull), at_ends.max(-report.force));
    /// }
    /// assert!(greatest > at_ends);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the quantity is not finite, or as [`Run::within_step`]. Before the first step it is that of the contact.
    pub fn max_within_step(&self, quantity: impl Fn(&C) -> f64) -> Result<(f64, f64)> {
        let end = self.contact.time();
        let look = |time: f64| {
            let value = if time == end { quantity(&self.contact) } else { quantity(&self.sample_within_step(time)?.0) };
            Ok((time, finite("quantity within a step", value)?))
        };
        let Some((start, report)) = self.last.filter(|(_, report)| report.dt > 0.0) else { return look(end) };
        let length = report.time - start;
        let part = |k: usize| if k == PARTS { end } else { start + length * k as f64 / PARTS as f64 };
        let mut looks = (0..=PARTS).map(|k| look(part(k))).collect::<Result<Vec<_>>>()?;
        for _ in 0..HALVINGS {
            let values = || looks.iter().map(|&(_, value)| value);
            let range = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
            let Some(best) = (0..looks.len()).max_by(|&a, &b| looks[a].1.total_cmp(&looks[b].1)) else { break };
            let (before, after) = (best.saturating_sub(1), (best + 1).min(looks.len() - 1));
            // a parabola through three neighbours rises above the middle one by at most an eighth of the fall to both
            // sides
            let falls = 2.0 * looks[best].1 - looks[before].1 - looks[after].1;
            if falls <= ACCURACY * range || looks[before].0 == looks[after].0 {
                break;
            }
            let middle = |a: usize, b: usize| 0.5 * (looks[a].0 + looks[b].0);
            let [left, right] = [middle(before, best), middle(best, after)];
            for (place, time) in [(after, right), (best, left)] {
                if looks.iter().all(|look| look.0 != time) {
                    looks.insert(place, look(time)?);
                }
            }
        }
        let greatest = looks.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        greatest.map_or_else(|| look(end), Ok)
    }
}
