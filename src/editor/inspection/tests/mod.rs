//! What the tests of this folder share: an editor without a window, and rays of its scenes.

mod addition;
mod answers;
mod stepper;
mod told;

use super::choice::Inspected;
use super::debug_ray::{DebugRay, Shot};
use super::{RaysPlugin, Which};
use crate::editor::action::Action;
use crate::editor::headless_editor;
use crate::inspect::{Names, Stepper, Traversal};
use crate::io::builtin;
use crate::io::{OpenOptions, SceneSource, open};
use crate::scene::{RenderSettings, SceneId};
use crate::sync::{Traced, TracedCameras};
use crate::trace::{RayCost, RayTree, Samples, probe};
use bevy::app::{App, Plugin};
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::world::Mut;
use bevy::math::UVec2;
use bevy::mesh::Mesh3d;
use bevy::transform::components::Transform;
use std::time::{Duration, Instant};

/// The picture's.
pub(super) const SIZE: UVec2 = UVec2::new(600, 480);

/// An editor with the debug ray, without a window.
pub(super) struct Bench {
    pub app: App,
}

impl Bench {
    pub fn open(scene: &str) -> Self {
        let mut app = headless_editor();
        // The app is finished already, and takes no more plugins by itself.
        RaysPlugin.build(&mut app);
        let source = SceneSource::Builtin(builtin::find(scene).unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.world_mut().resource_mut::<RenderSettings>().spp = 8;
        app.update();
        app.update();
        Self { app }
    }

    pub fn ray(&mut self) -> Mut<'_, DebugRay> {
        self.app.world_mut().resource_mut::<DebugRay>()
    }

    pub fn inspected(&mut self) -> &mut Inspected {
        self.app
            .world_mut()
            .resource_mut::<Inspected>()
            .into_inner()
    }

    /// Picks a pixel of the scene's first camera.
    pub fn shoot(&mut self, [x, y]: [u32; 2]) {
        let cameras = self.app.world().resource::<TracedCameras>();
        let shot = Shot {
            pixel: UVec2::new(x, y),
            camera: cameras.0[0].camera.clone(),
            size: SIZE,
        };
        self.ray().shoot(shot);
        self.app.update();
    }

    pub fn act(&mut self, action: Action) {
        self.app.world_mut().write_message(action);
        self.app.update();
    }

    pub fn wait(&mut self) {
        let start = Instant::now();
        while self.app.world().resource::<DebugRay>().is_busy() {
            assert!(start.elapsed() < Duration::from_secs(60), "no rays came");
            std::thread::sleep(Duration::from_millis(2));
            self.app.update();
        }
    }

    fn objects(&mut self) -> Vec<(Entity, SceneId)> {
        let world = self.app.world_mut();
        let mut query = world.query_filtered::<(Entity, &SceneId), With<Mesh3d>>();
        query
            .iter(world)
            .map(|(entity, id)| (entity, *id))
            .collect()
    }

    /// Edits the scene without changing what the middle of the picture meets.
    pub fn move_something(&mut self) {
        let (entity, _) = self.objects()[0];
        let mut entity = self.app.world_mut().entity_mut(entity);
        if let Some(mut place) = entity.get_mut::<Transform>() {
            place.translation.y -= 1e-4;
        }
        self.app.update();
    }

    /// Hides the object that the camera ray met, and tells its name.
    pub fn hide_what_is_met(&mut self) -> String {
        let met = self.ray().rays().unwrap().rays[0].hit.unwrap().object;
        let name = self.app.world().resource::<Names>().of(met);
        let objects = self.objects();
        let (entity, _) = objects.iter().find(|(_, id)| id.0 == met).unwrap();
        let mut entity = self.app.world_mut().entity_mut(*entity);
        entity.insert(Visibility::Hidden);
        self.settle();
        name
    }

    pub fn hide_everything(&mut self) {
        for (entity, _) in self.objects() {
            let mut entity = self.app.world_mut().entity_mut(entity);
            entity.insert(Visibility::Hidden);
        }
        self.settle();
    }

    /// What is hidden is known to be so a frame later.
    fn settle(&mut self) {
        for _ in 0..3 {
            self.app.update();
        }
    }
}

/// Rays of a pixel of a built-in scene with eight samples a pixel, and its names.
pub(super) fn rays_of(scene: &str, [x, y]: [u32; 2], samples: Samples) -> (RayTree, Names) {
    let mut bench = Bench::open(scene);
    let world = bench.app.world_mut();
    let names = std::mem::take(&mut *world.resource_mut::<Names>());
    let settings = RenderSettings {
        size: SIZE,
        ..world.resource::<RenderSettings>().clone()
    };
    let camera = &world.resource::<TracedCameras>().0[0].camera;
    let traced = world.resource::<Traced>();
    let pixel = UVec2::new(x, y);
    let rays = probe(&traced.world, camera, &settings, pixel, &samples).unwrap();
    (rays, names)
}

/// Calls something otherwise.
pub(super) fn names_of(names: &mut Names, id: u64, name: &str) {
    names.things.insert(id, name.into());
    names.version += 1;
}

/// The steps of a ray of a pixel's first sample, and what the ray cost.
pub(super) fn stepper_of(scene: &str, pixel: [u32; 2], ray: u32) -> (Stepper, RayCost) {
    let mut bench = Bench::open(scene);
    bench.ray().which = Which::First;
    bench.shoot(pixel);
    let ray_resource = bench.app.world().resource::<DebugRay>();
    let rays = ray_resource.rays().unwrap();
    let (world, settings) = ray_resource.traced_with().unwrap();
    let mut stepper = Stepper::default();
    stepper.load(Traversal::of(world, settings, rays, ray), false);
    (stepper, rays.rays[ray as usize].cost)
}
