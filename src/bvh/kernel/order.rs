//! What the rays of a batch have to do with each other.

/// How the rays of a batch follow each other. It says nothing about what they hit: a wrong one costs time, and changes no
/// bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// Any rays: each is walked alone.
    #[default]
    None,
    /// Rays of neighbouring pixels, tile by tile: sixteen in a row are a tile of 4 x 4, or samples of one pixel.
    Tile,
    /// Shadow rays from neighbouring points towards one light, best to one part of it after another.
    Light,
}
