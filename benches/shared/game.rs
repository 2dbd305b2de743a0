//! What a game of four thousand objects costs in a frame, each with a material of its own: all systems of the app, Bevy's
//! alone and with ours beside them, in an app with a view. No window; what the renderer does is not counted.

use bevy::DefaultPlugins;
use bevy::app::{App, Last, PluginGroup};
use bevy::asset::{Assets, Handle, RenderAssetUsages};
use bevy::camera::RenderTarget;
use bevy::color::Color;
use bevy::ecs::entity::Entity;
use bevy::image::Image;
use bevy::log::LogPlugin;
use bevy::math::Vec3;
use bevy::mesh::{Mesh, Mesh3d};
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::{
    Camera3d, Cuboid, DirectionalLight, Meshable, ResMut, Resource, Sphere, Transform,
};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::window::WindowPlugin;
use bevy::winit::WinitPlugin;
use glassbox::view::{GlassboxPlugins, TracedView};
use std::thread;
use std::time::{Duration, Instant};
use wgpu_types::TextureFormat;

const OBJECTS: usize = 4000;
const MESHES: usize = 40;
const SIZE: [u32; 2] = [320, 180];
/// Frames that are not counted, and those that are.
const BEFORE: usize = 30;
const FRAMES: usize = 100;
/// From one frame to the next: what goes on behind them has time to.
const BETWEEN: Duration = Duration::from_millis(8);

type Edit = fn(&mut Game, usize);

const EDITS: [(&str, Edit); 7] = [
    ("nothing", |_, _| {}),
    ("one moves", |game, i| game.shift(1, i)),
    ("all move", |game, i| game.shift(OBJECTS, i)),
    ("a light moves", |game, i| {
        game.place(game.light).translation.x = step(i);
    }),
    ("a material", |game, i| {
        let material = game.materials[i % OBJECTS].clone();
        let mut materials = game
            .app
            .world_mut()
            .resource_mut::<Assets<StandardMaterial>>();
        materials
            .insert(material.id(), painted(i + 7))
            .expect("a material");
    }),
    ("one comes, one goes", |game, i| {
        let place = Transform::from_xyz(0.0, 40.0 + step(i), 0.0);
        let come = game.object(i % OBJECTS, place);
        let goes = std::mem::replace(&mut game.objects[i % OBJECTS], come);
        game.app.world_mut().despawn(goes);
    }),
    ("a mesh", |game, i| {
        let mesh = game.meshes[i % MESHES].id();
        let mut meshes = game.app.world_mut().resource_mut::<Assets<Mesh>>();
        meshes.insert(mesh, ball(1.0 + step(i))).expect("a mesh");
    }),
];

pub fn main() {
    println!(
        "{OBJECTS} objects, milliseconds of the app's systems in {FRAMES} frames: p50 / p90 / most\n\n{:<22}{:>24}{:>24}{:>8}",
        "", "Bevy's", "and ours", "more"
    );
    let without = measure(false);
    let with = measure(true);
    for (((name, _), without), with) in EDITS.iter().zip(without).zip(with) {
        let figures = |[half, most, all]: [f64; 3]| format!("{half:.2} / {most:.2} / {all:.2}");
        let more = with[0] - without[0];
        println!(
            "{name:<22}{:>24}{:>24}{more:>8.2}",
            figures(without),
            figures(with)
        );
    }
}

fn measure(is_traced: bool) -> Vec<[f64; 3]> {
    let mut game = Game::open(is_traced);
    EDITS.iter().map(|(_, edit)| game.frames(*edit)).collect()
}

struct Game {
    app: App,
    meshes: Vec<Handle<Mesh>>,
    materials: Vec<Handle<StandardMaterial>>,
    objects: Vec<Entity>,
    light: Entity,
}

/// When the app's systems were through.
#[derive(Resource)]
struct Ended(Instant);

impl Game {
    fn open(is_traced: bool) -> Self {
        let mut app = App::new();
        app.add_plugins(
            DefaultPlugins
                .set(WindowPlugin {
                    primary_window: None,
                    ..WindowPlugin::default()
                })
                .disable::<WinitPlugin>()
                .disable::<LogPlugin>()
                // One thing after the other, so that it can be timed.
                .disable::<PipelinedRenderingPlugin>(),
        );
        if is_traced {
            app.add_plugins(GlassboxPlugins);
        }
        app.insert_resource(Ended(Instant::now()))
            .add_systems(Last, |mut ended: ResMut<Ended>| ended.0 = Instant::now());
        app.finish();
        app.cleanup();
        let [width, height] = SIZE;
        let mut image =
            Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
        image.asset_usage = RenderAssetUsages::RENDER_WORLD;
        let world = app.world_mut();
        let target = world.resource_mut::<Assets<Image>>().add(image);
        // Away from all of it: what an adapter draws with, a processor perhaps, has nothing to do.
        let place = Transform::from_xyz(0.0, 20.0, 60.0).looking_to(Vec3::Z, Vec3::Y);
        let target = RenderTarget::Image(target.into());
        let mut camera = world.spawn((Camera3d::default(), place, target));
        if is_traced {
            camera.insert(TracedView::default());
        }
        let light = world.spawn((DirectionalLight::default(), place)).id();
        let mut meshes = world.resource_mut::<Assets<Mesh>>();
        let meshes = (0..MESHES).map(|i| match i % 2 {
            0 => meshes.add(ball(1.0)),
            _ => meshes.add(Cuboid::default()),
        });
        let meshes = meshes.collect();
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let materials = (0..OBJECTS).map(|i| materials.add(painted(i))).collect();
        let mut game = Self {
            app,
            meshes,
            materials,
            objects: Vec::new(),
            light,
        };
        for i in 0..OBJECTS {
            let [x, y, z] = [i % 20, i / 20 % 10, i / 200].map(|n| n as f32);
            let object = game.object(
                i,
                Transform::from_xyz(2.0 * x - 20.0, 2.0 * y, 2.0 * z - 20.0),
            );
            game.objects.push(object);
        }
        game
    }

    fn object(&mut self, i: usize, place: Transform) -> Entity {
        let mesh = Mesh3d(self.meshes[i % MESHES].clone());
        let material = MeshMaterial3d(self.materials[i].clone());
        self.app.world_mut().spawn((mesh, material, place)).id()
    }

    fn place(&mut self, entity: Entity) -> bevy::ecs::change_detection::Mut<'_, Transform> {
        let place = self.app.world_mut().get_mut::<Transform>(entity);
        place.expect("a place")
    }

    fn shift(&mut self, count: usize, i: usize) {
        for object in self.objects.clone().into_iter().take(count) {
            self.place(object).translation.y += step(i);
        }
    }

    /// Milliseconds of the app's systems: the median, the 90th percentile, the most.
    fn frames(&mut self, edit: Edit) -> [f64; 3] {
        let mut times = Vec::new();
        for frame in 0..BEFORE + FRAMES {
            edit(self, frame);
            let start = Instant::now();
            self.app.update();
            let took = self.app.world().resource::<Ended>().0 - start;
            if frame >= BEFORE {
                times.push(took.as_secs_f64() * 1e3);
            }
            thread::sleep(BETWEEN);
        }
        times.sort_by(f64::total_cmp);
        [FRAMES / 2, FRAMES * 9 / 10, FRAMES - 1].map(|i| times[i])
    }
}

/// Back and forth.
fn step(i: usize) -> f32 {
    if i.is_multiple_of(2) { 0.1 } else { -0.1 }
}

fn ball(radius: f32) -> Mesh {
    Sphere::new(0.5 * radius).mesh().uv(16, 8)
}

fn painted(i: usize) -> StandardMaterial {
    StandardMaterial {
        base_color: Color::hsl((i * 37 % 360) as f32, 0.5, 0.5),
        perceptual_roughness: 0.9,
        ..StandardMaterial::default()
    }
}
