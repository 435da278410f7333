//! Random histories of both loads against Coulomb's law on the cells of dense bodies.

use viscocontact::prelude::*;
use viscocontact::states::{ElasticStates, StatesContact};

use super::bodies::{Body, Past, Relaxation};
use crate::common::draws::Draws;
use crate::common::environment::from_environment;

pub fn relaxation(kind: usize) -> Relaxation {
    let terms: &[(f64, f64)] = match kind {
        0 => &[(0.75, 1.0)],
        1 => &[(0.3, 0.05), (0.3, 1.0), (0.3, 20.0)],
        // nearly a fluid
        _ => &[(0.99, 1.0)],
    };
    Relaxation { equilibrium: 1.0 - terms.iter().map(|term| term.0).sum::<f64>(), terms: terms.to_vec() }
}

/// Two bodies of ν = 0, whose contact modulus is this one.
pub fn material(Relaxation { equilibrium, terms }: &Relaxation) -> Material {
    let body = || Material::constant_poisson(GeneralizedMaxwell::new(*equilibrium, terms).unwrap(), 0.0).unwrap();
    body().against(body())
}

/// A step: its length, and the forces at its end.
type Step = (f64, f64, f64);

/// Presses and shears at random; contacts shrink, part and meet again, or grow.
fn history(steps: usize, most: f64, friction: f64, grows: bool, draws: &mut Draws) -> Vec<Step> {
    let (mut force, mut along) = (most * draws.between(0.3, 1.0), 0.0);
    let step = |k: usize| {
        let dt = if k == 0 || draws.chance(0.1) { 0.0 } else { draws.power_of_ten(-2.0, 1.5) };
        if draws.chance(0.4) {
            force = (force * draws.between(if grows { 1.0 } else { 0.2 }, 1.9)).clamp(0.02 * most, 3.0 * most);
        }
        let limit = 0.95 * friction * force;
        along = if draws.chance(0.7) { limit * draws.between(-1.0, 1.0) } else { f64::clamp(along, -limit, limit) };
        (dt, force, along)
    };
    (0..steps).map(step).collect()
}

/// States whose levels are among those given, from dense elastic contacts, and their pressures.
fn states(body: &Body, levels: &[f64]) -> (std::sync::Arc<ElasticStates>, Vec<(f64, Vec<f64>)>) {
    let least = body.gap.iter().copied().reduce(f64::min).unwrap();
    let (free, mut table, mut pressures) = (vec![0.0; body.gap.len()], Vec::new(), Vec::new());
    for &level in levels {
        let (pressure, approach) = body.press(1.0, &free, level);
        let cells = pressure.iter().filter(|p| **p > 0.0).count() as f64;
        table.push((level, approach - least, 1.0, cells));
        pressures.push((level, pressure));
    }
    (ElasticStates::from_table(&table).unwrap(), pressures)
}

struct Worst {
    pressure: f64,
    traction: f64,
    displacement: f64,
    /// By slip and by creep.
    loss: f64,
    over: f64,
    steps: usize,
}

/// The same steps by levels and on cells. Where the contact grows, cells that it meets slip from their entry on: by the
/// part of the motion after it. Else the whole motion of a step is slip of what it meets.
fn compare(seed: u64, grows: bool, worst: &mut Worst) {
    let mut draws = Draws::new(seed);
    let (friction, relaxation) = (draws.between(0.1, 0.9), relaxation(seed as usize % 3));
    let body = if seed.is_multiple_of(2) { Body::line(48, &mut draws) } else { Body::half_space(9, &mut draws) };
    let steps =
        history(24, body.force() * if seed.is_multiple_of(2) { 0.25 } else { 1.0 }, friction, grows, &mut draws);
    let take = |states: &std::sync::Arc<ElasticStates>| {
        let contact = StatesContact::new(states, &material(&relaxation)).unwrap().with_linear_steps();
        let contact = contact.with_merge_error(0.0).unwrap().with_friction(friction).unwrap();
        if grows { contact } else { contact.with_slip_from_start().unwrap() }
    };
    // levels do not depend on the states under forces: those that the steps cut are found first
    let greatest = 20.0 * steps.iter().map(|step| step.1).fold(0.0, f64::max);
    let rough =
        ElasticStates::from_table(&[(1e-9, 1e-9, 1.0, 1.0), (greatest * 50.0, greatest * 50.0, 1.0, 1.0)]).unwrap();
    let (mut first, mut levels) = (take(&rough), Vec::new());
    for &(dt, force, along) in &steps {
        first.step_sheared(dt, Load::force(force), Load::force(along)).unwrap();
        levels.extend(first.tractions().map(|(level, _)| level));
        levels.extend([first.stick_level(), first.level()]);
    }
    levels.retain(|level| *level > 0.0);
    levels.push(1.01 * levels.iter().copied().fold(0.0, f64::max));
    // the work of levels between two states errs by the square of their distance
    let between = from_environment("FRICTION_LEVELS", 12);
    levels.push(1e-6 * levels[levels.len() - 1]);
    levels.sort_by(f64::total_cmp);
    let inner = |pair: &[f64]| {
        let (low, high) = (pair[0], pair[1]);
        (1..between).map(move |k| low + (high - low) * k as f64 / between as f64)
    };
    levels.extend(levels.windows(2).flat_map(inner).collect::<Vec<_>>());
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| *a - *b <= 1e-11 * *b);
    let (states, pressures) = states(&body, &levels);
    let mut contact = take(&states);
    let cells = body.gap.len();
    let (mut normal, mut lateral) = (Past::new(&relaxation, cells), Past::new(&relaxation, cells));
    let (mut d, mut traction) = (0.0, vec![0.0; cells]);
    let (mut lost, mut before) = (0.0, 0.0);
    let mut met = (vec![false; cells], body.gap.iter().copied().reduce(f64::min).unwrap());
    let (mut bodies, mut crept) = (Past::new(&relaxation, cells), 0.0);
    let form = |one: &[f64], other: &[f64]| one.iter().zip(body.displacement(other)).map(|(a, b)| a * b).sum();
    let field = |tractions: &mut dyn Iterator<Item = (f64, f64)>| {
        let (mut field, mut below) = (vec![0.0; cells], vec![0.0; cells]);
        for (level, traction) in tractions {
            let at = pressures.iter().min_by(|a, b| (a.0 - level).abs().total_cmp(&(b.0 - level).abs())).unwrap();
            assert!((at.0 - level).abs() < 1e-9 * level, "a level that was not cut: {level}");
            (0..cells).for_each(|k| field[k] += traction * (at.1[k] - below[k]));
            below.clone_from(&at.1);
        }
        field
    };
    for &(dt, force, along) in &steps {
        let (c, free) = relaxation.step(dt, &normal);
        let (pressure, approach) = body.press(c, &free, force);
        let gap_before = |k: usize| body.gap[k] + normal.now[k] - met.1;
        let share = |k: usize| {
            let enters = grows && pressure[k] > 0.0 && !met.0[k];
            if enters { 1.0 - gap_before(k).max(0.0) / (approach - met.1) } else { 1.0 }
        };
        let shares: Vec<f64> = (0..cells).map(share).collect();
        met = (pressure.iter().map(|p| *p > 0.0).collect(), approach);
        let displaced = body.displacement(&pressure);
        let now = (0..cells).map(|k| c * displaced[k] + free[k]).collect();
        relaxation.commit(dt, &mut normal, now);
        let (c, free) = relaxation.step(dt, &lateral);
        let change: Vec<f64> = free.iter().zip(&lateral.now).map(|(free, now)| free - now).collect();
        let bound: Vec<f64> = pressure.iter().map(|p| friction * p.max(0.0)).collect();
        let (found, motion) = body.rub(c, &change, &bound, &shares, along);
        let displaced = body.displacement(&found);
        let slip = |k: usize| shares[k] * motion - change[k] - c * displaced[k];
        lost += (0..cells).map(|k| 0.5 * (found[k] + traction[k]) * slip(k)).sum::<f64>();
        let now = (0..cells).map(|k| c * displaced[k] + free[k]).collect();
        relaxation.commit(dt, &mut lateral, now);
        (d, traction) = (d + motion, found);
        let (c, free) = relaxation.step(dt, &bodies);
        let moved: Vec<f64> = free.iter().zip(&traction).map(|(free, traction)| free + c * traction).collect();
        crept += relaxation.dissipated(dt, &bodies, &moved, &form);
        relaxation.commit(dt, &mut bodies, moved);

        contact.step_sheared(dt, Load::force(force), Load::force(along)).unwrap();
        let most = pressure.iter().copied().fold(0.0, f64::max);
        let far = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        worst.pressure = worst.pressure.max(far(&field(&mut contact.tractions()), &pressure) / most);
        worst.traction = worst.traction.max(far(&field(&mut contact.shear_tractions()), &traction) / (friction * most));
        before = f64::max(before, d.abs());
        worst.displacement = worst.displacement.max((contact.lateral_displacement() - d).abs() / before);
        let work = contact.lateral_work();
        // what slips in the step in which it is met is of another order in both
        let of_slip = if grows { 0.0 } else { (work.slip - lost).abs() };
        let off = f64::max(of_slip, (work.creep - crept).abs());
        worst.loss = worst.loss.max(off / (work.work.abs() + lost));
        let over =
            contact.tractions().zip(contact.shear_tractions()).map(|(w, theta)| theta.1.abs() / (friction * w.1));
        worst.over = over.fold(worst.over, f64::max);
        worst.steps += 1;
    }
}

#[test]
fn levels_are_coulombs_law_on_cells() {
    agree(false);
}

#[test]
fn what_grows_slips_from_its_entry_on() {
    agree(true);
}

fn agree(grows: bool) {
    let (scenes, first) = (from_environment("FRICTION_SCENES", 6), from_environment("FRICTION_FIRST", 0));
    let mut all = Worst { pressure: 0.0, traction: 0.0, displacement: 0.0, loss: 0.0, over: 0.0, steps: 0 };
    for seed in first..first + scenes {
        let mut worst = Worst { pressure: 0.0, traction: 0.0, displacement: 0.0, loss: 0.0, over: 0.0, steps: 0 };
        compare(seed, grows, &mut worst);
        if scenes < 20 || worst.traction > 1e-10 || worst.displacement > 1e-10 || worst.loss > 1e-6 {
            println!(
                "{seed}: p {:.1e}, τ {:.1e}, d {:.1e}, loss {:.1e}, over {:.6}",
                worst.pressure, worst.traction, worst.displacement, worst.loss, worst.over
            );
        }
        all.pressure = all.pressure.max(worst.pressure);
        all.traction = all.traction.max(worst.traction);
        all.displacement = all.displacement.max(worst.displacement);
        all.loss = all.loss.max(worst.loss);
        all.over = all.over.max(worst.over);
        all.steps += worst.steps;
    }
    println!(
        "{scenes} scenes, {} steps: p {:.1e}, τ {:.1e}, d {:.1e}, loss {:.1e}, over {:.9}",
        all.steps, all.pressure, all.traction, all.displacement, all.loss, all.over
    );
    assert_eq!(all.steps as u64, 24 * scenes);
    assert!(all.traction < 1e-9 && all.displacement < 1e-9 && all.over < 1.0 + 1e-9);
    assert!(all.loss < 1e-3);
}
