//! Contacts, kernels, runs and steady motions.

use std::sync::atomic::AtomicBool;

use viscocontact::ErrorKind::{Cancelled, Convergence, File, Memory, Unsupported, Value};
use viscocontact::contact::{EnergyBalance, StressHistory};
use viscocontact::parallel::Threads;
use viscocontact::prelude::*;

use super::Table;
use crate::common::{Temporary, builder_of, builder_on, elastic, maxwell, sphere, sphere_on, zener};

fn grid() -> Grid {
    Grid::square(16, 4.0e-3).unwrap()
}

fn contact(settings: Settings) -> ViscoelasticContact {
    sphere_on(grid(), maxwell(), settings)
}

fn two() -> ViscoelasticContact {
    let ball = |at: f64| Shifted::new(sphere(), [at, 0.0]).unwrap();
    builder_of(&ball(-1.0e-3), grid(), elastic()).another_body(&ball(1.0e-3)).build().unwrap()
}

fn shared<T: Send>(job: impl Fn(ViscoelasticContact) -> T + Sync) -> T {
    Threads::run(1, |ranks| job(builder_on(grid(), maxwell()).ranks(ranks).build().unwrap())).unwrap().pop().unwrap()
}

pub fn rows(t: &mut Table) {
    let plain = Settings::default();
    let over = plain.with_frame(Frame::Indenter);
    let pressed = || {
        let mut contact = contact(plain);
        contact.step(0.0, Load::force(0.1)).unwrap();
        contact
    };
    for (gap, says) in [
        (f64::NAN, "the initial gap at cell [8, 0], …is NaN: it must be finite, or +inf…"),
        (f64::NEG_INFINITY, "the initial gap at cell [8, 0], …is -inf: it must be finite, or +inf…"),
        (f64::INFINITY, "body 0 is the lowest…on none of the 256 cells…Grid::lengths"),
    ] {
        let shape = FnGeometry::new(move |x1, _| if x1 > 0.0 || gap == f64::INFINITY { gap } else { 0.0 });
        t.row("set_geometry", pressed().set_geometry(&shape), Value, says);
    }
    t.row("set_geometry", two().set_geometry(&sphere()), Value, "geometries of the rigid bodies: 1 given, 2 needed");
    for len in [0, 255, 257] {
        t.row(
            "traction_into",
            pressed().fields().traction_into(&mut vec![0.0; len]),
            Value,
            "traction: … given, 256 needed",
        );
    }
    for (balance, kind, says) in [
        (EnergyBalance::new(&pressed()), Value, "displacement where an energy balance begins = … → 0, before any step"),
        (EnergyBalance::new(&two()), Value, "rigid bodies of an energy balance = 2 → 1"),
        (shared(|contact| EnergyBalance::new(&contact)), Unsupported, "an energy balance is not covered on rows that…"),
        (EnergyBalance::new(&contact(over)), Unsupported, "an energy balance is not covered on a grid that…"),
    ] {
        t.row("EnergyBalance::new", balance, kind, says);
    }
    let of_ranks = shared(|contact| contact.fields().mesh_error());
    t.row(
        "mesh_error",
        of_ranks,
        Unsupported,
        "the error due to the mesh…ranks share out: compute the contact in one…",
    );
    let law = viscocontact::adhesion::ExponentialAttraction::new(0.05, 1.0e-4).unwrap();
    let attracted = builder_on(grid(), maxwell()).attraction(law).build().unwrap();
    t.row(
        "mesh_error",
        attracted.fields().mesh_error(),
        Unsupported,
        "the error…attract each other: compute on a finer mesh…",
    );
    for bins in [0, 1_000_001] {
        t.row(
            "pressure_distribution",
            pressed().fields().pressure_distribution(bins),
            Value,
            "bins = … → in [1, 1000000]",
        );
    }
    // a smooth influence of scattered cells hardly determines the pressure under a rigid punch; here it gives one that is known
    let smooth = InfluenceKernel::from_coefficients(&grid(), |i, j| (-((i * i + j * j) as f64) / 6.0).exp()).unwrap();
    let is_cell = |k: usize| (k * 7 + (k / 16) * 5 + k * k) % 5 < 4;
    let given: Vec<f64> = (0..256).map(|k| if is_cell(k) { 1.0 + ((k * k) % 7) as f64 } else { 0.0 }).collect();
    let mut displacement = vec![0.0; 256];
    smooth.convolve(&given, &mut displacement, &mut smooth.workspace().unwrap()).unwrap();
    let depth = displacement.iter().copied().fold(0.0, f64::max);
    let gap = displacement.iter().zip(&given).map(|(u, p)| if *p > 0.0 { depth - u } else { f64::NAN });
    let cells = HeightMap::new([16; 2], [4.0e-3; 2], gap.map(|gap| -gap).collect()).unwrap().masked();
    let punch = builder_of(&cells, grid(), Material::incompressible(Elastic::new(0.25).unwrap())).kernel(smooth);
    let mut punch = punch.settings(plain.with_tolerance(0.1).with_edge(Edge::Allow)).build().unwrap();
    punch.step(0.0, Load::approach(depth)).unwrap();
    let stiffness = punch.fields().stiffness_over_modulus();
    t.row("stiffness_over_modulus", stiffness, Convergence, "…after 500 iterations…check its influence coefficients");
    let layer = InfluenceKernel::layer(&grid(), Layer::bonded_to_rigid(1.0e-3, 0.5).unwrap()).unwrap();
    let on_layer = builder_on(grid(), maxwell()).kernel(layer).build().unwrap();
    for (history, kind, says) in [
        (
            StressHistory::new(&pressed()),
            Value,
            "pressure where the history of the stress begins = 141259… → 0: begin before…",
        ),
        (StressHistory::new(&contact(over)), Unsupported, "a history of the stress is not…Settings::with_frame"),
        (StressHistory::new(&on_layer), Unsupported, "the stress…(layer of 1e-3 m, …): it must be a half-space, …"),
    ] {
        t.row("StressHistory::new", history, kind, says);
    }
    let below = StressHistory::of_counter_body(&contact(plain));
    t.row("StressHistory::of_counter_body", below, Value, "a contact needs counter_body: call Builder::counter_body…");
    let (flag, free) = (AtomicBool::new(true), AtomicBool::new(false));
    let elastic = || ElasticContact::builder(grid()).geometry(&sphere()).modulus(4.0e6).build().unwrap();
    for (built, says) in [
        (ElasticContact::builder(grid()).modulus(4.0e6).build(), "a contact needs geometry…"),
        (ElasticContact::builder(grid()).geometry(&sphere()).build(), "a contact needs modulus…"),
        (
            ElasticContact::builder(grid()).geometry(&sphere()).modulus(-1.0).build(),
            "contact modulus = -1.0 → finite and > 0",
        ),
        (
            ElasticContact::builder(Grid::square(8, 4.0e-3).unwrap())
                .geometry(&sphere())
                .modulus(1.0)
                .kernel(InfluenceKernel::half_space(&grid()).unwrap())
                .build(),
            "the kernel…16…8…",
        ),
    ] {
        t.row("ElasticBuilder::build", built, Value, says);
    }
    for (solved, kind, says) in [
        (elastic().solve_unless(&flag, Load::force(0.2)), Cancelled, "a step was cancelled by its caller"),
        (elastic().solve(Load::force(10.0)), Value, "…on 60 cells…about 0.0053 m…: enlarge the grid…"),
        (elastic().solve([Load::force(0.1); 2]), Value, "loads of the rigid bodies: 2 given, 1 needed"),
        (elastic().solve(Load::force(-1.0)), Value, "normal force = -1.0 → finite and >= 0"),
    ] {
        t.row("ElasticContact::solve", solved, kind, says);
    }
    for (surface, says) in [
        (vec![0.0; 255], "displacement of the surface: 255 given, 256 needed"),
        (vec![f64::NAN; 256], "displacement of the surface = NaN → finite"),
    ] {
        t.row("ElasticContact::set_surface", elastic().set_surface(&surface), Value, says);
    }
    let step = |flag: &AtomicBool, dt: f64, loads: &[Load]| pressed().step_unless(flag, dt, loads);
    let force = Load::force;
    for (step, kind, says) in [
        (step(&flag, 0.1, &[force(0.2)]), Cancelled, "a step was cancelled by its caller"),
        (step(&free, -0.1, &[force(0.2)]), Value, "time step = -0.1 → finite and >= 0"),
        (step(&free, 0.1, &[force(10.0)]), Value, "at t = 0.1 s…on 60 cells…about 0.0053 m…: enlarge the grid…"),
        (step(&free, 0.1, &[force(0.1); 2]), Value, "loads of the rigid bodies: 2 given, 1 needed"),
    ] {
        t.row("step_unless", step, kind, says);
    }

    let coefficients = |of: &dyn Fn(isize, isize) -> f64| InfluenceKernel::from_coefficients(&grid(), of);
    let huge = Grid::square(1 << 20, 1.0).unwrap();
    let of_middle = |i: isize, j: isize, value: f64| if i == 0 && j == 0 { value } else { 0.0 };
    let slanted = |i: isize, j: isize| (1.0 + 0.1 * (i as f64).signum()) / (1.0 + (i * i + j * j) as f64);
    for (kernel, kind, says) in [
        (
            coefficients(&|i, _| if i == 2 { f64::NAN } else { 1.0 }),
            Value,
            "the influence coefficient [2, 0] is NaN: …",
        ),
        (coefficients(&|i, j| of_middle(i, j, 2.0e100)), Value, "…[0, 0] is 2e100: …at most 1e100 m…"),
        (coefficients(&slanted), Value, "the influence coefficient [-1, 0] is 0.45: …mirror images"),
        (coefficients(&|i, j| of_middle(i, j, -1.0)), Value, "…not positive definite: …check their signs…"),
        (InfluenceKernel::from_coefficients(&huge, |_, _| 1.0), Memory, "a kernel of coefficients needs 43980…"),
    ] {
        t.row("from_coefficients", kernel, kind, says);
    }
    let workspace = InfluenceKernel::half_space(&huge).unwrap().workspace();
    t.row("workspace", workspace, Memory, "the workspace of a kernel needs 35185…bytes…take fewer cells…");
    for (thickness, nu, says) in [
        (0.0, 0.3, "thickness of a layer = 0.0 → finite, > 0 and at most 1e300 m"),
        (f64::NAN, 0.3, "thickness of a layer = NaN → finite, > 0 and at most 1e300 m"),
        (2.0e300, 0.3, "thickness of a layer = 2e300 → finite, > 0 and at most 1e300 m"),
        (1.0, -1.0, "Poisson's ratio of a layer = -1.0 → in (-1, 0.5]"),
        (1.0, 0.51, "Poisson's ratio of a layer = 0.51 → in (-1, 0.5]"),
    ] {
        t.row("Layer::frictionless_on_rigid", Layer::frictionless_on_rigid(thickness, nu), Value, says);
    }

    let path = Temporary::file("clauses");
    let resume = |path: &std::path::Path| contact(plain).resume(path);
    t.row("resume", resume(&path.join("none")), File, "no run can be resumed from …: it cannot be read: …");
    std::fs::write(&path, "no checkpoint").unwrap();
    t.row("resume", resume(&path), File, "…: not a checkpoint: the magic number is missing");
    pressed().save(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    for (change, says) in [
        (8, "…: the checkpoint is of format 118, this version reads format…"),
        (bytes.len() - 3, "…: the checkpoint is damaged or truncated: its checksum is not that of…"),
    ] {
        let mut changed = bytes.clone();
        changed[change] ^= 99;
        std::fs::write(&path, changed).unwrap();
        t.row("resume", resume(&path), File, says);
    }
    std::fs::write(&path, &bytes[..bytes.len() - 9]).unwrap();
    t.row("resume", resume(&path), File, "…: the checkpoint is damaged or truncated:…");
    std::fs::write(&path, &bytes).unwrap();
    let other = sphere_on(grid(), zener(), plain).resume(&path);
    t.row("resume", other, File, "…: the checkpoint is of another scene: its material differs…");
    let of_ranks = shared(|mut contact| contact.resume(&path));
    t.row("resume", of_ranks, File, "…computed region (ranks need the whole grid…: save with Settings::window…");

    let steel = || Material::constant_poisson(Elastic::new(80.0e9).unwrap(), 0.3).unwrap();
    let bulk = Material::elastic_bulk(Zener::with_time(1.0e6, 0.5e6, 0.1).unwrap(), 1.0e9).unwrap();
    let of_bulk = Layer::bonded_to_material(1.0e-3, &bulk, &steel());
    t.row("Layer::bonded_to_material", of_bulk, Unsupported, "a layer or base whose Poisson's ratio changes…");
    let soft = || Material::incompressible(Elastic::new(1.0).unwrap());
    let by_function = || Material::incompressible(FnRheology::new(|t| 1.0e-6 * (1.0 + t.sqrt())));
    for (thickness, layer, base, says) in [
        (0.0, zener(), steel(), "thickness of a layer = 0.0 → finite, > 0 and at most 1e300 m"),
        (1.0e-3, maxwell(), steel(), "fluidity of a layer or its base = 2.5e-7 → 0:… an equilibrium modulus"),
        (1.0e-3, zener(), maxwell(), "fluidity of a layer or its base = 2.5e-7 → 0:… an equilibrium modulus"),
        (1.0e-3, by_function(), steel(), "a layer on a base needs an exponential series…"),
        (1.0e-3, soft(), steel(), "shear modulus of a layer over that of its base = 1.25e-11 → in [1e-6, 1e6]"),
    ] {
        t.row("Layer::bonded_to_material", Layer::bonded_to_material(thickness, &layer, &base), Value, says);
    }
    let on = |kernel: InfluenceKernel, base: Material| {
        builder_on(kernel.grid().clone(), zener()).kernel(kernel).build_sliding_on(base).map(drop)
    };
    let stiff = || Material::constant_poisson(Elastic::new(1.0e9).unwrap(), 0.3).unwrap();
    let made = |thickness: f64| Layer::bonded_to_material(thickness, &zener(), &stiff()).unwrap();
    let loaded = |thickness: f64| InfluenceKernel::layer(&grid(), made(thickness)).unwrap();
    let softer = Material::constant_poisson(Elastic::new(1.0e8).unwrap(), 0.3).unwrap();
    let half_space = InfluenceKernel::half_space(&grid()).unwrap();
    for (kernel, base, kind, says) in [
        (half_space, stiff(), Unsupported, "a base below another body than a layer is not covered…bonded_to_material"),
        (loaded(1.0e-3), softer, Unsupported, "a base of another ratio than the layer's is not covered…"),
        (loaded(1.0e-3), maxwell(), Value, "fluidity of a layer or its base = 2.5e-7 → 0: …"),
        (
            loaded(0.05e-3),
            stiff(),
            Unsupported,
            "the grid is 0.004 m long, 80 times the thickness of a layer on a base…shorten the grid to 0.0032 m…",
        ),
        (loaded(1.0e-3), by_function(), Value, "a layer on a base needs an exponential series…"),
    ] {
        t.row("build_sliding_on", on(kernel, base), kind, says);
    }
}
