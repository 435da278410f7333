//! What levels of elastic states do not reach, and where they do not superpose.

use crate::error::{Error, Refusal};
use crate::rounded::{TIME, rounded};

/// The error of a state beyond the last one of the sweep.
pub(super) fn beyond(time: f64, needed: &str, last: f64) -> Error {
    let (time, last) = (rounded(time, TIME), rounded(last, TIME));
    let what = format!("at t = {time} s the contact needs {needed}, beyond the last elastic state at {last}");
    Refusal::value("states_beyond", what, ": sweep further (states::Reach)").into()
}

/// The error of a level below the first from which the elastic contact only grows.
pub(super) fn below(time: f64, level: f64, first: f64) -> Error {
    let what = format!(
        "at t = {} s the contact needs the level {level:.3e} m², below {first:.3e} m², from which the pressure of the \
         elastic contact falls nowhere",
        rounded(time, TIME)
    );
    Refusal::value("states_below", what, ": step it with ViscoelasticContact").into()
}

/// The error of a group of levels that leaves 0 ≤ W ≤ 1.
pub(super) fn out_of_order(time: f64, share: f64) -> Error {
    let (time, share) = (rounded(time, TIME), rounded(share, 5));
    let what =
        format!("at t = {time} s the elastic states do not superpose: a share that must be in [0, 1] is {share}");
    let remedy = "; take a shorter step, or step the scene with ViscoelasticContact";
    Refusal::search("states_out_of_order", what, remedy).into()
}

/// The error of a part inside the one that slips, which cannot stick.
pub(super) fn beyond_friction(time: f64, share: f64) -> Error {
    let (time, share) = (rounded(time, TIME), rounded(share, 5));
    let what = format!(
        "at t = {time} s a part of the contact would have to carry {share} times what friction carries, inside the part \
         that slips: the elastic states do not superpose"
    );
    Refusal::unsupported("states_beyond_friction", what, "; take a shorter step").into()
}
