//! Pictures for code: what a view shows now, and a reference picture beside a running game.

use super::Failed;
use super::film_size;
use super::traced::traced_camera;
use crate::film::{Ending, Picture, Progressive, State, develop_rgba8};
use crate::scene::{Output, RenderSettings};
use crate::sync::{SyncSystems, Traced, TreeBuilding};
use bevy::asset::RenderAssetUsages;
use bevy::camera::Projection;
use bevy::ecs::system::EntityCommands;
use bevy::image::Image;
use bevy::math::UVec2;
use bevy::prelude::{
    App, Commands, Component, Entity, EntityEvent, IntoScheduleConfigs, Plugin, PostUpdate, Query,
    Res, ResMut, Resource,
};
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy::transform::TransformSystems;
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
/// count. Despawning the entity cancels it. This one frame waits for trees that are being built; the
/// rest goes on beside the game.
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
        app.init_resource::<Hurried>().add_systems(
            PostUpdate,
            (
                hurry.before(TransformSystems::Propagate),
                (render, relax).chain().after(SyncSystems),
            ),
        );
    }
}

/// Whether trees are waited for in this frame alone.
#[derive(Resource, Default)]
struct Hurried(bool);

/// The picture is one of this frame: what is being built would be missing, and what moves in every
/// frame is never without a tree that is being built.
fn hurry(
    references: Query<&Reference>,
    mut building: ResMut<TreeBuilding>,
    mut hurried: ResMut<Hurried>,
) {
    let begins = references.iter().any(|wanted| wanted.render.is_none());
    if begins && *building == TreeBuilding::InBackground {
        *building = TreeBuilding::AtOnce;
        hurried.0 = true;
    }
}

fn relax(mut building: ResMut<TreeBuilding>, mut hurried: ResMut<Hurried>) {
    if std::mem::take(&mut hurried.0) {
        *building = TreeBuilding::InBackground;
    }
}

fn render(
    mut commands: Commands,
    traced: Res<Traced>,
    building: Res<TreeBuilding>,
    cameras: Query<(&GlobalTransform, &Projection)>,
    mut references: Query<(Entity, &mut Reference)>,
) {
    for (entity, mut reference) in &mut references {
        let Some(render) = &reference.render else {
            // It was asked for too late in this frame.
            if *building == TreeBuilding::InBackground {
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
    if let Some(refusal) = film_size::refusal(settings.size, None) {
        return Err(refusal);
    }
    Progressive::start_for_file((*traced.world).clone(), camera, settings)
        .map_err(|problem| problem.to_string())
}
