//! The lines of the room `inspect` over the scene: a set for each system.

use super::debug_ray::DebugRay;
use super::drawn_set::{DrawnSet, Source};
use crate::editor::viewport::EditorCamera;
use crate::inspect::{InspectSettings, LineSet, Subject, System};
use crate::scene::RenderSettings;
use crate::sync::{Traced, TracedCameras};
use crate::view::{DrawnLines, TracedRender};
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Commands, Query, Res, ResMut, Single};
use std::sync::Arc;

/// What is drawn now.
#[derive(Resource, Default)]
pub(in crate::editor) struct Drawings {
    sets: [DrawnSet; System::ALL.len()],
    version: u64,
}

impl Drawings {
    /// The sets that are drawn, in their order.
    pub fn sets(&self) -> impl Iterator<Item = &LineSet> {
        self.sets.iter().filter_map(DrawnSet::set)
    }

    /// Nothing is drawn.
    pub fn is_empty(&self) -> bool {
        self.sets().next().is_none()
    }

    /// Another number for other lines.
    pub fn version(&self) -> u64 {
        self.version
    }
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
    mut lines: Query<&mut DrawnLines>,
    mut drawings: ResMut<Drawings>,
) {
    let Some((_, camera, rendered)) = render.subject() else {
        return;
    };
    let settings = RenderSettings {
        size: rendered.size,
        ..settings.clone()
    };
    let source = Source {
        world: traced.world.clone(),
        rays: ray.rays().cloned(),
    };
    let rays = source.rays.as_deref();
    let shot = ray.shot().map(|shot| &shot.camera);
    let of_scene = cameras.0.first().map(|camera| &camera.camera);
    let photographer = of_scene.or(shot).unwrap_or(camera);
    let subject =
        Subject::new(&source.world, photographer, &settings, &inspect, rays).seen_by(camera);
    let Drawings { sets, version } = &mut *drawings;
    for (system, set) in System::ALL.into_iter().zip(sets) {
        let is_on = system.is_on(&inspect) && (rays.is_some() || !system.needs_rays());
        let is_other = if is_on {
            set.draw(system, &subject, &source, (), &mut commands, &mut lines)
        } else {
            set.clear(&mut commands)
        };
        *version += u64::from(is_other);
    }
}
