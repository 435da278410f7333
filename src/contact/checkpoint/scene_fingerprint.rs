//! Fingerprints of a scene, and their comparison.

use std::mem::discriminant;

use serde::{Deserialize, Serialize};

use crate::adhesion::Attraction;
use crate::contact::checkpoint::built::{Mark, times};
use crate::contact::{Scene, Settings};
use crate::error::CheckpointError;
use crate::rounded::texts_without_noise;

/// Numbers of two scenes are the same if they differ by no more than this part: mathematical libraries round
/// differently.
const RELATIVE_TOLERANCE: f64 = 1e-9;
/// Traction and energy of an attraction at some gaps.
fn of_attraction(law: &dyn Attraction) -> Vec<f64> {
    let gaps = [0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 4.0].map(|ranges| ranges * law.range());
    gaps.into_iter().flat_map(|gap| [law.traction(gap), law.energy(gap)]).collect()
}

/// The first entry that differs.
pub(super) fn difference(saved: &[f64], built: &[f64]) -> Option<usize> {
    let same = |a: f64, b: f64| {
        a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= RELATIVE_TOLERANCE * a.abs().max(b.abs())
    };
    let differing = saved.iter().zip(built).position(|(&a, &b)| !same(a, b));
    differing.or_else(|| (saved.len() != built.len()).then(|| saved.len().min(built.len())))
}

impl Mark {
    fn numbers(&self) -> &[f64] {
        match self {
            Mark::Text(_) => &[],
            Mark::Numbers(numbers) | Mark::Series(numbers) | Mark::Values(numbers) => numbers,
        }
    }

    /// The first entry that differs.
    fn difference(&self, other: &Mark) -> Option<usize> {
        match (self, other) {
            (Mark::Text(saved), Mark::Text(built)) => (saved != built).then_some(0),
            _ if discriminant(self) != discriminant(other) => Some(0),
            _ => difference(self.numbers(), other.numbers()),
        }
    }

    /// One of its entries, in words.
    fn entry(&self, entry: usize) -> String {
        if let Mark::Text(text) = self {
            return text.clone();
        }
        let numbers = self.numbers();
        let Some(number) = numbers.get(entry) else { return format!("known by {} numbers", numbers.len()) };
        match self {
            Mark::Values(_) => format!("{number:e} 1/Pa at {:.3e} s", times().nth(entry).unwrap_or(f64::NAN)),
            Mark::Series(_) if entry == 0 => format!("{number:e} 1/Pa at 0 s"),
            Mark::Series(_) if entry == 1 => format!("one that flows by {number:e} 1/(Pa s)"),
            Mark::Series(_) if entry.is_multiple_of(2) => format!("{number:e} 1/Pa in term {}", entry / 2),
            Mark::Series(_) => format!("one with a time of {number:e} s in term {}", entry / 2),
            _ => format!("one whose fingerprint holds {number:e}"),
        }
    }
}

/// A scene, as far as it must not change. Solver, tolerance and limits may.
#[derive(Serialize, Deserialize)]
pub(super) struct Fingerprint([Mark; 14]);

/// The properties that are compared, by name.
fn marks(scene: &Scene) -> [(&'static str, Mark); 14] {
    let Settings { time_rule, frame, symmetry, window, series_tolerance, .. } = scene.ground.settings;
    let ([n1, n2], [d1, d2]) = (scene.ground.grid.cells(), scene.ground.grid.spacing());
    [
        ("grid", Mark::Text(format!("{n1} × {n2} cells of {d1:e} m × {d2:e} m"))),
        ("number of rigid bodies", Mark::Text(scene.ground.bodies.to_string())),
        ("kernel", Mark::Text(scene.ground.kernel.to_string())),
        ("Settings::time_rule", Mark::Text(format!("{time_rule:?}"))),
        ("Settings::frame", Mark::Text(format!("{frame:?}"))),
        ("Settings::symmetry", Mark::Text(symmetry.to_string())),
        ("Settings::window", Mark::Text(window.to_string())),
        ("Settings::series_tolerance", Mark::Text(format!("{series_tolerance:e}"))),
        ("temperature", Mark::Text(format!("{:?}", scene.temperature))),
        ("influence", Mark::Numbers(scene.ground.kernel.mark())),
        ("contact compliance", scene.built.creep(&scene.material).clone()),
        ("attraction", Mark::Numbers(scene.ground.attraction.as_deref().map(of_attraction).unwrap_or_default())),
        ("geometry", Mark::Numbers(scene.built.shape.clone())),
        ("assignment of cells to rigid bodies", Mark::Text(scene.built.owners.clone())),
    ]
}

impl Fingerprint {
    pub(super) fn of(scene: &Scene) -> Fingerprint {
        Fingerprint(marks(scene).map(|(_, mark)| mark))
    }

    /// Rejects another scene, and reports the first difference.
    pub(super) fn require(&self, scene: &Scene) -> Result<(), CheckpointError> {
        for (saved, (what, built)) in self.0.iter().zip(marks(scene)) {
            if let Some(entry) = saved.difference(&built) {
                let [saved, built] = texts_without_noise([saved, &built].map(|mark| mark.entry(entry)));
                return Err(CheckpointError::OtherScene { what, saved, built });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::difference;
    use crate::Grid;
    use crate::contact::checkpoint::built::Built;
    use crate::equilibrium::Region;
    use crate::geometry::Gap;
    use crate::parallel::{Rows, Threads};

    /// What ranks find of a gap, each on own rows, is what one process finds of the whole, folded or not.
    #[test]
    fn ranks_find_what_one_process_finds() {
        let grid = Grid::new([64, 384], [1.0e-3, 6.0e-3]).unwrap();
        for folded in [[false; 2], [true, false], [false, true], [true; 2]] {
            let about = |x: f64, folded: bool| if folded { x * x } else { (x - 0.1e-3) * (x - 0.1e-3) + 1.0e-9 * x };
            let above = (0..grid.len()).map(|k| {
                let [x1, x2] = grid.center(k / 384, k % 384);
                let h = about(x1, folded[0]) + about(x2, folded[1]);
                if h > 4.0e-6 { f64::INFINITY } else { h }
            });
            let gap = Gap { datum: 1.0e-6, above: above.collect(), owner: None };
            let expected = Built::new(&gap, &Region::whole(&grid, [false; 2]));
            assert!(expected.shape[5] > 0.0);
            for size in [1, 3, 5] {
                let found = Threads::run(size, |ranks| {
                    let region = Region::shared(&grid, folded, &Rows::of_rank(grid.cells(), ranks));
                    let own = Gap { datum: 1.0e-6, above: region.cut(&gap.above).collect(), owner: None };
                    Built::new(&own, &region)
                });
                for found in found.unwrap() {
                    assert_eq!(found.owners, expected.owners);
                    assert_eq!(difference(&found.shape, &expected.shape), None, "{folded:?} {size}");
                }
            }
        }
    }
}
