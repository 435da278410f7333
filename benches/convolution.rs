//! Times of a convolution: whole and against what it replaces, a plain transform of the whole padded grid; on one thread and
//! two. What matters are the ratios within one run.

use std::hint::black_box;
use std::time::Instant;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use num_complex::Complex64;
use realfft::RealFftPlanner;
use rustfft::FftPlanner;
use viscocontact::{Axis, Grid, InfluenceKernel};

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

fn convolution(c: &mut Criterion) {
    let mut group = c.benchmark_group("convolution");
    group.sample_size(20);
    for cells in [64, 128, 256, 512, 1024, 2048] {
        let grid = Grid::square(cells, 1.0).unwrap();
        let kernel = InfluenceKernel::half_space(&grid).unwrap();
        let (pressure, mut out) = (vec![1.0; grid.len()], vec![0.0; grid.len()]);
        for threads in [1, 2] {
            let pool = pool(threads);
            let mut work = pool.install(|| kernel.workspace().unwrap());
            group.bench_function(BenchmarkId::new(format!("{threads} threads"), cells), |b| {
                b.iter_custom(|times| {
                    pool.install(|| {
                        let start = Instant::now();
                        (0..times).for_each(|_| kernel.convolve(black_box(&pressure), &mut out, &mut work).unwrap());
                        start.elapsed()
                    })
                });
            });
        }
        let mut plain = Plain::new(cells);
        group.bench_function(BenchmarkId::new("plain, padded", cells), |b| {
            b.iter(|| plain.convolve(black_box(&pressure), &mut out));
        });
    }
    group.finish();
}

/// Bodies that are not half-spaces, on one thread: periodic ones are not padded, a line is transformed as a line.
fn other_bodies(c: &mut Criterion) {
    let mut group = c.benchmark_group("other bodies");
    group.sample_size(20);
    let (plane, line) = (Grid::square(256, 1.0).unwrap(), |cells| Grid::new([cells, 1], [1.0, 1.0]).unwrap());
    let kernels = [
        ("half-space 256²", InfluenceKernel::half_space(&plane)),
        ("periodic along one axis 256²", InfluenceKernel::periodic_along(&plane, Axis::X1, 1.0)),
        ("periodic 256²", InfluenceKernel::periodic(&plane)),
        ("half-space 64²", InfluenceKernel::half_space(&Grid::square(64, 1.0).unwrap())),
        ("line of 4096", InfluenceKernel::line(&line(4096), 1.0)),
        ("line of 512", InfluenceKernel::line(&line(512), 1.0)),
    ];
    for (name, kernel) in kernels {
        let kernel = kernel.unwrap();
        let (pressure, mut out) = (vec![1.0; kernel.grid().len()], vec![0.0; kernel.grid().len()]);
        let mut work = pool(1).install(|| kernel.workspace().unwrap());
        group.bench_function(name, |b| {
            b.iter(|| kernel.convolve(black_box(&pressure), &mut out, &mut work).unwrap());
        });
    }
    group.finish();
}

/// The textbook convolution: every row and column of the padded grid, forth and back.
struct Plain {
    cells: usize,
    rows: [Vec<f64>; 2],
    spectrum: Vec<Complex64>,
    kernel: Vec<f64>,
    plans: RealFftPlanner<f64>,
    columns: FftPlanner<f64>,
}

impl Plain {
    fn new(cells: usize) -> Plain {
        let (period, half) = (2 * cells, cells + 1);
        Plain {
            cells,
            rows: [vec![0.0; period * period], vec![0.0; period]],
            spectrum: vec![Complex64::default(); period * half],
            kernel: vec![1.0; period * half],
            plans: RealFftPlanner::new(),
            columns: FftPlanner::new(),
        }
    }

    fn convolve(&mut self, pressure: &[f64], out: &mut [f64]) {
        let (n, period, half) = (self.cells, 2 * self.cells, self.cells + 1);
        let (forward, inverse) = (self.plans.plan_fft_forward(period), self.plans.plan_fft_inverse(period));
        let columns = [self.columns.plan_fft_forward(period), self.columns.plan_fft_inverse(period)];
        let [padded, row] = &mut self.rows;
        padded.fill(0.0);
        for (padded, values) in padded.chunks_exact_mut(period).zip(pressure.chunks_exact(n)) {
            padded[..n].copy_from_slice(values);
        }
        for (padded, spectrum) in padded.chunks_exact_mut(period).zip(self.spectrum.chunks_exact_mut(half)) {
            forward.process(padded, spectrum).unwrap();
        }
        let mut column = vec![Complex64::default(); period];
        for k in 0..half {
            for (value, row) in column.iter_mut().zip(self.spectrum.chunks_exact(half)) {
                *value = row[k];
            }
            columns[0].process(&mut column);
            for (value, s) in column.iter_mut().zip(&self.kernel[k * period..]) {
                *value *= s;
            }
            columns[1].process(&mut column);
            for (value, row) in column.iter().zip(self.spectrum.chunks_exact_mut(half)) {
                row[k] = *value;
            }
        }
        for (i, spectrum) in self.spectrum.chunks_exact_mut(half).enumerate() {
            (spectrum[0].im, spectrum[half - 1].im) = (0.0, 0.0);
            inverse.process(spectrum, row).unwrap();
            if i < n {
                out[i * n..(i + 1) * n].copy_from_slice(&row[..n]);
            }
        }
    }
}

criterion_group!(benches, convolution, other_bodies);
criterion_main!(benches);
