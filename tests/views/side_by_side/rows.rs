//! A scene for each kind of component of Bevy's that is traced.

use super::{ALL, LEFT, RIGHT, Row, SAME, Stage, compare};
use bevy::asset::RenderAssetUsages;
use bevy::camera::Exposure;
use bevy::image::ImageSampler;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

/// Metres from the camera to what is put up.
pub(super) const FAR: f32 = 4.0;

const SRGB: TextureFormat = TextureFormat::Rgba8UnormSrgb;
const LINEAR: TextureFormat = TextureFormat::Rgba8Unorm;

pub(super) fn matte(red: f32, green: f32, blue: f32) -> StandardMaterial {
    StandardMaterial {
        base_color: Color::linear_rgb(red, green, blue),
        perceptual_roughness: 1.0,
        reflectance: 0.0,
        ..default()
    }
}

impl Stage {
    /// Its pixels from left to right.
    pub(super) fn picture(&mut self, pixels: &[[u8; 4]], format: TextureFormat) -> Handle<Image> {
        let size = Extent3d {
            width: pixels.len() as u32,
            ..default()
        };
        let usage = RenderAssetUsages::default();
        let bytes = pixels.concat();
        let mut image = Image::new(size, TextureDimension::D2, bytes, format, usage);
        image.sampler = ImageSampler::nearest();
        self.add::<Image>(image)
    }

    pub(super) fn shape(
        &mut self,
        mesh: Mesh,
        place: Transform,
        material: StandardMaterial,
    ) -> Entity {
        let mesh = self.add::<Mesh>(mesh);
        let material = self.add::<StandardMaterial>(material);
        self.put((Mesh3d(mesh), MeshMaterial3d(material), place))
    }

    /// Something flat of these metres, upright and facing the camera, so far to the right.
    pub(super) fn flat(&mut self, size: Vec2, x: f32, material: StandardMaterial) -> Entity {
        let mesh = Mesh::from(Rectangle::from_size(size));
        let mesh = mesh.with_generated_tangents().expect("it has all for them");
        self.shape(mesh, Transform::from_xyz(x, 0.0, -FAR), material)
    }

    pub(super) fn pair(&mut self, left: StandardMaterial, right: StandardMaterial) {
        self.flat(Vec2::new(2.2, 3.0), -1.2, left);
        self.flat(Vec2::new(2.2, 3.0), 1.2, right);
    }

    pub(super) fn wall(&mut self, material: StandardMaterial) -> Entity {
        self.flat(Vec2::new(5.0, 3.4), 0.0, material)
    }

    /// What stands behind all else, and shines by itself.
    pub(super) fn behind(&mut self, red: f32, green: f32, blue: f32) {
        let mesh = Rectangle::from_size(Vec2::splat(20.0));
        let material = StandardMaterial {
            unlit: true,
            ..matte(red, green, blue)
        };
        self.shape(mesh.into(), Transform::from_xyz(0.0, 0.0, -8.0), material);
    }

    /// Light that goes in this direction; head on it makes white matte things about white.
    pub(super) fn sun(&mut self, direction: Vec3) {
        let light = DirectionalLight {
            illuminance: 3000.0,
            shadow_maps_enabled: true,
            ..default()
        };
        let place = Transform::IDENTITY.looking_to(direction, Vec3::Y);
        self.put((light, place));
    }
}

const ROWS: &[Row] = &[
    Row {
        name: "base colours under a sun",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            stage.pair(matte(0.8, 0.1, 0.1), matte(0.2, 0.5, 0.6));
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "a point light and a spot",
        build: |stage| {
            let point = PointLight {
                intensity: 60_000.0,
                color: Color::linear_rgb(1.0, 0.6, 0.4),
                range: 100.0,
                shadow_maps_enabled: true,
                ..default()
            };
            stage.put((point, Transform::from_xyz(-1.2, 0.0, -FAR + 2.0)));
            let spot = SpotLight {
                intensity: 200_000.0,
                range: 100.0,
                inner_angle: 0.2,
                outer_angle: 0.4,
                shadow_maps_enabled: true,
                ..default()
            };
            stage.put((spot, Transform::from_xyz(1.2, 0.0, 0.0)));
            stage.wall(matte(0.8, 0.8, 0.8));
        },
        // Within the cone, and at its rim, where Bevy's fades as a square and ours smoothly at both ends.
        alike: &[
            (LEFT, 1.1),
            ([0.68, 0.4, 0.8, 0.6], 1.1),
            ([0.9, 0.1, 0.98, 0.3], 1.6),
        ],
        named: &[],
    },
    Row {
        name: "emission, of a factor and of a map",
        build: |stage| {
            let glow = |red, green, blue| StandardMaterial {
                emissive: LinearRgba::rgb(red, green, blue),
                ..matte(0.0, 0.0, 0.0)
            };
            let map = stage.picture(&[[0, 188, 0, 255], [188, 0, 0, 255]], SRGB);
            stage.pair(
                glow(0.1, 0.4, 0.6),
                StandardMaterial {
                    emissive_texture: Some(map),
                    ..glow(1.0, 1.0, 1.0)
                },
            );
        },
        alike: &[
            (LEFT, SAME),
            ([0.6, 0.2, 0.7, 0.8], SAME),
            ([0.8, 0.2, 0.9, 0.8], SAME),
        ],
        named: &[],
    },
    Row {
        name: "a normal map",
        build: |stage| {
            stage.sun(Vec3::new(-1.0, 0.0, -1.0));
            // The left half is turned to the left, the right one to the right.
            let map = stage.picture(&[[64, 128, 238, 255], [191, 128, 238, 255]], LINEAR);
            stage.wall(StandardMaterial {
                normal_map_texture: Some(map),
                ..matte(0.8, 0.8, 0.8)
            });
        },
        // Bevy's rough surfaces (Burley's) are brighter than Lambert's where light grazes them.
        alike: &[(LEFT, 1.4), (RIGHT, 1.1)],
        named: &[],
    },
    Row {
        name: "a tint times a texture",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            let map = stage.picture(&[[255, 255, 255, 255], [188, 188, 0, 255]], SRGB);
            stage.wall(StandardMaterial {
                base_color_texture: Some(map),
                ..matte(0.4, 0.8, 0.2)
            });
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "a mask cuts out, and what is behind is seen",
        build: |stage| {
            stage.behind(0.0, 0.1, 0.6);
            stage.sun(Vec3::NEG_Z);
            let map = stage.picture(&[[255, 255, 255, 255], [255, 255, 255, 60]], SRGB);
            stage.wall(StandardMaterial {
                base_color_texture: Some(map),
                alpha_mode: AlphaMode::Mask(0.5),
                ..matte(0.7, 0.2, 0.1)
            });
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "what is half there lets half through",
        build: |stage| {
            stage.behind(0.0, 0.1, 0.8);
            stage.sun(Vec3::NEG_Z);
            let half = StandardMaterial {
                base_color: Color::linear_rgba(0.8, 0.2, 0.1, 0.5),
                alpha_mode: AlphaMode::Blend,
                ..matte(0.0, 0.0, 0.0)
            };
            stage.flat(Vec2::new(2.2, 3.0), -1.2, half);
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "vertex colours",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            let mesh = Mesh::from(Rectangle::new(5.0, 3.4));
            // A rectangle's corners begin at the top right and go round to the left.
            let sides = [0.1, 0.9, 0.9, 0.1];
            let colors = sides.map(|red| [red, 1.0 - red, 0.1, 1.0]).to_vec();
            let mesh = mesh.with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors);
            let place = Transform::from_xyz(0.0, 0.0, -FAR);
            stage.shape(mesh, place, matte(0.9, 0.9, 0.9));
        },
        alike: &[(LEFT, SAME), ([0.45, 0.2, 0.55, 0.8], SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "what is unlit shows its colour whatever light there is",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            let map = stage.picture(&[[188, 0, 188, 255]], SRGB);
            let unlit = |red, green, blue| StandardMaterial {
                unlit: true,
                ..matte(red, green, blue)
            };
            stage.pair(
                unlit(0.2, 0.5, 0.1),
                StandardMaterial {
                    base_color_texture: Some(map),
                    ..unlit(0.5, 1.0, 1.0)
                },
            );
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "a rough metal by its map, and a rough plastic",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            let map = stage.picture(&[[0, 255, 255, 255]], LINEAR);
            stage.pair(
                StandardMaterial {
                    metallic: 1.0,
                    metallic_roughness_texture: Some(map),
                    ..matte(0.8, 0.4, 0.1)
                },
                StandardMaterial {
                    reflectance: 0.5,
                    perceptual_roughness: 0.8,
                    ..matte(0.1, 0.4, 0.1)
                },
            );
        },
        // Bevy's rough metal loses most of a single light's, and takes its colour twice.
        alike: &[(LEFT, 2.5), (RIGHT, 1.25)],
        named: &["its map of metalness and roughness counts with its mean"],
    },
    Row {
        name: "an occlusion map, where no light comes from all around",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            let map = stage.picture(&[[0, 0, 0, 255]], LINEAR);
            stage.wall(StandardMaterial {
                occlusion_texture: Some(map),
                ..matte(0.5, 0.5, 0.5)
            });
        },
        alike: &[(ALL, SAME)],
        named: &["its occlusion map is left out"],
    },
    Row {
        name: "a shadow falls where Bevy's does",
        build: |stage| {
            stage.sun(Vec3::new(1.0, 0.0, -1.0));
            stage.wall(matte(0.6, 0.6, 0.6));
            // Out of sight, to the left of the camera.
            let turned = Quat::from_rotation_y(0.8);
            let place = Transform::from_xyz(-2.6, 0.0, -FAR + 2.4).with_rotation(turned);
            let both_sides = StandardMaterial {
                double_sided: true,
                cull_mode: None,
                ..matte(1.0, 1.0, 1.0)
            };
            stage.shape(Mesh::from(Rectangle::new(1.2, 8.0)), place, both_sides);
        },
        alike: &[([0.42, 0.2, 0.5, 0.8], 1.1), ([0.8, 0.2, 0.95, 0.8], 1.1)],
        named: &[],
    },
    Row {
        name: "a skinned mesh stands where its joint is",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            let mesh = Mesh::from(Rectangle::new(2.2, 3.0));
            let count = mesh.count_vertices();
            let joints = VertexAttributeValues::Uint16x4(vec![[0; 4]; count]);
            let weights = vec![[1.0, 0.0, 0.0, 0.0]; count];
            let mesh = mesh
                .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints)
                .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
            let place = Transform::from_xyz(1.2, 0.0, -FAR);
            let object = stage.shape(mesh, place, matte(0.7, 0.5, 0.1));
            let joint = stage.put(Transform::from_xyz(-1.2, 0.0, -FAR));
            let inverse_bindposes = stage.add::<SkinnedMeshInverseBindposes>(vec![Mat4::IDENTITY]);
            stage.world().entity_mut(object).insert(SkinnedMesh {
                inverse_bindposes,
                joints: vec![joint],
            });
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "a morphed mesh has the weights of now",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            let mut mesh = Mesh::from(Rectangle::new(2.2, 3.0));
            let aside = MorphAttributes::new(Vec3::X * 4.8, Vec3::ZERO, Vec3::ZERO);
            mesh.set_morph_targets(vec![aside; mesh.count_vertices()]);
            let place = Transform::from_xyz(-1.2, 0.0, -FAR);
            let object = stage.shape(mesh, place, matte(0.1, 0.5, 0.7));
            let weights = vec![0.5];
            let weights = MeshMorphWeights::Value { weights };
            stage.world().entity_mut(object).insert(weights);
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &[],
    },
    Row {
        name: "another exposure",
        build: |stage| {
            stage.sun(Vec3::NEG_Z);
            stage.wall(matte(0.8, 0.4, 0.2));
            let darker = Exposure {
                ev100: Exposure::default().ev100 + 1.0,
            };
            let camera = stage.camera;
            stage.world().entity_mut(camera).insert(darker);
        },
        alike: &[(ALL, SAME)],
        named: &[],
    },
    Row {
        name: "the colour that the view is cleared with",
        build: |stage| {
            let world = stage.world();
            world.insert_resource(ClearColor(Color::linear_rgb(0.1, 0.3, 0.5)));
            stage.sun(Vec3::NEG_Z);
            stage.flat(Vec2::new(2.2, 3.0), -1.2, matte(0.8, 0.4, 0.2));
        },
        alike: &[(LEFT, SAME), (RIGHT, SAME)],
        named: &[],
    },
];

#[test]
fn each_kind_of_component_looks_as_bevy_draws_it() {
    compare(ROWS);
}
