//! This crate's side of the comparison with Tamaas, `benches/versus_tamaas.py`, which calls it and says how to run it.
//!
//! * `reference SCENE FOLDER` writes the gap of a scene and its pressures, solved to far below every error compared.
//! * `measure SCENE FOLDER ERROR` looks for the cheapest steps and tolerance whose pressures differ from those by at most
//!   ERROR, and prints `way error seconds steps tolerance iterations`, by default and on the whole grid.

use std::env;
use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::{Arc, LazyLock};
use std::time::Instant;

use viscocontact::InfluenceKernel;
use viscocontact::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["reference", scene, folder] => write_reference(&Scene::named(scene)?, Path::new(folder)),
        ["measure", scene, folder, error] => measure(&Scene::named(scene)?, Path::new(folder), error.parse()?),
        _ => Err("`reference SCENE FOLDER` or `measure SCENE FOLDER ERROR`".into()),
    }
}

/// Runs whose mean time is taken.
const RUNS: f64 = 8.0;

/// A body under a constant force from t = 0, and when its pressures are compared.
struct Scene {
    grid: Grid,
    geometry: Box<dyn Geometry>,
    /// None of an elastic body of E* = 1.
    material: Option<Material>,
    kernel: Arc<InfluenceKernel>,
    force: f64,
    /// Intervals between the times at which pressures are compared \[s\], and steps of each that may do; none if they are
    /// compared at t = 0 alone.
    intervals: &'static [f64],
    steps: &'static [usize],
    reference_steps: usize,
}

impl Scene {
    /// In units in which lengths and moduli are near 1.
    fn named(name: &str) -> Result<Scene, Box<dyn Error>> {
        Ok(if name == "sphere" {
            // long-term modulus 1, retardation time 1; on a square 2.25 radii wide of the contact of the compliance at 2 s
            let material = Material::incompressible(Zener::with_time(2.0, 2.0, 1.0)?);
            let force = 0.01;
            let radius = (0.75 * force * material.contact_compliance(2.0)).cbrt();
            let grid = Grid::square(256, 2.25 * radius)?;
            Scene {
                kernel: Arc::new(InfluenceKernel::half_space(&grid)?),
                grid,
                geometry: Box::new(FnGeometry::new(|x1: f64, x2: f64| 0.5 * (x1 * x1 + x2 * x2))),
                material: Some(material),
                force,
                intervals: &[1.0, 1.0],
                steps: &[1, 2, 3, 4, 6, 8, 12],
                reference_steps: 400,
            }
        } else {
            let grid = Grid::square(512, 1.0)?;
            let spec = RoughSpec::new(1.0, 8.0 / 512.0, Roughness::RmsSlope(0.1)).with_roll_off(0.25).with_seed(1);
            Scene {
                kernel: Arc::new(InfluenceKernel::periodic(&grid)?),
                geometry: Box::new(Rough::new(&grid, spec)?),
                grid,
                material: None,
                force: 0.03,
                intervals: &[],
                steps: &[0],
                reference_steps: 0,
            }
        })
    }

    fn contact(&self, settings: Settings) -> Result<Pressed, viscocontact::Error> {
        let (grid, kernel, settings) = (self.grid.clone(), self.kernel.clone(), settings.with_edge(Edge::Allow));
        Ok(match &self.material {
            Some(material) => {
                let builder = ViscoelasticContact::builder(grid).geometry(&*self.geometry).material(material.clone());
                Pressed::Creeping(Box::new(builder.kernel(kernel).settings(settings).build()?))
            }
            None => {
                let builder = ElasticContact::builder(grid).geometry(&*self.geometry).modulus(1.0);
                Pressed::Elastic(Box::new(builder.kernel(kernel).settings(settings).build()?))
            }
        })
    }

    /// The pressures compared, the seconds that the steps take, and their iterations.
    fn run(&self, contact: &mut Pressed, steps: usize) -> Result<(Vec<f64>, f64, usize), Box<dyn Error>> {
        let load = Load::force(self.force);
        let (mut pressures, mut seconds) = (Vec::new(), 0.0);
        let start = processor_seconds();
        let mut iterations = contact.take(0.0, load)?;
        seconds += processor_seconds() - start;
        if self.intervals.is_empty() {
            pressures.extend_from_slice(contact.fields().pressure());
        }
        for interval in self.intervals {
            let start = processor_seconds();
            for _ in 0..steps {
                iterations += contact.take(interval / steps as f64, load)?;
            }
            seconds += processor_seconds() - start;
            pressures.extend_from_slice(contact.fields().pressure());
        }
        Ok((pressures, seconds, iterations))
    }
}

/// The contact of a scene.
#[derive(Clone)]
enum Pressed {
    Creeping(Box<ViscoelasticContact>),
    Elastic(Box<ElasticContact>),
}

impl Pressed {
    /// A step of length `dt`, which does not matter to an elastic body; returns its iterations.
    fn take(&mut self, dt: f64, load: Load) -> Result<usize, viscocontact::Error> {
        match self {
            Pressed::Creeping(contact) => contact.step(dt, load).map(|report| report.iterations),
            Pressed::Elastic(contact) => contact.solve(load).map(|report| report.iterations),
        }
    }

    fn fields(&self) -> Fields<'_> {
        match self {
            Pressed::Creeping(contact) => contact.fields(),
            Pressed::Elastic(contact) => contact.fields(),
        }
    }
}

/// Seconds of processor time that this process has taken, in all its threads, so that other processes on the machine count
/// little; where the system does not tell (Linux does, every few milliseconds), seconds.
fn processor_seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let nanoseconds = || -> Option<f64> {
        let of = |task: fs::DirEntry| {
            fs::read_to_string(task.path().join("schedstat")).ok()?.split(' ').next()?.parse::<f64>().ok()
        };
        fs::read_dir("/proc/self/task").ok()?.map(|task| of(task.ok()?)).sum()
    };
    nanoseconds().map_or_else(|| START.elapsed().as_secs_f64(), |nanoseconds| 1e-9 * nanoseconds)
}

fn write_reference(scene: &Scene, folder: &Path) -> Result<(), Box<dyn Error>> {
    let write = |name, values: &[f64]| {
        fs::write(folder.join(name), values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>())
    };
    let mut gap = vec![0.0; scene.grid.len()];
    scene.geometry.fill_gap(&scene.grid, &mut gap);
    write("gap", &gap)?;
    let mut contact = scene.contact(Settings::default().with_tolerance(1e-10))?;
    write("pressures", &scene.run(&mut contact, scene.reference_steps)?.0)?;
    let share = contact.fields().contact_cells() as f64 / scene.grid.len() as f64;
    println!("{:e} {} {share:.3}", scene.grid.lengths()[0], scene.force);
    Ok(())
}

fn measure(scene: &Scene, folder: &Path, allowed: f64) -> Result<(), Box<dyn Error>> {
    let bytes = fs::read(folder.join("pressures"))?;
    let reference: Vec<f64> =
        bytes.chunks_exact(8).map(|value| f64::from_le_bytes(value.try_into().unwrap())).collect();
    let size = reference.len() / scene.intervals.len().max(1);
    let error = |pressures: &[f64]| {
        let of =
            |(p, r): (&[f64], &[f64])| p.iter().zip(r).map(|(p, r)| (p - r).abs()).sum::<f64>() / r.iter().sum::<f64>();
        pressures.chunks_exact(size).zip(reference.chunks_exact(size)).map(of).fold(0.0, f64::max)
    };
    for (way, part) in [("default", true), ("whole-grid", false)] {
        let mut cheapest = (f64::INFINITY, String::new());
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
            let settings = Settings::default().with_tolerance(tolerance).with_symmetry(part).with_window(part);
            let mut contact = scene.contact(settings)?;
            let at_rest = contact.clone();
            for &steps in scene.steps {
                let (mut sum, mut runs, mut last) = (0.0, 0.0, String::new());
                while runs < RUNS {
                    contact.clone_from(&at_rest);
                    let (pressures, seconds, iterations) = scene.run(&mut contact, steps)?;
                    let error = error(&pressures);
                    (sum, runs) = (sum + seconds, runs + 1.0);
                    last = format!(
                        "{error:e} {:e} {} {tolerance:e} {iterations}",
                        sum / runs,
                        steps * scene.intervals.len()
                    );
                    if error > allowed || sum > (1.2 * runs + 0.3) * cheapest.0 {
                        break; // not worth another run
                    }
                }
                if runs == RUNS && sum / runs < cheapest.0 {
                    cheapest = (sum / runs, last);
                }
            }
        }
        println!("{way} {}", cheapest.1);
    }
    Ok(())
}
