//! A ball under a constant force on creeping gels of finite thickness, bonded to glass: its indentation over time, and
//! the compliance that formulas read from it: Hertz's, for a half-space, and the series in √(Rδ)/h that are used to
//! correct it (Dimitriadis et al., Biophys. J. 82, 2002; P. D. Garcia and R. Garcia, Biophys. J. 114, 2018).
//!
//! `cargo run --release -p viscocontact --features layers,plot --example gel_indentation`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};
use viscocontact::prelude::*;

/// A ball on gels of finite thickness.
#[derive(Parser)]
struct Args {
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 25.0e-6)]
    radius: f64,
    /// Force [N].
    #[arg(long, default_value_t = 50.0e-9)]
    load: f64,
    /// Thicknesses of the gels [m].
    #[arg(long, value_delimiter = ',', default_values_t = [100.0e-6, 20.0e-6, 8.0e-6])]
    thickness: Vec<f64>,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 128)]
    cells: usize,
    /// Steps in time.
    #[arg(long, default_value_t = 240)]
    steps: u32,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and pictures.
    #[arg(long, default_value = "out/gel_indentation")]
    output: PathBuf,
}

/// 1 + Σ c_n χⁿ: the force over Hertz' force at the same depth, for χ = √(Rδ)/h, bonded and incompressible.
const SERIES: [(&str, [f64; 4]); 3] = [
    ("half-space (Hertz)", [0.0; 4]),
    ("Dimitriadis", [1.133, 1.283, 0.769, 0.0975]),
    ("Garcia", [1.133, 1.497, 1.469, 0.755]),
];

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.cells, args.steps) = (48, 60);
    }
    support::finish(run(&args));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    // shear modulus 2 kPa at once, 400 Pa after some seconds
    let gel = Zener::with_time(2.0e3, 500.0, 2.0)?;
    let material = Material::incompressible(gel);
    let until = 20.0_f64;
    let widest = (0.75 * args.radius * args.load * material.contact_compliance(until)).cbrt();

    let mut depths =
        Chart::new("Indentation of gels on glass by a ball", "time [s]", "indentation [µm]", Legend::UpperLeft);
    let mut errors =
        Chart::new("Error of the compliance that formulas read", "√(Rδ) / h", "relative error", Legend::LowerLeft);
    let mut compliances =
        Chart::new("Compliance read by Hertz's formula", "time [s]", "C(t) [1/kPa]", Legend::UpperLeft);
    (depths.scale, compliances.scale) = (Scale::LogX, Scale::LogX);
    let mut table = csv::Writer::from_path(args.output.join("indentation.csv"))?;
    table.write_record([
        "thickness_m",
        "time_s",
        "indentation_m",
        "contact_radius_m",
        "hertz",
        "dimitriadis",
        "garcia",
    ])?;
    let mut read: [Vec<(f64, f64)>; 3] = Default::default();
    let progress = support::progress(args.thickness.len() as u64 * (u64::from(args.steps) + 1));
    for (n, &thickness) in args.thickness.iter().enumerate() {
        let grid = Grid::square(args.cells, 2.4 * widest)?;
        let kernel = InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(thickness, 0.5)?)?;
        let mut contact = ViscoelasticContact::builder(grid)
            .geometry(&Sphere::new(args.radius)?)
            .material(material.clone())
            .kernel(kernel)
            .build()?;
        let (mut curve, mut apparent) = (Vec::new(), Vec::new());
        for step in 0..=args.steps {
            let (first, decades) = (1.0e-3_f64, (until / 1.0e-3).log10());
            let time =
                if step == 0 { 0.0 } else { first * 10_f64.powf(decades * f64::from(step) / f64::from(args.steps)) };
            let report = contact.step(time - contact.time(), Load::force(args.load))?;
            progress.inc(1);
            let chi = (args.radius * report.approach).sqrt() / thickness;
            // C for which each formula explains force and depth
            let hertz = 4.0 / 3.0 * args.radius.sqrt() * report.approach.powf(1.5) / args.load;
            let found = SERIES.map(|(_, series)| {
                let factor = 1.0 + (1..).zip(series).map(|(power, c)| c * chi.powi(power)).sum::<f64>();
                hertz * factor / material.contact_compliance(time) - 1.0
            });
            let radius = (contact.contact_area() / std::f64::consts::PI).sqrt();
            table.serialize((thickness, time, report.approach, radius, found[0], found[1], found[2]))?;
            if step > 0 {
                curve.push((time, 1e6 * report.approach));
                apparent.push((time, 1e3 * hertz));
            }
            (0..3).for_each(|k| read[k].push((chi, found[k])));
            if step == args.steps {
                progress.suspend(|| println!(
                    "{:.0} µm: indentation {:.2} µm, contact radius {:.2} µm; compliance read with an error of {:+.1} % (Hertz), {:+.1} % (Dimitriadis), {:+.1} % (Garcia)",
                    1e6 * thickness,
                    1e6 * report.approach,
                    1e6 * radius,
                    1e2 * found[0],
                    1e2 * found[1],
                    1e2 * found[2]
                ));
            }
        }
        let (name, color) = (format!("{:.0} µm", 1e6 * thickness), COLORS[n % COLORS.len()]);
        depths.add(name.clone(), color, Style::Line, curve);
        compliances.add(name, color, Style::Line, apparent);
    }
    table.flush()?;
    // the half-space's answer, Lee & Radok
    let half_space = |t: f64| {
        let a = (0.75 * args.radius * args.load * material.contact_compliance(t)).cbrt();
        1e6 * a * a / args.radius
    };
    let times: Vec<f64> =
        (0..60).map(|k| 1.0e-3 * 10_f64.powf((until / 1.0e-3).log10() * f64::from(k) / 59.0)).collect();
    let color = COLORS[args.thickness.len() % COLORS.len()];
    depths.add("half-space (closed form)", color, Style::Dots, times.iter().map(|&t| (t, half_space(t))).collect());
    let true_values = times.iter().map(|&t| (t, 1e3 * material.contact_compliance(t))).collect();
    compliances.add("compliance of the gels", color, Style::Dots, true_values);
    for (k, points) in read.iter_mut().enumerate() {
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        errors.add(SERIES[k].0, COLORS[k], Style::Line, points.clone());
    }
    depths.save(args.output.join("indentation.png"))?;
    compliances.save(args.output.join("compliance.png"))?;
    errors.save(args.output.join("error.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
