//! The picture of a render that goes on.

use super::engine::Engine;
use super::preview::Preview;
use crate::film::planes::tile_state::TileState;
use crate::film::planes::tiled_film::draw;
use crate::film::sums::tiles::Tile;
use crate::film::{Film, Picture, TILE};
use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;

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
    /// A black picture, for [`Progressive::refresh`](super::progressive::Progressive::refresh).
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
    /// The means so far; black where a pixel has none. On the current rayon pool.
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::black(self.size());
        let width = picture.width as usize;
        let columns = self.grid.columns() as usize;
        let row_of_tiles = (TILE as usize * width).max(1);
        let rows = picture.pixels.par_chunks_mut(row_of_tiles).enumerate();
        rows.for_each(|(row, pixels)| {
            for column in 0..columns {
                let mut state = self.tile(row * columns + column);
                if self.renders(state.tile) && state.has_samples() {
                    draw(&state.means(), state.tile, pixels, width);
                }
            }
        });
        picture
    }

    /// Draws again the tiles that have changed since the snapshot was drawn: the means so far; where
    /// there are none the nearest that the preview has; where it has none, what the snapshot shows
    /// already. True where any had changed. On the current rayon pool.
    pub fn redraw(&self, snapshot: &mut Snapshot) -> bool {
        if snapshot.picture.size() != self.size() {
            *snapshot = Snapshot::black(self.size());
        }
        let number = self.number();
        if snapshot.render != number {
            snapshot.render = number;
            snapshot.versions = vec![0; self.tiles.len()];
            snapshot.preview_version = 0;
        }
        let preview = self.preview();
        let preview_version = preview.as_ref().map_or(0, |preview| preview.version());
        let preview_changed = preview_version != snapshot.preview_version;
        snapshot.preview_version = preview_version;
        let width = snapshot.picture.width as usize;
        let columns = self.grid.columns() as usize;
        let row_of_tiles = (TILE as usize * width).max(1);
        let subject = self.subject();
        let rows = snapshot.picture.pixels.par_chunks_mut(row_of_tiles);
        rows.zip(snapshot.versions.par_chunks_mut(columns))
            .enumerate()
            .map(|(row, (pixels, versions))| {
                let mut changed = false;
                for (column, version) in versions.iter_mut().enumerate() {
                    let mut state = self.tile_of(&subject, row * columns + column);
                    let is_whole = !state.lacks_light();
                    let is_coarse = !is_whole || state.version == 0;
                    if is_whole && *version != state.version {
                        *version = state.version;
                        draw(&state.means(), state.tile, pixels, width);
                        changed = true;
                    } else if is_coarse
                        && preview_changed
                        && self.renders(state.tile)
                        && let Some(preview) = &preview
                    {
                        draw_preview(&state, preview, pixels, width);
                        changed = true;
                    }
                }
                changed
            })
            .reduce(|| false, |a, b| a | b)
    }

    /// A copy of the sums. On the current rayon pool.
    pub fn film(&self) -> Film {
        let tiles = (0..self.tiles.len()).into_par_iter();
        let tiles = tiles.map(|tile| self.tile(tile).film_tile());
        Film::from_tiles(self.size(), tiles.collect(), self.hidden_in_a_pixel())
    }

    /// The sums of a render that nobody looks at any more.
    pub fn into_film(self) -> Film {
        let hidden = self.hidden_in_a_pixel();
        let tiles = (0..self.tiles.len()).map(|tile| self.tile(tile).take_film_tile());
        Film::from_tiles(self.size(), tiles.collect(), hidden)
    }

    /// The film of the one tile that a pixel lies in, of which a pixel may lack so much light as was `hidden` from it; and the
    /// pixel's place there.
    pub fn tile_film(&self, pixel: UVec2, hidden: f64) -> Option<(Film, UVec2)> {
        if pixel.cmpge(self.size()).any() {
            return None;
        }
        let mut state = self.tile(self.grid.tile_of(pixel));
        let pixels = state.film_tile();
        let extent = state.tile.extent;
        drop(state);
        let film = Film::from_tiles(extent, vec![pixels], hidden);
        Some((film, pixel % TILE))
    }
}

/// Draws a tile that has no means yet into the rows of a picture, `width` pixels each, of which the first is the tile's
/// first: from pixel to pixel of the finest lattice even, as far as its pixels are known.
fn draw_preview(state: &TileState, preview: &Preview, rows: &mut [Vec3], width: usize) {
    let Tile { origin, extent } = state.tile;
    let step = preview.step();
    let side = step.min(TILE);
    for y in (0..extent.y).step_by(side as usize) {
        for x in (0..extent.x).step_by(side as usize) {
            let square = Tile {
                origin: origin + UVec2::new(x, y),
                extent: (extent - UVec2::new(x, y)).min(UVec2::splat(side)),
            };
            let rows = &mut rows[y as usize * width..];
            match preview.corners(square.origin) {
                Some((corner, values)) => {
                    let start = (square.origin - corner).as_vec2();
                    draw_between(values, (start, step as f32), square, rows, width);
                }
                None => draw_nearest(preview, square, rows, width),
            }
        }
    }
}

/// A square between four pixels of a lattice, of which it starts so far from the first one.
fn draw_between(
    corners: [Vec3; 4],
    (start, step): (Vec2, f32),
    square: Tile,
    rows: &mut [Vec3],
    width: usize,
) {
    // Even on a screen: between a lamp and a wall in linear light all would be lamp.
    let [a, b, c, d] = corners.map(|value| {
        let value = value.max(Vec3::ZERO).min(Vec3::splat(BRIGHTEST));
        value / (1.0 + value)
    });
    let columns = square.origin.x as usize..(square.origin.x + square.extent.x) as usize;
    for (y, row) in (0..square.extent.y).zip(rows.chunks_mut(width)) {
        let down = (start.y + y as f32) / step;
        let (left, right) = (a.lerp(c, down), b.lerp(d, down));
        for (x, pixel) in row[columns.clone()].iter_mut().enumerate() {
            let value = left.lerp(right, (start.x + x as f32) / step);
            *pixel = value / (1.0 - value);
        }
    }
}

/// What a preview tells from another at the most: 1 - x/(1 + x) has digits for it.
const BRIGHTEST: f32 = 1e4;

/// A square in which each pixel shows the nearest that is known.
fn draw_nearest(preview: &Preview, square: Tile, rows: &mut [Vec3], width: usize) {
    let Tile { origin, extent } = square;
    let side = preview.side();
    for y in (0..extent.y).step_by(side as usize) {
        for x in (0..extent.x).step_by(side as usize) {
            let Some(value) = preview.shown(origin + UVec2::new(x, y)) else {
                continue;
            };
            let columns = (origin.x + x) as usize..(origin.x + (x + side).min(extent.x)) as usize;
            for y in y..(y + side).min(extent.y) {
                let row = &mut rows[y as usize * width..];
                row[columns.clone()].fill(value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::engine::Mode;
    use super::*;
    use crate::film::subject::Subject;
    use crate::film::{lock, test_scene};
    use crate::trace::Gains;
    use std::sync::Arc;

    const SIZE: UVec2 = UVec2::new(70, 45);
    const OLD: Vec3 = Vec3::splat(7.0);

    fn engine() -> Engine {
        let settings = test_scene::settings(SIZE, 2);
        let subject = Subject::new(test_scene::world(), test_scene::camera(), settings, true);
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
        let preview = Preview::new(engine.area);
        preview.begin(32);
        preview.take(&[UVec2::new(32, 0)], &[Vec3::ONE]);
        *lock(&engine.preview) = Some(Arc::new(preview));
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
    fn a_picture_that_lacks_light_is_coarse_where_a_preview_is_and_else_what_it_was() {
        let lit = test_scene::lit();
        let settings = test_scene::settings(SIZE, 2);
        let subject = Subject::new(lit.clone(), test_scene::camera(), settings, true);
        let mode = engine().mode;
        let engine = Engine::new(subject, mode, None);
        engine.run(&|_| {});
        let mut snapshot = Snapshot::black(SIZE);
        assert!(engine.redraw(&mut snapshot));
        let before = snapshot.picture.clone();
        let moved = test_scene::edited(&lit, |lights| lights.points[0].position.x += 0.2);
        assert!(engine.edit(moved, &Gains::default()));
        engine.take_edit();
        assert!(!engine.redraw(&mut snapshot));
        assert_eq!(snapshot.picture, before);
        let preview = Preview::new(engine.area);
        preview.begin(32);
        preview.take(&[UVec2::new(32, 0)], &[Vec3::ONE]);
        *lock(&engine.preview) = Some(Arc::new(preview));
        assert!(engine.redraw(&mut snapshot));
        assert_eq!(snapshot.picture.pixel(20, 3), Vec3::ONE);
        assert_eq!(snapshot.picture.pixel(2, 3), before.pixel(2, 3));
        engine.run(&|_| {});
        assert!(engine.redraw(&mut snapshot));
        assert_eq!(snapshot.picture, engine.picture());
    }

    #[test]
    fn between_pixels_of_a_coarse_picture_it_goes_evenly_from_one_to_the_next() {
        let engine = engine();
        let preview = Preview::new(engine.area);
        preview.begin(8);
        for y in (0..SIZE.y).step_by(8) {
            for x in (0..SIZE.x).step_by(8) {
                let value = Vec3::splat(x as f32 / 100.0);
                preview.take(&[UVec2::new(x, y)], &[value]);
            }
        }
        *lock(&engine.preview) = Some(Arc::new(preview));
        let mut snapshot = Snapshot::black(SIZE);
        assert!(engine.redraw(&mut snapshot));
        for y in 0..SIZE.y {
            let row: Vec<f32> = (0..SIZE.x)
                .map(|x| snapshot.picture.pixel(x, y).x)
                .collect();
            for x in (0..SIZE.x as usize).step_by(8) {
                assert!((row[x] - x as f32 / 100.0).abs() < 1e-5, "{row:?}");
            }
            let steps = row.windows(2).map(|pair| pair[1] - pair[0]);
            assert!(
                steps.clone().all(|step| (0.0..0.015).contains(&step)),
                "{row:?}"
            );
            // From the last pixel of the lattice on there is none to go to.
            assert_eq!(row[64..], [row[64]; 6]);
        }
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
