use super::tile_state::TILE_PIXELS;
use super::{Picture, Sum};
use bevy::math::URect;
use glam::{UVec2, Vec2, Vec3};

/// Edge of a square tile in pixels: 256 pixels of one sample each fill a batch, and the arrays of a
/// batch stay within a core's second-level cache.
pub const TILE: u32 = 16;

/// Sums and counts of every pixel, tile by tile, so that a tile is one piece of memory that a
/// thread can have to itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    size: UVec2,
    /// `TILE_PIXELS` each.
    tiles: Vec<Box<[FilmPixel]>>,
    /// The squared error that unmet features may leave in a pixel, per [`Reach`](super::unmet::Reach) of a
    /// sample, if they lie in all alike.
    pub(super) hidden: f64,
}

/// One pixel: what arrived, and how many samples it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FilmPixel {
    pub sum: Sum,
    pub count: u32,
    /// How far the mean moved when its samples doubled, the last time first: squared, averaged over
    /// the channels; or [`NOT_KNOWN`]. They fill what the sum's alignment leaves.
    pub moved: [f32; 3],
}

/// Of samples that did not arrive by doublings from the first one on. Infinite and not NaN, so that
/// equal films are equal.
pub(super) const NOT_KNOWN: [f32; 3] = [f32::INFINITY; 3];

impl Film {
    /// An empty film of `size` pixels.
    pub fn new(size: UVec2) -> Self {
        let tiles = TileGrid::new(size).tiles().map(|_| empty_tile());
        Self::from_tiles(size, tiles.collect(), 0.0)
    }

    /// In pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The film whose tiles' pixels are given, in the grid's order. `hidden` is what unmet features may leave in a
    /// pixel, per reach of a sample.
    pub(super) fn from_tiles(size: UVec2, tiles: Vec<Box<[FilmPixel]>>, hidden: f64) -> Self {
        Self {
            size,
            tiles,
            hidden,
        }
    }

    /// The mean of every pixel's samples.
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::black(self.size);
        for y in 0..self.size.y {
            for x in 0..self.size.x {
                let pixel = self.pixel(x, y);
                picture.pixels[y as usize * self.size.x as usize + x as usize] =
                    pixel.sum.mean(pixel.count);
            }
        }
        picture
    }

    /// The mean of one pixel's samples.
    pub fn mean(&self, x: u32, y: u32) -> Vec3 {
        let pixel = self.pixel(x, y);
        pixel.sum.mean(pixel.count)
    }

    /// A film whose pixels hold these sums, row by row from the top, of `count` samples each. `None`
    /// where there are more or fewer sums than pixels.
    pub fn of_sums(size: UVec2, sums: &[Sum], count: u32) -> Option<Self> {
        let columns = size.x as usize;
        if sums.len() != columns * size.y as usize {
            return None;
        }
        let mut film = Self::new(size);
        for (i, sum) in sums.iter().enumerate() {
            let (tile, at) = film.place((i % columns) as u32, (i / columns) as u32);
            film.tiles[tile][at] = FilmPixel {
                sum: *sum,
                count,
                moved: NOT_KNOWN,
            };
        }
        Some(film)
    }

    /// The sum of a pixel's samples.
    pub fn sum(&self, x: u32, y: u32) -> &Sum {
        &self.pixel(x, y).sum
    }

    /// Adds the samples of another film of the same size. False, and nothing done, for another size.
    /// Of the sum of two parts the error is not known: neither part tells how far it would have moved.
    pub fn merge(&mut self, other: &Self) -> bool {
        if self.size != other.size {
            return false;
        }
        let pixels = self.tiles.iter_mut().flatten();
        for (pixel, other) in pixels.zip(other.tiles.iter().flatten()) {
            pixel.moved = match (pixel.count, other.count) {
                (0, _) => other.moved,
                (_, 0) => pixel.moved,
                _ => NOT_KNOWN,
            };
            pixel.sum.merge(&other.sum);
            pixel.count += other.count;
        }
        self.hidden = self.hidden.max(other.hidden);
        true
    }

    /// How many samples a pixel has.
    pub fn count(&self, x: u32, y: u32) -> u32 {
        self.pixel(x, y).count
    }

    /// The memory of the tile with this number.
    pub(super) fn tile(&self, number: usize) -> &[FilmPixel] {
        &self.tiles[number]
    }

    fn pixel(&self, x: u32, y: u32) -> &FilmPixel {
        let (tile, at) = self.place(x, y);
        &self.tiles[tile][at]
    }

    /// The tile that a pixel lies in, and where in its memory.
    fn place(&self, x: u32, y: u32) -> (usize, usize) {
        let tile = TileGrid::new(self.size).tile_of(UVec2::new(x, y));
        (tile, ((y % TILE) * TILE + x % TILE) as usize)
    }
}

/// The pixels of a tile that nothing has arrived in.
pub(super) fn empty_tile() -> Box<[FilmPixel]> {
    vec![FilmPixel::default(); TILE_PIXELS].into()
}

/// How a picture is cut into tiles: row by row from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TileGrid {
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
        let (first, end) = (min / TILE, max.map(|n| n.div_ceil(TILE)));
        if min.cmpge(max).any() {
            let nothing = Tile {
                origin: UVec2::ZERO,
                extent: UVec2::ZERO,
            };
            return (Vec::new(), nothing);
        }
        let tiles = (first.y..end.y)
            .flat_map(|y| (first.x..end.x).map(move |x| y * self.columns() + x))
            .collect();
        let origin = first * TILE;
        let extent = (end * TILE).min(self.size) - origin;
        (tiles, Tile { origin, extent })
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
    /// Its middle, in pixels.
    pub fn center(self) -> Vec2 {
        self.origin.as_vec2() + 0.5 * self.extent.as_vec2()
    }

    /// The same, in blocks of 4 × 4: rays of neighbours walk the trees together.
    pub fn pixels_in_blocks(self) -> impl Iterator<Item = (UVec2, usize)> {
        const BLOCK: u32 = 4;
        let blocks = TILE / BLOCK;
        (0..TILE * TILE).filter_map(move |i| {
            let (block, within) = (i / (BLOCK * BLOCK), i % (BLOCK * BLOCK));
            let x = block % blocks * BLOCK + within % BLOCK;
            let y = block / blocks * BLOCK + within / BLOCK;
            let inside = x < self.extent.x && y < self.extent.y;
            inside.then(|| (self.origin + UVec2::new(x, y), (y * TILE + x) as usize))
        })
    }

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
            let mut tiles = Vec::new();
            for tile in TileGrid::new(size).tiles() {
                let mut pixels = empty_tile();
                for (at, place) in tile.pixels() {
                    let pixel = &mut pixels[place];
                    pixel.sum.add(Vec3::new(at.x as f32, at.y as f32, 1.0));
                    pixel.count += 1;
                }
                tiles.push(pixels);
            }
            let film = Film::from_tiles(size, tiles, 0.0);
            assert_eq!(film.tiles.len(), Film::new(size).tiles.len());
            let picture = film.picture();
            for y in 0..size.y {
                for x in 0..size.x {
                    assert_eq!(picture.pixel(x, y), Vec3::new(x as f32, y as f32, 1.0));
                    assert_eq!(film.mean(x, y), picture.pixel(x, y));
                }
            }
        }
    }

    #[test]
    fn the_blocks_of_a_tile_hold_its_pixels_once_and_sixteen_in_a_row_are_neighbours() {
        for extent in [UVec2::splat(TILE), UVec2::new(5, 16), UVec2::new(3, 1)] {
            let tile = Tile {
                origin: UVec2::new(32, 48),
                extent,
            };
            let mut in_blocks: Vec<_> = tile.pixels_in_blocks().collect();
            if extent == UVec2::splat(TILE) {
                for block in in_blocks.chunks(16) {
                    let corner = block[0].0;
                    let far = block
                        .iter()
                        .map(|(pixel, _)| (*pixel - corner).max_element());
                    assert_eq!(far.max(), Some(3));
                }
            }
            in_blocks.sort_by_key(|(_, at)| *at);
            assert_eq!(in_blocks, tile.pixels().collect::<Vec<_>>());
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
        let (tiles, area) = grid.within(None);
        assert_eq!(tiles, (0..grid.count()).collect::<Vec<_>>());
        assert_eq!((area.origin, area.extent), (UVec2::ZERO, grid.size));
    }
}
