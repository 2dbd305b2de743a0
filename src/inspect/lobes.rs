//! The discs that blurred reflections and transmissions are drawn from, at the hits of debug rays.

use super::color::{CYAN, YELLOW};
use super::line_set::{LineSet, Stands};
use super::rays::is_shown;
use super::{Subject, System};
use crate::trace::{RayHit, RayKind, TracedRay};
use glam::Vec3;

/// The disc stands this part of the hit's distance from the camera away from the hit.
const DISTANCE: f32 = 0.15;

/// The disc of each hit that scatters, and where each ray passes it.
pub(super) fn lobes(subject: &Subject) -> LineSet {
    let mut set = LineSet::of(System::Lobes, subject.inspect);
    let Some(tree) = subject.rays else {
        set.notes.push("no pixel was picked".into());
        return set;
    };
    let mut drawn = [None; 2];
    for (index, ray) in (0..).zip(&tree.rays) {
        let way = match ray.kind {
            RayKind::Gloss => 0,
            RayKind::Translucency => 1,
            _ => continue,
        };
        if !is_shown(&subject.inspect.rays, ray) {
            continue;
        }
        let Some(parent) = ray.parent else { continue };
        let Some(hit) = tree.rays[parent as usize].hit else {
            continue;
        };
        let disc = Disc::new(subject, &hit, ray);
        if drawn[way] != Some(parent) {
            drawn[way] = Some(parent);
            let plane = disc.axis.any_orthonormal_pair();
            let plane = [plane.0, plane.1];
            set.circle(disc.center, plane, disc.radius, CYAN, Stands::Ray(parent));
            set.line([hit.position, disc.center], CYAN, Stands::Ray(parent));
        }
        if let Some(at) = disc.passed_by(&hit, ray) {
            set.dot(at, YELLOW, Stands::Ray(index));
        }
    }
    if drawn == [None; 2] {
        set.notes.push(
            "no debug ray met a surface that blurs (features.glossy, features.translucency)".into(),
        );
    }
    set
}

struct Disc {
    center: Vec3,
    axis: Vec3,
    radius: f32,
}

impl Disc {
    fn new(subject: &Subject, hit: &RayHit, ray: &TracedRay) -> Self {
        let axis = if ray.kind == RayKind::Gloss {
            mirrored(hit)
        } else {
            -hit.to_viewer
        };
        let distance = DISTANCE * (hit.position - subject.camera.position).length();
        Self {
            center: hit.position + distance * axis,
            axis,
            radius: distance / hit.shininess,
        }
    }

    /// Where a ray from the hit passes the disc's plane.
    fn passed_by(&self, hit: &RayHit, ray: &TracedRay) -> Option<Vec3> {
        let along = ray.direction.dot(self.axis);
        let distance = (self.center - hit.position).dot(self.axis);
        (along > 0.0).then(|| hit.position + ray.direction * (distance / along))
    }
}

/// The mirror direction: about the shading normal, or the triangle's where that leads into the surface.
fn mirrored(hit: &RayHit) -> Vec3 {
    let about = |n: Vec3| (2.0 * n.dot(hit.to_viewer) * n - hit.to_viewer).normalize_or(n);
    let direction = about(hit.normal);
    if direction.dot(hit.geometric_normal) > 0.0 {
        direction
    } else {
        about(hit.geometric_normal)
    }
}
