//! The film: its error estimate and adaptive sampling against references, parts of pictures, edits of lamps, and
//! what is left where a render is killed.

mod calibration;
mod edits;
mod killed;
mod parts;

use glam::UVec2;
use glassbox::app::headless_app;
use glassbox::film::{Film, render_samples};
use glassbox::io::{OpenOptions, SceneSource, builtin, open};
use glassbox::scene::RenderSettings;
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::{Camera, World};
use std::path::Path;
use std::sync::Arc;

/// A built-in scene, ready to be rendered.
struct Scene {
    name: &'static str,
    world: Arc<World>,
    camera: Camera,
    settings: RenderSettings,
}

impl Scene {
    fn all(size: UVec2) -> Vec<Self> {
        let names = builtin::SCENES.iter().map(|scene| scene.name);
        names.map(|name| Self::open(name, size)).collect()
    }

    fn open(name: &'static str, size: UVec2) -> Self {
        let mut app = headless_app();
        let source = SceneSource::named(Path::new(name));
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        let world = app.world();
        let mut settings = world.resource::<RenderSettings>().clone();
        settings.size = size;
        Self {
            name,
            world: world.resource::<Traced>().world.clone(),
            camera: world.resource::<TracedCameras>().0[0].camera.clone(),
            settings,
        }
    }

    fn film(&self, samples: std::ops::Range<u64>) -> Film {
        render_samples(&self.world, &self.camera, &self.settings, samples, &|_| {}).film
    }
}
