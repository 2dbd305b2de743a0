//! What is around a scene: skyboxes, and environment maps that light it.

use super::rows::matte;
use super::{LEFT, RIGHT, Row, SAME, Stage, compare};
use bevy::asset::RenderAssetUsages;
use bevy::light::Skybox;
use bevy::prelude::*;
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use std::f32::consts::FRAC_PI_4;

/// A cube of a colour a side, in Bevy's order.
fn cube(stage: &mut Stage, sides: [[u8; 3]; 6]) -> Handle<Image> {
    let size = Extent3d {
        width: 4,
        height: 4,
        depth_or_array_layers: 6,
    };
    let pixels = sides.map(|[r, g, b]| [r, g, b, 255].repeat(16));
    let usage = RenderAssetUsages::default();
    let format = TextureFormat::Rgba8UnormSrgb;
    let mut image = Image::new(size, TextureDimension::D2, pixels.concat(), format, usage);
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::Cube),
        ..default()
    });
    stage.add::<Image>(image)
}

const SIDES: [[u8; 3]; 6] = [
    [250, 60, 60],
    [60, 250, 60],
    [60, 60, 250],
    [250, 250, 60],
    [60, 250, 250],
    [250, 60, 250],
];
/// What makes white about white.
const BRIGHTNESS: f32 = 900.0;

fn look_at_sky(stage: &mut Stage, rotation: f32) -> Handle<Image> {
    let image = cube(stage, SIDES);
    let sky = Skybox {
        image: Some(image.clone()),
        brightness: BRIGHTNESS,
        rotation: Quat::from_rotation_y(rotation),
    };
    let camera = stage.camera;
    stage.world().entity_mut(camera).insert(sky);
    image
}

fn light_by(stage: &mut Stage, image: Handle<Image>) {
    let light = EnvironmentMapLight {
        diffuse_map: image.clone(),
        specular_map: image,
        intensity: BRIGHTNESS,
        ..default()
    };
    let camera = stage.camera;
    stage.world().entity_mut(camera).insert(light);
}

const ROWS: &[Row] = &[
    Row {
        name: "a skybox, of which two sides are seen",
        build: |stage| {
            look_at_sky(stage, FRAC_PI_4);
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "a skybox that is turned the other way, behind something",
        build: |stage| {
            look_at_sky(stage, -FRAC_PI_4);
            stage.sun(Vec3::NEG_Z);
            stage.flat(Vec2::new(1.0, 1.0), -1.0, matte(0.8, 0.4, 0.2));
        },
        alike: &[([0.25, 0.45, 0.35, 0.55], SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "an environment map that lights, and is seen where the sky is that it is of",
        build: |stage| {
            let image = cube(stage, [[200, 150, 100]; 6]);
            light_by(stage, image.clone());
            let sky = Skybox {
                image: Some(image),
                brightness: BRIGHTNESS,
                ..default()
            };
            let camera = stage.camera;
            stage.world().entity_mut(camera).insert(sky);
            stage.flat(Vec2::new(2.2, 3.0), -1.2, matte(0.8, 0.4, 0.2));
        },
        alike: &[(LEFT, 1.1), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "an environment map that lights alone, before the clear colour",
        build: |stage| {
            let image = cube(stage, [[200, 150, 100]; 6]);
            light_by(stage, image);
            stage.flat(Vec2::new(2.2, 3.0), -1.2, matte(0.8, 0.4, 0.2));
        },
        alike: &[(LEFT, 1.1), (RIGHT, SAME)],
        named: &[],
    },
];

#[test]
fn skies_look_as_bevy_draws_them_and_light_as_much() {
    compare(ROWS);
}
