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

fn whole_scene(c: &mut Criterion) {
    let mut group = c.benchmark_group("scene, 128² cells, 50 steps");
    group.sample_size(10);
    let scene = StepLoadedSphere::maxwell();
    group.bench_function("default", |b| b.iter(|| scene.run(128, 50, Settings::default()).unwrap()));
    group.bench_function("paper", |b| b.iter(|| scene.run(128, 50, Settings::paper()).unwrap()));
    group.finish();
}

criterion_group!(benches, convolution, cold_solve, warm_step, whole_scene);
criterion_main!(benches);
