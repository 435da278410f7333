//! Is a body what was asked for: its spectra, its tables, its fitted series, its share in a contact?

mod bodies;
mod intervals;
mod measured;
mod one_bad_row;
mod refusals;
mod repeats;
mod sparse_tables;
pub mod spectra;
mod superposed;
mod tension;
mod vertical;

use viscocontact::rheology::{Experiment, Measurements, RelaxationSpectrum};

use crate::common::{pairs, triples};

/// A table of a body: its creep or its moduli at `times`, or at the frequencies that are their reciprocals, each value as it was
/// `measured`.
fn table(
    experiment: Experiment,
    (creep, relaxation): (&dyn Fn(f64) -> f64, &RelaxationSpectrum),
    times: &[f64],
    mut measured: impl FnMut(f64) -> f64,
) -> Measurements {
    let mut column = |x: &[f64], value: &dyn Fn(f64) -> f64| x.iter().map(|&x| measured(value(x))).collect::<Vec<_>>();
    let rows = match experiment {
        Experiment::Creep => Measurements::creep(&pairs(times, &column(times, creep))),
        Experiment::Relaxation => Measurements::relaxation(&pairs(times, &column(times, &|t| relaxation.modulus(t)))),
        _ => {
            let omega: Vec<f64> = times.iter().rev().map(|t| 1.0 / t).collect();
            let storage = column(&omega, &|omega| relaxation.complex_modulus(omega).re);
            let loss = column(&omega, &|omega| relaxation.complex_modulus(omega).im);
            Measurements::dynamic(&triples(&omega, &storage, &loss))
        }
    };
    rows.unwrap()
}
