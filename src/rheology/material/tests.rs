//! Contact compliances of a bulk linear in the shear.

use super::{Material, Volume};
use crate::rheology::{GeneralizedMaxwell, PronyTerm};

/// At every s, C = (1 − ν)/2G is 1/4G + 3/4(3K + G) of the two Prony series.
#[test]
fn contact_compliance_obeys_the_correspondence_principle() {
    let terms = [(0.3, 0.01), (0.6, 2.0)].map(|(share, time)| PronyTerm { share, time });
    let (glassy, bulk) = (1.0e9, 2.5e9);
    for ratio in [0.0, 0.3, 0.95] {
        let body = GeneralizedMaxwell::prony(glassy, &terms).unwrap();
        let material = Material::relaxing_bulk(body, bulk, ratio).unwrap();
        let Volume::Bulk(at_once, contact, None) = &material.bodies[0].volume else { panic!("{material:?}") };
        assert!((at_once / bulk - 1.0).abs() < 1e-14);
        for s in [1e-4, 0.1, 1.0, 30.0, 1e5] {
            let lost: f64 = terms.iter().map(|term| term.share / (1.0 + s * term.time)).sum();
            let (g, k) = (glassy * (1.0 - lost), bulk * (1.0 - ratio * lost));
            let found =
                contact.glassy() + contact.terms().iter().map(|(share, time)| share / (1.0 + s * time)).sum::<f64>();
            let exact = 0.25 / g + 0.75 / (3.0 * k + g);
            assert!((found / exact - 1.0).abs() < 1e-11, "{ratio} at {s}: {found}");
        }
    }
}
