//! The residuals of a solve, in memory of fixed size.

/// Number of residuals that are stored.
const MAX_SAMPLES: usize = 32;

/// Residuals over the iterations of one solve, as pairs of an iteration and its residual. When the memory is full,
/// every second sample is dropped, and from then on half as many are stored: the samples are always spread over the
/// whole solve.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Trace {
    samples: [(u32, f64); MAX_SAMPLES],
    len: usize,
    /// How often samples were dropped: every 2^`halvings`-th iteration is stored.
    halvings: u32,
    last: (u32, f64),
}

impl Trace {
    pub(crate) fn clear(&mut self) {
        (self.len, self.halvings) = (0, 0);
    }

    /// Adds the residual after some iterations.
    pub(crate) fn note(&mut self, iterations: usize, residual: f64) {
        self.last = (u32::try_from(iterations).unwrap_or(u32::MAX), residual);
        if self.len == MAX_SAMPLES && iterations.is_multiple_of(1 << self.halvings) {
            self.halvings += 1;
            self.len = MAX_SAMPLES / 2;
            (1..self.len).for_each(|k| self.samples[k] = self.samples[2 * k]);
        }
        if iterations.is_multiple_of(1 << self.halvings) {
            self.samples[self.len] = self.last;
            self.len += 1;
        }
    }

    /// Iterations and residuals, the last one included.
    pub(crate) fn samples(&self) -> Vec<(usize, f64)> {
        let mut samples = self.samples[..self.len].to_vec();
        if samples.last().is_some_and(|last| last.0 != self.last.0) {
            samples.push(self.last);
        }
        samples.into_iter().map(|(iterations, residual)| (iterations as usize, residual)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_spreads_over_any_number_of_iterations() {
        for count in [1, 5, 32, 33, 100, 1000, 100_000] {
            let mut trace = Trace::default();
            (0..count).for_each(|k| trace.note(k, 1.0 / (k + 1) as f64));
            let samples = trace.samples();
            assert!(
                samples.len() <= MAX_SAMPLES + 1 && samples.len() >= count.min(MAX_SAMPLES / 2),
                "{count}: {}",
                samples.len()
            );
            assert_eq!((samples[0].0, samples[samples.len() - 1].0), (0, count - 1));
            let longest = samples.windows(2).map(|pair| pair[1].0 - pair[0].0).max().unwrap_or(1);
            assert!(longest <= (count / 8).max(1), "{count}: {longest}");
            assert!(samples.iter().all(|&(k, residual)| residual == 1.0 / (k + 1) as f64));
            trace.clear();
            assert!(trace.samples().is_empty());
        }
    }
}
