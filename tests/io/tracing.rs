//! Events for subscribers of `tracing`.

use crate::common::{builder_on, sphere_on};
use std::sync::{Arc, Mutex};
use std::thread::ThreadId;

use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::subscriber::Interest;
use tracing::{Event, Level, Metadata, Subscriber};
use viscocontact::prelude::*;

/// Keeps the level and message of each event of one thread: other tests share this process.
#[derive(Clone)]
struct Kept(Arc<Mutex<Vec<(Level, String)>>>, ThreadId);

impl Visit for Kept {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        if field.name() == "message" {
            self.0.lock().unwrap().last_mut().unwrap().1 = format!("{value:?}");
        }
    }
}

impl Subscriber for Kept {
    // asked at every event, as the answer depends on the thread
    fn register_callsite(&self, _: &'static Metadata<'static>) -> Interest {
        Interest::sometimes()
    }
    fn enabled(&self, _: &Metadata<'_>) -> bool {
        std::thread::current().id() == self.1
    }
    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }
    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn event(&self, event: &Event<'_>) {
        self.0.lock().unwrap().push((*event.metadata().level(), String::new()));
        event.record(&mut self.clone());
    }
    fn enter(&self, _: &Id) {}
    fn exit(&self, _: &Id) {}
}

#[test]
fn steps_regions_and_series_are_events() {
    let kept = Kept(Arc::default(), std::thread::current().id());
    tracing::subscriber::set_global_default(kept.clone()).unwrap();
    {
        let body = Material::incompressible(FnRheology::new(|t| 1.0e-6 * (1.0 + t.sqrt())));
        let mut contact = builder_on(Grid::square(48, 4.0e-3).unwrap(), body).times(1e-3..=1e5).build().unwrap();
        contact.step(0.0, Load::force(0.1)).unwrap();
        contact.step(0.1, Load::force(0.5)).unwrap();
        contact.step(0.1, Load::force(500.0)).unwrap_err();
        let mut contact = sphere_on(
            Grid::square(32, 4.0e-3).unwrap(),
            Material::incompressible(Zener::with_time(1.0e6, 1.0e5, 0.01).unwrap()),
            Settings::default(),
        );
        let wave = Sinusoid::new(Load::force(0.02), Load::force(0.1), 10.0).unwrap();
        let mut run = contact.follow(&wave, Stepping::adaptive(1e-3), 0.5);
        while run.next_step().unwrap().is_some() {}
        assert!(run.rejected_steps() > 0);
    }
    let kept = kept.0.lock().unwrap();
    for (level, message) in [
        (Level::DEBUG, "step accepted"),
        (Level::DEBUG, "region moved"),
        (Level::DEBUG, "series fitted"),
        (Level::WARN, "step failed"),
        (Level::WARN, "step rejected"),
    ] {
        assert!(kept.iter().any(|event| *event == (level, message.to_owned())), "{message}: {kept:?}");
    }
}
