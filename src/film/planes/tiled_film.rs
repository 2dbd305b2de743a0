//! What a render leaves: sums and counts of every pixel.

use super::plane_sums::PlaneSums;
use crate::film::errors::past_moves::PastMoves;
use crate::film::sums::sum_columns::{CHANNELS, SumColumns, TileColors};
use crate::film::sums::tiles::{Pixels, TILE, TILE_PIXELS, Tile, TileGrid, half_of, place_in_tile};
use crate::film::{Picture, Sum};
use glam::{UVec2, Vec3};

/// Sums and counts of every pixel, tile by tile, so that a tile is one piece of memory that a
/// thread can have to itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    size: UVec2,
    tiles: Vec<FilmTile>,
    /// The squared error that unmet features may leave in a pixel, per [`Reach`](crate::film::errors::unmet::Reach) of a
    /// sample, if they lie in all alike.
    pub(in crate::film) hidden: f64,
}

impl Film {
    /// An empty film of `size` pixels.
    pub fn new(size: UVec2) -> Self {
        let tiles = TileGrid::new(size).count() as usize;
        Self::from_tiles(size, vec![FilmTile::default(); tiles], 0.0)
    }

    /// In pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The film of these tiles, in the grid's order. `hidden` is what unmet features may leave in a
    /// pixel, per reach of a sample.
    pub(in crate::film) fn from_tiles(size: UVec2, tiles: Vec<FilmTile>, hidden: f64) -> Self {
        Self {
            size,
            tiles,
            hidden,
        }
    }

    /// The mean of every pixel's samples.
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::black(self.size);
        for (tile, pixels) in TileGrid::new(self.size).tiles().zip(&self.tiles) {
            let first = tile.origin.y as usize * self.size.x as usize;
            let rows = &mut picture.pixels[first..];
            draw(&pixels.means(), tile, rows, self.size.x as usize);
        }
        picture
    }

    /// The mean of one pixel's samples.
    pub fn mean(&self, x: u32, y: u32) -> Vec3 {
        self.sum(x, y).mean(self.count(x, y))
    }

    /// A film whose pixels hold these sums, row by row from the top, of `count` samples each. `None`
    /// where there are more or fewer sums than pixels.
    pub fn of_sums(size: UVec2, sums: &[Sum], count: u32) -> Option<Self> {
        let columns = size.x as usize;
        if sums.len() != columns * size.y as usize {
            return None;
        }
        let grid = TileGrid::new(size);
        let tiles = grid.tiles().map(|tile| {
            let sum = |(pixel, place): (UVec2, usize)| {
                let at = pixel.y as usize * columns + pixel.x as usize;
                (place, sums[at])
            };
            FilmTile::of_sums(tile.pixels().map(sum), count)
        });
        Some(Self::from_tiles(size, tiles.collect(), 0.0))
    }

    /// The sum of a pixel's samples.
    pub fn sum(&self, x: u32, y: u32) -> Sum {
        let (tile, place) = self.place(x, y);
        tile.sum(place)
    }

    /// Adds the samples of another film of the same size. False, and nothing done, for another size.
    /// Of the sum of two parts the error is not known: neither part tells how far it would have moved.
    pub fn merge(&mut self, other: &Self) -> bool {
        if self.size != other.size {
            return false;
        }
        for (tile, other) in self.tiles.iter_mut().zip(&other.tiles) {
            tile.merge(other);
        }
        self.hidden = self.hidden.max(other.hidden);
        true
    }

    /// How many samples a pixel has.
    pub fn count(&self, x: u32, y: u32) -> u32 {
        let (tile, place) = self.place(x, y);
        tile.count(place)
    }

    /// The tile with this number.
    pub(in crate::film) fn tile(&self, number: usize) -> &FilmTile {
        &self.tiles[number]
    }

    /// The tile that a pixel lies in, and where in its memory.
    fn place(&self, x: u32, y: u32) -> (&FilmTile, usize) {
        let tile = TileGrid::new(self.size).tile_of(UVec2::new(x, y));
        (&self.tiles[tile], place_in_tile(x % TILE, y % TILE))
    }
}

/// The pixels of a tile: what arrived, and how many samples it took.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::film) struct FilmTile {
    /// None where nothing arrived.
    pub sums: PlaneSums,
    pub past: PastMoves,
    /// Samples of each pixel of each half.
    pub counts: [u32; 2],
}

impl FilmTile {
    /// Pixels with these sums, of so many samples each.
    pub fn of_sums(sums: impl IntoIterator<Item = (usize, Sum)>, count: u32) -> Self {
        let mut columns = SumColumns::default();
        columns.reset(TILE_PIXELS);
        for (place, sum) in sums {
            columns.set(place, &sum);
        }
        let mut past = PastMoves::default();
        past.forget(Pixels::All);
        Self {
            sums: columns.into(),
            past,
            counts: [count; 2],
        }
    }

    pub fn sum(&self, place: usize) -> Sum {
        self.sums.get(place)
    }

    pub fn count(&self, place: usize) -> u32 {
        self.counts[half_of(place)]
    }

    /// The means of all its pixels; black where nothing arrived.
    pub fn means(&self) -> TileColors {
        self.sums.means(self.counts)
    }

    /// Adds the samples of another one.
    pub fn merge(&mut self, other: &Self) {
        for half in 0..2 {
            let pixels = Pixels::Half(half);
            match (self.counts[half], other.counts[half]) {
                (_, 0) => {}
                (0, _) => self.past.copy(pixels, &other.past),
                _ => self.past.forget(pixels),
            }
            self.counts[half] += other.counts[half];
        }
        self.sums.merge(&other.sums);
    }
}

/// Draws a tile with these means into rows of a picture, `width` pixels each, of which the first is the tile's first.
pub(in crate::film) fn draw(means: &TileColors, tile: Tile, rows: &mut [Vec3], width: usize) {
    let Tile { origin, extent } = tile;
    for (y, row) in (0..extent.y).zip(rows.chunks_mut(width)) {
        let row = &mut row[origin.x as usize..][..extent.x as usize];
        for (x, pixel) in (0..extent.x).zip(row) {
            let at = CHANNELS * place_in_tile(x, y);
            *pixel = Vec3::new(means[at], means[at + 1], means[at + 2]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_of_sums_has_each_at_its_pixel_whatever_the_size() {
        for size in [UVec2::new(1, 1), UVec2::new(16, 16), UVec2::new(37, 18)] {
            let pixels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y)));
            let value = |pixel: UVec2| pixel.as_vec2().extend(1.0);
            let sum = |pixel: UVec2| {
                let mut sum = Sum::default();
                sum.add(value(pixel));
                sum
            };
            let sums: Vec<Sum> = pixels.clone().map(sum).collect();
            let film = Film::of_sums(size, &sums, 1).expect("a sum for each pixel");
            let picture = film.picture();
            for pixel in pixels {
                let UVec2 { x, y } = pixel;
                assert_eq!(picture.pixel(x, y), value(pixel));
                assert_eq!(film.mean(x, y), value(pixel));
                assert_eq!((film.sum(x, y), film.count(x, y)), (sum(pixel), 1));
            }
            assert_eq!(Film::of_sums(size, &sums[1..], 1), None);
        }
    }
}
