use crate::scene::RenderSettings;
use crate::trace::{Camera, World, central_ray, first_surface};
use glam::UVec2;
use rayon::prelude::*;

/// How far away the surfaces are that the camera sees, in metres along its view axis, for a picture of
/// `size` pixels, row by row from the top; infinite where it sees none.
///
/// What a depth buffer is made of: one ray a pixel through its middle and the lens' middle, as the
/// shutter opens, on the current rayon pool. Depths change only with the camera and the top level, and with
/// materials where those let light through, so they can be kept over edits of lights; and where they only
/// hide lines, a `size` of a half or a quarter of the picture's will do.
pub fn depths(world: &World, camera: &Camera, settings: &RenderSettings, size: UVec2) -> Vec<f32> {
    let settings = RenderSettings {
        size,
        ..settings.clone()
    };
    let mut depths = vec![f32::INFINITY; size.x as usize * size.y as usize];
    (depths.par_chunks_mut(size.x.max(1) as usize).enumerate()).for_each_init(
        || (Vec::new(), Vec::new()),
        |(rays, hits), (y, row)| {
            rays.clear();
            rays.extend(
                (0..size.x).map(|x| central_ray(camera, &settings, UVec2::new(x, y as u32))),
            );
            world.aggregate.closest_hits(rays, hits);
            for ((depth, ray), hit) in row.iter_mut().zip(&*rays).zip(&*hits) {
                let seen = hit.and_then(|hit| first_surface(world, &settings, ray, hit));
                if let Some(hit) = seen {
                    *depth = hit.t * ray.direction.dot(camera.forward);
                }
            }
        },
    );
    depths
}

#[cfg(test)]
mod tests {
    use super::super::first_hits::FirstHits;
    use super::*;
    use crate::film::test_scene;
    use crate::scene::Projection;
    use glam::Vec3;
    use std::sync::Arc;

    #[test]
    fn depths_are_those_of_the_first_hits_along_the_view_axis() {
        let size = UVec2::new(41, 23);
        let plain = test_scene::world();
        let settings = test_scene::settings(size, 1);
        let mut camera = test_scene::camera();
        // An object is not there at all.
        let mut materials = (*plain.materials).clone();
        materials[plain.objects[1].material as usize].opacity = 0.0;
        let cut_out = World {
            materials: Arc::new(materials),
            ..plain.clone()
        };
        let perspective = camera.projection;
        let flat = Projection::Orthographic { height: 3.0 };
        let mut all = Vec::new();
        for (world, projection) in [
            (plain.clone(), perspective),
            (plain, flat),
            (cut_out.with_needs(), perspective),
        ] {
            camera.projection = projection;
            let hits = FirstHits::trace(&world, &camera, &settings);
            let depths = depths(&world, &camera, &settings, size);
            let mut seen = 0;
            for (i, (depth, hit)) in depths.iter().zip(&hits.centers).enumerate() {
                let pixel = UVec2::new(i as u32 % size.x, i as u32 / size.x);
                let direction = central_ray(&camera, &settings, pixel).direction;
                let expected = hit.depth * direction.dot(camera.forward);
                assert!(
                    *depth == expected || (depth / expected - 1.0).abs() < 1e-6,
                    "{pixel}: {depth}, not {expected}"
                );
                seen += u32::from(depth.is_finite());
            }
            assert!(seen > 100 && seen < size.element_product(), "{seen} seen");
            all.push(depths);
        }
        assert_ne!(all[0], all[2], "what was cut out was seen");
    }

    #[test]
    fn a_wall_across_the_view_is_equally_deep_everywhere_at_any_size() {
        let world = test_scene::world();
        // Straight down onto the floor, 2 m above what stands on it.
        let camera = Camera::looking_at(
            Vec3::new(2.0, 3.0, 2.0),
            Vec3::new(2.0, 0.0, 2.0),
            Vec3::X,
            0.3,
        );
        let settings = test_scene::settings(UVec2::new(640, 480), 1);
        for size in [UVec2::new(7, 5), UVec2::ONE, UVec2::new(8, 5)] {
            let depths = depths(&world, &camera, &settings, size);
            assert_eq!(depths.len() as u32, size.element_product());
            assert!(depths.iter().all(|d| (d - 3.0).abs() < 1e-5), "{depths:?}");
        }
        assert!(depths(&world, &camera, &settings, UVec2::ZERO).is_empty());
    }
}
