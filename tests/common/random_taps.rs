//! Bodies that are tapped and let go, drawn at random, and their forces by a foundation that is
//! marched beside.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use viscocontact::prelude::*;
use viscocontact::states::ElasticStates;

use super::draws::Draws;
use super::foundation::{Drive, Foundation, Relaxation};

/// Finenesses of the foundation: steps in the run and elements, and by how many times more the next
/// has, until two agree.
const FIRST: [f64; 2] = [10_000.0, 150.0];
const FINER: [f64; 2] = [2.0, 1.5];
const FINENESSES: i32 = 6;
/// Maximum difference of two finenesses, over the tolerance, of a reference that judges.
const DOUBT: f64 = 0.5;
/// A time is judged if the finenesses agree at so many times on both sides as well: where they cross they agree by chance.
const AROUND: usize = 4;
/// Share of the times at which the finest two may differ by more; these times are not judged.
const MOST_UNKNOWN: f64 = 0.05;
const TOLERANCES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

type Part = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// A body that is tapped.
pub struct Taps {
    pub name: String,
    pub tolerance: f64,
    pub until: f64,
    pub material: Material,
    pub states: Arc<ElasticStates>,
    pub history: Box<dyn LoadHistory>,
    body: Relaxation,
    gap: fn(f64) -> f64,
    /// Radius of the elements; of the only one, under a punch.
    radius: f64,
    /// Approach or drive at a time, and the stiffness of the spring; 0 for an approach.
    part: Part,
    spring: f64,
    /// Times of its corners, if it is a table.
    corners: Vec<f64>,
}

/// A run of the foundation.
pub struct Marched {
    /// Force and approach at the times asked for, `None` where steps to them are too short to be
    /// rounded well, and the maximum of each in contact.
    pub found: Vec<Option<[f64; 2]>>,
    pub greatest: [f64; 2],
    /// The part of the elements that were touched.
    reached: f64,
}

/// Time, force and approach.
pub type Point = (f64, [f64; 2]);

/// A contact modulus as a material, G = E*/4.
fn material(body: &Relaxation) -> Material {
    let Relaxation { equilibrium, terms, viscosity } = body;
    if *viscosity > 0.0 {
        return Material::incompressible(KelvinVoigt::new(0.25 * equilibrium, 0.25 * viscosity).unwrap());
    }
    let terms: Vec<_> = terms.iter().map(|&(modulus, tau)| (0.25 * modulus, tau)).collect();
    Material::incompressible(GeneralizedMaxwell::new(0.25 * equilibrium, &terms).unwrap())
}

/// Fluids of one to three relaxation times, solids with 1e-5 to all of their modulus left, and
/// Kelvin-Voigt bodies; times from 1e-4 of the run.
fn body(draws: &mut Draws, until: f64) -> (String, Relaxation) {
    let (modulus, tau) = (draws.power_of_ten(4.0, 8.0), until * draws.power_of_ten(-4.0, 0.0));
    let kind = draws.below(6);
    if kind == 5 {
        let body = Relaxation { equilibrium: modulus, terms: Vec::new(), viscosity: modulus * tau };
        return (format!("Kelvin-Voigt, {:.1e}", tau / until), body);
    }
    let mut terms = vec![(modulus, tau)];
    for _ in 0..[0, 1, 2, 0, 1 + draws.below(2)][kind] {
        terms.push((modulus * draws.power_of_ten(-1.0, 0.0), tau * draws.power_of_ten(-1.5, 1.5)));
    }
    let left = if kind < 3 { 0.0 } else { draws.power_of_ten(-5.0, 0.0) };
    let name = format!("{} times from {:.1e}, {left:.1e} left", terms.len(), tau / until);
    (name, Relaxation { equilibrium: left * modulus, terms, viscosity: 0.0 })
}

/// Name, part of the depth at a time, and the rows of a table; of one that begins apart, for bodies
/// that follow no jump.
fn drive(draws: &mut Draws, until: f64, jumps: bool) -> (String, Part, Vec<(f64, f64)>) {
    let (duty, phase) = (draws.power_of_ten(-2.0, 0.0), draws.between(0.0, TAU));
    let phase = if jumps { phase } else { -0.5 * PI };
    let smooth = |name: String, part: Part| (name, part, Vec::new());
    match draws.below(5) {
        0 => {
            let periods = draws.between(2.0, 12.0);
            let part = move |t: f64| 1.0 + ((TAU * periods * t / until + phase).sin() - 1.0) / duty;
            smooth(format!("sine, {periods:.1} periods, tops of {duty:.2}"), Arc::new(part))
        }
        1 => {
            let (slow, fast, mean) = (draws.between(1.0, 4.0), draws.between(8.0, 40.0), draws.between(-0.5, 0.5));
            let part = move |t: f64| {
                let s = t / until;
                mean + (1.0 - mean) * (PI * slow * s).sin().powi(2) * (TAU * fast * s + phase).sin()
            };
            smooth(format!("bursts, {slow:.1} of {fast:.1} about {mean:.2}"), Arc::new(part))
        }
        2 => {
            let (rate, sweep) = (draws.between(2.0, 6.0), draws.between(0.5, 3.0));
            let part = move |t: f64| {
                let s = t / until;
                1.0 + ((TAU * rate * (s + sweep * s * s) + phase).sin() - 1.0) / duty
            };
            smooth(format!("sine, {rate:.1} periods, swept by {sweep:.1}, tops of {duty:.2}"), Arc::new(part))
        }
        3 => {
            let low = if draws.chance(0.3) { 0.0 } else { -draws.power_of_ten(-2.0, 0.5) };
            let pulses: Vec<[f64; 3]> = (0..1 + draws.below(6))
                .map(|k| {
                    let top = if k == 0 { 1.0 } else { draws.between(0.1, 1.0) };
                    [draws.between(0.05, 0.95), draws.power_of_ten(-2.5, -1.0), top - low]
                })
                .collect();
            let name = format!("{} pulses from {low:.2}", pulses.len());
            let part = move |t: f64| {
                let pulse = |&[at, width, top]: &[f64; 3]| top * (-((t / until - at) / width).powi(2)).exp();
                low + pulses.iter().map(pulse).fold(0.0, f64::max)
            };
            smooth(name, Arc::new(part))
        }
        _ => {
            let (count, lowest) = (4 + draws.below(40), -draws.power_of_ten(-1.0, 0.5));
            let mut times: Vec<f64> = (0..count).map(|_| until * draws.between(0.0, 1.0)).collect();
            times.sort_by(f64::total_cmp);
            let (mut rows, highest) = (vec![(0.0, lowest)], draws.below(count));
            let value = |k: usize, other: f64| if k == highest { 1.0 } else { other };
            let row = |(k, time): (usize, f64)| (time, value(k, draws.between(lowest, 1.0)));
            rows.extend(times.into_iter().enumerate().map(row));
            rows.push((until, lowest));
            let table = rows.clone();
            let part = move |t: f64| {
                let next = table.partition_point(|row| row.0 < t).clamp(1, table.len() - 1);
                let [(start, from), (end, to)] = [table[next - 1], table[next]];
                from + (to - from) * (t - start) / (end - start)
            };
            (format!("table of {} rows from {lowest:.2}", rows.len()), Arc::new(part), rows)
        }
    }
}

impl Taps {
    pub fn new(seed: u64) -> Taps {
        let draws = &mut Draws::new(seed.wrapping_add(71_000_000));
        let (tolerance, until, depth) = (TOLERANCES[draws.below(4)], draws.power_of_ten(-3.0, 3.0), 1e-5);
        let (of_body, body) = body(draws, until);
        let jumps = body.viscosity == 0.0;
        let (of_drive, part, rows) = drive(draws, until, jumps);
        let first = if jumps { 0.0 } else { part(0.0).max(0.0) };
        let is_by_spring = draws.chance(0.5);
        // a punch under an approach is one number
        let (name, gap, states, radius): (_, fn(f64) -> f64, _, _) = match draws.below(if is_by_spring { 8 } else { 7 })
        {
            0..=3 => ("ball", |x| x * x / 1e-2, ElasticStates::sphere(1e-2), (depth * 1e-2_f64).sqrt()),
            4 | 5 => ("cone", |x| 0.05 * PI * x, ElasticStates::cone(0.1), depth / (0.05 * PI)),
            6 => {
                let radius = (depth / (8.0 / 3.0 * 1e6_f64)).powf(0.25);
                ("r⁴", |x| 8.0 / 3.0 * 1e6 * x.powi(4), ElasticStates::power(1e6, 4.0), radius)
            }
            _ => ("punch", |_| 0.0, ElasticStates::punch(1e-4), 1e-4),
        };
        let over = draws.scale(0.05, 20.0);
        let spring = if is_by_spring { over * 2.0 * radius * body.over(0.05 * until) } else { 0.0 };
        let depth = if is_by_spring { depth * (1.0 + 1.0 / over) } else { depth };
        let part: Part = Arc::new(move |t| depth * (part(t) - first) / (1.0 - first));
        let load = |value: f64| if spring > 0.0 { Load::spring(spring, value) } else { Load::approach(value) };
        let corners = rows.iter().map(|row| row.0).filter(|time| *time < until).collect();
        let history: Box<dyn LoadHistory> = if rows.is_empty() {
            let (part, spring) = (Arc::clone(&part), spring);
            Box::new(FnHistory::new(move |t| {
                let value = part(t);
                if spring > 0.0 { Load::spring(spring, value) } else { Load::approach(value) }
            }))
        } else {
            let rows: Vec<_> = rows.into_iter().map(|(time, part)| (time, load(depth * part))).collect();
            Box::new(PiecewiseLinear::new(&rows).unwrap())
        };
        let by = if spring > 0.0 { format!("a spring {over:.1e} as stiff") } else { "approach".into() };
        let name = format!("{seed}: {name} by {by}, {of_body}, {of_drive}, {tolerance:.0e}");
        let (material, states) = (material(&body), states.unwrap());
        let mut taps =
            Taps { name, tolerance, until, material, states, history, body, gap, radius, part, spring, corners };
        // a spring lets the bodies come as deep as its far end at most
        if gap(radius) > 0.0 {
            while gap(taps.radius) < 1.01 * depth {
                taps.radius *= 1.1;
            }
            taps.radius *= (1.1 * taps.marched(&[], [2000, 1000]).reached + 0.03).min(1.0);
        }
        taps
    }

    /// Force and approach at these times, and the maximum of each in contact, by so many steps and
    /// elements.
    pub fn marched(&self, times: &[f64], [steps, elements]: [usize; 2]) -> Marched {
        let count = if (self.gap)(self.radius) == 0.0 { 1 } else { elements };
        let mut foundation = Foundation::new(&self.body, self.radius, count, self.gap);
        // jumps are no part of these scenes; one at the start is linear in a step of no length
        let (mut found, mut greatest) = (Vec::with_capacity(times.len()), [0.0f64; 2]);
        let even = (1..=steps).map(|k| self.until * k as f64 / steps as f64);
        let mut ends: Vec<(f64, bool)> = even.map(|time| (time, false)).collect();
        ends.extend(self.corners.iter().map(|time| (*time, false)));
        ends.extend(times.iter().map(|time| (*time, true)));
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut now, mut before) = (0.0, (self.part)(0.0));
        if self.body.viscosity == 0.0 {
            foundation.step(0.0, self.drive(0.0, before, before));
        } else {
            foundation.depth = before;
        }
        for (end, is_asked_for) in ends {
            // changes in shorter steps are rounded
            let is_long = end - now > 1e-9 * self.until;
            if is_long {
                let value = (self.part)(end);
                foundation.step(end - now, self.drive(end, value, before));
                (now, before) = (end, value);
            }
            if foundation.force > 0.0 {
                greatest = [greatest[0].max(foundation.force), greatest[1].max(foundation.depth.abs())];
            }
            if is_asked_for {
                found
                    .push((is_long || end - now <= 1e-13 * self.until).then_some([foundation.force, foundation.depth]));
            }
        }
        Marched { found, greatest, reached: foundation.reached() }
    }

    fn drive(&self, time: f64, value: f64, before: f64) -> Drive {
        if self.spring > 0.0 {
            return Drive::Spring(self.spring, [value, before]);
        }
        let short = 1e-9 * self.until;
        let [one, two] = [1.0, 2.0].map(|k| (self.part)(time - k * short));
        Drive::Approach(value, 0.5 * (3.0 * value - 4.0 * one + two) / short)
    }

    fn apart(&self, a: &Option<[f64; 2]>, b: &Option<[f64; 2]>, greatest: [f64; 2]) -> f64 {
        let (Some(a), Some(b)) = (a, b) else { return 0.0 };
        let relative = |k: usize| if greatest[k] > 0.0 { (a[k] - b[k]).abs() / greatest[k] } else { 0.0 };
        relative(0).max(relative(1)) / self.tolerance
    }

    /// Errors of a run at some times in ascending order, in force and depth over the maximum of
    /// each, in tolerances; `None` where the finest foundations still differ by half a tolerance at
    /// more than a few times.
    pub fn errors(&self, points: &[Point]) -> Option<Vec<f64>> {
        assert!(points.len() > 100 && points.is_sorted_by(|a, b| a.0 <= b.0), "{}: not a run", self.name);
        let times: Vec<f64> = points.iter().map(|point| point.0).collect();
        let fineness = |k: i32| [0, 1].map(|axis| (FIRST[axis] * FINER[axis].powi(k)) as usize);
        let mut coarse = self.marched(&times, fineness(0));
        let known = coarse.found.iter().flatten().count();
        assert!(2 * known > times.len(), "{}: {known} of {} times are judged", self.name, times.len());
        for k in 1..FINENESSES {
            let fine = self.marched(&times, fineness(k));
            let doubt = coarse.found.iter().zip(&fine.found).map(|(a, b)| self.apart(a, b, fine.greatest));
            let agree: Vec<bool> = doubt.map(|doubt| doubt <= DOUBT).collect();
            let around = |k: usize| k.saturating_sub(AROUND)..(k + AROUND + 1).min(agree.len());
            let is_known: Vec<bool> = (0..agree.len()).map(|k| agree[around(k)].iter().all(|agree| *agree)).collect();
            let unknown = is_known.iter().filter(|is_known| !**is_known).count();
            // the force of a dashpot jumps where bodies return to an imprint, or where the rate changes
            if unknown == 0 || k + 1 == FINENESSES && unknown as f64 <= MOST_UNKNOWN * times.len() as f64 {
                let off = |k: usize| self.apart(&Some(points[k].1), &fine.found[k], fine.greatest);
                return Some((0..points.len()).map(|k| if is_known[k] { off(k) } else { 0.0 }).collect());
            }
            coarse = fine;
        }
        None
    }
}
