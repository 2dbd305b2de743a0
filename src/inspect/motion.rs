//! What moves while the shutter is open: from where to where.

use super::color::{ORANGE, faint};
use super::line_set::{LineSet, Stands, box_corners};
use super::{Subject, System};
use glam::Vec3;

/// How much the ghost at the shutter's opening covers; that at its closing covers all.
pub(super) const GHOST_ALPHA: f32 = 0.45;

/// For each moving object a line from its middle when the shutter opens to its middle when it
/// closes, and its box at both times; for a moving camera the line.
pub(super) fn motion(subject: &Subject) -> LineSet {
    let mut set = LineSet::new(System::Motion);
    let camera = subject.photographer;
    let [open, close] = camera.optics.shutter;
    let world = subject.world;
    for (instance, object) in world.aggregate.instances().iter().zip(world.objects.iter()) {
        let velocity = instance.velocity();
        let Some(bounds) = instance.mesh.bounds() else {
            continue;
        };
        if velocity == Vec3::ZERO {
            continue;
        }
        let stands = Stands::Object(object.id);
        let corners = box_corners(bounds.min.into(), bounds.max.into());
        let corners = corners.map(|corner| instance.to_world_point(corner));
        let middle = corners.iter().sum::<Vec3>() / 8.0;
        set.line(
            [middle + open * velocity, middle + close * velocity],
            ORANGE,
            stands,
        );
        for (time, color) in [(open, faint(ORANGE, GHOST_ALPHA)), (close, ORANGE)] {
            set.edges(
                &corners.map(|corner| corner + time * velocity),
                color,
                stands,
            );
        }
    }
    let velocity = camera.optics.velocity;
    if velocity != Vec3::ZERO {
        let ends = [open, close].map(|time| camera.position + time * velocity);
        set.line(ends, ORANGE, Stands::Camera);
        set.dot(ends[0], ORANGE, Stands::Camera);
    }
    if set.is_empty() {
        set.notes.push("nothing moves".into());
    } else if !subject.settings.features.motion {
        set.notes
            .push("features.motion is off: the picture shows everything at t = 0".into());
    }
    set
}
