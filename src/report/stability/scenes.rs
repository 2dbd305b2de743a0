//! Small worlds, put together by hand.

use crate::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Triangles};
use crate::scene::{PixelSampling, RenderSettings};
use crate::trace::{
    Camera, Lights, Material, Mesh, Object, PointLight, RayCounts, SampleId, Workspace, World,
    radiance,
};
use glam::{Affine3A, DVec3, UVec2, Vec3};
use std::sync::Arc;

/// Corner positions in threes, and normals (none: flat), with a material.
pub(super) fn object(
    id: u64,
    corners: &[Vec3],
    normals: Vec<Vec3>,
    material: u32,
) -> (Instance, Object) {
    let indices = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let triangles = Triangles::new(corners.to_vec(), indices.collect());
    let triangles = triangles.expect("every index has its position");
    placed(id, triangles, normals, &Affine3A::IDENTITY, material)
}

/// A mesh placed by a transform that has an inverse.
pub(super) fn placed(
    id: u64,
    triangles: Triangles,
    normals: Vec<Vec3>,
    transform: &Affine3A,
    material: u32,
) -> (Instance, Object) {
    let tree = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
    let instance = Instance::new(tree.clone(), transform);
    let mesh = Arc::new(Mesh {
        normals,
        ..Mesh::of(tree)
    });
    let object = Object {
        id,
        material,
        motion_samples: 0,
        mesh,
    };
    (instance.expect("the transform has an inverse"), object)
}

/// A flat one.
pub(super) fn flat(id: u64, corners: &[Vec3], material: u32) -> (Instance, Object) {
    object(id, corners, Vec::new(), material)
}

/// Two triangles of the quad `corner + u·a + v·b`, facing along `a × b`.
pub(super) fn quad(corner: Vec3, a: Vec3, b: Vec3) -> [Vec3; 6] {
    let across = corner + a + b;
    [corner, corner + a, across, corner, across, corner + b]
}

pub(super) fn world(objects: Vec<(Instance, Object)>, materials: Vec<Material>) -> World {
    let (instances, objects): (Vec<_>, Vec<_>) = objects.into_iter().unzip();
    World {
        aggregate: Arc::new(Aggregate::build(instances, &BuildOptions::default())),
        objects: Arc::new(objects),
        materials: Arc::new(materials),
        ..World::default()
    }
    .with_needs()
}

/// One lamp of 1 W/sr.
pub(super) fn point_light(position: Vec3) -> Arc<Lights> {
    let light = PointLight {
        id: 99,
        position,
        color: Vec3::ONE,
        cone: None,
    };
    Arc::new(Lights {
        points: vec![light],
        ..Lights::default()
    })
}

/// The mean radiance of `spp` samples along the camera's central ray.
pub(super) fn central_radiance(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
) -> (Vec3, RayCounts) {
    let settings = RenderSettings {
        size: UVec2::ONE,
        pixel: PixelSampling::Center,
        ..settings.clone()
    };
    let sample = |index| SampleId {
        pixel: UVec2::ZERO,
        index,
    };
    let samples: Vec<_> = (0..u64::from(settings.spp)).map(sample).collect();
    let mut values = vec![Vec3::ZERO; samples.len()];
    let mut workspace = Workspace::default();
    let counts = radiance(
        world,
        camera,
        &settings,
        &samples,
        &mut values,
        &mut workspace,
    );
    let sum: DVec3 = values.iter().map(|value| value.as_dvec3()).sum();
    ((sum / values.len() as f64).as_vec3(), counts)
}

/// One sample.
pub(super) fn once() -> RenderSettings {
    RenderSettings {
        spp: 1,
        ..RenderSettings::default()
    }
}
