//! What the tracer says of itself, against what is worked out without it: rays, trees, lines.

mod answers;
mod bad_input;
mod effects;
mod figures;
mod lights_and_rays;
mod many_rays;
mod program;
mod recomputed;
mod traversal;
mod trees;

use bevy::color::LinearRgba;
use glam::{UVec2, Vec3};
use glassbox::app::headless_app;
use glassbox::inspect::{InspectSettings, LineSet, Segment, Subject, System};
use glassbox::io::{OpenOptions, SceneSource, open};
use glassbox::scene::{Builder, PixelSampling, RenderSettings};
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::{Camera, RayTree, Samples, World, probe};
use std::path::Path;

/// A scene, and how it is looked at.
struct Scene {
    world: World,
    camera: Camera,
    settings: RenderSettings,
}

impl Scene {
    /// A built-in one.
    fn open(name: &str, size: UVec2) -> Self {
        Self::built(name, size, Builder::default())
    }

    /// The same with trees by that builder.
    fn built(name: &str, size: UVec2, builder: Builder) -> Self {
        let mut app = headless_app();
        let source = SceneSource::named(Path::new(name));
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.world_mut()
            .resource_mut::<RenderSettings>()
            .tree
            .builder = builder;
        app.update();
        let world = app.world();
        Self {
            world: World::clone(&world.resource::<Traced>().world),
            camera: world.resource::<TracedCameras>().0[0].camera.clone(),
            settings: RenderSettings {
                size,
                ..world.resource::<RenderSettings>().clone()
            },
        }
    }

    /// One pixel with one sample through its middle.
    fn of(world: World, camera: Camera) -> Self {
        Self {
            world: world.with_needs(),
            camera,
            settings: RenderSettings {
                size: UVec2::ONE,
                spp: 1,
                pixel: PixelSampling::Center,
                ..RenderSettings::default()
            },
        }
    }

    fn probe(&self, samples: Samples) -> RayTree {
        probe(
            &self.world,
            &self.camera,
            &self.settings,
            UVec2::ZERO,
            &samples,
        )
        .unwrap()
    }

    /// What one system shows, with the rays of all samples of pixel 0, 0.
    fn lines(&self, system: System, inspect: &InspectSettings) -> LineSet {
        let rays = self.probe(Samples::All);
        let subject = Subject::new(
            &self.world,
            &self.camera,
            &self.settings,
            inspect,
            Some(&rays),
        );
        system.lines(&subject)
    }
}

fn is_near(a: Vec3, b: Vec3) -> bool {
    (a - b).length() < 1e-3
}

fn is_color(a: LinearRgba, [r, g, b]: [f32; 3]) -> bool {
    (a.red - r).abs() < 2e-3 && (a.green - g).abs() < 2e-3 && (a.blue - b).abs() < 2e-3
}

/// The segment between two points, in either direction.
fn segment(set: &LineSet, a: Vec3, b: Vec3) -> &Segment {
    let found = set.segments.iter().find(|s| {
        let [from, to] = s.ends;
        (is_near(from, a) && is_near(to, b)) || (is_near(from, b) && is_near(to, a))
    });
    found.unwrap_or_else(|| {
        let all: Vec<_> = set.segments.iter().take(40).map(|s| s.ends).collect();
        panic!(
            "no segment from {a} to {b} in {all:#?}\nnotes: {:?}",
            set.notes
        )
    })
}

/// Expects a segment of one colour.
fn expect(set: &LineSet, a: Vec3, b: Vec3, color: [f32; 3]) {
    let found = segment(set, a, b);
    assert!(
        found.colors.iter().all(|c| is_color(*c, color)),
        "from {a} to {b}: {:?} instead of {color:?}",
        found.colors
    );
}

const WHITE: [f32; 3] = [1.0; 3];
const RED: [f32; 3] = [1.0, 0.02, 0.02];
