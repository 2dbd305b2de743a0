//! Pictures on surfaces and around the scene, and how they are read.
//!
//! [`texture`] is a picture, [`texels`] how its pixels are kept, [`mipmap`] its smaller versions; [`wrap`] reads between texels and
//! beyond the edges, [`cut_out`] mends colours where nothing is painted, [`srgb`] is the curve of stored values. [`normal_map`]
//! reads directions from it, [`dome_table`] tells where in it light comes from.

mod cut_out;
pub(super) mod dome_table;
mod mipmap;
pub(super) mod normal_map;
pub mod srgb;
mod texels;
mod texture;
mod wrap;

pub use texels::Texels;
pub use texture::{Texture, TextureError};
pub use wrap::Reading;
