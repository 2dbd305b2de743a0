//! A Bevy camera that shows the tracer's picture of what it looks at.
//!
//! Every frame [`follow`] asks what has changed since the render that is going on was started. A
//! change of the tracer's world, of the camera or of a setting that rays depend on starts another
//! one, but for one of the lights alone, which the render takes as an edit; exposure, view transform, bloom and the view are only developed again. The render it
//! replaces is cancelled and left to the developing thread to end: nothing here waits.

use super::adapter::Adapter;
use super::darkroom::{Darkroom, Order, Print};
use super::film_size;
use super::render::{PrintInfo, TracedRender, Wanted};
use super::screen::{Screen, depth_image, depth_numbers, no_depth, picture_image};
use super::surfaces::Surfaces;
use crate::film::views::View;
use crate::film::{Ending, LightMix};
use crate::scene::{self, Output, RenderSettings, Sampling, SceneId};
use crate::sync::{LeftOut, SyncSystems, Traced, TracedCameras};
use crate::trace;
use bevy::asset::{AssetEventSystems, Assets};
use bevy::camera::{Camera, Camera3d, OrthographicProjection, Projection, ScalingMode};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::lifecycle::Remove;
use bevy::ecs::observer::On;
use bevy::ecs::reflect::ReflectComponent;
use bevy::image::Image;
use bevy::math::{Rect, URect, UVec2, Vec2};
use bevy::prelude::{
    App, Commands, Component, EntityEvent, IntoScheduleConfigs, Or, Plugin, PostUpdate, Query, Res,
    ResMut, With, Without,
};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::GlobalTransform;

/// Starts, restarts and shows renders. Needs [`SyncPlugin`](crate::sync::SyncPlugin) and a window.
pub struct TracedViewPlugin;

impl Plugin for TracedViewPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<TracedView>()
            .register_type::<ViewSettings>()
            .add_observer(leave)
            .add_systems(
                PostUpdate,
                (
                    (attend, follow).chain().after(SyncSystems),
                    // So that a print's texture reaches the renderer with the screen that names it.
                    (show_prints, show_twins).chain().before(AssetEventSystems),
                ),
            );
    }
}

/// On a `Camera3d`: the tracer draws what this camera sees, in the camera's viewport and nowhere else.
///
/// The camera's own transform and projection count, so that raster and traced picture cover each
/// other. The picture comes after all that Bevy does to what it rasterises (tone mapping, bloom,
/// anti-aliasing …), and is as [`Output`] says.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[require(Camera3d, TracedRender)]
pub struct TracedView {
    /// Left of this part of the viewport's width Bevy's renderer is seen: 0 is all traced, 1 none,
    /// and nothing is traced.
    pub divider: f32,
    /// What of the film is shown.
    #[reflect(ignore)]
    pub view: View,
    /// The values at the ends of a heatmap's palette, the smaller one first; `None`, and what is no such pair, takes them from
    /// the picture.
    pub range: Option<[f32; 2]>,
    /// Screen pixels along each side of one of the film's: 1, 2, 4 …
    pub pixel_size: u32,
    /// Stands still: the picture that there is stays, whatever becomes of scene and camera.
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

/// What a [`TracedView`] renders with, where that is other than the app's [`RenderSettings`].
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
pub struct ViewSettings {
    /// Pixels of the film, whatever the viewport has, which it fills; `None` as many as that.
    pub size: Option<UVec2>,
    /// Samples of each pixel.
    pub spp: Option<u32>,
    /// The error or the time to stop at.
    pub sampling: Option<Sampling>,
    /// Whether lights are kept apart, and what multiplies each: no ray is traced for another gain, and the scene stays as it
    /// is.
    #[reflect(ignore)]
    pub mix: LightMix,
}

/// Triggered on a view when its picture is done and on the screen: by samples, error or time. Another
/// render, after an edit for example, triggers it again.
#[derive(EntityEvent, Clone, Debug, PartialEq, Eq)]
pub struct Converged {
    /// The view.
    pub entity: Entity,
    /// Which rule of the settings ended it.
    pub ending: Ending,
}

/// Triggered on a view, or on what [`render_reference`](super::render_reference) spawned, when it
/// cannot render; once for each reason. A view goes on when that is gone.
#[derive(EntityEvent, Clone, Debug, PartialEq, Eq)]
pub struct Failed {
    /// The view.
    pub entity: Entity,
    /// Why.
    pub problem: String,
}

/// On a camera: it shows the traced picture of another one, which has a [`TracedView`] and looks at the same.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShowsPictureOf(pub Entity);

/// The tracer's camera for a Bevy camera, with the lens, shutter and motion of `optics`. `None` for a projection or place that
/// has no picture. How high an orthographic picture is, where that hangs on its width, is as Bevy has last laid it out.
pub fn traced_camera(
    transform: &GlobalTransform,
    projection: &Projection,
    optics: Option<&trace::Camera>,
) -> Option<trace::Camera> {
    let (scale, rotation, position) = transform.to_scale_rotation_translation();
    let (projection, middle) = match projection {
        Projection::Perspective(p) => {
            let projection = scene::Projection::Perspective { fov_y: p.fov };
            (projection, Vec2::ZERO)
        }
        Projection::Orthographic(p) => {
            let height = height_of(p) * scale.y.abs();
            let middle = p.area.center() * scale.truncate();
            (scene::Projection::Orthographic { height }, middle)
        }
        Projection::Custom(_) => return None,
    };
    let position = position + rotation * middle.extend(0.0);
    if !(rotation.is_finite() && position.is_finite()) {
        return None;
    }
    let optics = optics.map(|camera| camera.optics).unwrap_or_default();
    Some(trace::Camera::new(position, rotation, projection, optics))
}

/// How high the picture of an orthographic camera is, in metres; also where Bevy has not laid it out for a viewport.
pub(crate) fn height_of(projection: &OrthographicProjection) -> f32 {
    match projection.scaling_mode {
        ScalingMode::FixedVertical {
            viewport_height: height,
        }
        | ScalingMode::Fixed { height, .. } => height * projection.scale,
        _ => projection.area.height(),
    }
}

/// Nothing is left of a view, and nothing goes on for it, once it is none any more.
fn leave(view: On<Remove, TracedView>, mut commands: Commands) {
    if let Ok(mut camera) = commands.get_entity(view.entity) {
        camera.try_remove::<(TracedRender, Screen)>();
    }
}

/// What a view is looked through with.
type Complete = (With<Camera>, With<GlobalTransform>, With<Projection>);
/// Disabled, which no other query meets, or no camera any more that could show anything.
type Resting = Or<(
    With<Disabled>,
    Without<Camera>,
    Without<GlobalTransform>,
    Without<Projection>,
)>;

/// Each view has a thread that develops for it; one that rests has nothing that goes on.
fn attend(
    mut commands: Commands,
    mut views: Query<(Entity, &mut TracedRender), With<TracedView>>,
    resting: Query<Entity, (With<TracedRender>, Resting)>,
    without: Query<Entity, (With<TracedView>, Without<TracedRender>, Complete)>,
) {
    for view in &resting {
        commands.entity(view).try_remove::<(TracedRender, Screen)>();
    }
    for view in &without {
        commands.entity(view).try_insert(TracedRender::default());
    }
    for (entity, mut render) in &mut views {
        if render.darkroom.is_some() || render.has_just_failed() {
            continue;
        }
        match Darkroom::open() {
            Ok(darkroom) => render.darkroom = Some(darkroom),
            Err(problem) => {
                let problem = format!("the traced view has no thread to develop on: {problem}");
                if let Some(problem) = render.fail(problem) {
                    commands.trigger(Failed { entity, problem });
                }
            }
        }
    }
}

/// The pixels that a part of the view touches.
fn pixels_of(region: Rect, size: UVec2) -> URect {
    let pixels = size.as_vec2();
    URect {
        min: (region.min * pixels).floor().as_uvec2(),
        max: (region.max * pixels).ceil().as_uvec2().min(size),
    }
}

/// Starts, restarts, pauses and directs the renders.
fn follow(
    traced: Res<Traced>,
    cameras: Res<TracedCameras>,
    settings: Res<RenderSettings>,
    adapter: Adapter,
    mut left_out: ResMut<LeftOut>,
    mut commands: Commands,
    mut views: Query<(
        Entity,
        &TracedView,
        Option<&ViewSettings>,
        &mut TracedRender,
        &Camera,
        &GlobalTransform,
        &Projection,
    )>,
) {
    for (entity, view, own, mut render, camera, transform, projection) in &mut views {
        // One that was given to a view just now has a thread with the next frame.
        if render.has_just_failed() || render.darkroom.is_none() {
            continue;
        }
        let optics = view.optics_of.and_then(|id| {
            let found = cameras.0.iter().find(|camera| camera.id == id)?;
            Some(&found.camera)
        });
        let seen_from = traced_camera(transform, projection, optics);
        let own = own.cloned().unwrap_or_default();
        let refusal = own
            .size
            .and_then(|size| film_size::refusal(size, adapter.largest_side()));
        let is_nowhere = seen_from.is_none() && !matches!(projection, Projection::Custom(_));
        let nowhere = is_nowhere
            .then(|| "its place is not a finite one; nothing is traced for it".to_owned());
        let size = seen_size(view, camera).map(|size| own.size.unwrap_or(size));
        let size = size.filter(|_| refusal.is_none());
        let has_picture = seen_from.is_some() && refusal.is_none();
        let refused = refusal.as_ref().or(nowhere.as_ref());
        if render.refused.as_ref() != refused {
            render.refused = refused.cloned();
            if let Some(problem) = render.refused.clone() {
                commands.trigger(Failed { entity, problem });
            }
        }
        let notes = |note: Option<String>| note.into_iter().collect();
        LeftOut::note(&mut left_out, "film of view", entity, notes(refusal));
        LeftOut::note(&mut left_out, "place of view", entity, notes(nowhere));
        if !has_picture && render.shown.take().is_some() {
            // It has no picture, and the one before is none of it.
            commands.entity(entity).try_remove::<Screen>();
        }
        let Some((size, camera)) = size.zip(seen_from) else {
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
                spp: own.spp.unwrap_or(settings.spp),
                sampling: own.sampling.unwrap_or(settings.sampling),
                // Only developing depends on it.
                output: Output::default(),
                ..settings.clone()
            },
            region: view.region.map(|region| pixels_of(region, size)),
            mix: own.mix,
            order: Order {
                output: settings.output,
                view: view.view,
                range: view.range.filter(is_range),
            },
        };
        let keeps = view.paused && render.running.is_some();
        if keeps || render.renders(&wanted) {
            render.develop(wanted.order);
        } else if render.is_awaited(size) {
            continue;
        } else {
            if let Some(problem) = render.begin(wanted) {
                commands.trigger(Failed { entity, problem });
            }
        }
        if let Some(running) = render.running.as_mut() {
            running.direct(view);
        }
    }
}

fn is_range([low, high]: &[f32; 2]) -> bool {
    low.is_finite() && high.is_finite() && low < high
}

/// The film's size; `None` where nothing of it would be seen.
fn seen_size(view: &TracedView, camera: &Camera) -> Option<UVec2> {
    let size = camera.physical_viewport_size()? / view.pixel_size.max(1);
    let seen = camera.is_active && view.divider < 1.0 && size.min_element() > 0;
    seen.then_some(size)
}

/// What stands on a view's screen stands on its twins' too.
fn show_twins(
    mut commands: Commands,
    twins: Query<(Entity, &ShowsPictureOf, Option<&Screen>)>,
    screens: Query<&Screen>,
) {
    for (twin, of, shown) in &twins {
        let wanted = screens.get(of.0).ok();
        if wanted == shown {
            continue;
        }
        let Ok(mut twin) = commands.get_entity(twin) else {
            continue;
        };
        match wanted {
            Some(wanted) => twin.try_insert(wanted.clone()),
            None => twin.try_remove::<Screen>(),
        };
    }
}

/// Puts what has been developed since the last frame onto the screens.
fn show_prints(
    mut commands: Commands,
    mut views: Query<(
        Entity,
        &TracedView,
        Option<&ViewSettings>,
        &mut TracedRender,
        &Projection,
        Option<&mut Screen>,
    )>,
    mut images: ResMut<Assets<Image>>,
) {
    for (entity, view, own, mut render, projection, mut screen) in &mut views {
        let keeps_shape = own.is_none_or(|own| own.size.is_none());
        if let Some(screen) = &mut screen {
            let wanted = Screen {
                divider: view.divider,
                numbers: depth_numbers(projection),
                keeps_shape,
                ..(**screen).clone()
            };
            screen.set_if_neq(wanted);
        }
        let Some(print) = render.darkroom.as_ref().and_then(Darkroom::take) else {
            continue;
        };
        if render.running.is_none() {
            // It was made of what is not shown any more.
            continue;
        }
        let Print {
            size,
            bytes,
            surfaces,
            scale,
            of,
            ending,
        } = print;
        let picture = images.add(picture_image(size.x, size.y, bytes));
        let depth = surfaces.map(
            |Surfaces {
                 size,
                 depths,
                 backs,
             }| {
                render.backs = backs;
                images.add(depth_image(size.x, size.y, &depths))
            },
        );
        match screen {
            Some(mut screen) => {
                screen.picture = picture.clone();
                if let Some(depth) = depth {
                    screen.depth = depth;
                }
            }
            None => {
                commands.entity(entity).try_insert(Screen {
                    picture: picture.clone(),
                    depth: depth.unwrap_or_else(|| images.add(no_depth())),
                    divider: view.divider,
                    numbers: depth_numbers(projection),
                    keeps_shape,
                });
            }
        }
        let running = render.running.as_ref();
        let same = running.filter(|running| running.render.number() == of);
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
            if let Some(ending) = ending.filter(|_| render.told != Some(of)) {
                render.told = Some(of);
                commands.trigger(Converged { entity, ending });
            }
        }
    }
}

#[cfg(test)]
mod tests;
