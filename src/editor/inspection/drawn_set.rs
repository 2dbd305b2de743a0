//! One system's lines on the screen.

use crate::inspect::{LineSet, Subject, System};
use crate::trace::{self, RayTree, World};
use crate::view::{DrawnLines, Line};
use bevy::camera::visibility::RenderLayers;
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::QueryFilter;
use bevy::ecs::system::{Commands, Query};
use bevy::math::Vec3;
use std::sync::Arc;

/// Logical pixels.
const WIDTH: f32 = 1.2;
/// Half the arm of the cross that a point is drawn as, as a part of its distance from the viewer.
const CROSS: f32 = 0.004;

/// A system's lines as one set of retained gizmos, or none. They are made again when the system's own
/// key says that they may be others, so what stands costs nothing.
#[derive(Default)]
pub(in crate::editor) struct DrawnSet(Option<Standing>);

struct Standing {
    entity: Entity,
    key: u64,
    set: LineSet,
    /// Kept, so that a key that is made of places in memory cannot come again.
    _of: Source,
}

/// What lines are made of: a subject's world and rays.
#[derive(Clone)]
pub(in crate::editor) struct Source {
    pub world: Arc<World>,
    pub rays: Option<Arc<RayTree>>,
}

impl DrawnSet {
    /// What is drawn.
    pub fn set(&self) -> Option<&LineSet> {
        self.0.as_ref().map(|standing| &standing.set)
    }

    /// Draws it no more. True where it was drawn.
    pub fn clear(&mut self, commands: &mut Commands) -> bool {
        let standing = self.0.take();
        if let Some(standing) = &standing {
            commands.entity(standing.entity).despawn();
        }
        standing.is_some()
    }

    /// Draws the system's lines of the subject, which is made of `source`, for the cameras of a layer. True
    /// where they are others than before.
    pub fn draw<F: QueryFilter>(
        &mut self,
        system: System,
        subject: &Subject,
        source: &Source,
        layer: usize,
        commands: &mut Commands,
        drawn: &mut Query<&mut DrawnLines, F>,
    ) -> bool {
        let key = system.key(subject);
        if self.0.as_ref().is_some_and(|standing| standing.key == key) {
            return false;
        }
        let set = system.lines(subject);
        let wanted = DrawnLines {
            lines: gizmo_lines(&set, subject.camera),
            width: WIDTH,
            on_top: false,
        };
        let entity = match &self.0 {
            Some(standing) => {
                if let Ok(mut lines) = drawn.get_mut(standing.entity) {
                    *lines = wanted;
                }
                standing.entity
            }
            None => {
                let layers = RenderLayers::layer(layer);
                commands.spawn((wanted, layers)).id()
            }
        };
        self.0 = Some(Standing {
            entity,
            key,
            set,
            _of: source.clone(),
        });
        true
    }
}

/// Lines as they are, points as crosses, planes as their outlines.
fn gizmo_lines(set: &LineSet, camera: &trace::Camera) -> Vec<Line> {
    let segments = set.segments.iter().map(|segment| Line {
        ends: segment.ends,
        colors: segment.colors,
    });
    let mut lines: Vec<Line> = segments.collect();
    for dot in &set.points {
        let arm = CROSS * (dot.at - camera.position).length();
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let (from, to) = (dot.at - axis * arm, dot.at + axis * arm);
            lines.push(Line::new(from, to, dot.color));
        }
    }
    for plane in &set.planes {
        let [x, y] = plane.edges;
        let corners = [Vec3::ZERO, x, x + y, y].map(|edge| plane.corner + edge);
        // A plane lets what is behind it shine through; its outline need not.
        let color = LinearRgba {
            alpha: 1.0,
            ..plane.color
        };
        for i in 0..4 {
            lines.push(Line::new(corners[i], corners[(i + 1) % 4], color));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::{Dot, Panel, Stands};

    #[test]
    fn a_point_is_a_cross_and_a_plane_its_outline() {
        let camera = trace::Camera::looking_at(Vec3::Z * 10.0, Vec3::ZERO, Vec3::Y, 1.0);
        let mut set = LineSet::new(System::Lens);
        set.points.push(Dot {
            at: Vec3::ZERO,
            color: LinearRgba::WHITE,
            stands: Stands::Camera,
        });
        set.planes.push(Panel {
            corner: Vec3::ZERO,
            edges: [Vec3::X, Vec3::Y],
            color: LinearRgba::new(1.0, 0.0, 0.0, 0.2),
            stands: Stands::Camera,
        });
        let lines = gizmo_lines(&set, &camera);
        assert_eq!(lines.len(), 3 + 4);
        // Its arm is a product of rounded numbers.
        let [from, to] = lines[0].ends;
        assert!(from.abs_diff_eq(Vec3::NEG_X * 0.04, 1e-6), "{from}");
        assert!(to.abs_diff_eq(Vec3::X * 0.04, 1e-6), "{to}");
        assert_eq!(lines[4].ends, [Vec3::X, Vec3::X + Vec3::Y]);
        assert_eq!(lines[4].colors[0].alpha, 1.0);
    }
}
