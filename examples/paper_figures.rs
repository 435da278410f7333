//! Figures 2 to 6 of the source paper, S. Spinu, *The surface contact of viscoelastic materials, Part I*, drawn to be laid
//! beside it, with a table of how exact they are; fails if one is less exact than it should be.
//!
//! `cargo run --release -p viscocontact --features analytic,plot,study --example paper_figures` (15 s), or with `-- --quick` (seconds, coarser)

#[path = "support/scenes/paper_figures.rs"]
mod scenes;
#[path = "support/scenes/step_loaded_sphere.rs"]
mod step_loaded_sphere;
mod support;

use std::error::Error;
use std::f64::consts::PI;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use scenes::{
    CLOSED, FEW_STEPS, FORCE, FewSteps, Merit, OPEN, RADIUS, STEP_COUNTS, TimeStudy, figure_2, figure_3, figure_6,
    figures_4_and_5, figures_in_few_steps, lure, pressed_punch,
};
use step_loaded_sphere::StepLoadedSphere;
use viscocontact::Result;
use viscocontact::analytic::{GrowingSphere, Hertz};
use viscocontact::plot::{COLORS, Chart, Legend, Picture, Style};
use viscocontact::prelude::*;

/// Draws Figures 2 to 6 of the source paper.
#[derive(Parser)]
struct Args {
    /// 64² cells in place of 256²: what needs the cells is then reported, and not required.
    #[arg(long)]
    quick: bool,
    /// Folder for the pictures.
    #[arg(long, default_value = "out/paper_figures")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

/// Pictures, each with the end of its name, and figures of merit.
type Drawn = Result<(Vec<(&'static str, Picture)>, Vec<Merit>), Box<dyn Error>>;

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let cells = if args.quick { 64 } else { 256 };
    let progress = support::progress(5);
    let mut merits = Vec::new();
    let few = figures_in_few_steps(cells)?;
    for figure in 2..=6 {
        let (mut pictures, own) = match figure {
            2 => eccentric_punch(cells),
            3 => opening(cells),
            6 => steps_in_time(cells),
            _ => pressure_history(figure, cells),
        }?;
        if figure == 4 || figure == 5 {
            let few: Vec<&FewSteps> = few.iter().filter(|few| few.figure == figure).collect();
            pictures.push(("_few_steps", few_steps(&few, cells)?));
        }
        for (end, picture) in pictures {
            picture.save(args.output.join(format!("paper_fig{figure}{end}.png")))?;
        }
        merits.extend(own);
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!("| Figure | quantity | of | value | range |\n|---|---|---|---|---|");
    for Merit { figure, quantity, of, value, range: [low, high] } in &merits {
        let of = match figure {
            2 | 3 => format!("e = {of} R"),
            _ => format!("t = {of} τ"),
        };
        println!("| {figure} | {quantity} | {of} | {value:.2e} | {low} … {high} |");
    }
    println!("\nError in time of the profiles (L1) and convolutions, in few steps to 2 τ");
    println!("| figure | steps | steps alone | fields to 1e-2 | fields to 1e-3 |\n|---|---|---|---|---|");
    for FewSteps { figure, steps, errors, convolutions, .. } in &few {
        let columns = errors.iter().zip(convolutions).map(|(error, work)| format!(" {error:.1e}, {work} |"));
        println!("| {figure} | {steps} |{}", columns.collect::<String>());
    }
    println!("\nFigure 6 as a study of mesh and time");
    figure_6_as_a_study(args)?;
    println!("{cells}² cells; pictures are in {}", args.output.display());
    let failed = merits.iter().filter(|merit| !merit.holds()).count();
    if failed == 0 || args.quick { Ok(()) } else { Err(format!("{failed} figures of merit are out of range").into()) }
}

/// Pressure along x1 next to the axis: distance over `length`, pressure over `unit`.
fn along_x1(grid: &Grid, pressure: &[f64], [length, unit]: [f64; 2]) -> Vec<(f64, f64)> {
    let [n1, n2] = grid.cells();
    (0..n1).map(|i| (grid.center(i, 0)[0] / length, pressure[i * n2 + n2 / 2] / unit)).collect()
}

/// So many numbers between two.
fn between(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (0..=400).map(move |k| low + (high - low) * f64::from(k) / 400.0)
}

/// Every so many of the points, so that dots do not merge.
fn thinned(points: impl ExactSizeIterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let every = points.len().div_ceil(56);
    points.skip(every / 2).step_by(every).collect()
}

/// Figure 2.
fn eccentric_punch(cells: usize) -> Drawn {
    let title = "Figure 2: rigid flat punch under an eccentric force, elastic body";
    let mut chart = Chart::new(title, "x1 / R", "p / mean pressure", Legend::UpperMiddle);
    let mean = FORCE / (PI * RADIUS * RADIUS);
    let mut merits = Vec::new();
    for (e, color) in CLOSED.into_iter().zip(COLORS) {
        let (exact, contact) = (lure(e)?, pressed_punch(cells, e)?);
        merits.push(figure_2(&contact, e)?);
        let curve = between(-0.98, 0.98).map(|x| (x, exact.pressure(x * RADIUS, 0.0) / mean)).collect();
        chart.add(format!("e = {e} R, closed form (Lur'e)"), color, Style::Line, curve);
        let dots = thinned(along_x1(contact.grid(), contact.pressure(), [RADIUS, mean]).into_iter());
        let dots = dots.into_iter().filter(|(x, _)| x.abs() < 0.98).collect();
        chart.add(if e == 0.0 { "computed (dots)" } else { "" }, color, Style::Dots, dots);
    }
    Ok((vec![("", chart.draw()?)], merits))
}

/// Figure 3: pressures of the open contact, and its area and the tilt over the eccentricity.
fn opening(cells: usize) -> Drawn {
    let title = "Figure 3: the contact opens under a larger eccentricity";
    let mut profiles = Chart::new(title, "x1 / R", "p / mean pressure", Legend::UpperLeft);
    let mean = FORCE / (PI * RADIUS * RADIUS);
    let face = pressed_punch(cells, 0.0)?.contact_area();
    let (mut area, mut tilt, mut finer_area, mut finer_tilt) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    // by Lur'e the tilt is e / R of these
    let unit = lure(0.3)?.tilt / 0.3;
    let mut merits = Vec::new();
    for step in 0..=16 {
        let e = f64::from(step) / 20.0;
        let contact = pressed_punch(cells, e)?;
        area.push((e, contact.contact_area() / face));
        tilt.push((e, contact.tilt()[0] / unit));
        if let Some(which) = OPEN.iter().position(|&open| (open - e).abs() < 1e-9) {
            let finer = pressed_punch(2 * cells, e)?;
            merits.extend(figure_3([&contact, &finer], e));
            finer_area.push((e, finer.contact_area() / face));
            finer_tilt.push((e, finer.tilt()[0] / unit));
            let line = along_x1(contact.grid(), contact.pressure(), [RADIUS, mean]);
            // the rim is singular
            let line = line.into_iter().filter(|(x, _)| *x < 0.98).collect();
            profiles.add(format!("e = {e} R"), COLORS[which], Style::Line, line);
        }
    }
    let names = [format!("{cells}² cells"), format!("{}² cells", 2 * cells)];
    let mut areas = Chart::new(
        "Figure 3: contact area over the eccentricity",
        "e / R",
        "area / area of the face",
        Legend::LowerLeft,
    );
    let mut tilts =
        Chart::new("Figure 3: tilt over the eccentricity", "e / R", "tilt R² E* / (3W / 4)", Legend::UpperLeft);
    tilts.add("closed form (Lur'e), e < R/3", COLORS[2], Style::Line, vec![(0.0, 0.0), (1.0 / 3.0, 1.0 / 3.0)]);
    for (chart, curve, finer) in [(&mut areas, area, finer_area), (&mut tilts, tilt, finer_tilt)] {
        chart.add(&names[0], COLORS[0], Style::Dots, curve);
        chart.add(&names[1], COLORS[1], Style::Dots, finer);
    }
    Ok((vec![("", profiles.draw()?), ("_area", areas.draw()?), ("_tilt", tilts.draw()?)], merits))
}

/// The radius of contact a_H and the greatest pressure p_H when the load has just been applied: the paper's units.
fn hertz(scene: &StepLoadedSphere) -> Result<[f64; 2]> {
    let hertz = Hertz::new(scene.radius, 1.0 / scene.material.contact_compliance(0.0), scene.force)?;
    Ok([hertz.contact_radius, hertz.max_pressure])
}

/// The exact pressure at a time in the paper's units, dense near the rim, where it falls like a root.
fn exact_profile(exact: &GrowingSphere, time: f64, [length, unit]: [f64; 2]) -> Vec<(f64, f64)> {
    let edge = exact.contact_radius(time);
    let radii = between(0.0, 1.0).map(|x| edge * (1.0 - (1.0 - x).powi(2)));
    radii.map(|r| (r / length, exact.pressure(r, time) / unit)).collect()
}

/// Figures 4 and 5.
fn pressure_history(figure: u32, cells: usize) -> Drawn {
    let (mut dots, mut merits) = (Vec::new(), Vec::new());
    let scene = figures_4_and_5(figure, cells, |contact, merit| {
        dots.push(along_x1(contact.grid(), contact.pressure(), [1.0, 1.0]));
        merits.push(merit);
    })?;
    let (units, exact) = (hertz(&scene)?, scene.reference()?);
    let title = format!("Figure {figure}: sphere under a step of the force, {} body", scene.name);
    let mut chart = Chart::new(title, "r / a_H", "p / p_H", Legend::UpperRight);
    for ((dots, merit), color) in dots.into_iter().zip(&merits).zip(COLORS) {
        let line = exact_profile(&exact, merit.of * scene.tau, units);
        chart.add(format!("t = {} τ, closed form", merit.of), color, Style::Line, line);
        let half = dots.into_iter().filter(|&(x, p)| x > 0.0 && p > 0.0).collect::<Vec<_>>();
        let dots = thinned(half.into_iter().map(|(x, p)| (x / units[0], p / units[1])));
        chart.add(if merit.of == 0.0 { "computed (dots)" } else { "" }, color, Style::Dots, dots);
    }
    Ok((vec![("", chart.draw()?)], merits))
}

/// Figure 6: profiles at 2τ for several numbers of steps, by the paper's rule and by the default one.
fn steps_in_time(cells: usize) -> Drawn {
    let scene = StepLoadedSphere::maxwell();
    let (units, exact) = (hertz(&scene)?, scene.reference()?);
    let studies = figure_6(cells)?;
    println!("Figure 6, errors in time at t = 2 τ, of the whole pressure (L1) and in the middle");
    println!("| steps | paper's rule, L1 | p(0) | default rule, L1 | p(0) |\n|---|---|---|---|---|");
    for (which, steps) in STEP_COUNTS.iter().enumerate() {
        let columns = studies.iter().map(|study| match study.errors.get(which) {
            Some([l1, middle]) => format!(" {l1:.1e} | {middle:.1e} |"),
            None => " – | – |".to_owned(),
        });
        println!("| {steps} |{}", columns.collect::<String>());
    }
    let panel = |study: &TimeStudy, name: &str| -> Result<Picture> {
        let title = format!("Figure 6: Maxwell body, t = 2 τ, {name}");
        let grid = scene.grid(study.cells)?;
        let mut chart = Chart::new(title, "r / a_H", "p / p_H", Legend::LowerLeft);
        let runs = study.pressures.iter().zip(STEP_COUNTS).zip(&study.errors).zip(COLORS);
        for (((pressure, steps), [error, _]), color) in runs {
            let half = along_x1(&grid, pressure, units).into_iter().filter(|&(x, p)| x > 0.0 && p > 0.0);
            chart.add(format!("{steps} steps, error {error:.1e}"), color, Style::Line, half.collect());
        }
        let time = 2.0 * scene.tau;
        let radii = (0..36).map(|k| 0.04 * f64::from(k)).chain([exact.contact_radius(time) / units[0]]);
        let exact = radii.map(|r| (r, exact.pressure(r * units[0], time) / units[1]));
        chart.add("closed form (dots)", COLORS[6], Style::Dots, exact.collect());
        chart.draw()
    };
    let pictures =
        vec![("", panel(&studies[0], "the paper's rule")?), ("_default", panel(&studies[1], "the default rule")?)];
    Ok((pictures, studies.iter().flat_map(TimeStudy::orders).collect()))
}

/// The scene of Figure 6, and the profile at 2τ: domain, mesh and steps for 1e-2 of it, measured. Writes the table as CSV, and the picture.
fn figure_6_as_a_study(args: &Args) -> Result<(), Box<dyn Error>> {
    let sphere = StepLoadedSphere::maxwell();
    let (shape, material) = (Sphere::new(sphere.radius)?, sphere.material.clone());
    let (load, until) = (StepLoad::new(Load::force(sphere.force))?, 2.0 * sphere.tau);
    let scene = |grid: Grid, settings: Settings| {
        Ok(ViscoelasticContact::builder(grid).geometry(&shape).material(material.clone()).settings(settings))
    };
    let accuracy = if args.quick { 5e-2 } else { 1e-2 };
    let study = Study::new(scene, &load, until).accuracy(accuracy).ask(Observable::MaxPressure);
    let study = study.fields_at(&[until]).run()?;
    println!("{study}");
    study.write_csv(args.output.join("study.csv"))?;
    study.chart().save(args.output.join("study.png"))?;
    Ok(())
}

/// The profile at 2τ in few steps, and in the fewest with the field asked for, on Table 1.
fn few_steps(few: &[&FewSteps], cells: usize) -> Result<Picture> {
    let scene = if few[0].figure == 5 { StepLoadedSphere::zener() } else { StepLoadedSphere::maxwell() };
    let (units, exact, grid) = (hertz(&scene)?, scene.reference()?, scene.grid(cells)?);
    let title = format!("Figure {}: t = 2 τ in few steps", few[0].figure);
    let mut chart = Chart::new(title, "r / a_H", "p / p_H", Legend::LowerLeft);
    let half = |pressure: &[f64]| -> Vec<(f64, f64)> {
        along_x1(&grid, pressure, units).into_iter().filter(|&(x, p)| x > 0.0 && p > 0.0).collect()
    };
    let asked = few[0].pressures.iter().zip(&few[0].errors).next_back();
    let asked =
        asked.map(|(pressure, error)| (format!("{} steps, field to 1e-3: error {error:.1e}", FEW_STEPS[0]), pressure));
    let alone =
        few[..3].iter().map(|few| (format!("{} steps: error {:.1e}", few.steps, few.errors[0]), &few.pressures[0]));
    for ((name, pressure), color) in alone.chain(asked).zip(COLORS) {
        chart.add(name, color, Style::Line, half(pressure));
    }
    let dots = thinned(exact_profile(&exact, 2.0 * scene.tau, units).into_iter());
    chart.add("closed form (dots)", COLORS[6], Style::Dots, dots);
    chart.draw()
}
