//! The near field against the operator.

use super::*;
use crate::{Grid, Layer};

/// Between cells less than half of the grid apart, and their mirror images, the near field is the operator, on
/// the half-space and on a layer, whether the cells make the transform fast or not. Nowhere does it give energy
/// away.
#[test]
fn the_near_field_is_the_operator_nearby() {
    for (cells, folded) in [([16, 12], [false; 2]), ([17, 23], [false; 2]), ([16, 24], [true, true])] {
        let grid = Grid::new(cells, [1.0, 1.3]).unwrap();
        let layer = Layer::bonded_to_rigid(0.2, 0.45).unwrap();
        for whole in [InfluenceKernel::half_space(&grid).unwrap(), InfluenceKernel::layer(&grid, layer).unwrap()] {
            let own = [0, 1].map(|axis| cells[axis] / if folded[axis] { 2 } else { 1 });
            let part = Grid::new(own, [0, 1].map(|axis| grid.spacing()[axis] * own[axis] as f64)).unwrap();
            let kernel = whole.on(&part, folded);
            let (near, mut work_near) = kernel.near().unwrap();
            let mut work = kernel.workspace();
            // all that acts lies within a square of half of the grid
            let begin = [0, 1].map(|axis| if folded[axis] { 0 } else { cells[axis] / 4 });
            let count = [0, 1].map(|axis| cells[axis] / if folded[axis] { 4 } else { 2 });
            let acts = |k: usize| {
                [k / own[1], k % own[1]]
                    .iter()
                    .zip(begin)
                    .zip(count)
                    .all(|((&i, begin), count)| i >= begin && i < begin + count)
            };
            let field: Vec<f64> =
                (0..part.len()).map(|k| if acts(k) { ((k * k + 3) as f64).sin() } else { 0.0 }).collect();
            let (mut exact, mut found) = (vec![0.0; field.len()], vec![0.0; field.len()]);
            kernel.apply(&field, &mut exact, &mut work);
            work.swap(&mut work_near);
            near.apply(&field, &mut found, &mut work);
            let most = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            for k in (0..field.len()).filter(|&k| acts(k)) {
                assert!(
                    (exact[k] - found[k]).abs() < 1e-12 * most,
                    "{cells:?}, {folded:?}, cell {k}: {} {}",
                    exact[k],
                    found[k]
                );
            }
            let waves: Vec<f64> = (0..field.len()).map(|k| ((7 * k * k + k) as f64).cos()).collect();
            near.apply(&waves, &mut found, &mut work);
            assert!(waves.iter().zip(&found).map(|(p, v)| p * v).sum::<f64>() > 0.0);
        }
    }
}
