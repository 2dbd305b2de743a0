//! The debug rays: where they went, and what they carry.

use super::boxes::outline;
use super::color::{BLOCKED, BLUE, DARK, GREEN, RED, YELLOW, of_radiance};
use super::count::left_out_text;
use super::line_set::{LineSet, Stands, Thinned};
use super::settings::{MissColor, RaySettings};
use super::{Subject, System};
use crate::trace::{RayEnd, RayKind, TracedRay};
use glam::Vec3;

/// Normals at hits are as long as this part of the distance from the camera.
const NORMAL_LENGTH: f32 = 0.05;

/// Whether the switches let a ray be seen.
pub fn is_shown(settings: &RaySettings, ray: &TracedRay) -> bool {
    let kind = match ray.kind {
        RayKind::Camera => settings.camera,
        RayKind::Mirror | RayKind::Gloss => settings.mirror,
        RayKind::Transmission | RayKind::Translucency => settings.transmission,
        RayKind::Shadow => settings.shadow,
        RayKind::LightSample => settings.light_samples,
    };
    let is_drawn = !matches!(ray.end, RayEnd::Unlit | RayEnd::LeftOut);
    kind && ray.depth <= settings.max_depth && is_drawn
}

/// Rays as lines, with what they hit.
pub(super) fn rays(subject: &Subject) -> LineSet {
    let mut set = LineSet::of(System::Rays, subject.inspect);
    let settings = &subject.inspect.rays;
    let Some(tree) = subject.rays else {
        set.notes.push("no pixel was picked".into());
        return set;
    };
    let shown: Vec<(u32, &TracedRay)> = (0..)
        .zip(&tree.rays)
        .filter(|(_, ray)| is_shown(settings, ray))
        .collect();
    // A blocked ray is two lines, an outline three, normals two.
    let most = subject.inspect.max_lines as usize / 7;
    let step = shown.len().div_ceil(most.max(1)).max(1);
    for &(index, ray) in shown.iter().step_by(step) {
        draw(&mut set, subject, index, ray);
    }
    if step > 1 {
        set.thinned = Some(Thinned {
            what: "rays",
            drawn: shown.len().div_ceil(step),
            of: shown.len(),
            rule: "every n-th",
        });
    }
    if tree.left_out > 0 {
        set.notes.push(left_out_text(tree.left_out));
    }
    set
}

fn draw(set: &mut LineSet, subject: &Subject, index: u32, ray: &TracedRay) {
    let settings = &subject.inspect.rays;
    let exposure = subject.settings.output.exposure;
    let stands = Stands::Ray(index);
    let start = ray.at(ray.after);
    let far = subject.far();
    // What has no end is drawn beyond the scene.
    let end = |t: f32| {
        let length = ray.direction.length();
        let t = if t.is_finite() { t } else { far / length };
        ray.at(t)
    };
    match ray.end {
        RayEnd::Surface | RayEnd::Light => {
            let color = of_radiance(ray.radiance, exposure);
            set.line([start, end(ray.t)], color, stands);
        }
        RayEnd::Background => {
            let color = match settings.misses {
                MissColor::Red => RED,
                MissColor::Carried => of_radiance(ray.radiance, exposure),
            };
            set.line([start, end(f32::INFINITY)], color, stands);
        }
        RayEnd::Arrived | RayEnd::Unshadowed => {
            // From layer to layer, in the colour of what is left of the light on its way to the start.
            let mut color = of_radiance(ray.transmittance, 0.0);
            let mut from = start;
            let mut left = ray.transmittance;
            for crossing in &ray.crossings {
                let at = ray.at(crossing.t);
                set.line([from, at], color, stands);
                from = at;
                let d = crossing.opacity;
                let through = (1.0 - d) * Vec3::ONE.lerp(crossing.diffuse, d);
                left = (left / through).min(Vec3::ONE);
                color = of_radiance(left, 0.0);
            }
            set.line([from, end(ray.t_max)], color, stands);
        }
        RayEnd::Blocked => {
            let blocker = end(ray.t);
            set.line([start, blocker], BLOCKED, stands);
            set.line([blocker, end(ray.t_max)], DARK, stands);
            set.dot(blocker, RED, stands);
        }
        RayEnd::Unlit | RayEnd::LeftOut => {}
    }
    let Some(hit) = &ray.hit else { return };
    if settings.hit_triangles && ray.end != RayEnd::Arrived {
        outline(set, subject, hit.instance, hit.triangle, YELLOW);
    }
    if settings.hit_normals && ray.end == RayEnd::Surface {
        let distance = (hit.position - subject.camera.position).length();
        let length = NORMAL_LENGTH * distance;
        let tip = |normal: Vec3| [hit.position, hit.position + length * normal];
        set.line(tip(hit.geometric_normal), BLUE, stands);
        set.line(tip(hit.normal), GREEN, stands);
    }
}
