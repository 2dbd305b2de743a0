//! Only what a scene needs: what each effect costs where a scene does not use it, and where it does.
//!
//! `cargo bench --bench needs`: for each effect the same picture with the effect switched off, on
//! but absent from the scene, and on and used. The first two must not differ. Instructions are
//! repeatable where times are not:
//!
//! ```sh
//! for on in false true; do
//!     valgrind --tool=callgrind --callgrind-out-file=/dev/null target/release/glassbox render head \
//!         -o h.png --size 64x64 --spp 16 --threads 1 --quiet --set features.transparency=$on
//! done
//! ```

use divan::Bencher;
use glam::{UVec2, Vec3};
use glassbox::app::headless_app;
use glassbox::film::{develop, render};
use glassbox::io::builtin;
use glassbox::scene::{RenderSettings, TextureFilter};
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::{Camera, Lights, Material, ParallelogramLight, World};
use std::sync::Arc;

fn main() {
    divan::main();
}

/// A scene to change: what rays read, from where, and how.
struct Scene {
    world: World,
    camera: Camera,
    settings: RenderSettings,
}

/// The head between its point lights: matt, opaque, still, without textures.
fn plain() -> Scene {
    let mut app = headless_app();
    (builtin::find("head").expect("a built-in scene").spawn)(app.world_mut());
    app.update();
    let cameras = app.world().resource::<TracedCameras>();
    let settings = app.world().resource::<RenderSettings>();
    Scene {
        world: World::clone(&app.world().resource::<Traced>().world),
        camera: cameras.0[0].camera.clone(),
        settings: RenderSettings {
            size: UVec2::splat(128),
            spp: 4,
            ..settings.clone()
        },
    }
}

impl Scene {
    fn material(&mut self, change: impl Fn(&mut Material)) {
        let mut materials = Vec::clone(&self.world.materials);
        materials.iter_mut().for_each(change);
        self.world.materials = Arc::new(materials);
        self.world = self.world.clone().with_needs();
    }

    fn area_light(&mut self) {
        let point = &self.world.lights.points[0];
        let light = ParallelogramLight {
            id: point.id,
            corner: point.position,
            edges: [Vec3::X * 0.5, Vec3::Z * 0.5],
            colors: [4.0 * point.color; 4],
            two_sided: true,
            visible: true,
            samples: 1,
        };
        let lights = Lights {
            points: self.world.lights.points[1..].to_vec(),
            parallelograms: vec![light],
            ..Lights::clone(&self.world.lights)
        };
        self.world.lights = Arc::new(lights);
        self.world = self.world.clone().with_needs();
    }
}

const EFFECTS: [&str; 8] = [
    "transparency",
    "translucency",
    "mirrors",
    "gloss",
    "lens",
    "motion",
    "area light",
    "bloom",
];

/// Switches an effect.
fn switch(scene: &mut Scene, effect: &str, on: bool) {
    let features = &mut scene.settings.features;
    match effect {
        "transparency" => features.transparency = on,
        "translucency" => features.translucency = on,
        "mirrors" => features.mirrors = on,
        "gloss" => features.glossy = on,
        "lens" => features.lens = on,
        "motion" => features.motion = on,
        "area light" => features.soft_shadows = on,
        _ => scene.settings.output.bloom.enabled = on,
    }
}

/// Puts into the scene what the effect shows itself on.
fn bring_in(scene: &mut Scene, effect: &str) {
    match effect {
        "transparency" | "translucency" => scene.material(|m| m.opacity = 0.5),
        "mirrors" | "gloss" => scene.material(|m| m.specular = Vec3::splat(0.3)),
        "lens" => scene.camera.optics.aperture_radius = 0.02,
        "motion" => {
            scene.camera.optics.velocity = Vec3::X * 0.1;
            scene.camera.optics.motion_samples = 4;
        }
        "area light" => scene.area_light(),
        // Whatever is brighter than nothing.
        _ => scene.settings.output.bloom.threshold = 0.0,
    }
}

fn bench(bencher: Bencher, scene: &Scene) {
    bencher.bench_local(|| {
        let rendered = render(&scene.world, &scene.camera, &scene.settings, &|_, _| {});
        develop(&rendered.picture, &scene.settings.output)
    });
}

#[divan::bench(args = EFFECTS, sample_count = 20)]
fn off(bencher: Bencher, effect: &str) {
    let mut scene = plain();
    switch(&mut scene, effect, false);
    bench(bencher, &scene);
}

#[divan::bench(args = EFFECTS, sample_count = 20)]
fn on_but_absent(bencher: Bencher, effect: &str) {
    let mut scene = plain();
    switch(&mut scene, effect, true);
    // Bloom is applied to every picture: it is absent only where it is off.
    if effect == "bloom" {
        switch(&mut scene, effect, false);
    }
    bench(bencher, &scene);
}

#[divan::bench(args = EFFECTS, sample_count = 20)]
fn on_and_used(bencher: Bencher, effect: &str) {
    let mut scene = plain();
    switch(&mut scene, effect, true);
    bring_in(&mut scene, effect);
    bench(bencher, &scene);
}

/// Filters of a texture look-up, on a scene that has textures: mipmaps cost only who asks for them.
#[divan::bench(args = [TextureFilter::Nearest, TextureFilter::Bilinear, TextureFilter::Mipmap], sample_count = 20)]
fn textures(bencher: Bencher, filter: TextureFilter) {
    let mut app = headless_app();
    (builtin::find("textured-cube")
        .expect("a built-in scene")
        .spawn)(app.world_mut());
    app.update();
    let scene = Scene {
        world: World::clone(&app.world().resource::<Traced>().world),
        camera: app.world().resource::<TracedCameras>().0[0].camera.clone(),
        settings: RenderSettings {
            size: UVec2::splat(128),
            spp: 4,
            texture_filter: filter,
            ..app.world().resource::<RenderSettings>().clone()
        },
    };
    bench(bencher, &scene);
}
