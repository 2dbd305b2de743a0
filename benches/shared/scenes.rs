//! Built-in scenes as the benches render them, and the truth about their pictures.

use glam::{DVec3, UVec2};
use glassbox::app::headless_app;
use glassbox::film::{Picture, RELATIVE_FLOOR, Rendered, render};
use glassbox::io::builtin;
use glassbox::scene::{RenderSettings, Sampling};
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::{Camera, World};
use std::sync::Arc;
use std::time::Instant;

/// Pictures of a reference, and samples of each.
const REFERENCES: u32 = 3;
const REFERENCE_SAMPLES: u32 = 256;

/// The built-in scenes that the command line names, or all, seen in `size` pixels.
pub fn scenes(size: UVec2) -> impl Iterator<Item = Scene> {
    let named: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| !argument.starts_with("--"))
        .collect();
    for name in &named {
        assert!(
            builtin::find(name).is_some(),
            "there is no built-in scene {name}"
        );
    }
    builtin::SCENES
        .iter()
        .filter(move |scene| named.is_empty() || named.iter().any(|name| name == scene.name))
        .map(move |scene| Scene::open(scene.name, size))
}

pub struct Scene {
    pub name: &'static str,
    pub world: Arc<World>,
    pub camera: Camera,
    pub settings: RenderSettings,
}

impl Scene {
    fn open(name: &'static str, size: UVec2) -> Self {
        let mut app = headless_app();
        (builtin::find(name).expect("a built-in scene").spawn)(app.world_mut());
        app.update();
        let world = app.world();
        Self {
            name,
            world: world.resource::<Traced>().world.clone(),
            camera: world.resource::<TracedCameras>().0[0].camera.clone(),
            settings: RenderSettings {
                size,
                ..world.resource::<RenderSettings>().clone()
            },
        }
    }

    pub fn render(&self, seed: u32, spp: u32, sampling: Sampling) -> Timed {
        let settings = RenderSettings {
            seed,
            spp,
            sampling,
            ..self.settings.clone()
        };
        let (clock, before) = (Instant::now(), processor_seconds());
        let rendered = render(&self.world, &self.camera, &settings, &|_, _| {});
        let seconds = match (before, processor_seconds()) {
            (Some(before), Some(after)) => after - before,
            _ => clock.elapsed().as_secs_f64(),
        };
        Timed { rendered, seconds }
    }
}

/// A picture, and the seconds that all threads together were on a processor for it.
pub struct Timed {
    pub rendered: Rendered,
    pub seconds: f64,
}

/// Seconds that each of the process' threads has spent on a processor, together.
pub fn processor_seconds() -> Option<f64> {
    let mut sum = 0.0;
    for task in std::fs::read_dir("/proc/self/task").ok()? {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        sum += text.split_whitespace().next()?.parse::<f64>().ok()?;
    }
    Some(sum * 1e-9)
}

/// The mean of several pictures, and each pixel's expected squared error.
pub struct Reference {
    means: Vec<DVec3>,
    squared_errors: Vec<f64>,
}

impl Reference {
    pub fn of(scene: &Scene) -> Self {
        let picture = |seed| {
            let rendered = scene
                .render(seed, REFERENCE_SAMPLES, Sampling::default())
                .rendered;
            rendered.picture
        };
        let pictures: Vec<Picture> = (0..REFERENCES).map(picture).collect();
        let n = f64::from(REFERENCES);
        let (mut means, mut squared_errors) = (Vec::new(), Vec::new());
        for i in 0..pictures[0].pixels.len() {
            let values = pictures.iter().map(|picture| picture.pixels[i].as_dvec3());
            let mean = values.clone().sum::<DVec3>() / n;
            let squares: f64 = values.map(|value| (value - mean).length_squared()).sum();
            means.push(mean);
            squared_errors.push(squares / 3.0 / (n - 1.0) / n);
        }
        Self {
            means,
            squared_errors,
        }
    }

    /// The true relative squared error of a picture.
    pub fn error_of(&self, picture: &Picture) -> f64 {
        let pixels = picture
            .pixels
            .iter()
            .zip(&self.means)
            .zip(&self.squared_errors);
        let squares = pixels.map(|((pixel, mean), own)| {
            let value = mean.element_sum() / 3.0;
            let square = (pixel.as_dvec3() - mean).length_squared() / 3.0 - own;
            square / (value * value + RELATIVE_FLOOR)
        });
        (squares.sum::<f64>() / self.means.len() as f64).max(0.0)
    }
}
