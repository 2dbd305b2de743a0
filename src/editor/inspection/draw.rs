//! The lines of the room `inspect` over the scene: a set for each system.

use super::debug_ray::DebugRay;
use super::drawn_set::{DrawnSet, Source};
use super::{Seen, seen_from};
use crate::editor::selection::Selection;
use crate::editor::viewport::EditorCamera;
use crate::inspect::{InspectSettings, LineSet, Subject, System};
use crate::scene::RenderSettings;
use crate::sync::{Traced, TracedCameras};
use crate::trace::Camera;
use crate::view::{DrawnLines, OVERLAY_LAYER, TracedView};
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Commands, Query, Res, ResMut, Single};

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

/// The camera whose lens and shutter are drawn: that of the picture, where a camera is looked through; else the selected one,
/// or the scene's first.
fn photographer<'a>(
    cameras: &'a TracedCameras,
    view: &TracedView,
    selection: &Selection,
) -> Option<&'a Camera> {
    let wanted = view.optics_of.into_iter().chain(selection.active());
    let found = cameras.first_of(wanted)?;
    Some(&found.camera)
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
    (ray, selection): (Res<DebugRay>, Res<Selection>),
    view: Single<Seen, With<EditorCamera>>,
    mut lines: Query<&mut DrawnLines>,
    mut drawings: ResMut<Drawings>,
) {
    let (render, view, camera, place, projection) = *view;
    let Some((camera, size)) = seen_from(render, view, camera, place, projection) else {
        return;
    };
    let settings = RenderSettings {
        size,
        ..settings.clone()
    };
    let source = Source {
        world: traced.world.clone(),
        rays: ray.rays().cloned(),
    };
    let rays = source.rays.as_deref();
    let shot = ray.shot().map(|shot| &shot.camera);
    let of_scene = photographer(&cameras, view, &selection);
    let photographer = of_scene.or(shot).unwrap_or(&camera);
    let subject =
        Subject::new(&source.world, photographer, &settings, &inspect, rays).seen_by(&camera);
    let Drawings { sets, version } = &mut *drawings;
    for (system, set) in System::ALL.into_iter().zip(sets) {
        let is_on = system.is_on(&inspect) && (rays.is_some() || !system.needs_rays());
        let is_other = if is_on {
            let layer = OVERLAY_LAYER;
            set.draw(system, &subject, &source, layer, &mut commands, &mut lines)
        } else {
            set.clear(&mut commands)
        };
        *version += u64::from(is_other);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Bench, SIZE};
    use super::*;
    use crate::scene::SceneId;
    use crate::sync::TracedCamera;
    use crate::trace;
    use bevy::camera::{Camera, Viewport};
    use bevy::ecs::system::RunSystemOnce;
    use bevy::math::Vec3;

    #[test]
    fn lines_follow_their_switches_while_nothing_is_traced() {
        let mut bench = Bench::open("cornell-box");
        let world = bench.app.world_mut();
        world.init_resource::<Drawings>();
        let viewport = Viewport {
            physical_size: SIZE,
            ..Viewport::default()
        };
        let camera = Camera {
            viewport: Some(viewport),
            ..Camera::default()
        };
        world.spawn((EditorCamera, TracedView::default(), camera));
        for is_on in [true, false, true] {
            let mut inspect = world.resource_mut::<InspectSettings>();
            (inspect.on, inspect.boxes.on) = (is_on, true);
            world.run_system_once(draw_inspection).unwrap();
            assert_eq!(world.resource::<Drawings>().is_empty(), !is_on);
        }
    }

    #[test]
    fn the_lens_that_is_drawn_is_the_pictures_or_the_selected_cameras() {
        let camera = |id: u64| {
            let mut camera = trace::Camera::looking_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0);
            camera.optics.aperture_radius = id as f32;
            TracedCamera {
                id: SceneId(id),
                name: id.to_string(),
                camera,
            }
        };
        let cameras = TracedCameras(vec![camera(1), camera(2), camera(3)]);
        let drawn = |optics_of: Option<u64>, selected: Option<u64>| {
            let view = TracedView {
                optics_of: optics_of.map(SceneId),
                ..TracedView::default()
            };
            let mut selection = Selection::default();
            selection.set(selected.map(SceneId));
            photographer(&cameras, &view, &selection).map(|camera| camera.optics.aperture_radius)
        };
        assert_eq!(drawn(None, None), Some(1.0));
        assert_eq!(drawn(None, Some(3)), Some(3.0));
        assert_eq!(drawn(None, Some(9)), Some(1.0), "it is no camera");
        assert_eq!(drawn(Some(2), Some(3)), Some(2.0));
    }
}
