//! Pictures for code: what a view shows now, and a reference picture beside a running game.

use super::Failed;
use super::traced::traced_camera;
use crate::film::{Ending, Picture, Progressive, State, develop_rgba8};
use crate::scene::{Output, RenderSettings};
use crate::sync::{SyncSystems, Traced};
use bevy::asset::RenderAssetUsages;
use bevy::camera::Projection;
use bevy::ecs::system::EntityCommands;
use bevy::image::Image;
use bevy::math::UVec2;
use bevy::prelude::{
    App, Commands, Component, Entity, EntityEvent, IntoScheduleConfigs, Plugin, PostUpdate, Query,
    Res,
};
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy::transform::components::GlobalTransform;
use std::sync::Arc;

/// A picture of a render at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedPicture {
    /// Linear and scene-referred: before exposure, bloom and view transform.
    pub linear: Picture,
    /// As it is shown: four bytes a pixel, red, green, blue and an alpha of 255, encoded as sRGB, row
    /// by row from the top.
    pub shown: Vec<u8>,
}

impl TracedPicture {
    pub(super) fn of(render: &Progressive, output: &Output) -> Self {
        let linear = render.snapshot().picture;
        let shown = develop_rgba8(&linear, output);
        Self { linear, shown }
    }

    /// Pixels.
    pub fn size(&self) -> UVec2 {
        self.linear.size()
    }

    /// As it is shown, for an `Assets<Image>`: `Rgba8UnormSrgb`, in both worlds.
    pub fn image(&self) -> Image {
        let size = Extent3d {
            width: self.linear.width,
            height: self.linear.height,
            depth_or_array_layers: 1,
        };
        Image::new(
            size,
            TextureDimension::D2,
            self.shown.clone(),
            TextureFormat::Rgba8UnormSrgb,
            RenderAssetUsages::default(),
        )
    }
}

/// Triggered on the entity of [`render_reference`] when its picture is done. The entity is despawned
/// after it.
#[derive(EntityEvent, Clone, Debug)]
pub struct ReferenceRendered {
    /// What [`render_reference`] spawned.
    pub entity: Entity,
    /// The picture.
    pub picture: Arc<TracedPicture>,
    /// Which of the settings' rules ended it.
    pub ending: Ending,
}

/// A reference picture that is wanted, or being rendered.
#[derive(Component)]
struct Reference {
    camera: Entity,
    settings: RenderSettings,
    render: Option<Progressive>,
}

/// Renders what a camera sees in this frame, while the game goes on: to the settings' size, samples,
/// error or time. The camera needs no [`TracedView`](super::TracedView); its transform and projection
/// count. Despawning the entity cancels it.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use glassbox::scene::RenderSettings;
/// # use glassbox::view::{ReferenceRendered, render_reference};
/// fn shoot(mut commands: Commands, camera: Single<Entity, With<Camera3d>>) {
///     let settings = RenderSettings { spp: 256, ..default() };
///     render_reference(&mut commands, *camera, settings).observe(|done: On<ReferenceRendered>| {
///         info!("{} pixels", done.picture.size());
///     });
/// }
/// ```
pub fn render_reference<'a>(
    commands: &'a mut Commands,
    camera: Entity,
    settings: RenderSettings,
) -> EntityCommands<'a> {
    commands.spawn(Reference {
        camera,
        settings,
        render: None,
    })
}

/// Renders what [`render_reference`] asks for.
pub(super) struct ReferencePlugin;

impl Plugin for ReferencePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PostUpdate, render.after(SyncSystems));
    }
}

fn render(
    mut commands: Commands,
    traced: Res<Traced>,
    cameras: Query<(&GlobalTransform, &Projection)>,
    mut references: Query<(Entity, &mut Reference)>,
) {
    for (entity, mut reference) in &mut references {
        let Some(render) = &reference.render else {
            // What is still being built would be missing.
            if traced.pending > 0 {
                continue;
            }
            match begin(&reference, &traced, &cameras) {
                Ok(render) => reference.render = Some(render),
                Err(problem) => {
                    commands.trigger(Failed { entity, problem });
                    commands.entity(entity).try_despawn();
                }
            }
            continue;
        };
        let State::Ended(ending) = render.status().state else {
            continue;
        };
        let picture = TracedPicture::of(render, &reference.settings.output);
        commands.trigger(ReferenceRendered {
            entity,
            picture: Arc::new(picture),
            ending,
        });
        commands.entity(entity).try_despawn();
    }
}

fn begin(
    reference: &Reference,
    traced: &Traced,
    cameras: &Query<(&GlobalTransform, &Projection)>,
) -> Result<Progressive, String> {
    let camera = cameras.get(reference.camera);
    let (transform, projection) = camera.map_err(|_| "the camera is gone".to_owned())?;
    let camera = traced_camera(transform, projection, None)
        .ok_or("the camera's place or projection cannot be traced")?;
    let settings = reference.settings.clone();
    Progressive::start_for_file((*traced.world).clone(), camera, settings)
        .map_err(|problem| problem.to_string())
}
