//! A picture's light kept apart, for those who mix it themselves.

use super::at_once::{Rendered, finish};
use super::engine::{Engine, Mode};
use super::status::Status;
use crate::film::subject::Subject;
use crate::film::sums::tiles::place_in_tile;
use crate::film::{Picture, TILE, lock};
use crate::scene::RenderSettings;
use crate::trace::planes::OWN;
use crate::trace::{Camera, Gains, Planes, Untinted, World, samples_per_pixel};
use glam::{UVec2, Vec3};
use std::ops::Range;

/// What shines by itself, and what each light adds: together they are the picture, but for the rounding of f32.
#[derive(Clone, Debug)]
pub struct LightPictures {
    /// Glowing surfaces and the background, and their mirror pictures.
    pub own: Picture,
    /// What lights add.
    pub lights: Vec<LightPicture>,
}

/// What a light adds to a picture.
#[derive(Clone, Debug)]
pub struct LightPicture {
    /// The `SceneId` of the light; of several where there are more lights than [`LightPictures::MOST`].
    pub ids: Vec<u64>,
    /// Linear, scene-referred.
    pub picture: Picture,
}

impl LightPictures {
    /// Pictures of one light each, at most; the others share one more.
    pub const MOST: usize = Planes::MOST - 1;

    /// How many pictures there are of so many lights, that of what shines by itself among them.
    pub fn planes(lights: usize) -> usize {
        1 + lights.min(Self::MOST + 1)
    }
}

/// What [`render`](super::at_once::render()) renders, and the same light by light.
pub fn render_lights(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    progress: &(dyn Fn(&Status) + Sync),
) -> (Rendered, LightPictures) {
    let subject = Subject {
        light: Untinted::of(world, LightPictures::MOST, &[], &Gains::default()),
        stays_apart: true,
        ..Subject::new(world.clone(), camera.clone(), settings.clone(), true)
    };
    let samples: Range<u64> = 0..samples_per_pixel(world, camera, settings).into();
    let mode = Mode {
        watched: false,
        samples,
        region: None,
    };
    let engine = Engine::new(subject, mode, None);
    let ending = engine.run(&|engine| progress(&engine.status()));
    let pictures = engine.light_pictures();
    (finish(engine, ending), pictures)
}

impl Engine {
    fn light_pictures(&self) -> LightPictures {
        let subject = self.subject();
        let pictures = |plane| self.plane_picture(plane, subject.light.tints[plane]);
        of_planes(&subject, (0..subject.planes()).map(pictures).collect())
    }

    fn plane_picture(&self, plane: usize, tint: Vec3) -> Picture {
        let mut picture = Picture::black(self.size());
        let width = picture.width as usize;
        for tile in 0..self.tiles.len() {
            let state = self.tile(tile);
            for (pixel, at) in state.tile.pixels() {
                let place = pixel.y as usize * width + pixel.x as usize;
                picture.pixels[place] = tint * state.plane_mean(plane, at);
            }
        }
        picture
    }

    /// Of every plane a picture of this size, for which a few pixels are read: with the lights' colours, and with the gains
    /// of those alone that share a plane. `None` where light is not kept apart, and while some of it is missing.
    pub fn light_sketches(&self, size: UVec2) -> Option<LightPictures> {
        let subject = self.subject();
        let mut pictures = vec![Picture::black(size); subject.planes()];
        let per_side = UVec2::splat(SKETCH_SIDE);
        let part = 1.0 / per_side.element_product() as f32;
        for y in 0..size.y * per_side.y {
            for x in 0..size.x * per_side.x {
                let place = UVec2::new(x, y);
                let middle = (place.as_vec2() + 0.5) / (size * per_side).as_vec2();
                let pixel = (middle * self.size().as_vec2()).as_uvec2();
                let pixel = pixel.min(self.size() - 1);
                let state = lock(&self.tiles[self.grid.tile_of(pixel)]);
                if !state.has_planes_of(&subject) {
                    return None;
                }
                let within = pixel % TILE;
                let at = place_in_tile(within.x, within.y);
                let to = place / per_side;
                for (plane, picture) in pictures.iter_mut().enumerate() {
                    picture.pixels[(to.y * size.x + to.x) as usize] +=
                        part * subject.light.colors[plane] * state.plane_mean(plane, at);
                }
            }
        }
        Some(of_planes(&subject, pictures))
    }
}

/// Pixels along each side that are read for one of a sketch: enough for it to be told what it shows.
const SKETCH_SIDE: u32 = 2;

/// Pictures of a subject's planes, in their order, with their lights.
fn of_planes(subject: &Subject, pictures: Vec<Picture>) -> LightPictures {
    let planes = &subject.light.planes;
    let ids = |plane| {
        let all = subject.world.lights.all().enumerate();
        let here = all.filter(move |(light, _)| planes.of_light(*light) == plane);
        here.map(|(_, light)| light.id()).collect()
    };
    let mut pictures = pictures.into_iter();
    LightPictures {
        own: pictures.next().unwrap_or(Picture::black(UVec2::ZERO)),
        lights: (OWN + 1..)
            .zip(pictures)
            .map(|(plane, picture)| LightPicture {
                ids: ids(plane),
                picture,
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::at_once::render;
    use super::*;
    use crate::film::test_scene;
    use crate::trace::{Lights, PointLight};
    use glam::{UVec2, Vec3};
    use std::sync::Arc;

    #[test]
    fn the_lights_pictures_add_up_to_the_picture_and_each_is_that_of_its_light_alone() {
        let size = UVec2::new(33, 20);
        let (camera, settings) = (test_scene::camera(), test_scene::settings(size, 8));
        let mut lights = (*test_scene::world().lights).clone();
        lights.points.push(PointLight {
            id: 77,
            position: Vec3::new(0.5, 1.5, 0.5),
            color: Vec3::new(0.5, 0.25, 2.0),
            cone: None,
        });
        let with = |lights: Lights| World {
            lights: Arc::new(lights),
            ..test_scene::world()
        };
        let world = with(lights.clone()).with_needs();
        let (rendered, apart) = render_lights(&world, &camera, &settings, &|_| {});
        let whole = render(&world, &camera, &settings, &|_, _| {});
        let ids: Vec<_> = apart.lights.iter().map(|light| &light.ids[..]).collect();
        assert_eq!(ids, [&[77][..], &[lights.parallelograms[0].id]]);
        for (i, pixel) in whole.picture.pixels.iter().enumerate() {
            // Each sample is rounded to f32 light by light, or as a whole.
            let other = rendered.picture.pixels[i];
            assert!(
                (other - *pixel).abs().max_element() <= 1e-6 * pixel.max_element(),
                "{i}"
            );
            let lights = apart.lights.iter().map(|light| light.picture.pixels[i]);
            let sum = apart.own.pixels[i] + lights.sum::<Vec3>();
            assert!(
                (sum - *pixel).abs().max_element() <= 1e-6 * pixel.max_element(),
                "{i}"
            );
        }
        lights.points.clear();
        lights.parallelograms[0].colors = [Vec3::ZERO; 4];
        let dark = render(&with(lights).with_needs(), &camera, &settings, &|_, _| {});
        assert_eq!(
            apart.own, dark.picture,
            "what shines by itself is not rounded otherwise"
        );
    }

    #[test]
    fn of_many_lights_each_has_a_picture_and_those_beyond_the_most_share_one() {
        let size = UVec2::new(9, 7);
        let (camera, settings) = (test_scene::camera(), test_scene::settings(size, 4));
        for points in [8, 9, 10, 29, 30, 31, 32, 100] {
            let world = test_scene::many(1..points + 1);
            let count = world.lights.count();
            let (rendered, apart) = render_lights(&world, &camera, &settings, &|_| {});
            assert_eq!(1 + apart.lights.len(), LightPictures::planes(count));
            let mut ids: Vec<usize> = apart.lights.iter().map(|light| light.ids.len()).collect();
            assert_eq!(ids.iter().sum::<usize>(), count);
            ids.truncate(LightPictures::MOST);
            assert!(ids.iter().all(|ids| *ids == 1), "{count}: {ids:?}");
            for (i, pixel) in rendered.picture.pixels.iter().enumerate() {
                let lights = apart.lights.iter().map(|light| light.picture.pixels[i]);
                let sum = apart.own.pixels[i] + lights.sum::<Vec3>();
                let difference = (sum - *pixel).abs().max_element();
                assert!(difference <= 1e-5 * pixel.max_element(), "{count} {i}");
            }
        }
    }
}
