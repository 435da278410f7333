//! When are bodies that attract each other apart? Random laws and bodies, pulled off under a given approach. `ADHESION_PULLS` (12) chooses how many.

use super::adhesion_population::law;
use crate::common::fields::gap;
use crate::common::sticky::{ball, elastic};
use crate::common::{Draws, from_environment};
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::prelude::*;

/// Whether the bodies are apart, from the fields and the law.
fn is_apart(contact: &ViscoelasticContact, energy: impl Fn(f64) -> f64) -> bool {
    let narrowest = gap(contact.fields()).into_iter().fold(f64::INFINITY, f64::min).max(0.0);
    contact.pressure().iter().all(|p| *p == 0.0) && energy(narrowest) <= 0.01 * energy(0.0)
}

#[test]
fn bodies_are_apart_when_no_attraction_is_left_to_overcome() {
    let (count, mut pulling) = (from_environment("ADHESION_PULLS", 12), 0);
    for number in 0..count {
        let mut draws = Draws::new(number);
        let (range, stiff) = (draws.between(0.8, 1.6), draws.between(0.0, 1.0));
        let law = law(&mut draws, range);
        let energy = |gap: f64| law.energy(gap);
        let body = GeneralizedMaxwell::new(0.25, &[(0.25 * stiff, 1.0)]).unwrap();
        let settings = Settings::default().with_edge(Edge::Allow).with_symmetry(draws.chance(0.5));
        let builder = ball(30, 8.0, Material::incompressible(body), law.clone());
        let mut contact = builder.settings(settings).build().unwrap();
        let dt = draws.power_of_ten(-2.0, 1.0);
        contact.step(10.0, Load::approach(0.5)).unwrap();
        let (mut greatest, mut parted) = (0.0_f64, None);
        for k in 1.. {
            let report = contact.step(dt, Load::approach(0.5 - 0.25 * f64::from(k))).unwrap();
            assert_eq!(contact.is_separated(), is_apart(&contact, energy), "{number}: {law:?} {report}");
            greatest = greatest.max(-report.force);
            if report.contact_cells == 0 {
                parted.get_or_insert(-report.force);
            }
            if contact.is_separated() {
                break;
            }
        }
        // of a ball the force that is left is 2π R times the energy at the narrowest gap
        assert!(contact.force().abs() <= 0.02 * greatest, "{number}: {} of {greatest}", contact.force());
        pulling += u64::from(parted.unwrap() > 0.1 * greatest);
    }
    println!("{pulling} of {count} pull when the last cell has left the wall");
    assert!(2 * pulling > count, "{pulling} of {count}");
}

/// A punch that tilts freely peels off under an eccentric pull: at the same force, however long the steps are that lead there.
#[test]
fn an_eccentric_pull_peels_at_one_force() {
    let forces = [0.5, 0.1, 0.02].map(|step| {
        let law = ExponentialAttraction::new(1.0, 0.8).unwrap();
        let punch = FlatPunch::circular(1.0).unwrap();
        let mut contact = ball(32, 4.0, elastic(), law).geometry(&punch).build().unwrap();
        let load = |force: f64| Load::eccentric_force(force, [0.2, 0.0]);
        contact.step(1.0, load(1.0)).unwrap();
        let (mut force, mut step): (f64, f64) = (1.0, step);
        let mut pull = |force: &mut f64, step: f64| loop {
            match contact.step(1.0, load(*force - step)) {
                Ok(_) => *force -= step,
                Err(Error::PulledOff { .. }) => return,
                Err(error) => panic!("by {step} from {force}: {error}"),
            }
        };
        pull(&mut force, step);
        // on to the force itself
        while step > 0.005 {
            step *= 0.5;
            pull(&mut force, step);
        }
        force
    });
    println!("peels at {forces:.3?} N");
    assert!(forces.iter().all(|force| *force < -0.5 && (force / forces[2] - 1.0).abs() < 0.02), "{forces:?}");
}
