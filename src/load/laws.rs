//! The laws that every [`LoadHistory`] obeys, to test implementations of the trait. [`all`] checks them at given times
//! and at the breakpoints between, and reports which law is violated, where and by how much.
//!
//! ```
//! use viscocontact::load::{Load, LoadHistory, laws};
//!
//! #[derive(Debug)]
//! struct Knock; // a jump without a breakpoint
//!
//! impl LoadHistory for Knock {
//!     fn at(&self, t: f64) -> Load {
//!         Load::force(if t < 0.7 { 1.0 } else { 0.0 })
//!     }
//! }
//! let violation = laws::all(&Knock, &laws::even_times(0.0, 2.0, 10)).unwrap_err();
//! assert_eq!((violation.law, violation.quantity), ("jumps lie on breakpoints", "normal force"));
//! assert!(matches!(violation.at, laws::Location::Time(t) if (t - 0.7).abs() < 1e-6));
//! println!("{violation}");
//! ```

use crate::error::KIND_OF_LOAD;
pub use crate::error::{Location, Verdict, Violation};
use crate::load::{Load, LoadHistory, VALUES};

/// Difference allowed between formulas that are equal but for rounding, relative to the maximum value.
const SAME: f64 = 1e-10;
/// Maximum number of breakpoints between the times that are checked.
const MOST_BREAKPOINTS: usize = 10_000;
/// Smaller second differences are rounding, relative to the maximum value.
const STRAIGHT: f64 = 1e-12;

/// `count` + 1 evenly spaced times from `first` to `last` \[s\].
pub fn even_times(first: f64, last: f64, count: usize) -> Vec<f64> {
    let count = count.max(1);
    (0..=count).map(|k| first + (last - first) * (k as f64 / count as f64)).collect()
}

const IS_A_LOAD: &str = "every load is one that a step accepts";
const JUMPS: &str = "jumps lie on breakpoints";

/// Every law, at two or more ascending `times` \[s\]: breakpoints increase; loads are those that a step accepts, and
/// the same when they are asked for again; [`LoadHistory::at`] is the limit from later times, [`LoadHistory::before`]
/// that from earlier ones; and between breakpoints there is no jump, no corner, and no load of another kind. Forces
/// that pull, which only surfaces that attract each other allow, break a law.
///
/// # Errors
/// The first violation; or if the times are fewer than two, or not ascending.
pub fn all(history: &dyn LoadHistory, times: &[f64]) -> Verdict {
    Violation::check_ascending(times, 2, f64::NEG_INFINITY)?;
    breakpoints_increase(history, times)?;
    is_a_load(history, times)?;
    repeats_itself(history, times)?;
    right_continuous(history, times)?;
    before_is_the_left_limit(history, times)?;
    smooth_between_breakpoints(history, times)
}

/// The times and the breakpoints between them.
fn moments(history: &dyn LoadHistory, times: &[f64]) -> Vec<f64> {
    let mut moments = times.to_vec();
    if let (Some(&first), Some(&last)) = (times.first(), times.last()) {
        moments.extend(history.breakpoints(first).take(MOST_BREAKPOINTS).take_while(|&next| next < last));
    }
    moments.sort_by(f64::total_cmp);
    moments.dedup();
    moments
}

/// The moments, and times between them.
fn and_between(moments: &[f64]) -> impl Iterator<Item = f64> {
    let between = moments.windows(2).flat_map(|pair| [0.3, 0.5, 0.7].map(|part| pair[0] + part * (pair[1] - pair[0])));
    moments.iter().copied().chain(between)
}

/// The maximum absolute value at and between the moments: a load may vanish at its corners.
fn scales(history: &dyn LoadHistory, moments: &[f64]) -> [f64; VALUES] {
    and_between(moments).fold([0.0; VALUES], |most, t| {
        let (at, before) = (history.at(t).values(), history.before(t).values());
        std::array::from_fn(|k| f64::max(most[k], f64::max(at[k].abs(), before[k].abs())))
    })
}

fn check_kind(law: &'static str, t: f64, found: &Load, expected: &Load) -> Verdict {
    Violation::check(law, KIND_OF_LOAD, t, [f64::NAN; 2], found.is_like(expected))
}

/// Accepts a load that differs from the expected one by no more than `within` in each value.
fn check_load(law: &'static str, t: f64, found: &Load, expected: &Load, within: [f64; VALUES]) -> Verdict {
    let (a, b, named) = (found.values(), expected.values(), found.names());
    check_kind(law, t, found, expected)?;
    (0..VALUES).try_for_each(|k| Violation::check(law, named[k], t, [a[k], b[k]], (a[k] - b[k]).abs() <= within[k]))
}

/// Breakpoints are finite and later than the argument; the next one is the same for every argument before it.
fn breakpoints_increase(history: &dyn LoadHistory, times: &[f64]) -> Verdict {
    let last = times.last().copied().unwrap_or(0.0);
    for (k, &t) in times.iter().enumerate() {
        let mut after = t;
        for _ in 0..MOST_BREAKPOINTS {
            let Some(next) = history.next_breakpoint(after) else { break };
            let later = next > after && next.is_finite();
            Violation::check("breakpoints increase", "breakpoint", after, [next, after], later)?;
            let between = times[k..].iter().copied().chain([after + 0.5 * (next - after)]);
            for s in between.filter(|s| *s > after && *s < next) {
                let again = history.next_breakpoint(s).unwrap_or(f64::INFINITY);
                let law = "the next breakpoint is the same until it is reached";
                Violation::check(law, "breakpoint", s, [again, next], again == next)?;
            }
            // breakpoints beyond the next time are checked from there
            if next > times.get(k + 1).copied().unwrap_or(last) {
                break;
            }
            after = next;
        }
    }
    Ok(())
}

/// The loads are valid, finite with forces that press and springs that resist, before and after jumps and between the
/// times. Forces that pull, which only surfaces that attract each other allow, break it.
fn is_a_load(history: &dyn LoadHistory, times: &[f64]) -> Verdict {
    for t in and_between(&moments(history, times)) {
        for load in [history.at(t), history.before(t)].iter().filter(|load| load.validate_in(false).is_err()) {
            let (named, found) = (load.names(), load.values());
            let k = (0..VALUES).find(|&k| !found[k].is_finite()).unwrap_or(0);
            Violation::check(IS_A_LOAD, named[k], t, [found[k], 0.0], false)?;
        }
    }
    Ok(())
}

/// Repeated evaluation in another order returns bitwise the same loads.
fn repeats_itself(history: &dyn LoadHistory, times: &[f64]) -> Verdict {
    let moments = moments(history, times);
    let first: Vec<[Load; 2]> = moments.iter().map(|&t| [history.at(t), history.before(t)]).collect();
    for (&t, loads) in moments.iter().zip(&first).rev() {
        let again = [history.before(t), history.at(t)];
        for (found, expected) in [(&again[1], &loads[0]), (&again[0], &loads[1])] {
            check_load("asked again, it answers the same", t, found, expected, [0.0; VALUES])?;
        }
    }
    Ok(())
}

/// Whether the load has its limit at the start of each interval from later times (`side` 1), or at its end from earlier
/// times (`side` −1): the difference must decrease with the distance in time.
fn one_sided_limits(law: &'static str, history: &dyn LoadHistory, times: &[f64], side: f64) -> Verdict {
    let moments = moments(history, times);
    let scale = scales(history, &moments);
    for pair in moments.windows(2) {
        let later = side > 0.0;
        let (t, limit) = if later { (pair[0], history.at(pair[0])) } else { (pair[1], history.before(pair[1])) };
        let room = pair[1] - pair[0];
        let far = (1e-6 * room).max(1e-9 * t.abs());
        if far >= 0.5 * room {
            continue; // below the resolution of f64
        }
        let (here, near) = (history.at(t + side * far), history.at(t + side * 1e-3 * far));
        let (a, b) = (here.values(), limit.values());
        let within = std::array::from_fn(|k| 0.5 * (a[k] - b[k]).abs() + SAME * scale[k]);
        check_load(law, t, &limit, &near, within)?;
    }
    Ok(())
}

/// At each time [`LoadHistory::at`] is the limit from later times.
fn right_continuous(history: &dyn LoadHistory, times: &[f64]) -> Verdict {
    one_sided_limits("at a time it is the load after it", history, times, 1.0)
}

/// At each time but the first [`LoadHistory::before`] is the limit from earlier times.
fn before_is_the_left_limit(history: &dyn LoadHistory, times: &[f64]) -> Verdict {
    one_sided_limits("before a time it is the left limit", history, times, -1.0)
}

/// Between breakpoints the load has no jump and no corner, and does not change its kind. The search follows the
/// maximum second difference.
fn smooth_between_breakpoints(history: &dyn LoadHistory, times: &[f64]) -> Verdict {
    let moments = moments(history, times);
    let scale = scales(history, &moments);
    for pair in moments.windows(2) {
        let (start, end) = (pair[0], pair[1]);
        // at a time that is not a breakpoint there is no jump
        let is_breakpoint = history.next_breakpoint(start).is_some_and(|next| next <= end);
        if !is_breakpoint {
            let within = scale.map(|scale| SAME * scale);
            check_load(JUMPS, end, &history.before(end), &history.at(end), within)?;
        }
        let first = history.at(start);
        let load = |t: f64| if t == end { history.before(end) } else { history.at(t) };
        let (middle, last) = (load(0.5 * (start + end)), load(end));
        for other in [&middle, &last] {
            check_kind(JUMPS, end, other, &first)?;
        }
        for (k, scale) in scale.into_iter().enumerate() {
            let value = |t: f64| load(t).values()[k];
            if let Some((law, t)) = roughest(&value, start, end, STRAIGHT * scale) {
                let near = 1e-9 * (end - start);
                let (found, expected) = (value((t + near).min(end)), value((t - near).max(start)));
                Violation::check(law, first.names()[k], t, [found, expected], false)?;
            }
        }
    }
    Ok(())
}

/// Repeatedly halves the interval of the maximum second difference, which then falls to a quarter where the load is
/// smooth, to a half at a corner, and not at all at a jump. Returns the law that is violated, and the time.
fn roughest(value: &dyn Fn(f64) -> f64, start: f64, end: f64, straight: f64) -> Option<(&'static str, f64)> {
    let bend = |[a, b]: [f64; 2]| (value(0.5 * (a + b)) - 0.5 * (value(a) + value(b))).abs();
    let mut window = [start, end];
    let mut bends = vec![bend(window)];
    for _ in 0..40 {
        let [a, b] = window;
        let width = b - a;
        // the rounding of the times, multiplied by the slope
        let local = value(a).abs().max(value(b).abs());
        let rounding = STRAIGHT * local + 1e-15 * (value(b) - value(a)).abs() / width * b.abs().max(a.abs());
        if width <= 1e-10 * b.abs().max(a.abs()) || bends.last().is_none_or(|last| *last <= straight + rounding) {
            break;
        }
        let halves = [[a, a + 0.5 * width], [a + 0.25 * width, a + 0.75 * width], [a + 0.5 * width, b]];
        let most = halves.into_iter().map(|half| (bend(half), half)).max_by(|x, y| x.0.total_cmp(&y.0))?;
        window = most.1;
        bends.push(most.0);
    }
    // six halvings, the last above rounding: 2⁻¹² where it is smooth, 2⁻⁶ at a corner, within a factor of 2
    let [.., early, _, _, _, _, _, late, _] = bends[..] else { return None };
    let at = 0.5 * (window[0] + window[1]);
    match late / early {
        ratio if ratio.is_nan() => Some((IS_A_LOAD, at)),
        ratio if ratio > 0.125 => Some((JUMPS, at)),
        ratio if ratio > 0.0055 => Some(("corners lie on breakpoints", at)),
        _ => None,
    }
}
