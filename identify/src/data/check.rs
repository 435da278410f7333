//! Checks of a curve before it is fitted.

use std::f64::consts::PI;

use crate::error::{Error, Result, count_within};
use crate::experiment::Curve;
use crate::statistics::{is_flat, line, mean, range, scatter};

/// Fewest points of a curve.
const LEAST_POINTS: usize = 10;
/// Blocks of points whose mean forces are compared.
const BLOCKS: usize = 20;
/// The maximum mean of a block rises above the scatter of the shallow end by this factor, if there is a contact.
const ABOVE_BASELINE: f64 = 3.0;
/// 97.5 % of χ² of four degrees of freedom: the moduli, the relaxation time and the contact point of a Zener body.
const EVIDENCE: f64 = 11.143;
/// Relaxation times of bodies over the duration of a curve, and moduli that do not relax over those that do.
const BODIES: [(f64, f64); 7] =
    [(f64::INFINITY, 0.0), (0.1, 1.0), (0.03, 1.0), (0.3, 0.0), (0.1, 0.0), (0.03, 0.0), (0.01, 0.0)];
/// Contact points that are tried, and half the correlations.
const TRIED: usize = 10;
/// One minus the correlation that the largest of those that are tried nearly reaches.
const LEAST_CHANGE: f64 = 0.004;
/// Share of the range of the force by which it differs between the ends of the drive, if the contact is at one of them.
const OPPOSITE: f64 = 0.25;
/// Share of the maximum force from which on the tip has certainly touched.
const TOUCHED: f64 = 0.1;
/// Depths over the contact radius that steep pyramids do not reach.
const STEEPEST: f64 = 4.0;
/// Noise over the rise of the force, to which running means of at most a block reduce it.
const ALLOWED_NOISE: f64 = 0.03;
/// Contact moduli of materials \[Pa\].
const MODULI: [f64; 2] = [1.0, 1e13];

impl Curve {
    /// Checks that the curve shows a contact of this tip: enough points, a force above its scatter, signs, and units that
    /// fit each other and the size of the tip. [`Recording`](crate::Recording) checks every curve that it makes.
    ///
    /// The checks are coarse: those of units and signs accept every curve that some material can give, and a curve of two wrong units
    /// may pass. In slow noise of a tenth of the force, of 1000 contacts at most 17 were taken for noise, and of 1000 curves of such noise at most
    /// 35 for contacts.
    ///
    /// # Errors
    /// What is wrong and what to change, such as [`Error::ForceFlipped`] or [`Error::BeyondStates`].
    pub fn check(&self) -> Result<()> {
        let (drive, force) = (self.experiment.protocol.drive(), self.force());
        let (points, [first, last]) = (force.len(), range(drive));
        count_within("points of the curve", points, points >= LEAST_POINTS, "10 or more: measure at a higher rate")?;
        if is_flat(force) {
            return Err(Error::NoContact { curve: 0 });
        }
        if first == last {
            // a jump before the first time
            return self.check_sizes(0.0, 1);
        }
        // the forces in a part of the range of the drive, and the least and the greatest mean of a block
        let part = |from: f64, to: f64| -> Vec<f64> {
            let inside = |z: f64| (from..=to).contains(&((z - first) / (last - first)));
            drive.iter().zip(force).filter(|(z, _)| inside(**z)).map(|(_, force)| *force).collect()
        };
        let block = (points / BLOCKS).max(1);
        let means = |forces: &[f64]| range(&forces.chunks_exact(block).map(mean).collect::<Vec<_>>());
        let (lowest, [least, greatest]) = (part(0.0, 0.1), means(force));
        let shallow = mean(&lowest);
        let fall = shallow - mean(&part(0.9, 1.0));
        if fall > OPPOSITE * (greatest - least) {
            let [shallow, deep] = [part(0.0, 0.5), part(0.5, 1.0)].map(|half| {
                let [low, high] = means(&half);
                (high - low).max(0.0)
            });
            // the contact is at the low end of the drive
            let drive_flipped = (shallow > 2.0 * deep).then_some(Error::DriveFlipped { shallow, deep });
            return Err(drive_flipped.unwrap_or(Error::ForceFlipped { fall }));
        }
        let squares: f64 = lowest.iter().map(|force| (force - shallow).powi(2)).sum();
        // adhesion may be stronger than the load, but not in the loading
        let shows_body = || self.shows_body() || self.loading().is_ok_and(|loading| loading.shows_body());
        let is_baseline = greatest - shallow <= ABOVE_BASELINE * (squares / lowest.len() as f64).sqrt();
        if is_baseline || !shows_body() {
            return Err(Error::NoContact { curve: 0 });
        }
        let wanted = (scatter(force) / (ALLOWED_NOISE * (greatest - least))).powi(2).ceil();
        self.check_sizes(shallow, wanted.clamp(1.0, block as f64) as usize)
    }

    /// Whether the forces are likelier those of a Zener body under a sphere in autoregressive noise than that noise alone, both
    /// above a constant force, by twice the logarithm of the ratio of their maximum likelihoods (S. S. Wilks, Ann. Math. Stat. 9, 1938).
    fn shows_body(&self) -> bool {
        let (times, drive) = (self.experiment.protocol.times(), self.experiment.protocol.drive());
        let (points, duration, [first, last]) = (times.len(), times[times.len() - 1] - times[0], range(drive));
        let body = &|contact: f64, (relaxation, staying): (f64, f64)| -> Vec<f64> {
            let (mut force, mut time, mut level) = (0.0_f64, times[0], 0.0);
            let at = |(&t, &z): (&f64, &f64)| {
                let pressed = ((z - first) / (last - first) - contact).max(0.0).powf(1.5);
                // the tip detaches and does not pull
                force = (force + pressed - level).max(0.0) * ((time - t) / (relaxation * duration)).exp();
                (time, level) = (t, pressed);
                force + staying * pressed
            };
            times.iter().zip(drive).map(at).collect()
        };
        let tried = |count: usize| (0..count).map(move |k| k as f64 / count as f64);
        let independent = |column: &[f64], phi: f64| column.windows(2).map(|w| w[1] - phi * w[0]).collect::<Vec<_>>();
        let correlations = tried(2 * TRIED).map(|at| 1.0 - LEAST_CHANGE.powf(at));
        let forces: Vec<_> = correlations.map(|phi| (phi, independent(self.force(), phi))).collect();
        // the independent parts of the noise that is left, over all correlations
        let least_squares = |body: &[f64]| {
            let squares = forces.iter().map(|(phi, force)| {
                let [_, slope, squares] = line(&independent(body, *phi), force, true);
                // the variance of the noise is 1/(1 − φ²) of that of its independent parts, in the likelihood of the first force
                if slope >= 0.0 { squares / (1.0 - phi * phi).powf(1.0 / points as f64) } else { f64::INFINITY }
            });
            squares.fold(f64::INFINITY, f64::min)
        };
        let noise = least_squares(&vec![0.0; points]);
        let mut bodies = BODIES.into_iter().flat_map(|kind| tried(TRIED).map(move |contact| body(contact, kind)));
        points >= LEAST_POINTS
            && bodies.any(|body| (points - 4) as f64 * (noise / least_squares(&body)).ln() > EVIDENCE)
    }

    /// Compares depth and force with the tip, in means of `width` points. The depth is counted from where the force has risen, so
    /// that it is hardly overestimated.
    fn check_sizes(&self, baseline: f64, width: usize) -> Result<()> {
        let means = |column: &[f64]| -> Vec<f64> { column.windows(width).map(mean).collect() };
        let (drive, force) = (means(self.experiment().protocol().drive()), means(self.force()));
        let peak = (0..force.len()).max_by(|&a, &b| force[a].total_cmp(&force[b])).unwrap_or_default();
        let touched = baseline + TOUCHED * (force[peak] - baseline);
        let touch = (0..peak).rev().find(|&k| force[k] < touched).unwrap_or_default();
        let [rise, travel] = [force[peak] - force[touch], drive[peak] - drive[touch]];
        let deflection = rise / self.experiment.stiffness;
        if deflection > 1.1 * travel {
            return Err(Error::SpringTooSoft { deflection, travel });
        }
        let depth = travel - deflection;
        if depth <= 0.0 {
            // a jump at the first time, or a sample that is stiff next to the spring
            return Ok(());
        }
        let level = self.experiment.level_within(depth)?;
        let radius = |depth: f64| (self.experiment.tip.area(self.experiment.level(depth)) / PI).sqrt();
        if depth > STEEPEST * radius(depth) && 1e-3 * depth < radius(1e-3 * depth) {
            return Err(Error::DepthTooLarge { depth, radius: radius(depth) });
        }
        let modulus = rise / level;
        if (MODULI[0]..=MODULI[1]).contains(&modulus) { Ok(()) } else { Err(Error::Modulus { modulus }) }
    }
}
