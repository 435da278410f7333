//! Counts beyond those of MPI, which have 32 bits: parts of all ranks, sent in several calls.

use std::ops::Range;

/// The most numbers of one call.
pub(crate) const MOST: usize = i32::MAX as usize;

/// Parts of a buffer that follow each other, one for each rank, cut into pieces.
pub(crate) struct Chunks {
    counts: Vec<usize>,
    starts: Vec<usize>,
    /// Most numbers of a part in one call.
    piece: usize,
}

impl Chunks {
    /// Parts of so many numbers, at most `most` in one call.
    pub(crate) fn new(counts: &[usize], most: usize) -> Chunks {
        let mut next = 0;
        let start = |count: &usize| {
            next += count;
            next - count
        };
        let starts = counts.iter().map(start).collect();
        Chunks { counts: counts.to_vec(), starts, piece: (most / counts.len().max(1)).max(1) }
    }

    /// Number of calls that the longest part takes.
    pub(crate) fn calls(&self) -> usize {
        self.counts.iter().map(|count| count.div_ceil(self.piece)).max().unwrap_or(0)
    }

    /// The most numbers in a call.
    pub(crate) fn longest(&self) -> usize {
        self.counts.iter().map(|&count| count.min(self.piece)).sum()
    }

    /// Counts and starts where one call is enough.
    pub(crate) fn whole(&self) -> (Vec<i32>, Vec<i32>) {
        let narrow = |values: &[usize]| values.iter().map(|&value| value as i32).collect();
        (narrow(&self.counts), narrow(&self.starts))
    }

    /// Counts and starts of a call, in a buffer of what is sent in it.
    pub(crate) fn of(&self, call: usize) -> (Vec<i32>, Vec<i32>) {
        let counts: Vec<usize> = (0..self.counts.len()).map(|rank| self.range(rank, call).len()).collect();
        Chunks::new(&counts, MOST).whole()
    }

    /// The numbers of a rank's part that are sent in a call.
    pub(crate) fn range(&self, rank: usize, call: usize) -> Range<usize> {
        let end = self.counts[rank];
        (call * self.piece).min(end)..((call + 1) * self.piece).min(end)
    }

    /// Copies what is sent in a call from the parts.
    pub(crate) fn copy_in<T: Copy>(&self, call: usize, parts: &[T], sent: &mut [T]) {
        let mut next = 0;
        for (rank, start) in self.starts.iter().enumerate() {
            let range = self.range(rank, call);
            sent[next..next + range.len()].copy_from_slice(&parts[start + range.start..start + range.end]);
            next += range.len();
        }
    }

    /// Copies what was received in a call to the parts.
    pub(crate) fn copy_out<T: Copy>(&self, call: usize, received: &[T], parts: &mut [T]) {
        let mut next = 0;
        for (rank, start) in self.starts.iter().enumerate() {
            let range = self.range(rank, call);
            parts[start + range.start..start + range.end].copy_from_slice(&received[next..next + range.len()]);
            next += range.len();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the counts and the length of a call, all numbers come through, in their order.
    #[test]
    fn parts_come_through_in_pieces() {
        for counts in [vec![0, 0], vec![5], vec![3, 0, 11], vec![7, 8, 9, 1], vec![0, 100]] {
            let parts: Vec<usize> = (0..counts.iter().sum()).collect();
            for most in [1, 4, 10, 1000] {
                let chunks = Chunks::new(&counts, most);
                let (mut buffer, mut back) = (vec![usize::MAX; chunks.longest()], vec![usize::MAX; parts.len()]);
                assert!(chunks.longest() <= most.max(counts.len()));
                for call in 0..chunks.calls() {
                    chunks.copy_in(call, &parts, &mut buffer);
                    let (lengths, starts) = chunks.of(call);
                    assert!(
                        starts.iter().zip(&lengths).all(|(start, length)| (start + length) as usize <= buffer.len())
                    );
                    chunks.copy_out(call, &buffer, &mut back);
                }
                assert_eq!(back, parts, "{counts:?} {most}");
            }
        }
    }
}
