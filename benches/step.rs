//! Times of the parts and of the whole: cold solve, warm step, scene.

#[path = "../examples/support/scenes/step_loaded_sphere.rs"]
mod step_loaded_sphere;

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use step_loaded_sphere::StepLoadedSphere;
use viscocontact::prelude::*;

/// What is computed, and how.
fn choices() -> [(&'static str, Settings); 3] {
    let settings = Settings::default();
    [
        ("default", settings),
        ("no symmetry", settings.with_symmetry(false)),
        ("whole grid", settings.with_symmetry(false).with_window(false)),
    ]
}

fn cold_solve(c: &mut Criterion) {
    let mut group = c.benchmark_group("cold solve, 128²");
    let scene = StepLoadedSphere::maxwell();
    for (name, settings) in choices() {
        let contact = scene.contact(128, settings).unwrap();
        group.bench_function(name, |b| {
            b.iter_batched_ref(
                || contact.clone(),
                |contact| contact.step(0.0, Load::force(1.0)).unwrap(),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

fn warm_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("warm step");
    group.sample_size(10);
    let scene = StepLoadedSphere::maxwell();
    for (name, settings) in choices() {
        for cells in [32, 64, 128, 256, 512, 1024] {
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let (contact, _) = pool.install(|| scene.run(cells, 20, settings).unwrap());
                group.bench_function(BenchmarkId::new(format!("{name}, {threads} threads"), cells), |b| {
                    b.iter_batched_ref(
                        || contact.clone(),
                        |contact| pool.install(|| contact.step(1e-3, Load::force(1.0)).unwrap()),
                        BatchSize::LargeInput,
                    );
                });
            }
        }
    }
    group.finish();
}

/// The same contact on a grid that it fills a sixteenth of.
fn small_contact(c: &mut Criterion) {
    let mut group = c.benchmark_group("scene, contact on 1/16 of 256², 20 steps");
    group.sample_size(10);
    let scene = StepLoadedSphere::maxwell();
    for (name, settings) in choices() {
        let grid = Grid::square(256, 7.09 * scene.reference().unwrap().contact_radius(scene.duration)).unwrap();
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut contact = scene.contact_on(grid.clone(), settings).unwrap();
                contact.step(0.0, Load::force(1.0)).unwrap();
                for _ in 0..20 {
                    contact.step(0.1, Load::force(1.0)).unwrap();
                }
            });
        });
    }
    group.finish();
}

/// The same creep from one retardation time and from thirty: what the history costs.
fn relaxation_times(c: &mut Criterion) {
    let mut group = c.benchmark_group("warm step, 256², relaxation times");
    for count in [1, 10, 30] {
        let terms: Vec<_> = (0..count).map(|k| (1.0e-6 / f64::from(count), 1.0 + 1e-4 * f64::from(k))).collect();
        let body = GeneralizedKelvin::new(1.0e-6, 0.0, &terms).unwrap();
        let scene = StepLoadedSphere { material: Material::incompressible(body), ..StepLoadedSphere::zener() };
        let (contact, _) = scene.run(256, 20, Settings::default()).unwrap();
        group.bench_function(BenchmarkId::from_parameter(count), |b| {
            b.iter_batched_ref(
                || contact.clone(),
                |contact| contact.step(0.02, Load::force(1.0)).unwrap(),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

/// A series for ten decades of a power law, and one through 161 noisy values.
fn fits(c: &mut Criterion) {
    let mut group = c.benchmark_group("fits");
    let power = PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap();
    group.bench_function("power law", |b| b.iter(|| power.series(1e-5..=1e5, 1e-4).unwrap()));
    let times: Vec<f64> = (0..=160).map(|k| 10f64.powf(-4.0 + 0.05 * f64::from(k))).collect();
    let rough = |(k, &t): (usize, &f64)| (t, power.creep_compliance(t) * (1.0 + 0.02 * (7.0 * k as f64).sin()));
    let rows: Vec<(f64, f64)> = times.iter().enumerate().map(rough).collect();
    group.bench_function("table", |b| b.iter(|| Measurements::creep(&rows).and_then(|table| table.fit()).unwrap()));
    group.finish();
}

fn whole_scene(c: &mut Criterion) {
    let mut group = c.benchmark_group("scene, 128² cells, 50 steps");
    group.sample_size(10);
    let scene = StepLoadedSphere::maxwell();
    group.bench_function("default", |b| b.iter(|| scene.run(128, 50, Settings::default()).unwrap()));
    group.bench_function("paper", |b| b.iter(|| scene.literally(128, 50).unwrap()));
    group.finish();
}

criterion_group!(benches, cold_solve, warm_step, small_contact, relaxation_times, fits, whole_scene);
criterion_main!(benches);
