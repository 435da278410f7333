//! Tables as rows, from columns.

pub fn pairs(x: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    x.iter().copied().zip(values.iter().copied()).collect()
}

pub fn triples(x: &[f64], first: &[f64], second: &[f64]) -> Vec<(f64, f64, f64)> {
    pairs(x, first).into_iter().zip(second).map(|((x, first), &second)| (x, first, second)).collect()
}
