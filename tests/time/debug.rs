use crate::common::random_scenes::RandomScene;
use viscocontact::prelude::*;
#[test]
fn debug_scene() {
    let var = |n: &str, d: f64| std::env::var(n).ok().and_then(|s| s.parse().ok()).unwrap_or(d);
    let Ok(list) = std::env::var("SCENES") else { return };
    for number in list.split(',') {
    let (seed, number, tol, level) = (var("SEED", 1.0) as u64, number.parse::<u64>().unwrap(), var("TOL", 1e-3), var("LEVEL", 5.0) as u32);
    let scene = RandomScene::new(seed, number);
    println!("SCENE {} {:?}", scene.name, scene.body.material);
    let by = scene.control.is_approach();
    let mut contact = scene.contact(1e-6);
    let mut run = contact.follow(scene.load(), Stepping::adaptive(tol), scene.body.until).stop_at(&scene.stops).unwrap();
    let mut rows = vec![];
    let mut rejected = 0;
    while let Some(r) = run.next_step().unwrap() {
        rows.push((r, run.rejected_steps() - rejected));
        rejected = run.rejected_steps();
    }
    let mut times: Vec<f64> = rows.iter().map(|r| r.0.time).collect();
    times.extend(scene.graded_times(level));
    let mut contact = scene.contact(1e-9);
    let mut fine = std::collections::BTreeMap::new();
    let mut run = contact.follow(scene.load(), Stepping::fixed(10.0 * scene.body.until), scene.body.until).stop_at(&times).unwrap();
    let mut big = 0.0f64;
    while let Some(r) = run.next_step().unwrap() {
        let a = if by { r.force } else { r.approach };
        big = big.max(a.abs());
        fine.insert(r.time.to_bits(), a);
    }
    for (r, rej) in rows {
        let a = if by { r.force } else { r.approach };
        let f = fine[&r.time.to_bits()];
        println!("t {:.6e} dt {:.3e} rej {rej} est/tol {:.3} cells {} answer {:.5e} err/tol {:.3} load {:?}", r.time, r.dt, r.time_error / tol, r.contact_cells, a / big, (a - f) / big / tol, scene.load().before(r.time));
    }
    }
}
