//! A sweep of many small contacts: a random rough surface slides over a standard solid, at several speeds and with several
//! seeds. The result of each case is kept in a file, so that a sweep that was stopped resumes.

use std::error::Error;
use std::fs;
use std::path::Path;

use viscocontact::prelude::*;

/// Error of a case, also on another thread.
pub type Failure = Box<dyn Error + Send + Sync>;

/// One contact of the sweep.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub speed: f64,
    pub seed: u64,
}

/// Friction at one speed, over all seeds.
pub struct Row {
    pub speed: f64,
    pub mean: f64,
    /// Standard deviation between seeds.
    pub spread: f64,
}

/// Period of the surface [m].
const PERIOD: f64 = 1.0e-3;

/// `speeds` speeds from 1 mm/s to 1 m/s, each with `seeds` surfaces.
pub fn cases(speeds: usize, seeds: usize) -> Vec<Case> {
    let speed = |k: usize| 1.0e-3 * 1.0e3_f64.powf(k as f64 / (speeds.max(2) - 1) as f64);
    (0..speeds * seeds).map(|case| Case { speed: speed(case / seeds), seed: (case % seeds) as u64 }).collect()
}

impl Case {
    /// The friction coefficient as a file in `folder` keeps it, or else computed, and kept.
    pub fn friction_kept_in(&self, folder: &Path, cells: usize) -> Result<f64, Failure> {
        let name = format!("speed_{:.3e}_seed_{}_cells_{cells}", self.speed, self.seed);
        let (file, part) = (folder.join(format!("{name}.txt")), folder.join(format!("{name}.part")));
        if let Ok(kept) = fs::read_to_string(&file) {
            return Ok(kept.trim().parse()?);
        }
        let friction = self.friction(cells)?;
        // whole or not at all, should the sweep be stopped here
        fs::write(&part, format!("{friction:?}\n"))?;
        fs::rename(&part, &file)?;
        Ok(friction)
    }

    /// Mean lateral force over normal force, on the second of two periods of travel.
    fn friction(&self, cells: usize) -> viscocontact::Result<f64> {
        let (grid, load) = (Grid::square(cells, PERIOD)?, Load::force(2.0e-3));
        let spec = RoughSpec::new(0.5 * PERIOD, 0.06 * PERIOD, Roughness::RmsSlope(0.05)).with_seed(self.seed);
        let surface = Travel::new(Rough::new(&grid, spec)?, Straight::new([0.0; 2], [self.speed, 0.0])?);
        let mut contact = ViscoelasticContact::builder(grid.clone())
            .geometry(&surface.shape_at(0.0)?)
            .material(Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0e-3)?)) // retarded by 1 ms
            .kernel(InfluenceKernel::periodic(&grid)?)
            .build()?;
        contact.step(0.0, load)?;
        let mut sum = 0.0;
        for step in 0..2 * cells {
            let report = contact.step_along(&surface, PERIOD / cells as f64 / self.speed, load)?; // a cell further
            sum += if step < cells { 0.0 } else { report.lateral_force[0] / contact.force() };
        }
        Ok(sum / cells as f64)
    }
}

/// The table of a sweep, from the friction of each case in their order.
pub fn table(cases: &[Case], seeds: usize, friction: &[f64]) -> Vec<Row> {
    let rows = cases.chunks(seeds).zip(friction.chunks(seeds)).map(|(cases, friction)| {
        let mean = friction.iter().sum::<f64>() / seeds as f64;
        let squares: f64 = friction.iter().map(|value| (value - mean).powi(2)).sum();
        Row { speed: cases[0].speed, mean, spread: (squares / (seeds.max(2) - 1) as f64).sqrt() }
    });
    rows.collect()
}

/// Prints the table.
pub fn print(rows: &[Row]) {
    println!("speed [m/s]  friction  between seeds");
    for Row { speed, mean, spread } in rows {
        println!("{speed:11.3e}  {mean:8.5}  {spread:13.5}");
    }
}
