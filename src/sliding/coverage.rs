//! What steady motions do not cover, and what to do in place of each.

use crate::error::Special::SteadyMotion;
use crate::error::coverage::not_covered;

not_covered! {
    COEFFICIENTS: "a body of coefficients", SteadyMotion: "take InfluenceKernel::from_spectrum or a layer";
    JUMPING_SHAPE: "a shape that jumps once in the period of its body",
        SteadyMotion: "take one that repeats, or taper its ends";
    MODULUS: "a modulus over frequency, of a body that is not periodic along both axes,",
        SteadyMotion: "fit a series to it";
    MODULUS_OF_TWO: "a counter-body beside a modulus over frequency",
        SteadyMotion: "add its compliance to that of the modulus";
    COUNTER_BODY: "a counter-body that creeps, of which it is not said whether it slides or rolls,",
        SteadyMotion: "say it by Builder::counter_motion";
    FLOWING_COUNTER: "a counter-body that slides and flows",
        SteadyMotion: "give it an equilibrium modulus, or let it roll";
    FLOW: "a body that flows",
        SteadyMotion: "take a half-space, or an equilibrium modulus: one approach or slope grows for ever";
    DRIFT: "a body that flows, under an approach or at rest,", SteadyMotion: "give a force and a velocity";
    SPRING: "a body on a spring", SteadyMotion: "give the force or the approach";
    NEAR_DATUM: "a line load of given approach whose datum is nearer than the grid and the longest memory of the \
        motion",
        SteadyMotion: "give the force, or a datum farther away";
    OBLIQUE: "a motion that follows neither x1 nor x2, over a body that is not periodic along both,",
        SteadyMotion: "turn the shape instead";
}
