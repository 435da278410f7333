//! The usual readings of an indentation curve, for comparison.
//!
//! Each of these formulas takes the body for elastic, or the load for an ideal step. On a creeping body they are off by as much
//! as the body relaxes in the time of a ramp; [`oliver_pharr`] is also off by the creep during unloading. The crate has
//! them so that their results can be compared with a fit of the same curve, and with results of other programs.
//!
//! | formula | source |
//! |---|---|
//! | [`oliver_pharr`]: modulus from the stiffness at the onset of unloading | W. C. Oliver, G. M. Pharr, J. Mater. Res. 7 (1992) 1564; 19 (2004) 3 |
//! | [`hold_relaxation`]: relaxation modulus from the force of a hold, as after an ideal step | E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27 (1960) 438; ramps as [`RampCorrection`] |
//! | [`loading_modulus`]: elastic law fitted to the loading curve | H. Hertz 1882; I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47 |

use std::f64::consts::PI;

use viscocontact::numeric::minimum;

use crate::error::{Error, Result, count_within, positive};
use crate::experiment::Curve;
use crate::statistics::{line, range};

/// Shares of the force at the onset of unloading between which its curve is fitted.
const UNLOADING: [f64; 2] = [0.98, 0.20];
/// ε of a paraboloid, and about that of a cone, in h_c = h − ε F/S.
const EPSILON: f64 = 0.75;
/// Points at which a least value is looked for first.
const POINTS: usize = 60;
/// Fewest points of a fit.
const LEAST_POINTS: usize = 5;

/// The reading of an unloading curve, see [`oliver_pharr`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct OliverPharr {
    /// Stiffness S at the onset of unloading \[N/m\].
    pub stiffness: f64,
    /// Contact depth h_c \[m\].
    pub contact_depth: f64,
    /// Contact area A(h_c) \[m²\].
    pub area: f64,
    /// Contact modulus E* \[Pa\].
    pub modulus: f64,
}

/// The contact modulus E* = √π/2 S/√A of the unloading stiffness: F = B (h − h_f)^m is fitted from 98 % to 20 % of the force at
/// the onset of unloading, S is its slope there, h_c = h − 0.75 F/S, and `area` is the area \[m²\] of the cross section of
/// the tip at the distance h_c \[m\] from its end: 2πR h_c for a paraboloid, 24.5 h_c² for a Berkovich pyramid.
///
/// On a creeping body the depth still grows as the force begins to fall, or the force falls by relaxation too: S is too large,
/// and negative where unloading is slow. A long hold before a fast unloading helps.
///
/// ```
/// use std::f64::consts::PI;
/// use viscocontact::states::ElasticStates;
/// use viscocontact_identify::usual::oliver_pharr;
/// use viscocontact_identify::{Curve, Experiment, Protocol};
///
/// let tip = ElasticStates::sphere(10.0e-6)?;
/// let protocol = Protocol::trapezoid(0.2e-6, [1.0, 1.0, 1.0], 0.01)?;
/// let force = protocol.drive().iter().map(|&depth| 3.0e9 * tip.level_at(depth)).collect();
/// let curve = Curve::new(Experiment::new(protocol, tip), force)?;
/// let read = oliver_pharr(&curve, 0.0, |depth| 2.0 * PI * 10.0e-6 * depth)?;
/// assert!((read.modulus / 3.0e9 - 1.0).abs() < 1e-3);
/// # Ok::<(), viscocontact_identify::Error>(())
/// ```
///
/// # Errors
/// If fewer than five points unload, or stiffness or area are not positive.
pub fn oliver_pharr(curve: &Curve, contact_point: f64, area: impl Fn(f64) -> f64) -> Result<OliverPharr> {
    let (depth, force) = (depths(curve, contact_point), curve.force());
    let onset = curve.hold().1;
    let greatest = positive("force at the onset of unloading", force[onset])?;
    let is_fitted = |force: f64| (UNLOADING[1] * greatest..=UNLOADING[0] * greatest).contains(&force);
    let end = (onset..force.len()).find(|&k| force[k] < UNLOADING[1] * greatest).unwrap_or(force.len());
    let fitted: Vec<usize> = (onset..end).filter(|&k| is_fitted(force[k])).collect();
    enough(fitted.len())?;
    let lowest = fitted.iter().map(|&k| depth[k]).fold(f64::INFINITY, f64::min);
    let range = positive("depth unloaded", depth[onset] - lowest)?;
    let logs: Vec<f64> = fitted.iter().map(|&k| force[k].ln()).collect();
    // h_f below the lowest depth by some factor of the range of depths
    let power = |below: f64| {
        let rest = lowest - range * below.exp();
        (rest, line(&fitted.iter().map(|&k| (depth[k] - rest).ln()).collect::<Vec<_>>(), &logs, true))
    };
    let (rest, [intercept, exponent, _]) = power(minimum(-7.0, 4.0, POINTS, |below| power(below).1[2]));
    let stiffness = exponent * (intercept + (exponent - 1.0) * (depth[onset] - rest).ln()).exp();
    positive("stiffness at the onset of unloading", stiffness)?;
    let contact_depth = positive("contact depth", depth[onset] - EPSILON * greatest / stiffness)?;
    let area = positive("area at the contact depth", area(contact_depth))?;
    Ok(OliverPharr { stiffness, contact_depth, area, modulus: 0.5 * PI.sqrt() * stiffness / area.sqrt() })
}

/// How a ramp of the time t_R before a hold is taken into account.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RampCorrection {
    /// Not at all: an ideal step at the end of the ramp.
    Step,
    /// An ideal step in the middle of the ramp (L. J. Zapas, J. C. Phillips, J. Res. Natl. Bur. Stand. 75A (1971) 33).
    HalfRamp,
    /// Coefficients divided by (τ/t_R) (e^(t_R/τ) − 1), which is exact for a level that grows linearly in time (J. M. Mattice
    /// et al., J. Mater. Res. 21 (2006) 2003).
    Factor,
}

/// The relaxation modulus E∞ + (E₀ − E∞) e^(−t/τ) of a hold, see [`hold_relaxation`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct HoldRelaxation {
    /// Equilibrium contact modulus E∞ \[Pa\].
    pub equilibrium: f64,
    /// Glassy contact modulus E₀ \[Pa\].
    pub glassy: f64,
    /// Relaxation time τ \[s\].
    pub time: f64,
}

/// The relaxation modulus of a hold as F(t)/l(δ(t)), where l is the level of the elastic states: right after an ideal step of the
/// depth. One exponential is fitted to it over the hold of the maximum drive. The tip touches at the drive `contact_point` \[m\].
///
/// # Errors
/// If the hold has fewer than five points, or the depth is not positive there; [`Error::BeyondStates`].
pub fn hold_relaxation(curve: &Curve, contact_point: f64, correction: RampCorrection) -> Result<HoldRelaxation> {
    let (depth, times, drive) =
        (depths(curve, contact_point), curve.experiment.protocol.times(), curve.experiment.protocol.drive());
    let (start, end) = curve.hold();
    enough(end + 1 - start)?;
    let level = |k: usize| curve.experiment.level_within(positive("depth in the hold", depth[k])?);
    let modulus = |k: usize| Ok(curve.force[k] / level(k)?);
    let moduli: Vec<f64> = (start..=end).map(modulus).collect::<Result<_>>()?;
    let ages: Vec<f64> = times[start..=end].iter().map(|time| time - times[start]).collect();
    let decay = |log_time: f64| -> Vec<f64> { ages.iter().map(|age| (-age * (-log_time).exp()).exp()).collect() };
    let fit = |log_time: f64| line(&decay(log_time), &moduli, true);
    let time = minimum((0.5 * ages[1]).ln(), (10.0 * ages[ages.len() - 1]).ln(), POINTS, |log_time| fit(log_time)[2]);
    let ([equilibrium, at_end, _], time) = (fit(time), time.exp());
    let touch = (0..start).find(|&k| drive[k + 1] > contact_point).unwrap_or_default();
    // the drive is linear in time around the first touch
    let share = (contact_point - drive[touch]) / (drive[touch + 1] - drive[touch]);
    let touched = times[touch] + share.clamp(0.0, 1.0) * (times[touch + 1] - times[touch]);
    // a jump at the first time has none
    let ramp = ((times[start] - touched) / time).max(f64::MIN_POSITIVE);
    let factor = match correction {
        RampCorrection::Step => 1.0,
        RampCorrection::HalfRamp => (0.5 * ramp).exp(),
        RampCorrection::Factor => ramp / -(-ramp).exp_m1(),
    };
    Ok(HoldRelaxation { equilibrium, glassy: equilibrium + at_end * factor, time })
}

/// The elastic law F = F₀ + E* l(δ) fitted to a loading curve, see [`loading_modulus`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct LoadingModulus {
    /// Contact modulus E* \[Pa\].
    pub modulus: f64,
    /// Force without contact F₀ \[N\].
    pub offset: f64,
    /// Drive at which the tip touches first \[m\].
    pub contact_point: f64,
}

/// The elastic law F = F₀ + E* l(δ) of the states of the tip, fitted by least squares to the curve up to the maximum drive: for
/// a sphere the law of Hertz, for a cone the law of Sneddon. The contact point is fitted too, unless it is given \[m\].
///
/// On a creeping body E* is a modulus of the time of loading: it depends on the speed, and the contact point moves to make up for
/// the shape of the curve.
///
/// # Errors
/// If the loading has fewer than five points; [`Error::BeyondStates`]; [`Error::NoContact`] where the force does not rise with the depth.
pub fn loading_modulus(curve: &Curve, contact_point: Option<f64>) -> Result<LoadingModulus> {
    let end = curve.hold().0;
    enough(end + 1)?;
    let give = 1.0 / curve.experiment.stiffness;
    let contact_point = contact_point.unwrap_or_else(|| curve.elastic_contact_point(give, true));
    curve.experiment.level_within(range(&depths(curve, contact_point)[..=end])[1])?;
    let [offset, modulus, sum] = curve.elastic_law(contact_point, give, true);
    let law = LoadingModulus { modulus, offset, contact_point };
    sum.is_finite().then_some(law).ok_or(Error::NoContact { curve: 0 })
}

/// Depth at each time \[m\].
fn depths(curve: &Curve, contact_point: f64) -> Vec<f64> {
    let experiment = &curve.experiment;
    let depth = |(drive, force): (&f64, &f64)| drive - contact_point - force / experiment.stiffness;
    experiment.protocol.drive().iter().zip(&curve.force).map(depth).collect()
}

fn enough(points: usize) -> Result<()> {
    count_within("points that are read", points, points >= LEAST_POINTS, "5 or more: measure at a higher rate")
}
