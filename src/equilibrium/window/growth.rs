//! The search for a region that holds the whole contact.

use crate::equilibrium::{Ground, Held, Region};
use crate::error::{Error, Result, StepError};

/// What solves for an equilibrium on a region, and can continue in a copy of itself on another one.
pub(crate) trait OnRegion: Sized {
    /// What is asked for.
    type Asked<'a>: Copy;

    fn held(&mut self) -> &mut Held;

    /// Solves on the present region: writes the trial.
    fn solve(&mut self, asked: Self::Asked<'_>) -> Result<()>;

    /// A larger region, if the bodies of the trial might touch outside this one.
    fn outgrown(&self, asked: Self::Asked<'_>) -> Option<Region>;

    /// Σ p of the trial, if it can be accepted.
    fn acceptable(&self, asked: Self::Asked<'_>) -> Result<f64>;

    /// A copy on another region, on which it holds the same equilibrium.
    fn transferred_to(&mut self, asked: Self::Asked<'_>, region: Region) -> Result<Box<Self>>;
}

/// Solves in `own`, or in a copy on the first `larger` region that contains the whole contact. The solution begins on
/// the region `placed`, and whether that was chosen for a contact, if there is one. Returns Σ p.
pub(crate) fn solve_on_growing_region<C: OnRegion>(
    ground: &Ground,
    own: &mut C,
    larger: &mut Option<Box<C>>,
    placed: Option<(Region, bool)>,
    asked: C::Asked<'_>,
) -> Result<f64> {
    if let Some((region, is_for_contact)) = placed {
        let transferred = larger.insert(own.transferred_to(asked, region)?);
        transferred.held().region_is_for_contact = is_for_contact;
    }
    loop {
        let at = larger.as_deref_mut().unwrap_or(&mut *own);
        let grown = match at.solve(asked) {
            Ok(()) => at.outgrown(asked),
            // the load acts inside the hull of the body, but outside the hull of its cells in the window
            Err(Error::Step(StepError::LoadOutsideHull { .. })) if !at.held().region.covers() => {
                Some(Region::whole(&ground.grid, at.held().region.folded()))
            }
            Err(error) => return Err(error),
        };
        let Some(region) = grown else { return at.acceptable(asked) };
        *larger = Some(at.transferred_to(asked, region)?);
    }
}
