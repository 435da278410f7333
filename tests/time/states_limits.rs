//! Contacts on elastic states where numbers are extreme: blunt tips on springs, odd units, bodies without elastic response.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::random_histories::{Control, random_history};
use crate::common::{Draws, builder_of, from_environment};
use approx::assert_relative_eq;
use viscocontact::contact::Edge;
use viscocontact::contact::StepError;
use viscocontact::geometry::Sum;
use viscocontact::load::Tilt;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};
use viscocontact::states::{ElasticStates, Reach, StatesContact, Sweep};

/// A Zener body of the contact moduli 4 and 1, times `modulus`.
fn zener(modulus: f64) -> Material {
    Material::incompressible(GeneralizedMaxwell::new(0.25 * modulus, &[(0.75 * modulus, 1.0)]).unwrap())
}

/// ∫ f′ dr/√(a² − r²) of the shape f = r^n at a = 1: ∫ ds/√(1 − s^(2/n)) over 0 < s < 1, by the rule of Takahasi and Mori.
fn kappa(n: f64) -> f64 {
    let step = 1.0 / 64.0;
    let term = |k: i32| {
        let t = step * f64::from(k);
        // 1 − s, without cancelling near 1
        let (rest, slope) = (1.0 / (1.0 + (PI * t.sinh()).exp()), PI * t.cosh());
        slope * rest * (1.0 - rest) / (-(2.0 / n * (-rest).ln_1p()).exp_m1()).sqrt()
    };
    step * (-360..=360).map(term).filter(|term| term.is_finite()).sum::<f64>()
}

/// Level, depth and area of the shape c r^n at the contact radius a (Galin; Sneddon).
fn galin(c: f64, n: f64) -> impl Fn(f64) -> [f64; 3] {
    let factor = kappa(n) * c;
    move |a| {
        let depth = factor * a.powf(n);
        [2.0 * n / (n + 1.0) * depth * a, depth, PI * a * a]
    }
}

/// The depth at which force and spring balance, on a body that has not crept: E₀ l(δ) = k (z − δ), by halving the contact radius's range.
fn balanced_depth(curve: impl Fn(f64) -> [f64; 3], [modulus, stiffness, drive]: [f64; 3]) -> f64 {
    let [mut low, mut high] = [-700.0_f64, 700.0];
    for _ in 0..2000 {
        let middle = 0.5 * (low + high);
        let [level, depth, _] = curve(middle.exp());
        if depth < drive && modulus * level < stiffness * (drive - depth) { low = middle } else { high = middle }
    }
    curve(low.exp())[1]
}

/// A spring balances the force on any tip c r^n, in any units and at any stiffness, in jumps, holds and on the way back.
#[test]
fn springs_balance_on_blunt_and_sharp_tips() {
    let (mut steps, mut pressed, mut worst) = (0, 0, [0.0f64; 2]);
    let scenes = from_environment("STATES_SPRINGS", 200);
    for number in 0..scenes {
        let mut draws = Draws::new(number.wrapping_add(83_000_001));
        let (n, unit, modulus) =
            (draws.between(0.5, 12.0), draws.power_of_ten(-9.0, 9.0), draws.power_of_ten(-3.0, 9.0));
        // the radius and the depth of a contact are about 1 and 0.01…1 units
        let c = draws.power_of_ten(-2.0, 0.0) * unit.powf(1.0 - n);
        let states = ElasticStates::power(c, n).unwrap();
        let curve = galin(c, n);
        let [level, depth, _] = curve(unit * draws.power_of_ten(-1.5, 0.5));
        let stiffness = modulus * level / depth * draws.power_of_ten(-6.0, 6.0);
        let elastic = 4.0 * modulus;
        let mut contact = StatesContact::new(&states, &zener(modulus)).unwrap();
        for step in 0..20 {
            let share = [0.3, 1.0, 1.0, 0.6, 0.2, -0.1, 0.5][step % 7] * draws.between(0.8, 1.2);
            let drive = share * (depth + elastic * level / stiffness);
            let dt = if step % 3 == 0 { 0.0 } else { draws.power_of_ten(-3.0, 1.0) };
            let report = contact
                .step(dt, Load::spring(stiffness, drive))
                .unwrap_or_else(|error| panic!("{number} n {n}: {error}"));
            let spring = stiffness * (drive - report.approach);
            steps += 1;
            if report.force == 0.0 {
                assert!(spring <= 0.0, "{number} step {step}: no force on a spring of {spring:e}");
                continue;
            }
            let off = (report.force - spring).abs() / report.force.max(stiffness * drive.abs());
            (pressed, worst[0]) = (pressed + 1, worst[0].max(off));
            assert!(off < 1e-9, "{number} step {step}, n {n}: {off:e}");
            if step == 0 {
                let off = (report.approach / balanced_depth(&curve, [elastic, stiffness, drive]) - 1.0).abs();
                worst[1] = worst[1].max(off);
                assert!(off < 1e-9, "{number}, n {n}: {off:e}");
            }
        }
    }
    println!(
        "{steps} steps, {pressed} in contact: unbalanced by {:.1e}, the first depth errs by {:.1e}",
        worst[0], worst[1]
    );
    assert!(pressed > 10 * scenes && pressed < steps, "{pressed} of {steps}");
}

/// The same on tables of rising curves of any slopes.
#[test]
fn springs_balance_on_any_table() {
    let (mut pressed, mut worst) = (0, 0.0f64);
    let scenes = from_environment("STATES_SPRINGS", 200);
    for number in 0..scenes {
        let mut draws = Draws::new(number.wrapping_add(84_000_001));
        let (mut level, mut depth) = (draws.power_of_ten(-12.0, 0.0), draws.power_of_ten(-9.0, 0.0));
        let mut table = Vec::new();
        for _ in 0..2 + draws.below(12) {
            let by = draws.power_of_ten(0.001, 4.0);
            let slope = draws.power_of_ten(-3.0, 0.0);
            (level, depth) = (level * by, depth * by.powf(slope));
            // slopes that do not belong to the curve, too
            table.push((level, depth, level / depth * draws.power_of_ten(-2.0, 2.0), level / depth));
        }
        let states = ElasticStates::from_table(&table).unwrap();
        let mut contact = StatesContact::new(&states, &zener(4.0)).unwrap();
        let (level, depth) = (table[table.len() - 1].0, table[table.len() - 1].1);
        let stiffness = 4.0 * level / depth * draws.power_of_ten(-6.0, 6.0);
        for step in 0..10 {
            let drive = depth * draws.power_of_ten(-4.0, 0.0) * (1.0 + 4.0 * level / depth / stiffness);
            let drive =
                if step == 0 { drive.min(0.99 * depth) } else { drive.min(0.99 * depth) * draws.between(0.0, 1.0) };
            let report = contact.step(draws.power_of_ten(-2.0, 1.0), Load::spring(stiffness, drive)).unwrap();
            let off =
                (report.force - stiffness * (drive - report.approach)).abs() / report.force.max(stiffness * drive);
            if report.force > 0.0 {
                (pressed, worst) = (pressed + 1, worst.max(off));
                assert!(off < 1e-9, "{number} step {step}: {off:e}");
            }
        }
    }
    println!("{pressed} steps in contact: unbalanced by {worst:.1e}");
    assert!(pressed > 2 * scenes, "{pressed}");
}

/// Closed forms do not end where numbers in other units would.
#[test]
fn closed_forms_hold_in_any_units() {
    for number in 0..from_environment("STATES_UNITS", 300) {
        let mut draws = Draws::new(number.wrapping_add(85_000_001));
        let n = draws.scale(0.1, 100.0);
        // c in these units is a number
        let decades = (200.0 / n).min(15.0);
        let unit = draws.power_of_ten(-decades, decades);
        let c = draws.power_of_ten(-3.0, 3.0) * unit.powf(1.0 - n);
        let a = unit * draws.power_of_ten(-6.0 / n.max(1.0), 6.0 / n.max(1.0));
        let [level, depth, area] = galin(c, n)(a);
        let check = |states: &Arc<ElasticStates>, [level, depth, stiffness, area]: [f64; 4]| {
            // rounding of exponents
            let found = [states.level_at(depth), states.approach(level), states.stiffness(level), states.area(level)];
            for (found, expected) in found.into_iter().zip([level, depth, stiffness, area]) {
                assert_relative_eq!(found, expected, max_relative = 1e-12 * n.max(1.0));
            }
        };
        check(&ElasticStates::power(c, n).unwrap(), [level, depth, 2.0 * a, area]);
        let radius = unit * draws.power_of_ten(-3.0, 3.0);
        check(&ElasticStates::sphere(radius).unwrap(), [4.0 / 3.0 * a.powi(3) / radius, a * a / radius, 2.0 * a, area]);
        let slope = draws.power_of_ten(-3.0, 1.0);
        let depth = 0.5 * PI * slope * a;
        check(&ElasticStates::cone(slope).unwrap(), [depth * a, depth, 2.0 * a, area]);
        let face = PI * radius * radius;
        check(&ElasticStates::punch(radius).unwrap(), [2.0 * radius * depth, depth, 2.0 * radius, face]);
    }
    // a sphere of 10 mm in nanometres, pressed by 10 µm
    let contact = StatesContact::new(&ElasticStates::sphere(1.0e7).unwrap(), &zener(1.0e-12));
    assert!(contact.unwrap().step(1.0, Load::approach(1.0e4)).is_ok());
}

/// E* = 1 and 1 s of retardation: C(t) = 1 − e^(−t).
fn kelvin_voigt() -> StatesContact {
    let material = Material::incompressible(KelvinVoigt::with_time(0.25, 1.0).unwrap());
    StatesContact::new(&ElasticStates::sphere(1.0).unwrap(), &material).unwrap()
}

/// Bodies without elastic response follow histories in which nothing jumps, and a release; the level is that of the integral.
#[test]
fn bodies_without_elastic_response_follow_histories_without_jumps() {
    // levels that are met in a step err by its first order
    for (stepping, allowed) in
        [(Stepping::fixed(0.01), 1e-2), (Stepping::fixed(0.001), 1e-3), (Stepping::adaptive(1e-5), 1e-3)]
    {
        let mut contact = kelvin_voigt();
        let ramp = Ramp::new(Load::force(0.0), Load::force(2.0), 2.0).unwrap();
        let mut run = contact.follow(&ramp, stepping, 5.0);
        let (mut compared, mut worst) = (0, 0.0f64);
        while let Some(report) = run.next_step().unwrap() {
            // ∫ C(t − s) dF(s)
            let crept = |t: f64| if t > 0.0 { t - (1.0 - (-t).exp()) } else { 0.0 };
            let expected = crept(report.time) - crept(report.time - 2.0);
            worst = worst.max((run.contact().level() - expected).abs());
            compared += 1;
        }
        println!("{stepping:?}: {worst:.1e} in {compared} steps");
        assert!(compared > 20 && worst < allowed, "{stepping:?}: {worst:e}");
        // taken up again under the same load, and by the same approach
        let (held, approach) = (contact.clone(), contact.approach());
        for load in [Load::force(2.0), Load::approach(approach), Load::spring(1.0, approach + 2.0)] {
            contact.step(0.0, load).unwrap();
            assert_eq!(format!("{contact:?}"), format!("{held:?}"), "{load}");
            let history = Ramp::new(load, load, 1.0).unwrap();
            let mut again = held.clone();
            let mut run = again.follow(&history, stepping, 5.1);
            while run.next_step().unwrap().is_some() {}
            // a body that stops loses the force of its dashpots
            let forces = 0.99 * held.level()..2.01;
            assert!(forces.contains(&again.force()), "{load}: {}", again.force());
        }
        // more at once is refused and changes nothing; less than the surface releases the body, and the surface recovers
        for load in
            [Load::force(2.1), Load::force(1.0), Load::approach(1.1 * approach), Load::spring(1.0, approach + 2.1)]
        {
            let refused = contact.step(0.0, load).unwrap_err();
            assert!(matches!(refused, Error::Step(StepError::NoElasticResponse { .. })), "{refused}");
            assert_eq!(format!("{contact:?}"), format!("{held:?}"));
        }
        let mut parted = held.clone();
        let report = parted.step(0.0, Load::approach(0.5 * approach)).unwrap();
        assert_eq!([report.force, report.approach, parted.level()], [0.0, 0.5 * approach, 0.0]);
        let report = contact.step(0.0, Load::force(0.0)).unwrap();
        assert_eq!([report.force, contact.level()], [0.0, 0.0]);
        assert_relative_eq!(report.approach, approach, max_relative = 1e-12);
        for contact in [&mut contact, &mut parted] {
            for _ in 0..200 {
                contact.step(0.005, Load::force(0.0)).unwrap();
            }
            assert_relative_eq!(contact.approach(), approach * (-1.0_f64).exp(), max_relative = 1e-3);
        }
    }
    let approaching = Ramp::new(Load::approach(-0.1), Load::approach(0.3), 1.0).unwrap();
    let mut contact = kelvin_voigt();
    let mut run = contact.follow(&approaching, Stepping::adaptive(1e-4), 2.0);
    while run.next_step().unwrap().is_some() {}
    assert_relative_eq!(contact.force(), 4.0 / 3.0 * 0.3_f64.powf(1.5), max_relative = 0.5);
    assert_eq!(contact.approach(), 0.3);
}

/// A sweep to the reach of a run holds all states of the run, and under forces and approaches few others.
#[test]
fn sweeps_reach_what_a_run_needs() {
    let (mut beyond, mut wasted, mut kinds) = ([0; 2], 0.0f64, [0; 4]);
    let grid = Grid::square(10, 1.0).unwrap();
    for number in 0..from_environment("STATES_REACH", 40) {
        let mut draws = Draws::new(number.wrapping_add(86_000_001));
        let kind = (number % 4) as usize;
        let rise = draws.between(-0.05, 0.05);
        let bowl = FnGeometry::new(move |x1: f64, x2: f64| rise + 0.5 * (x1 * x1 + 1.5 * x2 * x2));
        let terms: Vec<_> =
            (0..1 + draws.below(4)).map(|_| (draws.between(0.1, 1.0), draws.power_of_ten(-2.0, 1.0))).collect();
        let body = Material::incompressible(GeneralizedMaxwell::new(draws.between(0.02, 0.3), &terms).unwrap());
        let warming = draws.chance(0.3).then(|| {
            let law = TimeTemperature::wlf(10.0, 60.0, 300.0).unwrap();
            TemperatureHistory::function(law, |t| 300.0 + 5.0 * t, &[]).unwrap()
        });
        let depth = 0.02 + rise.max(0.0);
        let history = match kind {
            3 => {
                let [force, back] = [2.0e-3, depth];
                let held =
                    move |t: f64| if t < 0.5 { Load::force(2.0 * t * force) } else { Load::approach((1.0 - t) * back) };
                Box::new(FnHistory::new(held).with_breakpoints(&[0.5]).unwrap())
            }
            0 => random_history(&mut draws, Control::Force(2.0e-3), 1.0, true).history,
            1 => random_history(&mut draws, Control::Approach { touch: rise, depth }, 1.0, true).history,
            _ => {
                let spring = Control::by_spring(&mut draws, rise, depth, 2.0e-3);
                random_history(&mut draws, spring, 1.0, true).history
            }
        };
        let reach = match &warming {
            Some(warming) => Reach::at_temperature(&body, warming, &*history, 1.0).unwrap(),
            None => Reach::of(&body, &*history, 1.0).unwrap(),
        };
        let sweep = Sweep::new(grid.clone(), &bowl).settings(Settings::default().with_edge(Edge::Allow)).accuracy(1e-2);
        let states = match sweep.run(reach) {
            Ok(states) => states,
            // never in contact
            Err(Error::OutOfRange { field: "load that a sweep reaches" | "level that a sweep reaches", .. }) => {
                continue;
            }
            Err(error) => panic!("{number}: {error}"),
        };
        let mut contact = StatesContact::new(&states, &body).unwrap();
        if let Some(warming) = warming {
            contact = contact.with_temperature(warming);
        }
        let mut run = contact.follow(&*history, Stepping::adaptive(1e-3), 1.0);
        let mut greatest = 0.0f64;
        loop {
            match run.next_step() {
                Ok(Some(_)) => greatest = greatest.max(run.contact().level()),
                Ok(None) => break,
                Err(error) if error.code() == "states_beyond" => {
                    beyond[usize::from(matches!(kind, 2 | 3))] += 1;
                    println!("{number}, kind {kind}: beyond");
                    break;
                }
                Err(error) => panic!("{number}: {error}"),
            }
        }
        kinds[kind] += 1;
        let last = states.states()[states.states().len() - 1].level;
        if greatest > 0.0 && !matches!(kind, 2 | 3) {
            wasted = wasted.max(last / greatest);
        }
    }
    println!("runs by kind {kinds:?}; {beyond:?} go beyond; sweeps reach {wasted:.3} times the level needed");
    // springs and several kinds of load have an estimate
    let of_estimates: u32 = kinds[2] + kinds[3];
    let few = beyond[0] == 0 && 20 * beyond[1] <= of_estimates;
    assert!(few && wasted < 1.2 && kinds.iter().all(|runs| *runs > 2), "{beyond:?} {wasted} {kinds:?}");
}

/// A body that tilts freely under no force rests where small forces press it. The stepper has the same limit; under exactly no force its
/// bodies are upright.
#[test]
fn free_tilts_under_no_force_are_the_limit_of_small_forces() {
    let (mut compared, mut tilted) = (0, 0);
    for seed in 0..from_environment("STATES_REST", 4) {
        let grid = Grid::square(16, 1.0).unwrap();
        let spec = RoughSpec::new(0.5, 0.2, Roughness::RmsHeight(3e-4)).with_seed(seed);
        let face = FlatPunch::rectangular([0.7, 0.55]).unwrap();
        let shape = Sum::new(face, Rough::new(&grid, spec).unwrap());
        let (at, settings) = ([0.03, -0.02], Settings::default().with_edge(Edge::Allow).with_tolerance(1e-11));
        let tilt = at.map(|at| Tilt::Free { at });
        let force = |normal: f64| Load::Force { normal, tilt };
        let sweep = Sweep::new(grid.clone(), &shape).tilt(tilt).settings(settings).accuracy(1e-4);
        let states = sweep.run(Reach::Level(0.02)).unwrap();
        let mut contact = StatesContact::new(&states, &zener(0.25)).unwrap();
        let builder = builder_of(&shape, grid, zener(0.25)).settings(settings);
        let mut full = builder.build().unwrap();
        let of_point = |approach: f64, tilt: [f64; 2]| approach + tilt[0] * at[0] + tilt[1] * at[1];
        for held in [false, true] {
            if held {
                for dt in [0.0, 1.0] {
                    contact.step(dt, force(5e-3)).unwrap();
                    full.step(dt, force(5e-3)).unwrap();
                }
            }
            let dt = if held { 0.3 } else { 0.0 };
            let free = contact.clone().step(dt, force(0.0)).unwrap();
            let (mut resting, mut unloaded) = (full.clone(), full.clone());
            let touching = resting.step(dt, force(1e-12)).unwrap();
            let off = of_point(free.approach, free.tilt) / of_point(touching.approach, touching.tilt) - 1.0;
            assert!(off.abs() < 1e-6, "{seed}: {off:e}");
            assert_eq!(unloaded.step(dt, force(0.0)).unwrap().tilt, [0.0; 2]);
            compared += 1;
            tilted += u32::from(touching.tilt != [0.0; 2]);
        }
    }
    assert!(compared >= 2 && tilted == compared, "{compared} {tilted}");
}

/// Tables of thousands of rows whose highest peak is narrower than the samples of a run: a sweep reaches to it.
#[test]
fn sweeps_reach_the_tops_of_long_tables() {
    for number in 0..20 {
        let draws = &mut Draws::new(number + 71_700_000);
        let (count, depth) = (1100 + draws.below(4000), draws.power_of_ten(-6.0, -4.0));
        let highest = draws.below(count);
        let mut rows = Vec::new();
        for k in 0..count {
            let part = if k == highest { 1.0 } else { draws.between(0.0, 0.5) };
            let time = k as f64 + draws.between(0.1, 0.9);
            rows.extend([(time - 1e-4, 0.0), (time, part * depth), (time + 1e-4, 0.0)]);
        }
        let rows: Vec<_> = rows.into_iter().map(|(time, approach)| (time, Load::approach(approach))).collect();
        let history = PiecewiseLinear::new(&rows).unwrap();
        let Reach::Loads(loads) = Reach::of(&zener(1e6), &history, count as f64).unwrap() else { panic!("no loads") };
        assert!(loads.contains(&Load::approach(depth)), "{number}: {loads:?} for {depth}");
    }
}
