//! A motion over the bodies by whole cells, as far as to its steady state.

use viscocontact::prelude::*;

/// What a march took.
#[derive(Debug, Clone, Copy, Default)]
pub struct March {
    pub steps: usize,
    pub convolutions: usize,
    /// Distance travelled [m].
    pub distance: f64,
}

/// Most contact lengths by cells.
const MOST_LENGTHS: usize = 1000;

/// Moves the indenter by a `track` [m] along an axis in strides of an eighth of the contact, which are cheap and whose
/// errors decay, then in shorter ones, at last by cells, until the pressure changes by less than `tolerance` on the way
/// of a contact length. Slow creep changes the pressure slowly: the track should be several v τ long.
pub fn march(
    contact: &mut ViscoelasticContact,
    axis: Axis,
    velocity: f64,
    load: Load,
    (track, tolerance): (f64, f64),
) -> viscocontact::Result<March> {
    let side = contact.grid().spacing()[axis.index()];
    let mut took = March::default();
    contact.step(side / velocity.abs(), load)?;
    let mut travel = |contact: &mut ViscoelasticContact, stride: usize, cells: usize| -> viscocontact::Result<()> {
        let mut by = [0; 2];
        by[axis.index()] = velocity.signum() as isize * stride as isize;
        for _ in 0..cells.div_ceil(stride) {
            let report = contact.step_over(by, stride as f64 * side / velocity.abs(), load)?;
            took.steps += 1;
            took.convolutions += report.convolutions;
            took.distance += stride as f64 * side;
        }
        Ok(())
    };
    let mut stride = 1 << (length_of_contact(contact, axis) / 8).max(1).ilog2();
    travel(contact, stride, (track / side) as usize)?;
    while stride > 1 {
        stride /= 2;
        travel(contact, stride, 2 * length_of_contact(contact, axis))?;
    }
    for _ in 0..MOST_LENGTHS {
        let before = contact.pressure().to_vec();
        travel(contact, 1, length_of_contact(contact, axis))?;
        let change: f64 = contact.pressure().iter().zip(&before).map(|(now, before)| (now - before).abs()).sum();
        if change <= tolerance * contact.pressure().iter().sum::<f64>() {
            return Ok(took);
        }
    }
    panic!("the pressure still changes after {MOST_LENGTHS} lengths of the contact")
}

/// Cells between the ends of the contact along an axis.
fn length_of_contact(contact: &ViscoelasticContact, axis: Axis) -> usize {
    let n2 = contact.grid().cells()[1];
    let pressed = contact.pressure().iter().enumerate().filter(|(_, p)| **p > 0.0);
    let places = pressed.map(|(k, _)| [k / n2, k % n2][axis.index()]);
    let [low, high] = places.fold([usize::MAX, 0], |[low, high], at| [low.min(at), high.max(at)]);
    (high + 1).saturating_sub(low).max(1)
}
