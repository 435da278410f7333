//! Histories that load, unload and load again, against formulations of another kind.

use std::f64::consts::PI;

use viscocontact::Result;
use viscocontact::analytic::Hertz;
use viscocontact::plot::Legend;
use viscocontact::prelude::*;
use viscocontact_paper as paper;

use crate::claim::{Checked, Outcome};
use crate::elastic::G;
use crate::noise::uniform;

const RADIUS: f64 = 10.0e-3;

/// A sphere on a body pressed, released, pressed again and released, beside a one-dimensional foundation of the material `known`:
/// rows of approach, central pressure and contact radius.
fn beside_foundation(material: &Material, known: &Material, scene: &'static str, reference: &'static str) -> Outcome {
    let (corners, dt) = ([(0.0, 0.0), (1.0, 1.0), (1.6, 0.2), (2.4, 0.8), (2.8, 0.3)], 0.02);
    let history = PiecewiseLinear::new(&corners.iter().map(|&(t, force)| (t, Load::force(force))).collect::<Vec<_>>())?;
    let until = corners[corners.len() - 1].0;
    let greatest = corners.iter().map(|&(_, force)| force).fold(0.0, f64::max);
    let widest = (0.75 * RADIUS * greatest * known.contact_compliance(until)).cbrt();
    let mut contact = ViscoelasticContact::builder(Grid::square(128, 2.1 * widest)?)
        .geometry(&Sphere::new(RADIUS)?)
        .material(material.clone())
        .build()?;
    let mut run = contact.follow(&history, Stepping::fixed(dt), until);
    while run.next_step()?.is_some() {}
    let mut foundation = StatesContact::new(&ElasticStates::sphere(RADIUS)?, known)?;
    for pair in corners.windows(2) {
        let [(start, from), (end, to)] = [pair[0], pair[1]];
        let steps = (10.0 * (end - start) / dt).round();
        for k in 1..=steps as usize {
            foundation.step((end - start) / steps, Load::force(from + (to - from) * k as f64 / steps))?;
        }
    }
    let [n1, n2] = contact.grid().cells();
    let [x1, x2] = contact.grid().center(n1 / 2, n2 / 2);
    let central = contact.pressure()[n1 / 2 * n2 + n2 / 2];
    let pressure = |level| Hertz::new(RADIUS, 1.0, level).map_or(f64::NAN, |hertz| hertz.pressure(x1.hypot(x2)));
    let rows = [
        ("approach", contact.approach(), foundation.approach(), 1e-3),
        ("central pressure", central, foundation.superposed(pressure), 2e-3),
        ("contact radius", (contact.contact_area() / PI).sqrt(), (foundation.contact_area() / PI).sqrt(), 3e-3),
    ];
    Ok(Checked::new(scene, reference, &rows))
}

/// Five relaxation times over four decades.
pub fn many_times() -> Outcome {
    let terms = [(2.0, 0.01), (1.0, 0.1), (1.0, 0.5), (1.0, 3.0), (0.5, 100.0)].map(|(g, tau)| (g * G, tau));
    let material = Material::incompressible(GeneralizedMaxwell::new(0.5 * G, &terms)?);
    beside_foundation(
        &material,
        &material,
        "sphere on a body of five relaxation times, up and down twice, 128² cells",
        "method of dimensionality reduction (Popov & Heß)",
    )
}

/// A table of creep without noise, twelve values per decade; the foundation has the law that the table was made from.
pub fn measured() -> Outcome {
    let law = FractionalZener::new(10.0 * G, 0.5 * G, 1.0, 0.5)?;
    let times: Vec<f64> = (0..=72).map(|k| 10_f64.powf(-4.0 + f64::from(k) / 12.0)).collect();
    let rows: Vec<(f64, f64)> = times.iter().map(|&t| (t, law.creep_compliance(t))).collect();
    let table = Material::incompressible(Measurements::creep(&rows)?.fit()?);
    let known = Material::incompressible(law.series(1e-6..=1e2, 1e-6)?);
    beside_foundation(
        &table,
        &known,
        "sphere on a table of measured creep, up and down twice, 128² cells",
        "method of dimensionality reduction, the law behind the table",
    )
}

/// A cone of slope m pressed at a constant velocity into a body of modulus E(t) = E₁ t^(−β) up to the time 1, and withdrawn as fast.
///
/// While the contact grows its radius is 2δ/πm. While it shrinks, the radius is that of the time T on the way in for which
/// ∫ E(t − s) dδ(s) = 0 over T < s < t, and the force is (4/πm) ∫ E(t − s) δ dδ(s) over s < T (Ting 1966). For this E and δ:
/// (t − T)^(1−β) = 2 (t − 1)^(1−β), so that T = t − c (t − 1), c = 2^(1/(1−β)), and
/// F(t)/F(1) = t^(2−β) − 2 (t − 1)^(1−β) [(1 − β) T + t].
pub fn cone() -> Outcome {
    let (beta, slope, velocity) = (0.3, 0.05, 1.0e-5);
    let material = Material::incompressible(PowerLaw::new(1.0 / G, 1.0, beta)?);
    let radius = |t: f64| 2.0 * velocity * t / (PI * slope);
    let (turn, end, steps) = (1.0, 1.25, 100.0);
    let corners = [(0.0, 0.0), (turn, turn), (end, 2.0 * turn - end)];
    let history = PiecewiseLinear::new(&corners.map(|(t, way)| (t, Load::approach(velocity * way))))?;
    let mut contact = ViscoelasticContact::builder(Grid::square(128, 2.1 * radius(turn))?)
        .geometry(&Cone::new(slope)?)
        .material(material.clone())
        .settings(Settings::default().with_series_tolerance(1e-6))
        .times(1.0e-5..=end)
        .build()?;
    let mut run = contact.follow(&history, Stepping::fixed(turn / steps), end);
    let (mut curve, mut greatest) = (Vec::new(), 0.0);
    while let Some(report) = run.next_step()? {
        if report.time <= turn * (1.0 + 1e-9) {
            greatest = report.force;
        }
        curve.push((1e6 * report.approach, 1e3 * report.force));
    }
    // E₁ = 1/(C₁ Γ(1 + β) Γ(1 − β)), and Γ(1 + β) Γ(1 − β) = πβ/sin πβ
    let modulus = (PI * beta).sin() / (PI * beta) / material.contact_compliance(1.0);
    let exact_greatest = 4.0 * modulus * velocity.powi(2) / (PI * slope * (1.0 - beta) * (2.0 - beta));
    let withdrawn = |t: f64| t - 2_f64.powf(1.0 / (1.0 - beta)) * (t - 1.0);
    let share = |t: f64| t.powf(2.0 - beta) - 2.0 * (t - 1.0).powf(1.0 - beta) * ((1.0 - beta) * withdrawn(t) + t);
    let rows = [
        ("force at the maximum depth", greatest, exact_greatest, 1e-3),
        ("force on the way out over that", contact.force() / greatest, share(end), 1e-3),
        ("contact radius on the way out", (contact.contact_area() / PI).sqrt(), radius(withdrawn(end)), 4e-3),
    ];
    let line = (0..=500).map(|k| {
        let t = end * f64::from(k) / 500.0;
        let (way, share) = if t <= turn { (t, t.powf(2.0 - beta)) } else { (2.0 * turn - t, share(t)) };
        (1e6 * velocity * way, 1e3 * exact_greatest * share)
    });
    Ok(Checked::new("cone on a power law t^0.3, in and out, 128² cells", "Ting 1966, derived below", &rows).drawn(
        ["approach [µm]", "force [mN]"],
        Legend::UpperLeft,
        line.collect(),
        curve,
    ))
}

/// Three retardation times, and forces that rise and fall at random, down to nothing too.
pub fn direct_sums() -> Outcome {
    let body = GeneralizedKelvin::new(1.0 / G, 0.0, &[(0.6 / G, 0.05), (0.5 / G, 0.4), (0.4 / G, 3.0)])?;
    let material = Material::incompressible(body);
    let relaxation = material.contact_spectrum()?.ok_or("the body has a series")?.relaxation();
    let widest = (0.75 * RADIUS * material.contact_compliance(1e3)).cbrt();
    let grid = Grid::square(64, 2.1 * widest)?;
    let sphere = |time_rule: TimeRule, tolerance: f64| {
        ViscoelasticContact::builder(grid.clone())
            .geometry(&Sphere::new(RADIUS)?)
            .material(material.clone())
            .settings(Settings::default().with_time_rule(time_rule).with_tolerance(tolerance))
            .build()
    };

    // u is linear within each step: v(t) = Σ (u_k − u_(k−1))/Δ_k ∫ E(t − s) ds over all steps, from the u of the recursion
    let mut random = uniform(20);
    let mut contact = sphere(TimeRule::ExponentialLinear, 1e-10)?;
    let middle = grid.len() / 2 + grid.cells()[1] / 2;
    let mut past = vec![(0.0, 0.0)];
    for k in 0..60 {
        let dt = 10_f64.powf(-3.0 + 3.0 * random());
        // every sixth step lets go, the last one does not
        let force = if k % 6 == 3 { 0.0 } else { random() };
        contact.step(dt, Load::force(force))?;
        past.push((contact.time(), contact.fields().displacement()[middle]));
    }
    let mut potential = vec![0.0; grid.len()];
    contact.fields().kernel().convolve(
        contact.pressure(),
        &mut potential,
        &mut contact.fields().kernel().workspace()?,
    )?;
    let now = contact.time();
    let summed: f64 = past
        .windows(2)
        .map(|pair| {
            let [(start, before), (end, after)] = [pair[0], pair[1]];
            let relaxing = |&(modulus, tau): &(f64, f64)| {
                modulus * tau / (end - start) * (((end - now) / tau).exp() - ((start - now) / tau).exp())
            };
            (after - before) * (relaxation.equilibrium() + relaxation.terms().iter().map(relaxing).sum::<f64>())
        })
        .sum();

    // the default rule beside the source paper's own algorithm, whose error falls as the step
    let corners: Vec<_> = (0..=10).map(|k| (0.2 * f64::from(k), if k % 4 == 0 { 0.0 } else { random() })).collect();
    let history = PiecewiseLinear::new(&corners.iter().map(|&(t, force)| (t, Load::force(force))).collect::<Vec<_>>())?;
    let mut contact = sphere(TimeRule::Exponential, 1e-8)?;
    let mut run = contact.follow(&history, Stepping::fixed(0.005), 1.9);
    while run.next_step()?.is_some() {}
    let literally = |steps: u32| -> Result<[f64; 2]> {
        let grid = paper::Grid { cells: 64, side: grid.spacing()[0] };
        let square = |k: usize| grid.center(k).map(|x| x * x).iter().sum::<f64>();
        let gap = (0..grid.len()).map(|k| square(k) / (2.0 * RADIUS)).collect();
        let creep = |t: f64| material.contact_compliance(t);
        let mut contact = paper::History::new(paper::Influence::new(grid), &creep, gap, 1e-9);
        for step in 1..=steps {
            let time = 1.9 * f64::from(step) / f64::from(steps);
            let Load::Force { normal, .. } = history.at(time) else { unreachable!("all are forces") };
            assert!(
                contact.step(time, paper::Load { force: normal, at: None }),
                "the paper's solver does not converge"
            );
        }
        Ok([contact.state.approach, contact.state.pressure.iter().copied().fold(0.0, f64::max)])
    };
    let [coarse, fine] = [literally(95)?, literally(190)?];
    let (own, limit) =
        ([contact.approach(), contact.fields().max_pressure()], |which: usize| 2.0 * fine[which] - coarse[which]);
    let rows = [
        ("K p in the middle, after any steps", potential[middle], summed, 1e-8),
        ("approach", own[0], limit(0), 1e-4),
        ("maximum pressure", own[1], limit(1), 1e-3),
    ];
    Ok(Checked::new(
        "sphere on a body of three retardation times, forces at random, 64² cells",
        "direct sums over all past steps",
        &rows,
    ))
}
