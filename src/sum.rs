//! Sums in lanes: additions are independent of each other, and rounding errors grow more slowly with the number of
//! values.

/// Rounding of a sum of a few terms, over the sum of their sizes.
pub(crate) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A struct of sums and maxima over cells, each with a name, that bands and ranks reduce.
///
/// `named_sums!(Found { force: +, moments: modes, deepest: max })` declares `Found` with five numbers: a sum, three
/// sums, and the largest of values ≥ 0. `most` is the largest of values of either sign. `joined` adds sums, and
/// takes the greater of maxima. `numbers` and `of` convert to an array and back, for ranks.
macro_rules! named_sums {
    ($(#[$of:meta])* $name:ident { $($(#[$doc:meta])* $field:ident: $kind:tt,)* }) => {
        $(#[$of])*
        #[derive(Debug, Clone, Copy)]
        pub(crate) struct $name { $($(#[$doc])* pub(crate) $field: named_sums!(@type $kind),)* }

        impl $name {
            pub(crate) const NUMBERS: usize = 0 $(+ named_sums!(@count $kind))*;

            /// The sums over no cells.
            pub(crate) const NOTHING: $name = $name { $($field: named_sums!(@nothing $kind)),* };

            pub(crate) fn joined(self, next: $name) -> $name {
                $name { $($field: named_sums!(@joined $kind self.$field, next.$field)),* }
            }

            pub(crate) fn numbers(self) -> [f64; $name::NUMBERS] {
                let mut numbers = [].into_iter()$(.chain(named_sums!(@numbers $kind self.$field)))*;
                std::array::from_fn(|_| numbers.next().unwrap_or(f64::NAN))
            }

            pub(crate) fn of(numbers: [f64; $name::NUMBERS]) -> $name {
                let mut numbers = numbers.into_iter();
                let mut next = || numbers.next().unwrap_or(f64::NAN);
                $name { $($field: named_sums!(@of $kind next)),* }
            }
        }
    };
    (@type modes) => { [f64; 3] };
    (@type $other:tt) => { f64 };
    (@count modes) => { 3 };
    (@count $other:tt) => { 1 };
    (@nothing modes) => { [0.0; 3] };
    (@nothing most) => { f64::NEG_INFINITY };
    (@nothing $other:tt) => { 0.0 };
    (@joined + $a:expr, $b:expr) => { $a + $b };
    (@joined modes $a:expr, $b:expr) => { crate::sum::add($a, $b) };
    (@joined $max:tt $a:expr, $b:expr) => { f64::max($a, $b) };
    (@numbers modes $a:expr) => { $a };
    (@numbers $other:tt $a:expr) => { [$a] };
    (@of modes $next:ident) => { [$next(), $next(), $next()] };
    (@of $other:tt $next:ident) => { $next() };
}
pub(crate) use named_sums;

const LANES: usize = 8;

/// The sums of two arrays, number by number.
pub(crate) fn add<const K: usize>(a: [f64; K], b: [f64; K]) -> [f64; K] {
    std::array::from_fn(|n| a[n] + b[n])
}

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

/// The largest |value|.
pub(crate) fn greatest(values: &[f64]) -> f64 {
    greatest_of(values, 0.0, f64::abs)
}

/// The maximum value, −∞ of no values.
pub(crate) fn most(values: &[f64]) -> f64 {
    greatest_of(values, f64::NEG_INFINITY, |value| value)
}

/// The largest of `least` and f of the values; NaN is passed over.
fn greatest_of(values: &[f64], least: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (chunks, rest) = values.as_chunks::<LANES>();
    let mut lanes = [least; LANES];
    for chunk in chunks {
        for (lane, &value) in lanes.iter_mut().zip(chunk) {
            *lane = if f(value) > *lane { f(value) } else { *lane };
        }
    }
    let greatest = lanes.into_iter().fold(least, |greatest, value| value.max(greatest));
    rest.iter().fold(greatest, |greatest, &value| f(value).max(greatest))
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

/// A number from 0 to 1 for each cell, by the rounds of splitmix64 (Steele, Lea & Flood, OOPSLA 2014) but for the last.
pub(crate) fn scattered(k: usize) -> f64 {
    let bits = (k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((bits ^ (bits >> 27)) >> 11) as f64 / (1_u64 << 53) as f64
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
            assert_eq!(most(&a), a.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            assert_eq!(sum_of_pairs(&a, &a, |a, b| 2.0 * a * b), a.iter().map(|a| 2.0 * a * a).sum());
        }
    }
}
