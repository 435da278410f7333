//! Sums in lanes: additions need not wait for each other, and rounding grows less with the number of values.

const LANES: usize = 8;

/// Σ values.
pub(crate) fn sum(values: &[f64]) -> f64 {
    let (chunks, rest) = values.as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane += value;
        }
    }
    lanes.into_iter().sum::<f64>() + rest.iter().sum::<f64>()
}

/// The greatest |value|.
pub(crate) fn greatest(values: &[f64]) -> f64 {
    let (chunks, rest) = values.as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane = if value.abs() > *lane { value.abs() } else { *lane };
        }
    }
    lanes.iter().chain(rest).fold(0.0, |greatest, value| value.abs().max(greatest))
}

/// Σ f(a, b) over the values of two fields.
pub(crate) fn sum_of_pairs(a: &[f64], b: &[f64], f: impl Fn(f64, f64) -> f64) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut lanes = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            lanes[lane] += f(a[lane], b[lane]);
        }
    }
    lanes.into_iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(&a, &b)| f(a, b)).sum::<f64>()
}

/// Sums over a field that tell one from another: of its absolute values, these weighted along x1 and x2, their squares, and the
/// absolute values with weights that have no symmetry, so that a field that is turned or mirrored is another one.
#[cfg(feature = "checkpoint")]
pub(crate) fn moments(field: impl Iterator<Item = f64>, columns: usize) -> Vec<f64> {
    let mut sums = vec![0.0; 5];
    for (k, value) in field.enumerate() {
        let (size, i, j) = (value.abs(), (k / columns) as f64, (k % columns) as f64);
        // the bits of a product with an odd number, 0.5 to 1.5
        let weight = 0.5 + ((k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64 / (1_u64 << 53) as f64;
        for (sum, term) in sums.iter_mut().zip([size, size * i, size * j, size * size, size * weight]) {
            *sum += term;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_take_every_value() {
        for n in [0, 1, 7, 8, 29] {
            let a: Vec<f64> = (0..n).map(f64::from).collect();
            assert_eq!(sum(&a), a.iter().sum());
            assert_eq!(greatest(&a.iter().map(|a| -a).collect::<Vec<_>>()), a.iter().copied().fold(0.0, f64::max));
            assert_eq!(sum_of_pairs(&a, &a, |a, b| 2.0 * a * b), a.iter().map(|a| 2.0 * a * a).sum());
        }
    }
}
