//! Pressures in a few numbers.

use crate::ViscoelasticContact;

impl ViscoelasticContact {
    /// Mean pressure over the contact \[Pa\]: force over [`contact_area`](ViscoelasticContact::contact_area); 0 without
    /// contact.
    pub fn mean_pressure(&self) -> f64 {
        let area = self.contact_area();
        if area > 0.0 { self.force() / area } else { 0.0 }
    }

    /// The greatest pressure of any cell \[Pa\]; 0 without contact.
    pub fn greatest_pressure(&self) -> f64 {
        crate::sum::greatest(self.pressure())
    }
}

#[cfg(test)]
mod tests {
    use crate::analytic::Hertz;
    use crate::load::Load;
    use crate::observe::sphere;

    #[test]
    fn hertz() {
        let exact = Hertz::new(10.0e-3, 4.0e6, 0.5).unwrap();
        let peak = exact.pressure(0.0);
        // a cell lies in the middle
        let mut contact = sphere([129; 2], [2.6 * exact.contact_radius(); 2], [0.0; 2], 0.5);
        assert!((contact.greatest_pressure() / peak - 1.0).abs() < 1e-3);
        assert!((contact.mean_pressure() / (peak / 1.5) - 1.0).abs() < 3e-3);
        contact.step(0.0, Load::force(0.0)).unwrap();
        assert_eq!([contact.mean_pressure(), contact.greatest_pressure()], [0.0; 2]);
    }
}
