//! A pulse of the load that one part of a run sees all see: adaptive steps in space, on states and of a contact of a user's own, events, and
//! how far a sweep has to go.

use std::sync::Arc;

use viscocontact::prelude::*;

use super::own_contact::Own;
use crate::common::{Draws, from_environment};

const UNTIL: f64 = 1.0;
const REST: f64 = 0.02;
const RADIUS: f64 = 10.0e-3;
const MODULUS: f64 = 1.0e6;

/// Times at which the load of a run is found to pass half of its pulses, upwards.
fn seen<C: Contact>(
    contact: C,
    history: &Arc<dyn LoadHistory>,
    stepping: Stepping,
    load: fn(&C) -> f64,
    half: f64,
) -> Vec<f64> {
    let run = contact.into_follow(Arc::clone(history), stepping, UNTIL);
    let mut run = run.stop_when(load, Crossing::Up(half)).unwrap();
    while run.next_step().unwrap().is_some() {}
    run.events()[0].times().to_vec()
}

#[test]
fn a_pulse_that_one_sees_all_see() {
    for seed in 0..from_environment("PULSES", 16) {
        let draws = &mut Draws::new(seed.wrapping_add(88_000_000));
        let by_force = draws.below(2) == 0;
        // far shorter than the steps under the load that is held in between, and longer than two looks at the run
        let pulses: Vec<[f64; 2]> =
            (0..3).map(|k| [(f64::from(k) + draws.between(0.2, 0.8)) / 3.0, draws.power_of_ten(-3.3, -1.7)]).collect();
        let (taps, size) = (pulses.clone(), if by_force { 0.5 } else { 40.0e-6 });
        // of compact support: between the pulses nothing tells of them
        let pulse = |t: f64, [at, width]: [f64; 2]| (1.0 - ((t - at) / width).powi(2)).max(0.0).powi(2);
        let share = move |t: f64| REST + (1.0 - REST) * taps.iter().map(|tap| pulse(t, *tap)).sum::<f64>();
        let load = move |t: f64| if by_force { Load::force(size * share(t)) } else { Load::approach(size * share(t)) };
        let history: Arc<dyn LoadHistory> = Arc::new(FnHistory::new(load));
        let rubber = Material::incompressible(Zener::relaxing(2.0 * MODULUS, MODULUS, 0.05).unwrap());
        let states = StatesContact::new(&ElasticStates::sphere(RADIUS).unwrap(), &rubber).unwrap();
        let in_space = ViscoelasticContact::builder(Grid::square(12, 2.0e-3).unwrap())
            .geometry(&Sphere::new(RADIUS).unwrap())
            .material(rubber.clone())
            .build()
            .unwrap();
        let ball = Own::new([1.0e4, 0.0], 1.0, 1.0);
        let (adaptive, half) = (Stepping::adaptive(1e-2), 0.5 * size);
        fn load_of<C: Contact>(by_force: bool) -> fn(&C) -> f64 {
            if by_force { |contact| contact.force() } else { |contact| contact.approach() }
        }
        let all = [
            ("in space", seen(in_space.clone(), &history, adaptive, load_of(by_force), half)),
            ("on states", seen(states.clone(), &history, adaptive, load_of(by_force), half)),
            ("own", seen(ball.clone(), &history, adaptive, load_of(by_force), half)),
            // steps of a given length look at their own load alone, in 64 parts
            ("fixed, own", seen(ball, &history, Stepping::fixed(0.01), load_of(by_force), half)),
            ("fixed, on states", seen(states, &history, Stepping::fixed(0.01), load_of(by_force), half)),
        ];
        for (who, found) in &all {
            assert_eq!(found.len(), pulses.len(), "{seed}, {who}: {found:?} of {pulses:?}");
            for (time, [at, width]) in found.iter().zip(&pulses) {
                let exact = at - width * (1.0 - ((0.5 - REST) / (1.0 - REST)).sqrt()).sqrt();
                assert!((time - exact).abs() < 0.01 * width + 1e-6, "{seed}, {who}: {time} {exact} {width}");
            }
        }
        // the maximum is not missed by a sweep, but for its margin
        match Reach::of(&rubber, &*history, UNTIL).unwrap() {
            Reach::Level(level) => assert!(level > size * rubber.contact_compliance(0.0), "{seed}: {level}"),
            Reach::Loads(loads) => {
                assert!(
                    loads.iter().any(|load| matches!(load, Load::Approach { approach, .. } if *approach > 0.9 * size))
                );
            }
            reach => panic!("{reach:?}"),
        }
    }
}
