//! Load histories drawn at random: holds, ramps, contact lost and made again, oscillation, powers of time, tables.

use std::f64::consts::{PI, TAU};

use viscocontact::prelude::*;

use super::draws::Draws;

/// What a number between 0 and 1 means as a load; numbers below 0 keep the bodies apart.
#[derive(Debug, Clone, Copy)]
pub enum Control {
    /// Of the greatest force \[N\].
    Force(f64),
    /// Of the greatest force \[N\], at this point \[m\].
    EccentricForce(f64, [f64; 2]),
    /// From the first touch \[m\], of the greatest depth \[m\].
    Approach { touch: f64, depth: f64 },
    /// The same, of the greatest drive of a spring \[m\], its stiffness \[N/m\], and how much stiffer it is than the bodies are in the end.
    Spring { touch: f64, depth: f64, stiffness: f64, over: f64 },
}

impl Control {
    /// A spring 1/20 to 20 times as stiff as the bodies are in the end, which presses them by about `force` to `depth`.
    pub fn by_spring(draws: &mut Draws, touch: f64, depth: f64, force: f64) -> Control {
        let over = draws.scale(0.05, 20.0);
        Control::Spring { touch, depth: depth * (1.0 + 1.0 / over), stiffness: over * force / depth, over }
    }

    pub fn load(&self, part: f64) -> Load {
        match *self {
            Control::Force(greatest) => Load::force(greatest * part.max(0.0)),
            Control::EccentricForce(greatest, at) => Load::eccentric_force(greatest * part.max(0.0), at),
            Control::Approach { touch, depth } => Load::approach(touch + depth * part),
            Control::Spring { touch, depth, stiffness, .. } => Load::spring(stiffness, touch + depth * part),
        }
    }

    pub fn is_approach(&self) -> bool {
        matches!(self, Control::Approach { .. } | Control::Spring { .. })
    }

    fn table(&self, rows: &[(f64, f64)]) -> Box<dyn LoadHistory> {
        let rows: Vec<_> = rows.iter().map(|&(time, part)| (time, self.load(part))).collect();
        Box::new(PiecewiseLinear::new(&rows).unwrap())
    }

    /// The history through these times and parts.
    pub(super) fn tabled(&self, name: String, rows: &[(f64, f64)]) -> RandomHistory {
        RandomHistory { name, history: self.table(rows), corners: corners_of(rows) }
    }

    fn function(&self, part: impl Fn(f64) -> f64 + Send + Sync + 'static, corners: &[f64]) -> Box<dyn LoadHistory> {
        let control = *self;
        Box::new(FnHistory::new(move |t| control.load(part(t))).with_breakpoints(corners).unwrap())
    }
}

/// Force, approach or drive.
pub fn size(load: Load) -> f64 {
    match load {
        Load::Force { normal: size, .. } | Load::Approach { approach: size, .. } | Load::Spring { drive: size, .. } => {
            size
        }
        _ => unreachable!("no other load"),
    }
}

/// A history, and the times at which it is not smooth, whether it names them or not.
pub struct RandomHistory {
    pub name: String,
    pub history: Box<dyn LoadHistory>,
    pub corners: Vec<f64>,
}

/// The times of a table, and those at which the bodies touch or part.
fn corners_of(rows: &[(f64, f64)]) -> Vec<f64> {
    let crossing = |pair: &[(f64, f64)]| {
        let [(t1, x1), (t2, x2)] = [pair[0], pair[1]];
        (x1 * x2 < 0.0).then(|| t1 + (t2 - t1) * x1 / (x1 - x2))
    };
    rows.iter().map(|row| row.0).chain(rows.windows(2).filter_map(crossing)).collect()
}

/// A history over `until` seconds, with jumps if `jumps`.
pub fn random_history(draws: &mut Draws, control: Control, until: f64, jumps: bool) -> RandomHistory {
    let apart = if control.is_approach() { -draws.between(0.1, 0.5) } else { 0.0 };
    let tabled = |name: String, rows: Vec<(f64, f64)>| control.tabled(name, &rows);
    match draws.below(10) {
        0 if jumps => tabled("held".into(), vec![(0.0, 1.0), (until, 1.0)]),
        0 | 1 => {
            let risen = until * draws.power_of_ten(-3.0, 0.0);
            tabled(
                format!("ramp to {:.1e} of the run, held", risen / until),
                vec![(0.0, 0.0), (risen, 1.0), (1.1 * until, 1.0)],
            )
        }
        2 => {
            let times: Vec<f64> = [0.25, 0.25, 0.2, 0.3].iter().map(|part| part * draws.between(0.5, 1.0)).collect();
            let at = |count: usize| until * times[..count].iter().sum::<f64>();
            let again = draws.between(0.3, 1.0);
            let rows =
                vec![(0.0, 0.0), (at(1), 1.0), (at(2), apart), (at(3), apart), (at(4), again), (1.1 * until, again)];
            tabled("triangle, apart, again".into(), rows)
        }
        3 if draws.chance(0.5) => {
            let (periods, least) = (draws.between(1.0, 4.0), draws.between(0.1, 0.8));
            let (low, high, period) = (control.load(least), control.load(1.0), until / periods);
            let (kind, built) = match draws.below(3) {
                0 if jumps => ("square", Periodic::square(high, low, period, 0.5)),
                1 if jumps => ("sawtooth", Periodic::sawtooth(low, high, period)),
                _ => ("triangle", Periodic::triangle(control.load(0.0), high, period)),
            };
            let corners = (0..=8).map(|half| 0.5 * f64::from(half) * period).collect();
            RandomHistory { name: format!("{kind}, {periods:.1} periods"), history: Box::new(built.unwrap()), corners }
        }
        3 => {
            let least = draws.between(0.1, 0.8);
            let times = [draws.between(0.1, 0.3), draws.between(0.4, 0.6), draws.between(0.7, 0.9)];
            let at = |k: usize| until * times[k];
            let rows = vec![(0.0, 0.0), (at(0), 1.0), (at(1), least), (at(2), 1.0), (1.1 * until, least)];
            tabled(format!("triangle down to {least:.2}"), rows)
        }
        4 => {
            let (low, cycles) = (draws.between(0.0, 0.7), draws.power_of_ten(-0.5, 0.8));
            let frequency = cycles / until;
            let history: Box<dyn LoadHistory> = if jumps {
                Box::new(Sinusoid::new(control.load(low), control.load(1.0), frequency).unwrap())
            } else {
                let part = move |t: f64| 0.5 * (1.0 - (TAU * frequency * t).cos());
                control.function(part, &[])
            };
            RandomHistory { name: format!("sine, {cycles:.1} cycles from {low:.2}"), history, corners: Vec::new() }
        }
        5 => {
            let (cycles, squared) = (draws.power_of_ten(-0.3, 0.6), draws.chance(0.5));
            let rate = PI * cycles / until;
            let zeros: Vec<f64> = (1..=cycles as usize).map(|k| until * k as f64 / cycles).collect();
            let named = draws.chance(0.5);
            let power = if squared { 2 } else { 1 };
            let part = move |t: f64| (rate * t).sin().abs().powi(power);
            let name = format!("|sin|^{power}, {cycles:.1} arcs{}", if named { "" } else { ", corners unnamed" });
            RandomHistory { name, history: control.function(part, if named { &zeros } else { &[] }), corners: zeros }
        }
        6 | 7 => {
            let power = draws.power_of_ten(0.3_f64.log10(), 3_f64.log10());
            // a body without elastic response would answer the infinite rate of a root with an infinite force
            let power = if control.is_approach() && !jumps { power.max(1.0) } else { power };
            let part = move |t: f64| (t / until).powf(power);
            RandomHistory { name: format!("t^{power:.2}"), history: control.function(part, &[]), corners: Vec::new() }
        }
        8 => {
            let count = 2 + draws.below(5);
            let mut times: Vec<f64> = (0..count).map(|_| until * draws.between(0.02, 0.95)).collect();
            times.sort_by(f64::total_cmp);
            let mut rows = vec![(0.0, if jumps && draws.chance(0.5) { draws.between(0.2, 1.0) } else { 0.0 })];
            for time in times {
                rows.push((time, draws.between(0.0, 1.0)));
                if jumps && draws.chance(0.3) {
                    rows.push((time, draws.between(0.1, 1.0)));
                }
            }
            rows.push((1.1 * until, draws.between(0.1, 1.0)));
            tabled(format!("table of {} rows", rows.len()), rows)
        }
        _ => {
            let apart = if control.is_approach() { apart } else { 0.0 };
            let (first, top) = (until * draws.between(0.0, 0.3), until * draws.between(0.5, 1.05));
            let rows = vec![(0.0, apart), (first, apart), (top, 1.0), (1.1 * until.max(top), apart)];
            tabled("late ramp".into(), rows)
        }
    }
}

/// Taps: arcs of a sine of `until` seconds, between which the bodies are apart.
pub fn taps(draws: &mut Draws, control: Control, until: f64) -> RandomHistory {
    let (low, cycles) = (-draws.between(0.1, 1.0), draws.power_of_ten(0.0, 0.8));
    let part = move |t: f64| low + (1.0 - low) * 0.5 * (1.0 - (TAU * cycles * t / until).cos());
    let history = control.function(part, &[]);
    RandomHistory { name: format!("{cycles:.1} taps from {low:.2}"), history, corners: Vec::new() }
}

/// Pulses, sines or arcs between which the bodies are apart, longer or shorter.
pub fn parting_history(draws: &mut Draws, control: Control, until: f64) -> RandomHistory {
    let smooth = |name: &str, part: Box<dyn Fn(f64) -> f64 + Send + Sync>| RandomHistory {
        name: name.into(),
        history: control.function(part, &[]),
        corners: Vec::new(),
    };
    match draws.below(4) {
        0 => taps(draws, control, until),
        1 => {
            let rate = TAU * draws.scale(0.5, 12.0) / until;
            let slow = rate * draws.between(0.05, 0.6);
            smooth("two sines", Box::new(move |t| 0.35 * (rate * t).sin() + 0.3 * (slow * t).sin() - 0.05))
        }
        2 => {
            let (first, second) = (until * draws.between(0.02, 0.2), until * draws.between(0.3, 0.7));
            let width = until * draws.scale(0.01, 0.1);
            let pulse = |t: f64| (-t * t).exp();
            let second = move |t| 0.9 * pulse((t - second) / width);
            smooth("two pulses", Box::new(move |t| 0.8 * pulse((t - first) / (0.3 * first)) + second(t) - 0.02))
        }
        _ => {
            let (mut rows, mut time) = (vec![(0.0, 0.0)], 0.0);
            for k in 1..=10 {
                time += draws.scale(0.02, 1.0);
                rows.push((time, if k % 2 == 1 { draws.between(0.2, 1.0) } else { draws.between(-0.6, 0.1) }));
            }
            rows.iter_mut().for_each(|row| row.0 *= until / time);
            control.tabled("table that parts".into(), &rows)
        }
    }
}

/// The same history, but never below a hundredth of its greatest load.
#[derive(Debug)]
pub struct FromSmallLoad<'a> {
    pub history: &'a dyn LoadHistory,
    pub least: Load,
    /// When the load crosses that \[s\], ascending.
    crossings: Vec<f64>,
}

/// Force, or approach.
fn main_value(load: &Load) -> f64 {
    let (Load::Force { normal: value, .. } | Load::Approach { approach: value, .. }) = *load else { unreachable!() };
    value
}

impl FromSmallLoad<'_> {
    pub fn new(history: &dyn LoadHistory, least: Load, until: f64) -> FromSmallLoad<'_> {
        let above = |load: Load| main_value(&load) > main_value(&least);
        let mut crossings = Vec::new();
        let moments: Vec<f64> = (0..=4000).map(|k| until * (f64::from(k) / 4000.0).powi(3)).collect();
        for pair in moments.windows(2) {
            let (mut a, mut b) = (pair[0], pair[1]);
            let side = above(history.at(a));
            if side != above(history.before(b)) {
                for _ in 0..60 {
                    let middle = 0.5 * (a + b);
                    if above(history.at(middle)) == side { a = middle } else { b = middle }
                }
                crossings.push(b);
            }
        }
        FromSmallLoad { history, least, crossings }
    }

    fn raised(&self, load: Load) -> Load {
        if main_value(&load) > main_value(&self.least) { load } else { self.least }
    }
}

impl LoadHistory for FromSmallLoad<'_> {
    fn at(&self, t: f64) -> Load {
        self.raised(self.history.at(t))
    }

    fn before(&self, t: f64) -> Load {
        self.raised(self.history.before(t))
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        let crossing = self.crossings.iter().copied().find(|&time| time > after);
        let named = self.history.next_breakpoint(after);
        crossing.into_iter().chain(named).reduce(f64::min)
    }
}
