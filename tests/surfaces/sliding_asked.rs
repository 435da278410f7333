//! What steady motions are asked and tell: counter-bodies that slide or roll against dense problems of two bodies, frequencies at which a
//! material was not measured, saw-teeth wherever they begin, moduli that give energy away. `SLIDING_ASKED` (12) random scenes of each,
//! `SLIDING_SEED` (1).

use std::f64::consts::TAU;

use super::sliding_chains::errors;
use crate::common::moving_bodies::{Base, Bodies, Creep};
use crate::common::{Draws, Ratios, builder_of, from_environment};
use viscocontact::motion::CounterMotion;
use viscocontact::num_complex::Complex64;
use viscocontact::prelude::*;

fn scenes() -> impl Iterator<Item = (u64, Draws)> {
    let (count, seed) = (from_environment("SLIDING_ASKED", 12), from_environment("SLIDING_SEED", 1));
    (0..count).map(move |number| (number, Draws::new(11_000_000 * seed + number)))
}

fn creep(draws: &mut Draws) -> Creep {
    let term = |draws: &mut Draws| (1e-6 * draws.scale(0.3, 10.0), draws.power_of_ten(-2.0, 2.0));
    Creep { glassy: 1e-6 * draws.scale(0.3, 3.0), terms: (0..1 + draws.below(4)).map(|_| term(draws)).collect() }
}

/// Waves of random phases over the lengths of the bodies, and a ball where they are not periodic.
fn waves(draws: &mut Draws, bodies: &Bodies) -> impl Fn(f64, f64) -> f64 + Clone + Send + Sync + use<> {
    let (lengths, is_periodic) = (bodies.lengths(), bodies.periodic == [true; 2]);
    let wave = |draws: &mut Draws| {
        [1.0 + draws.below(2) as f64, draws.below(3) as f64, draws.between(0.0, TAU), draws.between(2e-3, 6e-3)]
    };
    let waves: Vec<_> = (0..3).map(|_| wave(draws)).collect();
    move |x1: f64, x2: f64| {
        let of =
            |[a, b, phase, h]: &[f64; 4]| h * (1.0 - (TAU * (a * x1 / lengths[0] + b * x2 / lengths[1]) + phase).cos());
        let rise = waves.iter().map(of).sum::<f64>();
        if is_periodic { rise } else { 0.1 * rise + (x1 * x1 + x2 * x2) / 200.0 }
    }
}

fn bodies(periodic: bool, cells: [usize; 2], creep: Creep, nu: f64) -> Bodies {
    let (periodic, base, spacing) = ([periodic; 2], Base::None, [1.0, 1.2]);
    Bodies { periodic, cells, spacing, creep, nu, base, base_nu: 0.5, thickness: 1.0, datum: 1e4, as_line: false }
}

/// Random pairs: the points of a counter-body that slides rest under the pressure, those of one that rolls pass it as those of the body.
#[test]
fn counter_bodies_slide_or_roll_as_dense_problems_of_two_bodies_do() {
    let (mut all, mut ratios): ([Ratios; 3], Ratios) = Default::default();
    for (number, mut draws) in scenes() {
        let periodic = number % 2 == 0;
        let count = |draws: &mut Draws| if periodic { 8 + draws.below(9) } else { 8 + draws.below(5) };
        let cells = [count(&mut draws), count(&mut draws)];
        let own = bodies(periodic, cells, creep(&mut draws), if draws.chance(0.5) { 0.5 } else { 0.3 });
        let is_elastic = draws.chance(0.2);
        let mut other = creep(&mut draws);
        other.terms.truncate(if is_elastic { 0 } else { 9 });
        let counter = bodies(periodic, cells, other, draws.between(0.1, 0.5));
        let shape = FnGeometry::new(waves(&mut draws, &own));
        let softest = own.creep.relaxed() + counter.creep.relaxed();
        let load = Load::force(draws.scale(1e-2, 0.3) * 1e-2 / softest * own.lengths()[0]);
        let speed = draws.power_of_ten(-2.0, 2.0);
        let angle = if periodic { draws.between(0.0, TAU) } else { 0.25 * TAU * draws.below(4) as f64 };
        // exactly along an axis where the bodies end
        let velocity = [angle.cos(), angle.sin()].map(|part| if part.abs() < 1e-9 { 0.0 } else { speed * part });
        let builder = || {
            builder_of(&shape, own.grid(), own.creep.material(own.nu))
                .kernel(own.kernel())
                .counter_body(counter.creep.material(counter.nu))
                .settings(Settings::default().with_tolerance(1e-8).with_edge(Edge::Allow))
        };
        let unsaid = builder().build_sliding();
        assert_eq!(unsaid.is_ok(), is_elastic, "{number}");
        let said = unsaid.map_or_else(|error| error.to_string(), |_| "Builder::counter_motion".into());
        assert!(said.contains("Builder::counter_motion"), "{said}");
        let grid = own.grid();
        let gap: Vec<f64> = (0..cells[0] * cells[1])
            .map(|k| grid.center(k / cells[1], k % cells[1]))
            .map(|[x1, x2]| shape.initial_gap(x1, x2))
            .collect();
        let motions = [(CounterMotion::Slides, [0.0; 2]), (CounterMotion::Rolls, velocity)];
        let frictions = motions.map(|(motion, of_counter)| {
            let mut sliding = builder().counter_motion(motion).build_sliding().unwrap();
            let report = sliding.at(velocity, load).unwrap_or_else(|error| panic!("{number} {motion:?}: {error}"));
            let influences = [own.influence(velocity), counter.influence(of_counter)];
            let own = errors(&influences, &gap, load, &sliding, &report);
            let found = [own.gap, own.penetration, own.drag];
            let name = format!("{number} {motion:?} {report}");
            (0..3).for_each(|k| all[k].push(found[k], &name));
            report.friction()
        });
        assert!(!is_elastic || (frictions[0] / frictions[1] - 1.0).abs() < 1e-6, "{number}: {frictions:?}");
        ratios.push(frictions[1] / frictions[0], &number.to_string());
    }
    ratios.print("rolling over sliding", 1);
    for ((own, what), most) in all.iter().zip(["gap", "penetration", "drag"]).zip([3.0, 3.0, 1e-6]) {
        own.print(what, 1);
        assert!(own.greatest() < most, "{what} {}", own.greatest());
    }
    assert!(ratios.greatest() > 1.5 || from_environment("SLIDING_ASKED", 12) < 12, "motions differ");
}

/// A counter-body that flows rolls, but does not slide; beside a modulus over frequency there is none.
#[test]
fn counter_bodies_that_have_no_state_are_refused() {
    let grid = Grid::square(16, 4.0e-3).unwrap();
    let [solid, fluid] = [0.0, 2.0e-6].map(|fluidity| GeneralizedKelvin::new(1e-6, fluidity, &[(1e-6, 0.1)]).unwrap());
    let builder = |other: &GeneralizedKelvin| {
        builder_of(&Sphere::new(10.0e-3).unwrap(), grid.clone(), Material::incompressible(solid.clone()))
            .counter_body(Material::incompressible(other.clone()))
    };
    let rolls = builder(&fluid).counter_motion(CounterMotion::Rolls).build_sliding();
    assert!(rolls.unwrap().at([0.1, 0.0], Load::force(0.05)).unwrap().friction() > 0.0);
    let text = |refused: viscocontact::Result<SteadySliding>| refused.unwrap_err().to_string();
    let slides = builder(&fluid).counter_motion(CounterMotion::Slides).build_sliding();
    assert!(text(slides).contains("a counter-body that slides and flows is not covered"));
    let by_modulus =
        builder_of(&Wavy::new(1e-6, 4.0e-3).unwrap(), grid.clone(), Material::incompressible(solid.clone()))
            .kernel(InfluenceKernel::periodic(&grid).unwrap())
            .counter_body(Material::incompressible(solid.clone()))
            .build_sliding_by(|_| Complex64::new(1e6, 0.0));
    assert!(text(by_modulus).contains("a counter-body beside a modulus over frequency"));
}

/// Friction from tables that are cut is told to be, where it is wrong by more than a quarter; within the tables nothing is told.
#[test]
fn frequencies_beyond_the_data_are_told() {
    let (mut wrong, mut told_of, mut silent, mut unsaid) = (Ratios::default(), [0; 2], Ratios::default(), 0);
    for (number, mut draws) in scenes() {
        let periodic = number % 3 > 0;
        let of = bodies(periodic, [24, 24], Creep { glassy: 1e-8, terms: Vec::new() }, 0.5);
        let (shape, grid) = (FnGeometry::new(waves(&mut draws, &of)), of.grid());
        let speed = draws.power_of_ten(-2.0, 2.0);
        // the frequencies of the longest wave of the grid and of the shortest
        let [slowest, fastest] = [TAU / of.lengths()[0], TAU / 2.0].map(|q| q * speed);
        let covers = number % 4 == 0;
        let [from, until] = match draws.below(2) {
            _ if covers => [1e-3 * slowest, 10.0 * fastest],
            0 => [1e-5 * slowest, slowest * draws.power_of_ten(-2.5, 1.5)],
            _ => [fastest * draws.power_of_ten(-1.5, 2.5), 1e5 * fastest],
        };
        // all over the data and beyond, or relaxed by their end
        let times = if covers { [1.0 / until, 1e-2 / from] } else { [1e-7, 1e7] };
        let decades = (times[1] / times[0]).log10() as i32;
        let mut term = |k: i32| (1e6 * draws.scale(0.3, 3.0), times[0] * 10f64.powi(k) * draws.scale(1.0, 3.0));
        let body = GeneralizedMaxwell::new(0.3e6, &(0..=decades).map(&mut term).collect::<Vec<_>>()).unwrap();
        let spectrum = body.creep_spectrum().unwrap().relaxation();
        let count = (8.0 * (until / from).log10()) as i32;
        let row = |w: f64| (w, spectrum.complex_modulus(w).re, spectrum.complex_modulus(w).im);
        let rows: Vec<_> = (0..=count).map(|k| row(from * 10f64.powf(f64::from(k) / 8.0))).collect();
        let fit = Measurements::dynamic(&rows).unwrap().fit().unwrap();
        let depth = if periodic { 1e-2 } else { 0.1 };
        let load = Load::force(0.2 * depth * 1e6 * draws.scale(0.3, 3.0) * of.lengths()[0]);
        let at = |material: Material| {
            let settings = Settings::default().with_edge(Edge::Allow);
            let builder = builder_of(&shape, grid.clone(), material).kernel(of.kernel()).settings(settings);
            builder.build_sliding().unwrap().at([speed, 0.0], load).unwrap()
        };
        let [found, exact] = [at(Material::incompressible(fit)), at(Material::incompressible(body.clone()))];
        let off = (found.friction() / exact.friction() - 1.0).abs();
        let told = found.messages().any(|message| message.contains("was not measured"));
        assert_eq!(told, found.warnings.contains(Warnings::FREQUENCIES));
        assert!(!exact.warnings.contains(Warnings::FREQUENCIES), "{number}: a formula is known at all frequencies");
        assert!(!(covers && told), "{number}: {found}");
        println!("{number}: {periodic} covers {covers} told {told} {off:.3} {:?}", found.figures.unmeasured);
        // contact on single cells is told to be: a little softer, and it has others
        unsaid += usize::from(off > 0.25 && !told && !found.warnings.contains(Warnings::FEW_CELLS));
        told_of[usize::from(told)] += 1;
        let list = if told { &mut wrong } else { &mut silent };
        list.push(off, &number.to_string());
    }
    wrong.print("off where told", 2);
    silent.print("off where silent", 2);
    assert_eq!(unsaid, 0, "{}", silent.greatest());
    assert!(told_of.iter().all(|count| *count > 1) && wrong.greatest() > 0.25, "{told_of:?}");
}

/// A height map with one step in its period is refused, one without is computed, wherever its origin lies.
#[test]
fn saw_teeth_do_not_depend_on_their_origin() {
    for (number, mut draws) in scenes() {
        let cells = [12 + draws.below(20), 4 + draws.below(6)];
        let (n, axis, steps) = (cells[0], draws.below(2), number % 2 == 0);
        // down within one cell, or within a third of the period
        let flank = if steps { 1 } else { n / 3 };
        let bumps: Vec<f64> = (0..n * cells[1]).map(|_| draws.between(0.0, 0.2 / n as f64)).collect();
        let height = |i: usize, j: usize| {
            let (up, along) = ((n - flank) as f64, (i % n) as f64);
            let tooth = if along <= up { along / up } else { (n as f64 - along) / flank as f64 };
            4e-3 * (tooth + bumps[i % n * cells[1] + j])
        };
        let on_grid = if axis == 0 { cells } else { [cells[1], cells[0]] };
        let grid = Grid::new(on_grid, on_grid.map(|n| n as f64)).unwrap();
        let material = creep(&mut draws).material(0.5);
        let velocity = if axis == 0 { [0.3, 0.0] } else { [0.0, 0.3] };
        let at = |shift: usize| {
            let of = |k: usize| {
                let [i, j] = [k / on_grid[1], k % on_grid[1]];
                if axis == 0 { height(i + shift, j) } else { height(j + shift, i) }
            };
            let map = HeightMap::new(on_grid, grid.lengths(), (0..grid.len()).map(|k| -of(k)).collect()).unwrap();
            let builder = builder_of(&map, grid.clone(), material.clone())
                .kernel(InfluenceKernel::periodic(&grid).unwrap())
                .settings(Settings::default().with_tolerance(1e-9));
            builder.build_sliding()?.at(velocity, Load::force(500.0)).map(|report| report.friction())
        };
        let all: Vec<_> = (0..n).map(at).collect();
        for found in &all {
            match (found, &all[0]) {
                (Ok(found), Ok(first)) if !steps => assert!((found / first - 1.0).abs() < 1e-6, "{found} {first}"),
                (Err(error), Err(_)) if steps => {
                    assert!(error.to_string().contains("jumps once in the period"), "{error}")
                }
                other => panic!("{number}: {other:?}"),
            }
        }
    }
}

/// Moduli E′ − i E″, everywhere or from a frequency on, are refused with the modulus and the convention.
#[test]
fn moduli_that_give_energy_away_are_refused() {
    for (number, mut draws) in scenes() {
        let grid = Grid::square(8 + draws.below(9), 1.0).unwrap();
        let (power, time, scale) =
            (draws.between(0.1, 0.9), draws.power_of_ten(-3.0, 1.0), draws.power_of_ten(4.0, 9.0));
        let loses = move |omega: f64| scale * (1.0 + Complex64::new(0.0, omega * time).powf(power));
        let speed = draws.power_of_ten(-1.0, 2.0);
        let q = TAU * draws.between(0.7, 0.4 * grid.cells()[0] as f64);
        let from = match number % 3 {
            0 => 0.0,
            1 => q * speed,
            _ => 2.0 * TAU * grid.cells()[0] as f64 * speed, // no wave is so fast
        };
        let modulus = move |omega: f64| if omega > from { loses(omega).conj() } else { loses(omega) };
        let shape = FnGeometry::new(|x1: f64, x2: f64| 1e-3 * (2.0 - (TAU * x1).cos() - (TAU * x2).cos()));
        let builder = ViscoelasticContact::builder(grid.clone())
            .geometry(&shape)
            .kernel(InfluenceKernel::periodic(&grid).unwrap());
        let found = builder.build_sliding_by(modulus).unwrap().at([speed, 0.0], Load::force(1e-4 * scale));
        match found {
            Ok(report) => assert!(number % 3 == 2 && report.friction() > 0.0, "{number}: {report}"),
            Err(error) => {
                let text = error.to_string();
                assert_eq!(error.code(), "sliding_not_passive", "{number}: {text}");
                let omega = error.value().unwrap();
                assert!(number % 3 < 2 && omega > from, "{number}: {text}");
                assert!(text.contains("E' + i E'' bodies have E' > 0 and E'' >= 0"), "{text}");
                let said: Vec<f64> = text.split(' ').filter_map(|word| word.parse().ok()).collect();
                for (said, exact) in said.iter().zip([omega, modulus(omega).re, modulus(omega).im]) {
                    assert!((said / exact - 1.0).abs() < 1e-3, "{text}: {said} {exact}");
                }
            }
        }
    }
}

/// Layers much thinner than a cell, whose losses cells do not resolve: bodies that would drive the motion are refused, whose
/// dissipation is never negative else.
#[test]
fn bodies_that_would_drive_are_refused() {
    let (mut driven, mut resisted) = (0, 0);
    for (number, mut draws) in scenes() {
        let mut own = bodies(false, [16, 12], creep(&mut draws), draws.between(0.1, 0.49));
        own.base = if number % 2 == 0 { Base::Frictionless } else { Base::Rigid };
        own.thickness = draws.power_of_ten(-2.9, 0.5);
        let shape = FnGeometry::new(waves(&mut draws, &own));
        let builder = builder_of(&shape, own.grid(), own.creep.material(own.nu)).kernel(own.kernel());
        let settings = Settings::default().with_edge(Edge::Allow);
        let mut sliding = builder.settings(settings).build_sliding().unwrap();
        for decade in -4..4 {
            let speed = 10f64.powi(decade);
            match sliding.at([speed, 0.0], Load::approach(0.05)) {
                Ok(report) => {
                    assert!(report.dissipation() >= 0.0, "{number}: {report}");
                    resisted += 1;
                }
                Err(error) if error.code() == "sliding_drives" => {
                    let part = error.value().unwrap();
                    assert!(part > 0.0 && own.thickness < 1.0, "{number}: {part}");
                    driven += 1;
                }
                Err(error) => panic!("{number}: {error}"),
            }
        }
    }
    println!("{driven} would drive, {resisted} resist");
    assert!(driven > 0 && resisted > 0);
}
