//! Files of checkpoints, damaged, and forged with a right checksum.

use std::sync::OnceLock;

use viscocontact::prelude::*;
use viscocontact_scenes::Temporary;
use viscocontact_scenes::sealed::{CHECKSUM, seal};

use crate::engine::{Outcome, Target, Verdict, finite, known};

use crate::files::shared;
use crate::scenes::{look, look_along, state, unchanged};
use crate::source::Source;

pub fn targets() -> Vec<Target> {
    vec![Target { name: "checkpoint", short: 2500, run: checkpoint }]
}

/// How many scenes there are to save.
const SCENES: usize = 7;

fn build(scene: usize) -> viscocontact::Result<ViscoelasticContact> {
    let whole = Settings::default().with_window(false).with_symmetry(false);
    let terms = [(1.0e6, 0.03), (0.5e6, 0.3), (0.5e6, 3.0)];
    let polymer = Material::incompressible(GeneralizedMaxwell::new(0.1e6, &terms)?);
    let grid = Grid::square(8, 4.0e-3)?;
    let ball = Sphere::new(5.0e-3)?;
    let builder = || ViscoelasticContact::builder(grid.clone()).geometry(&ball);
    match scene {
        0 => builder().material(polymer).build(),
        1 => builder().material(polymer).settings(whole).build(),
        2 => builder().material(polymer).settings(whole.with_time_rule(TimeRule::ExponentialLinear)).build(),
        3 => builder().material(polymer).settings(whole.with_frame(Frame::Indenter)).build(),
        // a past of jumps alone, and one of steps too
        4 | 5 => {
            let body = Material::incompressible(FractionalMaxwell::findley(1e-6, 1e-6, 0.3)?);
            builder().material(body).times(1e-3..=1e3).build()
        }
        _ => {
            let beside = Shifted::new(ball, [1.0e-3, 0.0])?;
            builder().material(polymer).another_body(&beside).settings(whole).build()
        }
    }
}

fn step(contact: &mut ViscoelasticContact, dt: f64, force: f64) -> viscocontact::Result<StepReport> {
    let loads = vec![Load::force(force); contact.fields().bodies()];
    contact.step(dt, &loads)
}

/// A new contact of a scene: a copy, since some of their series are fitted.
fn new(scene: usize) -> ViscoelasticContact {
    static CONTACTS: OnceLock<Vec<ViscoelasticContact>> = OnceLock::new();
    let all = || (0..SCENES).map(|scene| build(scene).expect("a good scene")).collect();
    CONTACTS.get_or_init(all)[scene].clone()
}

/// A sound file of each scene, and one of a run along a history.
fn sound_files() -> &'static [(usize, Vec<u8>)] {
    static FILES: OnceLock<Vec<(usize, Vec<u8>)>> = OnceLock::new();
    FILES.get_or_init(|| {
        let folder = Temporary::folder("fuzz-sound");
        let path = folder.join("file");
        let mut files = Vec::new();
        for scene in 0..SCENES {
            let mut contact = new(scene);
            for dt in if scene == 4 { &[0.0, 0.0][..] } else { &[0.0, 0.02, 0.01] } {
                step(&mut contact, *dt, 0.1).expect("a good step");
            }
            contact.save(&path).expect("a file");
            files.push((scene, std::fs::read(&path).expect("a file")));
            // once an indenter has moved, the file has its gap
            let ball = |body: usize| Shifted::new(Sphere::new(5.0e-3)?, [2.0e-4 + 1.0e-3 * body as f64, 0.0]);
            let moved: Vec<_> = (0..contact.fields().bodies()).map(|body| ball(body).expect("a ball")).collect();
            let moved: Vec<&dyn Geometry> = moved.iter().map(|ball| ball as _).collect();
            let mut aside = contact.clone();
            if aside.set_geometries(&moved).is_ok() {
                aside.save(&path).expect("a file");
                files.push((scene, std::fs::read(&path).expect("a file")));
            }
            let load = StepLoad::new(Load::force(0.1)).expect("a good load");
            if scene == 0 {
                let mut run = contact.follow(&load, Stepping::adaptive(1e-2), 3.0);
                (0..3).for_each(|_| _ = run.next_step());
                run.save(&path).expect("a file");
                files.push((scene, std::fs::read(&path).expect("a file")));
            }
        }
        files
    })
}

/// A file whose state is damaged, and whose length and checksum fit it.
fn forged(file: &[u8], source: &mut Source) -> Vec<u8> {
    let mut file = if source.chance(0.2) {
        [&file[..CHECKSUM.end], &source.damage(&file[CHECKSUM.end..])].concat()
    } else {
        source.damage_behind(file, CHECKSUM.end)
    };
    seal(&mut file);
    file
}

/// A damaged file is refused and leaves no mark, or it gives a contact whose next steps are numbers.
fn checkpoint(source: &mut Source) -> Verdict {
    let files = sound_files();
    let (scene, ref file) = files[source.below(files.len())];
    let damaged = match source.below(10) {
        0 => file.clone(),
        1 | 2 => source.damage(file),
        _ => forged(file, source),
    };
    // another scene now and then
    let scene = if source.chance(0.02) { source.below(SCENES) } else { scene };
    let mut contact = new(scene);
    let path = shared().join("checkpoint");
    std::fs::write(&path, &damaged).map_err(|error| error.to_string())?;
    let before = state(&contact);
    if let Err(error) = contact.resume(&path) {
        return unchanged(&before, &contact, &error).map(|()| Outcome::Refused);
    }
    known("resumed pressure", contact.pressure().iter().copied())?;
    finite("resumed displacement", contact.fields().displacement().iter().copied())?;
    finite("resumed numbers", [contact.time(), contact.approach(), contact.force()])?;
    if source.chance(0.2) {
        let load = StepLoad::new(Load::force(0.1)).map_err(|error| error.to_string())?;
        look_along(contact.follow(&load, Stepping::adaptive(1e-2), 3.0), 2, source, |_| ())?;
        return Ok(Outcome::Accepted);
    }
    for dt in [source.choose(&[0.0, 0.01]), 0.02] {
        let before = state(&contact);
        match step(&mut contact, dt, 0.08) {
            Ok(report) => look(&contact, &report, source)?,
            Err(error) => unchanged(&before, &contact, &error)?,
        }
    }
    Ok(Outcome::Accepted)
}
