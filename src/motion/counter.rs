/// What a creeping counter-body does in a steady motion
/// ([`Builder::counter_motion`](crate::contact::Builder::counter_motion)).
///
/// A rubber ball on a rubber of the same kind resists three times as much where it rolls as where
/// it slides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CounterMotion {
    /// It slides with the contact: a steady pressure rests on its own points, which are relaxed.
    Slides,
    /// It rolls: the pressure passes the points of both bodies at the same velocity, and both
    /// creep.
    Rolls,
}
