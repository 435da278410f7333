//! Observed orders of convergence on the one-dimensional foundation.

use std::f64::consts::PI;

use super::foundation::{Foundation, Given};
use super::{INTERPOLANTS, kelvin_voigt, zener};
use crate::hereditary::Interpolant;
use crate::rheology::{CreepSpectrum, Material, PowerLaw, Rheology};

const ELEMENTS: usize = 2000;
const FINE: usize = 1280;
const COARSE: [usize; 4] = [20, 40, 80, 160];

type History = fn(f64) -> Given;

/// The answers at the ends of equal steps.
fn run(body: &CreepSpectrum, history: History, until: f64, steps: usize, interpolant: Interpolant) -> Vec<f64> {
    let mut foundation = Foundation::new(body, ELEMENTS, interpolant);
    if body.glassy() > 0.0 {
        foundation.step(0.0, history(0.0));
    }
    let dt = until / steps as f64;
    (1..=steps).map(|step| foundation.step(dt, history(step as f64 * dt))).collect()
}

/// Orders between doubled numbers of steps: of the maximum errors after the first quarter.
fn orders(name: &str, body: &CreepSpectrum, history: History, until: f64, interpolant: Interpolant) -> [f64; 3] {
    let fine = run(body, history, until, FINE, Interpolant::CorrectedQuadratic);
    let size = fine.iter().copied().fold(0.0, f64::max);
    let errors = COARSE.map(|steps| {
        let own = run(body, history, until, steps, interpolant);
        let far = |step: usize| (own[step] - fine[(step + 1) * (FINE / steps) - 1]).abs() / size;
        (steps / 4..steps).map(far).fold(0.0, f64::max)
    });
    let orders = [0, 1, 2].map(|k| (errors[k] / errors[k + 1]).log2());
    println!("{name}, {interpolant:?}: errors {}, orders {orders:.2?}", errors.map(|e| format!("{e:.1e}")).join(" "));
    orders
}

fn growing(t: f64) -> Given {
    Given::Force(0.02 + 0.04 * (1.0 - (PI * t).cos()))
}

fn growing_and_receding(t: f64) -> Given {
    Given::Force(0.08 - 0.05 * (2.0 * PI * t).cos())
}

fn away_and_back(t: f64) -> Given {
    Given::Approach(0.4 * ((PI * t).sin().powi(2) + 0.1))
}

fn risen(t: f64) -> Given {
    Given::Force(0.1 * t * t * (3.0 - 2.0 * t))
}

#[test]
fn corrected_steps_are_of_third_and_fourth_order() {
    for (name, history) in [("growing", growing as History), ("growing and receding", growing_and_receding)] {
        let of = |interpolant| orders(name, &zener(), history, 1.0, interpolant);
        assert!(of(Interpolant::Linear).iter().all(|order| (1.9..2.1).contains(order)), "{name}");
        assert!(of(Interpolant::CorrectedLinear).iter().all(|order| *order > 2.75), "{name}");
        assert!(of(Interpolant::CorrectedQuadratic).iter().all(|order| *order > 3.5), "{name}");
    }
}

/// u has a kink where cells part and come into contact again.
#[test]
fn new_contact_is_met_with_second_order() {
    for interpolant in [Interpolant::CorrectedLinear, Interpolant::CorrectedQuadratic] {
        let orders = orders("away and back", &zener(), away_and_back, 2.0, interpolant);
        assert!(orders.iter().sum::<f64>() / 3.0 > 1.9, "{orders:?}");
    }
}

#[test]
fn bodies_without_elastic_response_are_met_with_second_order() {
    let of = |interpolant| orders("Kelvin-Voigt", &kelvin_voigt(), risen, 1.0, interpolant);
    assert!(of(Interpolant::Linear).iter().all(|order| (0.9..1.1).contains(order)));
    for interpolant in [Interpolant::CorrectedLinear, Interpolant::CorrectedQuadratic] {
        assert!(of(interpolant).iter().all(|order| *order > 1.9), "{interpolant:?}");
    }
}

/// E ~ t^(−α), α = ½: what a step lacks of a degree k of u makes an error of the order k − α. Its series has a small
/// elastic response, and so steps of given length take u to be linear.
#[test]
fn a_springpot_takes_half_an_order() {
    let law = PowerLaw::new(1.0, 1.0, 0.5).unwrap().series(1e-4..=1e2, 1e-5).unwrap();
    let springpot = Material::incompressible(law).contact_spectrum().unwrap().unwrap();
    let of = |interpolant| orders("springpot", &springpot, risen, 1.0, interpolant);
    let least = |orders: [f64; 3]| orders.into_iter().fold(f64::INFINITY, f64::min);
    let orders = INTERPOLANTS.map(|interpolant| least(of(interpolant)));
    assert!(orders[0] > 1.3 && orders[1] > 1.4 && orders[2] > 1.9, "{orders:?}");
}
