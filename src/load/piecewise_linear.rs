use crate::error::{Error, Result, finite, least_length};
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
    table: Vec<(f64, Load)>,
}

impl PiecewiseLinear {
    /// The history through `table`: (time \[s\], load), times not decreasing.
    ///
    /// # Errors
    /// If there are fewer than two entries, a time is not finite or earlier than the one before, three
    /// entries share a time, a load is invalid, or the loads are of different kinds.
    pub fn new(table: &[(f64, Load)]) -> Result<PiecewiseLinear> {
        least_length("load table", table.len(), 2)?;
        for &(time, _) in table {
            finite("time in the load table", time)?;
        }
        Load::validate_all("load table", table.iter().map(|entry| entry.1))?;
        for (index, pair) in (1..).zip(table.windows(2)) {
            let (field, previous, value) = ("load table times", pair[0].0, pair[1].0);
            let disorder = |rule| Error::OutOfOrder { field, index, value, previous, rule };
            if value < previous {
                return Err(disorder("not decrease"));
            }
            if index > 1 && value == table[index - 2].0 {
                return Err(disorder("occur at most twice, where the load jumps"));
            }
        }
        Ok(PiecewiseLinear { table: table.to_vec() })
    }

    /// Interpolates between entry `next` − 1 and entry `next`; constant beyond the ends of the table.
    fn around(&self, next: usize, t: f64) -> Load {
        match (next.checked_sub(1).map(|k| self.table[k]), self.table.get(next)) {
            (Some((start, from)), Some(&(end, ref to))) if end > start => from.towards(to, (t - start) / (end - start)),
            (Some((_, load)), _) => load,
            (None, _) => self.table[0].1,
        }
    }
}

impl LoadHistory for PiecewiseLinear {
    fn at(&self, t: f64) -> Load {
        self.around(self.table.partition_point(|entry| entry.0 <= t), t)
    }

    fn before(&self, t: f64) -> Load {
        self.around(self.table.partition_point(|entry| entry.0 < t), t)
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        self.table.get(self.table.partition_point(|entry| entry.0 <= after)).map(|entry| entry.0)
    }
}
