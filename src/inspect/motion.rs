//! What moves while the shutter is open: from where to where.

use super::color::{ORANGE, faint};
use super::line_set::{LineSet, Stands, box_corners};
use super::{Subject, System};
use crate::trace::{Lights, World};
use bevy::color::LinearRgba;
use glam::Vec3;

/// How much the ghost at the shutter's opening covers; that at its closing covers all.
pub(super) const GHOST_ALPHA: f32 = 0.45;

/// For whatever moves, by itself or with what it hangs below, a line from its middle when the shutter
/// opens to its middle when it closes: objects with their box at both times, lights with their shape,
/// the camera as a point.
pub(super) fn motion(subject: &Subject) -> LineSet {
    let mut set = LineSet::of(System::Motion, subject.inspect);
    let camera = subject.photographer;
    let shutter = camera.optics.shutter;
    objects(subject.world, shutter, &mut set);
    lights(&subject.world.lights, shutter, &mut set);
    let velocity = camera.optics.velocity;
    if velocity != Vec3::ZERO {
        let ends = shutter.map(|time| camera.position + time * velocity);
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

/// When the shutter opens and when it closes, and in which colour that is drawn.
fn ghosts([open, close]: [f32; 2]) -> [(f32, LinearRgba); 2] {
    [(open, faint(ORANGE, GHOST_ALPHA)), (close, ORANGE)]
}

fn objects(world: &World, shutter: [f32; 2], set: &mut LineSet) {
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
        set.line(shutter.map(|time| middle + time * velocity), ORANGE, stands);
        for (time, color) in ghosts(shutter) {
            set.edges(
                &corners.map(|corner| corner + time * velocity),
                color,
                stands,
            );
        }
    }
}

fn lights(lights: &Lights, shutter: [f32; 2], set: &mut LineSet) {
    if lights.moving.is_empty() {
        return;
    }
    // By its corners: one of a point, two of a segment, four of a parallelogram.
    let mut light = |id: u64, corners: &[Vec3]| {
        let velocity = lights.velocity(id);
        if velocity == Vec3::ZERO {
            return;
        }
        let stands = Stands::Light(id);
        let middle = corners.iter().sum::<Vec3>() / corners.len() as f32;
        set.line(shutter.map(|time| middle + time * velocity), ORANGE, stands);
        for (time, color) in ghosts(shutter) {
            let there = |corner: &Vec3| *corner + time * velocity;
            match corners {
                [point] => set.dot(there(point), color, stands),
                [a, b] => set.line([there(a), there(b)], color, stands),
                _ => {
                    let corners: Vec<Vec3> = corners.iter().map(there).collect();
                    set.closed(&corners, color, stands);
                }
            }
        }
    };
    for point in &lights.points {
        light(point.id, &[point.position]);
    }
    for segment in &lights.segments {
        light(segment.id, &segment.ends);
    }
    for parallelogram in &lights.parallelograms {
        let (corner, [a, b]) = (parallelogram.corner, parallelogram.edges);
        let corners = [corner, corner + a, corner + a + b, corner + b];
        light(parallelogram.id, &corners);
    }
}
