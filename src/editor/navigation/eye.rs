//! Where the view stands, and the ways in which a hand moves it. Plain arithmetic: no window.

use super::super::action::Axis;
use crate::bvh::REACH;
use bevy::ecs::reflect::ReflectResource;
use bevy::ecs::resource::Resource;
use bevy::math::{EulerRot, Quat, Vec2, Vec3};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::Transform;
use std::f32::consts::{FRAC_PI_2, PI};

/// How far the view turns for a drag across its whole height, in radians.
const TURN: f32 = PI;
/// Room around what is framed, as a factor.
const MARGIN: f32 = 1.1;
/// Limits of the distance to the pivot, in metres. With [`FARTHEST_PIVOT`] and [`FARTHEST_BACK`] the eye stays where rays
/// are traced from.
pub(super) const DISTANCE: [f32; 2] = [1e-4, 0.36 * REACH];
/// How far from the origin what is framed may lie along each axis, in metres.
const FARTHEST_PIVOT: f32 = 0.25 * REACH;
/// How far an orthographic view may stand back, in metres.
pub(super) const FARTHEST_BACK: f32 = 0.2 * REACH;

/// The view: it turns around a pivot that lies on its axis.
///
/// Turned about the vertical first, then up or down, then about its own axis, so that the horizon
/// stays level however it is dragged.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq, Debug)]
pub struct Eye {
    /// What the view turns around.
    pub pivot: Vec3,
    /// From the eye to the pivot, in metres.
    pub distance: f32,
    /// About the vertical, in radians; at 0 the view looks along -Z.
    pub yaw: f32,
    /// Above the horizontal, in radians, from -π/2 to π/2.
    pub pitch: f32,
    /// About the view's own axis, in radians.
    pub roll: f32,
    /// Vertical field of view in radians, between 0 and π.
    pub fov_y: f32,
    /// Far things keep their size. What lies in the plane of the pivot has the size that it has in
    /// perspective.
    pub orthographic: bool,
    /// How many metres further an orthographic view stands back, so that nothing is behind it.
    pub back: f32,
}

impl Default for Eye {
    fn default() -> Self {
        Self {
            pivot: Vec3::ZERO,
            distance: 4.0,
            yaw: 0.5,
            pitch: -0.4,
            roll: 0.0,
            fov_y: 50_f32.to_radians(),
            orthographic: false,
            back: 0.0,
        }
    }
}

impl Eye {
    /// A view with the place and direction of `transform`, whose scale is not read.
    pub fn from_transform(transform: &Transform, distance: f32) -> Self {
        let mut eye = Self {
            distance: distance.clamp(DISTANCE[0], DISTANCE[1]),
            ..Self::default()
        };
        eye.set_rotation(transform.rotation);
        eye.pivot = transform.translation + eye.forward() * eye.distance;
        eye
    }

    fn set_rotation(&mut self, rotation: Quat) {
        let (yaw, pitch, roll) = rotation.to_euler(EulerRot::YXZ);
        (self.yaw, self.pitch, self.roll) = (yaw, pitch, roll);
    }

    /// From the view's axes to the world's.
    pub fn rotation(&self) -> Quat {
        Quat::from_euler(EulerRot::YXZ, self.yaw, self.pitch, self.roll)
    }

    /// Unit vector into the picture.
    pub fn forward(&self) -> Vec3 {
        self.rotation() * Vec3::NEG_Z
    }

    /// Where the camera stands.
    pub fn position(&self) -> Vec3 {
        let back = if self.orthographic { self.back } else { 0.0 };
        self.pivot - self.forward() * (self.distance + back)
    }

    /// The camera's place and direction.
    pub fn transform(&self) -> Transform {
        Transform::from_translation(self.position()).with_rotation(self.rotation())
    }

    /// Height of what the view shows of the plane through the pivot, in metres.
    pub fn height(&self) -> f32 {
        2.0 * self.distance * (0.5 * self.fov_y).tan()
    }

    /// The point of the plane through the pivot at `ndc`, each from -1 to 1, y up.
    pub fn on_pivot_plane(&self, ndc: Vec2, aspect: f32) -> Vec3 {
        let half = 0.5 * self.height();
        let rotation = self.rotation();
        self.pivot + rotation * Vec3::new(ndc.x * half * aspect, ndc.y * half, 0.0)
    }

    /// Turns the head: the eye stays where it is.
    pub fn look(&mut self, delta: Vec2) {
        let position = self.position();
        self.orbit(delta);
        let ahead = self.pivot - self.position();
        self.pivot = position + ahead;
    }

    /// Turns around the pivot: `delta` is a drag in heights of the view, y down.
    pub fn orbit(&mut self, delta: Vec2) {
        self.yaw = wrapped(self.yaw - delta.x * TURN);
        self.pitch = (self.pitch - delta.y * TURN).clamp(-FRAC_PI_2, FRAC_PI_2);
    }

    /// Moves with the hand: what lies in the pivot's plane stays under the pointer.
    pub fn pan(&mut self, delta: Vec2) {
        let moved = Vec3::new(-delta.x, delta.y, 0.0) * self.height();
        self.pivot += self.rotation() * moved;
    }

    /// Moves the eye so that its distance to `toward` is multiplied by `factor`; `toward` keeps its
    /// place in the picture.
    pub fn zoom(&mut self, factor: f32, toward: Vec3) {
        let distance = (self.distance * factor).clamp(DISTANCE[0], DISTANCE[1]);
        let factor = distance / self.distance;
        self.pivot = toward + (self.pivot - toward) * factor;
        self.distance = distance;
    }

    /// Flies by `step` metres along the view's own axes: right, up, back.
    pub fn fly(&mut self, step: Vec3) {
        self.pivot += self.rotation() * step;
    }

    /// Shows the whole ball, from the direction that it has.
    pub fn frame(&mut self, centre: Vec3, radius: f32, aspect: f32) {
        let radius = radius.max(DISTANCE[0]) * MARGIN;
        let tan = (0.5 * self.fov_y).tan();
        let narrow = aspect.min(1.0);
        let distance = if self.orthographic {
            radius / (tan * narrow)
        } else {
            radius / (tan * narrow).atan().sin()
        };
        self.pivot = centre.clamp(Vec3::splat(-FARTHEST_PIVOT), Vec3::splat(FARTHEST_PIVOT));
        self.distance = distance.clamp(DISTANCE[0], DISTANCE[1]);
        self.back = self.back.min(FARTHEST_BACK);
    }

    /// Looks along an axis of the world, at the pivot, without perspective.
    pub fn look_along(&mut self, axis: Axis) {
        (self.yaw, self.pitch) = match axis {
            Axis::Front => (0.0, 0.0),
            Axis::Back => (PI, 0.0),
            Axis::Right => (FRAC_PI_2, 0.0),
            Axis::Left => (-FRAC_PI_2, 0.0),
            Axis::Top => (0.0, -FRAC_PI_2),
            Axis::Bottom => (0.0, FRAC_PI_2),
        };
        self.roll = 0.0;
        self.orthographic = true;
    }
}

/// The same angle between -π and π, so that no number of turns costs precision.
fn wrapped(angle: f32) -> f32 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Vec3, b: Vec3) -> bool {
        (a - b).length() < 1e-4 * (1.0 + a.length())
    }

    /// Where a point of the world is in the picture, in ndc.
    fn seen(eye: &Eye, point: Vec3, aspect: f32) -> Vec2 {
        let view = eye.rotation().inverse() * (point - eye.position());
        let half = (0.5 * eye.fov_y).tan();
        let depth = if eye.orthographic {
            eye.distance
        } else {
            -view.z
        };
        Vec2::new(view.x / (half * aspect), view.y / half) / depth
    }

    #[test]
    fn orbiting_keeps_the_pivot_and_the_distance_and_the_horizon() {
        let mut eye = Eye::default();
        for _ in 0..100 {
            eye.orbit(Vec2::new(0.31, 0.17));
            assert!((eye.position().distance(eye.pivot) - eye.distance).abs() < 1e-4);
            let right = eye.rotation() * Vec3::X;
            assert!(right.y.abs() < 1e-5, "the horizon tilts: {right}");
            let up = eye.rotation() * Vec3::Y;
            assert!(up.y > -1e-5, "the view is upside down: {up}");
        }
    }

    #[test]
    fn looking_around_keeps_the_eye_where_it_is() {
        let mut eye = Eye::default();
        let position = eye.position();
        eye.look(Vec2::new(0.2, -0.1));
        assert!(close(eye.position(), position), "{}", eye.position());
    }

    #[test]
    fn what_is_under_the_pointer_stays_there_while_panning_and_zooming() {
        for orthographic in [false, true] {
            let mut eye = Eye {
                orthographic,
                back: 10.0,
                ..Eye::default()
            };
            let ndc = Vec2::new(0.4, -0.7);
            let point = eye.on_pivot_plane(ndc, 1.5);
            assert!((seen(&eye, point, 1.5) - ndc).length() < 1e-4);
            eye.zoom(0.5, point);
            let now = seen(&eye, point, 1.5);
            assert!((now - ndc).length() < 1e-4, "zooming moved it to {now}");
            // A drag of a tenth of the height to the right and down.
            eye.pan(Vec2::new(0.1, 0.1));
            let now = seen(&eye, point, 1.5);
            let wanted = ndc + Vec2::new(0.2 / 1.5, -0.2);
            assert!((now - wanted).length() < 1e-4, "panning moved it to {now}");
        }
    }

    #[test]
    fn zooming_to_a_hit_halves_the_distance_to_it() {
        let mut eye = Eye::default();
        let hit = eye.position() + eye.forward() * 1.5 + Vec3::X * 0.2;
        let before = eye.position().distance(hit);
        eye.zoom(0.5, hit);
        let after = eye.position().distance(hit);
        assert!((after - 0.5 * before).abs() < 1e-4, "{before} to {after}");
    }

    #[test]
    fn what_is_framed_fills_the_view_and_does_not_leave_it() {
        for (orthographic, aspect) in [(false, 2.0), (false, 0.5), (true, 2.0), (true, 0.5)] {
            let mut eye = Eye {
                orthographic,
                ..Eye::default()
            };
            let centre = Vec3::new(1.0, 2.0, 3.0);
            eye.frame(centre, 0.7, aspect);
            let (right, up) = (eye.rotation() * Vec3::X, eye.rotation() * Vec3::Y);
            let mut largest = 0.0_f32;
            for i in 0..64 {
                let angle = i as f32 / 64.0 * 2.0 * PI;
                let rim = centre + 0.7 * (right * angle.cos() + up * angle.sin());
                largest = largest.max(seen(&eye, rim, aspect).abs().max_element());
            }
            assert!((0.75..=1.0).contains(&largest), "{largest}");
        }
    }

    #[test]
    fn a_camera_that_is_taken_over_is_seen_from_the_same_place() {
        for (eye, target, up) in [
            (Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, Vec3::Y),
            (Vec3::new(0.0, 5.0, 0.0), Vec3::ZERO, Vec3::NEG_Z),
            (
                Vec3::new(-2.0, 0.1, 1.0),
                Vec3::ONE,
                Vec3::new(0.3, 1.0, 0.2),
            ),
        ] {
            let transform = Transform::from_translation(eye).looking_at(target, up);
            let taken = Eye::from_transform(&transform, 2.0).transform();
            assert!(close(taken.translation, transform.translation));
            assert!(close(
                taken.rotation * Vec3::Y,
                transform.rotation * Vec3::Y
            ));
            assert!(close(
                taken.rotation * Vec3::Z,
                transform.rotation * Vec3::Z
            ));
        }
    }

    #[test]
    fn axis_views_look_along_their_axes() {
        for (axis, ahead, up) in [
            (Axis::Front, Vec3::NEG_Z, Vec3::Y),
            (Axis::Back, Vec3::Z, Vec3::Y),
            (Axis::Right, Vec3::NEG_X, Vec3::Y),
            (Axis::Left, Vec3::X, Vec3::Y),
            (Axis::Top, Vec3::NEG_Y, Vec3::NEG_Z),
            (Axis::Bottom, Vec3::Y, Vec3::Z),
        ] {
            let mut eye = Eye::default();
            eye.look_along(axis);
            assert!(close(eye.forward(), ahead), "{axis:?} {}", eye.forward());
            assert!(close(eye.rotation() * Vec3::Y, up), "{axis:?}");
        }
    }

    #[test]
    fn framing_keeps_the_eye_where_rays_are_traced_from() {
        for size in [0.0, 1e-30, 1.0, 1e12, 1e30, f32::MAX] {
            for (orthographic, axis) in [(false, Vec3::X), (true, Vec3::NEG_ONE)] {
                let mut eye = Eye {
                    orthographic,
                    back: size,
                    ..Eye::default()
                };
                eye.frame(axis * size, size, 1.5);
                let position = eye.position();
                assert!(position.abs().max_element() < REACH, "{size}: {position}");
                assert!(eye.height().is_finite() && eye.distance > 0.0, "{size}");
            }
        }
    }

    #[test]
    fn no_zoom_leaves_the_range_or_loses_the_view() {
        let mut eye = Eye::default();
        for factor in [1e-30, 1e30, 1e30, 1e-30] {
            eye.zoom(factor, Vec3::ONE);
            assert!(eye.position().is_finite() && eye.distance > 0.0);
        }
    }
}
