//! Runs targets, each execution from a seed of its own, and prints the findings.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::source::{Source, split_mix};

/// Longer than so many times a piece of work no execution may take, on inputs as small as these: about 2 s on a machine that
/// does nothing else.
const SLOW: f64 = 200.0;
/// Executions that are shorter are not looked at.
const QUICK: Duration = Duration::from_secs(1);
/// How often a slow execution is repeated on a machine that does other things as well.
const REPETITIONS: usize = 5;
/// After this the process is given up, with the case that hangs.
const HANGS: u64 = 120;
/// So many findings of a target are printed.
const TOLD: usize = 12;

/// What was made of an input that did no harm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It was taken, and everything that came of it is a number.
    Accepted,
    /// It was refused, or something on the way, with an error.
    Refused,
}

/// Result of one execution; `Err` holds the finding.
pub type Verdict = Result<Outcome, String>;

/// Something that reads or accepts data.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    pub name: &'static str,
    /// Executions of the short run.
    pub short: u64,
    pub run: fn(&mut Source) -> Verdict,
}

/// What a target has been through.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    pub executions: u64,
    pub accepted: u64,
    pub slowest: Duration,
    /// Cases, each with its finding.
    pub findings: Vec<(u64, String)>,
    pub found: u64,
}

thread_local! {
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// What is being run, for the watch: its name, its case, and when it began, as seconds of the process.
static RUNNING: Mutex<(&str, u64)> = Mutex::new(("", 0));
static SINCE: AtomicU64 = AtomicU64::new(u64::MAX);

/// Keeps panics quiet, and ends the process with the name of what hangs.
pub fn watch() {
    std::panic::set_hook(Box::new(|info| PANIC.with(|text| *text.borrow_mut() = info.to_string().replace('\n', " "))));
    let start = Instant::now();
    std::thread::spawn(move || {
        let mut last = (u64::MAX, 0);
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let current = SINCE.load(Ordering::Relaxed);
            if current != last.0 {
                last = (current, start.elapsed().as_secs());
            } else if current != u64::MAX && start.elapsed().as_secs() - last.1 > HANGS {
                let (name, case) = RUNNING.lock().map_or(("?", 0), |running| *running);
                eprintln!("hangs: FUZZ_TARGET={name} FUZZ_CASE={case}");
                std::process::exit(1);
            }
        }
    });
}

/// One execution.
pub fn execute(target: &Target, case: u64) -> Verdict {
    let verdict = catch_unwind(AssertUnwindSafe(|| (target.run)(&mut Source::new(case))));
    verdict.unwrap_or_else(|_| Err(format!("panic: {}", PANIC.with(|text| text.take()))))
}

/// Time of an execution over the time of a piece of work right before and after it.
fn cost(target: &Target, case: u64) -> f64 {
    let time = |run: &dyn Fn()| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    let piece = || {
        let mut state = 1;
        std::hint::black_box((0..10_000_000).fold(0_u64, |sum, _| sum.wrapping_add(split_mix(&mut state))));
    };
    let before = time(&piece);
    let took = time(&|| _ = execute(target, case));
    took / (0.5 * (before + time(&piece)))
}

impl Tally {
    /// One execution, counted.
    pub fn take(&mut self, target: &Target, case: u64) {
        if let Ok(mut running) = RUNNING.lock() {
            *running = (target.name, case);
        }
        SINCE.fetch_add(1, Ordering::Relaxed);
        let start = Instant::now();
        let mut verdict = execute(target, case);
        let took = start.elapsed();
        if verdict.is_ok() && took > QUICK {
            let least = (0..REPETITIONS)
                .map(|_| cost(target, case))
                .fold(f64::INFINITY, |least, cost| if least > SLOW { least.min(cost) } else { least });
            if least > SLOW {
                verdict = Err(format!("slow: {least:.0} pieces of work"));
            }
        }
        self.executions += 1;
        self.slowest = self.slowest.max(took);
        match verdict {
            Ok(outcome) => self.accepted += u64::from(outcome == Outcome::Accepted),
            Err(what) => {
                self.found += 1;
                let alike = |other: &str| other.chars().take(60).eq(what.chars().take(60));
                let told = self.findings.iter().filter(|(_, other)| alike(other)).count();
                if told < 3 && self.findings.len() < TOLD {
                    println!("FUZZ_TARGET={} FUZZ_CASE={case}: {what}", target.name);
                    self.findings.push((case, what));
                }
            }
        }
    }

    /// One line for the record.
    pub fn line(&self, target: &Target) -> String {
        let percent = 100.0 * self.accepted as f64 / self.executions.max(1) as f64;
        let slowest = 1e3 * self.slowest.as_secs_f64();
        format!(
            "{:<16} {:>10} executions, {percent:>5.1} % accepted, slowest {slowest:.0} ms, {} findings",
            target.name, self.executions, self.found
        )
    }
}

/// The case of an execution: any number, the same from the same seed.
pub fn case(seed: u64, target: usize, execution: u64) -> u64 {
    let mut state = seed ^ (target as u64) << 56 ^ execution.wrapping_mul(0x2545_f491_4f6c_dd1d);
    split_mix(&mut state)
}

/// `Err` if a number is NaN.
pub fn known(what: &str, values: impl IntoIterator<Item = f64>) -> Result<(), String> {
    match values.into_iter().position(f64::is_nan) {
        Some(at) => Err(format!("NaN in {what}, entry {at}")),
        None => Ok(()),
    }
}

/// `Err` if a number is not finite.
pub fn finite(what: &str, values: impl IntoIterator<Item = f64>) -> Result<(), String> {
    match values.into_iter().enumerate().find(|(_, value)| !value.is_finite()) {
        Some((at, value)) => Err(format!("{value} in {what}, entry {at}")),
        None => Ok(()),
    }
}

/// Accepted or refused, by the result; the message of an error must not be empty.
pub fn judged<T>(result: viscocontact::Result<T>, look: impl FnOnce(T) -> Result<(), String>) -> Verdict {
    match result {
        Ok(value) => look(value).map(|()| Outcome::Accepted),
        Err(error) if error.to_string().is_empty() => Err("an error without words".to_owned()),
        Err(_) => Ok(Outcome::Refused),
    }
}
