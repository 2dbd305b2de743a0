//! The camera's lens: its aperture, the plane that is in focus, and what the picture holds.

use super::color::{CYAN, faint};
use super::line_set::{LineSet, Panel, Stands};
use super::{Subject, System};
use crate::scene::Projection;
use glam::{UVec2, Vec2, Vec3};

/// How much the focus plane covers.
const PLANE_ALPHA: f32 = 0.08;

/// The aperture's circle, the part of the focus plane that the picture shows, and the lines from the
/// middle of the lens to its corners. All as they stand when the shutter opens.
pub(super) fn lens(subject: &Subject) -> LineSet {
    let mut set = LineSet::of(System::Lens, subject.inspect);
    let camera = subject.photographer;
    let optics = &camera.optics;
    let middle = camera.position + optics.velocity * optics.shutter[0];
    if !(subject.settings.features.lens && camera.has_lens()) {
        set.notes
            .push("the camera is a pinhole: aperture radius 0, or features.lens is off".into());
        return set;
    }
    let plane = [camera.right, camera.up];
    set.circle(middle, plane, optics.aperture_radius, CYAN, Stands::Camera);
    if !optics.focus_distance.is_finite() {
        set.notes
            .push("the focus is at infinity: there is no plane".into());
        return set;
    }
    let corners = frame(
        subject.settings.size,
        camera.projection,
        optics.focus_distance,
    )
    .map(|at| {
        middle + optics.focus_distance * camera.forward + at.x * camera.right + at.y * camera.up
    });
    set.closed(&corners, CYAN, Stands::Camera);
    set.planes.push(Panel {
        corner: corners[0],
        edges: [corners[1] - corners[0], corners[3] - corners[0]],
        color: faint(CYAN, PLANE_ALPHA),
        stands: Stands::Camera,
    });
    let starts: [Vec3; 4] = match camera.projection {
        Projection::Perspective { .. } => [middle; 4],
        Projection::Orthographic { .. } => {
            corners.map(|corner| corner - optics.focus_distance * camera.forward)
        }
    };
    for (start, corner) in starts.into_iter().zip(corners) {
        set.line([start, corner], CYAN, Stands::Camera);
    }
    set
}

/// The picture's corners at a distance from the camera, along `right` and `up`, counter-clockwise
/// from the lower left.
fn frame(size: UVec2, projection: Projection, distance: f32) -> [Vec2; 4] {
    let half_height = match projection {
        Projection::Perspective { fov_y } => distance * (0.5 * fov_y).tan(),
        Projection::Orthographic { height } => 0.5 * height,
    };
    let half = Vec2::new(half_height * size.x as f32 / size.y as f32, half_height);
    [
        Vec2::new(-1.0, -1.0),
        Vec2::new(1.0, -1.0),
        Vec2::new(1.0, 1.0),
        Vec2::new(-1.0, 1.0),
    ]
    .map(|corner| corner * half)
}
