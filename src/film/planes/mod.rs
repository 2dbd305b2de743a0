//! A film of planes: what each tile holds, its light kept apart or not.
//!
//! [`plane_sums`] is one plane of a tile, [`tile_planes`] all of them and the picture that they are, [`tile_state`] the tile while
//! it is rendered, with what is on its way to it; [`tiled_film`] is what a render leaves, [`per_pixel`] what a film knows of
//! each pixel besides.

mod per_pixel;
mod plane_sums;
mod tile_planes;
pub(super) mod tile_state;
pub(super) mod tiled_film;

pub use per_pixel::PixelError;
pub use tiled_film::Film;
