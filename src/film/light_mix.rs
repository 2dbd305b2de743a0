//! What a view makes of the light that is kept apart: nothing of it changes the scene.

use crate::trace::Gains;

/// How a view mixes what its lights add.
#[derive(Clone, Debug, PartialEq)]
pub struct LightMix {
    /// Lights have planes of their own, so that another tint costs no ray and one that moves only its own. Without them the
    /// picture is the same, but for the rounding of f32, and each edit renders all of it again. (A gain that is not the same
    /// for all channels then makes another gradient of a light that has one, and samples lie elsewhere on it.)
    pub apart: bool,
    /// What multiplies each.
    pub gains: Gains,
}

impl Default for LightMix {
    fn default() -> Self {
        Self {
            apart: true,
            gains: Gains::default(),
        }
    }
}

/// What a film takes, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmMemory {
    /// Planes of light that is kept apart; none where it is not.
    pub planes: usize,
    /// Of one of them.
    pub plane: u64,
    /// What camera rays hit, and those that leave there, and what hides lights: kept while lights and materials are edited.
    pub hits: u64,
    /// Of all of it: the planes, what the others are together while one is edited, and those hits.
    pub total: u64,
}

#[cfg(test)]
mod tests {
    use super::super::subject::Subject;
    use super::super::test_scene::{camera, edited, lit, many, settings};
    use super::super::{Ending, LightMix, Picture, Progressive};
    use crate::trace::{Gains, World};
    use glam::{UVec2, Vec3};

    const SIZE: UVec2 = UVec2::new(37, 22);

    fn start(world: &World, spp: u32) -> Progressive {
        Progressive::start(world.clone(), camera(), settings(SIZE, spp)).unwrap()
    }

    fn gain(id: u64, gain: Vec3) -> Gains {
        std::iter::once((id, gain)).collect()
    }

    #[test]
    fn a_gain_takes_no_ray_and_is_the_picture_of_a_render_with_that_gain_even_of_a_gradient() {
        let world = lit();
        let render = start(&world, 16);
        render.wait();
        let (rays, plain) = (render.status().rays, render.snapshot().picture);
        let spectra = [Vec3::new(0.3, 2.7, 1.0), Vec3::ZERO, Vec3::splat(f32::NAN)];
        for (id, factor) in [100, 102, 103].into_iter().zip(spectra) {
            let gains = gain(id, factor);
            assert!(render.edit(world.clone(), &gains), "light {id}");
            assert_eq!(render.wait(), Ending::Samples);
            assert_eq!(render.status().rays, rays, "no ray more for light {id}");
            let mix = LightMix {
                gains,
                ..LightMix::default()
            };
            let settings = settings(SIZE, 16);
            let fresh = Progressive::start_region(world.clone(), camera(), settings, None, &mix);
            let fresh = fresh.unwrap();
            fresh.wait();
            let mixed = render.snapshot().picture;
            assert_eq!(mixed, fresh.snapshot().picture, "light {id}");
            assert_eq!(mixed == plain, factor.x.is_nan(), "light {id}");
        }
        assert!(render.edit(world, &Gains::default()));
        assert_eq!(render.snapshot().picture, plain);
        assert_eq!(render.status().rays, rays);
    }

    #[test]
    fn the_largest_gain_leaves_the_picture_a_picture() {
        let world = lit();
        let render = start(&world, 4);
        render.wait();
        let plain = render.snapshot().picture;
        // Two lights that do what a sum cannot hold, and others beside them as they are.
        let bright = edited(&world, |lights| {
            lights.points[0].color = Vec3::MAX;
            lights.directionals[0].color = Vec3::MAX;
        });
        let gains = [(100, Vec3::splat(1e30)), (103, Vec3::ONE)].into_iter();
        assert!(render.edit(bright, &gains.collect()));
        // Lights that are so much brighter are kept in other powers of two, and so traced again.
        render.wait();
        let pixels = render.snapshot().picture.pixels;
        for (pixel, plain) in pixels.iter().zip(&plain.pixels) {
            assert!(
                pixel.is_finite() && pixel.cmpge(*plain * 0.999).all(),
                "{pixel} where it was {plain}"
            );
        }
    }

    #[test]
    fn a_light_that_is_edited_has_a_plane_of_its_own_however_many_there_are() {
        let world = many(1..25);
        let render = start(&world, 4);
        render.wait();
        let edit = |render: &Progressive, red: f32| {
            let before = render.status().rays.total();
            let world = edited(&world, |lights| lights.points[20].color.x = red);
            assert!(render.edit(world.clone(), &Gains::default()));
            render.wait();
            (world, render.status().rays.total() - before)
        };
        let (_, first) = edit(&render, 0.5);
        assert!(first > 0, "it shared a plane");
        let (last, second) = edit(&render, 0.9);
        assert_eq!(second, 0, "rays for a light that is edited once more");
        let fresh = start(&last, 4);
        fresh.wait();
        let pictures = [&render, &fresh].map(|render| render.snapshot().picture);
        for (one, other) in pictures[0].pixels.iter().zip(&pictures[1].pixels) {
            // Lights that share a plane are added in f32.
            let difference = (*one - *other).abs().max_element();
            assert!(difference <= 1e-5 * other.max_element(), "{one} {other}");
        }
    }

    #[test]
    fn a_thousand_lights_are_edited_like_a_few() {
        let world = many(1..1001);
        let render = start(&world, 1);
        render.wait();
        assert_eq!(render.memory().planes, 10);
        let gains = gain(777, Vec3::ZERO);
        // On a slow machine another render has its first picture sooner.
        let render = match render.edit(world.clone(), &gains) {
            true => render,
            false => {
                let (settings, mix) = (
                    settings(SIZE, 1),
                    LightMix {
                        gains,
                        ..LightMix::default()
                    },
                );
                Progressive::start_region(world.clone(), camera(), settings, None, &mix).unwrap()
            }
        };
        render.wait();
        let dark = edited(&world, |lights| lights.points[776].color = Vec3::ZERO);
        let fresh = start(&dark, 1);
        fresh.wait();
        for (one, other) in
            (render.snapshot().picture.pixels.iter()).zip(&fresh.snapshot().picture.pixels)
        {
            let difference = (*one - *other).abs().max_element();
            assert!(difference <= 1e-4 * other.max_element(), "{one} {other}");
        }
    }

    #[test]
    fn with_lights_in_one_plane_the_picture_is_the_same_and_gains_count() {
        let world = lit();
        // Of one colour: where a light has a gradient, another gradient is met at other places.
        let gains = gain(104, Vec3::new(0.5, 2.0, 1.0));
        let render = |apart| {
            let mix = LightMix {
                apart,
                gains: gains.clone(),
            };
            let render =
                Progressive::start_region(world.clone(), camera(), settings(SIZE, 8), None, &mix);
            let render = render.unwrap();
            render.wait();
            render
        };
        let [apart, together] = [true, false].map(render);
        assert_eq!([apart.memory().planes, together.memory().planes], [6, 0]);
        assert!(together.memory().total < apart.memory().total);
        assert!(together.light_sketches(UVec2::new(4, 3)).is_none());
        let pictures = [&apart, &together].map(|render| render.snapshot().picture);
        for (one, other) in pictures[0].pixels.iter().zip(&pictures[1].pixels) {
            let difference = (*one - *other).abs().max_element();
            assert!(difference <= 1e-6 * other.max_element(), "{one} {other}");
        }
        assert!(
            !together.edit(world.clone(), &Gains::default()),
            "another render begins"
        );
    }

    #[test]
    fn planes_of_a_large_picture_take_no_more_than_they_may() {
        for (size, planes) in [([1280, 720], 10), ([3840, 2160], 2), ([8192, 8192], 0)] {
            let settings = settings(size.into(), 1);
            let subject = Subject::new(many(1..41), camera(), settings, true);
            let bytes = 60 * u64::from(size[0]) * u64::from(size[1]) * subject.planes() as u64;
            let apart = if subject.stays_apart {
                subject.planes()
            } else {
                0
            };
            assert_eq!(apart, planes, "{size:?}");
            assert!(apart == 0 || bytes <= 1_000_000_000, "{bytes} of {size:?}");
        }
    }

    #[test]
    fn sketches_are_the_planes_of_the_lights_in_their_colours_whatever_the_gains() {
        let world = lit();
        let size = UVec2::new(8, 5);
        let render = start(&world, 8);
        render.wait();
        let plain = render.light_sketches(size).unwrap();
        assert_eq!(plain.lights.len(), 5);
        let sum = |sketch: &Picture| sketch.pixels.iter().sum::<Vec3>();
        for light in &plain.lights {
            assert!(sum(&light.picture).max_element() > 0.0, "{:?}", light.ids);
        }
        assert!(render.edit(world.clone(), &gain(100, Vec3::ZERO)));
        let muted = render.light_sketches(size).unwrap();
        assert_eq!(muted.lights[0].picture, plain.lights[0].picture);
        let red = edited(&world, |lights| lights.points[0].color = Vec3::X);
        assert!(render.edit(red, &Gains::default()));
        let red = render.light_sketches(size).unwrap();
        let sums = [&plain, &red].map(|lights| sum(&lights.lights[0].picture));
        assert!((sums[1].x / sums[0].x - 0.5).abs() < 1e-4 && sums[1].y == 0.0);
        assert_eq!(red.lights[1].picture, plain.lights[1].picture);
    }
}
