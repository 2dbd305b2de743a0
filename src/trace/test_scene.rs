//! A scene for tests of stages over columns: whatever a hit may lie on, and rays that find it.

use super::stages::vertices::Vertices;
use super::{Cone, Lights, Material, Mesh, Object, World};
use crate::bvh::{Aggregate, BuildOptions, Hit, Instance, MeshTree, Ray, Triangles};
use crate::scene::{Alpha, RenderSettings};
use glam::{Affine3A, Mat3, Quat, Vec3};
use std::sync::Arc;

/// Numbers in [0, 1) that look random.
pub(super) struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f32 {
        self.0 = (self.0)
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    /// In the cube from -1 to 1.
    pub fn in_cube(&mut self) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| 2.0 * self.next() - 1.0))
    }
}

/// Triangles of all sizes, needles among them.
fn soup(numbers: &mut Numbers) -> Triangles {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for i in 0..300_u32 {
        let size = [1.0, 0.3, 1e-3, 1e-9][(i % 4) as usize];
        let corner = numbers.in_cube();
        let along = numbers.in_cube() * size;
        let across = if i % 5 == 0 {
            along * 0.7 + numbers.in_cube() * (size * 1e-7)
        } else {
            numbers.in_cube() * size
        };
        positions.extend([corner, corner + along, corner + across]);
        indices.push([0, 1, 2].map(|k| 3 * i + k));
    }
    Triangles::new(positions, indices).unwrap()
}

/// Soups as they are, turned, mirrored, sheared and moving; flat and smooth, of one colour and of many, opaque and cut out.
pub(super) fn world() -> World {
    let mut numbers = Numbers(7);
    let options = BuildOptions::default();
    let places = [
        Affine3A::IDENTITY,
        Affine3A::from_translation(Vec3::new(150.0, -3.0, 20.0)),
        Affine3A::from_scale_rotation_translation(
            Vec3::new(2.0, -0.5, 1.0),
            Quat::from_rotation_y(0.7),
            Vec3::new(1.0, 2.0, 3.0),
        ),
        Affine3A::from_mat3_translation(
            Mat3::from_cols(Vec3::X, Vec3::new(0.8, 1.0, 0.0), Vec3::Z),
            Vec3::new(-2.0, 0.0, 1.0),
        ),
    ];
    let (mut instances, mut objects) = (Vec::new(), Vec::new());
    for (i, place) in places.iter().cycle().take(12).enumerate() {
        let triangles = soup(&mut numbers);
        let corners = triangles.positions().len();
        let some = |wanted: bool| if wanted { corners } else { 0 };
        let mut vectors =
            |count: usize| -> Vec<Vec3> { (0..count).map(|_| numbers.in_cube()).collect() };
        let normals = vectors(some(i % 3 != 0));
        let colors = vectors(some(i % 5 == 4)).into_iter().map(Vec3::abs);
        let colors: Vec<_> = colors.collect();
        let tree = Arc::new(MeshTree::build(triangles, &options));
        let mut instance = Instance::new(tree.clone(), place).unwrap();
        if i % 4 == 3 {
            instance = instance.moving(Vec3::new(0.3, -0.2, 0.1)).unwrap();
        }
        instances.push(instance);
        objects.push(Object {
            id: i as u64 + 1,
            material: (i % 3) as u32,
            motion_samples: 0,
            mesh: Arc::new(Mesh {
                normals,
                alphas: vec![0.5; colors.len()],
                colors,
                ..Mesh::of(tree)
            }),
        });
    }
    let matt = Material {
        diffuse: Vec3::new(0.7, 0.5, 0.3),
        emission: Vec3::splat(0.1),
        ..Material::default()
    };
    let cut_out = Material {
        opacity: 0.5,
        alpha: Alpha::Mask { cutoff: 0.4 },
        ..matt.clone()
    };
    let shiny = Material {
        specular: Vec3::splat(0.3),
        shininess: 20.0,
        opacity: 0.7,
        ..matt.clone()
    };
    World {
        aggregate: Arc::new(Aggregate::build(instances, &options)),
        objects: Arc::new(objects),
        materials: Arc::new(vec![matt, cut_out, shiny]),
        lights: Arc::new(Lights::default()),
        ..World::default()
    }
    .with_needs()
}

/// Rays to places in the world's triangles and on their edges and corners, those that hit something, and what they hit.
pub(super) fn rays(world: &World) -> (Vec<Ray>, Vec<Hit>) {
    let mut numbers = Numbers(11);
    let instances = world.aggregate.instances();
    let (mut rays, mut hits) = (Vec::new(), Vec::new());
    for i in 0..20_000 {
        // Some in a row at the same object.
        let instance = &instances[i / 7 % instances.len()];
        let triangles = instance.mesh.triangles();
        let triangle = (numbers.next() * triangles.indices().len() as f32) as u32;
        let [a, b, c] = triangles.corners(triangle);
        let [mut u, mut v] = [numbers.next(), numbers.next()];
        if i % 11 == 0 {
            v = 0.0;
        }
        if u + v > 1.0 {
            [u, v] = [1.0 - u, 1.0 - v];
        }
        let time = numbers.next();
        let to =
            instance.to_world_point(a + u * (b - a) + v * (c - a)) + instance.velocity() * time;
        let origin = to + numbers.in_cube() * 2.0;
        let ray = Ray {
            time,
            ..Ray::new(origin, to - origin)
        };
        if let Some(hit) = world.aggregate.closest_hit(&ray) {
            rays.push(ray);
            hits.push(hit);
        }
    }
    assert!(hits.len() > 10_000, "only {} hits", hits.len());
    (rays, hits)
}

/// The vertices of hits of rays from the camera.
pub(super) fn vertices(
    world: &World,
    settings: &RenderSettings,
    (rays, hits): (&[Ray], &[Hit]),
    cone: Cone,
) -> Vertices {
    let mut vertices = Vertices::default();
    vertices.clear(cone);
    for (i, hit) in hits.iter().enumerate() {
        vertices.push_from_camera(i as u32, *hit);
    }
    vertices.look_up(world, settings, rays);
    vertices
}
