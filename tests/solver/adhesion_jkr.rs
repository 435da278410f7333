//! Does a sphere that attracts by a short range stick as Johnson, Kendall & Roberts have it? Units E* = R = w = 1. Their attraction has no range:
//! the difference falls with the range, and the limit is extrapolated. `ADHESION_RANGES` (2) chooses how many ranges are taken.

use std::f64::consts::PI;

use crate::common::environment::from_environment;
use crate::common::sticky::{ball, elastic, least};
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::analytic::Jkr;
use viscocontact::prelude::*;

/// Cells in the zone, and the side of the square.
const ZONE: f64 = 6.0;
const SIDE: f64 = 6.0;
/// Contact radii of JKR's states: from a contact that pulls half as much as it can, through its greatest pull.
const RADII: [f64; 9] = [2.0, 1.9, 1.8, 1.7, 1.6, 1.52, 1.45, 1.35, 1.25];

/// Order of the difference in the range, between 1.4 and 1.6 here.
const ORDER: f64 = 1.5;

/// Forces at JKR's approaches, and the greatest pull among them and between, under a range.
fn retracted(range: f64, approaches: &[f64]) -> (Vec<f64>, f64) {
    let cells = 2 * (0.5 * ZONE * SIDE / (range * range)).ceil() as usize;
    let law = ExponentialAttraction::new(1.0, range).unwrap();
    let mut contact = ball(cells, SIDE, elastic(), law).build().unwrap();
    contact.step(1.0, Load::approach(approaches[0] + 0.2)).unwrap();
    let mut step = |approach: f64| (approach, contact.step(1.0, Load::approach(approach)).unwrap().force);
    let path: Vec<(f64, f64)> = approaches.iter().map(|&approach| step(approach)).collect();
    (path.iter().map(|(_, force)| *force).collect(), least(&path))
}

#[test]
fn a_short_range_sticks_as_jkr() {
    let theory = Jkr::new(1.0, 1.0, 1.0).unwrap();
    let (exact, approaches): (Vec<f64>, Vec<f64>) = RADII.iter().map(|&a| theory.state(a).into()).unzip();
    let ranges: Vec<f64> = (0..from_environment("ADHESION_RANGES", 2)).map(|k| 0.49 * 0.7f64.powi(k as i32)).collect();
    let found: Vec<_> = ranges.iter().map(|&range| retracted(range, &approaches)).collect();
    let curve = |forces: &[f64]| forces.iter().zip(&exact).map(|(f, e)| (f - e).abs()).fold(0.0, f64::max) / (1.5 * PI);
    let excess = |pull: f64| pull / theory.pull_off_force() - 1.0;
    for (range, (forces, pull)) in ranges.iter().zip(&found) {
        println!("range {range:.3}: pull-off differs by {:.5}, curve by {:.4}", excess(*pull), curve(forces));
        // every range pulls harder than none
        assert!((0.0..0.15 * range.powf(1.5)).contains(&excess(*pull)), "{range}: {pull}");
    }
    let limit = |coarse: f64, fine: f64| (fine - 0.7f64.powf(ORDER) * coarse) / (1.0 - 0.7f64.powf(ORDER));
    for pair in found.windows(2) {
        let [(coarse, coarse_pull), (fine, fine_pull)] = pair else { unreachable!() };
        let order = (excess(*coarse_pull) / excess(*fine_pull)).ln() / 0.7f64.ln().abs();
        let pull = excess(limit(*coarse_pull, *fine_pull));
        let forces: Vec<f64> = coarse.iter().zip(fine).map(|(&coarse, &fine)| limit(coarse, fine)).collect();
        println!(
            "order in the range {order:.2}; extrapolated: pull-off differs by {pull:.5}, curve by {:.4}",
            curve(&forces)
        );
        assert!((1.3..1.8).contains(&order) && pull.abs() < 3e-3 && curve(&forces) < 1e-2, "{order} {pull}");
    }
}
