//! Convolutions of two components.

use num_complex::Complex64;

use crate::fft::RealPlane;

/// A convolution of two components with real spectra, on a rectangle of cells.
#[derive(Debug, Clone)]
pub(super) struct Operator {
    pub(super) cells: [usize; 2],
    pub(super) plane: RealPlane,
    /// xx, yy and xy of each coefficient, over the number of values.
    pub(super) spectrum: Vec<[f64; 3]>,
    work: [Vec<Complex64>; 2],
}

impl Operator {
    pub(super) fn new(
        cells: [usize; 2],
        mut plane: RealPlane,
        of: impl FnOnce(&mut RealPlane) -> Vec<[f64; 3]>,
    ) -> Operator {
        let mut spectrum = of(&mut plane);
        let scale = 1.0 / plane.periods().iter().product::<usize>() as f64;
        spectrum.iter_mut().flatten().for_each(|value| *value *= scale);
        let work = [(); 2].map(|()| vec![Complex64::ZERO; plane.coefficients()]);
        Operator { cells, plane, spectrum, work }
    }

    /// out ← K field; both hold the components one after the other.
    pub(super) fn apply(&mut self, field: &[f64], out: &mut [f64]) {
        let Operator { cells: [_, columns], plane, spectrum, work: [first, second] } = self;
        let (one, two) = field.split_at(field.len() / 2);
        plane.forward(one.chunks_exact(*columns), first);
        plane.forward(two.chunks_exact(*columns), second);
        for ((one, two), &[xx, yy, xy]) in first.iter_mut().zip(second.iter_mut()).zip(&*spectrum) {
            (*one, *two) = (xx * *one + xy * *two, xy * *one + yy * *two);
        }
        let (one, two) = out.split_at_mut(field.len() / 2);
        plane.inverse(first, one.chunks_exact_mut(*columns));
        plane.inverse(second, two.chunks_exact_mut(*columns));
    }
}
