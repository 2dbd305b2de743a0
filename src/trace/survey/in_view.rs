//! Where in a picture anything may be seen: rectangles around what there is. Outside of them no camera ray meets anything,
//! and none has to be traced to know it.

use crate::scene::{Lighting, Projection, RenderSettings};
use crate::trace::{Camera, World};
use bevy::math::URect;
use glam::{UVec2, Vec2, Vec3};

/// Boxes of which the rectangles are looked for, at most: a fraction of a millisecond.
const MOST_BOXES: usize = 1024;
/// A perspective camera's boxes lie ahead of it by at least this part of their distance: beside it, where places run off to
/// infinity, they would be rounded by pixels.
const LEAST_AHEAD: f32 = 0.01;
/// Around a box, in pixels: one, and a thousandth of the picture for the rounding of rays and of places in it.
const MARGIN: f32 = 1.0;
const RELATIVE_MARGIN: f32 = 1e-3;
/// Of a light's corner, as a part of its distance from the origin or the camera: some units of rounding.
const LIGHT_PAD: f32 = 64.0 * f32::EPSILON;

/// Rectangles of pixels outside of which no camera ray meets anything. `None` where none are known: through a lens or from
/// a camera that moves, and where something lies beside or behind the camera, or there is very much.
pub fn in_view(world: &World, camera: &Camera, settings: &RenderSettings) -> Option<Vec<URect>> {
    let instances = world.aggregate.instances();
    let still = camera.optics.velocity == Vec3::ZERO;
    if camera.has_lens() || !still || instances.len() > MOST_BOXES {
        return None;
    }
    let size = settings.size.max(UVec2::ONE);
    // As far from the origin as rays start.
    let reach = match camera.projection {
        Projection::Perspective { .. } => 0.0,
        Projection::Orthographic { .. } => {
            camera.half_height() * (1.0 + size.x as f32 / size.y as f32)
        }
    };
    let start = camera.position.abs().max_element() + reach;
    let objects = instances.iter().filter_map(|instance| {
        let bounds = instance.world_bounds()?;
        let [min, max]: [Vec3; 2] = [bounds.min.into(), bounds.max.into()];
        let pad = instance.ray_pad() * start;
        Some([min - pad, max + pad])
    });
    let mut boxes: Vec<[Vec3; 2]> = objects.collect();
    if settings.lighting == Lighting::Physical && world.needs.visible_lights {
        let lights = &world.lights;
        if !lights.moving.is_empty() {
            return None;
        }
        for light in lights.parallelograms.iter().filter(|light| light.visible) {
            let corners = light.corners();
            let min = corners.into_iter().fold(Vec3::INFINITY, Vec3::min);
            let max = corners.into_iter().fold(Vec3::NEG_INFINITY, Vec3::max);
            let pad = LIGHT_PAD * start.max(min.abs().max(max.abs()).max_element());
            boxes.push([min - pad, max + pad]);
        }
    }
    let mut rectangles = Vec::with_capacity(boxes.len());
    for bounds in boxes {
        let rectangle = rectangle(bounds, camera, size)?;
        if !rectangle.is_empty() {
            rectangles.push(rectangle);
        }
    }
    Some(rectangles)
}

/// The pixels in which a box may be seen.
fn rectangle([min, max]: [Vec3; 2], camera: &Camera, size: UVec2) -> Option<URect> {
    let is_perspective = matches!(camera.projection, Projection::Perspective { .. });
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for corner in 0..8 {
        let of = |axis: usize| {
            if corner >> axis & 1 == 0 {
                min[axis]
            } else {
                max[axis]
            }
        };
        let corner = Vec3::new(of(0), of(1), of(2));
        let (place, ahead) = camera.project(corner, size, 0.0)?;
        if is_perspective && ahead < LEAST_AHEAD * corner.distance(camera.position) {
            return None;
        }
        (low, high) = (low.min(place), high.max(place));
    }
    let margin = MARGIN + RELATIVE_MARGIN * size.max_element() as f32;
    let end = size.as_vec2();
    Some(URect {
        min: (low - margin).clamp(Vec2::ZERO, end).as_uvec2(),
        max: (high + margin).clamp(Vec2::ZERO, end).ceil().as_uvec2(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{ParallelogramLight, SampleId, Workspace, radiance, test_scene};
    use std::sync::Arc;

    const SIZE: UVec2 = UVec2::new(96, 64);

    fn has(rectangles: &[URect], pixel: UVec2) -> bool {
        rectangles
            .iter()
            .any(|r| pixel.cmpge(r.min).all() && pixel.cmplt(r.max).all())
    }

    #[test]
    fn outside_of_the_rectangles_no_sample_meets_anything() {
        let mut world = test_scene::world();
        let mut lights = (*world.lights).clone();
        lights.parallelograms.push(ParallelogramLight {
            id: 77,
            corner: Vec3::new(-4.0, 3.0, 1.0),
            edges: [Vec3::X, Vec3::Z],
            colors: [Vec3::splat(6.0); 4],
            two_sided: true,
            visible: true,
            samples: 1,
        });
        lights.moving.clear();
        world.lights = Arc::new(lights);
        world.environment.map = None;
        world.environment.background = Vec3::new(0.25, 0.5, 0.125);
        let world = world.with_needs();
        let settings = RenderSettings {
            size: SIZE,
            ..RenderSettings::default()
        };
        let background = world.environment.background;
        let (mut outside, mut inside) = (0, 0);
        let mut numbers = test_scene::Numbers(11);
        let mut workspace = Workspace::default();
        for view in 0..40 {
            let distance = 100.0 * (1.0 + 30.0 * numbers.next());
            let target = 200.0 * numbers.in_cube();
            let eye = target + distance * numbers.in_cube().normalize_or(Vec3::Z);
            let mut camera = Camera::looking_at(eye, target, Vec3::Y, 0.3 + numbers.next());
            if view % 4 == 3 {
                camera.projection = Projection::Orthographic {
                    height: 50.0 + 400.0 * numbers.next(),
                };
            }
            let Some(rectangles) = in_view(&world, &camera, &settings) else {
                continue;
            };
            let pixels = (0..SIZE.element_product()).map(|i| UVec2::new(i % SIZE.x, i / SIZE.x));
            let ids: Vec<SampleId> = pixels
                .flat_map(|pixel| (0..4).map(move |index| SampleId { pixel, index }))
                .collect();
            let mut values = vec![Vec3::ZERO; ids.len()];
            radiance(
                &world,
                &camera,
                &settings,
                &ids,
                &mut values,
                &mut workspace,
            );
            for (id, value) in ids.iter().zip(&values) {
                if has(&rectangles, id.pixel) {
                    inside += 1;
                } else {
                    outside += 1;
                    assert_eq!(*value, background, "{id:?} of view {view}");
                }
            }
        }
        assert!(outside > 10_000 && inside > 1000, "{outside} and {inside}");
    }

    #[test]
    fn nothing_is_said_of_lenses_of_moving_cameras_and_of_what_is_beside_or_behind_the_camera() {
        let world = test_scene::world();
        let settings = RenderSettings::default();
        let far = Camera::looking_at(Vec3::new(0.0, 0.0, 4000.0), Vec3::ZERO, Vec3::Y, 0.5);
        let is_known = |camera: &Camera| in_view(&world, camera, &settings).is_some();
        assert!(is_known(&far) || !world.lights.moving.is_empty());
        let mut lens = far.clone();
        lens.optics.aperture_radius = 0.1;
        let mut moving = far.clone();
        moving.optics.velocity = Vec3::X;
        let amid = Camera::looking_at(Vec3::ZERO, Vec3::X, Vec3::Y, 0.5);
        for camera in [lens, moving, amid] {
            assert!(!is_known(&camera), "{camera:?}");
        }
    }
}
