//! The reciprocal of a Stieltjes series: the algebra behind creep ⇄ relaxation.
//!
//! Creep and relaxation satisfy s Ĵ(s) · s Ĝ(s) = 1 (e.g. Tschoegl, *The Phenomenological Theory of
//! Linear Viscoelastic Behavior*, Springer 1989). With s = −x, s Ĵ becomes
//!
//! φ(x) = c − f/x + Σ a_k p_k/(p_k − x),
//!
//! which rises from −∞ to +∞ between consecutive poles, so that its zeros z_k interlace with the poles
//! (one of which is 0 if f > 0): one in every gap, and one above the last pole if c > 0. The
//! reciprocal is then c′ + f′ s + Σ b_k s/(s + z_k) with b_k = 1/(z_k φ′(z_k)),
//! c′ = 1/φ(0) (0 if f > 0) and f′ = 1/(f + Σ a_k p_k) (0 if c > 0).
//!
//! In σ = 1/s the reciprocal has the form of φ again, with poles at the times 1/z_k: one function
//! converts both ways.

/// The coefficients c′, f′ and (b_k, z_k), zeros ascending, of the reciprocal c′ + f′ s + Σ b s/(s + z) of
/// c + f/s + Σ a p/(p + s), given by c, f and `terms` of positive strengths a at ascending, distinct poles p.
pub(crate) fn reciprocal(constant: f64, slope: f64, terms: &[(f64, f64)]) -> (f64, f64, Vec<(f64, f64)>) {
    let terms = significant(&merged(terms), constant, slope);
    let total: f64 = terms.iter().map(|&(a, _)| a).sum();
    let rate: f64 = terms.iter().map(|&(a, p)| a * p).sum();

    let mut poles = Vec::with_capacity(terms.len() + 1);
    if slope > 0.0 {
        poles.push(Pole { at: 0.0, weight: slope });
    }
    poles.extend(terms.iter().map(|&(a, p)| Pole { at: p, weight: a * p }));
    let function = Secular { constant, poles };

    let mut zeros: Vec<(f64, f64)> = Vec::with_capacity(terms.len() + 1);
    // a zero that coincides with its pole in `f64` belongs to a negligible term
    for zero in function.zeros().filter(|zero| zero.offset != 0.0) {
        let (strength, at) = (function.residue(zero), function.position(zero));
        match zeros.last_mut() {
            // zeros on both sides of a very weak term may round to the same number
            Some(last) if last.1 == at => last.0 += strength,
            _ => zeros.push((strength, at)),
        }
    }
    let slope_of_reciprocal = if constant > 0.0 { 0.0 } else { 1.0 / (slope + rate) };
    let constant_of_reciprocal = if slope > 0.0 { 0.0 } else { 1.0 / (constant + total) };
    (constant_of_reciprocal, slope_of_reciprocal, zeros)
}

/// The terms with clusters of poles replaced by their means, weighted by strength: poles closer than 1e-6, relative to
/// their position. This changes the function by a relative 1e-13 at most (the square of the distance, over eight),
/// while zeros in a narrower gap would be resolved to fewer than ten digits of its width.
fn merged(terms: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut first = 0.0;
    let mut merged: Vec<(f64, f64)> = Vec::with_capacity(terms.len());
    for &(a, p) in terms {
        match merged.last_mut() {
            Some((strength, mean)) if p <= first * (1.0 + 1e-6) => {
                *mean += (p - *mean) * (a / (*strength + a));
                *strength += a;
            }
            _ => {
                first = p;
                merged.push((a, p));
            }
        }
    }
    merged
}

/// The terms that exceed the rounding error of the constant, the slope, or a stronger term of a higher or
/// lower pole. If the pole of such a term is at a zero of the others, the zeros on its two sides coincide in `f64`, and
/// the division of the strength between them would be arbitrary.
fn significant(terms: &[(f64, f64)], constant: f64, slope: f64) -> Vec<(f64, f64)> {
    // for p ≤ q, a p/(p + s) is at most a/b of b q/(q + s); for p ≥ q, a p/(b q) of it
    let mut highest = vec![constant; terms.len()];
    for k in (0..terms.len().saturating_sub(1)).rev() {
        highest[k] = highest[k + 1].max(terms[k + 1].0);
    }
    let rounding = 0.5 * f64::EPSILON;
    let mut lowest = slope;
    let mut significant = Vec::with_capacity(terms.len());
    for (&(a, p), highest) in terms.iter().zip(highest) {
        if a > rounding * highest && a * p > rounding * lowest {
            significant.push((a, p));
        }
        lowest = lowest.max(a * p);
    }
    significant
}

#[derive(Debug, Clone, Copy)]
struct Pole {
    at: f64,
    weight: f64,
}

/// φ(x) = constant + Σ weight/(at − x), increasing between its poles.
struct Secular {
    constant: f64,
    poles: Vec<Pole>,
}

/// A point given by its signed distance from a pole, so that a zero that nearly coincides with the
/// pole of a weak term keeps its full relative accuracy.
#[derive(Debug, Clone, Copy)]
struct Point {
    pole: usize,
    offset: f64,
}

impl Secular {
    fn zeros(&self) -> impl Iterator<Item = Point> + '_ {
        let above = (self.constant > 0.0 && !self.poles.is_empty()).then(|| self.zero_above_last());
        (1..self.poles.len()).map(|k| self.zero_between(k - 1)).chain(above)
    }

    /// The zero between poles k and k + 1, measured from the nearer one.
    fn zero_between(&self, k: usize) -> Point {
        let middle = 0.5 * (self.poles[k + 1].at - self.poles[k].at);
        let value = self.value(Point { pole: k, offset: middle });
        // On the side of pole q the other terms grow no further than they are in the middle, so the
        // zero is no nearer to q than weight / (weight/middle + |φ(middle)|).
        let pole = if value >= 0.0 { k } else { k + 1 };
        let weight = self.poles[pole].weight;
        let nearest = weight / (weight / middle + value.abs());
        self.bisect(pole, if value >= 0.0 { 1.0 } else { -1.0 }, nearest, middle)
    }

    /// The zero above the last pole: weight_last/c ≤ distance ≤ Σ weight/c.
    fn zero_above_last(&self) -> Point {
        let last = self.poles.len() - 1;
        let farthest = self.poles.iter().map(|pole| pole.weight).sum::<f64>() / self.constant;
        self.bisect(last, 1.0, self.poles[last].weight / self.constant, farthest)
    }

    /// Bisection in the logarithm of the distance from `pole` on the given side.
    fn bisect(&self, pole: usize, side: f64, nearest: f64, farthest: f64) -> Point {
        let (mut near, mut far) = (nearest, farthest);
        let mut middle = far;
        while far / near - 1.0 > 2.0 * f64::EPSILON {
            middle = near.sqrt() * far.sqrt();
            if middle <= near || middle >= far {
                break;
            }
            // φ rises with x: on the right of its pole it is negative nearby, on the left positive
            if side * self.value(Point { pole, offset: side * middle }) < 0.0 {
                near = middle;
            } else {
                far = middle;
            }
        }
        Point { pole, offset: side * middle }
    }

    /// Signed distance from `point` to pole j, free of cancellation.
    fn distance(&self, j: usize, point: Point) -> f64 {
        (self.poles[j].at - self.poles[point.pole].at) - point.offset
    }

    fn value(&self, point: Point) -> f64 {
        let terms = self.poles.iter().enumerate().map(|(j, pole)| pole.weight / self.distance(j, point));
        self.constant + terms.sum::<f64>()
    }

    fn position(&self, point: Point) -> f64 {
        self.poles[point.pole].at + point.offset
    }

    /// 1/(z φ′(z)), written so that squares of tiny distances do not underflow.
    fn residue(&self, zero: Point) -> f64 {
        let d = zero.offset;
        let scaled_slope: f64 =
            self.poles.iter().enumerate().map(|(j, pole)| pole.weight * (d / self.distance(j, zero)).powi(2)).sum();
        (d / self.position(zero)) * (d / scaled_slope)
    }
}
