//! Studies of scenes, from the accuracy that is wanted.

use viscocontact::contact::ViscoelasticContact;
use viscocontact::study::Study;

use crate::engine::{Target, Verdict, finite, judged};
use crate::models;
use crate::source::Source;

/// Most cells of a mesh, and most work.
const CELLS: usize = 60 * 60;
const WORK: f64 = 1e7;

pub fn targets() -> Vec<Target> {
    vec![Target { name: "study", short: 20, run: study }]
}

fn study(source: &mut Source) -> Verdict {
    let length = source.scale(1e-6, 1.0);
    let made = models::material(source, false).and_then(|material| {
        let softness = material.contact_compliance(1.0).abs().max(1e-300);
        let history = models::few_turns(source, length, softness)?;
        let geometry = models::geometry(source, length)?;
        let accuracy = if source.chance(0.5) { 1e-2 } else { source.scale(1e-2, 0.1) };
        let until = source.scale(0.3, 3.0);
        let scene = |grid, settings| {
            Ok(ViscoelasticContact::builder(grid).geometry(&geometry).material(material.clone()).settings(settings))
        };
        Study::new(scene, &*history, until).accuracy(accuracy).cells(CELLS).work(WORK).run()
    });
    judged(made, |study| {
        let told = study.quantities.iter().flat_map(|own| [Some(own.time), own.mesh, own.order]).flatten();
        finite("study", told.chain([study.work, study.contact().approach()]))?;
        let text = study.to_string();
        if text.contains("NaN") || text.contains("inf") || study.meshes.is_empty() || study.bytes() == 0 {
            return Err(format!("a study of nothing: {text}"));
        }
        Ok(())
    })
}
