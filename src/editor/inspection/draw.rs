//! The lines of the room `inspect` over the scene.
//!
//! Each system's lines are one set of retained gizmos. They are made again when the system's own
//! key says that they may be others, so what stands costs nothing.

use super::debug_ray::DebugRay;
use crate::editor::viewport::EditorCamera;
use crate::inspect::{InspectSettings, LineSet, Subject, System};
use crate::scene::RenderSettings;
use crate::sync::{Traced, TracedCameras};
use crate::trace::{self, RayTree, World};
use crate::view::{DrawnLines, Line, TracedRender};
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Commands, Query, Res, ResMut, Single};
use bevy::math::Vec3;
use std::sync::Arc;

/// Logical pixels.
const WIDTH: f32 = 1.2;
/// Half the arm of the cross that a point is drawn as, as a part of its distance from the viewer.
const CROSS: f32 = 0.004;

/// What is drawn now.
#[derive(Resource, Default)]
pub(in crate::editor) struct Drawings {
    sets: [Option<Drawn>; System::ALL.len()],
    version: u64,
}

impl Drawings {
    /// The sets that are drawn, in their order.
    pub fn sets(&self) -> impl Iterator<Item = &LineSet> {
        self.sets.iter().flatten().map(|drawn| &drawn.set)
    }

    /// Nothing is drawn.
    pub fn is_empty(&self) -> bool {
        self.sets.iter().all(Option::is_none)
    }

    /// Another number for other lines.
    pub fn version(&self) -> u64 {
        self.version
    }
}

/// One system's set on the screen.
struct Drawn {
    entity: Entity,
    key: u64,
    set: LineSet,
    /// Kept, so that a key that is made of places in memory cannot come again.
    _world: Arc<World>,
    _rays: Option<Arc<RayTree>>,
}

/// Makes those sets again that may be others.
#[expect(
    clippy::too_many_arguments,
    reason = "a system's parameters are the list of what it reads"
)]
pub(super) fn draw_inspection(
    mut commands: Commands,
    inspect: Res<InspectSettings>,
    settings: Res<RenderSettings>,
    traced: Res<Traced>,
    cameras: Res<TracedCameras>,
    ray: Res<DebugRay>,
    render: Single<&TracedRender, With<EditorCamera>>,
    mut sets: Query<&mut DrawnLines>,
    mut drawings: ResMut<Drawings>,
) {
    let Some((_, camera, rendered)) = render.subject() else {
        return;
    };
    let settings = RenderSettings {
        size: rendered.size,
        ..settings.clone()
    };
    let rays = ray.rays();
    let shot = ray.shot().map(|shot| &shot.camera);
    let of_scene = cameras.0.first().map(|camera| &camera.camera);
    let photographer = of_scene.or(shot).unwrap_or(camera);
    let subject = Subject::new(
        &traced.world,
        photographer,
        &settings,
        &inspect,
        rays.map(Arc::as_ref),
    )
    .seen_by(camera);
    let Drawings {
        sets: drawn,
        version,
    } = &mut *drawings;
    for (system, known) in System::ALL.into_iter().zip(drawn.iter_mut()) {
        let needs_rays = matches!(system, System::Visits | System::Rays | System::Lobes);
        if !system.is_on(&inspect) || (needs_rays && rays.is_none()) {
            if let Some(known) = known.take() {
                commands.entity(known.entity).despawn();
                *version += 1;
            }
            continue;
        }
        let key = system.key(&subject);
        if known.as_ref().is_some_and(|known| known.key == key) {
            continue;
        }
        let set = system.lines(&subject);
        let wanted = DrawnLines {
            lines: gizmo_lines(&set, camera),
            width: WIDTH,
            on_top: false,
        };
        let entity = match known {
            Some(known) => {
                if let Ok(mut set) = sets.get_mut(known.entity) {
                    *set = wanted;
                }
                known.entity
            }
            None => commands.spawn(wanted).id(),
        };
        *version += 1;
        *known = Some(Drawn {
            entity,
            key,
            set,
            _world: traced.world.clone(),
            _rays: rays.cloned(),
        });
    }
}

/// Lines as they are, points as crosses, planes as their outlines.
fn gizmo_lines(set: &LineSet, camera: &trace::Camera) -> Vec<Line> {
    let mut lines: Vec<Line> = set
        .segments
        .iter()
        .map(|segment| Line {
            ends: segment.ends,
            colors: segment.colors,
        })
        .collect();
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
