//! From a place in the picture to a ray.
//!
//! Perspective: the ray through a pixel meets the image plane at `ndc · tan(fov/2)`, the x axis
//! scaled by width/height. Lens (Cook, Porter, Carpenter 1984): the ray starts at a point of the
//! aperture and goes through the point where the pinhole's ray meets the focus plane, so a point
//! at distance d makes a circle of diameter `2a·|d-f|/d` on the focus plane.

use super::math::disc::concentric;
use crate::bvh::{Ray, TriangleId};
use crate::scene::Projection;
use glam::{Quat, UVec2, Vec2, Vec3};

/// A camera with everything that rays need, in world space.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole, or the middle of the lens, at t = 0.
    pub position: Vec3,
    /// Unit vector to the right of the picture.
    pub right: Vec3,
    /// Unit vector to the top of the picture.
    pub up: Vec3,
    /// Unit vector into the picture.
    pub forward: Vec3,
    /// How directions become places in the picture.
    pub projection: Projection,
    /// Lens, shutter and motion.
    pub optics: Optics,
}

/// What makes a camera more than a pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optics {
    /// 0 is a pinhole.
    pub aperture_radius: f32,
    /// To the focus plane, along `forward`; may be infinite.
    pub focus_distance: f32,
    /// [open, close] in [0, 1].
    pub shutter: [f32; 2],
    /// The camera stands at `position + velocity · t`.
    pub velocity: Vec3,
    /// Samples of a pixel that the lens asks for.
    pub lens_samples: u32,
    /// Samples of a pixel that the camera's motion asks for; 0 where it stands still.
    pub motion_samples: u32,
}

impl Default for Optics {
    fn default() -> Self {
        Self {
            aperture_radius: 0.0,
            focus_distance: 1.0,
            shutter: [0.0, 1.0],
            velocity: Vec3::ZERO,
            lens_samples: 1,
            motion_samples: 0,
        }
    }
}

impl Camera {
    /// A camera at `position`, its local -Z ahead and +Y up, turned by `rotation`.
    pub fn new(position: Vec3, rotation: Quat, projection: Projection, optics: Optics) -> Self {
        Self {
            position,
            right: rotation * Vec3::X,
            up: rotation * Vec3::Y,
            forward: rotation * Vec3::NEG_Z,
            projection,
            optics,
        }
    }

    /// A pinhole at `position` that looks at `target`; `up` need not be perpendicular.
    pub fn looking_at(position: Vec3, target: Vec3, up: Vec3, fov_y: f32) -> Self {
        let forward = (target - position).normalize_or(Vec3::NEG_Z);
        let right = forward
            .cross(up)
            .try_normalize()
            .unwrap_or_else(|| forward.any_orthonormal_vector());
        Self {
            position,
            right,
            up: right.cross(forward),
            forward,
            projection: Projection::Perspective { fov_y },
            optics: Optics::default(),
        }
    }

    /// True where samples need a point on the lens.
    pub fn has_lens(&self) -> bool {
        self.optics.aperture_radius > 0.0
    }

    /// Where the rays of a picture of `size` pixels pass.
    pub fn image_plane(&self, size: UVec2) -> ImagePlane<'_> {
        let size = size.as_vec2();
        ImagePlane {
            camera: self,
            size,
            aspect: size.x / size.y,
            half_height: self.half_height(),
        }
    }

    /// From the image plane's middle to its top edge, in metres: at distance 1, or anywhere where the
    /// projection is orthographic.
    pub(super) fn half_height(&self) -> f32 {
        match self.projection {
            Projection::Perspective { fov_y } => (0.5 * fov_y).tan(),
            Projection::Orthographic { height } => 0.5 * height,
        }
    }

    /// [`ImagePlane::ray`] of a picture of `size` pixels.
    pub fn ray(&self, place: Vec2, size: UVec2, lens: [f32; 2], time: f32) -> Ray {
        self.image_plane(size).ray(place, lens, time)
    }

    /// Where a point of the world lies in a picture of `size` pixels, seen through the pinhole (or the
    /// middle of the lens) at `time`: the inverse of [`Self::ray`]. Columns and rows from the top left
    /// corner, and metres along the view axis; a perspective camera sees nothing that is not ahead.
    pub fn project(&self, point: Vec3, size: UVec2, time: f32) -> Option<(Vec2, f32)> {
        let offset = (point - self.position) - self.optics.velocity * time;
        let ahead = offset.dot(self.forward);
        let at = Vec2::new(offset.dot(self.right), offset.dot(self.up));
        let at = match self.projection {
            Projection::Perspective { .. } if ahead > 0.0 => at / (ahead * self.half_height()),
            Projection::Perspective { .. } => return None,
            Projection::Orthographic { .. } => at / self.half_height(),
        };
        let size = size.as_vec2();
        let ndc = Vec2::new(at.x * (size.y / size.x), at.y);
        let place = 0.5 * Vec2::new(ndc.x + 1.0, 1.0 - ndc.y) * size;
        place.is_finite().then_some((place, ahead))
    }

    /// Shutter time for the number `u` in [0, 1).
    pub fn time(&self, u: f32) -> f32 {
        let [open, close] = self.optics.shutter;
        open + (close - open) * u
    }
}

/// The plane at distance 1 (the film itself of an orthographic camera) that a camera's rays pass through, and what
/// all of them share: computed once and not for each ray.
#[derive(Clone, Copy, Debug)]
pub struct ImagePlane<'a> {
    pub(super) camera: &'a Camera,
    /// Of the picture, in pixels.
    size: Vec2,
    /// Width over height.
    aspect: f32,
    /// [`Camera::half_height`].
    half_height: f32,
}

impl ImagePlane<'_> {
    /// The same of another camera with the same projection.
    pub(super) fn of_camera<'a>(&self, camera: &'a Camera) -> ImagePlane<'a> {
        ImagePlane { camera, ..*self }
    }

    /// The ray through `place` in pixels, (0, 0) at the picture's top left corner, from the lens
    /// point that the numbers `lens` in [0, 1)² choose.
    #[inline(always)]
    pub fn ray(&self, place: Vec2, lens: [f32; 2], time: f32) -> Ray {
        let Self { camera, size, .. } = self;
        let ndc = Vec2::new(2.0 * place.x / size.x - 1.0, 1.0 - 2.0 * place.y / size.y);
        let at = Vec2::new(ndc.x * self.aspect, ndc.y) * self.half_height;
        let moved = |from: Vec3| from + at.x * camera.right + at.y * camera.up;
        // Where the pinhole's ray starts, from the camera: added to its position last, so that it is rounded once.
        let (mut start, mut direction) = match camera.projection {
            Projection::Perspective { .. } => (Vec3::ZERO, moved(camera.forward).normalize()),
            Projection::Orthographic { .. } => (moved(Vec3::ZERO), camera.forward),
        };
        let optics = &camera.optics;
        if optics.velocity != Vec3::ZERO {
            start += optics.velocity * time;
        }
        let mut origin = camera.position + start;
        if camera.has_lens() {
            let p = optics.aperture_radius * concentric(lens);
            origin = camera.position + (start + (p.x * camera.right + p.y * camera.up));
            if optics.focus_distance.is_finite() {
                let to_focus = optics.focus_distance / direction.dot(camera.forward);
                let to_focus = to_focus.min(FARTHEST_FOCUS);
                // From where the ray does start: far from the origin that is another place of the lens, and what is
                // in focus has to stay sharp.
                let offset = (origin - camera.position) - start;
                let aimed = to_focus * direction - offset;
                let size = aimed.abs().max_element();
                let is_ordinary = size > 1.0 / ORDINARY && size < ORDINARY;
                direction = if is_ordinary { aimed } else { aimed / size }.normalize();
            }
        }
        Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
            time,
            starts_on: TriangleId::NONE,
        }
    }
}

/// In metres: no lens is large enough to tell what is farther away from what is infinitely far.
const FARTHEST_FOCUS: f32 = 1e30;
/// The squares of vectors no longer than this, and no shorter than its reciprocal, are ordinary numbers.
const ORDINARY: f32 = 1e18;

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: UVec2 = UVec2::new(640, 480);

    fn camera(optics: Optics) -> Camera {
        Camera {
            optics,
            ..Camera::looking_at(
                Vec3::new(1.0, 2.0, 3.0),
                Vec3::new(0.0, 1.0, -4.0),
                Vec3::Y,
                0.9,
            )
        }
    }

    #[test]
    fn the_middle_looks_ahead_and_the_top_edge_half_the_field_of_view_up() {
        let camera = camera(Optics::default());
        let middle = camera.ray(Vec2::new(320.0, 240.0), SIZE, [0.0; 2], 0.0);
        assert!((middle.direction - camera.forward).length() < 1e-6);
        let top = camera.ray(Vec2::new(320.0, 0.0), SIZE, [0.0; 2], 0.0);
        let angle = top.direction.dot(camera.forward).acos();
        assert!((angle - 0.45).abs() < 1e-5, "{angle}");
        assert!(top.direction.dot(camera.up) > 0.0);
        let right = camera.ray(Vec2::new(640.0, 240.0), SIZE, [0.0; 2], 0.0);
        let slope = right.direction.dot(camera.right) / right.direction.dot(camera.forward);
        assert!((slope - 0.45_f32.tan() * 640.0 / 480.0).abs() < 1e-5);
    }

    #[test]
    fn a_lens_focuses_as_near_and_as_far_as_numbers_go() {
        for (focus_distance, aperture_radius) in [
            (1e-30, 1e-30),
            (1e-20, 1e-3),
            (2e19, 0.1),
            (1e30, 0.1),
            (f32::MAX, 0.1),
        ] {
            let camera = camera(Optics {
                aperture_radius,
                focus_distance,
                ..Optics::default()
            });
            for lens in [[0.1, 0.2], [0.5, 0.5], [0.9, 0.3]] {
                let ray = camera.ray(Vec2::new(3.0, 4.0), SIZE, lens, 0.0);
                let length = ray.direction.length();
                assert!((length - 1.0).abs() < 1e-6, "{focus_distance:e}: {ray:?}");
            }
        }
    }

    #[test]
    fn a_point_on_a_pixels_ray_is_projected_to_its_place() {
        let perspective = camera(Optics {
            velocity: Vec3::new(0.3, -0.2, 0.1),
            ..Optics::default()
        });
        let orthographic = Camera {
            projection: Projection::Orthographic { height: 2.0 },
            ..perspective.clone()
        };
        for camera in [perspective, orthographic] {
            for place in [Vec2::new(3.0, 4.0), Vec2::new(600.5, 17.25)] {
                let ray = camera.ray(place, SIZE, [0.5; 2], 0.7);
                let (found, ahead) = camera.project(ray.at(5.0), SIZE, 0.7).unwrap();
                assert!((found - place).length() < 1e-2, "{place} became {found}");
                assert!((ahead - 5.0 * ray.direction.dot(camera.forward)).abs() < 1e-4);
            }
        }
        let behind = camera(Optics::default());
        assert_eq!(
            behind.project(behind.position - behind.forward, SIZE, 0.0),
            None
        );
    }

    #[test]
    fn an_aperture_of_zero_is_the_pinhole_bit_for_bit() {
        let pinhole = camera(Optics::default());
        let lens = camera(Optics {
            aperture_radius: 0.0,
            focus_distance: 5.0,
            ..Optics::default()
        });
        for place in [Vec2::new(3.0, 4.0), Vec2::new(600.5, 17.25)] {
            let a = pinhole.ray(place, SIZE, [0.3, 0.9], 0.0);
            let b = lens.ray(place, SIZE, [0.1, 0.2], 0.0);
            assert_eq!((a.origin, a.direction), (b.origin, b.direction));
        }
    }

    #[test]
    fn all_rays_of_a_lens_meet_on_the_focus_plane_and_are_parallel_when_it_is_infinitely_far() {
        let sharp = camera(Optics {
            aperture_radius: 0.2,
            focus_distance: 7.0,
            ..Optics::default()
        });
        let place = Vec2::new(500.0, 100.0);
        let on_plane = |lens| {
            let ray = sharp.ray(place, SIZE, lens, 0.0);
            let t = (7.0 - (ray.origin - sharp.position).dot(sharp.forward))
                / ray.direction.dot(sharp.forward);
            ray.origin + t * ray.direction
        };
        let far = camera(Optics {
            aperture_radius: 0.2,
            focus_distance: f32::INFINITY,
            ..Optics::default()
        });
        for lens in [[0.0, 0.0], [0.9, 0.1], [0.4, 0.99], [0.5, 0.5]] {
            let distance = (on_plane(lens) - on_plane([0.5, 0.5])).length();
            assert!(distance < 1e-5, "{lens:?} misses by {distance}");
            let parallel = far.ray(place, SIZE, lens, 0.0).direction;
            assert_eq!(parallel, far.ray(place, SIZE, [0.5, 0.5], 0.0).direction);
        }
    }

    #[test]
    fn an_orthographic_camera_keeps_sizes() {
        let camera = Camera {
            projection: Projection::Orthographic { height: 2.0 },
            ..camera(Optics::default())
        };
        let top = camera.ray(Vec2::new(320.0, 0.0), SIZE, [0.0; 2], 0.0);
        assert_eq!(top.direction, camera.forward);
        assert!(((top.origin - camera.position) - camera.up).length() < 1e-6);
    }
}
