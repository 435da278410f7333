//! A sphere on many cells: seconds of a step, of them in messages; bytes on the wire and in memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use viscocontact::parallel::{Ranks, RanksError};
use viscocontact::prelude::*;

/// Ranks whose messages are counted and timed.
#[derive(Debug)]
struct Counted {
    ranks: Arc<dyn Ranks>,
    /// Bytes sent to others by exchanges, and nanoseconds in them; number of gathers, bytes that they bring, nanoseconds in them.
    bytes: AtomicU64,
    exchanging: AtomicU64,
    gathers: AtomicU64,
    gathered: AtomicU64,
    gathering: AtomicU64,
}

/// What a rank has seen of a run: seconds, and bytes.
pub struct Seen {
    build: f64,
    cold: f64,
    warm: f64,
    report: StepReport,
    /// What was counted in the warm step.
    messages: [f64; 5],
    told: viscocontact::contact::Memory,
}

/// A jump of the force, and three steps, the last of which is the warm one; on a quarter of the grid by symmetry, or all of it.
pub fn run(cells: usize, quarter: bool, ranks: Option<Arc<dyn Ranks>>) -> viscocontact::Result<Seen> {
    let start = Instant::now();
    let counted = ranks.map(|ranks| Arc::new(Counted::new(ranks)));
    let builder = ViscoelasticContact::builder(Grid::square(cells, 4.0e-3)?);
    let builder = match &counted {
        Some(ranks) => builder.ranks(Arc::clone(ranks) as Arc<dyn Ranks>),
        None => builder,
    };
    let builder = builder
        .geometry(&Sphere::new(10.0e-3)?)
        .material(Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?))
        .settings(Settings::default().with_symmetry(quarter).with_window(false));
    let told = builder.memory()?;
    let mut contact = builder.build()?;
    let build = start.elapsed().as_secs_f64();
    let mut step = |dt: f64| {
        counted.iter().for_each(|ranks| ranks.reset());
        let start = Instant::now();
        let report = contact.step(dt, Load::force(1.0))?;
        Ok::<_, viscocontact::Error>((start.elapsed().as_secs_f64(), report))
    };
    let (cold, _) = step(0.0)?;
    step(0.2)?;
    step(0.2)?;
    let (warm, report) = step(0.2)?;
    let messages = counted.as_ref().map_or([0.0; 5], |ranks| ranks.read());
    Ok(Seen { build, cold, warm, report, messages, told })
}

impl Seen {
    /// A row for `docs/scale.md`, from what the first of `ranks` saw; `processes` of them share the peak of memory.
    pub fn print(&self, cells: usize, ranks: usize, in_this_process: usize) {
        let Seen { build, cold, warm, report, messages: [bytes, exchanging, gathers, gathered, gathering], told } =
            self;
        let own = told.computed_cells as f64;
        println!(
            "{cells} cells, {ranks} ranks: build {build:.2} s, cold {cold:.2} s, warm {warm:.3} s ({} convolutions, {} \
             preconditioner); in exchanges {:.3} s, in {gathers} sums of {:.0} kB {:.3} s; a cell: sent {:.1} B, memory told {:.1} B, peak {:.1} B",
            report.convolutions,
            report.preconditioner_applications,
            exchanging * 1e-9,
            gathered * 1e-3 / gathers,
            gathering * 1e-9,
            bytes / own,
            told.total() as f64 / own,
            peak_memory().unwrap_or(f64::NAN) / own / in_this_process as f64,
        );
    }
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
        Counted { ranks, bytes: zero(), exchanging: zero(), gathers: zero(), gathered: zero(), gathering: zero() }
    }

    fn counters(&self) -> [&AtomicU64; 5] {
        [&self.bytes, &self.exchanging, &self.gathers, &self.gathered, &self.gathering]
    }

    fn reset(&self) {
        self.counters().iter().for_each(|counter| counter.store(0, Ordering::Relaxed));
    }

    fn read(&self) -> [f64; 5] {
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
        self.gathers.fetch_add(1, Ordering::Relaxed);
        self.gathered.fetch_add(size_of_val(all) as u64, Ordering::Relaxed);
        self.gathering.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }

    fn exchange(
        &self,
        send: &[f64],
        send_counts: &[usize],
        received: &mut [f64],
        receive_counts: &[usize],
    ) -> Result<(), RanksError> {
        let start = Instant::now();
        let done = self.ranks.exchange(send, send_counts, received, receive_counts);
        let to_others = send.len() - send_counts[self.rank()];
        self.bytes.fetch_add((to_others * size_of::<f64>()) as u64, Ordering::Relaxed);
        self.exchanging.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }
}
