//! The domain of a plan, and the contact in it.

use std::fmt;

use crate::error::{Error, Result, StepError};
use crate::extent::Extent;
use crate::{Grid, InfluenceKernel};

/// Cells across the widest contact on the coarsest mesh, where the steps are found.
pub(super) const LEAST_ACROSS: f64 = 16.0;
/// Growth factor of a domain whose edge the contact reaches on a finer mesh, and the greatest number of growths.
const GROWTH: f64 = 1.2;
const MAX_GROWTHS: u32 = 5;
/// Ratio of the domain to the rectangle of the contact.
const DOMAIN_TO_CONTACT: f64 = 1.12;

/// A side of the domain.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) enum Side {
    /// As long as the contact needs.
    #[default]
    Found,
    /// A period \[m\].
    Period(f64),
    /// One cell \[m\], along which nothing changes.
    Uniform(f64),
}

/// The kernel of a body on a grid.
pub(super) type KernelOf<'a> = &'a dyn Fn(&Grid) -> Result<InfluenceKernel>;

/// The body of a plan: its kernel on a grid, a half-space by default, and the sides of its domain.
#[derive(Clone, Copy, Default)]
pub(super) struct Body<'a> {
    pub(super) kernel: Option<KernelOf<'a>>,
    pub(super) sides: [Side; 2],
}

impl fmt::Debug for Body<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Body").field("sides", &self.sides).finish_non_exhaustive()
    }
}

/// Size of the contact during a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct ContactSize {
    pub(super) sides: [Side; 2],
    /// Half sides of the rectangle about the origin that contained the contact.
    pub(super) reach: [f64; 2],
    /// Greatest widths of the contact at any one time.
    pub(super) width: [f64; 2],
}

impl ContactSize {
    /// No contact yet.
    pub(super) fn none(sides: [Side; 2]) -> ContactSize {
        ContactSize { sides, ..ContactSize::default() }
    }

    /// Includes the contact at one time.
    pub(super) fn include(&mut self, grid: &Grid, Extent { low, high }: Extent) {
        let (first, last) = (grid.center(low[0], low[1]), grid.center(high[0], high[1]));
        for axis in 0..2 {
            let (side, ContactSize { reach, width, .. }) = (grid.spacing()[axis], &mut *self);
            reach[axis] = reach[axis].max(first[axis].abs().max(last[axis].abs()) + 0.5 * side);
            width[axis] = width[axis].max((high[axis] + 1 - low[axis]) as f64 * side);
        }
    }

    fn lengths(&self) -> [f64; 2] {
        [0, 1].map(|axis| match self.sides[axis] {
            Side::Found => 2.0 * DOMAIN_TO_CONTACT * self.reach[axis],
            Side::Period(length) | Side::Uniform(length) => length,
        })
    }

    /// Cells along the sides with `across` cells across the widest contact.
    pub(super) fn cells(&self, across: f64) -> [f64; 2] {
        let lengths = self.lengths();
        [0, 1].map(|axis| match self.sides[axis] {
            Side::Uniform(_) => 1.0,
            _ => across * lengths[axis] / self.width[axis],
        })
    }

    /// The grid with `across` cells across the widest contact.
    pub(super) fn grid(&self, across: f64) -> Result<Grid> {
        let cells = self.cells(across);
        let cells = [0, 1].map(|axis| match self.sides[axis] {
            Side::Uniform(_) => 1,
            _ => smooth_size(cells[axis].ceil() as usize),
        });
        Grid::new(cells, self.lengths())
    }

    /// Runs `compute` on domains that grow until they contain the contact.
    pub(super) fn on_growing_domain<T>(&self, compute: impl Fn(&ContactSize) -> Result<T>) -> Result<T> {
        let mut size = *self;
        for _ in 0..MAX_GROWTHS {
            match compute(&size) {
                Err(Error::Step(StepError::ContactAtEdge { .. })) => size.reach = size.reach.map(|half| GROWTH * half),
                other => return other,
            }
        }
        compute(&size)
    }
}

/// The next even number of cells without prime factors above 5, for fast transforms.
fn smooth_size(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (least..).find(|&n| n.is_multiple_of(2) && smooth(n)).unwrap_or(least)
}
