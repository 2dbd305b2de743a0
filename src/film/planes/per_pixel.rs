//! What a film knows of each pixel beside its colour.

use super::tiled_film::{Film, FilmTile};
use crate::film::errors::error::{Decline, Moves};
use crate::film::errors::means::Means;
use crate::film::sums::tiles::{BLOCK_PIXELS, TILE_PIXELS, Tile, TileGrid};

/// The estimated relative error of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelError {
    /// 0.01 is one percent; NaN where it is not known.
    pub relative: f32,
    /// Whether that is the pixel's part of what features may hide, at most, that no sample has met: the
    /// samples themselves differ by less, or not at all.
    pub is_bound: bool,
}

impl Film {
    /// The number of each pixel's samples, row by row from the top.
    pub fn counts(&self) -> Vec<u32> {
        let size = self.size();
        (0..size.y)
            .flat_map(|y| (0..size.x).map(move |x| self.count(x, y)))
            .collect()
    }

    /// The estimated relative error of each pixel, row by row from the top: 0.01 is one percent. Its
    /// 4 × 4 pixels' part of their tile's error, so that the mean square is the picture's
    /// ([`ErrorEstimate::relative_mse`](crate::film::ErrorEstimate)); NaN where it is not known: of
    /// less than two samples, of samples without the first ones, and of a merged film. Where they moved by
    /// less than what features may hide that no sample has met, it is that.
    pub fn relative_errors(&self) -> Vec<f32> {
        let tiles = self.half_tiles();
        let errors = self.errors_of(&tiles, &Decline::of(tiles.iter().map(|half| &half.whole)));
        errors.into_iter().map(|error| error.relative).collect()
    }

    /// The same where this film is a part of one whose errors decline so.
    pub(in crate::film) fn errors_in(&self, decline: &Decline) -> Vec<PixelError> {
        self.errors_of(&self.half_tiles(), decline)
    }

    /// Two for each tile.
    fn half_tiles(&self) -> Vec<HalfTile> {
        TileGrid::new(self.size())
            .tiles()
            .enumerate()
            .flat_map(|(number, tile)| HalfTile::both(tile, self.tile(number)))
            .collect()
    }

    fn errors_of(&self, tiles: &[HalfTile], decline: &Decline) -> Vec<PixelError> {
        let size = self.size();
        let mut errors = vec![PixelError::UNKNOWN; size.x as usize * size.y as usize];
        for halves in tiles.chunks_exact(2) {
            let blocks = block_errors(halves, decline, self.hidden);
            for (pixel, place) in halves[0].tile.pixels() {
                let at = pixel.y as usize * size.x as usize + pixel.x as usize;
                errors[at] = blocks[place / BLOCK_PIXELS];
            }
        }
        errors
    }
}

impl PixelError {
    const UNKNOWN: Self = Self {
        relative: f32::NAN,
        is_bound: false,
    };
}

const BLOCKS: usize = TILE_PIXELS / BLOCK_PIXELS;

/// Half of a tile's pixels, as adaptive sampling halves them: the two may have different numbers of
/// samples.
struct HalfTile {
    tile: Tile,
    /// How far they moved.
    whole: Moves,
    /// How far those of each block did.
    blocks: [Moves; BLOCKS],
}

impl HalfTile {
    fn both(tile: Tile, pixels: &FilmTile) -> [Self; 2] {
        let colors = pixels.means();
        let means = Means::of(&colors, &pixels.past, pixels.counts, tile.extent);
        [0, 1].map(|half| Self {
            tile,
            whole: means.moves(half),
            blocks: std::array::from_fn(|block| means.moves_in_block(half, block)),
        })
    }
}

/// The relative error of each block: its share of what its tile's halves err by, or of what unmet features
/// may hide in it.
fn block_errors(halves: &[HalfTile], decline: &Decline, hidden: f64) -> [PixelError; BLOCKS] {
    std::array::from_fn(|i| {
        let (mut sum, mut unmet, mut pixels) = (0.0, 0.0, 0);
        for half in halves.iter().filter(|half| half.blocks[i].pixels > 0) {
            let Some(expected) = half.whole.expected(decline) else {
                return PixelError::UNKNOWN;
            };
            let block = &half.blocks[i];
            if block.relative[0] > 0.0 {
                sum += expected.relative * block.relative[0] / half.whole.relative[0];
            }
            let in_block = f64::from(block.pixels);
            unmet += hidden * block.reach_with(block.count).relative * in_block;
            pixels += block.pixels;
        }
        PixelError {
            relative: (sum.max(unmet) / f64::from(pixels.max(1))).sqrt() as f32,
            is_bound: unmet > sum,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{ErrorEstimate, Rendered, render, render_samples, test_scene};
    use glam::UVec2;

    fn rendered(spp: u32) -> Rendered {
        let settings = test_scene::settings(UVec2::new(36, 28), spp);
        render(
            &test_scene::world(),
            &test_scene::camera(),
            &settings,
            &|_, _| {},
        )
    }

    #[test]
    fn every_pixel_has_the_samples_that_were_asked_for() {
        let counts = rendered(8).film.counts();
        assert_eq!(counts, vec![8; 36 * 28]);
    }

    #[test]
    fn the_mean_square_of_the_pixels_errors_is_the_pictures() {
        let mut rendered = rendered(16);
        // What no sample has met is a bound for the whole, wherever it lies.
        rendered.film.hidden = 0.0;
        let errors = rendered.film.relative_errors();
        let squares: f64 = errors.iter().map(|&e| f64::from(e).powi(2)).sum();
        let mean = squares / errors.len() as f64;
        let halves = rendered.film.half_tiles();
        let moves: Vec<Moves> = halves.iter().map(|half| half.whole).collect();
        let picture = ErrorEstimate::of(&moves, 0.0).unwrap().relative_mse;
        assert!(
            (mean / picture - 1.0).abs() < 1e-4,
            "{mean}, the picture's {picture}"
        );
        let (least, most) = errors
            .iter()
            .fold((f32::MAX, 0.0_f32), |(least, most), &e| {
                (least.min(e), most.max(e))
            });
        assert!(
            most > 4.0 * least,
            "from {least} to {most}: it does not tell places apart"
        );
    }

    #[test]
    fn the_error_of_a_merged_film_and_of_a_later_part_is_not_known() {
        let settings = test_scene::settings(UVec2::new(36, 28), 1);
        let part = |samples| {
            let (world, camera) = (test_scene::world(), test_scene::camera());
            render_samples(&world, &camera, &settings, samples, &|_| {}).film
        };
        let known = |film: &Film| {
            let errors = film.relative_errors();
            errors.iter().filter(|error| error.is_finite()).count()
        };
        let (mut film, later) = (part(0..8), part(8..16));
        assert_eq!((known(&film), known(&later)), (36 * 28, 0));
        // Nothing added changes nothing, and what is added to nothing stays what it is.
        assert!(film.merge(&Film::new(film.size())));
        assert_eq!(known(&film), 36 * 28);
        let mut same = Film::new(film.size());
        assert!(same.merge(&film));
        assert_eq!(same, film);
        assert!(film.merge(&later));
        assert_eq!(known(&film), 0);
        assert!(film.relative_errors().iter().all(|error| error.is_nan()));
    }

    #[test]
    fn the_error_of_a_single_sample_is_not_known() {
        assert!(
            rendered(1)
                .film
                .relative_errors()
                .iter()
                .all(|e| e.is_nan())
        );
        assert!(
            Film::new(UVec2::new(3, 5))
                .relative_errors()
                .iter()
                .all(|e| e.is_nan())
        );
    }
}
