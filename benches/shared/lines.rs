//! What a hundred thousand lines that stand cost in a frame, on the processor's side: the app's own
//! systems, the extraction, and all that the renderer does before it gives its commands to the
//! adapter. No window; what the adapter draws with, a processor perhaps, is not counted.

use bevy::DefaultPlugins;
use bevy::app::{App, PluginGroup};
use bevy::asset::{Assets, RenderAssetUsages};
use bevy::camera::RenderTarget;
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::image::Image;
use bevy::log::LogPlugin;
use bevy::math::Vec3;
use bevy::prelude::{IntoScheduleConfigs, Res, Resource, Transform};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::{Render, RenderApp, RenderSystems};
use bevy::window::WindowPlugin;
use bevy::winit::WinitPlugin;
use glassbox::view::{DrawnLines, GlassboxPlugins, Line, TracedView};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use wgpu_types::TextureFormat;

const LINES: usize = 100_000;
/// A small picture: drawing it takes the adapter next to nothing.
const SIDE: u32 = 64;
/// Frames that are not counted: pipelines are compiled, lines are brought to the adapter.
const BEFORE: usize = 60;
const FRAMES: usize = 300;

/// When the renderer's own work began, and how long it took.
#[derive(Resource, Clone, Default)]
struct Watch(Arc<Mutex<(Option<Instant>, Duration)>>);

pub fn main() {
    let mut session = Session::open();
    let without = session.frames();
    let start = Instant::now();
    let lines = session.add_lines();
    session.app.update();
    let built = start.elapsed();
    let with = session.frames();
    session.app.world_mut().despawn(lines);
    let again = session.frames();
    println!("{LINES} lines, median of {FRAMES} frames, milliseconds of one thread\n");
    println!("{:<12}{:>12}{:>12}", "", "app", "renderer");
    for (name, times) in [("without", without), ("standing", with), ("without", again)] {
        println!("{name:<12}{:>12.3}{:>12.3}", times[0], times[1]);
    }
    let of = |times: [f64; 2]| times[0] + times[1];
    let cost = of(with) - of(without).min(of(again));
    println!(
        "\ncost of lines that stand: {cost:.3} ms a frame; the frame that made them: {:.1} ms",
        built.as_secs_f64() * 1e3
    );
}

struct Session {
    app: App,
    watch: Watch,
}

impl Session {
    fn open() -> Self {
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
        )
        .add_plugins(GlassboxPlugins);
        let watch = Watch::default();
        app.get_sub_app_mut(RenderApp)
            .expect("an adapter: Mesa's software one is enough")
            .insert_resource(watch.clone())
            .add_systems(Render, begin.before(RenderSystems::ExtractCommands))
            .add_systems(
                Render,
                end.after(RenderSystems::Prepare)
                    .before(RenderSystems::Render),
            );
        app.finish();
        app.cleanup();
        let mut image = Image::new_target_texture(SIDE, SIDE, TextureFormat::Rgba8UnormSrgb, None);
        image.asset_usage = RenderAssetUsages::RENDER_WORLD;
        let world = app.world_mut();
        let target = world.resource_mut::<Assets<Image>>().add(image);
        let view = TracedView {
            // All of it is the raster view's: nothing is traced.
            divider: 1.0,
            ..TracedView::default()
        };
        let place = Transform::from_xyz(0.0, 0.0, 30.0).looking_at(Vec3::ZERO, Vec3::Y);
        world.spawn((view, place, RenderTarget::Image(target.into())));
        Self { app, watch }
    }

    /// Boxes all over a cube, as those of a tree's leaves.
    fn add_lines(&mut self) -> Entity {
        let lines = (0..LINES)
            .map(|i| {
                let [x, y, z] = [i % 47, i / 47 % 47, i / (47 * 47)].map(|n| n as f32 * 0.4);
                let from = Vec3::new(x, y, z) - 9.0;
                let step = [Vec3::X, Vec3::Y, Vec3::Z][i % 3] * 0.3;
                Line::new(from, from + step, LinearRgba::WHITE)
            })
            .collect();
        let set = DrawnLines {
            lines,
            width: 1.2,
            on_top: false,
        };
        self.app.world_mut().spawn(set).id()
    }

    /// Milliseconds of a frame: the app's systems with the extraction, and the renderer's until it
    /// gives its commands to the adapter.
    fn frames(&mut self) -> [f64; 2] {
        let mut times = [Vec::new(), Vec::new()];
        for frame in 0..BEFORE + FRAMES {
            let start = Instant::now();
            self.app.update();
            if frame < BEFORE {
                continue;
            }
            let (began, took) = *self.watch.0.lock().unwrap_or_else(PoisonError::into_inner);
            let app = began.map_or(Duration::ZERO, |began| began - start);
            times[0].push(app.as_secs_f64() * 1e3);
            times[1].push(took.as_secs_f64() * 1e3);
        }
        times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        })
    }
}

fn begin(watch: Res<Watch>) {
    watch.0.lock().unwrap_or_else(PoisonError::into_inner).0 = Some(Instant::now());
}

fn end(watch: Res<Watch>) {
    let mut watch = watch.0.lock().unwrap_or_else(PoisonError::into_inner);
    watch.1 = watch.0.map_or(Duration::ZERO, |began| began.elapsed());
}
