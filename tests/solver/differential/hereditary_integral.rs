//! The hereditary integral as it is written: u at all nodes of the past, on every interval between them a polynomial through
//! some of them, and ∫ E(t − s) du(s) over all of that by quadrature, anew in each step.

use crate::common::gauss;
use viscocontact::prelude::*;

use super::scenes::Body;

/// What is older by so many relaxation times is forgotten.
const FORGOTTEN: f64 = 45.0;

/// E(t) = `equilibrium` + Σ E e^(−t/τ) + `dashpot` δ(t), the inverse of the contact compliance C = J/4.
#[derive(Debug, Clone)]
struct Relaxation {
    equilibrium: f64,
    dashpot: f64,
    /// (E, 1/τ).
    terms: Vec<(f64, f64)>,
}

impl Relaxation {
    /// With x = −s, s·Ĉ(s) = C0 − f/x + Σ C/(1 − xλ) rises from −∞ to +∞ between its poles; its zeros are 1/τ.
    fn of(body: &Body) -> Relaxation {
        let (c0, f) = (0.25 * body.glassy, 0.25 * body.fluidity);
        let mut terms: Vec<(f64, f64)> = body.terms.iter().map(|&(c, lambda)| (0.25 * c, lambda)).collect();
        terms.sort_by(|a, b| b.1.total_cmp(&a.1));
        let value = |x: f64| c0 - f / x + terms.iter().map(|(c, l)| c / (1.0 - x * l)).sum::<f64>();
        let slope =
            |x: f64| f / (x * x) + terms.iter().map(|(c, l)| c * l / ((1.0 - x * l) * (1.0 - x * l))).sum::<f64>();
        let mut poles: Vec<f64> = terms.iter().map(|(_, lambda)| 1.0 / lambda).collect();
        if f > 0.0 {
            poles.insert(0, 0.0);
        }
        let mut zeros = Vec::new();
        for (k, &pole) in poles.iter().enumerate() {
            let end = match poles.get(k + 1) {
                Some(&next) => next,
                None if c0 > 0.0 => {
                    let mut far = 2.0 * pole.max(f / c0);
                    while value(far) < 0.0 {
                        far *= 2.0;
                    }
                    far
                }
                None => break,
            };
            let (mut low, mut high) = (pole, end);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                if value(middle) < 0.0 { low = middle } else { high = middle }
            }
            let x = 0.5 * (low + high);
            zeros.push((1.0 / (x * slope(x)), x));
        }
        let held: f64 = c0 + terms.iter().map(|(c, _)| c).sum::<f64>();
        let rate: f64 = f + terms.iter().map(|(c, lambda)| c / lambda).sum::<f64>();
        Relaxation {
            equilibrium: if f > 0.0 { 0.0 } else { 1.0 / held },
            dashpot: if c0 > 0.0 { 0.0 } else { 1.0 / rate },
            terms: zeros,
        }
    }
}

/// What happened between a node and the one before.
#[derive(Debug, Clone)]
struct Span {
    /// Its length \[s\], 0 for a jump.
    length: f64,
    /// The nodes that u on it is the polynomial through.
    nodes: Vec<usize>,
}

/// u at the nodes 0 (undisturbed), 1, …, and on the spans that end at the nodes 1, 2, …
pub struct HereditaryIntegral {
    relaxation: Relaxation,
    rule: TimeRule,
    fields: Vec<Vec<f64>>,
    spans: Vec<Span>,
    /// With the step predicted last.
    tried: Vec<Span>,
    /// The greatest displacement so far.
    greatest: f64,
    /// What a convolution leaves of nothing \[m\].
    noise: f64,
}

impl HereditaryIntegral {
    pub fn new(body: &Body, rule: TimeRule, cells: usize, side: f64) -> HereditaryIntegral {
        let (fields, relaxation) = (vec![vec![0.0; cells]], Relaxation::of(body));
        HereditaryIntegral {
            relaxation,
            rule,
            fields,
            spans: Vec::new(),
            tried: Vec::new(),
            greatest: 0.0,
            noise: 1e-14 * side,
        }
    }

    /// u at the last node.
    pub fn displacement(&self) -> &[f64] {
        &self.fields[self.fields.len() - 1]
    }

    /// u at the end of the next step is c v + u_old: returns c and u_old.
    pub fn predict(&mut self, dt: f64) -> (f64, Vec<f64>) {
        let dashpot = self.relaxation.dashpot > 0.0;
        let corrected = self.rule == TimeRule::Exponential && dt > 0.0;
        let last = self.spans.last().map_or(0.0, |span| span.length);
        let known = self.spans.iter().rev().take_while(|span| span.length > 0.0).count();
        let longest = if dashpot { 2.41 } else { 4.0 } * last;
        let mut degree = if corrected && dashpot && dt <= longest { 2.min(known + 1) } else { 1 };
        let mut corrects = corrected && last > 0.0 && dt >= 0.5 * last;
        loop {
            let (c, u_old) = self.predict_as(dt, degree, corrects);
            self.greatest = self.displacement().iter().copied().fold(self.greatest, f64::max);
            if degree == 1 && !corrects || u_old.iter().all(|&u| u >= -(1e-9 * self.greatest).max(self.noise)) {
                return (c, u_old);
            }
            (degree, corrects) = (1, corrects && degree > 1);
        }
    }

    /// The same with u of a `degree` on the step, which corrects the span before if `corrects`.
    fn predict_as(&mut self, dt: f64, degree: usize, corrects: bool) -> (f64, Vec<f64>) {
        let new = self.fields.len();
        self.tried.clone_from(&self.spans);
        if let Some(before) = self.tried.last_mut().filter(|_| corrects) {
            before.nodes.push(new);
        }
        self.tried.push(Span { length: dt, nodes: (new - degree..=new).collect() });
        let weights = self.weights();
        let u_old = (0..self.fields[0].len())
            .map(|k| -self.fields.iter().zip(&weights).map(|(u, weight)| weight * u[k]).sum::<f64>() / weights[new]);
        (1.0 / weights[new], u_old.collect())
    }

    /// The weight of u at each node in ∫ E(t − s) du(s) at the end of the step that is tried.
    fn weights(&self) -> Vec<f64> {
        let Relaxation { equilibrium, dashpot, ref terms } = self.relaxation;
        let new = self.tried.len();
        // how long ago each node was
        let mut ages = vec![0.0; new + 1];
        (0..new).rev().for_each(|node| ages[node] = ages[node + 1] + self.tried[node].length);
        let mut weights = vec![0.0; new + 1];
        weights[new] += equilibrium;
        for (start, Span { length, nodes }) in self.tried.iter().enumerate() {
            let end = start + 1;
            for &(e, x) in terms.iter().filter(|(_, x)| ages[end] * x < 700.0) {
                if *length == 0.0 {
                    let left = e * (-x * ages[end]).exp();
                    (weights[end], weights[start]) = (weights[end] + left, weights[start] - left);
                    continue;
                }
                // panels of a relaxation time from the end back to where nothing is left
                let reach = length.min(FORGOTTEN / x);
                let panels = (reach * x).ceil().max(1.0) as usize;
                for (age, weight) in gauss::points(ages[end], ages[end] + reach, panels) {
                    let left = weight * e * (-x * age).exp();
                    nodes.iter().for_each(|&node| weights[node] += left * slope(&ages, nodes, node, age));
                }
            }
        }
        let Span { length, nodes } = &self.tried[new - 1];
        if dashpot > 0.0 && *length > 0.0 {
            nodes.iter().for_each(|&node| weights[node] += dashpot * slope(&ages, nodes, node, 0.0));
        }
        weights
    }

    /// Takes u at the end of the step predicted last into the past.
    pub fn commit(&mut self, u: Vec<f64>) {
        self.fields.push(u);
        std::mem::swap(&mut self.spans, &mut self.tried);
    }
}

/// The slope in time, at some age, of the polynomial that is 1 at a node and 0 at the other `nodes`.
fn slope(ages: &[f64], nodes: &[usize], node: usize, age: f64) -> f64 {
    let others = || nodes.iter().filter(move |&&other| other != node);
    let from_node = |other: usize| ages[other] - ages[node];
    let without = |one: usize| -> f64 {
        others().filter(|&&other| other != one).map(|&other| (ages[other] - age) / from_node(other)).product()
    };
    others().map(|&one| without(one) / from_node(one)).sum()
}
