//! Runs that go on from a file as if nothing had happened; files that are refused; fifty runs that were killed.

mod ranks;
mod scenes;

use crate::common::{Temporary, builder_of, builder_on, power_law, sphere, sphere_on, three_times, uniform};
use approx::assert_abs_diff_eq;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use crate::common::runs::{scenes, wandering};
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};

/// Every scene, saved after each of several numbers of steps, none included: from the file or its bytes, and from a snapshot in its own
/// memory or by a clone, the steps after it are the same to the last bit.
#[test]
fn every_scene_continues_from_its_file_and_its_snapshot_bit_by_bit() {
    for (name, build, step) in scenes() {
        let (path, mut snapshot) = (Temporary::file("continuation"), build().snapshot());
        for steps in [0, 1, 2, 9, 70] {
            let mut contact = build();
            (0..steps).for_each(|k| _ = step(&mut contact, k));
            contact.save(&path).unwrap();
            let bytes = contact.to_bytes().unwrap();
            assert!(fs::read(&path).unwrap() == bytes, "{name}, bytes after {steps}");
            contact.snapshot_into(&mut snapshot);
            let (mut resumed, mut clone) = (build(), contact.clone());
            assert!(resumed.restore(&snapshot).is_err_and(|error| error.code() == "other_contact"));
            let again = if steps == 9 { resumed.resume_bytes(&bytes) } else { resumed.resume(&path) };
            again.unwrap();
            assert!(build().resume_bytes(&bytes[..bytes.len() / 2]).is_err());
            assert_eq!((contact.time(), contact.fields().load()), (resumed.time(), resumed.fields().load()));
            assert_eq!(
                (contact.pressure(), contact.fields().displacement()),
                (resumed.pressure(), resumed.fields().displacement())
            );
            assert_eq!((contact.approach(), contact.tilt()), (resumed.approach(), resumed.tilt()));
            let ahead = |contact: &mut ViscoelasticContact| {
                let reports: Vec<_> = (steps..steps + 8).map(|k| step(contact, k)).collect();
                (reports, contact.pressure().to_vec(), contact.fields().displacement().to_vec())
            };
            let exact = ahead(&mut contact);
            assert!(ahead(&mut resumed) == exact, "{name}, saved after {steps}");
            // a state ahead, and one behind
            for restored in [&mut contact, &mut clone] {
                for _ in 0..2 {
                    restored.restore(&snapshot).unwrap();
                    assert!(ahead(restored) == exact, "{name}, restored after {steps}");
                }
            }
        }
    }
}

fn refused(contact: &mut ViscoelasticContact, path: &Path) -> Error {
    let error = contact.resume(path).unwrap_err();
    assert!(matches!(error, Error::Checkpoint { .. }), "{error}");
    error
}

/// What a scene of another rule differs in.
const RULES: &str = "time rule, frame, symmetry or window";

#[test]
fn other_scenes_are_refused_by_what_differs() {
    let path = Temporary::file("scene");
    let grid = || Grid::square(16, 4.0e-3).unwrap();
    let mut contact = sphere_on(grid(), three_times(), Settings::default());
    wandering(&mut contact, 1);
    contact.save(&path).unwrap();
    let what = |mut other: ViscoelasticContact| {
        let error = refused(&mut other, &path);
        assert_eq!(error.code(), "checkpoint_other_scene", "{error}");
        error.name().unwrap().to_owned()
    };
    let settings = Settings::default();
    for (grid, settings, differs) in [
        (Grid::square(16, 4.1e-3).unwrap(), settings, "grid"),
        (grid(), settings.with_window(false), RULES),
        (grid(), settings.with_series_tolerance(1e-3), "series tolerance"),
        (grid(), settings.with_time_rule(TimeRule::ExponentialLinear), RULES),
    ] {
        assert_eq!(what(sphere_on(grid, three_times(), settings)), differs);
    }
    let layer = |thickness: f64| {
        let layer = Layer::bonded_to_rigid(thickness, 0.5).unwrap();
        let kernel = InfluenceKernel::layer(&grid(), layer).unwrap();
        builder_on(grid(), three_times()).kernel(kernel).build().unwrap()
    };
    let warming = |rate: f64| {
        let law = TimeTemperature::wlf(10.0, 60.0, 300.0).unwrap();
        let temperature = TemperatureHistory::function(law, move |t| 290.0 + rate * t, &[0.5]).unwrap();
        let mut contact = builder_on(grid(), three_times()).temperature(temperature).build().unwrap();
        wandering(&mut contact, 1);
        contact
    };
    let aside = Shifted::new(sphere(), [1.0e-4, 0.0]).unwrap();
    let periodic = Arc::new(InfluenceKernel::periodic(&grid()).unwrap());
    for (builder, differs) in [
        (builder_on(grid(), power_law()).times(1e-3..=1e3), "material"),
        (builder_on(grid(), three_times()).kernel(periodic), "kernel"),
        (builder_of(&Cone::new(0.1).unwrap(), grid(), three_times()), "geometry"),
        (builder_of(&aside, grid(), three_times()), "geometry"),
    ] {
        assert_eq!(what(builder.build().unwrap()), differs);
    }
    assert_eq!([what(layer(1.0e-3)), what(warming(20.0))], ["kernel", "temperature"]);
    let own = |scale: f64| {
        let kernel = InfluenceKernel::from_spectrum(&grid(), move |_, _| scale).unwrap();
        builder_on(grid(), three_times()).kernel(kernel).build().unwrap()
    };
    // the same on the diagonal is not the same
    let layered = |reach: f64| {
        let coefficient = move |i: isize, j: isize| match i * i + j * j {
            0 => 1.0e-4,
            square => 0.3e-4 / (square as f64).sqrt() * (-(square as f64).sqrt() / reach).exp(),
        };
        let kernel = Arc::new(InfluenceKernel::from_coefficients(&grid(), coefficient).unwrap());
        builder_on(grid(), three_times()).kernel(kernel).build().unwrap()
    };
    let closure = |power: f64| {
        let creep = move |t: f64| 1.0e-6 * (1.0 + t.max(0.0).powf(power));
        builder_on(grid(), Material::incompressible(FnRheology::new(creep))).times(1e-3..=1e3).build().unwrap()
    };
    type Scene<'a> = &'a dyn Fn(f64) -> ViscoelasticContact;
    let attracted = |range: f64| {
        let law = ExponentialAttraction::new(1.0, range).unwrap();
        builder_on(grid(), three_times()).attraction(law).build().unwrap()
    };
    let fitted = |until: f64| builder_on(grid(), power_law()).times(1e-3..=until).build().unwrap();
    let scenes: [(Scene, [f64; 2], &str); 7] = [
        (&fitted, [1e5, 1e4], "material"),
        (&attracted, [4.0e-5, 4.1e-5], "attraction"),
        (&own, [1.0e-4, 2.0e-4], "kernel"),
        (&layered, [3.0, 1.0], "kernel"),
        (&closure, [0.3, 0.301], "material"),
        (&layer, [1.0e-3, 1.1e-3], "kernel"),
        (&warming, [20.0, 21.0], "temperature"),
    ];
    for (scene, [one, other], differs) in scenes {
        scene(one).save(&path).unwrap();
        scene(one).resume(&path).unwrap();
        assert_eq!(what(scene(other)), differs);
    }
}

/// Settings of the solver may differ: a run that did not converge resumes with more iterations.
#[test]
fn other_ways_to_solve_are_taken() {
    let path = Temporary::file("solve");
    let mut contact = sphere_on(Grid::square(16, 4.0e-3).unwrap(), three_times(), Settings::default());
    wandering(&mut contact, 1);
    contact.save(&path).unwrap();
    for settings in [
        Settings::default().with_tolerance(1e-9).with_max_iterations(5000),
        Settings::default().with_edge(Edge::Allow).with_time_rule(TimeRule::Exponential),
    ] {
        let mut other = sphere_on(Grid::square(16, 4.0e-3).unwrap(), three_times(), settings);
        other.resume(&path).unwrap();
        let (one, two) = (wandering(&mut contact.clone(), 2), wandering(&mut other, 2));
        assert_abs_diff_eq!(one.approach, two.approach, epsilon = 1e-5 * two.approach);
    }
}

/// A step whose file cannot be written is reported by the call that writes it.
#[test]
fn a_step_whose_file_fails_is_reported() {
    let folder = Temporary::file("medium");
    let mut contact = sphere_on(Grid::square(16, 4.0e-3).unwrap(), three_times(), Settings::default());
    let load = StepLoad::new(Load::force(0.1)).unwrap();
    let mut run = contact.follow(&load, Stepping::fixed(0.1), 0.2).autosave_to(folder.join("run"), Duration::ZERO);
    let mut times = Vec::new();
    loop {
        match run.next_step() {
            Ok(Some(report)) => times.push(report.time),
            Ok(None) => break,
            Err(error) => {
                assert!(matches!(error, Error::Output(_)), "{error}");
                fs::create_dir_all(&folder).unwrap();
                continue;
            }
        }
        fs::remove_dir_all(&folder).unwrap();
    }
    assert_eq!(times, [0.0, 0.1, 0.2]);
}

const STEPS: f64 = 400.0;
/// An interval at which some steps are saved and others are not.
const EVERY: Duration = Duration::from_millis(5);

/// The run that is killed: it goes on from its file, notes each step, and leaves the last state when it is over.
#[test]
#[ignore = "started by fifty_killed_runs_end_with_the_same_bits"]
fn a_run_that_is_killed() {
    let folder = PathBuf::from(std::env::var("CHECKPOINT_FOLDER").unwrap());
    let every = if std::env::var("CHECKPOINT_EVERY_STEP").is_ok() { Duration::ZERO } else { EVERY };
    let (saved, done) = (folder.join("run.checkpoint"), folder.join("done"));
    let mut contact = sphere_on(Grid::square(64, 6.0e-3).unwrap(), three_times(), Settings::default());
    if saved.exists() {
        contact.resume(&saved).unwrap();
    }
    let mut log = fs::OpenOptions::new().create(true).append(true).open(folder.join("log")).unwrap();
    use std::io::Write;
    writeln!(log, "\nresumed {:e}", contact.time()).unwrap(); // the line before may be cut
    let load = Sinusoid::new(Load::force(0.2), Load::force(0.3), 1.0).unwrap();
    let mut run = contact.follow(&load, Stepping::fixed(0.01), 0.01 * STEPS).autosave_to(&saved, every);
    while let Some(report) = run.next_step().unwrap() {
        writeln!(log, "{:e} .", report.time).unwrap();
    }
    let bits: Vec<u8> =
        contact.pressure().iter().chain(contact.fields().displacement()).flat_map(|x| x.to_le_bytes()).collect();
    fs::write(folder.join("part"), bits).unwrap();
    fs::rename(folder.join("part"), done).unwrap();
}

/// Starts the run in a folder; kills it when it has written `kill_after` lines. Returns whether it came to its end.
fn start(folder: &Path, every_step: bool, kill_after: Option<usize>) -> bool {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", "io::checkpoint::a_run_that_is_killed", "--ignored"]);
    command.env("CHECKPOINT_FOLDER", folder).stdout(Stdio::null()).stderr(Stdio::null());
    if every_step {
        command.env("CHECKPOINT_EVERY_STEP", "");
    }
    let mut child = command.spawn().unwrap();
    if let Some(after) = kill_after {
        let log = folder.join("log");
        let written = || fs::read(&log).map_or(0, |log| log.iter().filter(|&&byte| byte == b'\n').count());
        let before = written();
        while written() < before + after && child.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        child.kill().unwrap();
    }
    child.wait().unwrap();
    folder.join("done").exists()
}

/// For each resumption: where it was, and how many steps of the run before it were lost.
fn losses(log: &str) -> Vec<(f64, usize)> {
    let (mut losses, mut steps) = (Vec::new(), Vec::<f64>::new());
    for line in log.lines() {
        if let Some(time) = line.strip_prefix("resumed ") {
            let resumed: f64 = time.parse().unwrap();
            losses.push((resumed, steps.iter().filter(|time| **time > resumed).count()));
            steps.clear();
        } else if let Some(time) = line.strip_suffix(" .") {
            // the last line of a run that was killed may be cut
            steps.push(time.parse().unwrap());
        }
    }
    losses
}

/// Killed at fifty random steps, run after run to its end: not a bit differs, and where each step is saved, none is lost.
#[test]
fn fifty_killed_runs_end_with_the_same_bits() {
    let undisturbed = Temporary::folder("undisturbed");
    assert!(start(&undisturbed, true, None));
    let exact = fs::read(undisturbed.join("done")).unwrap();
    let (mut kills, mut runs, mut differing, mut most) = (0, 0, 0, 0);
    let mut random = uniform(1);
    while kills < 50 {
        let killed = Temporary::folder("killed");
        let every_step = runs % 2 == 0;
        loop {
            let after = 1 + (80.0 * random()) as usize;
            if start(&killed, every_step, (kills < 50).then_some(after)) {
                break;
            }
            kills += 1;
        }
        runs += 1;
        differing += usize::from(fs::read(killed.join("done")).unwrap() != exact);
        for (at, lost) in losses(&fs::read_to_string(killed.join("log")).unwrap()) {
            assert!(lost == 0 || !every_step, "at {at}: {lost} steps lost");
            most = most.max(lost);
        }
    }
    println!("{kills} kills in {runs} runs, {differing} answers differ, {most} steps lost at most");
    assert_eq!(differing, 0);
}
