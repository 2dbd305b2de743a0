use bevy::math::URect;
use glam::{UVec2, Vec2};
use std::ops::Range;

/// Edge of a square tile in pixels: 256 pixels of one sample each fill a batch, and the arrays of a
/// batch stay within a core's second-level cache.
pub const TILE: u32 = 16;
pub(in crate::film) const TILE_PIXELS: usize = (TILE * TILE) as usize;

/// Edge of a block in pixels: the rays of its pixels walk the trees together, and what moved in it says how far its pixels are
/// from the converged ones; the means of a single pixel move too much by chance.
pub(in crate::film) const BLOCK: u32 = 4;
pub(in crate::film) const BLOCK_PIXELS: usize = (BLOCK * BLOCK) as usize;
/// Blocks along a tile's edge.
const BLOCKS: u32 = TILE / BLOCK;

/// Pixels of a block of each half: those with x + y even are one half of a picture, the others the other one. Adaptive
/// sampling gives one half the samples that the other half asks for.
pub(in crate::film) const HALF_PIXELS: usize = BLOCK_PIXELS / 2;

/// Where a pixel of a tile, at this column and this row of it, lies in the tile's memory: block by block, and in each block
/// first one half and then the other, so that the same is done to all pixels that lie beside one another.
#[inline(always)]
pub(in crate::film) const fn place_in_tile(x: u32, y: u32) -> usize {
    let block = y / BLOCK * BLOCKS + x / BLOCK;
    let half = (x + y) % 2;
    let within = y % BLOCK * (BLOCK / 2) + x % BLOCK / 2;
    block as usize * BLOCK_PIXELS + half as usize * HALF_PIXELS + within as usize
}

/// Column and row of the pixel at a place of a tile's memory.
#[inline(always)]
pub(in crate::film) fn pixel_in_tile(place: usize) -> UVec2 {
    static PIXELS: [UVec2; TILE_PIXELS] = {
        let mut pixels = [UVec2::ZERO; TILE_PIXELS];
        let mut place = 0;
        while place < TILE_PIXELS {
            pixels[place] = pixel_of(place);
            place += 1;
        }
        pixels
    };
    PIXELS[place]
}

/// The same, worked out.
const fn pixel_of(place: usize) -> UVec2 {
    let (block, half) = ((place / BLOCK_PIXELS) as u32, half_of(place) as u32);
    let within = (place % HALF_PIXELS) as u32;
    let y = within / (BLOCK / 2);
    let x = within % (BLOCK / 2) * 2 + (y + half) % 2;
    UVec2::new(block % BLOCKS * BLOCK + x, block / BLOCKS * BLOCK + y)
}

/// The half that the pixel at a place of a tile's memory belongs to.
#[inline(always)]
pub(in crate::film) const fn half_of(place: usize) -> usize {
    place / HALF_PIXELS % 2
}

/// Which of a tile's pixels: those with x + y even, odd, or both. Adaptive sampling gives one half
/// the samples that the other half asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::film) enum Pixels {
    All,
    Half(usize),
}

impl Pixels {
    pub fn has_half(self, half: usize) -> bool {
        self == Self::All || self == Self::Half(half)
    }

    pub fn halves(self) -> impl Iterator<Item = usize> {
        (0..2).filter(move |half| self.has_half(*half))
    }

    /// Their places in a tile's memory, as they lie beside one another.
    pub fn runs(self) -> impl Iterator<Item = Range<usize>> {
        let (first, length, count) = match self {
            Self::All => (0, TILE_PIXELS, 1),
            Self::Half(half) => (half * HALF_PIXELS, HALF_PIXELS, TILE_PIXELS / BLOCK_PIXELS),
        };
        let starts = (0..count).map(move |run| first + run * BLOCK_PIXELS);
        starts.map(move |start| start..start + length)
    }
}

/// How a picture is cut into tiles: row by row from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::film) struct TileGrid {
    pub size: UVec2,
}

impl TileGrid {
    pub fn new(size: UVec2) -> Self {
        Self { size }
    }

    /// How many tiles are beside one another.
    pub fn columns(&self) -> u32 {
        self.size.x.div_ceil(TILE).max(1)
    }

    pub fn count(&self) -> u32 {
        self.columns() * self.size.y.div_ceil(TILE)
    }

    /// Pixels in memory: those of whole tiles.
    pub fn pixels(&self) -> u64 {
        u64::from(self.count()) * u64::from(TILE * TILE)
    }

    /// The number of the tile that a pixel of the picture lies in.
    pub fn tile_of(&self, pixel: UVec2) -> usize {
        let tile = pixel / TILE;
        tile.y as usize * self.columns() as usize + tile.x as usize
    }

    pub fn tile(&self, i: u32) -> Tile {
        let origin = UVec2::new(i % self.columns(), i / self.columns()) * TILE;
        let extent = (self.size - origin).min(UVec2::splat(TILE));
        Tile { origin, extent }
    }

    pub fn tiles(self) -> impl Iterator<Item = Tile> {
        (0..self.count()).map(move |i| self.tile(i))
    }

    /// The tiles that a region touches, and the rectangle that they make; all of them without one.
    pub fn within(self, region: Option<URect>) -> (Vec<u32>, Tile) {
        let (min, max) = match region {
            Some(region) => (region.min.min(self.size), region.max.min(self.size)),
            None => (UVec2::ZERO, self.size),
        };
        let [first, end] = touched([min, max]);
        let tiles = self.rows(first, end).flatten().collect();
        let origin = first * TILE;
        let extent = (end * TILE).min(self.size) - origin;
        (tiles, Tile { origin, extent })
    }

    /// The tiles that a region touches, row by row.
    pub fn rows_within(self, region: URect) -> impl Iterator<Item = Range<u32>> {
        let [first, end] = touched([region.min, region.max].map(|n| n.min(self.size)));
        self.rows(first, end)
    }

    fn rows(self, first: UVec2, end: UVec2) -> impl Iterator<Item = Range<u32>> {
        let columns = self.columns();
        (first.y..end.y).map(move |y| y * columns + first.x..y * columns + end.x)
    }
}

/// The first column and row of tiles that these pixels touch, and the first ones beyond: zero where there is no pixel.
fn touched([min, max]: [UVec2; 2]) -> [UVec2; 2] {
    if min.cmpge(max).any() {
        [UVec2::ZERO; 2]
    } else {
        [min / TILE, max.map(|n| n.div_ceil(TILE))]
    }
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::film) struct Tile {
    /// Its top left pixel.
    pub origin: UVec2,
    /// Columns and rows of it that lie in the picture.
    pub extent: UVec2,
}

impl Tile {
    /// Its middle, in pixels.
    pub fn center(self) -> Vec2 {
        self.origin.as_vec2() + 0.5 * self.extent.as_vec2()
    }

    /// How many of these pixels it has.
    pub fn count(self, pixels: Pixels) -> u64 {
        let all = u64::from(self.extent.element_product());
        match pixels {
            Pixels::All => all,
            // Row by row and pixel by pixel in turns, the first one of the first half.
            Pixels::Half(half) => (all + 1 - half as u64) / 2,
        }
    }

    /// Whether it has the pixel at this place of its memory.
    #[inline(always)]
    pub fn has(self, place: usize) -> bool {
        pixel_in_tile(place).cmplt(self.extent).all()
    }

    /// The places of these pixels in its memory, in their order: rays of neighbours walk the trees together.
    pub fn places(self, pixels: Pixels) -> impl Iterator<Item = usize> {
        pixels
            .runs()
            .flatten()
            .filter(move |place| self.has(*place))
    }

    /// Its pixels in the order of its memory, each with its place there.
    pub fn pixels(self) -> impl Iterator<Item = (UVec2, usize)> {
        let places = self.places(Pixels::All);
        places.map(move |place| (self.origin + pixel_in_tile(place), place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_has_each_of_its_pixels_once_block_by_block_and_half_by_half() {
        for extent in [UVec2::splat(TILE), UVec2::new(5, 16), UVec2::new(3, 1)] {
            let tile = Tile {
                origin: UVec2::new(32, 48),
                extent,
            };
            let pixels: Vec<_> = tile.pixels().collect();
            assert_eq!(pixels.len() as u32, extent.element_product());
            for (pixel, place) in &pixels {
                let within = *pixel - tile.origin;
                assert!(within.cmplt(extent).all());
                assert_eq!(place_in_tile(within.x, within.y), *place);
                assert_eq!(half_of(*place) as u32, within.element_sum() % 2);
                let block = within / BLOCK;
                let number = block.y * (TILE / BLOCK) + block.x;
                assert_eq!((place / BLOCK_PIXELS) as u32, number);
            }
            for half in 0..2 {
                let of_half = pixels.iter().filter(|(_, place)| half_of(*place) == half);
                assert_eq!(of_half.count() as u64, tile.count(Pixels::Half(half)));
            }
            let mut places: Vec<_> = pixels.iter().map(|(_, place)| *place).collect();
            places.dedup();
            assert!(places.is_sorted() && places.len() == pixels.len());
        }
    }

    #[test]
    fn a_region_is_grown_to_the_tiles_that_it_touches_and_cut_at_the_pictures_border() {
        let grid = TileGrid::new(UVec2::new(70, 45));
        let of = |a: [u32; 2], b: [u32; 2]| {
            let (tiles, area) = grid.within(Some(URect {
                min: a.into(),
                max: b.into(),
            }));
            (tiles, area.origin.to_array(), area.extent.to_array())
        };
        assert_eq!(of([17, 3], [33, 16]), (vec![1, 2], [16, 0], [32, 16]));
        assert_eq!(of([60, 40], [900, 900]), (vec![13, 14], [48, 32], [22, 13]));
        assert_eq!(of([20, 20], [20, 30]), (vec![], [0, 0], [0, 0]));
        assert_eq!(of([70, 0], [90, 9]), (vec![], [0, 0], [0, 0]));
        let rows = |a: [u32; 2], b: [u32; 2]| {
            let region = URect {
                min: a.into(),
                max: b.into(),
            };
            grid.rows_within(region).flatten().collect::<Vec<_>>()
        };
        assert_eq!(rows([17, 3], [33, 17]), [1, 2, 6, 7]);
        assert_eq!(rows([60, 40], [900, 900]), [13, 14]);
        assert!(rows([70, 0], [90, 9]).is_empty());
        let (tiles, area) = grid.within(None);
        assert_eq!(tiles, (0..grid.count()).collect::<Vec<_>>());
        assert_eq!((area.origin, area.extent), (UVec2::ZERO, grid.size));
    }
}
