use super::{Picture, Sum};
use glam::{UVec2, Vec3};

/// Edge of a square tile in pixels: 256 pixels of one sample each fill a batch, and the arrays of a
/// batch stay within a core's second-level cache.
pub const TILE: u32 = 16;

/// Sums and counts of every pixel, tile by tile, so that a tile is one piece of memory that a
/// thread can have to itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    size: UVec2,
    pixels: Vec<FilmPixel>,
}

/// One pixel: what arrived, and how many samples it took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct FilmPixel {
    pub sum: Sum,
    pub count: u32,
}

impl Film {
    /// An empty film of `size` pixels.
    pub fn new(size: UVec2) -> Self {
        let tiles = size.map(|n| n.div_ceil(TILE));
        let pixels = tiles.x as usize * tiles.y as usize * (TILE * TILE) as usize;
        Self {
            size,
            pixels: vec![FilmPixel::default(); pixels],
        }
    }

    /// In pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The tiles, each with its pixels' memory.
    pub(super) fn tiles_mut(&mut self) -> impl Iterator<Item = (Tile, &mut [FilmPixel])> {
        let size = self.size;
        let columns = size.x.div_ceil(TILE).max(1);
        self.pixels
            .chunks_exact_mut((TILE * TILE) as usize)
            .enumerate()
            .map(move |(i, pixels)| {
                let i = i as u32;
                let origin = UVec2::new(i % columns, i / columns) * TILE;
                let extent = (size - origin).min(UVec2::splat(TILE));
                (Tile { origin, extent }, pixels)
            })
    }

    /// The mean of every pixel's samples.
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::black(self.size);
        for y in 0..self.size.y {
            for x in 0..self.size.x {
                let pixel = &self.pixels[self.place(x, y)];
                picture.pixels[y as usize * self.size.x as usize + x as usize] =
                    pixel.sum.mean(pixel.count);
            }
        }
        picture
    }

    /// The mean of one pixel's samples.
    pub fn mean(&self, x: u32, y: u32) -> Vec3 {
        let pixel = &self.pixels[self.place(x, y)];
        pixel.sum.mean(pixel.count)
    }

    fn place(&self, x: u32, y: u32) -> usize {
        let columns = self.size.x.div_ceil(TILE) as usize;
        let tile = (y / TILE) as usize * columns + (x / TILE) as usize;
        tile * (TILE * TILE) as usize + ((y % TILE) * TILE + x % TILE) as usize
    }
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tile {
    /// Its top left pixel.
    pub origin: UVec2,
    /// Columns and rows of it that lie in the picture.
    pub extent: UVec2,
}

impl Tile {
    /// Its pixels, each with its place in the tile's memory.
    pub fn pixels(self) -> impl Iterator<Item = (UVec2, usize)> {
        (0..self.extent.y).flat_map(move |y| {
            (0..self.extent.x)
                .map(move |x| (self.origin + UVec2::new(x, y), (y * TILE + x) as usize))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once_whatever_the_size() {
        for size in [UVec2::new(1, 1), UVec2::new(16, 16), UVec2::new(37, 18)] {
            let mut film = Film::new(size);
            for (tile, pixels) in film.tiles_mut() {
                for (at, place) in tile.pixels() {
                    pixels[place]
                        .sum
                        .add(Vec3::new(at.x as f32, at.y as f32, 1.0));
                    pixels[place].count += 1;
                }
            }
            let picture = film.picture();
            for y in 0..size.y {
                for x in 0..size.x {
                    assert_eq!(picture.pixel(x, y), Vec3::new(x as f32, y as f32, 1.0));
                    assert_eq!(film.mean(x, y), picture.pixel(x, y));
                }
            }
        }
    }
}
