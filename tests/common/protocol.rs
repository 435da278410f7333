//! A load history in segments, each of a kind of its own.

use viscocontact::prelude::*;

/// Segments that follow one another: what each starts from need not be what the one before ended with.
#[derive(Debug, Clone, Default)]
pub struct Protocol {
    segments: Vec<(f64, PiecewiseLinear)>,
    end: f64,
}

impl Protocol {
    /// With a further segment of so many seconds, straight from one load to another of its kind.
    pub fn then(mut self, duration: f64, from: Load, to: Load) -> Protocol {
        let table = [(self.end, from), (self.end + duration, to)];
        self.segments.push((self.end, PiecewiseLinear::new(&table).unwrap()));
        self.end += duration;
        self
    }

    pub fn end(&self) -> f64 {
        self.end
    }

    fn segment(&self, started: impl Fn(f64) -> bool) -> &PiecewiseLinear {
        let next = self.segments.partition_point(|segment| started(segment.0));
        &self.segments[next.saturating_sub(1)].1
    }
}

impl LoadHistory for Protocol {
    fn at(&self, t: f64) -> Load {
        self.segment(|start| start <= t).at(t)
    }

    fn before(&self, t: f64) -> Load {
        self.segment(|start| start < t).before(t)
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        self.segments.iter().map(|segment| segment.0).chain([self.end]).find(|&time| time > after)
    }
}
