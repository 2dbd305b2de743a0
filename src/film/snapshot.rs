//! The picture of a render that goes on.

use super::engine::Engine;
use super::preview::Preview;
use super::tile_state::{TILE_PIXELS, TileState};
use super::tiles::{FilmPixel, Tile};
use super::{Film, Picture, TILE, lock};
use glam::UVec2;

/// A picture that is kept up to date: only what changed is drawn again.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Linear, scene-referred; coarse where the film has no sample yet.
    pub picture: Picture,
    /// Of which render the versions are.
    render: u64,
    versions: Vec<u32>,
    preview_version: u32,
}

impl Snapshot {
    /// A black picture, for [`Progressive::refresh`](super::Progressive::refresh).
    pub fn black(size: UVec2) -> Self {
        Self {
            picture: Picture::black(size),
            render: 0,
            versions: Vec::new(),
            preview_version: 0,
        }
    }
}

impl Engine {
    /// The means so far; black where a pixel has none.
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::black(self.size());
        for tile in &self.rendered {
            draw_means(&lock(&self.tiles[*tile as usize]), &mut picture);
        }
        picture
    }

    /// Draws again the tiles that have changed since the snapshot was drawn: the means so far; where
    /// there are none the nearest that the preview has; where it has none, what the snapshot shows
    /// already. True where any had changed.
    pub fn redraw(&self, snapshot: &mut Snapshot) -> bool {
        if snapshot.picture.size() != self.size() {
            *snapshot = Snapshot::black(self.size());
        }
        if snapshot.render != self.number {
            snapshot.render = self.number;
            snapshot.versions = vec![0; self.tiles.len()];
            snapshot.preview_version = 0;
        }
        let preview_version = (lock(&self.preview).as_ref()).map_or(0, |preview| preview.version);
        let preview_changed = preview_version != snapshot.preview_version;
        snapshot.preview_version = preview_version;
        let mut changed = false;
        for &tile in &self.rendered {
            let state = lock(&self.tiles[tile as usize]);
            let version = &mut snapshot.versions[tile as usize];
            if *version != state.version {
                *version = state.version;
                draw_means(&state, &mut snapshot.picture);
                changed = true;
            } else if state.version == 0 && preview_changed {
                if let Some(preview) = lock(&self.preview).as_ref() {
                    draw_preview(&state, preview, &mut snapshot.picture);
                }
                changed = true;
            }
        }
        changed
    }

    pub fn film(&self) -> Film {
        let mut pixels = Vec::with_capacity(self.tiles.len() * TILE_PIXELS);
        for state in &self.tiles {
            let end = pixels.len() + TILE_PIXELS;
            pixels.extend_from_slice(&lock(state).pixels);
            // A tile that no pass has reached has none.
            pixels.resize(end, FilmPixel::default());
        }
        Film::from_tiles(self.size(), pixels)
    }

    /// The film of the one tile that a pixel lies in, and the pixel's place there.
    pub fn tile_film(&self, pixel: UVec2) -> Option<(Film, UVec2)> {
        if pixel.cmpge(self.size()).any() {
            return None;
        }
        let columns = self.size().x.div_ceil(TILE);
        let tile = (pixel.y / TILE) * columns + pixel.x / TILE;
        let state = lock(self.tiles.get(tile as usize)?);
        let mut pixels = state.pixels.to_vec();
        // A tile that no pass has reached has none.
        pixels.resize(TILE_PIXELS, FilmPixel::default());
        let film = Film::from_tiles(state.tile.extent, pixels);
        Some((film, pixel - state.tile.origin))
    }
}

fn draw_means(state: &TileState, picture: &mut Picture) {
    if state.pixels.is_empty() {
        return;
    }
    let width = picture.width as usize;
    for (pixel, at) in state.tile.pixels() {
        let FilmPixel { sum, count, .. } = &state.pixels[at];
        picture.pixels[pixel.y as usize * width + pixel.x as usize] = sum.mean(*count);
    }
}

fn draw_preview(state: &TileState, preview: &Preview, picture: &mut Picture) {
    let width = picture.width as usize;
    let Tile { origin, extent } = state.tile;
    let end = origin + extent;
    let side = preview.side();
    for y in (origin.y..end.y).step_by(side as usize) {
        for x in (origin.x..end.x).step_by(side as usize) {
            let Some(value) = preview.shown(UVec2::new(x, y)) else {
                continue;
            };
            let columns = x as usize..(x + side).min(end.x) as usize;
            for y in y..(y + side).min(end.y) {
                let row = &mut picture.pixels[y as usize * width..];
                row[columns.clone()].fill(value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::engine::Mode;
    use super::super::sample_chunk::Subject;
    use super::super::test_scene;
    use super::*;
    use glam::Vec3;

    const SIZE: UVec2 = UVec2::new(70, 45);
    const OLD: Vec3 = Vec3::splat(7.0);

    fn engine() -> Engine {
        let subject = Subject {
            world: test_scene::world(),
            camera: test_scene::camera(),
            settings: test_scene::settings(SIZE, 2),
        };
        let mode = Mode {
            watched: true,
            samples: 0..2,
            region: None,
        };
        Engine::new(subject, mode, None)
    }

    #[test]
    fn what_stood_there_before_stays_until_there_is_something_to_show() {
        let mut snapshot = Snapshot::black(SIZE);
        snapshot.picture.pixels.fill(OLD);
        let engine = engine();
        assert!(!engine.redraw(&mut snapshot));
        assert!(snapshot.picture.pixels.iter().all(|p| *p == OLD));

        // One pixel of the coarsest lattice is known: it stands for those around it.
        let mut preview = Preview::new(engine.area);
        preview.take(&[UVec2::new(32, 0)], &[Vec3::ONE]);
        *lock(&engine.preview) = Some(preview);
        assert!(engine.redraw(&mut snapshot) && !engine.redraw(&mut snapshot));
        for y in 0..SIZE.y {
            for x in 0..SIZE.x {
                let near = (16..48).contains(&x) && y < 16;
                let expected = if near { Vec3::ONE } else { OLD };
                assert_eq!(snapshot.picture.pixel(x, y), expected, "{x}, {y}");
            }
        }

        engine.run(&|_| {});
        assert!(engine.redraw(&mut snapshot) && !engine.redraw(&mut snapshot));
        assert_eq!(snapshot.picture, engine.picture());
        assert_eq!(engine.film().picture(), engine.picture());
    }

    #[test]
    fn another_render_and_another_size_are_drawn_anew() {
        let first = engine();
        first.run(&|_| {});
        let mut snapshot = Snapshot::black(UVec2::new(3, 4));
        assert!(first.redraw(&mut snapshot));
        assert_eq!(snapshot.picture, first.picture());
        let second = engine();
        second.run(&|_| {});
        snapshot.picture.pixels.fill(OLD);
        assert!(second.redraw(&mut snapshot));
        assert_eq!(snapshot.picture, second.picture());
    }
}
