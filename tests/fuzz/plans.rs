//! Plans of scenes, from the accuracy that is wanted.

use viscocontact::plan::{Accuracy, Plan};

use crate::engine::{Target, Verdict, finite, judged};
use crate::models;
use crate::source::Source;

pub fn targets() -> Vec<Target> {
    vec![Target { name: "plan", short: 20, run: plan }]
}

fn plan(source: &mut Source) -> Verdict {
    let length = source.scale(1e-6, 1.0);
    let made = models::material(source, false).and_then(|material| {
        let softness = material.contact_compliance(1.0).abs().max(1e-300);
        let history = models::few_turns(source, length, softness)?;
        let geometry = models::geometry(source, length)?;
        let accuracy = if source.chance(0.5) { Accuracy::COARSE } else { Accuracy::new(source.scale(1e-2, 0.1))? };
        let until = source.scale(0.3, 3.0);
        Plan::builder(&geometry, &material, &*history, until).accuracy(accuracy).build()
    });
    judged(made, |plan| {
        let (error, [reach1, reach2]) = (plan.mesh_error, plan.reach);
        let numbers = [reach1, reach2, plan.convolutions, error.approach, error.area];
        finite("plan", numbers.into_iter().chain([error.singular]).chain(error.max_pressure))?;
        let text = plan.to_string();
        if text.contains("NaN") || text.contains("inf") || plan.grid.len() == 0 || plan.bytes == 0 {
            return Err(format!("a plan of nothing: {text}"));
        }
        Ok(())
    })
}
