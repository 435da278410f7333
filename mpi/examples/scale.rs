//! What a step takes on many cells: seconds, of them in messages; bytes on the wire and in memory. A row for `docs/scale.md`.
//!
//! `cargo build --release --example scale && mpirun -n 2 target/release/examples/scale 4096` (cells along a side); with
//! `quarter` behind it the scene is computed on a quarter of the grid, by symmetry; with `alone`, without ranks.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use num_complex::Complex64;
use viscocontact::prelude::*;
use viscocontact::ranks::{Ranks, RanksError};
use viscocontact_mpi::Mpi;

/// Ranks whose messages are counted and timed.
#[derive(Debug)]
struct Counted {
    ranks: Arc<dyn Ranks>,
    /// Bytes sent to others by exchanges, nanoseconds in them, and in gathers.
    bytes: AtomicU64,
    exchanging: AtomicU64,
    gathering: AtomicU64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |word: &str| arguments.iter().any(|argument| argument == word);
    let cells = arguments.first().map_or(Ok(1024), |cells| cells.parse())?;
    let counted = if has("alone") { None } else { Some(Arc::new(Counted::new(Mpi::start()?))) };
    let first = counted.as_ref().is_none_or(|ranks| ranks.rank() == 0);

    let start = Instant::now();
    let builder = ViscoelasticContact::builder(Grid::square(cells, 4.0e-3)?);
    let builder = match &counted {
        Some(ranks) => builder.ranks(Arc::clone(ranks) as Arc<dyn Ranks>),
        None => builder,
    };
    let builder = builder
        .geometry(&Sphere::new(10.0e-3)?)
        .material(Material::incompressible(Zener::new(1.0e6, 1.0e6, 1.0e6)?))
        .settings(Settings::default().with_symmetry(has("quarter")).with_window(false));
    let told = builder.memory()?;
    let mut contact = builder.build()?;
    let mut seconds = vec![start.elapsed().as_secs_f64()];
    let mut last = None;
    for step in 0..4 {
        counted.iter().for_each(|ranks| ranks.reset());
        let start = Instant::now();
        last = Some(contact.step(if step == 0 { 0.0 } else { 0.2 }, Load::force(1.0))?);
        seconds.push(start.elapsed().as_secs_f64());
    }
    let Some(report) = last else { return Ok(()) };
    if first {
        let [bytes, exchanging, gathering] = counted.as_ref().map_or([0.0; 3], |ranks| ranks.read());
        let computed = told.computed_cells as f64;
        println!(
            "{cells} cells, {} ranks: build {:.2} s, cold {:.2} s, warm {:.2} s ({} convolutions, {} preconditioner); \
             in messages {:.2} s, sums {:.2} s; sent {:.1} B, memory told {:.1} B, peak {:.1} B, each for a cell of its own",
            counted.as_ref().map_or(1, |ranks| ranks.size()),
            seconds[0],
            seconds[1],
            seconds[4],
            report.convolutions,
            report.preconditioner_applications,
            exchanging * 1e-9,
            gathering * 1e-9,
            bytes / computed,
            told.total() as f64 / computed,
            peak_memory().unwrap_or(f64::NAN) / computed,
        );
    }
    Ok(())
}

/// The most memory that this process has had \[bytes\], as Linux tells it.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kilobytes| kilobytes * 1024.0)
}

impl Counted {
    fn new(ranks: Arc<dyn Ranks>) -> Counted {
        let zero = || AtomicU64::new(0);
        Counted { ranks, bytes: zero(), exchanging: zero(), gathering: zero() }
    }

    fn counters(&self) -> [&AtomicU64; 3] {
        [&self.bytes, &self.exchanging, &self.gathering]
    }

    fn reset(&self) {
        self.counters().iter().for_each(|counter| counter.store(0, Ordering::Relaxed));
    }

    fn read(&self) -> [f64; 3] {
        self.counters().map(|counter| counter.load(Ordering::Relaxed) as f64)
    }
}

impl Ranks for Counted {
    fn rank(&self) -> usize {
        self.ranks.rank()
    }

    fn size(&self) -> usize {
        self.ranks.size()
    }

    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) -> Result<(), RanksError> {
        let start = Instant::now();
        let done = self.ranks.gather(own, counts, all);
        self.gathering.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }

    fn exchange(
        &self,
        send: &[Complex64],
        send_counts: &[usize],
        received: &mut [Complex64],
        receive_counts: &[usize],
    ) -> Result<(), RanksError> {
        let start = Instant::now();
        let done = self.ranks.exchange(send, send_counts, received, receive_counts);
        let to_others = send.len() - send_counts[self.rank()];
        self.bytes.fetch_add((to_others * size_of::<Complex64>()) as u64, Ordering::Relaxed);
        self.exchanging.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }
}
