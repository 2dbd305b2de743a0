//! How Bevy's renderer draws what stands on a view's [`Screen`]: a pass of that view alone, after its
//! post-processing and before any interface, so that no tone mapping, bloom or anti-aliasing changes
//! what was developed already, whatever the camera has.
//!
//! Gizmos are drawn again over it, against the depth of what was traced. Where the picture covers the
//! whole viewport nothing of the rasterised scene is drawn below it.

use super::screen::{Screen, widening};
use super::screen_part::{traced_part, whole_part};
use bevy::anti_alias::contrast_adaptive_sharpening::cas;
use bevy::anti_alias::fxaa::fxaa;
use bevy::anti_alias::smaa::smaa;
use bevy::asset::{AssetServer, Handle, embedded_asset, load_embedded_asset};
use bevy::camera::{Camera, CompositingSpace};
use bevy::core_pipeline::FullscreenShader;
use bevy::core_pipeline::blit::{BlitPipeline, BlitPipelineKey};
use bevy::core_pipeline::core_3d::{CORE_3D_DEPTH_FORMAT, Transparent3d};
use bevy::core_pipeline::schedule::{Core3d, Core3dSystems};
use bevy::core_pipeline::tonemapping::tonemapping;
use bevy::ecs::entity_disabling::Disabled;
use bevy::log::error;
use bevy::pbr::{RenderMaterialInstances, ViewLightEntities};
use bevy::prelude::{
    App, Commands, Component, Entity, IntoScheduleConfigs, Plugin, Query, Res, ResMut, Resource,
    With, World, default,
};
use bevy::render::camera::ExtractedCamera;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_phase::{PhaseItem, ViewSortedRenderPhases};
use bevy::render::render_resource::binding_types::{texture_2d, uniform_buffer};
use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries,
    BufferInitDescriptor, BufferUsages, CachedRenderPipelineId, ColorTargetState, ColorWrites,
    CompareFunction, DepthStencilState, FragmentState, LoadOp, MultisampleState, Operations,
    PipelineCache, RenderPassColorAttachment, RenderPassDescriptor, RenderPipelineDescriptor,
    ShaderStages, SpecializedRenderPipeline, SpecializedRenderPipelines, StoreOp, TextureFormat,
    TextureSampleType,
};
use bevy::render::renderer::{CurrentView, RenderContext, RenderDevice, ViewQuery};
use bevy::render::sync_world::RenderEntity;
use bevy::render::texture::GpuImage;
use bevy::render::view::{ExtractedView, Msaa, ViewDepthTexture, ViewTarget};
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderStartup, RenderSystems};
use bevy::shader::Shader;

/// Draws each camera's [`Screen`]. Does nothing in an app without a renderer.
pub(super) struct ScreenPlugin;

impl Plugin for ScreenPlugin {
    fn build(&self, app: &mut App) {
        if app.get_sub_app(RenderApp).is_none() {
            return;
        }
        embedded_asset!(app, "screen.wgsl");
        let Some(renderer) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        renderer
            .init_resource::<SpecializedRenderPipelines<ScreenPipeline>>()
            .add_systems(RenderStartup, init_pipeline)
            .add_systems(ExtractSchedule, extract_screens)
            .add_systems(
                Render,
                prepare_screens.in_set(RenderSystems::PrepareBindGroups),
            )
            .configure_sets(
                Core3d,
                (
                    Core3dSystems::Prepass.run_if(is_uncovered),
                    Core3dSystems::MainPass.run_if(is_uncovered),
                    Core3dSystems::EarlyPostProcess.run_if(is_uncovered),
                ),
            )
            .add_systems(
                Core3d,
                (
                    clear_below
                        .after(Core3dSystems::MainPass)
                        .before(Core3dSystems::EarlyPostProcess),
                    draw_screen
                        .in_set(Core3dSystems::PostProcess)
                        .after(tonemapping)
                        .after(fxaa)
                        .after(smaa)
                        .after(cas),
                ),
            );
    }
}

#[derive(Resource)]
struct ScreenPipeline {
    layout: BindGroupLayoutDescriptor,
    vertices: FullscreenShader,
    shader: Handle<Shader>,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct ScreenKey {
    format: TextureFormat,
    samples: u32,
    space: Option<CompositingSpace>,
}

fn init_pipeline(
    mut commands: Commands,
    vertices: Res<FullscreenShader>,
    assets: Res<AssetServer>,
) {
    let exact = TextureSampleType::Float { filterable: false };
    let entries = BindGroupLayoutEntries::sequential(
        ShaderStages::FRAGMENT,
        (
            texture_2d(exact),
            texture_2d(exact),
            uniform_buffer::<bevy::math::Vec4>(false),
        ),
    );
    commands.insert_resource(ScreenPipeline {
        layout: BindGroupLayoutDescriptor::new("traced_picture", &entries),
        vertices: vertices.clone(),
        shader: load_embedded_asset!(assets.as_ref(), "screen.wgsl"),
    });
}

impl SpecializedRenderPipeline for ScreenPipeline {
    type Key = ScreenKey;

    fn specialize(&self, key: ScreenKey) -> RenderPipelineDescriptor {
        let shader_defs = match key.space {
            Some(CompositingSpace::Srgb) => vec!["LINEAR_TO_SRGB".into()],
            Some(CompositingSpace::Oklab) => vec!["LINEAR_TO_OKLAB".into()],
            Some(CompositingSpace::Linear) | None => Vec::new(),
        };
        RenderPipelineDescriptor {
            label: Some("traced_picture".into()),
            layout: vec![self.layout.clone()],
            vertex: self.vertices.to_vertex_state(),
            fragment: Some(FragmentState {
                shader: self.shader.clone(),
                shader_defs,
                targets: vec![Some(ColorTargetState {
                    format: key.format,
                    blend: None,
                    write_mask: ColorWrites::ALL,
                })],
                ..default()
            }),
            // Whatever is there already: this covers it.
            depth_stencil: Some(DepthStencilState {
                format: CORE_3D_DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(CompareFunction::Always),
                stencil: default(),
                bias: default(),
            }),
            multisample: MultisampleState {
                count: key.samples,
                ..default()
            },
            ..default()
        }
    }
}

/// A camera that shows nothing any more has nothing left in the renderer either, and one that was
/// disabled is not met by a query without saying so.
fn extract_screens(
    mut commands: Commands,
    cameras: Extract<Query<(RenderEntity, Option<&Screen>), With<Camera>>>,
    disabled: Extract<Query<RenderEntity, (With<Camera>, With<Disabled>)>>,
) {
    for (entity, screen) in &cameras {
        let mut entity = commands.entity(entity);
        match screen {
            Some(screen) => entity.insert(screen.clone()),
            None => entity.remove::<(Screen, Prepared)>(),
        };
    }
    for entity in &disabled {
        commands.entity(entity).remove::<(Screen, Prepared)>();
    }
}

/// What the pass of a view needs.
#[derive(Component)]
struct Prepared {
    bind_group: BindGroup,
    pipeline: CachedRenderPipelineId,
    /// Copies what is there into the texture of several samples a pixel, where there is one.
    copies: Option<CachedRenderPipelineId>,
    /// [`Screen::divider`] of what the bind group holds.
    divider: f32,
}

impl Prepared {
    fn is_ready(&self, cache: &PipelineCache) -> bool {
        let mut pipelines = [self.pipeline].into_iter().chain(self.copies);
        pipelines.all(|id| cache.get_render_pipeline(id).is_some())
    }

    fn covers_all(&self, cache: &PipelineCache) -> bool {
        self.divider <= 0.0 && self.is_ready(cache)
    }
}

/// Binds what each screen shows. A picture that has not reached the graphics card leaves the one
/// before on the screen.
fn prepare_screens(
    mut commands: Commands,
    device: Res<RenderDevice>,
    pipeline: Res<ScreenPipeline>,
    blit: Res<BlitPipeline>,
    cache: Res<PipelineCache>,
    mut pipelines: ResMut<SpecializedRenderPipelines<ScreenPipeline>>,
    mut copies: ResMut<SpecializedRenderPipelines<BlitPipeline>>,
    images: Res<RenderAssets<GpuImage>>,
    mut views: Query<(
        Entity,
        &Screen,
        &ViewTarget,
        &ExtractedCamera,
        &Msaa,
        Option<&mut Prepared>,
        Option<&mut ViewLightEntities>,
    )>,
) {
    for (entity, screen, target, camera, msaa, prepared, shadows) in &mut views {
        let format = target.main_texture_format();
        let samples = msaa.samples();
        let key = ScreenKey {
            format,
            samples,
            space: target.compositing_space,
        };
        let copies = (samples > 1).then(|| {
            let key = BlitPipelineKey {
                target_format: format,
                blend_state: None,
                samples,
                source_space: None,
            };
            copies.specialize(&cache, &blit, key)
        });
        let pipeline_id = pipelines.specialize(&cache, &pipeline, key);
        let shown = [&screen.picture, &screen.depth].map(|image| images.get(image));
        let bind_group = match (shown, &prepared) {
            ([Some(picture), Some(depth)], _) => {
                let view = whole_part(camera).map(|whole| whole.size());
                let view = view.filter(|size| screen.keeps_shape && size.min_element() > 0);
                let widening = view.map_or(1.0, |view| widening(view, picture.size_2d()));
                let numbers: Vec<u8> = screen
                    .numbers
                    .extend(widening)
                    .to_array()
                    .into_iter()
                    .flat_map(f32::to_ne_bytes)
                    .collect();
                let numbers = device.create_buffer_with_data(&BufferInitDescriptor {
                    label: Some("traced_picture"),
                    contents: &numbers,
                    usage: BufferUsages::UNIFORM,
                });
                device.create_bind_group(
                    "traced_picture",
                    &cache.get_bind_group_layout(&pipeline.layout),
                    &BindGroupEntries::sequential((
                        &picture.texture_view,
                        &depth.texture_view,
                        numbers.as_entire_binding(),
                    )),
                )
            }
            (_, Some(before)) => before.bind_group.clone(),
            _ => continue,
        };
        let new = Prepared {
            bind_group,
            pipeline: pipeline_id,
            copies,
            divider: screen.divider,
        };
        if new.covers_all(&cache)
            && let Some(mut shadows) = shadows
        {
            // Of these nothing would be seen.
            shadows.lights.clear();
        }
        match prepared {
            Some(mut prepared) => *prepared = new,
            None => {
                commands.entity(entity).insert(new);
            }
        }
    }
}

/// Whether anything of the rasterised scene is seen in the view that is drawn now.
fn is_uncovered(
    current: Option<Res<CurrentView>>,
    screens: Query<&Prepared>,
    cache: Res<PipelineCache>,
) -> bool {
    let screen = current.and_then(|view| screens.get(view.0).ok());
    !screen.is_some_and(|screen| screen.covers_all(&cache))
}

/// In place of the main passes, which would have cleared the view's textures.
fn clear_below(
    view: ViewQuery<(&ViewTarget, &ViewDepthTexture, &Prepared)>,
    cache: Res<PipelineCache>,
    mut context: RenderContext,
) {
    let (target, depth, screen) = view.into_inner();
    if screen.covers_all(&cache) {
        context.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("below_traced_picture"),
            color_attachments: &[Some(target.get_color_attachment())],
            depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
            ..default()
        });
    }
}

/// The picture, and gizmos over it.
fn draw_screen(
    world: &World,
    view: ViewQuery<(
        &ExtractedCamera,
        &ExtractedView,
        &ViewTarget,
        &ViewDepthTexture,
        &Prepared,
    )>,
    phases: Res<ViewSortedRenderPhases<Transparent3d>>,
    of_materials: Res<RenderMaterialInstances>,
    blit: Res<BlitPipeline>,
    cache: Res<PipelineCache>,
    mut context: RenderContext,
) {
    let entity = view.entity();
    let (camera, view, target, depth, screen) = view.into_inner();
    let Some(part) = traced_part(camera, screen.divider) else {
        return;
    };
    let Some(pipeline) = cache.get_render_pipeline(screen.pipeline) else {
        return;
    };
    let color = match (target.sampled_main_texture_view(), screen.copies) {
        (Some(sampled), Some(copies)) => {
            let Some(copies) = cache.get_render_pipeline(copies) else {
                return;
            };
            // What post-processing left is in the texture of one sample a pixel alone.
            let write = target.post_process_write();
            let source = blit.create_bind_group(context.render_device(), write.source, &cache);
            let attachment = |load, resolve_target| RenderPassColorAttachment {
                view: sampled,
                depth_slice: None,
                resolve_target,
                ops: Operations {
                    load,
                    store: StoreOp::Store,
                },
            };
            let mut pass = context.begin_tracked_render_pass(RenderPassDescriptor {
                label: Some("beside_traced_picture"),
                color_attachments: &[Some(attachment(LoadOp::Clear(default()), None))],
                ..default()
            });
            pass.set_render_pipeline(copies);
            pass.set_bind_group(0, &source, &[]);
            pass.draw(0..3, 0..1);
            attachment(LoadOp::Load, Some(write.destination))
        }
        _ => target.get_unsampled_color_attachment(),
    };
    let mut pass = context.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("traced_picture"),
        color_attachments: &[Some(color)],
        depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
        ..default()
    });
    if let Some(viewport) = &camera.viewport {
        pass.set_camera_viewport(viewport);
    }
    let (corner, size) = (part.min, part.size());
    pass.set_scissor_rect(corner.x, corner.y, size.x, size.y);
    pass.set_render_pipeline(pipeline);
    pass.set_bind_group(0, &screen.bind_group, &[]);
    pass.draw(0..3, 0..1);
    let Some(phase) = phases.get(&view.retained_view_entity) else {
        return;
    };
    for (place, item) in phase.items.values().enumerate() {
        // What has a material was traced, or stands behind the picture.
        if of_materials.instances.contains_key(&item.main_entity()) {
            continue;
        }
        if let Err(problem) = phase.render_range(&mut pass, world, entity, place..=place) {
            error!("a gizmo over the traced picture was not drawn: {problem}");
        }
    }
}
