//! Tiles in which nothing is to be seen but an even background: their samples are known without a ray. Of a model that stands
//! by itself, as it comes out of a file, they are most of the picture.

use crate::film::subject::Subject;
use crate::film::sums::tiles::{TILE, Tile, TileGrid};
use crate::trace::in_view;
use glam::{UVec2, Vec3};

/// Which tiles those are, and what their samples are.
pub(in crate::film) struct Voids {
    color: Vec3,
    /// Of each tile, whether it is one; empty where none is. Those at the right and the lower end that are cut are none: their
    /// memory has more pixels than the picture, which have no samples.
    tiles: Vec<bool>,
}

impl Voids {
    /// Of a picture: it stays true while lights that are not seen and materials are edited.
    pub fn of(subject: &Subject, grid: &TileGrid) -> Self {
        let Subject {
            world,
            camera,
            settings,
            ..
        } = subject;
        let none = Self {
            color: Vec3::ZERO,
            tiles: Vec::new(),
        };
        let background = world.environment.even(settings.features.environment);
        let Some(color) = background.filter(|color| color.is_finite()) else {
            return none;
        };
        let Some(rectangles) = in_view(world, camera, settings) else {
            return none;
        };
        let whole = |tile: Tile| tile.extent == UVec2::splat(TILE);
        let mut tiles: Vec<bool> = grid.tiles().map(whole).collect();
        let mut left = tiles.iter().filter(|is_void| **is_void).count();
        for rectangle in rectangles {
            for row in grid.rows_within(rectangle) {
                for is_void in &mut tiles[row.start as usize..row.end as usize] {
                    left -= usize::from(std::mem::take(is_void));
                }
            }
            if left == 0 {
                return none;
            }
        }
        Self { color, tiles }
    }

    /// What every sample of a tile is, where nothing is to be seen in it.
    pub fn color_of(&self, tile: u32) -> Option<Vec3> {
        let is_void = self.tiles.get(tile as usize).copied().unwrap_or(false);
        is_void.then_some(self.color)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::test_scene::{settings, world};
    use crate::film::{Progressive, Sum};
    use crate::trace::{Camera, SampleId, Workspace, radiance};

    const SIZE: UVec2 = UVec2::new(150, 90);

    #[test]
    fn a_picture_with_much_nothing_around_is_that_of_its_samples_one_by_one() {
        let mut world = world();
        world.environment.background = Vec3::new(0.3, 0.1, 2.7);
        let eye = Vec3::new(4.0, 9.0, 30.0);
        let camera = Camera::looking_at(eye, Vec3::ZERO, Vec3::Y, 0.9);
        let settings = settings(SIZE, 5);
        let subject = Subject::new(world.clone(), camera.clone(), settings.clone(), true);
        let grid = TileGrid::new(SIZE);
        let voids = Voids::of(&subject, &grid);
        let count = (0..grid.count())
            .filter(|tile| voids.color_of(*tile).is_some())
            .count();
        assert!(2 * count > grid.count() as usize, "{count}");
        assert!(count < grid.count() as usize);

        let render = Progressive::start(world.clone(), camera.clone(), settings.clone()).unwrap();
        render.wait();
        let picture = render.snapshot().picture;
        let rays = render.status().rays;
        assert_eq!(rays.camera, 5 * u64::from(SIZE.element_product()));
        let mut workspace = Workspace::default();
        for (i, pixel) in picture.pixels.iter().enumerate() {
            let place = UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x);
            let ids: Vec<_> = (0..5)
                .map(|index| SampleId {
                    pixel: place,
                    index,
                })
                .collect();
            let mut values = [Vec3::ZERO; 5];
            radiance(
                &world,
                &camera,
                &settings,
                &ids,
                &mut values,
                &mut workspace,
            );
            let mut sum = Sum::default();
            values.into_iter().for_each(|value| sum.add(value));
            // The panel's light is added to what shines by itself in f32.
            let difference = (sum.mean(5) - *pixel).abs().max_element();
            assert!(difference < 1e-5 * pixel.max_element(), "{place}");
        }
    }
}
