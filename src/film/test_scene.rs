//! A floor, two walls on it, a mirror and an area light: something noisy to render in tests.

use crate::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Triangles};
use crate::scene::RenderSettings;
use crate::trace::{Camera, Lights, Material, Mesh, Object, ParallelogramLight, World};
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
