//! What is counted over many scenes, and its quantiles.

/// Numbers with the names of their scenes, ascending.
#[derive(Debug, Default)]
pub struct Ratios(Vec<(f64, String)>);

impl FromIterator<f64> for Ratios {
    /// Of scenes without names.
    fn from_iter<I: IntoIterator<Item = f64>>(ratios: I) -> Ratios {
        let mut all = Ratios::default();
        ratios.into_iter().for_each(|ratio| all.push(ratio, ""));
        all
    }
}

impl Ratios {
    /// Those of several together.
    pub fn of<'a>(several: impl Iterator<Item = &'a Ratios>) -> Ratios {
        let mut all = Ratios::default();
        several.flat_map(|ratios| &ratios.0).for_each(|(ratio, scene)| all.push(*ratio, scene));
        all
    }

    pub fn push(&mut self, ratio: f64, scene: &str) {
        assert!(!ratio.is_nan(), "{scene}: no number");
        let place = self.0.partition_point(|other| other.0 <= ratio);
        self.0.insert(place, (ratio, scene.into()));
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    pub fn mean(&self) -> f64 {
        self.0.iter().map(|ratio| ratio.0).sum::<f64>() / self.count() as f64
    }

    pub fn above(&self, bound: f64) -> usize {
        self.0.iter().filter(|ratio| ratio.0 > bound).count()
    }

    /// Fails where nothing was compared.
    pub fn quantile(&self, part: f64) -> f64 {
        assert!(self.count() > 0, "nothing was compared");
        self.0[(part * (self.count() - 1) as f64).round() as usize].0
    }

    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    pub fn greatest(&self) -> f64 {
        self.quantile(1.0)
    }

    /// One line, and the scenes of the greatest.
    pub fn print(&self, what: &str, scenes: usize) {
        if self.count() == 0 {
            return println!("  {what:<24} none");
        }
        let [least, low, median, high, higher, most] = [0.0, 0.1, 0.5, 0.9, 0.99, 1.0].map(|part| self.quantile(part));
        let (count, above) = (self.count(), self.above(2.0));
        println!(
            "  {what:<24} {count:>5}: from {least:.3}, {low:.3} {median:.3} {high:.3} {higher:.2} {most:.2}, above 2: {above}"
        );
        self.0.iter().rev().take(scenes).for_each(|(ratio, scene)| println!("    {ratio:.2} {scene}"));
    }
}
