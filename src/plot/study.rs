//! The picture of a convergence study.

use crate::plot::{COLORS, Chart, Legend, Quantity, Scale, Style};
use crate::study::{Mesh, StudyResult};

impl StudyResult {
    /// A chart of the change of each quantity from mesh to mesh over the cells along the longer side; quantities that
    /// do not change are left out.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let (ball, load) = (Sphere::new(10.0e-3)?, StepLoad::new(Load::force(1.0))?);
    /// let body = Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0)?);
    /// let scene = |grid: Grid, settings: Settings| {
    ///     Ok(ViscoelasticContact::builder(grid).geometry(&ball).material(body.clone()).settings(settings))
    /// };
    /// let study = Study::new(scene, &load, 5.0).accuracy(1e-2).run()?;
    /// # let path = std::env::temp_dir().join(format!("viscocontact-doc-study-{}.png", std::process::id()));
    /// study.chart().save(&path)?;
    /// # std::fs::remove_file(&path).unwrap();
    /// # Ok::<(), Error>(())
    /// ```
    pub fn chart(&self) -> Chart {
        let change = Quantity::from("change from the mesh before, over the maximum value");
        let mut chart =
            Chart::new("Convergence study", Quantity::from("cells along a side"), change, Legend::LowerLeft);
        chart.scale = Scale::LogLog;
        let mut colors = COLORS.iter().cycle();
        for (k, own) in self.quantities.iter().enumerate() {
            let point = |mesh: &Mesh| Some((mesh.cells[0].max(mesh.cells[1]) as f64, mesh.changes[k]?));
            let points: Vec<(f64, f64)> = self.meshes.iter().filter_map(point).collect();
            if points.iter().any(|point| point.1 > 0.0) {
                let Some(color) = colors.next() else { continue };
                chart.add(own.name.clone(), *color, Style::LineAndDots, points);
            }
        }
        chart
    }
}
