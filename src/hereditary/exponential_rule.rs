//! Exponential integration of the relaxation form of the hereditary integral, in place of the sum of Eq. 11.

use crate::hereditary::moments::{Relaxed, RelaxedSteps, moments as moments_of, slopes as slopes_of};
use crate::rheology::{CreepSpectrum, RelaxationSpectrum};

/// How the displacement is taken to change with time within a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Interpolant {
    /// Linear, and that stays so.
    #[default]
    Linear,
    /// Linear, with the step before raised to a quadratic by what this step adds to its nodes. Quadratic for bodies
    /// with an immediate dashpot, which respond to the slope at the end.
    CorrectedLinear,
    /// Quadratic through the last three nodes, with the step before raised to a cubic.
    CorrectedQuadratic,
}

/// The exponential rule.
///
/// With v = K p and the contact relaxation modulus E(t) = E∞ + Σ E_i e^(−t/τ_i) + η δ(t), v = ∫ E(t − s) du(s). On a
/// step of length Δ, after steps of Δ′ and Δ″, u is a polynomial through its last values, in Newton's form
///
/// u + D₁ s + D₂ s (s − Δ), with the divided differences D_k at the end of the step,
///
/// and the step before, which had one node less, is corrected: it gets its next term, with the D_k found now.
/// With z_i = Δ/τ_i, and the moments I_k of [`moments`], that gives one field q_i for each relaxation time
///
/// q_i ← e^(−z_i) q_i + E_i Σ_k (I_k + e^(−z_i) I_k′ of the step before) D_k,
///
/// where D_k = (u_new − R_k)/(Δ (Δ + Δ′) …), and R_k continues the polynomial through the k nodes before. Hence
/// u_new = u_old + c v, with γ_k = Σ_i γ_ik, γ_ik = E_i (I_k + …)/(Δ (Δ + Δ′) …), dashpot included:
///
/// 1/c = E∞ + γ₁ + γ₂ + γ₃, u_old = c (Σ γ_k R_k − Σ e^(−z_i) q_i).
///
/// All γ_k are positive, and so is c. In a jump, Δ = 0, u is linear and γ₁ = Σ E_i. The derivation, the orders and
/// the stability are in docs/methods.md and docs/maintainers/measurements.md.
///
/// Fields keep their differences undivided, d₁ = u − u_before and so on, which have the unit of u whatever the length
/// of the steps: d_k of a step is d_(k−1) less ρ_(k−1) times the d_(k−1) of the previous step.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ExponentialRule {
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::rheology::SavedRelaxation"))]
    pub(super) relaxation: RelaxationSpectrum,
    /// Lengths of the last two steps since the last jump or corner.
    spans: [f64; 2],
    /// How many differences are known at the end of the last step.
    known: usize,
    /// How many the fields keep.
    kept: usize,
    /// The term that the last step lacks, 0 for none.
    lacking: usize,
    /// `spans`, `known` and `lacking` at the start of the last step.
    at_start: ([f64; 2], usize, usize),
    /// Of the step predicted last.
    pub(super) tried: StepWeights,
    /// Of the step committed last, which the fields take in with the next prediction.
    pub(super) committed: StepWeights,
    /// The maximum displacement so far.
    pub(super) greatest: f64,
    /// How often a prediction was made again, because u_old was negative somewhere.
    pub(super) repeated: u64,
    /// Number of steps accepted in this process.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    accepted: u32,
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) relaxed: RelaxedSteps,
}

clone_by_fields! { ExponentialRule {
    relaxation, spans, known, kept, lacking, at_start, tried, committed, greatest, repeated, accepted, relaxed,
} }

/// What a step does to a field that follows the rule.
#[derive(Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StepWeights {
    /// Length of the step.
    pub(super) dt: f64,
    /// Degree of u on the step.
    degree: usize,
    corrects_last: bool,
    corrected_by_next: bool,
    /// Compliance of the step.
    pub(super) c: f64,
    /// Of u and its differences in u_old.
    pub(super) past: [f64; 3],
    /// e^(−z_i), γ_i1, γ_i2, γ_i3.
    pub(super) branches: Vec<[f64; 4]>,
    /// The highest k for which a γ_ik is not zero.
    pub(super) terms: usize,
    /// ρ₁ and ρ₂.
    pub(super) ratios: [f64; 2],
    /// γ_k of the degrees 2 and 3, each as if the step had it: what v lacks is this times d_k.
    defects: [f64; 2],
    /// γ of a change of u that the steps before do not predict, without what it changes of the step before.
    answer: f64,
    /// (Δ + Δ′)/Δ.
    pub(super) span: f64,
    /// How many differences are known at its end.
    known: usize,
}

clone_by_fields! { StepWeights {
    dt, degree, corrects_last, corrected_by_next, c, past, branches, terms, ratios, defects, answer, span, known,
} }

/// A step that is longer than so many times the one before is not continued from it by a quadratic, ...
const LONGEST_CONTINUED: f64 = 4.0;
/// ... nor one of a body with an immediate dashpot, whose errors grow beyond 1 + √2.
const LONGEST_CONTINUED_OF_DASHPOT: f64 = 2.41;
/// Steps farther apart in length than this factor do not extrapolate each other: its square must be a number.
const FARTHEST_APART: f64 = 1e150;
/// A step shorter than this fraction of the step before was cut by an event: it does not correct the step before.
const MIN_CORRECTING: f64 = 0.5;
/// Stresses q_i below this \[Pa\] are forgotten, far above the smallest numbers of all: no sum shows them.
const NOTHING: f64 = 1e-200;
/// Number of steps from one forgetting to the next. A stress that keeps half or more in each of them keeps 5e-20 in
/// all; one that keeps less passes the smallest numbers by itself.
const FORGETTING: u32 = 64;

impl ExponentialRule {
    /// For bodies with contact compliance `creep`.
    pub(crate) fn new(creep: &CreepSpectrum) -> ExponentialRule {
        let relaxation = creep.relaxation();
        let branches = vec![[0.0; 4]; relaxation.terms().len()];
        let relaxed = RelaxedSteps::new(branches.len());
        let weights = StepWeights { degree: 1, branches, span: 1.0, ..StepWeights::default() };
        ExponentialRule {
            relaxation,
            spans: [0.0; 2],
            known: 0,
            kept: 0,
            lacking: 0,
            at_start: ([0.0; 2], 0, 0),
            committed: weights.clone(),
            tried: weights,
            greatest: 0.0,
            repeated: 0,
            accepted: 0,
            relaxed,
        }
    }

    /// Number of relaxation times.
    pub(crate) fn branches(&self) -> usize {
        self.relaxation.terms().len()
    }

    /// Whether there is a past: an elastic body has none.
    pub(crate) fn has_memory(&self) -> bool {
        self.branches() > 0 || self.has_dashpot()
    }

    /// Whether the body has no elastic response.
    pub(crate) fn has_dashpot(&self) -> bool {
        self.relaxation.viscosity() > 0.0
    }

    /// E∞.
    pub(crate) fn equilibrium(&self) -> f64 {
        self.relaxation.equilibrium()
    }

    /// The longest step that the one before continues as a quadratic, over the one before.
    pub(crate) fn longest_continued(&self) -> f64 {
        if self.has_dashpot() { LONGEST_CONTINUED_OF_DASHPOT } else { LONGEST_CONTINUED }
    }

    /// How many differences of its fields the rule keeps.
    pub(super) fn kept(&self) -> usize {
        self.kept
    }

    /// How many differences steps of given length need.
    pub(super) fn least_kept(&self) -> usize {
        if self.has_dashpot() { 2 } else { usize::from(self.has_memory()) }
    }

    /// c of the step predicted last.
    pub(crate) fn compliance(&self) -> f64 {
        self.tried.c
    }

    /// The first degree that u lacks on the step predicted last, as far as the steps before it determine, and γ of
    /// that degree; none after a jump or a corner.
    pub(super) fn missing(&self) -> Option<(usize, f64)> {
        let lacking = (self.tried.degree + 1).min(self.known + 1);
        (self.tried.dt > 0.0 && lacking > 1).then(|| (lacking, self.tried.defects[lacking - 2]))
    }

    /// η/Δ of the step predicted last.
    pub(super) fn viscous(&self) -> f64 {
        if self.has_dashpot() { self.relaxation.viscosity() / self.tried.dt } else { 0.0 }
    }

    /// Of each relaxation time, in the step predicted last: the part of q_i that is left of it, its response to a
    /// unit of u that is linear on the step, and its share in a defect of v.
    pub(super) fn responses(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let dt = self.tried.dt;
        let past = if self.known > 0 { self.spans[0] / dt } else { 0.0 };
        let terms = self.relaxation.terms();
        let moments =
            move |&(modulus, tau): &(f64, f64)| moments_of(Relaxed::new(dt / tau), past).map(|moment| modulus * moment);
        let missing = self.missing().map(|(degree, _)| degree - 1);
        let whole = missing.map_or(f64::INFINITY, |k| {
            slopes_of(past)[k] * self.viscous() + terms.iter().map(|term| moments(term)[k]).sum::<f64>()
        });
        terms.iter().zip(&self.tried.branches).map(move |(term, weights)| {
            let moments = moments(term);
            [weights[0], moments[0], moments[missing.unwrap_or(0)] / whole]
        })
    }

    /// The responses of v, in the step predicted last, to a unit of u that the steps before do not predict: of the polynomial on the
    /// step, and γ₁ + γ₂ + γ₃ = 1/c − E∞. The change raises all differences of u, and so the correction of the step before.
    pub(super) fn responses_to_unexpected(&self) -> [f64; 2] {
        [self.tried.answer, 1.0 / self.tried.c - self.equilibrium()]
    }

    /// The response of the relaxation times, at the end of such a `share` of the step predicted last, to a u that has
    /// grown at the rate 1/Δ since its start: Σ E_i (1 − e^(−share z_i))/z_i.
    pub(super) fn relaxing(&self, share: f64) -> f64 {
        let dt = self.tried.dt;
        let response = |&(modulus, tau): &(f64, f64)| -modulus * tau / dt * (-share * dt / tau).exp_m1();
        self.relaxation.terms().iter().map(response).sum()
    }

    /// Whether the next step corrects the one predicted last.
    pub(super) fn corrects(&self) -> bool {
        self.tried.corrected_by_next
    }

    /// Where the steps before do not determine how u continues ([`Self::missing`]): the response of the step predicted last to a unit of v
    /// that acts at once from its start on an undisturbed body, and of one that grows from 0.
    pub(crate) fn first_step_responses(&self) -> Option<[f64; 2]> {
        let StepWeights { dt, c, branches, .. } = &self.tried;
        if *dt == 0.0 || self.missing().is_some() {
            return None;
        }
        let terms = self.relaxation.terms();
        let moduli: f64 = terms.iter().map(|&(modulus, _)| modulus).sum();
        let elastic = if self.has_dashpot() { 0.0 } else { 1.0 / (self.equilibrium() + moduli) };
        let left: f64 = branches.iter().zip(terms).map(|(weights, &(modulus, _))| weights[0] * modulus).sum();
        Some([c + elastic * (1.0 - c * (self.equilibrium() + left)), *c])
    }

    /// The order of the error of a step in its length.
    pub(crate) fn order(&self, interpolant: Interpolant) -> u32 {
        match interpolant {
            Interpolant::Linear => 2,
            Interpolant::CorrectedLinear => 3,
            Interpolant::CorrectedQuadratic if self.has_dashpot() => 3,
            Interpolant::CorrectedQuadratic => 4,
        }
    }

    /// Whether it is a rule for the bodies of another: a file may hold anything.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &ExponentialRule) -> bool {
        let branches = other.branches();
        let follows = |(spans, known, lacking): ([f64; 2], usize, usize)| {
            known <= self.kept
                && [0, 2, 3].contains(&lacking)
                && spans.iter().take(known).all(|&span| span > 0.0 && span.is_finite())
        };
        self.relaxation.terms().len() == branches
            && [&self.tried, &self.committed].iter().all(|weights| weights.branches.len() == branches)
            && self.kept <= 2
            && follows((self.spans, self.known, self.lacking))
            && follows(self.at_start)
    }

    #[cfg(feature = "checkpoint")]
    pub(crate) fn relaxation(&self) -> &RelaxationSpectrum {
        &self.relaxation
    }

    /// The past does not determine how u continues, as after a corner of the load.
    pub(crate) fn reset_differences(&mut self) {
        (self.known, self.lacking) = (0, 0);
    }

    /// Finds the weights of a step of length `dt`; its compliance is 0 in a jump of a body without elastic response.
    pub(crate) fn compute_weights(&mut self, dt: f64, interpolant: Interpolant) {
        let quadratic = interpolant == Interpolant::CorrectedQuadratic
            || interpolant == Interpolant::CorrectedLinear && self.has_dashpot();
        let wanted = if quadratic { 2 } else { 1 };
        if self.has_memory() && self.kept < wanted {
            (self.kept, self.known) = (wanted, self.known.min(self.kept));
        }
        let degree = if dt > self.longest_continued() * self.spans[0] { 1 } else { wanted };
        let corrected = interpolant != Interpolant::Linear;
        self.weigh_as(dt, degree, corrected && dt >= MIN_CORRECTING * self.spans[0], corrected);
    }

    /// Whether the step can be weighed with less degree.
    pub(super) fn has_less(&self) -> bool {
        self.tried.degree > 1 || self.tried.corrects_last
    }

    /// The weights of the same step with less degree: linear, then without the correction of the step before.
    pub(super) fn reduce_order(&mut self) {
        let StepWeights { dt, degree, corrects_last, corrected_by_next, .. } = self.tried;
        self.weigh_as(dt, 1, corrects_last && degree > 1, corrected_by_next);
        self.repeated += 1;
    }

    fn weigh_as(&mut self, dt: f64, degree: usize, corrects_last: bool, corrected_by_next: bool) {
        let jump = dt == 0.0;
        let apart = self.known > 0 && !(1.0 / FARTHEST_APART..=FARTHEST_APART).contains(&(self.spans[0] / dt));
        let known = if jump || apart { 0 } else { self.known };
        let degree = degree.min(known + 1);
        let lacking = if corrects_last && known + 1 >= self.lacking { self.lacking } else { 0 };
        let [past, before] = [0, 1].map(|k| if k < known { self.spans[k] / dt } else { 0.0 });
        let late_past = if known > 1 { before / past } else { 0.0 };
        // Δ (Δ + Δ′) … over Δ^k
        let products = [1.0, 1.0 + past, (1.0 + past) * (1.0 + past + before)];
        let slopes = slopes_of(past);
        let viscosity = if self.has_dashpot() { self.relaxation.viscosity() / dt } else { 0.0 };

        let (mut gains, mut defects) = ([0.0; 3], [0.0; 2]);
        let terms = self.tried.branches.iter_mut().zip(self.relaxation.terms());
        for (branch, (weights, &(modulus, tau))) in terms.enumerate() {
            let (decay, moments) = if jump {
                (1.0, [1.0, 0.0, 0.0])
            } else {
                let relaxed = self.relaxed.of(branch, dt / tau);
                (relaxed.decay, moments_of(relaxed, past))
            };
            let mut own = [0, 1, 2].map(|k| if k < degree { modulus * moments[k] / products[k] } else { 0.0 });
            (0..2).for_each(|k| defects[k] += modulus * moments[k + 1] / products[k + 1]);
            if lacking > 0 {
                let late = moments_of(self.relaxed.of(branch, self.spans[0] / tau), late_past);
                // over Δ^k instead of Δ′^k
                own[lacking - 1] +=
                    decay * modulus * late[lacking - 1] * past.powi(lacking as i32) / products[lacking - 1];
            }
            (0..3).for_each(|k| gains[k] += own[k]);
            *weights = [decay, own[0], own[1], own[2]];
        }
        if viscosity > 0.0 {
            (0..degree).for_each(|k| gains[k] += viscosity * slopes[k] / products[k]);
            (0..2).for_each(|k| defects[k] += viscosity * slopes[k + 1] / products[k + 1]);
        }
        let c = 1.0 / (self.equilibrium() + gains.iter().sum::<f64>());
        let ratios = if known == 0 {
            [0.0; 2]
        } else {
            let second = if known > 1 { (1.0 + past) / (past * (past + before)) } else { 0.0 };
            [1.0 / past, second]
        };
        let differences = [c * (gains[1] + gains[2]) * ratios[0], c * gains[2] * ratios[1]];
        // c Σ γ_k, written so that an elastic body keeps exactly nothing
        let kept = if self.has_memory() { 1.0 - c * self.equilibrium() } else { 0.0 };
        let tried = &mut self.tried;
        (tried.dt, tried.degree, tried.c, tried.ratios) = (dt, degree, c, ratios);
        tried.past = [kept, differences[0], differences[1]];
        (tried.terms, tried.span) = (degree.max(lacking), products[1]);
        (tried.corrects_last, tried.corrected_by_next) = (lacking > 0, corrected_by_next);
        tried.defects = if jump { [0.0; 2] } else { defects };
        tried.answer = gains[0] + if degree > 1 { defects[0] } else { 0.0 };
        tried.known = if jump { 0 } else { (known + 1).min(self.kept) };
    }

    /// Accepts the step predicted last.
    pub(crate) fn commit(&mut self) {
        let step = &self.tried;
        self.at_start = (self.spans, self.known, self.lacking);
        self.known = step.known;
        self.spans = if step.dt > 0.0 { [step.dt, self.spans[0]] } else { [0.0; 2] };
        self.lacking = if step.corrected_by_next && self.known > 0 { step.degree + 1 } else { 0 };
        self.committed.clone_from(&self.tried);
        self.accepted = self.accepted.wrapping_add(1);
    }

    /// Sets stresses that have relaxed to nothing to zero, in one step of [`FORGETTING`]. Rounding would keep a stress that less than halves in a
    /// step at the smallest numbers of all, for which processors take a hundred times as long.
    pub(super) fn forget_relaxed(&self, stresses: &mut [f64]) {
        if self.accepted.is_multiple_of(FORGETTING) {
            stresses.iter_mut().filter(|stress| stress.abs() < NOTHING).for_each(|stress| *stress = 0.0);
        }
    }

    /// Returns to the start of the step accepted last.
    pub(super) fn roll_back(&mut self) {
        (self.spans, self.known, self.lacking) = self.at_start;
    }
}
