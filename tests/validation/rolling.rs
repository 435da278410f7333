//! A cylinder rolling over a standard solid, step by step to its steady state, against a formulation that has no steps.

use crate::common::builder_of;
use approx::assert_abs_diff_eq;

use crate::common::figures;
use crate::common::march::march;
use crate::common::rolling::RollingCylinder;
use viscocontact::contact::Warnings;
use viscocontact::prelude::*;

const G: f64 = 1.0e6;
const G_K: f64 = 0.5e6;
const TAU: f64 = 1.0;
/// Cells on half the width of the glassy contact.
pub(super) const FINE: f64 = 32.0;

/// J = 1/G + (1 − e^(−t/τ))/G_K, C = J/4; `speed` is v τ over half the width of the glassy contact.
pub(super) fn scene(speed: f64) -> RollingCylinder {
    let mut scene =
        RollingCylinder { radius: 0.02, per_length: 500.0, glassy: 0.25 / G, delayed: 0.25 / G_K, reach: 1.0 };
    scene.reach = speed * scene.hertz(scene.glassy).0;
    scene
}

pub(super) struct Rolled {
    pub(super) contact: ViscoelasticContact,
    shape: Shifted,
    /// Axis of the cylinder.
    pub(super) at: f64,
    /// Whether what has left the grid matters.
    pub(super) leaves: bool,
}

impl Rolled {
    fn peak(&self) -> f64 {
        self.contact.pressure().iter().copied().fold(0.0, f64::max)
    }

    fn friction(&self) -> f64 {
        self.contact.fields().slope_force(&self.shape)[0] / self.contact.force()
    }

    fn width(&self) -> f64 {
        self.contact.contact_area()
    }
}

/// On a grid that reaches `behind` the contact.
pub(super) fn roll(scene: &RollingCylinder, direction: f64, behind: f64) -> Rolled {
    let side = scene.hertz(scene.glassy).0 / FINE;
    let relaxed = scene.hertz(scene.glassy + scene.delayed).0;
    let cells = ((behind + 3.0 * relaxed) / side) as usize;
    let grid = Grid::new([cells, 1], [cells as f64 * side, 1.0]).unwrap();
    let at = direction * (0.5 * cells as f64 * side - 2.0 * relaxed);
    let shape = Shifted::new(Cylinder::new(scene.radius).unwrap(), [at, 0.0]).unwrap();
    let mut contact =
        builder_of(&shape, grid.clone(), Material::incompressible(Zener::new(G, G_K, G_K * TAU).unwrap()))
            .kernel(InfluenceKernel::line(&grid, 1.0).unwrap())
            .settings(Settings::default().with_frame(Frame::Indenter))
            .build()
            .unwrap();
    let velocity = direction * scene.reach / TAU;
    let load = Load::force(scene.per_length);
    march(&mut contact, Axis::X1, velocity, load, (grid.lengths()[0], 4e-3)).unwrap();
    let cell = [direction as isize, 0];
    let report = contact.step_over(cell, side / velocity.abs(), load).unwrap();
    Rolled { contact, shape, at, leaves: report.warnings.contains(Warnings::WAKE) }
}

/// Five speeds over four decades, forth or back: peak pressure, width, both ends of contact, friction.
#[test]
fn rolling_ends_in_the_steady_state_of_the_reference() {
    let (mut worst_peak, mut worst_width, mut frictions) = (0.0_f64, 0.0_f64, Vec::new());
    for (speed, direction) in [(0.01, 1.0), (0.1, -1.0), (1.0, 1.0), (10.0, -1.0), (100.0, 1.0)] {
        let scene = scene(speed);
        let (glassy, relaxed) = (scene.hertz(scene.glassy).0, scene.hertz(scene.glassy + scene.delayed).0);
        let (side, steady) = (glassy / FINE, scene.steady(600));
        let rolled = roll(&scene, direction, (5.0 * scene.reach).clamp(4.0 * relaxed, 450.0 * glassy));
        assert!(!rolled.leaves, "{speed}");
        let (peak, [behind, ahead]) = (rolled.peak() / steady.peak() - 1.0, steady.ends());
        let friction = direction * rolled.friction() / steady.friction(scene.radius) - 1.0;
        let width = (rolled.width() - (ahead - behind)) / side;
        println!("v τ/a = {speed}: peak {peak:.1e}, width {width:.2} cells, friction {friction:.1e}");
        assert!(peak.abs() < 1e-3, "{speed}: {peak}");
        assert!(width.abs() < 0.8, "{speed}: {width}");
        assert!(friction.abs() < 0.012, "{speed}: {friction}");
        (worst_peak, worst_width) = (worst_peak.max(peak.abs()), worst_width.max(width.abs()));
        frictions.push(friction.abs());
        let grid = rolled.contact.grid();
        let touched = (0..grid.len()).filter(|&i| rolled.contact.pressure()[i] > 0.0);
        let ends = touched.map(|i| direction * (grid.center(i, 0)[0] - rolled.at));
        let found = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        assert!((found[0] - behind).abs() < 1.5 * side && (found[1] - ahead).abs() < 1.5 * side, "{speed}: {found:?}");
    }
    let others = frictions[1..].iter().fold(0.0_f64, |most, error| most.max(*error));
    let text = format!(
        "maximum pressure {worst_peak:.1e}, width {worst_width:.2} cells, friction {:.1e} at the slowest speed, {others:.1e} at the others",
        frictions[0]
    );
    figures::figure("errors of rolling", &text).unwrap();
}

/// So slow that the body has time to relax, and so fast that it has none: Hertz, twice.
#[test]
fn very_slow_and_very_fast_rolling_is_hertzs() {
    let mut errors = Vec::new();
    for (speed, compliance) in [(1e-4, 0.25 / G + 0.25 / G_K), (1e6, 0.25 / G)] {
        let scene = scene(speed);
        let (half_width, peak) = scene.hertz(compliance);
        let rolled = roll(&scene, 1.0, 4.0 * scene.hertz(scene.glassy + scene.delayed).0);
        // slow creep has left nothing so far that matters
        assert!(!rolled.leaves, "{speed}");
        let (peak, width) = (rolled.peak() / peak - 1.0, 0.5 * rolled.width() / half_width - 1.0);
        println!("v τ/a = {speed}: peak {peak:.1e}, width {width:.1e}, friction {:.1e}", rolled.friction());
        assert!(peak.abs() < 3e-3 && width.abs() < 6e-3, "{speed}: {peak} {width}");
        assert_abs_diff_eq!(rolled.friction(), 0.0, epsilon = 1e-3 * half_width / scene.radius);
        errors.push([peak, width].map(|error| format!("{:.1e}", error.abs())));
    }
    let [[slow, slow_width], [fast, fast_width]] = &errors[..] else { unreachable!() };
    let text = format!("maximum pressure {slow} and {fast}, width {slow_width} and {fast_width}");
    figures::figure("errors of very slow and very fast rolling", &text).unwrap();
}
