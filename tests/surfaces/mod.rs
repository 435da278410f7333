//! Do rough surfaces and indenters that move press as they must?

mod motion;
mod rough;
mod sliding;
mod sliding_asked;
mod sliding_bodies;
mod sliding_chains;
mod sliding_cost;
mod sliding_limits;
mod steady;
