//! What is seen of a run at given times, and how far two runs are apart.

use viscocontact::Error;
use viscocontact::prelude::*;

use super::random_scenes::RandomScene;

/// A number from the environment.
pub fn from_environment(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}

/// States of a run at the times to look at, and what it took.
#[derive(Debug, Clone, Default)]
pub struct Watched {
    pub times: Vec<f64>,
    /// Force where the approach is given, otherwise the approach.
    pub answer: Vec<f64>,
    pub pressure: Vec<Vec<f64>>,
    /// Greatest answer and pressure of the whole run.
    pub greatest: [f64; 2],
    pub steps: u64,
    pub rejected: u64,
    pub equivalents: f64,
}

impl Watched {
    /// Contact problems, those of rejected steps included.
    pub fn problems(&self) -> u64 {
        self.steps + self.rejected
    }

    pub fn greatest_pressures(&self) -> Vec<f64> {
        self.pressure.iter().map(|field| field.iter().copied().fold(0.0, f64::max)).collect()
    }

    pub fn pressures_in(&self, cell: usize) -> Vec<f64> {
        self.pressure.iter().map(|field| field[cell]).collect()
    }

    /// The cell that is in contact at most of the times, with the greatest pressure among those.
    pub fn central_cell(&self) -> usize {
        let cells = self.pressure.first().map_or(0, Vec::len);
        let held = |cell: usize| {
            let pressures = self.pressure.iter().map(|field| field[cell]);
            let touched = pressures.clone().filter(|&p| p > 0.0).count() as f64;
            touched + pressures.sum::<f64>() / (1e-300 + self.greatest[1] * self.pressure.len() as f64)
        };
        (0..cells).max_by(|&a, &b| held(a).total_cmp(&held(b))).unwrap_or(0)
    }
}

/// Why a run did not come to its end.
#[derive(Debug)]
pub enum Stopped {
    Failed {
        time: f64,
        error: Error,
    },
    /// After so many steps.
    Endless {
        time: f64,
        steps: u64,
    },
}

/// Follows the history of a scene, and looks at it at its moments.
pub fn watch(
    scene: &RandomScene,
    contact: &mut ViscoelasticContact,
    history: &dyn LoadHistory,
    stepping: Stepping,
    stops: &[f64],
    most_steps: u64,
) -> Result<Watched, Stopped> {
    let moments = scene.moments();
    let by_approach = scene.control.is_approach();
    let mut run = contact.follow(history, stepping, scene.body.until).stop_at(stops).unwrap();
    let mut seen = Watched::default();
    loop {
        let report = match run.next_step() {
            Ok(Some(report)) => report,
            Ok(None) => break,
            Err(error) => return Err(Stopped::Failed { time: run.contact().time(), error }),
        };
        seen.steps += 1;
        seen.equivalents += report.convolution_equivalents();
        let answer = if by_approach { report.force } else { report.approach };
        let pressure = run.contact().pressure().iter().copied().fold(0.0, f64::max);
        seen.greatest = [seen.greatest[0].max(answer.abs()), seen.greatest[1].max(pressure)];
        if report.time > 0.0 && moments.binary_search_by(|time| time.total_cmp(&report.time)).is_ok() {
            seen.times.push(report.time);
            seen.answer.push(answer);
            seen.pressure.push(run.contact().pressure().to_vec());
        }
        if seen.steps + run.rejected_steps() >= most_steps {
            return Err(Stopped::Endless { time: report.time, steps: seen.steps });
        }
    }
    seen.rejected = run.rejected_steps();
    Ok(seen)
}

/// Greatest difference of two sequences over `scale`.
fn apart(one: &[f64], other: &[f64], scale: f64) -> f64 {
    assert_eq!(one.len(), other.len());
    one.iter().zip(other).fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs())) / scale.max(f64::MIN_POSITIVE)
}

/// The truth on the mesh, and how well it is known: of the answer, the greatest pressure, the pressure of a central cell.
pub struct Truth {
    answer: Vec<f64>,
    pressures: [Vec<f64>; 2],
    times: Vec<f64>,
    cell: usize,
    greatest: [f64; 2],
    pub uncertainty: [f64; 3],
    pub steps: u64,
    pub levels: u32,
}

/// The limit of runs each with half the steps of the one before, by the order that the last three show, one to four; and how
/// far it is from the limit of the runs before the last, or a part of the last difference.
fn extrapolated(runs: &[Vec<f64>], scale: f64) -> (Vec<f64>, f64) {
    let limit = |runs: &[Vec<f64>]| -> Vec<f64> {
        let [.., coarse, middle, fine] = runs else { unreachable!("three runs or more") };
        let ratio = (apart(middle, coarse, scale) / apart(fine, middle, scale).max(1e-300)).clamp(2.0, 16.0);
        fine.iter().zip(middle).map(|(f, m)| f + (f - m) / (ratio - 1.0)).collect()
    };
    let (last, best) = (runs.len() - 1, limit(runs));
    let uncertainty = apart(&best, &limit(&runs[..last]), scale).max(apart(&runs[last], &runs[last - 1], scale) / 40.0);
    (best, uncertainty)
}

impl Truth {
    /// Halves given steps until the answer is known to `wanted`, or a run would take more than `most_steps`.
    pub fn of(scene: &RandomScene, wanted: f64, most_steps: u64) -> Result<Truth, Stopped> {
        let mut runs: Vec<Watched> = Vec::new();
        let mut work = 0;
        loop {
            let times = scene.graded_times(runs.len() as u32);
            let mut contact = scene.contact(1e-9);
            let stepping = Stepping::fixed(10.0 * scene.body.until);
            let run = watch(scene, &mut contact, scene.load(), stepping, &times, u64::MAX)?;
            work += run.steps;
            runs.push(run);
            let (count, fine) = (runs.len(), &runs[runs.len() - 1]);
            if count < 4 {
                continue;
            }
            let cell = fine.central_cell();
            let of = |pick: &dyn Fn(&Watched) -> Vec<f64>, scale: f64| {
                let last: Vec<_> = runs[count - 4..].iter().map(pick).collect();
                extrapolated(&last, scale)
            };
            let (answer, u0) = of(&|run| run.answer.clone(), fine.greatest[0]);
            let (top, u1) = of(&Watched::greatest_pressures, fine.greatest[1]);
            let (central, u2) = of(&|run| run.pressures_in(cell), fine.greatest[1]);
            if u0 <= wanted || 2 * fine.steps > most_steps {
                return Ok(Truth {
                    answer,
                    pressures: [top, central],
                    times: fine.times.clone(),
                    cell,
                    greatest: fine.greatest,
                    uncertainty: [u0, u1, u2],
                    steps: work,
                    levels: runs.len() as u32,
                });
            }
        }
    }

    /// Errors of a run, relative to the greatest values.
    pub fn errors(&self, run: &Watched) -> [f64; 3] {
        assert_eq!(run.times, self.times, "both runs stop at every moment");
        [
            apart(&run.answer, &self.answer, self.greatest[0]),
            apart(&run.greatest_pressures(), &self.pressures[0], self.greatest[1]),
            apart(&run.pressures_in(self.cell), &self.pressures[1], self.greatest[1]),
        ]
    }
}
