//! Is the work of the load what elastic bodies store, and lose in jumps? `ADHESION_LOOPS` (8) chooses the number of random surfaces, and
//! `ADHESION_SEED` (1) others.

use super::adhesion_population::{Drawn, Scene};
use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::fields::{gap, traction};
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::contact::{Energies, EnergyBalance, StepError};
use viscocontact::prelude::*;

/// What the bodies store, ½ Σ q u, and the energy of the attraction, which is taken from it.
fn stored(contact: &ViscoelasticContact) -> [f64; 2] {
    let (traction, gap) = (traction(contact.fields()), gap(contact.fields()));
    let displaced = traction.iter().zip(contact.fields().displacement()).map(|(q, u)| 0.5 * q * u);
    let attracted = gap.iter().map(|h| contact.fields().attraction().unwrap().energy(h.max(0.0)));
    [displaced.sum::<f64>(), attracted.sum::<f64>()].map(|sum| sum * contact.grid().cell_area())
}

/// A random scene: pressed on and pulled off by some kind of load, in so many steps each way.
struct Loop {
    name: String,
    contact: ViscoelasticContact,
    creeping: bool,
    kind: usize,
    stiffness: f64,
    tilt: f64,
    down: f64,
    dt: f64,
}

impl Loop {
    fn draw(number: u64) -> Loop {
        let mut draws = Draws::new(3000 * from_environment("ADHESION_SEED", 1) + number);
        let kind = number as usize % 4;
        let periodic = if kind == 3 { 0.0 } else { 0.4 };
        let scene = Scene::draw(
            &mut draws,
            &Drawn { side: 8.0, tabor: [0.5, 1.4], heights: [0.02, 0.3], waves: [2.5, 4.0], creeping: 0.3, periodic },
        );
        Loop {
            name: format!("scene {number}: {}, load {kind}", scene.name),
            contact: scene.build(Settings::default().with_tolerance(1e-8)),
            creeping: scene.creeping,
            kind,
            stiffness: draws.scale(0.5, 50.0),
            tilt: draws.between(0.02, 0.1),
            down: draws.between(0.2, 0.7),
            dt: draws.scale(1e-2, 1e-1),
        }
    }

    /// The load at this part of the way, which goes in up to 1 and out up to 2.
    fn load(&self, way: f64) -> Load {
        let at = if way < 1.0 { -2.5 + (2.5 + self.down) * way } else { self.down - (3.5 + self.down) * (way - 1.0) };
        let approach = self.contact.approach() + at;
        match self.kind {
            0 => Load::approach(approach),
            1 => Load::spring(self.stiffness, approach),
            2 => Load::force(if at > 0.0 { 5.0 * at } else { 0.4 * at }),
            _ => Load::Approach { approach, tilt: [Tilt::Fixed(self.tilt * way), Tilt::Fixed(-0.5 * self.tilt * way)] },
        }
    }
}

/// The work of every kind of load is stored, dissipated or lost, from bodies far apart on, though the first step takes time: the error falls as the
/// square of the length of the steps. No jump gains, and what bodies that do not creep store is summed up anew.
#[test]
fn energies_close_under_every_load() {
    let mut errors = [const { Vec::new() }; 2];
    let mut snapped = 0;
    for number in 0..from_environment("ADHESION_LOOPS", 8) {
        let scene = Loop::draw(number);
        let [coarse, fine] = [64, 256].map(|steps| {
            let mut contact = scene.contact.clone();
            let mut balance = EnergyBalance::new(&contact).unwrap();
            let (mut worst, mut greatest) = (0.0_f64, 0.0_f64);
            for k in 0..=2 * steps {
                let report = match contact
                    .step(scene.dt * 64.0 / f64::from(steps), scene.load(f64::from(k) / f64::from(steps)))
                {
                    Ok(report) => report,
                    Err(Error::PulledOff { .. }) if scene.kind == 2 => break,
                    // full contact of a periodic body has no greater approach
                    Err(Error::Step(StepError::BeyondFullContact { .. })) => break,
                    Err(error) => panic!("{}: {error}", scene.name),
                };
                let before = balance.energies().lost;
                let energies = balance.record(&contact, &report).unwrap();
                let sizes = energies.stored.abs().max(greatest).max(1e-9);
                assert!(energies.lost >= before - 1e-3 * sizes, "{}: {before} {energies:?}", scene.name);
                // over the largest term of the balance: what is stored is a difference of its parts
                let [elastic, attracted] = stored(&contact);
                let apart = energies.stored - (elastic - attracted);
                let sizes = sizes.max(elastic.abs() + attracted.abs()).max(energies.work.abs());
                assert!(scene.creeping || apart.abs() < 1e-6 * sizes, "{}: {apart:e} of {energies:?}", scene.name);
                (worst, greatest) = (worst.max(energies.imbalance().abs()), greatest.max(energies.stored.abs()));
            }
            (worst, balance.energies(), greatest)
        });
        let Energies { lost, viscous, .. } = fine.1;
        assert!(scene.creeping || viscous.abs() < 1e-9 * fine.2, "{}: {viscous} {}", scene.name, fine.2);
        // what is lost: by bodies that neither creep nor snap, nothing
        let whole = (lost + viscous).max(0.1 * fine.2);
        let [e0, e1] = [coarse.0 / whole, fine.0 / whole];
        println!("{}: {e0:.1e}, {e1:.1e} of what is lost; {:?}", scene.name, fine.1);
        snapped += usize::from(lost > 0.0);
        errors[0].push(e0);
        errors[1].push(e1);
    }
    let [coarse, fine] = errors.map(|mut errors| {
        errors.sort_by(f64::total_cmp);
        [errors[errors.len() / 2], errors[errors.len() - 1]]
    });
    println!("median and worst {coarse:?}, {fine:?} in a fourth of the steps; {snapped} with jumps");
    assert!(snapped > 0 && coarse[1] < 1e-2 && fine[1] < 1e-2 && fine[0] < coarse[0] / 8.0);
}

/// What a pull-off takes and shows: its work, what is lost and dissipated, the greatest pull, and the warning of the balance.
struct PulledOff {
    work: f64,
    gone: f64,
    greatest: f64,
    warning: Option<String>,
    steps: usize,
}

/// Drawn off from a dwell at this speed, at stops so far apart.
fn pull_off(contact: &ViscoelasticContact, speed: f64, way: f64, tolerance: f64, every: Option<f64>) -> PulledOff {
    let mut contact = contact.clone();
    let mut balance = EnergyBalance::new(&contact).unwrap();
    for dt in [0.0, 10.0] {
        let report = contact.step(dt, Load::force(2.0e-3)).unwrap();
        balance.record(&contact, &report).unwrap();
    }
    let (before, from, start) = (balance.energies(), contact.time(), contact.approach());
    let load = FnHistory::new(move |t: f64| Load::approach(start - speed * (t - from).max(0.0)));
    let run = contact.follow(&load, Stepping::adaptive(tolerance), from + way / speed);
    let mut run = match every {
        Some(every) => run.stop_at(Times::every(every / speed)).unwrap(),
        None => run,
    };
    let (mut greatest, mut steps) = (0.0_f64, 0);
    while run.next_step().unwrap().is_some_and(|report| {
        balance.record(run.contact(), &report).unwrap();
        steps += 1;
        true
    }) {
        // the stops of the reference show the peak
        let pull = |contact: &ViscoelasticContact| -contact.force();
        let at_end = pull(run.contact());
        let found = if every.is_some() { at_end } else { run.max_within_step(pull).unwrap().1 };
        assert!(found >= at_end);
        greatest = greatest.max(found);
    }
    let Energies { work, viscous, lost, .. } = balance.energies();
    let gone = viscous + lost - before.viscous - before.lost;
    PulledOff { work: work - before.work, gone, greatest, warning: balance.energies().warning(), steps }
}

/// Pull-offs that lie within a few adaptive steps: the work, what is gone and the greatest pull are those of many short steps, or the
/// balance warns. `PULL_OFFS=40` draws more.
#[test]
fn fast_pull_offs_are_balanced_or_warn() {
    let (mut warned, mut worst, mut crossed) = (0, [0.0_f64; 3], 0);
    let count = from_environment("PULL_OFFS", 4);
    for number in 0..count {
        let mut draws = Draws::new(77_000 * from_environment("ADHESION_SEED", 1) + number);
        let moduli = [(60.0e3 * draws.scale(0.3, 1.5), draws.scale(0.3, 3.0)), (20.0e3, draws.scale(0.03, 0.3))];
        let body = GeneralizedMaxwell::new(20.0e3 * draws.scale(0.7, 1.5), &moduli).unwrap();
        let law = ExponentialAttraction::new(0.2 * draws.scale(0.7, 1.4), 60.0e-6 * draws.scale(0.8, 1.3)).unwrap();
        let (speed, tolerance) = (draws.scale(1e-3, 3e-2), draws.scale(1e-3, 1e-2));
        let builder = ViscoelasticContact::builder(Grid::square(32, 5.0e-3).unwrap());
        let builder = builder.geometry(&Sphere::new(5.0e-3).unwrap()).material(Material::incompressible(body));
        let contact = builder.attraction(law).build().unwrap();
        let way = 1.2e-3;
        let [found, fine] = [None, Some(way / 600.0)].map(|every| pull_off(&contact, speed, way, tolerance, every));
        let off = [
            (found.work - fine.work).abs() / fine.work,
            (found.gone - fine.gone).abs() / fine.gone,
            (found.greatest - fine.greatest).abs() / fine.greatest,
        ];
        println!(
            "{number}: {} steps at {speed:.1e} m/s to {tolerance:.1e}: work, gone, pull off by {off:.3?} of {:.2e} J, {:.2e} J, {:.2e} N; {:?}",
            found.steps, fine.work, fine.gone, fine.greatest, found.warning
        );
        assert!(fine.warning.is_none() && fine.work > 0.0, "{number}: {:?}", fine.warning);
        crossed += usize::from(found.steps < 20);
        warned += u64::from(found.warning.is_some());
        if found.warning.is_none() {
            (0..3).for_each(|k| worst[k] = worst[k].max(off[k]));
        }
    }
    println!("{warned} of {count} warned, {crossed} in fewer than 20 steps; the others off by at most {worst:.3?}");
    assert!(
        crossed > 0 && 2 * warned <= count && worst[0] < 0.02 && worst[1] < 0.02 && worst[2] < 0.01,
        "{warned} {worst:?}"
    );
}
