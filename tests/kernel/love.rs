//! Love's coefficients against his four-term closed form with so many digits that none are lost where it cancels.

use astro_float_num::{BigFloat, Consts, RoundingMode};
use viscocontact::{Grid, InfluenceKernel};

const BITS: usize = 320;
const ROUND: RoundingMode = RoundingMode::ToEven;

struct Oracle {
    constants: Consts,
}

impl Oracle {
    /// F(x, y) = x asinh(y/|x|) + y asinh(x/|y|); no term is asked for with a zero factor here.
    fn primitive(&mut self, x: &BigFloat, y: &BigFloat) -> BigFloat {
        let mut half = |x: &BigFloat, y: &BigFloat| {
            let ratio = y.div(&x.abs(), BITS, ROUND);
            x.mul(&ratio.asinh(BITS, ROUND, &mut self.constants), BITS, ROUND)
        };
        half(x, y).add(&half(y, x), BITS, ROUND)
    }

    fn coefficient(&mut self, spacing: [f64; 2], i: usize, j: usize) -> f64 {
        let big = |x: f64| BigFloat::from_f64(x, BITS);
        let corner = |axis: usize, steps: f64| big(spacing[axis]).mul(&big(steps), BITS, ROUND);
        let [left, right] = [-0.5, 0.5].map(|half| corner(0, i as f64 + half));
        let [below, above] = [-0.5, 0.5].map(|half| corner(1, j as f64 + half));
        let rising = self.primitive(&right, &above).add(&self.primitive(&left, &below), BITS, ROUND);
        let falling = self.primitive(&left, &above).add(&self.primitive(&right, &below), BITS, ROUND);
        let pi = self.constants.pi(BITS, ROUND);
        let value = rising.sub(&falling, BITS, ROUND).div(&pi, BITS, ROUND);
        value.to_string().parse().unwrap()
    }
}

#[test]
fn coefficients_are_right_to_1e_14_at_every_distance_and_aspect() {
    let mut oracle = Oracle { constants: Consts::new().unwrap() };
    let steps = [0, 1, 2, 3, 4, 6, 9, 17, 40, 333, 1000, 1001, 4095];
    let mut worst: f64 = 0.0;
    for spacing in
        [[1.0, 1.0], [3.0e-6, 1.0e-6], [0.1, 3.1], [1.0, 1000.0], [1000.0, 1.0], [7.0e-9, 2.2e-7], [1.0, 1.01]]
    {
        let cells = [4096, 4096];
        let grid = Grid::new(cells, [0, 1].map(|axis| cells[axis] as f64 * spacing[axis])).unwrap();
        let spacing = grid.spacing();
        let kernel = InfluenceKernel::half_space(&grid).unwrap();
        for i in steps {
            for j in steps {
                let exact = oracle.coefficient(spacing, i, j);
                let error = (kernel.coefficient(i as isize, j as isize).unwrap() / exact - 1.0).abs();
                assert!(error < 1e-14, "{spacing:?} ({i}, {j}): {error:e}");
                worst = worst.max(error);
            }
        }
    }
    println!("worst relative error {worst:e}");
}
