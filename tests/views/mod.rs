//! A Bevy app's own cameras with traced pictures in them, drawn into images: no window is needed, but
//! a Vulkan driver (Debian: mesa-vulkan-drivers). Where it is missing a test says so and passes,
//! unless `GLASSBOX_NEEDS_WINDOW=1` is set.

mod hostile;
mod lasting;
#[cfg(target_os = "linux")]
mod minute;
mod own_picture;
mod picking;
mod pictures;
mod second_window;
mod side_by_side;
mod switched_off;

use bevy::app::{PluginGroup, PluginGroupBuilder, PluginsState};
use bevy::camera::{RenderTarget, Viewport};
use bevy::mesh::PlaneMeshBuilder;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use glassbox::prelude::*;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// How long a picture may take: software drivers compile shaders for seconds.
const PATIENCE: Duration = Duration::from_secs(60);

/// Pixels of the image that cameras draw into.
const SIZE: UVec2 = UVec2::new(96, 64);

/// One app at a time: several would take each other's time.
static ONE: Mutex<()> = Mutex::new(());

/// An app with a renderer and no window, and an image that its cameras draw into.
///
/// Around the origin stand, each filling a view: a red wall at -Z and a green one at +Z, which are
/// traced and never rasterised; before the red one a blue wall that is rasterised and never traced.
struct Game {
    app: App,
    image: Handle<Image>,
    _one: MutexGuard<'static, ()>,
}

/// The render of each view that has converged last, by its number.
#[derive(Resource, Default)]
struct Done(HashMap<Entity, u64>);

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Seen {
    Red,
    Green,
    Blue,
    Black,
    Other([u8; 3]),
}

/// Where the walls are.
const RED: Dir3 = Dir3::NEG_Z;
const GREEN: Dir3 = Dir3::Z;

/// What the red wall looks like on the screen: its radiance, encoded.
const SHOWN_RED: u8 = 188;

/// Bevy's plugins for an app with this window: the test's thread runs it, and pipelines are there when they are first drawn
/// with, so that no frame lacks anything.
fn plugins_for(window: Window) -> PluginGroupBuilder {
    DefaultPlugins
        .set(WinitPlugin {
            run_on_any_thread: true,
        })
        .set(at_once())
        .set(WindowPlugin {
            primary_window: Some(window),
            ..default()
        })
}

/// A renderer that waits for its pipelines.
fn at_once() -> RenderPlugin {
    RenderPlugin {
        synchronous_pipeline_compilation: true,
        ..default()
    }
}

impl Game {
    /// `None`, said loudly, where nothing can be drawn with.
    fn open() -> Option<Self> {
        let mut game = Self::without_walls(AssetPlugin::default())?;
        game.build_walls();
        Some(game)
    }

    /// The same with nothing in it.
    fn without_walls(assets: AssetPlugin) -> Option<Self> {
        let one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        if !draws() {
            return None;
        }
        let mut app = App::new();
        let plugins = DefaultPlugins
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(at_once())
            .disable::<WinitPlugin>()
            .disable::<PipelinedRenderingPlugin>()
            .disable::<bevy::log::LogPlugin>()
            .set(assets);
        app.add_plugins((plugins, GlassboxPlugins));
        app.init_resource::<Done>().add_observer(
            |done: On<Converged>, renders: Query<&TracedRender>, mut all: ResMut<Done>| {
                let render = renders.get(done.entity).ok().and_then(TracedRender::render);
                all.0
                    .extend(render.map(|render| (done.entity, render.number())));
            },
        );
        app.insert_resource(ClearColor(Color::BLACK));
        app.insert_resource(RenderSettings {
            spp: 2,
            ..RenderSettings::default()
        });
        while app.plugins_state() == PluginsState::Adding {
            bevy::tasks::tick_global_task_pools_on_main_thread();
        }
        app.finish();
        app.cleanup();
        let image = Image::new_target_texture(SIZE.x, SIZE.y, TextureFormat::Rgba8UnormSrgb, None);
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        Some(Self {
            app,
            image,
            _one: one,
        })
    }

    fn build_walls(&mut self) {
        for (direction, color) in [(RED, LinearRgba::RED), (GREEN, LinearRgba::GREEN)] {
            let mesh = self.wall(20.0);
            self.app.world_mut().spawn((
                Mesh3d(mesh),
                Phong {
                    diffuse: LinearRgba::BLACK,
                    emission: color * 0.5,
                    ..Phong::default()
                },
                facing_origin(direction, 10.0),
            ));
        }
        self.blue(AlphaMode::Opaque, RED);
    }

    fn wall(&mut self, side: f32) -> Handle<Mesh> {
        let mut meshes = self.app.world_mut().resource_mut::<Assets<Mesh>>();
        meshes.add(PlaneMeshBuilder::new(Dir3::Z, Vec2::splat(side)).build())
    }

    /// A wall that Bevy alone knows of.
    fn blue(&mut self, alpha_mode: AlphaMode, direction: Dir3) -> Entity {
        let mesh = self.wall(20.0);
        let world = self.app.world_mut();
        let material = world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(StandardMaterial {
                base_color: Color::linear_rgba(0.0, 0.0, 1.0, 0.9),
                unlit: true,
                alpha_mode,
                ..default()
            });
        let place = facing_origin(direction, 5.0);
        let wall = (Mesh3d(mesh), MeshMaterial3d(material), NotTraced, place);
        world.spawn(wall).id()
    }

    /// A camera at the origin that draws into a part of the image, the whole of it where that is
    /// `None`.
    fn camera(&mut self, direction: Dir3, part: Option<URect>, order: isize) -> Entity {
        let camera = Camera {
            order,
            viewport: part.map(|part| Viewport {
                physical_position: part.min,
                physical_size: part.size(),
                ..default()
            }),
            clear_color: match order {
                0 => ClearColorConfig::Default,
                _ => ClearColorConfig::None,
            },
            ..default()
        };
        let target = RenderTarget::Image(self.image.clone().into());
        let place = Transform::IDENTITY.looking_to(direction, Vec3::Y);
        let world = self.app.world_mut();
        let camera = world.spawn((Camera3d::default(), camera, target, place));
        camera.id()
    }

    /// The same with a traced picture in it.
    fn view(&mut self, direction: Dir3, part: Option<URect>, order: isize) -> Entity {
        let camera = self.camera(direction, part, order);
        let world = self.app.world_mut();
        world.entity_mut(camera).insert(TracedView::default());
        camera
    }

    /// Until every view shows the last picture of its render.
    fn wait_for_pictures(&mut self) {
        let start = Instant::now();
        loop {
            self.app.update();
            let world = self.app.world_mut();
            let built = world.resource::<Traced>().pending == 0;
            let mut views = world.query::<(Entity, &TracedRender)>();
            let done = world.resource::<Done>();
            let is_done = |(view, render): (Entity, &TracedRender)| {
                let number = render.render().map(|render| render.number());
                number.is_some() && done.0.get(&view).copied() == number
            };
            if built && views.iter(world).all(is_done) {
                break;
            }
            let mut known = || {
                let renders = views.iter(world);
                let known = renders.map(|(view, render)| (view, render.status(), render.shown()));
                format!("{:?}, built: {built}", known.collect::<Vec<_>>())
            };
            assert!(start.elapsed() < PATIENCE, "no picture: {}", known());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// The image, after the frames that a change takes to reach it.
    fn shot(&mut self) -> Shot {
        #[derive(Resource)]
        struct Taken(Option<Image>);
        for _ in 0..3 {
            self.app.update();
        }
        let world = self.app.world_mut();
        world.insert_resource(Taken(None));
        world.spawn(Screenshot::image(self.image.clone())).observe(
            |captured: On<ScreenshotCaptured>, mut taken: ResMut<Taken>| {
                taken.0 = Some(captured.image.clone());
            },
        );
        let start = Instant::now();
        loop {
            self.app.update();
            if let Some(image) = self.app.world_mut().resource_mut::<Taken>().0.take() {
                return Shot(image);
            }
            assert!(start.elapsed() < PATIENCE, "no shot");
        }
    }
}

/// Where a wall stands that is seen from the origin.
fn facing_origin(direction: Dir3, metres: f32) -> Transform {
    let place = direction * metres;
    Transform::from_translation(place).looking_at(2.0 * place, Vec3::Y)
}

struct Shot(Image);

impl Shot {
    fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        let color = self.0.get_color_at(x, y).expect("inside the picture");
        let [r, g, b, _] = color.to_srgba().to_u8_array();
        [r, g, b]
    }

    fn seen(&self, x: u32, y: u32) -> Seen {
        let color = self.pixel(x, y);
        match color.map(|channel| channel > 100) {
            [true, false, false] => Seen::Red,
            [false, true, false] => Seen::Green,
            [false, false, true] => Seen::Blue,
            [false, false, false] if color.iter().all(|c| *c < 10) => Seen::Black,
            _ => Seen::Other(color),
        }
    }
}

/// Whether there is an adapter to draw with. Asked once.
fn draws() -> bool {
    static DRAWS: OnceLock<bool> = OnceLock::new();
    *DRAWS.get_or_init(|| {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let asked = instance.request_adapter(&wgpu::RequestAdapterOptions::default());
        let found = bevy::tasks::block_on(asked).is_ok();
        if !found {
            crate::window::missing("there is no graphics adapter (Debian: mesa-vulkan-drivers)");
        }
        found
    })
}
