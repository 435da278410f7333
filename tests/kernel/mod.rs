//! Does a pressure displace the surface as the theory says, on every kind of body?

mod coefficients;
mod layers;
mod love;
mod other_bodies;

use viscocontact::InfluenceKernel;

/// K p.
fn convolve(kernel: &InfluenceKernel, pressure: &[f64]) -> Vec<f64> {
    let mut displacement = vec![f64::NAN; pressure.len()];
    kernel.convolve(pressure, &mut displacement, &mut kernel.workspace().unwrap()).unwrap();
    displacement
}

/// Any pressure, the same every time.
fn noise(cells: usize) -> Vec<f64> {
    (0..cells).map(|k| ((k * k) as f64 * 0.37 + 1.0).sin()).collect()
}
