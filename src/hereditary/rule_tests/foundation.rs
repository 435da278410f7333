//! A sphere on a one-dimensional foundation, with any interpolant.

use crate::hereditary::remembered_field::RememberedField;
use crate::hereditary::{ExponentialRule, Interpolant};
use crate::parallel::Rows;
use crate::rheology::CreepSpectrum;

/// What a step is given.
#[derive(Debug, Clone, Copy)]
pub enum Given {
    Force(f64),
    Approach(f64),
}

/// Independent elements under the profile g = x², from the axis to 1.
pub struct Foundation {
    gap: Vec<f64>,
    width: f64,
    pub rule: ExponentialRule,
    pub field: RememberedField,
    interpolant: Interpolant,
    load: Vec<f64>,
}

impl Foundation {
    pub fn new(body: &CreepSpectrum, elements: usize, interpolant: Interpolant) -> Foundation {
        let (width, rule) = (1.0 / elements as f64, ExponentialRule::new(body));
        Foundation {
            gap: (0..elements).map(|k| ((k as f64 + 0.5) * width).powi(2)).collect(),
            width,
            field: RememberedField::new(rule.branches(), elements),
            rule,
            interpolant,
            load: vec![0.0; elements],
        }
    }

    /// The answer: the approach to a force, the force to an approach.
    pub fn step(&mut self, dt: f64, given: Given) -> f64 {
        self.rule.compute_weights(dt, self.interpolant);
        self.field.predict_non_negative(&mut self.rule, 0.0, &Rows::all([self.load.len(), 1]), || true);
        let c = self.rule.compliance();
        let touch: Vec<f64> = self.gap.iter().zip(self.field.trial()).map(|(g, u_old)| g + u_old).collect();
        let approach = match given {
            Given::Approach(approach) => approach,
            Given::Force(force) => {
                let mut sorted = touch.clone();
                sorted.sort_by(f64::total_cmp);
                // width Σ (approach − touch) = force c over as many elements as are touched
                let (mut sum, mut approach) = (force * c / self.width, sorted[0]);
                for (k, touch) in sorted.iter().enumerate() {
                    if k > 0 && *touch >= approach {
                        break;
                    }
                    sum += touch;
                    approach = sum / (k + 1) as f64;
                }
                approach
            }
        };
        for (load, touch) in self.load.iter_mut().zip(&touch) {
            *load = (approach - touch).max(0.0) / c;
        }
        assert!(self.load[self.load.len() - 1] == 0.0, "the foundation is too short");
        self.field.add(c, &self.load);
        self.rule.commit();
        self.field.commit();
        if let Given::Force(_) = given { approach } else { self.width * self.load.iter().sum::<f64>() }
    }
}
