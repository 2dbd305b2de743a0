//! What the tracer did, drawn over the scene: the lines of the room `inspect`, and the debug ray.
//!
//! Each system's lines are one set of retained gizmos. They are made again when the system's own
//! key says that they may be others, so what stands costs nothing.

use super::action::Action;
use super::notice::Notices;
use super::viewport::{EditorCamera, Viewport};
use crate::inspect::{InspectSettings, LineSet, Subject, System};
use crate::scene::RenderSettings;
use crate::sync::{SyncSystems, Traced, TracedCameras};
use crate::trace::{self, Camera, RayTree, Samples, World, probe};
use crate::view::{DrawnLines, Line, TracedRender};
use bevy::app::{App, Plugin, PostUpdate, Update};
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::ecs::message::MessageReader;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Commands, Query, Res, ResMut, Single};
use bevy::math::{UVec2, Vec3};
use bevy::prelude::{DetectChanges, IntoScheduleConfigs};
use bevy::window::{PrimaryWindow, Window};
use std::sync::Arc;

/// Draws them, and shoots the debug ray.
pub(super) struct InspectionPlugin;

impl Plugin for InspectionPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<InspectSettings>()
            .init_resource::<DebugRay>()
            .init_resource::<Drawings>()
            .add_systems(Update, shoot)
            .add_systems(
                PostUpdate,
                (trace_again, draw_inspection).chain().after(SyncSystems),
            );
    }
}

/// Logical pixels.
const WIDTH: f32 = 1.2;
/// Half the arm of the cross that a point is drawn as, as a part of its distance from the viewer.
const CROSS: f32 = 0.004;

/// The rays of the pixel that was picked. They stay when the view moves, and are traced again when
/// the scene changes.
#[derive(Resource, Default)]
pub(super) struct DebugRay {
    /// Which of the samples are traced.
    pub which: Which,
    shot: Option<Shot>,
    rays: Option<Arc<RayTree>>,
    /// What `rays` were traced with.
    of: Option<(Arc<World>, RenderSettings, Which)>,
}

/// Which of the pixel's samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Which {
    /// Sample 0.
    #[default]
    First,
    /// All that a render takes.
    All,
}

impl Which {
    fn samples(self) -> Samples {
        match self {
            Self::First => Samples::One(0),
            Self::All => Samples::All,
        }
    }
}

/// A pixel of a picture: all that is needed to trace it again.
pub(super) struct Shot {
    /// (0, 0) is the top left one.
    pub pixel: UVec2,
    /// From where. The view may have moved on since.
    pub camera: Camera,
    /// The picture's.
    pub size: UVec2,
}

impl DebugRay {
    /// The rays, where a pixel was picked.
    pub fn rays(&self) -> Option<&Arc<RayTree>> {
        self.rays.as_ref()
    }

    /// The pixel that was picked.
    pub fn shot(&self) -> Option<&Shot> {
        self.shot.as_ref()
    }

    /// The world and the settings that the rays were traced with.
    pub fn traced_with(&self) -> Option<(&Arc<World>, &RenderSettings)> {
        let (world, settings, _) = self.of.as_ref()?;
        Some((world, settings))
    }
}

/// R: the pixel under the pointer. Over nothing it takes the rays away.
fn shoot(
    mut actions: MessageReader<Action>,
    window: Single<&Window, With<PrimaryWindow>>,
    viewport: Res<Viewport>,
    render: Single<&TracedRender, With<EditorCamera>>,
    mut ray: ResMut<DebugRay>,
    mut notices: ResMut<Notices>,
) {
    let mut asked = false;
    for action in actions.read() {
        match action {
            Action::ShootRay => asked = true,
            Action::ToggleAllSamples => {
                ray.which = match ray.which {
                    Which::All => Which::First,
                    _ => Which::All,
                };
            }
            _ => {}
        }
    }
    if !asked {
        return;
    }
    let place = window.cursor_position().map(|at| viewport.place(at));
    let inside = place.filter(|at| at.min_element() >= 0.0 && at.max_element() < 1.0);
    let Some(place) = inside else {
        *ray = DebugRay {
            which: ray.which,
            ..DebugRay::default()
        };
        return;
    };
    let Some((_, camera, rendered)) = render.subject() else {
        notices.tell("The debug ray is one of the traced view's pixels: show it (key 2) first");
        return;
    };
    let size = rendered.size;
    ray.shot = Some(Shot {
        pixel: (place * size.as_vec2()).as_uvec2().min(size - 1),
        camera: camera.clone(),
        size,
    });
    ray.of = None;
}

/// The picked pixel, whenever the scene is another.
fn trace_again(
    traced: Res<Traced>,
    settings: Res<RenderSettings>,
    mut ray: ResMut<DebugRay>,
    mut notices: ResMut<Notices>,
) {
    let Some(shot) = &ray.shot else {
        return;
    };
    let same = ray
        .of
        .as_ref()
        .is_some_and(|(world, _, which)| Arc::ptr_eq(world, &traced.world) && *which == ray.which);
    if same && !settings.is_changed() {
        return;
    }
    let settings = RenderSettings {
        size: shot.size,
        ..settings.clone()
    };
    let samples = ray.which.samples();
    let found = probe(&traced.world, &shot.camera, &settings, shot.pixel, &samples);
    let of = (traced.world.clone(), settings, ray.which);
    ray.of = Some(of);
    ray.rays = match found {
        Ok(rays) => Some(Arc::new(rays)),
        Err(problem) => {
            notices.fault(problem.to_string());
            None
        }
    };
}

/// What is drawn now.
#[derive(Resource, Default)]
pub(super) struct Drawings {
    sets: [Option<Drawn>; System::ALL.len()],
    version: u64,
}

impl Drawings {
    /// The sets that are drawn, in their order.
    pub fn sets(&self) -> impl Iterator<Item = &LineSet> {
        self.sets.iter().flatten().map(|drawn| &drawn.set)
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
}

/// Makes those sets again that may be others.
#[expect(
    clippy::too_many_arguments,
    reason = "a system's parameters are the list of what it reads"
)]
fn draw_inspection(
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
    let shot = ray.shot.as_ref().map(|shot| &shot.camera);
    let of_scene = cameras.0.first().map(|camera| &camera.camera);
    let photographer = of_scene.or(shot).unwrap_or(camera);
    let rays = ray.rays().map(Arc::as_ref);
    let subject =
        Subject::new(&traced.world, photographer, &settings, &inspect, rays).seen_by(camera);
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
