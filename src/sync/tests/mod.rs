//! Tests of the room as a whole: an app with nothing but what `SyncPlugin` needs.

mod background;
mod conversions;
mod cut_outs;
mod dice;
mod domes;
mod edited;
mod edits;
mod kept;
mod lights;
mod motions;
mod problems;
mod rest;
mod sharing;
mod shown;

use super::{Changes, SyncPlugin, Traced, TreeBuilding};
use crate::scene::{Phong, PointLamp, SceneCamera, ScenePlugin};
use crate::trace;
use bevy::app::{App, TaskPoolPlugin};
use bevy::asset::{AssetApp, AssetPlugin, Assets, Handle, RenderAssetUsages};
use bevy::camera::visibility::VisibilityPlugin;
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::image::Image;
use bevy::mesh::{Indices, Mesh, Mesh3d, MeshPlugin, PrimitiveTopology};
use bevy::transform::TransformPlugin;
use bevy::transform::components::Transform;
use std::sync::Arc;
use wgpu_types::{Extent3d, TextureDimension, TextureFormat};

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        AssetPlugin::default(),
        TransformPlugin,
        MeshPlugin,
        VisibilityPlugin,
        ScenePlugin,
    ))
    .init_asset::<Image>()
    .add_plugins(SyncPlugin)
    .insert_resource(TreeBuilding::AtOnce);
    app.finish();
    app
}

/// One frame; what it redid.
fn frame(app: &mut App) -> Changes {
    app.update();
    app.world().resource::<Traced>().changes
}

fn world(app: &App) -> Arc<trace::World> {
    app.world().resource::<Traced>().world.clone()
}

fn problems(app: &App) -> Vec<String> {
    let traced = app.world().resource::<Traced>();
    traced.problems.iter().map(ToString::to_string).collect()
}

/// A closed fan of `sides` triangles around the z axis, different for every number.
fn fan(sides: u32) -> Mesh {
    let rim = (0..sides).map(|i| {
        let angle = i as f32 / sides as f32 * std::f32::consts::TAU;
        [angle.cos(), angle.sin(), 0.1 * i as f32]
    });
    let positions: Vec<[f32; 3]> = rim.chain([[0.0, 0.0, 0.5]]).collect();
    let uvs: Vec<[f32; 2]> = positions.iter().map(|p| [p[0], p[1]]).collect();
    let indices = (0..sides).flat_map(|i| [i, (i + 1) % sides, sides]);
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::MAIN_WORLD,
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_indices(Indices::U32(indices.collect()))
    .with_computed_smooth_normals()
}

fn add_mesh(app: &mut App, sides: u32) -> Handle<Mesh> {
    app.world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(fan(sides))
}

fn image(value: u8) -> Image {
    Image::new_fill(
        Extent3d {
            width: 2,
            height: 2,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        &[value, 0, 255, 255],
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::MAIN_WORLD,
    )
}

fn add_image(app: &mut App, value: u8) -> Handle<Image> {
    app.world_mut()
        .resource_mut::<Assets<Image>>()
        .add(image(value))
}

fn grey(value: f32) -> Phong {
    Phong {
        diffuse: LinearRgba::rgb(value, value, value),
        ..Phong::default()
    }
}

/// Two objects of one mesh, a third of another, a light and a camera.
struct Small {
    app: App,
    meshes: [Handle<Mesh>; 2],
    objects: [Entity; 3],
    light: Entity,
    camera: Entity,
}

impl Small {
    fn new() -> Self {
        let mut app = app();
        let meshes = [add_mesh(&mut app, 3), add_mesh(&mut app, 5)];
        let [a, b] = meshes.clone();
        let mut spawn = |mesh: &Handle<Mesh>, x: f32, value: f32| {
            let object = (
                Mesh3d(mesh.clone()),
                Transform::from_xyz(x, 0.0, 0.0),
                grey(value),
            );
            app.world_mut().spawn(object).id()
        };
        let objects = [
            spawn(&a, 0.0, 0.1),
            spawn(&a, 3.0, 0.2),
            spawn(&b, 6.0, 0.3),
        ];
        let light = app.world_mut().spawn(PointLamp::default()).id();
        let camera = app.world_mut().spawn(SceneCamera::default()).id();
        app.update();
        Self {
            app,
            meshes,
            objects,
            light,
            camera,
        }
    }

    fn edit<C: bevy::ecs::component::Component<Mutability = bevy::ecs::component::Mutable>>(
        &mut self,
        entity: Entity,
        edit: impl FnOnce(&mut C),
    ) {
        let mut component = self.app.world_mut().get_mut::<C>(entity).unwrap();
        edit(&mut component);
    }
}
