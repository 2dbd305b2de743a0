//! The picture against closed forms: what the tracer computes is compared with what it should be.

mod dome;
mod dome_directions;
mod irradiance;
mod light_points;
mod materials;
mod mirrors;
mod normal_maps;
mod views;

use glam::{UVec2, Vec3};
use glassbox::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Triangles};
use glassbox::scene::{PixelSampling, RenderSettings};
use glassbox::trace::{
    Camera, Environment, Lights, Material, Mesh, Object, ParallelogramLight, RayCounts, SampleId,
    Workspace, World, radiance,
};
use std::sync::Arc;

/// Deterministic numbers for set-ups: a splitmix64 generator.
pub struct Numbers(pub u64);

impl Numbers {
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub fn point(&mut self, low: f32, high: f32) -> Vec3 {
        Vec3::new(
            self.between(low, high),
            self.between(low, high),
            self.between(low, high),
        )
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point(-1.0, 1.0);
            let length = p.length();
            if length > 0.1 && length < 1.0 {
                return p / length;
            }
        }
    }
}

/// Two numbers of a sequence that fills the square evenly: Roberts' R2.
fn even_pair(i: u32) -> [f32; 2] {
    [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| {
        let number = (0.5 + step * f64::from(i)).fract() as f32;
        number.min(1.0_f32.next_down())
    })
}

/// An object: corner positions in threes, and a material.
pub fn object(id: u64, corners: &[Vec3], material: u32) -> (Instance, Object) {
    let indices = (0..corners.len() as u32 / 3)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    let triangles = Triangles::new(corners.to_vec(), indices).unwrap();
    let tree = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
    let mesh = Mesh::of(tree.clone());
    let instance = Instance::new(tree, &glam::Affine3A::IDENTITY).unwrap();
    (
        instance,
        Object {
            id,
            material,
            motion_samples: 0,
            mesh: Arc::new(mesh),
        },
    )
}

/// Two triangles of the quad `corner + u·a + v·b`, facing along `a × b`.
pub fn quad(corner: Vec3, a: Vec3, b: Vec3) -> [Vec3; 6] {
    [
        corner,
        corner + a,
        corner + a + b,
        corner,
        corner + a + b,
        corner + b,
    ]
}

pub fn world(objects: Vec<(Instance, Object)>, materials: Vec<Material>) -> World {
    let (instances, objects): (Vec<_>, Vec<_>) = objects.into_iter().unzip();
    World {
        aggregate: Arc::new(Aggregate::build(instances, &BuildOptions::default())),
        objects: Arc::new(objects),
        materials: Arc::new(materials),
        ..World::default()
    }
    .with_needs()
}

/// An object that reflects nothing, before a background of one.
pub fn dark_before_light(object: (Instance, Object)) -> World {
    let dark = Material {
        diffuse: Vec3::ZERO,
        ..Material::default()
    };
    let mut world = world(vec![object], vec![dark]);
    world.environment = Environment {
        background: Vec3::ONE,
        ..Environment::default()
    };
    world
}

/// A light of 1 m², facing down from `height` above the origin, that cameras do not see.
pub fn square_light(height: f32, samples: u32) -> Arc<Lights> {
    Arc::new(Lights {
        parallelograms: vec![ParallelogramLight {
            id: 3,
            corner: Vec3::new(-0.5, height, -0.5),
            edges: [Vec3::X, Vec3::Z],
            colors: [Vec3::ONE; 4],
            two_sided: false,
            visible: false,
            samples,
        }],
        ..Lights::default()
    })
}

/// The mean radiance of `spp` samples along the camera's central ray.
pub fn central_radiance(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
) -> (Vec3, RayCounts) {
    let settings = RenderSettings {
        size: UVec2::ONE,
        pixel: PixelSampling::Center,
        ..settings.clone()
    };
    let samples: Vec<_> = (0..u64::from(settings.spp))
        .map(|index| SampleId {
            pixel: UVec2::ZERO,
            index,
        })
        .collect();
    let mut values = vec![Vec3::ZERO; samples.len()];
    let counts = radiance(
        world,
        camera,
        &settings,
        &samples,
        &mut values,
        &mut Workspace::default(),
    );
    let sum = values
        .iter()
        .fold(glam::DVec3::ZERO, |sum, v| sum + v.as_dvec3());
    ((sum / values.len() as f64).as_vec3(), counts)
}
