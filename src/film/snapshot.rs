//! The picture of a render that goes on.

use super::engine::Engine;
use super::tile_state::{TILE_PIXELS, TileState};
use super::tiles::FilmPixel;
use super::{Film, Picture, lock};

impl Engine {
    /// The means so far; where a pixel has none, the nearest that the preview has.
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::black(self.size());
        for state in &self.tiles {
            let state = lock(state);
            self.draw_tile(&state, &mut picture);
        }
        picture
    }

    /// Draws again the tiles whose `versions` have changed since. True where any had.
    pub fn redraw(&self, picture: &mut Picture, versions: &mut Vec<u32>) -> bool {
        let mut changed = false;
        versions.resize(self.tiles.len(), 0);
        for (state, version) in self.tiles.iter().zip(versions) {
            let state = lock(state);
            // Version 0 may be the preview's, which changes without counting.
            if *version != state.version || state.version == 0 {
                self.draw_tile(&state, picture);
                *version = state.version;
                changed = true;
            }
        }
        changed
    }

    fn draw_tile(&self, state: &TileState, picture: &mut Picture) {
        let width = self.size().x as usize;
        let preview = (state.version == 0).then(|| lock(&self.preview));
        for (pixel, at) in state.tile.pixels() {
            let FilmPixel { sum, count, .. } = &state.pixels[at];
            let coarse = || {
                let preview = preview.as_ref()?.as_ref()?;
                preview.shown(pixel)
            };
            picture.pixels[pixel.y as usize * width + pixel.x as usize] = match count {
                0 => coarse().unwrap_or_default(),
                count => sum.mean(*count),
            };
        }
    }

    pub fn film(&self) -> Film {
        let mut pixels = Vec::with_capacity(self.tiles.len() * TILE_PIXELS);
        for state in &self.tiles {
            pixels.extend_from_slice(&lock(state).pixels);
        }
        Film::from_tiles(self.size(), pixels)
    }
}
