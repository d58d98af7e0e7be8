//! Views of a mesh: a page for any browser, and pictures without a browser.
//!
//! `scene` is what there is to show (surface, regions, ridges, qualities, fields, names), `cut` which part of it; `page` packs it
//! all into one HTML file, whose JavaScript does the same cut again, and `picture` draws it here, with the parts `camera`, `raster`, `image`, `sheet`
//! (what stands around the scene) and `font`.
mod camera;
pub mod colour;
pub mod cut;
mod font;
mod image;
mod labels;
mod pack;
mod page;
pub mod picture;
mod raster;
mod scene;
pub mod section;
mod sheet;
pub mod streamlines;
mod surface;
mod values;

pub(crate) use pack::base64;
pub use page::{add_page, write_page};
pub use scene::{Given, NamesFile, OfModel, Quality, Scene};
pub use streamlines::Velocity;
pub use values::ScalarField;
