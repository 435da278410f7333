//! Pictures of contacts and runs, one line of code each. Feature `plot`.
//!
//! | picture | call |
//! |---|---|
//! | pressure, gap, displacement or traction as a map | [`Map::of`] |
//! | any field as a map | [`Map::new`] |
//! | the stress below the surface, on a section | [`Map::section`] |
//! | an outline on any map | [`Map::outline`] |
//! | maps, charts, or both side by side | [`Map::draw_row`], [`Picture::beside`] |
//! | a profile along a line | [`Chart::profile`] |
//! | quantities over time | [`Chart::history`] |
//! | any curves, a family coloured by its parameter | [`Chart`], [`Chart::add_family`] |
//! | an animation of a run | [`Animation`] |
//! | a convergence study | `StudyResult::chart` |
//! | a sweep of steady motions | `SlidingTable::chart` |
//!
//! ```
//! use viscocontact::plot::{Animation, Chart, Map, Quantity};
//! use viscocontact::{output::Field, prelude::*};
//!
//! let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
//!     .geometry(&Sphere::new(10.0e-3)?)
//!     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
//!     .build()?;
//! # let folder = std::env::temp_dir().join(format!("viscocontact-doc-plot-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder).unwrap();
//! let (mut times, mut areas) = (Vec::new(), Vec::new());
//! let mut animation = Animation::create(folder.join("run.gif"), Field::Pressure, [0.0, 0.5e6], 0.2)?;
//! for dt in [0.0, 0.5, 0.5] {
//!     contact.step(dt, Load::force(1.0))?;
//!     times.push(contact.time());
//!     areas.push(contact.contact_area());
//!     animation.record(&contact)?;
//! }
//! animation.finish()?;
//! Map::of(&contact, Field::Pressure)?.save(folder.join("pressure.png"))?;
//! Chart::history("", &times, Quantity::new("contact area", "m²"), &[("", &areas)])?.save(folder.join("area.png"))?;
//! # std::fs::remove_dir_all(&folder).unwrap();
//! # Ok::<(), Error>(())
//! ```
//!
//! Files are PNG or SVG, by their extension. Values are given in SI; axes and colour bars choose the prefix that
//! keeps numbers short ([`Quantity`]; [`measure`] for titles and legends). The colours can be distinguished without
//! colour vision. The font is compiled in: no system font is needed.

mod animation;
mod axis;
mod canvas;
mod chart;
mod color;
mod color_bar;
mod contact;
mod curve;
mod font;
mod frame;
mod history;
mod legend;
mod map;
mod palette;
mod picture;
mod quantity;
#[cfg(feature = "stress")]
mod section;
mod sizes;
#[cfg(feature = "sliding")]
mod sliding;
#[cfg(feature = "study")]
mod study;

pub use animation::Animation;
pub use chart::{Chart, Scale};
pub use color::{COLORS, Color, ColorScale};
pub use curve::{Legend, Style};
pub use map::Map;
pub use picture::Picture;
pub use quantity::{Quantity, measure};

use axis::{DrawnAxis, Room};
use canvas::{Anchor, Canvas};
use frame::Frame;
use quantity::{color_scale, drawable};
