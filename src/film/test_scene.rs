//! A floor, two walls on it, a mirror and an area light: something noisy to render in tests.

use crate::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Triangles};
use crate::scene::RenderSettings;
use crate::trace::{
    Camera, DirectionalLight, Lights, Material, Mesh, Object, ParallelogramLight, PointLight,
    SegmentLight, World,
};
use glam::{Affine3A, UVec2, Vec3};
use std::sync::Arc;

fn quad(corner: Vec3, a: Vec3, b: Vec3) -> Vec<Vec3> {
    vec![
        corner,
        corner + a,
        corner + a + b,
        corner,
        corner + a + b,
        corner + b,
    ]
}

pub(super) fn world() -> World {
    let parts = [
        quad(Vec3::new(-3.0, 0.0, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0),
        quad(Vec3::new(-0.8, 0.0, 0.2), Vec3::X, Vec3::Y),
        quad(
            Vec3::new(0.6, 0.0, -0.5),
            Vec3::new(0.3, 0.0, 0.9),
            Vec3::Y * 0.8,
        ),
    ];
    let (mut instances, mut objects) = (Vec::new(), Vec::new());
    for (i, corners) in parts.into_iter().enumerate() {
        let triangles = Triangles::new(corners, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let tree = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
        instances.push(Instance::new(tree.clone(), &Affine3A::IDENTITY).unwrap());
        objects.push(Object {
            id: i as u64 + 1,
            material: i as u32,
            motion_samples: 0,
            mesh: Arc::new(Mesh::of(tree)),
        });
    }
    let paint = |r, g, b| Material {
        diffuse: Vec3::new(r, g, b),
        ..Material::default()
    };
    let mirror = Material {
        specular: Vec3::splat(0.7),
        mirror: Vec3::splat(0.7),
        ..paint(0.1, 0.1, 0.1)
    };
    World {
        aggregate: Arc::new(Aggregate::build(instances, &BuildOptions::default())),
        objects: Arc::new(objects),
        materials: Arc::new(vec![paint(0.7, 0.7, 0.6), paint(0.8, 0.3, 0.2), mirror]),
        lights: Arc::new(Lights {
            parallelograms: vec![ParallelogramLight {
                id: 9,
                corner: Vec3::new(-1.0, 2.0, 1.0),
                edges: [Vec3::X, Vec3::Z],
                colors: [Vec3::splat(6.0); 4],
                two_sided: false,
                visible: true,
                samples: 1,
            }],
            ..Lights::default()
        }),
        ..World::default()
    }
    .with_needs()
}

/// So many faint sheets, one behind the other across the z axis, which all rays of a camera go through, and a light.
pub(super) fn sheets(count: u32) -> (World, Camera) {
    let sheet = |i: u32| {
        let corner = Vec3::new(-9.0, -9.0, -0.01 * i as f32);
        quad(corner, Vec3::X * 18.0, Vec3::Y * 18.0)
    };
    let corners: Vec<Vec3> = (0..count).flat_map(sheet).collect();
    let indices = (0..2 * count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let triangles = Triangles::new(corners, indices.collect()).unwrap();
    let tree = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
    let instance = Instance::new(tree.clone(), &Affine3A::IDENTITY).unwrap();
    let object = Object {
        id: 1,
        material: 0,
        motion_samples: 0,
        mesh: Arc::new(Mesh::of(tree)),
    };
    let faint = Material {
        opacity: 1e-3,
        ..Material::default()
    };
    let world = World {
        aggregate: Arc::new(Aggregate::build(vec![instance], &BuildOptions::default())),
        objects: Arc::new(vec![object]),
        materials: Arc::new(vec![faint]),
        ..world()
    };
    let camera = Camera::looking_at(Vec3::Z * 2.0, Vec3::ZERO, Vec3::Y, 0.5);
    (world.with_needs(), camera)
}

pub(super) fn camera() -> Camera {
    Camera::looking_at(
        Vec3::new(0.4, 1.2, 3.0),
        Vec3::new(0.0, 0.3, 0.0),
        Vec3::Y,
        0.9,
    )
}

pub(super) fn settings(size: UVec2, spp: u32) -> RenderSettings {
    RenderSettings {
        size,
        spp,
        ..RenderSettings::default()
    }
}

/// The world with one light of each kind, and two of the last.
pub(super) fn lit() -> World {
    let panel = |id: u64, x: f32, colors| ParallelogramLight {
        id,
        corner: Vec3::new(x, 1.5, 0.2),
        edges: [Vec3::X * 0.4, Vec3::Z * 0.3],
        colors,
        two_sided: true,
        visible: false,
        samples: 2,
    };
    let lights = Lights {
        points: vec![PointLight {
            id: 100,
            position: Vec3::new(0.3, 1.2, 1.0),
            color: Vec3::new(2.0, 1.0, 0.5),
            cone: None,
        }],
        directionals: vec![DirectionalLight {
            id: 101,
            to_light: Vec3::new(0.3, 0.9, 0.2).normalize(),
            color: Vec3::splat(0.4),
            disc: None,
            samples: 1,
        }],
        segments: vec![SegmentLight {
            id: 102,
            ends: [Vec3::new(-0.5, 1.0, 0.6), Vec3::new(0.5, 1.3, 0.4)],
            colors: [Vec3::ONE, Vec3::Z],
            samples: 1,
        }],
        parallelograms: vec![
            panel(103, -0.6, [Vec3::ONE, Vec3::X, Vec3::splat(0.3), Vec3::Y]),
            panel(104, 0.4, [Vec3::ONE; 4]),
        ],
        moving: Vec::new(),
    };
    World {
        lights: Arc::new(lights),
        ..world()
    }
    .with_needs()
}

pub(super) fn edited(world: &World, edit: impl FnOnce(&mut Lights)) -> World {
    let mut lights = (*world.lights).clone();
    edit(&mut lights);
    World {
        lights: Arc::new(lights),
        ..world.clone()
    }
    .with_needs()
}

/// The world with another colour of one of its materials.
pub(super) fn repainted(world: &World, material: usize, diffuse: Vec3) -> World {
    let mut materials = (*world.materials).clone();
    materials[material].diffuse = diffuse;
    World {
        materials: Arc::new(materials),
        ..world.clone()
    }
    .with_needs()
}

/// Point lights in a row, with these numbers.
pub(super) fn many(ids: std::ops::Range<u64>) -> World {
    edited(&lit(), |lights| {
        lights.points = ids
            .map(|id| PointLight {
                id,
                position: Vec3::new(0.01 * id as f32 - 1.0, 1.2, 0.9),
                color: Vec3::new(0.4, 0.3, 0.2),
                cone: None,
            })
            .collect();
    })
}
