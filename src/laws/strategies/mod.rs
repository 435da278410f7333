//! Random valid models, as strategies of [`proptest`](https://docs.rs/proptest).
//!
//! Each takes the scales of its models, finite, positive and within 1e±50, so that they suit the scenario of a test.
//! The simplest models come first: failures shrink towards them.

use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

use proptest::prelude::*;
use proptest::strategy::Union;

use crate::adhesion::{Attraction, Dugdale, ExponentialAttraction, LinearSoftening, VanDerWaals};
use crate::error::Result;
use crate::geometry::{
    Cone, Cylinder, Ellipsoid, FlatPunch, Geometry, HeightMap, Repeated, Shifted, Sphere, Sum, Wavy,
};
use crate::load::LoadHistory;
use crate::rheology::{
    Burgers, CreepSpectrum, Elastic, FractionalMaxwell, FractionalZener, GeneralizedKelvin, GeneralizedMaxwell,
    KelvinVoigt, Kww, LogCreep, Maxwell, PowerLaw, PronyTerm, Rheology, SlowCreep, Zener,
};

mod histories;
mod scenarios;

pub use histories::{histories, loads};
pub use scenarios::{Scenario, scenarios};

/// Values within a decade of `scale`, in its unit.
fn around(scale: f64) -> impl Strategy<Value = f64> + Clone {
    (-1.0..1.0_f64).prop_map(move |exponent| scale * 10f64.powf(exponent))
}

/// The models that a constructor accepts: it may refuse scales that are too far apart.
fn built<I, T>(
    numbers: impl Strategy<Value = I> + 'static,
    build: impl Fn(I) -> Result<T> + 'static,
) -> BoxedStrategy<T>
where
    I: std::fmt::Debug + 'static,
    T: std::fmt::Debug + 'static,
{
    numbers.prop_filter_map("refused by its constructor", move |numbers| build(numbers).ok()).boxed()
}

/// Models of a trait, by their numbers and constructor.
macro_rules! models {
    ($($name:ident: $model:ident,)*) => {$(
        fn $name<I: std::fmt::Debug + 'static, M: $model + 'static>(
            numbers: impl Strategy<Value = I> + 'static,
            build: impl Fn(I) -> Result<M> + 'static,
        ) -> BoxedStrategy<Arc<dyn $model>> {
            built(numbers, move |numbers| Ok(Arc::new(build(numbers)?) as Arc<dyn $model>))
        }
    )*};
}
models! {
    body: Rheology, shape: Geometry, law: Attraction, history: LoadHistory,
}

/// Every rheology of the crate that has a formula, with moduli around `modulus` \[Pa\] and times around `time` \[s\].
pub fn rheologies(modulus: f64, time: f64) -> impl Strategy<Value = Arc<dyn Rheology>> {
    let (g, t, exponent) = (around(modulus), around(time), 0.05..0.95_f64);
    let eta = around(modulus * time);
    let compliance = around(1.0 / modulus);
    let kelvin = prop::collection::vec((compliance.clone(), t.clone()), 1..5);
    let maxwell = prop::collection::vec((g.clone(), t.clone()), 1..5);
    let zero_or = |scale: f64| prop_oneof![Just(0.0), around(scale)];
    Union::new([
        body(g.clone(), Elastic::new),
        body((g.clone(), eta.clone()), |(g, eta)| Maxwell::new(g, eta)),
        body((g.clone(), eta.clone()), |(g, eta)| KelvinVoigt::new(g, eta)),
        body((g.clone(), g.clone(), eta.clone()), |(g, slow, eta)| Zener::new(g, slow, eta)),
        body((g.clone(), eta.clone(), g.clone(), eta), |(g, eta, slow, own)| Burgers::new(g, eta, slow, own)),
        body((g.clone(), t.clone()), |(g, t)| Maxwell::with_time(g, t)),
        body((g.clone(), t.clone()), |(g, t)| KelvinVoigt::with_time(g, t)),
        body((g.clone(), 0.001..0.9_f64, t.clone()), |(g, rest, t)| Zener::relaxing(g, rest * g, t)),
        body((g.clone(), t.clone(), g.clone(), t.clone()), |(g, t, slow, own)| {
            Burgers::with_times((g, t), (slow, own))
        }),
        body((zero_or(1.0 / modulus), zero_or(1.0 / (modulus * time)), kelvin), |(glassy, flow, terms)| {
            GeneralizedKelvin::new(glassy, flow, &terms)
        }),
        body((zero_or(modulus), maxwell), |(rest, terms)| GeneralizedMaxwell::new(rest, &terms)),
        body((g.clone(), prop::collection::vec((0.01..0.2_f64, t.clone()), 1..5)), |(g, terms)| {
            let terms: Vec<_> = terms.into_iter().map(|(share, time)| PronyTerm { share, time }).collect();
            GeneralizedMaxwell::prony(g, &terms)
        }),
        body((compliance.clone(), t.clone(), exponent.clone()), |(j, t, n)| PowerLaw::new(j, t, n)),
        body((g.clone(), around(modulus * time.powf(0.5)), exponent.clone()), |(g, v, n)| {
            FractionalMaxwell::new(g, v, n)
        }),
        body((g.clone(), t.clone(), exponent.clone()), |(g, t, n)| FractionalMaxwell::with_time(g, t, n)),
        body((g.clone(), 0.001..0.9_f64, t.clone(), exponent.clone()), |(g, rest, t, n)| {
            FractionalZener::new(g, rest * g, t, n)
        }),
        body((g, 0.01..0.9_f64, t.clone(), 0.3..0.95_f64), |(g, rest, t, n)| {
            FractionalZener::relaxing(g, rest * g, t, n)
        }),
        body((compliance.clone(), compliance.clone(), t.clone(), exponent.clone()), |(j, rise, t, n)| {
            Kww::new(j, rise, t, n)
        }),
        body((compliance.clone(), compliance.clone(), t.clone()), |(j, rise, t)| LogCreep::new(j, rise, t)),
        body((compliance.clone(), compliance, t, exponent), |(j, rise, t, n)| SlowCreep::new(j, rise, t, n)),
    ])
}

/// Creep spectra of solids and fluids, with an elastic response, of up to five terms around 1/`modulus` \[1/Pa\] and
/// `time` \[s\].
pub fn spectra(modulus: f64, time: f64) -> impl Strategy<Value = CreepSpectrum> {
    let fluidity = prop_oneof![Just(0.0), around(0.3 / (modulus * time))];
    let terms = prop::collection::vec((around(1.0 / modulus), around(time)), 0..5);
    built((around(1.0 / modulus), fluidity, terms), |(glassy, fluidity, terms)| {
        CreepSpectrum::new(glassy, fluidity, &terms)
    })
}

/// Every attraction of the crate, with works of separation around `work` \[J/m²\] and ranges around `range` \[m\].
pub fn attractions(work: f64, range: f64) -> impl Strategy<Value = Arc<dyn Attraction>> {
    let scales = (around(work), around(range));
    let width = (around(work), around(range), 0.01..2.0_f64);
    Union::new([
        law(scales.clone(), |(work, range)| ExponentialAttraction::new(work, range)),
        law(scales.clone(), |(work, range)| LinearSoftening::new(work, range)),
        law(scales, |(work, range)| VanDerWaals::new(work, range)),
        law(width, |(work, range, width)| Dugdale::new(work, range)?.with_width(width)),
    ])
}

/// Indenters with a formula, alone, superposed, shifted and repeated, that touch within `length` \[m\] of the origin.
/// At that distance their gap is up to about a tenth of it.
pub fn geometries(length: f64) -> impl Strategy<Value = Arc<dyn Geometry>> {
    let radius = around(5.0 * length);
    let wave = (around(1e-3 * length), (0.3..3.0_f64).prop_map(move |part| part * length));
    let face = (0.4..1.0_f64).prop_map(move |part| part * length);
    let single = Union::new([
        shape(radius.clone(), Sphere::new),
        shape((radius.clone(), radius.clone()), |(r1, r2)| Ellipsoid::new(r1, r2)),
        shape(radius.clone(), Cylinder::new),
        shape((0.01..0.5_f64).prop_map(|part| (part * FRAC_PI_4).tan()), Cone::new),
        shape(face.clone(), FlatPunch::circular),
        shape((face.clone(), face), |(a, b)| FlatPunch::rectangular([2.0 * a, 2.0 * b])),
        shape(wave.clone(), |(height, wavelength)| Wavy::new(height, wavelength)),
        shape((wave.clone(), wave.clone()), |(first, second)| {
            Wavy::in_two_directions([first.0, second.0], [first.1, second.1])
        }),
        shape((radius, wave), |(r, (height, wavelength))| {
            Ok(Sum::new(Sphere::new(r)?, Wavy::new(height, wavelength)?))
        }),
    ])
    .boxed();
    let moved = shape((single.clone(), [-0.2..0.2_f64, -0.2..0.2_f64]), move |(shape, by)| {
        Shifted::new(shape, by.map(|part| part * length))
    });
    let periods = [1.5..3.0_f64, 1.5..3.0_f64];
    let repeated = shape((single.clone(), periods), move |(shape, periods)| {
        Repeated::new(shape, periods.map(|part| part * length))
    });
    prop_oneof![4 => single, 1 => moved, 1 => repeated]
}

/// Maps of random heights within ±`height` \[m\] on 1 to 24 points per side of a square of `length` \[m\], half of them
/// periodic.
pub fn height_maps(length: f64, height: f64) -> impl Strategy<Value = HeightMap> {
    ([1_usize..24, 1_usize..24], any::<bool>()).prop_flat_map(move |(cells, periodic)| {
        let heights = prop::collection::vec((-1.0..1.0_f64).prop_map(move |part| part * height), cells[0] * cells[1]);
        built(heights, move |heights| {
            let map = HeightMap::new(cells, [length; 2], heights)?;
            Ok(if periodic { map.periodic() } else { map })
        })
    })
}
