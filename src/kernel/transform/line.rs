//! Transforms of lines of cells, two real lines at a time as the real and imaginary parts of a complex one.
//!
//! | axis | coefficients of x_n | transformed by |
//! |---|---|---|
//! | whole | Σ x_n e^(−2πi kn/P), 0 ≤ k < P | a complex transform of length P |
//! | folded | Σ x_n cos(π k(2n+1)/2L), 0 ≤ k < L | a complex transform of length L (Makhoul, IEEE Trans. ASSP 28, 1980) |
//!
//! A folded line is half of a line that is even about its beginning; its coefficients equal the coefficients of the
//! whole line, of period 2L. Lines shorter than their transform are padded with zeros.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

/// The transform along one axis.
#[derive(Clone)]
pub(crate) struct LineTransform {
    length: usize,
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
    /// e^(−iπk/2L) for 0 ≤ k ≤ L/2 of a folded axis; empty otherwise.
    twist: Vec<Complex64>,
}

impl LineTransform {
    pub(crate) fn new(length: usize, folded: bool) -> LineTransform {
        let mut planner = FftPlanner::new();
        let root = |k: usize| Complex64::from_polar(1.0, -PI * k as f64 / (2 * length) as f64);
        LineTransform {
            length,
            forward: planner.plan_fft_forward(length),
            inverse: planner.plan_fft_inverse(length),
            twist: if folded { (0..=length / 2).map(root).collect() } else { Vec::new() },
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.length
    }

    pub(crate) fn is_folded(&self) -> bool {
        !self.twist.is_empty()
    }

    /// Length of the scratch that the transforms need.
    pub(crate) fn scratch(&self) -> usize {
        self.forward.get_inplace_scratch_len().max(self.inverse.get_inplace_scratch_len())
    }

    /// Number of independent coefficients of a real line: the others mirror them.
    pub(crate) fn independent(&self) -> usize {
        if self.is_folded() { self.len() } else { self.len() / 2 + 1 }
    }

    /// The index of the n-th value of a line in the buffer of the transform: in a folded line even values come first,
    /// odd values from the end back.
    #[inline(always)]
    pub(crate) fn place(&self, n: usize) -> usize {
        if !self.is_folded() {
            n
        } else if n.is_multiple_of(2) {
            n / 2
        } else {
            self.len() - 1 - n / 2
        }
    }

    /// Fills the indices of all but the first `cells` values with zeros.
    #[inline(always)]
    pub(crate) fn pad(&self, buffer: &mut [Complex64], cells: usize) {
        let end = if self.is_folded() { self.len() - cells / 2 } else { self.len() };
        let start = if self.is_folded() { cells.div_ceil(2) } else { cells };
        buffer[start..end].fill(Complex64::default());
    }

    /// Writes the values of a line to their indices.
    #[inline(always)]
    pub(crate) fn fill(&self, buffer: &mut [Complex64], values: impl Iterator<Item = Complex64>) {
        if !self.is_folded() {
            for (z, value) in buffer.iter_mut().zip(values) {
                *z = value;
            }
            return;
        }
        let mut values = values;
        let (mut front, mut back) = (0, buffer.len());
        while let Some(value) = values.next() {
            buffer[front] = value;
            front += 1;
            let Some(value) = values.next() else { return };
            back -= 1;
            buffer[back] = value;
        }
    }

    /// Reads the values of a line from their indices.
    #[inline(always)]
    pub(crate) fn read(&self, buffer: &[Complex64], out: &mut [f64], part: impl Fn(Complex64) -> f64) {
        if !self.is_folded() {
            for (out, &z) in out.iter_mut().zip(buffer) {
                *out = part(z);
            }
            return;
        }
        let values = buffer.iter().zip(buffer.iter().rev());
        for (out, (&front, &back)) in out.chunks_mut(2).zip(values) {
            out[0] = part(front);
            if let Some(out) = out.get_mut(1) {
                *out = part(back);
            }
        }
    }

    /// Transforms the values placed in `buffer` to coefficients.
    #[inline(always)]
    pub(crate) fn forward(&self, buffer: &mut [Complex64], scratch: &mut [Complex64]) {
        self.bare_forward(buffer, scratch);
        if !self.is_folded() {
            return;
        }
        // with a = w_k V_k and b = conj(w_k) V_(L−k): X_k = (a + b)/2, X_(L−k) = i (a − b)/2, without the factor ½
        buffer[0] = buffer[0] + buffer[0];
        for ((v, mirror), w) in pairs(buffer).zip(&self.twist[1..]) {
            let (a, b) = (*v * *w, *mirror * w.conj());
            let difference = a - b;
            (*v, *mirror) = (a + b, Complex64::new(-difference.im, difference.re));
        }
        if self.len().is_multiple_of(2) {
            let middle = &mut buffer[self.len() / 2];
            let w = self.twist[self.len() / 2];
            *middle *= w.re + w.re;
        }
    }

    /// Transforms coefficients to values, multiplied by [`LineTransform::norm`].
    #[inline(always)]
    pub(crate) fn inverse(&self, buffer: &mut [Complex64], scratch: &mut [Complex64]) {
        if self.is_folded() {
            for ((x, mirror), w) in pairs(buffer).zip(&self.twist[1..]) {
                let turned = Complex64::new(-mirror.im, mirror.re);
                let (a, b) = (*x - turned, *x + turned);
                (*x, *mirror) = (a * w.conj(), b * *w);
            }
            if self.len().is_multiple_of(2) {
                let middle = &mut buffer[self.len() / 2];
                let w = self.twist[self.len() / 2];
                *middle *= w.re + w.re;
            }
        }
        self.inverse.process_with_scratch(buffer, scratch);
    }

    /// Multiplies the real and the imaginary parts of the coefficients of a folded complex line by a spectrum each in
    /// one pass, between
    /// [`LineTransform::bare_forward`] and [`LineTransform::bare_inverse`].
    #[inline(always)]
    pub(crate) fn multiply_folded(&self, buffer: &mut [Complex64], first: &[f64], second: &[f64]) {
        let last = buffer.len();
        let (start, middle) = (buffer[0] + buffer[0], buffer[last / 2] + buffer[last / 2]);
        buffer[0] = Complex64::new(start.re * first[0], start.im * second[0]);
        let spectra = first[1..].iter().zip(&second[1..]).zip(first.iter().rev().zip(second.iter().rev()));
        for (((v, mirror), (s, other)), w) in pairs(buffer).zip(spectra).zip(&self.twist[1..]) {
            let (a, b) = (*v * *w, *mirror * w.conj());
            let (sum, difference) = (a + b, a - b);
            let x = Complex64::new(sum.re * *s.0, sum.im * *s.1);
            // i times the coefficient at L − k, which is i (a − b)
            let turned = Complex64::new(-difference.re * *other.1, -difference.im * *other.0);
            (*v, *mirror) = ((x - turned) * w.conj(), (x + turned) * *w);
        }
        if last.is_multiple_of(2) {
            buffer[last / 2] = Complex64::new(middle.re * first[last / 2], middle.im * second[last / 2]);
        }
    }

    /// The complex forward transform, without the twist of folded lines.
    #[inline(always)]
    pub(crate) fn bare_forward(&self, buffer: &mut [Complex64], scratch: &mut [Complex64]) {
        self.forward.process_with_scratch(buffer, scratch);
    }

    /// The complex inverse transform, without the twist of folded lines.
    #[inline(always)]
    pub(crate) fn bare_inverse(&self, buffer: &mut [Complex64], scratch: &mut [Complex64]) {
        self.inverse.process_with_scratch(buffer, scratch);
    }

    /// The factor by which a forward and an inverse transform multiply a line.
    pub(crate) fn norm(&self) -> f64 {
        self.len() as f64 * if self.is_folded() { 2.0 } else { 1.0 }
    }
}

/// The values at k and at length − k, for 0 < k < length/2.
#[inline(always)]
fn pairs<T>(buffer: &mut [T]) -> impl Iterator<Item = (&mut T, &mut T)> {
    let length = buffer.len();
    let (rising, falling) = buffer[1..].split_at_mut((length - 1) / 2);
    rising.iter_mut().zip(falling.iter_mut().rev())
}

/// Splits the transform of a complex line of length P into the transforms of its real and imaginary part: the
/// coefficients k, as many as `first` and `second` hold, but none at or beyond the end of `k`.
#[inline(always)]
pub(crate) fn separate(both: &[Complex64], k: Range<usize>, first: &mut [Complex64], second: &mut [Complex64]) {
    let (mut first, mut second, mut start) = (first, second, k.start);
    if start == 0 {
        let value = both[0];
        (first[0], second[0]) = (Complex64::from(value.re), Complex64::from(value.im));
        (first, second, start) = (&mut first[1..], &mut second[1..], 1);
    }
    let count = first.len().min(k.end.saturating_sub(start));
    let end = both.len() + 1 - start;
    let (values, mirrors) = (&both[start..start + count], &both[end - count..end]);
    let parts = first[..count].iter_mut().zip(&mut second[..count]);
    for ((a, b), (z, mirror)) in parts.zip(values.iter().zip(mirrors.iter().rev())) {
        let (sum, difference) = (*z + mirror.conj(), *z - mirror.conj());
        (*a, *b) = (0.5 * sum, 0.5 * Complex64::new(difference.im, -difference.re));
    }
    first[count..].fill(Complex64::default());
    second[count..].fill(Complex64::default());
}

/// The reverse of [`separate`]: sets the coefficients k and P − k.
#[inline(always)]
pub(crate) fn unite(first: &[Complex64], second: &[Complex64], k: Range<usize>, both: &mut [Complex64]) {
    let (mut first, mut second, mut start) = (first, second, k.start);
    if start == 0 {
        both[0] = Complex64::new(first[0].re, second[0].re);
        (first, second, start) = (&first[1..], &second[1..], 1);
    }
    let count = first.len().min(k.end.saturating_sub(start));
    let end = both.len() + 1 - start;
    // the mirror images first: of an even length the middle is its own
    let parts = first[..count].iter().zip(&second[..count]);
    for (z, (a, b)) in both[end - count..end].iter_mut().rev().zip(parts.clone()) {
        *z = Complex64::new(a.re + b.im, b.re - a.im);
    }
    for (z, (a, b)) in both[start..start + count].iter_mut().zip(parts) {
        *z = Complex64::new(a.re - b.im, a.im + b.re);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(cells: usize) -> Vec<Complex64> {
        (0..cells).map(|n| Complex64::new(((n * n + 3) as f64).sin(), ((5 * n * n + 1) as f64).cos())).collect()
    }

    /// Every coefficient against its definition, and the inverse.
    #[test]
    fn lines_match_their_sums() {
        for folded in [false, true] {
            for (cells, length) in [(1, 1), (1, 2), (3, 4), (3, 5), (5, 6), (6, 6), (7, 10), (15, 15), (40, 42)] {
                let (line, x) = (LineTransform::new(length, folded), signal(cells));
                let mut buffer = vec![Complex64::new(f64::NAN, f64::NAN); length];
                let mut scratch = vec![Complex64::default(); line.scratch()];
                line.pad(&mut buffer, cells);
                x.iter().enumerate().for_each(|(n, &x)| buffer[line.place(n)] = x);
                line.forward(&mut buffer, &mut scratch);
                for (k, value) in buffer.iter().enumerate() {
                    let wave = |n: usize| match folded {
                        true => Complex64::from(2.0 * (PI * (k * (2 * n + 1)) as f64 / (2 * length) as f64).cos()),
                        false => Complex64::from_polar(1.0, -2.0 * PI * (k * n) as f64 / length as f64),
                    };
                    let exact: Complex64 = x.iter().enumerate().map(|(n, x)| x * wave(n)).sum();
                    assert!((value - exact).norm() < 1e-12, "{cells} {length} {folded} {k}: {value} {exact}");
                }
                line.inverse(&mut buffer, &mut scratch);
                for (n, x) in x.iter().enumerate() {
                    let back = buffer[line.place(n)];
                    assert!((back - line.norm() * x).norm() < 1e-12, "{cells} {length} {folded} {n}: {back} {x}");
                }
            }
        }
    }

    #[test]
    fn two_real_lines_are_one_complex_one() {
        for length in [1, 2, 5, 8] {
            let line = LineTransform::new(length, false);
            let mut scratch = vec![Complex64::default(); line.scratch()];
            let mut both = signal(length);
            let mut parts =
                [0, 1].map(|part| both.iter().map(|z| Complex64::from([z.re, z.im][part])).collect::<Vec<_>>());
            line.forward(&mut both, &mut scratch);
            parts.iter_mut().for_each(|part| line.forward(part, &mut scratch));
            // in pieces of three
            let half = length / 2 + 1;
            let mut found = [vec![Complex64::default(); half], vec![Complex64::default(); half]];
            let [first, second] = &mut found;
            for (piece, (first, second)) in first.chunks_mut(3).zip(second.chunks_mut(3)).enumerate() {
                separate(&both, 3 * piece..half, first, second);
            }
            for (found, exact) in found.iter().zip(&parts) {
                assert!(found.iter().zip(exact).all(|(a, b)| (a - b).norm() < 1e-13), "{length}");
            }
            let mut united = vec![Complex64::default(); length];
            for (piece, (first, second)) in found[0].chunks(3).zip(found[1].chunks(3)).enumerate() {
                unite(first, second, 3 * piece..half, &mut united);
            }
            assert!(united.iter().zip(&both).all(|(a, b)| (a - b).norm() < 1e-13), "{length}");
        }
    }
}
