/// The quantity that is no number.
pub(crate) const KIND_OF_LOAD: &str = "kind of load";

/// A law of a trait that an implementation violates, with the value found and the value required.
#[derive(Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Violation {
    /// The law.
    pub law: &'static str,
    /// The quantity: creep compliance \[1/Pa\], gap \[m\], force \[N\], breakpoint \[s\], …
    pub quantity: &'static str,
    /// Where the law is violated.
    pub at: Location,
    /// The value found.
    pub found: f64,
    /// The value expected; the bound of an inequality. NaN, as the value found, of what is no number: the kind of a
    /// load.
    pub expected: f64,
}

impl std::error::Error for Violation {}

/// The message: a `main` that returns a [`Verdict`] prints it so.
impl std::fmt::Debug for Violation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

impl std::fmt::Display for Violation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Violation { law, quantity, at, found, expected } = self;
        if *quantity == KIND_OF_LOAD {
            return write!(f, "{law}: {quantity} {at} is another one");
        }
        let bound = if found == expected { "more than " } else { "" };
        write!(f, "{law}: {quantity} {at} is {found:?}, expected {bound}{expected:?}")
    }
}

/// Nothing if a law holds, otherwise its first violation.
pub type Verdict = Result<(), Violation>;

/// Where a law is violated.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Location {
    /// A time \[s\].
    Time(f64),
    /// A gap \[m\].
    Gap(f64),
    /// In the arguments of the check.
    Arguments,
    /// A cell.
    Cell {
        /// Its indices \[i, j\].
        cell: [usize; 2],
        /// Its centre \[m\].
        position: [f64; 2],
    },
}

impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Location::Time(time) => write!(f, "at t = {time:?} s"),
            Location::Arguments => f.write_str("of the check"),
            Location::Gap(gap) => write!(f, "at a gap of {gap:?} m"),
            Location::Cell { cell, position } => write!(f, "on cell {cell:?} at {position:?} m"),
        }
    }
}

impl Violation {
    /// The verdict of a law at one time \[s\].
    pub(crate) fn check(
        law: &'static str,
        quantity: &'static str,
        time: f64,
        [found, expected]: [f64; 2],
        holds: bool,
    ) -> Verdict {
        if holds { Ok(()) } else { Err(Violation { law, quantity, at: Location::Time(time), found, expected }) }
    }

    /// Accepts `least` or more finite times, ascending from a time after `bound`.
    pub(crate) fn check_ascending(times: &[f64], least: usize, bound: f64) -> Verdict {
        let law = "(arguments) times are ascending";
        Violation::check_argument(law, "number of times", [times.len() as f64, least as f64], times.len() >= least)?;
        let mut previous = bound;
        for &time in times {
            Violation::check(law, "time", time, [time, previous], time > previous && time.is_finite())?;
            previous = time;
        }
        Ok(())
    }

    /// The verdict on an argument of a check.
    pub(crate) fn check_argument(
        law: &'static str,
        quantity: &'static str,
        [found, expected]: [f64; 2],
        holds: bool,
    ) -> Verdict {
        if holds { Ok(()) } else { Err(Violation { law, quantity, at: Location::Arguments, found, expected }) }
    }
}
