use crate::ascending::TimeTable;
use crate::error::{Error, Refusal, Result};
use crate::load::{Load, LoadHistory};

/// Loads at given times, linear in between and constant before the first and after the last. Two entries at the
/// same time are a jump.
///
/// ```
/// use viscocontact::load::{Load, LoadHistory, PiecewiseLinear};
///
/// let table = [(0.0, Load::force(0.0)), (1.0, Load::force(4.0)), (1.0, Load::force(1.0)), (2.0, Load::force(1.0))];
/// let history = PiecewiseLinear::new(&table)?;
/// assert_eq!(history.at(0.5), Load::force(2.0));
/// assert_eq!((history.before(1.0), history.at(1.0)), (Load::force(4.0), Load::force(1.0)));
/// assert_eq!(history.next_breakpoint(0.5), Some(1.0));
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PiecewiseLinear {
    table: TimeTable<Load>,
}

/// The error of loads between which nothing is linear.
pub(super) fn mixed(field: &'static str, first: [&str; 2], second: [&str; 2]) -> Error {
    let [first, second] = [first, second].map(|kind| kind.join(", "));
    let what = format!("the {field} mixes loads of different kinds ({first}; {second}), which cannot be interpolated");
    let remedy = ": take loads of one kind, and a run for each kind";
    Refusal::value("load_mixed_kinds", what, remedy).naming(field).into()
}

impl PiecewiseLinear {
    /// The history through `table`: (time \[s\], load), times not decreasing.
    ///
    /// # Errors
    /// If there are fewer than two entries, a time is not finite or earlier than the one before, three
    /// entries share a time, a load is invalid, or the loads are of different kinds.
    pub fn new(table: &[(f64, Load)]) -> Result<PiecewiseLinear> {
        let times = "load table times";
        let checked = TimeTable::new(["load table", times], table, 2)?;
        Load::validate_all("load table", table.iter().map(|entry| entry.1))?;
        if let Some(k) = table.windows(3).position(|three| three[0].0 == three[2].0) {
            let (value, rule) = (table[k].0, "occur at most twice, where the load jumps");
            return Err(Error::OutOfOrder { field: times, index: k + 2, value, previous: value, rule });
        }
        Ok(PiecewiseLinear { table: checked })
    }
}

impl LoadHistory for PiecewiseLinear {
    fn at(&self, t: f64) -> Load {
        self.table.at(t, |from, to, share| from.towards(&to, share))
    }

    fn before(&self, t: f64) -> Load {
        self.table.before(t, |from, to, share| from.towards(&to, share))
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        self.table.after(after)
    }
}
