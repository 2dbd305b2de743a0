//! A scene for each kind of component of Bevy's that is named because it is not followed: what does not
//! depend on it is alike.

use super::rows::{FAR, matte};
use super::{ALL, LEFT, RIGHT, Row, SAME, compare};
use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::RenderLayers;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::math::Affine2;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;

const ROWS: &[Row] = &[
    Row {
        name: "maps that are moved over a surface, where they are the same everywhere",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            let format = TextureFormat::Rgba8UnormSrgb;
            let map = stage.picture(&[[255, 188, 90, 255]; 2], format);
            stage.wall(StandardMaterial {
                base_color_texture: Some(map),
                uv_transform: Affine2::from_translation(Vec2::new(0.5, 0.0)),
                ..matte(0.8, 0.8, 0.8)
            });
        },
        alike: &[(ALL, SAME)],
        named: &["its uv_transform is left out"],
    },
    Row {
        name: "what light is transmitted by",
        build: |stage| {
            stage.behind(0.1, 0.3, 0.8);
            stage.wall(StandardMaterial {
                specular_transmission: 1.0,
                ior: 1.0,
                perceptual_roughness: 0.0,
                ..matte(1.0, 1.0, 1.0)
            });
        },
        alike: &[(LEFT, 1.1), (RIGHT, 1.1)],
        named: &["its transmission is opacity"],
    },
    Row {
        name: "two backs, one of which Bevy culls",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            let turned = |x: f32| {
                let place = Transform::from_xyz(x, 0.0, -FAR);
                place.with_rotation(Quat::from_rotation_y(std::f32::consts::PI))
            };
            let mesh = || Mesh::from(Rectangle::new(2.2, 3.0));
            let single = stage.shape(mesh(), turned(-1.2), matte(0.8, 0.1, 0.1));
            stage.world().entity_mut(single).insert(Name::new("Sail"));
            let both_sides = StandardMaterial {
                double_sided: true,
                cull_mode: None,
                ..matte(0.2, 0.5, 0.6)
            };
            stage.shape(mesh(), turned(1.2), both_sides);
        },
        alike: &[(RIGHT, SAME)],
        named: &["it shows the back of \"Sail\", which Bevy culls"],
    },
    Row {
        name: "an object in another layer than the camera's",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            stage.pair(matte(0.8, 0.1, 0.1), matte(0.2, 0.5, 0.6));
            let size = Vec2::new(0.4, 3.0);
            let hidden = stage.flat(size, 0.0, matte(0.5, 0.5, 0.5));
            let layer = RenderLayers::layer(5);
            stage.world().entity_mut(hidden).insert(layer);
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &["its RenderLayers are left out"],
    },
    Row {
        name: "light from everywhere, which is a tenth of what there is",
        build: |stage| {
            stage.world().insert_resource(GlobalAmbientLight {
                brightness: 100.0,
                ..default()
            });
            stage.sun(Vec3::NEG_Z);
            stage.wall(matte(0.6, 0.4, 0.2));
        },
        alike: &[(ALL, 1.2)],
        named: &["the GlobalAmbientLight of 100 cd/m²"],
    },
    Row {
        name: "what casts no shadow and what gets none, beside their shadows",
        build: |stage| {
            stage.sun(Vec3::new(1.0, 0.0, -1.0));
            let wall = stage.wall(matte(0.6, 0.6, 0.6));
            stage.world().entity_mut(wall).insert(NotShadowReceiver);
            // Out of sight, to the left of the camera.
            let place = Transform::from_xyz(-2.6, 0.0, -FAR + 2.4);
            let place = place.with_rotation(Quat::from_rotation_y(0.8));
            let mesh = Mesh::from(Rectangle::new(1.2, 8.0));
            let caster = stage.shape(mesh, place, matte(1.0, 1.0, 1.0));
            stage.world().entity_mut(caster).insert(NotShadowCaster);
        },
        alike: &[([0.8, 0.2, 0.95, 0.8], 1.1)],
        named: &["its NotShadowCaster is", "its NotShadowReceiver is"],
    },
    Row {
        name: "a sun without shadows, and a lamp that ends where it would be seen",
        build: |stage| {
            let sun = DirectionalLight {
                illuminance: 2000.0,
                shadow_maps_enabled: false,
                ..default()
            };
            stage.put((sun, Transform::IDENTITY.looking_to(Vec3::NEG_Z, Vec3::Y)));
            let lamp = PointLight {
                intensity: 60_000.0,
                range: 10.0,
                shadow_maps_enabled: true,
                ..default()
            };
            stage.put((lamp, Transform::from_xyz(0.0, 0.0, -FAR + 2.0)));
            stage.wall(matte(0.6, 0.6, 0.6));
        },
        alike: &[([0.4, 0.3, 0.6, 0.7], 1.1)],
        named: &["its shadow_maps_enabled is", "its range of 10 m"],
    },
    Row {
        name: "a mesh that the card alone has",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            stage.flat(Vec2::new(2.2, 3.0), -1.2, matte(0.8, 0.1, 0.1));
            let mut mesh = Mesh::from(Rectangle::new(2.2, 3.0));
            mesh.asset_usage = RenderAssetUsages::RENDER_WORLD;
            let place = Transform::from_xyz(1.2, 0.0, -FAR);
            stage.shape(mesh, place, matte(0.2, 0.5, 0.6));
        },
        alike: &[(LEFT, SAME)],
        named: &["RenderAssetUsages::MAIN_WORLD"],
    },
];

#[test]
fn what_is_not_followed_is_named_and_the_rest_looks_as_bevy_draws_it() {
    compare(ROWS);
}
