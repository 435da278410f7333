//! Does a pressure displace the surface as the theory says, on every kind of body?

mod coefficients;
mod half_space;
mod layers;
mod love;
mod other_bodies;
