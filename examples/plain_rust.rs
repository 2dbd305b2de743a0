//! The tracer without Bevy's ECS: triangles in; a hit, a shadow and a picture out.
//!
//! `cargo run --release --example plain_rust` writes `plain.ppm`.

use glam::{Affine3A, UVec2, Vec3};
use glassbox::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Ray, Triangles};
use glassbox::film;
use glassbox::scene::RenderSettings;
use glassbox::trace::{Camera, Lights, Material, Mesh, Object, PointLight, World};
use std::error::Error;
use std::io::Write;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    // A square floor and a triangle that stands on it.
    let positions = vec![
        Vec3::new(-2.0, 0.0, -2.0),
        Vec3::new(-2.0, 0.0, 2.0),
        Vec3::new(2.0, 0.0, 2.0),
        Vec3::new(2.0, 0.0, -2.0),
        Vec3::new(-0.5, 0.0, 0.0),
        Vec3::new(0.5, 0.0, 0.0),
        Vec3::new(0.0, 1.0, 0.0),
    ];
    let indices = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6]];
    let options = BuildOptions::default();
    let triangles = Triangles::new(positions, indices)?;
    let tree = Arc::new(MeshTree::build(triangles, &options));
    let instance = Instance::new(tree.clone(), &Affine3A::IDENTITY)?;
    let aggregate = Aggregate::build(vec![instance], &options);

    let ray = Ray::new(Vec3::new(0.0, 0.5, 3.0), Vec3::NEG_Z);
    if let Some(hit) = aggregate.closest_hit(&ray) {
        println!("triangle {} at t = {}", hit.triangle, hit.t);
    }
    let light = Vec3::new(1.0, 3.0, 2.0);
    let floor = Vec3::new(-0.3, 0.001, -0.6);
    let shadow = Ray {
        t_max: 1.0,
        ..Ray::new(floor, light - floor)
    };
    let dark = aggregate.occluded(&shadow);
    println!("behind the triangle the light is hidden: {dark}");

    let world = World {
        aggregate: Arc::new(aggregate),
        objects: Arc::new(vec![Object {
            id: 1,
            material: 0,
            motion_samples: 0,
            mesh: Arc::new(Mesh::of(tree)),
        }]),
        materials: Arc::new(vec![Material::default()]),
        lights: Arc::new(Lights {
            points: vec![PointLight {
                id: 2,
                position: light,
                color: Vec3::splat(30.0),
                cone: None,
            }],
            ..Lights::default()
        }),
        ..World::default()
    }
    .with_needs();
    let camera = Camera::looking_at(Vec3::new(1.5, 2.0, 4.0), Vec3::Y * 0.3, Vec3::Y, 0.7);
    let settings = RenderSettings {
        size: UVec2::new(320, 240),
        ..RenderSettings::default()
    };
    let rendered = film::render(&world, &camera, &settings, &|_, _| {});
    let screen = film::view_transform(&rendered.picture, &settings.output);
    let mut ppm = std::io::BufWriter::new(std::fs::File::create("plain.ppm")?);
    writeln!(ppm, "P6 320 240 255")?;
    for pixel in screen {
        ppm.write_all(&pixel.map(|c| (c * 255.0).round() as u8))?;
    }
    ppm.flush()?;
    let (rays, seconds) = (rendered.status.rays.total(), rendered.status.seconds);
    println!("plain.ppm: {rays} rays in {seconds:.2} s");
    Ok(())
}
