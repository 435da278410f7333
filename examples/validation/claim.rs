//! A number beside the one that it should be, and curves beside theirs.

use std::error::Error;

use viscocontact::plot::{COLORS, Chart, Legend, Style};

/// Result of a scene.
pub type Outcome = Result<Checked, Box<dyn Error>>;

/// One number beside the one that it should be.
pub struct Claim {
    pub scene: &'static str,
    pub quantity: &'static str,
    pub reference: &'static str,
    pub computed: f64,
    pub exact: f64,
    /// Relative error allowed.
    pub allowed: f64,
}

impl Claim {
    pub fn error(&self) -> f64 {
        (self.computed / self.exact - 1.0).abs()
    }

    pub fn holds(&self) -> bool {
        self.error() <= self.allowed
    }
}

/// A curve beside the one that it should lie on.
pub struct Curve {
    /// Quantities of the axes.
    pub axes: [&'static str; 2],
    pub legend: Legend,
    pub exact: Vec<(f64, f64)>,
    pub computed: Vec<(f64, f64)>,
}

/// The claims of one scene, and its picture, if it has one.
pub struct Checked {
    pub claims: Vec<Claim>,
    pub curve: Option<Curve>,
}

impl Checked {
    /// Rows of: what, computed, exact, allowed.
    pub fn new(scene: &'static str, reference: &'static str, rows: &[(&'static str, f64, f64, f64)]) -> Checked {
        let claim =
            |&(quantity, computed, exact, allowed)| Claim { scene, quantity, reference, computed, exact, allowed };
        Checked { claims: rows.iter().map(claim).collect(), curve: None }
    }

    /// With a picture, the legend where it leaves the curve free; of the computed points about fifty are shown.
    pub fn drawn(
        self,
        axes: [&'static str; 2],
        legend: Legend,
        exact: Vec<(f64, f64)>,
        computed: Vec<(f64, f64)>,
    ) -> Checked {
        let every = (computed.len() / 50).max(1);
        let computed = computed.into_iter().skip(every / 2).step_by(every).collect();
        Checked { curve: Some(Curve { axes, legend, exact, computed }), ..self }
    }

    /// The picture.
    pub fn chart(&self) -> Option<Chart> {
        let (curve, claim) = (self.curve.as_ref()?, self.claims.first()?);
        let mut chart = Chart::new(claim.scene, curve.axes[0], curve.axes[1], curve.legend);
        chart.add(claim.reference, COLORS[0], Style::Line, curve.exact.clone());
        chart.add("computed", COLORS[1], Style::Dots, curve.computed.clone());
        Some(chart)
    }
}
