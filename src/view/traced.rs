//! A Bevy camera that shows the tracer's picture of what it looks at.
//!
//! Every frame [`follow`] asks what has changed since the render that is going on was started. A
//! change of the tracer's world, of the camera or of a setting that rays depend on starts another
//! one; exposure, view transform, bloom and the view are only developed again. The render it
//! replaces is cancelled and left to the developing thread to end: nothing here waits.

use super::darkroom::{Darkroom, Order, Print};
use super::screen::{
    Screen, ScreenMaterial, depth_image, no_picture, numbers, picture_image, spawn_screen,
};
use crate::film::views::{Scale, View};
use crate::film::{Progressive, State, Status};
use crate::scene::{self, Output, RenderSettings, SceneId};
use crate::sync::{SyncSystems, Traced, TracedCameras};
use crate::trace;
use bevy::asset::{AssetEventSystems, Assets, Handle};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, Camera3d, Projection};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::reflect::ReflectComponent;
use bevy::image::Image;
use bevy::log::error;
use bevy::math::{Rect, UVec2, Vec2};
use bevy::mesh::Mesh;
use bevy::prelude::{
    Added, App, Commands, Component, IntoScheduleConfigs, Plugin, PostUpdate, Query, Res, ResMut,
    With, Without,
};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::GlobalTransform;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A render that is to be replaced may take so long to its first picture.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

/// Starts, restarts and shows renders. Needs [`SyncPlugin`](crate::sync::SyncPlugin) and a window.
pub struct TracedViewPlugin;

impl Plugin for TracedViewPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<TracedView>().add_systems(
            PostUpdate,
            (
                (give_screens, follow).chain().after(SyncSystems),
                // A print's texture has to reach the renderer in the frame in which the material
                // names it: a material without its texture waits for the next frame, and where
                // every frame brings another print it would wait for ever.
                show_prints.before(AssetEventSystems),
            ),
        );
    }
}

/// On a `Camera3d`: the tracer draws what this camera sees, in the camera's viewport.
///
/// The camera's own transform and projection count, so that raster and traced picture cover each
/// other.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[require(Camera3d, Tonemapping::None, TracedRender)]
pub struct TracedView {
    /// Left of this part of the viewport's width Bevy's renderer is seen: 0 is all traced, 1 none,
    /// and nothing is traced.
    pub divider: f32,
    /// What of the film is shown.
    #[reflect(ignore)]
    pub view: View,
    /// The values at the ends of a heatmap's palette; `None` takes them from the picture.
    pub range: Option<[f32; 2]>,
    /// Screen pixels along each side of one of the film's: 1, 2, 4 …
    pub pixel_size: u32,
    /// Stands still, and keeps what it has.
    pub paused: bool,
    /// Only this part of the viewport is rendered; from (0, 0) at the top left to (1, 1).
    pub region: Option<Rect>,
    /// The scene's camera whose lens, shutter and motion this one has.
    pub optics_of: Option<SceneId>,
    /// What is around this place comes first; from (0, 0) at the top left to (1, 1).
    pub focus: Vec2,
}

impl Default for TracedView {
    fn default() -> Self {
        Self {
            divider: 0.0,
            view: View::Shaded,
            range: None,
            pixel_size: 1,
            paused: false,
            region: None,
            optics_of: None,
            focus: Vec2::splat(0.5),
        }
    }
}

/// The render that a [`TracedView`] shows.
#[derive(Component, Default)]
pub struct TracedRender {
    running: Option<Running>,
    darkroom: Option<Darkroom>,
    /// What the print on the screen says of itself.
    shown: Option<PrintInfo>,
    screen: Option<ScreenOf>,
    failed: bool,
}

/// What stands on the screen.
#[derive(Clone, Debug)]
pub struct PrintInfo {
    /// Pixels of the film.
    pub size: UVec2,
    /// What a heatmap's colours mean.
    pub scale: Option<Scale>,
    /// As it stands on the screen, encoded. It stays as it is while the handle is held.
    pub picture: Handle<Image>,
    /// From the edit to this render's first picture on the screen.
    pub first_picture: Duration,
    of: usize,
}

struct Running {
    render: Arc<Progressive>,
    world: Arc<trace::World>,
    camera: trace::Camera,
    settings: RenderSettings,
    order: Order,
    started: Instant,
    paused: bool,
    focus: Vec2,
}

struct ScreenOf {
    entity: Entity,
    material: Handle<ScreenMaterial>,
}

impl TracedRender {
    /// The render's numbers now; `None` while there is none.
    pub fn status(&self) -> Option<Status> {
        Some(self.running.as_ref()?.render.status())
    }

    /// The render itself.
    pub fn render(&self) -> Option<&Progressive> {
        Some(&self.running.as_ref()?.render)
    }

    /// What it renders: world, camera and settings, the film's size among them.
    pub fn subject(&self) -> Option<(&Arc<trace::World>, &trace::Camera, &RenderSettings)> {
        let running = self.running.as_ref()?;
        Some((&running.world, &running.camera, &running.settings))
    }

    /// What stands on the screen.
    pub fn shown(&self) -> Option<&PrintInfo> {
        self.shown.as_ref()
    }

    /// Starts over with the next frame.
    pub fn restart(&mut self) {
        self.retire();
    }

    /// Whether a render that has just begun shall show its first picture before another takes its
    /// place: while something is dragged every frame begins one, and none would ever be seen.
    fn is_awaited(&self, size: UVec2) -> bool {
        let Some(running) = &self.running else {
            return false;
        };
        let of = Arc::as_ptr(&running.render) as usize;
        !running.paused
            && running.settings.size == size
            && running.started.elapsed() < LONGEST_WAIT
            && self.shown.as_ref().is_none_or(|shown| shown.of != of)
            && !matches!(running.render.status().state, State::Ended(_))
    }

    fn retire(&mut self) {
        if let Some(running) = self.running.take() {
            running.render.cancel();
            if let Some(darkroom) = &self.darkroom {
                darkroom.retire(running.render);
            }
        }
    }
}

impl Drop for TracedRender {
    fn drop(&mut self) {
        self.retire();
    }
}

/// The tracer's camera for a Bevy camera. `None` for a projection or place that has no picture.
pub fn traced_camera(
    transform: &GlobalTransform,
    projection: &Projection,
    optics: Option<&trace::Camera>,
) -> Option<trace::Camera> {
    let projection = match projection {
        Projection::Perspective(p) => scene::Projection::Perspective { fov_y: p.fov },
        Projection::Orthographic(p) => scene::Projection::Orthographic {
            height: p.area.height(),
        },
        Projection::Custom(_) => return None,
    };
    let (_, rotation, position) = transform.to_scale_rotation_translation();
    if !(rotation.is_finite() && position.is_finite()) {
        return None;
    }
    let optics = optics.map(|camera| camera.optics).unwrap_or_default();
    Some(trace::Camera::new(position, rotation, projection, optics))
}

/// Each view gets its rectangle, and a thread that develops for it.
fn give_screens(
    mut commands: Commands,
    mut added: Query<(Entity, &mut TracedRender, Option<&RenderLayers>), Added<TracedView>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<ScreenMaterial>>,
    mut images: ResMut<Assets<Image>>,
) {
    for (camera, mut render, layers) in &mut added {
        let material = ScreenMaterial {
            numbers: numbers(1.0, &Projection::default()),
            picture: images.add(no_picture()),
            depth: images.add(depth_image(1, 1, &[f32::MAX])),
        };
        let layers = layers.cloned().unwrap_or_default();
        let (entity, material) =
            spawn_screen(&mut commands, &mut meshes, &mut materials, material, layers);
        commands.entity(entity).insert(ChildOf(camera));
        render.screen = Some(ScreenOf { entity, material });
        match Darkroom::open() {
            Ok(darkroom) => render.darkroom = Some(darkroom),
            Err(problem) => {
                render.failed = true;
                error!("the traced view has no thread to develop on: {problem}");
            }
        }
    }
}

/// Starts, restarts, pauses and directs the renders.
fn follow(
    traced: Res<Traced>,
    cameras: Res<TracedCameras>,
    settings: Res<RenderSettings>,
    mut views: Query<(
        &TracedView,
        &mut TracedRender,
        &Camera,
        &GlobalTransform,
        &Projection,
    )>,
) {
    for (view, mut render, camera, transform, projection) in &mut views {
        if render.failed {
            continue;
        }
        let optics = view.optics_of.and_then(|id| {
            let found = cameras.0.iter().find(|camera| camera.id == id)?;
            Some(&found.camera)
        });
        let seen_from = traced_camera(transform, projection, optics);
        let Some((size, camera)) = seen_size(view, camera).zip(seen_from) else {
            if render.running.is_some() {
                render.retire();
            }
            continue;
        };
        let wanted = Wanted {
            world: traced.world.clone(),
            camera,
            settings: RenderSettings {
                size,
                // Only developing depends on it.
                output: Output::default(),
                ..settings.clone()
            },
            order: Order {
                output: settings.output,
                view: view.view,
                range: view.range,
            },
        };
        if render.renders(&wanted) {
            render.develop(wanted.order);
        } else if render.is_awaited(size) {
            continue;
        } else {
            render.begin(wanted);
        }
        if let Some(running) = render.running.as_mut() {
            running.direct(view);
        }
    }
}

/// The film's size; `None` where nothing of it would be seen.
fn seen_size(view: &TracedView, camera: &Camera) -> Option<UVec2> {
    let size = camera.physical_viewport_size()? / view.pixel_size.max(1);
    let seen = camera.is_active && view.divider < 1.0 && size.min_element() > 0;
    seen.then_some(size)
}

/// What a view shall show.
struct Wanted {
    world: Arc<trace::World>,
    camera: trace::Camera,
    settings: RenderSettings,
    order: Order,
}

impl TracedRender {
    /// Whether it is what is being rendered.
    fn renders(&self, wanted: &Wanted) -> bool {
        self.running.as_ref().is_some_and(|running| {
            Arc::ptr_eq(&running.world, &wanted.world)
                && running.camera == wanted.camera
                && running.settings == wanted.settings
        })
    }

    /// Prints are made in this way from now on.
    fn develop(&mut self, order: Order) {
        if let Self {
            running: Some(running),
            darkroom: Some(darkroom),
            ..
        } = self
            && running.order != order
        {
            running.order = order.clone();
            darkroom.develop(&running.render, &running.subject(), order);
        }
    }

    /// Renders this instead of what was rendered before.
    fn begin(&mut self, wanted: Wanted) {
        let started = Instant::now();
        self.retire();
        let Wanted {
            world,
            camera,
            settings,
            order,
        } = wanted;
        let render = match Progressive::start((*world).clone(), camera.clone(), settings.clone()) {
            Ok(render) => Arc::new(render),
            Err(problem) => {
                self.failed = true;
                error!("the traced view cannot render: {problem}");
                return;
            }
        };
        let running = Running {
            render,
            world,
            camera,
            settings,
            order: order.clone(),
            started,
            paused: false,
            focus: Vec2::splat(0.5),
        };
        if let Some(darkroom) = &self.darkroom {
            darkroom.develop(&running.render, &running.subject(), order);
        }
        self.running = Some(running);
    }
}

impl Running {
    fn subject(&self) -> (Arc<trace::World>, trace::Camera, RenderSettings) {
        (
            self.world.clone(),
            self.camera.clone(),
            self.settings.clone(),
        )
    }

    fn direct(&mut self, view: &TracedView) {
        if self.paused != view.paused {
            self.paused = view.paused;
            if view.paused {
                self.render.pause();
            } else {
                self.render.resume();
            }
        }
        if self.focus != view.focus && view.focus.is_finite() {
            self.focus = view.focus;
            self.render
                .set_focus(view.focus * self.settings.size.as_vec2());
        }
    }
}

/// Puts what has been developed since the last frame onto the screens.
fn show_prints(
    mut views: Query<(&TracedView, &mut TracedRender, &Projection)>,
    mut screens: Query<&mut RenderLayers, With<Screen>>,
    cameras: Query<&RenderLayers, (With<TracedView>, Without<Screen>)>,
    parents: Query<&ChildOf>,
    mut materials: ResMut<Assets<ScreenMaterial>>,
    mut images: ResMut<Assets<Image>>,
) {
    for (view, mut render, projection) in &mut views {
        let Some(screen) = &render.screen else {
            continue;
        };
        // A rectangle lies in the layers of its camera, whatever these become.
        if let Ok(parent) = parents.get(screen.entity)
            && let Ok(layers) = cameras.get(parent.parent())
            && let Ok(mut own) = screens.get_mut(screen.entity)
        {
            own.set_if_neq(layers.clone());
        }
        let print = render.darkroom.as_ref().and_then(Darkroom::take);
        let Some(mut material) = materials.get_mut(&screen.material) else {
            continue;
        };
        let divider = if render.shown.is_none() && print.is_none() {
            1.0
        } else {
            view.divider
        };
        let wanted = numbers(divider, projection);
        if material.numbers != wanted {
            material.numbers = wanted;
        }
        let Some(Print {
            size,
            bytes,
            depths,
            scale,
            of,
        }) = print
        else {
            continue;
        };
        let picture = images.add(picture_image(size.x, size.y, bytes));
        material.picture = picture.clone();
        if let Some((size, depths)) = depths {
            material.depth = images.add(depth_image(size.x, size.y, &depths));
        }
        let running = render.running.as_ref();
        let same = running.filter(|running| Arc::as_ptr(&running.render) as usize == of);
        if let Some(running) = same {
            let first_picture = running.started.elapsed();
            let before = render.shown.as_ref().filter(|shown| shown.of == of);
            let first_picture = before.map_or(first_picture, |shown| shown.first_picture);
            render.shown = Some(PrintInfo {
                size,
                scale,
                picture,
                first_picture,
                of,
            });
        }
    }
}
