//! Random loads and load histories.

use std::sync::Arc;

use proptest::prelude::*;
use proptest::strategy::Union;

use super::{built, history};
use crate::load::{FnHistory, Load, LoadHistory, Periodic, PiecewiseLinear, Ramp, Sinusoid, StepLoad, Tilt};

/// Loads of every kind: forces up to `force` \[N\], approaches within `depth` \[m\], springs about as stiff as both
/// suggest, tilts within `tilt` \[rad\], load points within `reach` of the origin \[m\].
pub fn loads(force: f64, depth: f64, tilt: f64, reach: f64) -> impl Strategy<Value = Load> {
    let part = || -1.0..1.0_f64;
    let one = move || {
        prop_oneof![
            Just(Tilt::Fixed(0.0)),
            part().prop_map(move |part| Tilt::Fixed(part * tilt)),
            part().prop_map(move |part| Tilt::Free { at: part * reach }),
        ]
    };
    let tilts = move || [one(), one()];
    prop_oneof![
        (0.0..1.0_f64).prop_map(move |part| Load::force(part * force)),
        part().prop_map(move |part| Load::approach(part * depth)),
        (0.0..1.0_f64, tilts()).prop_map(move |(part, tilt)| Load::Force { normal: part * force, tilt }),
        (part(), tilts()).prop_map(move |(part, tilt)| Load::Approach { approach: part * depth, tilt }),
        (part(), part(), tilts()).prop_map(move |(part, stiff, tilt)| {
            let stiffness = 10f64.powf(2.0 * stiff) * force / depth;
            Load::Spring { stiffness, drive: part * (depth + force / stiffness), tilt }
        }),
    ]
}

/// Histories of a force up to `force` \[N\] on a body that does not tilt, varying over `duration` \[s\]: constant,
/// ramps, tables with corners and jumps, oscillations, closures with and without corners.
pub fn histories(force: f64, duration: f64) -> impl Strategy<Value = Arc<dyn LoadHistory>> {
    let load = move || (0.0..1.0_f64).prop_map(move |part| Load::force(part * force));
    let time = move || (0.05..1.0_f64).prop_map(move |part| part * duration);
    let frequency = move || (0.5..3.0_f64).prop_map(move |cycles| cycles / duration);
    let entries = prop::collection::vec((0.02..0.3_f64, load(), prop::option::of(load())), 2..8);
    let tables = built(entries, move |entries| {
        let (mut table, mut time) = (Vec::new(), 0.0);
        for (pause, load, jump) in entries {
            table.push((time, load));
            table.extend(jump.map(|after| (time, after)));
            time += pause * duration;
        }
        Ok(table)
    });
    Union::new([
        history(load(), StepLoad::new),
        history((load(), load(), time()), |(from, to, time)| Ramp::new(from, to, time)),
        history(tables.clone(), |table| PiecewiseLinear::new(&table)),
        history(tables, |table| Periodic::new(&table)),
        history((load(), load(), time(), 0.05..0.95_f64), |(a, b, period, duty)| Periodic::square(a, b, period, duty)),
        history((load(), load(), time()), |(from, to, period)| Periodic::triangle(from, to, period)),
        history((load(), load(), time()), |(from, to, period)| Periodic::sawtooth(from, to, period)),
        history((0.0..1.0_f64, 0.0..1.0_f64, frequency()), move |(high, part, frequency)| {
            Sinusoid::new(Load::force(part * high * force), Load::force(high * force), frequency)
        }),
        history((0.1..0.5_f64, 0.1..0.5_f64, time()), move |(mean, swing, time)| {
            let smooth = move |t: f64| Load::force(force * (mean + 0.1 * swing * (-t / time).exp()));
            Ok(FnHistory::new(smooth))
        }),
        history((0.1..1.0_f64, time()), move |(part, corner)| {
            let load = move |t: f64| Load::force(part * force * (t - corner).abs() / duration);
            FnHistory::new(load).with_breakpoints(&[corner])
        }),
    ])
}
