//! Times of the parts and of the whole: convolution, cold solve, warm step, scene.

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::StepLoadedSphere;
use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use viscocontact::prelude::*;

fn convolution(c: &mut Criterion) {
    let mut group = c.benchmark_group("convolution");
    for cells in [64, 128, 256, 512] {
        let grid = Grid::square(cells, 1.0).unwrap();
        let kernel = InfluenceKernel::half_space(&grid).unwrap();
        let mut work = kernel.workspace();
        let (pressure, mut out) = (vec![1.0; grid.len()], vec![0.0; grid.len()]);
        group.bench_function(BenchmarkId::from_parameter(cells), |b| {
            b.iter(|| kernel.convolve(black_box(&pressure), &mut out, &mut work).unwrap());
        });
    }
    group.finish();
}

fn cold_solve(c: &mut Criterion) {
    let mut group = c.benchmark_group("cold solve");
    let scene = StepLoadedSphere::maxwell();
    for (name, solver) in [("active set", Solver::ActiveSet), ("Polonsky–Keer", Solver::PolonskyKeer)] {
        let contact = scene.contact(128, Settings { solver, ..Settings::default() }).unwrap();
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
    let scene = StepLoadedSphere::maxwell();
    for cells in [32, 64, 128, 256] {
        let (contact, _) = scene.run(cells, 50, Settings::default()).unwrap();
        group.bench_function(BenchmarkId::from_parameter(cells), |b| {
            b.iter_batched_ref(
                || contact.clone(),
                |contact| contact.step(1e-3, Load::force(1.0)).unwrap(),
                BatchSize::LargeInput,
            );
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
    let rough = |(k, &t): (usize, &f64)| power.creep_compliance(t) * (1.0 + 0.02 * (7.0 * k as f64).sin());
    let values: Vec<f64> = times.iter().enumerate().map(rough).collect();
    group.bench_function("table", |b| b.iter(|| TabulatedCreep::new(&times, &values).unwrap()));
    group.finish();
}

fn whole_scene(c: &mut Criterion) {
    let mut group = c.benchmark_group("scene, 128² cells, 50 steps");
    group.sample_size(10);
    let scene = StepLoadedSphere::maxwell();
    group.bench_function("default", |b| b.iter(|| scene.run(128, 50, Settings::default()).unwrap()));
    group.bench_function("paper", |b| b.iter(|| scene.run(128, 50, Settings::paper()).unwrap()));
    group.finish();
}

criterion_group!(benches, convolution, cold_solve, warm_step, relaxation_times, fits, whole_scene);
criterion_main!(benches);
