use std::f64::consts::FRAC_PI_4;

use super::{Bodies, Jkr};
use crate::error::{Error, Result, StepError, length, non_negative, positive, within};
use crate::quadrature::{GaussLegendre, bisect};
use crate::rheology::{CreepSpectrum, Material};

/// The edge of a contact that opens at a speed v on a creeping body, under an attraction of the range ρ.
///
/// The bodies open within a zone of the length α at the edge. A point of the zone passes it in the time α/v, and
/// feels the body as stiff as the body is over this time. With a constant traction over the zone (Dugdale's law) the
/// opening of a point is a hereditary integral of the elastic one, and its work is w (Schapery, Int. J. Fract. 11,
/// 1975; Greenwood, J. Phys. D 37, 2004):
///
/// 1/y = ∫₀¹ C((1 − ξ) α/v)/C(∞) · ½ ln((1 + √ξ)/(1 − √ξ)) dξ, α = z y l, l = E*ρ²/w, z = π/4.
///
/// y w is the work that the opening of a unit of area takes, E* the relaxed contact modulus 1/C(∞). So y goes from 1
/// (slow) to C(∞)/C(0) (fast), and follows from v over l and the creep alone: the range of an attraction is a length
/// of the material. The rest of the body has to be relaxed: l and the contact pass in times that differ.
///
/// ```
/// use viscocontact::analytic::OpeningEdge;
/// use viscocontact::rheology::{GeneralizedMaxwell, Material};
///
/// // E* from 1 MPa at once to 0.1 MPa, w = 0.1 J/m², ρ = 1 µm: l = 1 µm
/// let gel = Material::incompressible(GeneralizedMaxwell::new(25.0e3, &[(225.0e3, 1.0)])?);
/// let edge = OpeningEdge::new(&gel, 0.1, 1.0e-6)?;
/// assert!((edge.length() / 1.0e-6 - 1.0).abs() < 1e-12);
/// assert!((edge.work(0.0)? / 0.1 - 1.0).abs() < 1e-9 && (edge.work(1.0)? / 1.0 - 1.0).abs() < 1e-3);
/// let [slow, fast] = [1.0e-8, 1.0e-5].map(|speed| edge.pull_off(1.0e-3, 30.0e-6, speed));
/// assert!(fast?.force < slow?.force);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct OpeningEdge {
    creep: CreepSpectrum,
    /// C(∞) \[1/Pa\].
    relaxed: f64,
    work: f64,
    range: f64,
    zone: f64,
    rule: GaussLegendre,
}

/// The state of a sphere at the maximum pull, of [`OpeningEdge::pull_off`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PullOff {
    /// Force, < 0 \[N\].
    pub force: f64,
    /// Approach \[m\].
    pub approach: f64,
    /// Contact radius \[m\].
    pub contact_radius: f64,
    /// Speed of the edge \[m/s\].
    pub edge_speed: f64,
    /// Work that opens a unit of area \[J/m²\].
    pub work: f64,
    /// V τ over R^⅓ (w/E*)^⅔, with the longest relaxation time τ: the theory holds within 4 % up to 0.03, within 7 % at
    /// 0.1, and pulls too much beyond.
    pub lag: f64,
}

/// z of a constant traction, π/4.
const CONSTANT_TRACTION: f64 = FRAC_PI_4;
/// Points of the integral over the zone.
const POINTS: usize = 48;
/// Halvings of an interval that holds a root.
const HALVINGS: usize = 48;
/// The logarithm of the passage of a zone over the shortest and the longest time of the body is sought between minus
/// and plus so much.
const BEYOND: f64 = 100.0;
/// Steps of the contact radius, geometric down to a thousandth.
const STEPS: usize = 1000;
const LEAST_RADIUS: f64 = 1e-3;

impl OpeningEdge {
    /// The edge of a contact with the body of `material` by an attraction of `work` w \[J/m²\] and `range` ρ \[m\].
    ///
    /// # Errors
    /// If work or range is not finite and positive, or the material has no exponential series, no elastic response or
    /// flows without limit.
    pub fn new(material: &Material, work: f64, range: f64) -> Result<OpeningEdge> {
        let what = "the theory of an opening edge";
        positive("work of separation", work)?;
        length("range of the attraction", range)?;
        let creep = material.spectrum_for(what)?;
        if creep.glassy() == 0.0 {
            return Err(Error::Step(StepError::NoElasticResponse { time: 0.0, what }));
        }
        let fluidity = creep.fluidity();
        within(
            "fluidity of the body",
            fluidity,
            fluidity == 0.0,
            "0 for an opening edge, which needs a relaxed modulus",
        )?;
        let relaxed = creep.compliance(f64::INFINITY);
        positive("length of the zone", range * range / (relaxed * work))?;
        let rule = GaussLegendre::new(POINTS);
        Ok(OpeningEdge { creep, relaxed, work, range, zone: CONSTANT_TRACTION, rule })
    }

    /// The same with z in place of π/4, for laws other than Dugdale's: about 1.4 for
    /// [`ExponentialAttraction`](crate::adhesion::ExponentialAttraction), fitted to pull-off forces that this crate computes
    /// (docs/maintainers/claims.md).
    ///
    /// # Errors
    /// If z is not within \[0.01, 100\].
    pub fn with_zone(mut self, zone: f64) -> Result<OpeningEdge> {
        self.zone = within("length of the zone over y l", zone, (0.01..=100.0).contains(&zone), "in [0.01, 100]")?;
        Ok(self)
    }

    /// The length l = E*ρ²/w of the relaxed body \[m\]: what counts is v τ/l, with the times τ of the body.
    pub fn length(&self) -> f64 {
        self.range / self.work * self.range / self.relaxed
    }

    /// The work that opens a unit of area at the `speed` v ≥ 0 of the edge \[m/s\], in J/m².
    ///
    /// # Errors
    /// If the speed is not finite and at least 0.
    pub fn work(&self, speed: f64) -> Result<f64> {
        non_negative("speed of the edge", speed)?;
        Ok(self.opening(|[edge_speed, _]| edge_speed > speed)[1])
    }

    /// A sphere of `radius` R \[m\] that rested at an `approach` ω \[m\] until the body was relaxed, and is pulled
    /// back at the constant `speed` V of the approach \[m/s\]: its state at the maximum pull. With the contact
    /// radius a and the relaxed bulk of the body
    ///
    /// W = 4E*a³/3R − √(8π y w E* a³), ω = a²/R − √(2π y w a/E*), da/dt = −v(y),
    ///
    /// as long as the contact takes longer than the body to change: V τ ≪ ω.
    ///
    /// # Errors
    /// If radius or speed is not finite and positive, or no contact has this approach at rest.
    pub fn pull_off(&self, radius: f64, approach: f64, speed: f64) -> Result<PullOff> {
        let sphere = Jkr::new(radius, 1.0 / self.relaxed, self.work)?;
        positive("speed", speed)?;
        let least = sphere.radius_at_min_approach();
        let [_, farthest] = sphere.state(least);
        within("approach", approach, approach > farthest, "above the one at which the relaxed contact separates")?;
        let most = 4.0 * (least + (radius * approach.abs()).sqrt());
        let start = bisect(least, most, HALVINGS, |a| sphere.state(a)[1] < approach)[1];
        // implicit steps err by their length: twice the finer ones less the coarser ones errs by its square
        let [coarse, fine] = [STEPS, 2 * STEPS].map(|steps| self.greatest_pull(radius, start, approach, speed, steps));
        let [force, approach, contact_radius, edge_speed, work] = std::array::from_fn(|k| 2.0 * fine[k] - coarse[k]);
        let slowest = self.creep.relaxation().terms().iter().fold(0.0, |slowest, &(_, time)| time.max(slowest));
        let lag = speed * slowest / (radius.cbrt() * (self.work * self.relaxed).powf(2.0 / 3.0));
        Ok(PullOff { force, approach, contact_radius, edge_speed, work, lag })
    }

    /// Speed v of the edge and work y w where points pass the zone in `passage` α/v.
    fn at(&self, passage: f64) -> [f64; 2] {
        // ξ = η² and η = 1 − s⁴ take the root at ξ = 0 and the logarithm at ξ = 1
        let mean = self.rule.integrate(0.0, 1.0, |s| {
            let left = s.powi(4);
            let weight = 4.0 * s.powi(3) * (1.0 - left) * ((2.0 - left) / left).ln();
            weight * self.creep.compliance(left * (2.0 - left) * passage)
        });
        let stiffening = self.relaxed / mean;
        [self.zone * stiffening * self.length() / passage, stiffening * self.work]
    }

    /// Speed and work of the slowest edge of which `is_fast` holds: both grow while the passage of the zone shortens.
    fn opening(&self, is_fast: impl Fn([f64; 2]) -> bool) -> [f64; 2] {
        let times = || self.creep.terms().iter().map(|&(_, time)| time.ln());
        let [shortest, longest] = [times().fold(0.0, f64::min) - BEYOND, times().fold(0.0, f64::max) + BEYOND];
        let [passage, _] = bisect(shortest, longest, HALVINGS, |passage| is_fast(self.at(passage.exp())));
        self.at(passage.exp())
    }

    /// Force, approach, contact radius, speed of the edge and work at the maximum pull, by implicit steps of the
    /// contact radius from radius and approach at rest on.
    fn greatest_pull(&self, radius: f64, start: f64, at_rest: f64, speed: f64, steps: usize) -> [f64; 5] {
        // of the relaxed body, at another work of separation
        let state = |a: f64, work: f64| Jkr(Bodies { length: radius, modulus: 1.0 / self.relaxed, work }).state(a);
        let ratio = LEAST_RADIUS.powf(1.0 / steps as f64);
        let mut path = vec![[state(start, self.work)[0], at_rest, start, 0.0, self.work]];
        for a in (1..=steps).map(|k| start * ratio.powi(k as i32)) {
            let [_, before, a_before, ..] = path[path.len() - 1];
            // while the edge takes the way a_before − a, the approach falls by V over its speed
            let is_left =
                |[edge_speed, work]: [f64; 2]| state(a, work)[1] < before - speed * (a_before - a) / edge_speed;
            let [edge_speed, work] = self.opening(is_left);
            let [force, approach] = state(a, work);
            path.push([force, approach, a, edge_speed, work]);
            // the greatest pull is passed, or the edge runs away faster than the body answers
            let is_passed = force > path[path.len() - 2][0];
            if is_passed || !is_left([edge_speed, work]) {
                break;
            }
        }
        least_of(&path)
    }
}

/// The least first number of a path, by a parabola through three points, with the other numbers there.
fn least_of(path: &[[f64; 5]]) -> [f64; 5] {
    let Some(&[first, middle, last]) = path.windows(3).last().and_then(|three| three.first_chunk()) else {
        return path[path.len() - 1];
    };
    let bend = first[0] - 2.0 * middle[0] + last[0];
    let place = if bend > 0.0 { (0.5 * (first[0] - last[0]) / bend).clamp(-1.0, 1.0) } else { 1.0 };
    std::array::from_fn(|k| {
        middle[k] + 0.5 * place * (last[k] - first[k]) + 0.5 * place * place * (first[k] - 2.0 * middle[k] + last[k])
    })
}
