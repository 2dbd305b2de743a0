//! The traced picture as something that Bevy's renderer draws: a rectangle over the whole viewport
//! with the depth of what was traced, so that gizmos are hidden by what they stand behind.
//!
//! It is drawn after the opaque part of the rasterised scene, which it covers where it shows, and
//! before gizmos.

use crate::scene::NotTraced;
use bevy::asset::{Asset, Assets, Handle, RenderAssetUsages, embedded_asset};
use bevy::camera::visibility::{NoFrustumCulling, RenderLayers};
use bevy::image::{Image, ImageSampler, TextureFormatPixelInfo};
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::mesh::{Indices, Mesh, Mesh3d, MeshVertexBufferLayoutRef, PrimitiveTopology};
use bevy::pbr::{Material, MaterialPipeline, MaterialPipelineKey, MaterialPlugin, MeshMaterial3d};
use bevy::prelude::{AlphaMode, App, Commands, Component, Plugin, Transform, Vec3, Vec4};
use bevy::reflect::TypePath;
use bevy::render::render_resource::{
    AsBindGroup, CompareFunction, Extent3d, RenderPipelineDescriptor, SpecializedMeshPipelineError,
    TextureDimension, TextureFormat,
};
use bevy::shader::ShaderRef;

/// Adds the material.
pub(super) struct ScreenPlugin;

impl Plugin for ScreenPlugin {
    fn build(&self, app: &mut App) {
        embedded_asset!(app, "screen.wgsl");
        app.add_plugins(MaterialPlugin::<ScreenMaterial>::default());
    }
}

/// What the rectangle shows.
#[derive(Asset, AsBindGroup, TypePath, Clone)]
pub(super) struct ScreenMaterial {
    /// x: nothing is drawn left of this part of the viewport's width. y, z, w: the depth that is
    /// written is `y / metres + z - w · metres`.
    #[uniform(0)]
    pub numbers: Vec4,
    /// Encoded for the screen.
    #[texture(1)]
    #[sampler(2)]
    pub picture: Handle<Image>,
    /// Metres along the view axis.
    #[texture(3, sample_type = "float", filterable = false)]
    pub depth: Handle<Image>,
}

impl Material for ScreenMaterial {
    fn vertex_shader() -> ShaderRef {
        "embedded://glassbox/view/screen.wgsl".into()
    }

    fn fragment_shader() -> ShaderRef {
        "embedded://glassbox/view/screen.wgsl".into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        // These are drawn after what is opaque, and before gizmos, which are drawn first of all
        // that is blended.
        AlphaMode::Mask(0.5)
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        _: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        // Whatever is there already: this covers it.
        if let Some(depth) = descriptor.depth_stencil.as_mut() {
            depth.depth_write_enabled = Some(true);
            depth.depth_compare = Some(CompareFunction::Always);
        }
        descriptor.primitive.cull_mode = None;
        Ok(())
    }
}

/// Marks the rectangle that belongs to a view.
#[derive(Component)]
pub(super) struct Screen;

/// A rectangle over the whole viewport.
pub(super) fn spawn_screen(
    commands: &mut Commands,
    meshes: &mut Assets<Mesh>,
    materials: &mut Assets<ScreenMaterial>,
    material: ScreenMaterial,
    layer: RenderLayers,
) -> (bevy::ecs::entity::Entity, Handle<ScreenMaterial>) {
    let corners = [
        Vec3::new(-1.0, -1.0, 0.0),
        Vec3::new(1.0, -1.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(-1.0, 1.0, 0.0),
    ];
    let mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::RENDER_WORLD,
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners.to_vec())
    .with_inserted_indices(Indices::U32(vec![0, 1, 2, 0, 2, 3]));
    let handle = materials.add(material);
    let entity = commands.spawn((
        (Screen, NotTraced),
        Mesh3d(meshes.add(mesh)),
        MeshMaterial3d(handle.clone()),
        NoFrustumCulling,
        NotShadowCaster,
        NotShadowReceiver,
        Transform::default(),
        layer,
    ));
    (entity.id(), handle)
}

/// A picture of one black pixel, until there is one.
pub(super) fn no_picture() -> Image {
    picture_image(1, 1, vec![0, 0, 0, 255])
}

/// Bytes in RGBA, as they go to the screen.
pub(super) fn picture_image(width: u32, height: u32, bytes: Vec<u8>) -> Image {
    image(width, height, bytes, TextureFormat::Rgba8UnormSrgb)
}

/// Metres along the view axis, one number a pixel.
pub(super) fn depth_image(width: u32, height: u32, depths: &[f32]) -> Image {
    let bytes = depths.iter().flat_map(|d| d.to_ne_bytes()).collect();
    image(width, height, bytes, TextureFormat::R32Float)
}

fn image(width: u32, height: u32, bytes: Vec<u8>, format: TextureFormat) -> Image {
    debug_assert_eq!(
        bytes.len(),
        (width * height) as usize * format.pixel_size().unwrap_or(0),
    );
    let size = Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let usage = RenderAssetUsages::RENDER_WORLD;
    let mut image = Image::new(size, TextureDimension::D2, bytes, format, usage);
    // Pixels are pixels: a coarse preview and a zoomed one show what they are.
    image.sampler = ImageSampler::nearest();
    image
}

/// The three numbers of [`ScreenMaterial`] that turn metres into Bevy's reversed depth.
pub(super) fn depth_numbers(projection: &bevy::camera::Projection) -> [f32; 3] {
    match projection {
        bevy::camera::Projection::Orthographic(p) => {
            let length = p.far - p.near;
            [0.0, p.far / length, 1.0 / length]
        }
        bevy::camera::Projection::Perspective(p) => [p.near, 0.0, 0.0],
        bevy::camera::Projection::Custom(_) => [0.1, 0.0, 0.0],
    }
}

/// `numbers` of [`ScreenMaterial`].
pub(super) fn numbers(divider: f32, projection: &bevy::camera::Projection) -> Vec4 {
    let [near, offset, slope] = depth_numbers(projection);
    Vec4::new(divider, near, offset, slope)
}
