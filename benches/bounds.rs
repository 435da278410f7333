//! What bounds a convolution: its floating-point operations against the rate of transforms that lie in the cache, its bytes
//! against the bandwidth of a copy, on one thread and two; and what a second thread gains in whole steps. Least times of
//! alternating runs, so that a busy machine disturbs the ratios little.
//!
//! Operations: N transforms of rows in pairs and 2 N of columns, forth and back, each of 2 N complex values and 5 n log₂ n
//! operations. Bytes: pressure and displacement once (16 a cell), half of the spectrum of the padded rows four times (64),
//! the kernel's (8).

#[path = "../examples/support/scenes/step_loaded_sphere.rs"]
mod step_loaded_sphere;

use std::hint::black_box;
use std::time::Instant;

use num_complex::Complex64;
use rayon::prelude::*;
use rustfft::FftPlanner;
use step_loaded_sphere::StepLoadedSphere;
use viscocontact::prelude::*;
use viscocontact::{Grid, InfluenceKernel};

const CELLS: [usize; 6] = [64, 128, 256, 512, 1024, 2048];

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

/// The least seconds of `runs` runs of each of two things, turn about.
fn least(runs: usize, mut pair: [Box<dyn FnMut() + '_>; 2]) -> [f64; 2] {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..runs {
        for (run, least) in pair.iter_mut().zip(&mut least) {
            let start = Instant::now();
            run();
            *least = least.min(start.elapsed().as_secs_f64());
        }
    }
    least
}

/// Bytes read and written per second by a copy between fields far larger than the caches.
fn bandwidth(pools: &[rayon::ThreadPool; 2]) -> [f64; 2] {
    const LEN: usize = 1 << 25;
    let from = vec![1.0_f64; LEN];
    let mut to = [vec![0.0_f64; LEN], vec![0.0_f64; LEN]];
    let [one, two] = &mut to;
    let copy = |pool: &rayon::ThreadPool, to: &mut [f64]| {
        pool.install(|| {
            to.par_chunks_mut(1 << 16).zip(from.par_chunks(1 << 16)).for_each(|(to, from)| to.copy_from_slice(from))
        });
    };
    let seconds = least(9, [Box::new(|| copy(&pools[0], one)), Box::new(|| copy(&pools[1], two))]);
    seconds.map(|s| 16.0 * LEN as f64 / s)
}

/// Operations per second of complex transforms of `len` values that lie in the cache.
fn fft_rate(pools: &[rayon::ThreadPool; 2], len: usize) -> [f64; 2] {
    let plan = FftPlanner::new().plan_fft_forward(len);
    let times = (1 << 22) / len;
    let run = |pool: &rayon::ThreadPool, threads: usize| {
        pool.install(|| {
            (0..threads).into_par_iter().for_each(|_| {
                let (mut row, mut scratch) =
                    (vec![Complex64::default(); len], vec![Complex64::default(); plan.get_inplace_scratch_len()]);
                (0..times / threads).for_each(|_| plan.process_with_scratch(black_box(&mut row), &mut scratch));
            });
        });
    };
    let seconds = least(9, [Box::new(|| run(&pools[0], 1)), Box::new(|| run(&pools[1], 2))]);
    let n = len as f64;
    seconds.map(|s| times as f64 * 5.0 * n * n.log2() / s)
}

fn convolutions(pools: &[rayon::ThreadPool; 2]) {
    let bytes_per_second = bandwidth(pools);
    println!("copy: {:.1} GB/s on one thread, {:.1} on two\n", bytes_per_second[0] / 1e9, bytes_per_second[1] / 1e9);
    println!(
        "cells  ms, 1 thread  2 threads  ratio | Gflop/s of transforms in the cache, 1, 2 | share of it, 1, 2 | GB/s | share of a copy, 1, 2"
    );
    for cells in CELLS {
        let grid = Grid::square(cells, 1.0).unwrap();
        let kernel = InfluenceKernel::half_space(&grid).unwrap();
        let pressure = vec![1.0; grid.len()];
        let run = |pool: &rayon::ThreadPool| {
            let (mut out, mut work) = (vec![0.0; grid.len()], pool.install(|| kernel.workspace().unwrap()));
            let (kernel, pressure) = (&kernel, &pressure);
            move |times: usize| {
                (0..times).for_each(|_| kernel.convolve(black_box(pressure), &mut out, &mut work).unwrap());
            }
        };
        let times = (1 << 20) / grid.len() + 1;
        let (mut one, mut two) = (run(&pools[0]), run(&pools[1]));
        let seconds =
            least(12, [Box::new(|| pools[0].install(|| one(times))), Box::new(|| pools[1].install(|| two(times)))])
                .map(|s| s / times as f64);
        let n = cells as f64;
        let (operations, bytes) = (30.0 * n * n * (2.0 * n).log2(), 88.0 * n * n);
        let rate = fft_rate(pools, 2 * cells);
        let share = |k: usize| operations / rate[k] / seconds[k];
        let traffic = |k: usize| bytes / bytes_per_second[k] / seconds[k];
        println!(
            "{cells:5}  {:.4}  {:.4}  {:.2} | {:.1} {:.1} | {:.2} {:.2} | {:.1} {:.1} | {:.2} {:.2}",
            1e3 * seconds[0],
            1e3 * seconds[1],
            seconds[0] / seconds[1],
            rate[0] / 1e9,
            rate[1] / 1e9,
            share(0),
            share(1),
            bytes / seconds[0] / 1e9,
            bytes / seconds[1] / 1e9,
            traffic(0),
            traffic(1),
        );
    }
}

/// Ten warm steps of a Zener sphere on one thread and two.
fn steps(pools: &[rayon::ThreadPool; 2]) {
    println!("\ncells  grid     ms a step, 1 thread  2 threads  ratio");
    let scene = StepLoadedSphere::zener();
    let whole = Settings::default().with_symmetry(false).with_window(false);
    for cells in [256, 512, 1024] {
        for (name, settings) in [("whole", whole), ("default", Settings::default())] {
            let start = |pool: &rayon::ThreadPool| pool.install(|| scene.run(cells, 20, settings).unwrap().0);
            let contacts = pools.each_ref().map(start);
            let run = |k: usize| {
                let (contact, pool) = (&contacts[k], &pools[k]);
                move || {
                    let mut contact = contact.clone();
                    pool.install(|| (0..10).for_each(|_| assert!(contact.step(0.02, Load::force(1.0)).is_ok())));
                }
            };
            let seconds = least(if cells == 1024 { 5 } else { 12 }, [Box::new(run(0)), Box::new(run(1))]);
            println!(
                "{cells:5}  {name:7}  {:.3}  {:.3}  {:.2}",
                1e2 * seconds[0],
                1e2 * seconds[1],
                seconds[0] / seconds[1]
            );
        }
    }
}

fn main() {
    let pools = [pool(1), pool(2)];
    convolutions(&pools);
    steps(&pools);
}
