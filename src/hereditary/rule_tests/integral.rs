//! ∫ E(t − s) du(s) by quadrature over the whole past, with u a polynomial between its nodes.

use crate::hereditary::Interpolant;
use crate::rheology::RelaxationSpectrum;

/// Gauss–Legendre points and weights on −1 … 1, exact for degree 19.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];
/// What is older by so many relaxation times is forgotten.
const FORGOTTEN: f64 = 45.0;

/// Σ E_i ∫ e^(−t/τ_i) u′ dt over a span of the past that ended `end` ago, for u′ at each time before its end.
pub fn relaxing(body: &RelaxationSpectrum, end: f64, length: f64, slope: impl Fn(f64) -> f64) -> f64 {
    let of_branch = |&(modulus, tau): &(f64, f64)| {
        let reach = length.min(FORGOTTEN * tau);
        let panels = (reach / tau).ceil().max(1.0);
        let half = 0.5 * reach / panels;
        let mut sum = 0.0;
        for panel in 0..panels as usize {
            let middle = (2 * panel + 1) as f64 * half;
            for (at, weight) in GAUSS {
                for before in [middle - half * at, middle + half * at] {
                    sum += half * weight * (-(end + before) / tau).exp() * slope(before);
                }
            }
        }
        modulus * sum
    };
    body.terms().iter().filter(|(_, tau)| end / tau < 700.0).map(of_branch).sum()
}

/// u at a node, and what led to it.
#[derive(Clone)]
struct Node {
    u: f64,
    /// Length of the step, 0 for a jump.
    length: f64,
    /// The nodes that u on the step is the polynomial through.
    through: Vec<usize>,
    /// Whether the next step may add its end to them.
    open: bool,
}

/// What the rule states about u, kept node by node.
pub struct Past {
    body: RelaxationSpectrum,
    nodes: Vec<Node>,
    /// How many steps before now tell how u goes on.
    known: usize,
}

impl Past {
    pub fn undisturbed(body: &RelaxationSpectrum) -> Past {
        let start = Node { u: 0.0, length: 0.0, through: vec![0], open: false };
        Past { body: body.clone(), nodes: vec![start], known: 0 }
    }

    pub fn reset_differences(&mut self) {
        self.known = 0;
        let last = self.nodes.len() - 1;
        self.nodes[last].open = false;
    }

    /// Takes a step to `u`, by the limits that are written down for it.
    pub fn step(&mut self, dt: f64, u: f64, interpolant: Interpolant) {
        let dashpot = self.body.viscosity() > 0.0;
        let new = self.nodes.len();
        let corrected = interpolant != Interpolant::Linear;
        let quadratic = interpolant == Interpolant::CorrectedQuadratic || corrected && dashpot;
        let before = &mut self.nodes[new - 1];
        let suits = dt <= if dashpot { 2.41 } else { 4.0 } * before.length;
        if dt == 0.0 {
            self.known = 0;
        } else if before.open && corrected && dt >= 0.5 * before.length {
            before.through.push(new);
        }
        let degree = if quadratic && suits && self.known > 0 { 2 } else { 1 };
        self.nodes.push(Node { u, length: dt, through: (new - degree..=new).collect(), open: corrected && dt > 0.0 });
        self.known += usize::from(dt > 0.0);
    }

    /// v at the end of the last step, and the sum of the absolute values that it is made of.
    pub fn potential(&self) -> [f64; 2] {
        let mut ages = vec![0.0; self.nodes.len()];
        (1..ages.len()).rev().for_each(|k| ages[k - 1] = ages[k] + self.nodes[k].length);
        let last = &self.nodes[ages.len() - 1];
        let mut parts = vec![self.body.equilibrium() * last.u];
        for (k, Node { u, length, through, .. }) in self.nodes.iter().enumerate().skip(1) {
            if *length == 0.0 {
                let left: f64 = self.body.terms().iter().map(|&(modulus, tau)| modulus * (-ages[k] / tau).exp()).sum();
                parts.push(left * (u - self.nodes[k - 1].u));
            } else {
                parts.push(relaxing(&self.body, ages[k], *length, |before| self.slope(k, through, before)));
            }
        }
        if self.body.viscosity() > 0.0 && last.length > 0.0 {
            parts.push(self.body.viscosity() * self.slope(ages.len() - 1, &last.through, 0.0));
        }
        [parts.iter().sum(), parts.iter().map(|part| part.abs()).sum()]
    }

    /// u′ of the polynomial through nodes at a time before one of them, by Lagrange's form.
    fn slope(&self, end: usize, through: &[usize], before: f64) -> f64 {
        // how long after a node another one was
        let after = |a: usize, b: usize| {
            let length: f64 = self.nodes[a.min(b) + 1..=a.max(b)].iter().map(|node| node.length).sum();
            if b > a { length } else { -length }
        };
        let mut sum = 0.0;
        for &node in through {
            let others = || through.iter().filter(move |&&other| other != node);
            for &one in others() {
                let rest = others().filter(|&&other| other != one);
                let rest: f64 = rest.map(|&other| (after(other, end) - before) / after(other, node)).product();
                sum += self.nodes[node].u * rest / after(one, node);
            }
        }
        sum
    }
}
