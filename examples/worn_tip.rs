//! Which shape creeps like this? The face of a tip is worn; its heights are found from the approach over time that was measured
//! under a force which is raised in steps.
//!
//! The gradient of the approach with respect to the height of each cell comes with the contact on elastic states, so that a fit takes
//! a few sweeps: c ← Jᵀ (J Jᵀ + N)⁻¹ (y − f(c) + J c), the Gauss–Newton method with a prior (Tarantola, Inverse Problem Theory,
//! SIAM 2005, section 3.2; doi:10.1137/1.9780898717921). A curve says nothing of angles and little of details: wear is taken for the
//! same all around, a sum of bumps c over the radius that are likely as deep as the wear; N says how accurate the curve is.
//!
//! `cargo run --release -p viscocontact --features data,plot,states --example worn_tip`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use faer::Mat;
use faer::linalg::solvers::Solve;
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Style};
use viscocontact::prelude::*;

/// The heights of a worn tip from a creep curve.
#[derive(Parser)]
struct Args {
    /// Radius of the new tip [m].
    #[arg(long, default_value_t = 10.0e-3, value_parser = support::positive)]
    radius: f64,
    /// Depth of the wear in the middle [m].
    #[arg(long, default_value_t = 8.0e-6, value_parser = support::positive)]
    wear: f64,
    /// Radius of the wear [m].
    #[arg(long, default_value_t = 0.4e-3, value_parser = support::positive)]
    width: f64,
    /// Deviation of the measured approach [m].
    #[arg(long, default_value_t = 10.0e-9, value_parser = support::positive)]
    noise: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 64, value_parser = support::at_least_one)]
    cells: usize,
    /// A small grid, for a look.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/worn_tip")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

/// The experiment: lengths of steps and forces at their ends.
fn protocol() -> Vec<(f64, f64)> {
    let hold = |force: f64| [0.0, 0.1, 0.3, 0.6, 1.0].map(|dt| (dt, force));
    [0.02, 0.06, 0.2, 0.6, 1.5].into_iter().flat_map(hold).collect()
}

struct Experiment {
    grid: Grid,
    rubber: Material,
    steps: Vec<(f64, f64)>,
}

impl Experiment {
    /// Approaches of a tip of these gaps at the end of each step, and where they are asked for their gradients.
    fn curve(&self, gaps: &[f64], gradients: bool) -> viscocontact::Result<(Vec<f64>, Vec<Vec<f64>>)> {
        let [n, _] = self.grid.cells();
        let index = |x: f64| ((x / self.grid.lengths()[0] + 0.5) * n as f64) as usize;
        let tip = FnGeometry::new(|x1, x2| gaps[index(x1).min(n - 1) * n + index(x2).min(n - 1)]);
        let softest = self.rubber.contact_compliance(self.steps.iter().map(|step| step.0).sum());
        let greatest = self.steps.iter().map(|step| step.1).fold(0.0, f64::max);
        let states = Sweep::new(self.grid.clone(), &tip).run(Reach::Level(1.01 * greatest * softest))?;
        let mut contact = StatesContact::new(&states, &self.rubber)?;
        let (mut approaches, mut rows) = (Vec::new(), Vec::new());
        for &(dt, force) in &self.steps {
            contact.step(dt, Load::force(force))?;
            approaches.push(contact.approach());
            if gradients {
                rows.push(contact.approach_gradient()?);
            }
        }
        Ok((approaches, rows))
    }
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let n = if args.quick { 32 } else { args.cells };
    let grid = Grid::square(n, 0.45 * args.radius)?;
    let at = |i: usize| grid.spacing()[0] * (i as f64 + 0.5 - 0.5 * n as f64);
    let radius2 = |k: usize| at(k / n).powi(2) + at(k % n).powi(2);
    let new: Vec<f64> = (0..n * n).map(|k| 0.5 * radius2(k) / args.radius).collect();
    let worn: Vec<f64> =
        (0..n * n).map(|k| new[k] + args.wear * (-0.5 * radius2(k) / args.width.powi(2)).exp()).collect();
    let rubber = Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 0.5)?);
    let experiment = Experiment { grid: grid.clone(), rubber, steps: protocol() };
    let (measured, _) = experiment.curve(&worn, false)?;

    // wear as a sum of bumps over the radius, each as deep as the wear may be
    let (width, half) = (0.75 * args.width, 0.5 * grid.lengths()[0]);
    let bumps = (2.0 * half / width) as usize;
    let bump = |b: usize, k: usize| {
        let distance = radius2(k).sqrt() - 0.5 * width * b as f64;
        args.wear * (-0.5 * (distance / width).powi(2)).exp()
    };
    let shape = |weights: &Mat<f64>| -> Vec<f64> {
        (0..n * n).map(|k| new[k] + (0..bumps).map(|b| weights[(b, 0)] * bump(b, k)).sum::<f64>()).collect()
    };
    let (mut weights, mut curves) = (Mat::zeros(bumps, 1), Vec::new());
    for iteration in 0..=4 {
        let (approaches, rows) = experiment.curve(&shape(&weights), true)?;
        let off = Mat::from_fn(rows.len(), 1, |i, _| measured[i] - approaches[i]);
        println!(
            "after {iteration} steps the curve is off by {:8.2} nm (rms)",
            1e9 * off.norm_l2() / (rows.len() as f64).sqrt()
        );
        curves.push(approaches);
        let of_bump = |i: usize, b: usize| rows[i].iter().enumerate().map(|(k, row)| row * bump(b, k)).sum::<f64>();
        let jacobian = Mat::from_fn(rows.len(), bumps, of_bump);
        let noise = Mat::from_fn(rows.len(), rows.len(), |i, j| if i == j { args.noise * args.noise } else { 0.0 });
        let normal = &jacobian * jacobian.transpose() + noise;
        weights = jacobian.transpose() * normal.partial_piv_lu().solve(off + &jacobian * &weights);
    }
    let found = shape(&weights);
    let wear_at = |gaps: &[f64], k: usize| gaps[k] - new[k];
    let seen: Vec<usize> = (0..n * n).filter(|&k| radius2(k) < (2.0 * args.width).powi(2)).collect();
    let far = seen.iter().map(|&k| (found[k] - worn[k]).abs()).fold(0.0, f64::max);
    println!(
        "within {:.1} mm the heights found are off by at most {:.2} of {:.2} µm",
        2e3 * args.width,
        1e6 * far,
        1e6 * args.wear
    );

    let mut time = 0.0;
    let times: Vec<f64> = experiment.steps.iter().map(|(dt, _)| (time += dt, time).1).collect();
    let mut chart =
        Chart::new("Creep of a tip", Quantity::new("time", "s"), Quantity::new("approach", "m"), Legend::UpperLeft);
    let points = |values: &[f64]| times.iter().copied().zip(values.iter().copied()).collect::<Vec<_>>();
    chart.add("new tip", COLORS[1], Style::Line, points(&curves[0]));
    chart.add("worn tip, measured", COLORS[0], Style::Dots, points(&measured));
    chart.add("shape found", COLORS[2], Style::Line, points(&curves[curves.len() - 1]));
    chart.save(args.output.join("curves.png"))?;
    let mut table = csv::Writer::from_path(args.output.join("heights.csv"))?;
    table.write_record(["x [m]", "wear [m]", "wear found [m]"])?;
    let (mut true_wear, mut found_wear) = (Vec::new(), Vec::new());
    for i in 0..n {
        let k = i * n + n / 2;
        table.serialize((at(i), wear_at(&worn, k), wear_at(&found, k)))?;
        true_wear.push((at(i), wear_at(&worn, k)));
        found_wear.push((at(i), wear_at(&found, k)));
    }
    table.flush()?;
    let mut section =
        Chart::new("Wear along a diameter", Quantity::new("x", "m"), Quantity::new("wear", "m"), Legend::UpperRight);
    section.add("worn tip", COLORS[0], Style::Dots, true_wear);
    section.add("found from the curve", COLORS[2], Style::Line, found_wear);
    section.save(args.output.join("section.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
