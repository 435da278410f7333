use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use crate::error::{Error, Result, StepError, count_within, finite, length, non_negative, positive};
use crate::hereditary::{ExponentialRule, Interpolant, RememberedField};
use crate::memory;
use crate::parallel::Rows;
use crate::rheology::{Material, is_known};

/// The profile g(x) on a one-dimensional foundation that is equivalent to an axisymmetric indenter f(r):
/// g(x) = |x| ∫ f′(r)/√(x² − r²) dr over 0 < r < |x|.
#[derive(Clone)]
pub struct Profile {
    depth: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
}

impl Profile {
    /// A sphere of `radius` R \[m\]: g = x²/R.
    ///
    /// # Errors
    /// If the radius is not finite and positive.
    pub fn sphere(radius: f64) -> Result<Profile> {
        positive("sphere radius", radius)?;
        Ok(Profile::new(move |x| x * x / radius))
    }

    /// A cone with slope `tan_beta`: g = (π/2) x tan β.
    ///
    /// # Errors
    /// If the slope is not finite and positive.
    pub fn cone(tan_beta: f64) -> Result<Profile> {
        positive("cone slope tan β", tan_beta)?;
        Ok(Profile::new(move |x| 0.5 * PI * x * tan_beta))
    }

    /// A flat circular punch of `radius` \[m\]: g = 0 on the face, +∞ off it.
    ///
    /// # Errors
    /// If the radius is not finite and positive.
    pub fn punch(radius: f64) -> Result<Profile> {
        positive("punch radius", radius)?;
        Ok(Profile::new(move |x| if x <= radius { 0.0 } else { f64::INFINITY }))
    }

    /// Any other g(x) for x ≥ 0 \[m\].
    pub fn new(depth: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Profile {
        Profile { depth: Arc::new(depth) }
    }
}

impl fmt::Debug for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Profile").finish_non_exhaustive()
    }
}

/// An axisymmetric indenter on a viscoelastic half-space under any history of force or approach,
/// loading, holding, unloading and loading again, by the method of dimensionality reduction (Popov &
/// Heß, *Method of Dimensionality Reduction in Contact Mechanics and Friction*, 2015; for viscoelastic
/// bodies also Greenwood, Int. J. Mech. Sci. 52, 2010).
///
/// A row of independent elements, each with the relaxation modulus E(t) per unit length, is indented by
/// the profile g(x). Force, approach and contact radius equal their three-dimensional values, as
/// long as the contact is a single circle; the pressure follows from the line load q by Abel's integral.
/// In time it advances by the exponential rule, third order in the step, second where elements come into
/// contact again and for bodies without elastic response; in space it is second order in the width of the
/// elements: choose both fine.
///
/// ```
/// use viscocontact::analytic::{AxisymmetricContact, Hertz, Profile};
/// use viscocontact::rheology::{Elastic, Material};
///
/// let body = Material::incompressible(Elastic::new(1.0e6)?);
/// let mut contact = AxisymmetricContact::new(&Profile::sphere(10.0e-3)?, &body, 4000, 2.0e-3)?;
/// contact.press(0.0, 1.0)?;
/// let hertz = Hertz::new(10.0e-3, 4.0e6, 1.0)?;
/// assert!((contact.approach() / hertz.approach - 1.0).abs() < 1e-6);
/// assert!((contact.contact_radius() / hertz.contact_radius - 1.0).abs() < 1e-6);
/// assert!((contact.pressure(0.0) / hertz.max_pressure - 1.0).abs() < 1e-6);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone)]
pub struct AxisymmetricContact {
    /// Width of an element; the k-th is centred on (k + ½) width.
    width: f64,
    profile: Vec<f64>,
    known_until: f64,
    time: f64,
    approach: f64,
    rule: ExponentialRule,
    displacement: RememberedField,
    /// Line load q \[N/m\].
    load: Vec<f64>,
    /// g + u_old: the approach at which each element comes into contact, in the last step and in the current one.
    touch: Vec<f64>,
    trial_touch: Vec<f64>,
}

impl AxisymmetricContact {
    /// A foundation of `elements` elements from the axis to `reach` \[m\], undisturbed and without load.
    ///
    /// # Errors
    /// If there are no elements, the reach is not positive or more than 1e300 m, no value of the profile is finite or
    /// one is NaN or −∞, or the material has no exponential series. If there is not enough memory for the elements.
    pub fn new(profile: &Profile, material: &Material, elements: usize, reach: f64) -> Result<AxisymmetricContact> {
        count_within("elements", elements, elements > 0, "1 or more")?;
        length("reach of the foundation", reach)?;
        let creep = material.contact_spectrum()?.ok_or_else(|| material.no_series("the one-dimensional foundation"))?;
        let width = reach / elements as f64;
        let rule = ExponentialRule::new(&creep);
        // six fields, a difference of one or two, and the recursion
        memory::check("a foundation", (64 + 8 * rule.branches()) as u128 * elements as u128)?;
        let depths: Vec<f64> = (0..elements).map(|k| (profile.depth)((k as f64 + 0.5) * width)).collect();
        for &depth in depths.iter().filter(|depth| **depth != f64::INFINITY) {
            finite("profile", depth)?;
        }
        let approach = depths.iter().copied().fold(f64::INFINITY, f64::min);
        if approach == f64::INFINITY {
            return Err(Error::NothingToTouch { body: 0, cells: elements });
        }
        Ok(AxisymmetricContact {
            width,
            profile: depths,
            known_until: material.known_until(),
            time: 0.0,
            approach,
            displacement: RememberedField::new(rule.branches(), elements),
            rule,
            load: vec![0.0; elements],
            touch: vec![0.0; elements],
            trial_touch: vec![0.0; elements],
        })
    }

    /// Advances by `dt` \[s\] to the force `force` \[N\]; `dt` = 0 is a jump.
    ///
    /// # Errors
    /// If `dt` or the force is negative or not finite, `dt` = 0 and the body has no elastic response, or
    /// the contact reaches the end of the foundation.
    pub fn press(&mut self, dt: f64, force: f64) -> Result<()> {
        non_negative("force", force)?;
        let c = self.predict(dt)?;
        // 2 width Σ max(0, ω − touch)/c = W: convex and piecewise linear, Newton from the right ends
        let wanted = force * c / (2.0 * self.width);
        let lowest = self.trial_touch.iter().copied().fold(f64::INFINITY, f64::min);
        let mut approach = lowest + wanted;
        loop {
            let touched = self.trial_touch.iter().filter(|&&touch| touch < approach);
            let (count, sum) = touched.fold((0, 0.0), |(count, sum), touch| (count + 1, sum + (touch - lowest)));
            let next = if count == 0 { lowest } else { lowest + (wanted + sum) / count as f64 };
            if next >= approach {
                break;
            }
            approach = next;
        }
        self.accept(dt, c, approach)
    }

    /// Advances by `dt` \[s\] to the approach `approach` \[m\]; `dt` = 0 is a jump.
    ///
    /// # Errors
    /// If `dt` is negative, a number not finite, `dt` = 0 and the body has no elastic response, or the
    /// contact reaches the end of the foundation.
    pub fn indent(&mut self, dt: f64, approach: f64) -> Result<()> {
        finite("approach", approach)?;
        let c = self.predict(dt)?;
        self.accept(dt, c, approach)
    }

    fn predict(&mut self, dt: f64) -> Result<f64> {
        non_negative("time step", dt)?;
        let (time, known_until) = (self.time + dt, self.known_until);
        if !is_known(time, known_until) {
            return Err(Error::Step(StepError::BeyondMaterial { time, age: time, known_until }));
        }
        let rows = Rows::all([self.profile.len(), 1]);
        self.rule.compute_weights(dt, Interpolant::CorrectedLinear);
        self.displacement.predict_non_negative(&mut self.rule, self.width, &rows, || true);
        let c = self.rule.compliance();
        if c == 0.0 && dt == 0.0 {
            return Err(Error::Step(StepError::NoElasticResponse { time, what: "a jump of the foundation" }));
        }
        for ((touch, &g), &u_old) in self.trial_touch.iter_mut().zip(&self.profile).zip(self.displacement.trial()) {
            *touch = g + u_old;
        }
        Ok(c)
    }

    fn accept(&mut self, dt: f64, c: f64, approach: f64) -> Result<()> {
        let time = self.time + dt;
        if self.trial_touch.last().is_some_and(|&touch| touch < approach) {
            return Err(Error::Step(StepError::BeyondReach { time, reach: self.width * self.load.len() as f64 }));
        }
        let load = |touch: &f64| (approach - touch).max(0.0) / c;
        let force = self.trial_touch.iter().map(load).sum::<f64>() * self.width;
        let displacement = self.displacement.trial().iter().sum::<f64>();
        let overflow = |what| Err(Error::Step(StepError::Overflow { time, what }));
        if !(approach.is_finite() && c.is_finite()) {
            return overflow("the approach");
        }
        if !(force.is_finite() && displacement.is_finite()) {
            return overflow("the force");
        }
        self.load.iter_mut().zip(&self.trial_touch).for_each(|(q, touch)| *q = load(touch));
        self.displacement.add(c, &self.load);
        self.rule.commit();
        self.displacement.commit();
        std::mem::swap(&mut self.touch, &mut self.trial_touch);
        (self.time, self.approach) = (time, approach);
        Ok(())
    }

    /// Time \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Approach ω \[m\].
    pub fn approach(&self) -> f64 {
        self.approach
    }

    /// Force \[N\].
    pub fn force(&self) -> f64 {
        2.0 * self.width * self.load.iter().sum::<f64>()
    }

    /// Contact radius \[m\], to a fraction of an element: where the line load, continued linearly, vanishes.
    pub fn contact_radius(&self) -> f64 {
        let Some(last) = self.load.iter().rposition(|&q| q > 0.0) else { return 0.0 };
        let center = (last as f64 + 0.5) * self.width;
        let inside = self.approach - self.touch[last];
        match self.touch.get(last + 1).map(|touch| touch - self.approach) {
            Some(outside) if outside.is_finite() => center + self.width * inside / (inside + outside),
            _ => center + 0.5 * self.width,
        }
    }

    /// Pressure \[Pa\] at the distance `r` ≥ 0 from the axis \[m\]: −(1/π) ∫ q′(x)/√(x² − r²) dx over x > r,
    /// for q linear in x² between the elements and zero at the contact radius. Not for a punch, whose line
    /// load jumps there.
    pub fn pressure(&self, r: f64) -> f64 {
        let edge = self.contact_radius();
        let node = |k: usize| (k as f64 + 0.5) * self.width;
        let root = |x: f64| ((x - r) * (x + r)).max(0.0).sqrt();
        let mut sum = 0.0;
        for (k, &q) in self.load.iter().enumerate().take_while(|(_, q)| **q > 0.0) {
            let next = self.load.get(k + 1).copied().unwrap_or(0.0);
            let end = if next > 0.0 { node(k + 1) } else { edge };
            // the first piece reaches back to the axis
            let start = if k == 0 { 0.0 } else { node(k) };
            let slope = (q - next) / ((end - node(k)) * (end + node(k)));
            sum += 2.0 * slope * (root(end) - root(start));
        }
        sum / PI
    }
}

impl fmt::Debug for AxisymmetricContact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AxisymmetricContact")
            .field("elements", &self.load.len())
            .field("time", &self.time)
            .field("approach", &self.approach)
            .finish_non_exhaustive()
    }
}
