//! Contacts in a browser: what `index.html` calls of the crate, as functions of numbers alone.
//!
//! Settings are set one by one, in the units of the form; [`start`] builds the scene; each [`advance`] takes a step, after
//! which series, fields and lines are read in place. Texts and numbers stay where they are until the next call.

pub mod scenes;
pub mod settings;
pub mod simulation;

use std::cell::RefCell;

use settings::Settings;
use simulation::Simulation;

/// What one page has.
#[derive(Debug, Default)]
struct Page {
    settings: Settings,
    simulation: Option<Simulation>,
    text: String,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

fn with<T>(on: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(on)
}

impl Page {
    fn say(&mut self, text: String) -> usize {
        self.text = text;
        self.text.len()
    }

    /// Numbers that were seen, none before the start.
    fn seen<'a>(&'a self, of: impl FnOnce(&'a Simulation) -> Option<&'a Vec<f64>>) -> &'a [f64] {
        self.simulation.as_ref().and_then(of).map_or(&[], Vec::as_slice)
    }
}

/// 1 if there is more, 0 at the end, −1 if it failed: the text then says why.
fn outcome(page: &mut Page, of: Result<bool, String>) -> i32 {
    of.map(i32::from).unwrap_or_else(|error| {
        page.say(error);
        -1
    })
}

/// Gives the text to a native caller.
pub fn with_text<T>(on: impl FnOnce(&str) -> T) -> T {
    with(|page| on(&page.text))
}

// A browser finds functions by their names, which are unique here.
macro_rules! exported {
    ($($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? $body:block)*) => {
        $($(#[$doc])* #[unsafe(no_mangle)] pub extern "C" fn $name($($argument: $type),*) $(-> $result)? $body)*
    };
}

exported! {
    /// Writes the table of settings and the scenes as JSON into the text, and returns its bytes.
    fn describe() -> usize {
        with(|page| page.say(settings::described(&scenes::scenes())))
    }

    /// The text that the last call wrote.
    fn text() -> *const u8 {
        with(|page| page.text.as_ptr())
    }

    /// The bytes of that text.
    fn text_length() -> usize {
        with(|page| page.text.len())
    }

    /// Sets the setting at a place of the table.
    fn set(place: usize, value: f64) {
        with(|page| page.settings.set(place, value));
    }

    /// Forgets the load.
    fn clear_load() {
        with(|page| page.settings.clear_load());
    }

    /// Adds a point to the load.
    fn add_load(time: f64, value: f64) {
        with(|page| page.settings.add_load(time, value));
    }

    /// Builds the scene of the settings: 1, or −1 if it is refused, for the reason in the text.
    fn start() -> i32 {
        with(|page| {
            page.simulation = None;
            let built = Simulation::new(&page.settings).map(|built| page.simulation = Some(built));
            outcome(page, built.map(|()| true))
        })
    }

    /// Takes a step: 1, or 0 at the end, or −1 if the step is refused, for the reason in the text.
    fn advance() -> i32 {
        with(|page| {
            let advanced = page.simulation.as_mut().map_or(Ok(false), Simulation::advance);
            outcome(page, advanced)
        })
    }

    /// Writes what the run says of its last step and its errors into the text, and returns its bytes.
    fn report() -> usize {
        with(|page| {
            let report = page.simulation.as_ref().map(|simulation| simulation.report.clone());
            page.say(report.unwrap_or_default())
        })
    }

    /// Steps that were taken.
    fn frames() -> usize {
        with(|page| page.seen(|simulation| simulation.frames.series.first()).len())
    }

    /// Times \[s\] (0), forces \[N\] (1), approaches \[m\] (2), areas \[m²\] (3) or maximum pressures \[Pa\] (4) of all frames.
    fn series(of: usize) -> *const f64 {
        with(|page| page.seen(|simulation| simulation.frames.series.get(of)).as_ptr())
    }

    /// The pressures \[Pa\] of all cells in a frame.
    fn pressure(frame: usize) -> *const f64 {
        with(|page| page.seen(|simulation| simulation.frames.pressure.get(frame)).as_ptr())
    }

    /// Pressures \[Pa\] (0), displacements \[m\] (1) or gaps \[m\] (2) along x1 through the middle, in a frame.
    fn line(frame: usize, of: usize) -> *const f64 {
        with(|page| page.seen(|simulation| simulation.frames.lines.get(frame)?.get(of)).as_ptr())
    }

    /// Points of the friction loop.
    fn loop_points() -> usize {
        with(|page| page.seen(|simulation| simulation.friction.first()).len())
    }

    /// Displacements \[m\] (0) or forces \[N\] (1) along the surface.
    fn friction_loop(of: usize) -> *const f64 {
        with(|page| page.seen(|simulation| simulation.friction.get(of)).as_ptr())
    }
}
