//! The paper's scene on another body; its figures are in `paper_figures`.

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
