//! Steady motions as one problem, against closed forms and limits; against dense problems on all bodies in `sliding_chains`.

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::common::builder_of;
use crate::common::fields::gap;
use crate::common::refused::{not_covered, refused};
use crate::io::numbers_of;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::contact::Builder;
use viscocontact::output::Format;
use viscocontact::prelude::*;
use viscocontact::rheology::TimeTemperature;
use viscocontact::sliding::{SlidingReport, SlidingSweep};

/// Waves of an indenter over its period of 1 m: numbers along x1 and x2, phase, height.
const WAVES: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.3, 2e-4], [2.0, 1.0, 1.0, 1e-4], [-1.0, 3.0, 2.0, 1e-4], [3.0, 3.0, 4.0, 5e-5]];

fn body() -> GeneralizedKelvin {
    GeneralizedKelvin::new(1e-6, 0.0, &[(2e-6, 1e-3), (3e-6, 0.1), (4e-6, 30.0)]).unwrap()
}

fn rubber() -> Material {
    Material::incompressible(body())
}

fn on_waves(cells: usize, material: Material) -> Builder {
    let grid = Grid::square(cells, 1.0).unwrap();
    let wave = |[a, b, phase, h]: [f64; 4], x1: f64, x2: f64| h * (TAU * (a * x1 + b * x2) + phase).cos();
    let height = move |x1: f64, x2: f64| WAVES.map(|own| wave(own, x1, x2)).iter().sum::<f64>();
    builder_of(&FnGeometry::new(height), grid.clone(), material)
        .kernel(InfluenceKernel::periodic(&grid).unwrap())
        .settings(Settings::default().with_tolerance(1e-10))
}

fn wavy(cells: usize) -> SteadySliding {
    on_waves(cells, rubber()).build_sliding().unwrap()
}

/// C(iω) of the contact from the series, an eighth of J: an incompressible body has C = J/4.
fn complex_compliance(omega: f64) -> [f64; 2] {
    [(2e-6, 1e-3), (3e-6, 0.1), (4e-6, 30.0)].iter().fold([0.25e-6, 0.0], |[real, imaginary], (j, time)| {
        let x: f64 = omega * time;
        [real + 0.25 * j / (1.0 + x * x), imaginary - 0.25 * j * x / (1.0 + x * x)]
    })
}

/// In full contact every wave has its own resistance, ¼ |q| (q·v/v) h² Im 1/C*(i q·v) on a unit of area, whatever the direction.
#[test]
fn full_contact_resists_wave_by_wave() {
    let mut sliding = wavy(16);
    for (speed, angle) in [(0.0, 0.0), (1e-3, 0.4), (0.1, 2.0), (1.0, -1.0), (30.0, 0.0), (1e4, 1.5)] {
        let velocity = [speed * f64::cos(angle), speed * f64::sin(angle)];
        let report = sliding.at(velocity, Load::force(1e5)).unwrap();
        assert_eq!(report.contact_cells, 256);
        let exact = WAVES.iter().fold([0.0; 2], |[f1, f2], [a, b, _, h]| {
            let q = [TAU * a, TAU * b];
            let [real, imaginary] = complex_compliance(q[0] * velocity[0] + q[1] * velocity[1]);
            let loss = -imaginary / (real * real + imaginary * imaginary);
            let part = 0.25 * q[0].hypot(q[1]) * h * h * loss;
            [f1 + q[0] * part, f2 + q[1] * part]
        });
        let scale = exact[0].hypot(exact[1]).max(1e-6);
        for axis in 0..2 {
            let error = (report.lateral_force[axis] - exact[axis]).abs();
            assert!(error < 1e-8 * scale, "{speed} {angle}: {:?} {exact:?}", report.lateral_force);
        }
    }
}

/// An eccentric force on a blunt body that tilts freely: at rest all that is read of the steady state are the readings of the elastic contact with the relaxed body,
/// and in motion load and moments balance, and the mirrored motion under the mirrored force is the mirror image.
#[test]
fn a_steady_state_is_read_like_a_contact() {
    let grid = Grid::square(48, 1.0).unwrap();
    let shape = FnGeometry::new(|x1, x2| 0.4 * (x1 * x1 + x2 * x2).powi(2));
    let builder = |body| {
        let settings = Settings::default().with_tolerance(1e-10);
        builder_of(&shape, grid.clone(), body).settings(settings)
    };
    let load = Load::eccentric_force(500.0, [0.03, -0.02]);
    let mut sliding = builder(rubber()).build_sliding().unwrap();
    sliding.at([0.0; 2], load).unwrap();
    let mut still = builder(Material::incompressible(Elastic::new(1e5).unwrap())).build().unwrap();
    still.step(0.0, load).unwrap();
    let readings = |contact: Fields<'_>| -> Vec<(&'static str, Vec<f64>)> {
        let (patches, profile) = (contact.patches().unwrap(), contact.profile(Axis::X2, 0.1).unwrap());
        let stress = contact.stress().unwrap().at(&[[0.0, 0.0, 0.1], [0.1, 0.2, 0.3]]).unwrap();
        let (folder, metadata) = (crate::common::Temporary::folder("steady-gap"), Metadata::new("steady"));
        let series = FrameSeries::create(&*folder, Format::Npz, &metadata, contact, &[Field::Gap], Earlier::Refuse);
        let file = series.unwrap().record(contact).unwrap();
        vec![
            ("pressure", contact.pressure().to_vec()),
            ("displacement", contact.displacement().to_vec()),
            ("gap", gap(contact)),
            ("gap of a file", numbers_of(&file, "gap")),
            ("approach", vec![contact.approach()]),
            ("tilt", contact.tilt().to_vec()),
            ("force", vec![contact.force()]),
            ("area", vec![contact.contact_area(), contact.contact_cells() as f64]),
            ("maximum", vec![contact.max_pressure(), contact.mean_pressure()]),
            ("patches", patches.all.iter().flat_map(|patch| [patch.area, patch.force / 500.0]).collect()),
            ("profile", [profile.pressure, profile.gap.iter().map(|gap| 1e6 * gap).collect()].concat()),
            ("stress", stress.iter().map(|own| own.von_mises()).collect()),
            ("stiffness", vec![contact.stiffness_over_modulus().unwrap()]),
        ]
    };
    let both: Vec<_> = readings(sliding.fields()).into_iter().zip(readings(still.fields())).collect();
    assert_eq!(both.len(), 13);
    for ((what, found), (_, exact)) in both {
        let scale = exact.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
        let differ = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(found.len() == exact.len() && scale > 0.0 && differ < 1e-6 * scale, "{what}: {differ:e} of {scale:e}");
    }
    let [ahead, back] = [1.0, -1.0].map(|sign: f64| {
        let report = sliding.at([0.5 * sign, 0.0], Load::eccentric_force(500.0, [0.03 * sign, -0.02])).unwrap();
        let contact = sliding.fields();
        let cells = contact.pressure().iter().enumerate().map(|(k, p)| (*p, grid.center(k / 48, k % 48)));
        let moments = cells
            .fold([0.0; 3], |[f, m1, m2], (p, [x1, x2])| [f + p, m1 + p * (x1 - 0.03 * sign), m2 + p * (x2 + 0.02)]);
        assert!((moments[0] / (48.0 * 48.0) / 500.0 - 1.0).abs() < 1e-12);
        assert!(moments[1..].iter().all(|moment| moment.abs() < 1e-10 * moments[0]), "{moments:?}");
        let deepest = gap(contact).into_iter().fold(f64::INFINITY, f64::min);
        assert!(deepest > -1e-8 && contact.pressure().iter().all(|p| *p >= 0.0), "{deepest}");
        (report.friction(), report.approach, contact.tilt())
    });
    assert!(ahead.0 > 1e-3 && (ahead.0 / back.0 - 1.0).abs() < 1e-7 && (ahead.1 / back.1 - 1.0).abs() < 1e-8);
    assert!((ahead.2[0] + back.2[0]).abs() < 1e-8 && (ahead.2[1] - back.2[1]).abs() < 1e-8, "{ahead:?} {back:?}");
}

/// Another thread ends a search within it, or a sweep: the state found last is kept, and the search repeated finds what one finds that was not ended.
#[test]
fn a_search_is_ended_by_another_thread() {
    let (velocity, load) = ([3.0, 1.0], Load::force(40.0));
    let flag = Arc::new(AtomicBool::new(false));
    let mut sliding = wavy(512).cancelled_by(Arc::clone(&flag));
    let ended = std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(100));
            flag.store(true, Ordering::Relaxed);
        });
        sliding.at(velocity, load)
    });
    assert!(matches!(ended, Err(Error::Cancelled { .. })), "{ended:?}");
    let mut sliding = wavy(32).cancelled_by(Arc::clone(&flag));
    flag.store(false, Ordering::Relaxed);
    sliding.at([0.0; 2], Load::force(10.0)).unwrap();
    let pressure = sliding.fields().pressure().to_vec();
    flag.store(true, Ordering::Relaxed);
    let swept = sliding.sweep(&SlidingSweep::new([velocity], [load])).map(drop);
    for ended in [sliding.at(velocity, load).map(drop), swept] {
        assert!(matches!(ended, Err(Error::Cancelled { .. })), "{ended:?}");
        assert_eq!(sliding.fields().pressure(), pressure, "the state found last is kept");
    }
    flag.store(false, Ordering::Relaxed);
    // a sweep whose report of progress sets the flag ends within the next state
    let states = [[0.0; 2], velocity];
    let swept = sliding.sweep_with(&SlidingSweep::new(states, [load]), |_, _| {
        flag.store(true, Ordering::Relaxed);
        ControlFlow::Continue(())
    });
    assert!(matches!(swept, Err(Error::Cancelled { .. })), "{swept:?}");
    flag.store(false, Ordering::Relaxed);
    let [found, exact] = [sliding, wavy(32)].map(|mut own| own.at(velocity, load).unwrap().friction());
    assert!((found - exact).abs() < 1e-8 * exact);
}

#[test]
fn what_is_not_steady_is_refused() {
    let grid = Grid::square(16, 1.0).unwrap();
    let of = |shape: &dyn Geometry| builder_of(shape, grid.clone(), rubber());
    let on_periodic = |shape: &dyn Geometry| of(shape).kernel(InfluenceKernel::periodic(&grid).unwrap());
    let periodic = || on_periodic(&FnGeometry::new(|x1, _| (TAU * x1).cos()));
    let fluid = Material::incompressible(Maxwell::with_time(1.0, 1.0).unwrap());
    let law = ExponentialAttraction::new(1.0, 1.0).unwrap();
    // heights that jump from one end of a period to the other, and coefficients at cells alone
    let slope = |axis: usize| {
        let slope = FnGeometry::new(move |x1: f64, x2: f64| 0.1 * [x1, x2][axis] + 1e-3 * (TAU * x1).cos());
        on_periodic(&slope).build_sliding().err()
    };
    let kernel = InfluenceKernel::from_coefficients(&grid, |i, j| 1.0 / (1.0 + (i * i + j * j) as f64)).unwrap();
    let mut sliding = periodic().build_sliding().unwrap();
    let before = sliding.at([1.0, 0.0], Load::force(1.0)).unwrap();
    let pressure = sliding.fields().pressure().to_vec();
    let mut at = |velocity: f64, load: Load| sliding.at([velocity, 0.0], load).err();
    not_covered([
        (periodic().material(fluid).build_sliding().err(), "a body that flows is not covered in steady motion"),
        (
            periodic().another_body(&FnGeometry::new(|x1, _| (TAU * x1).sin())).build_sliding().err(),
            "several rigid bodies is not covered in steady motion",
        ),
        (periodic().attraction(law).build_sliding().err(), "attract each other is not covered in steady motion"),
        (slope(0), "jumps"),
        (slope(1), "jumps"),
        (
            of(&Sphere::new(1.0).unwrap()).kernel(kernel).build_sliding().err(),
            "a body of coefficients is not covered in steady motion",
        ),
        (at(1.0, Load::eccentric_force(1.0, [0.1, 0.0])), "tilts the body along x1"),
        (at(1.0, Load::approach_and_tilt(0.0, [0.1, 0.0])), "tilts the body along x1"),
        (at(1.0, Load::spring(1.0, 1.0)), "a body on a spring is not covered in steady motion"),
    ]);
    refused([
        (at(1.0, Load::approach(1.0)), "that of full contact"),
        (at(f64::NAN, Load::force(1.0)), "velocity along x1"),
        (at(1.0, Load::force(-1.0)), "normal force"),
    ]);
    assert_eq!(sliding.fields().pressure(), pressure);
    let apart = sliding.at([1.0, 0.0], Load::force(0.0)).unwrap();
    assert!(apart.contact_cells == 0 && apart.friction() == 0.0 && before.friction() > 0.0);
    // an approach that does not touch leaves nothing undetermined
    let apart = periodic().build_sliding().unwrap().at([1.0, 0.0], Load::approach(-2.0)).unwrap();
    assert!(apart.contact_cells == 0 && apart.force == 0.0 && apart.residual == 0.0, "{apart:?}");
    // memory: stated before, in proportion to the cells
    let memory = |cells: usize| {
        let grid = Grid::square(cells, 1.0).unwrap();
        builder_of(&Sphere::new(1.0).unwrap(), grid, rubber()).sliding_memory().unwrap() as f64
    };
    assert!((memory(512) / memory(256) / 4.0 - 1.0).abs() < 0.05, "{} {}", memory(256), memory(512));
}

/// A sweep has the states of single problems, at each temperature those of the body there, vertical factors included, and shows the last; it ends where its
/// progress says so, and its file can be read back.
#[test]
fn a_sweep_is_its_states() {
    let law = TimeTemperature::wlf(8.61, 200.4, 298.15).unwrap();
    let law = law.with_vertical_factors(&[(270.0, 0.9), (298.15, 1.0), (320.0, 1.3)]).unwrap();
    let (velocities, loads) = ([[1e-2, 0.0], [1.0, 1.0], [30.0, -4.0]], [Load::force(20.0), Load::approach(-1e-4)]);
    let kelvins = [273.15, 298.15, 313.15];
    let sweep = SlidingSweep::new(velocities, loads).at_temperatures(law.clone(), kelvins);
    let (mut last, mut swept) = (0.0, wavy(16));
    let table = swept
        .sweep_with(&sweep, |_, share| {
            assert!(share > last);
            last = share;
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!(last == 1.0 && table.states().len() == 18);
    for (k, state) in table.states().iter().enumerate() {
        assert_eq!(state.temperature, Some(kelvins[k / 6]));
        assert_eq!((state.load, state.report.velocity), (loads[k / 3 % 2], velocities[k % 3]));
        let there = Material::incompressible(law.at(body(), kelvins[k / 6]).unwrap());
        let mut own = on_waves(16, there).build_sliding().unwrap();
        let single = own.at(state.report.velocity, state.load).unwrap();
        assert!((state.report.friction() - single.friction()).abs() < 1e-8 * single.friction().abs().max(1e-3), "{k}");
        assert!((state.report.mean_gap - single.mean_gap).abs() < 1e-10);
        assert_eq!(state.report.contact_cells, single.contact_cells);
        let (found, exact) = (state.report, single);
        for (found, exact) in [
            (found.force, exact.force),
            (found.approach, exact.approach),
            (found.lateral_force[0], exact.lateral_force[0]),
        ] {
            assert!((found / exact - 1.0).abs() < 1e-5, "{k}: {found} {exact}");
        }
        if k == 17 {
            let [shown, own] = [swept.fields(), own.fields()];
            assert!((shown.force() / own.force() - 1.0).abs() < 1e-5 && shown.load() == state.load);
            assert!((shown.max_pressure() / own.max_pressure() - 1.0).abs() < 1e-4);
        }
    }
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| wavy(16).sweep(&sweep)).unwrap(), table, "the same bits on {threads} threads");
    }
    let ended = wavy(16).sweep_with(&sweep, |_, _| ControlFlow::Break(())).unwrap();
    assert_eq!(ended.states().len(), 1);
    let folder = crate::common::Temporary::folder("sliding_sweep");
    table.write_csv(folder.join("mu.csv")).unwrap();
    table.chart("coefficient of friction", SlidingReport::friction).save(folder.join("mu.png")).unwrap();
    let mut rows = csv::Reader::from_path(folder.join("mu.csv")).unwrap();
    let friction: Vec<f64> = rows.records().map(|row| row.unwrap()[5].parse().unwrap()).collect();
    assert_eq!(friction, table.states().iter().map(|state| state.report.friction()).collect::<Vec<_>>());
}
