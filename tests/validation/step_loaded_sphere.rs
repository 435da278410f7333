//! The paper's scene on another body, and by the paper's own algorithm; its figures are in `paper_figures`.

use crate::common::StepLoadedSphere;
use crate::common::step_loaded_sphere::errors;
use viscocontact::prelude::*;

#[test]
fn a_generalized_body_with_three_times_is_the_closed_form() {
    let terms = [(0.4e-6, 0.02), (0.3e-6, 0.3), (0.6e-6, 4.0)];
    let body = GeneralizedKelvin::new(1.0e-6, 0.2e-6, &terms).unwrap();
    let scene = StepLoadedSphere { material: Material::incompressible(body), ..StepLoadedSphere::maxwell() };
    let (contact, _) = scene.run(128, 200, Settings::default()).unwrap();
    let error = errors(&contact, &scene.reference().unwrap());
    assert!(error.central_pressure.abs() < 5e-4 && error.approach.abs() < 5e-4, "{error:?}");
}

/// The paper's algorithm whole solves the same scene, at its own (first) order in time.
#[test]
fn the_papers_own_algorithm_agrees_at_more_work() {
    let scene = StepLoadedSphere::maxwell();
    let (contact, work) = scene.run(64, 100, Settings::paper()).unwrap();
    let error = errors(&contact, &scene.reference().unwrap());
    assert!((1e-3..1e-2).contains(&error.central_pressure.abs()), "{error:?}");
    assert!(error.approach.abs() < 1e-3, "{error:?}");
    let (_, ours) = scene.run(64, 100, Settings::default()).unwrap();
    println!("Polonsky–Keer {work:.1}, active set {ours:.1} convolution equivalents per step");
    assert!(work > 3.0 * ours);
}
