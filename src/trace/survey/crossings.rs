//! Whether rays go through so many surfaces that a picture takes long: asked of a few rays before it is rendered.

use super::first_hit::central_ray;
use crate::bvh::{Hit, Ray};
use crate::scene::{RenderSettings, SceneId};
use crate::trace::stages::scatter::FAINT;
use crate::trace::stages::shadow_rays::shadow_ray;
use crate::trace::surfaces::transmittance::crossings;
use crate::trace::world::lights::LightPoint;
use crate::trace::{Camera, Lamp, Surface, World};
use glam::UVec2;

/// From so many surfaces a ray on it is worth a word: going through one takes about as long as a ray does elsewhere.
const MANY: f64 = 100.0;
/// Rays from the camera that are asked, along each side of the picture.
const SIDE: u32 = 8;
/// Lights that each of them is asked about.
const LAMPS: usize = 8;
/// When so many surfaces were met, the rays that were asked are enough.
const ENOUGH: u64 = 200_000;

/// How many surfaces rays go through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossings {
    /// Of a ray, on average.
    pub a_ray: f64,
    /// The object that most of them are of.
    pub object: SceneId,
}

impl Crossings {
    /// What rays from the camera go through, and those to the middles of lights from where the former end. `None` where it is
    /// nothing that takes long.
    pub fn many(world: &World, camera: &Camera, settings: &RenderSettings) -> Option<Self> {
        if !(world.needs.transparency && settings.features.transparency) {
            return None;
        }
        let mut count = Count::default();
        let places = (0..SIDE * SIDE).map(|i| UVec2::new(i % SIDE, i / SIDE));
        for place in places {
            // In the middle of its part of the picture.
            let pixel = (2 * place + 1).as_u64vec2() * settings.size.as_u64vec2();
            let ray = central_ray(camera, settings, (pixel / u64::from(2 * SIDE)).as_uvec2());
            count.follow(world, settings, &ray);
            if count.all() > ENOUGH {
                break;
            }
        }
        let a_ray = count.all() as f64 / f64::from(count.rays.max(1));
        let most = (0..count.of_objects.len()).max_by_key(|&i| count.of_objects[i])?;
        (a_ray > MANY).then(|| Self {
            a_ray,
            object: SceneId(world.objects[most].id),
        })
    }

    /// The same for people, who may know the object by a name.
    pub fn text(&self, name: Option<&str>) -> String {
        let object = match name {
            Some(name) => format!("\"{name}\""),
            None => format!("object {}", self.object.0),
        };
        format!(
            "rays go through about {:.0} surfaces each, most of them of {object}: every one of them takes its time",
            self.a_ray
        )
    }
}

#[derive(Default)]
struct Count {
    rays: u32,
    /// Surfaces of each object that were gone through.
    of_objects: Vec<u64>,
}

impl Count {
    fn all(&self) -> u64 {
        self.of_objects.iter().sum()
    }

    /// Along a ray to where nothing goes on, and from there to the lights.
    fn follow(&mut self, world: &World, settings: &RenderSettings, ray: &Ray) {
        let met = seen(world, settings, ray);
        self.add(world, met.iter().map(|(hit, _)| hit));
        let Some((_, surface)) = met.last().filter(|_| settings.features.shading) else {
            return;
        };
        let lamps = world.lamps(settings).take(LAMPS);
        for lamp in lamps.filter(|_| settings.features.shadows) {
            if let Some(point) = middle(world, settings, lamp, surface, ray.time) {
                let ray = shadow_ray(&world.aggregate, surface, &point, ray.time);
                let met = crossings(world, settings, &ray);
                self.add(world, met.iter().map(|(hit, _)| hit));
            }
        }
    }

    fn add<'a>(&mut self, world: &World, met: impl Iterator<Item = &'a Hit>) {
        self.rays += 1;
        self.of_objects.resize(world.objects.len(), 0);
        for hit in met {
            self.of_objects[hit.instance as usize] += 1;
        }
    }
}

/// What a ray goes through that sees what it meets, and where it ends.
fn seen(world: &World, settings: &RenderSettings, ray: &Ray) -> Vec<(Hit, Surface)> {
    let mut hits = Vec::new();
    world.aggregate.all_crossings(ray, &mut hits);
    let (mut met, mut left) = (Vec::new(), 1.0);
    for hit in hits {
        let surface = Surface::at(world, settings, ray, 0.0, &hit);
        left *= 1.0 - surface.opacity;
        met.push((hit, surface));
        if left < FAINT {
            break;
        }
    }
    met
}

/// The middle of a light, where it may light a surface.
fn middle(
    world: &World,
    settings: &RenderSettings,
    lamp: Lamp,
    surface: &Surface,
    time: f32,
) -> Option<LightPoint> {
    let from = (world.lights).in_rest_frame(lamp.id(), surface.point.position, time);
    let point = lamp.middle(surface, from, settings.lighting);
    point.filter(|point| surface.normal.dot(point.direction) > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Triangles};
    use crate::trace::{Lights, Material, Mesh, Object, PointLight};
    use glam::{Affine3A, Vec3};
    use std::sync::Arc;

    /// Sheets of 2 m across the z axis, from `near` on, one behind the other.
    fn sheets(id: u64, material: u32, near: f32, count: u32) -> (Instance, Object) {
        let positions = (0..count).flat_map(|i| {
            let z = near - 0.001 * i as f32;
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z))
        });
        let indices = (0..count).flat_map(|i| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| 4 * i + k)));
        let triangles = Triangles::new(positions.collect(), indices.collect()).unwrap();
        let tree = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
        let instance = Instance::new(tree.clone(), &Affine3A::IDENTITY).unwrap();
        let object = Object {
            id,
            material,
            motion_samples: 0,
            mesh: Arc::new(Mesh::of(tree)),
        };
        (instance, object)
    }

    fn world(objects: Vec<(Instance, Object)>, opacities: &[f32], lamp: Vec3) -> World {
        let (instances, objects): (Vec<_>, Vec<_>) = objects.into_iter().unzip();
        let material = |&opacity: &f32| Material {
            opacity,
            ..Material::default()
        };
        let lamp = PointLight {
            id: 9,
            position: lamp,
            color: Vec3::ONE,
            cone: None,
        };
        World {
            aggregate: Arc::new(Aggregate::build(instances, &BuildOptions::default())),
            objects: Arc::new(objects),
            materials: Arc::new(opacities.iter().map(material).collect()),
            lights: Arc::new(Lights {
                points: vec![lamp],
                ..Lights::default()
            }),
            ..World::default()
        }
        .with_needs()
    }

    fn asked(world: &World, from: f32) -> Option<Crossings> {
        let camera = Camera::looking_at(Vec3::Z * from, Vec3::ZERO, Vec3::Y, 0.2);
        Crossings::many(world, &camera, &RenderSettings::default())
    }

    #[test]
    fn many_faint_sheets_are_counted_and_those_with_most_of_them_named() {
        let before = Vec3::Z * 3.0;
        let few = sheets(7, 0, 0.5, 20);
        let many = sheets(8, 0, 0.0, 2_000);
        let scene = world(vec![few, many], &[0.0005], before);
        // Those to the lamp cross all but one of them too.
        let found = asked(&scene, 4.0).unwrap();
        assert!((2_000.0..2_030.0).contains(&found.a_ray), "{found:?}");
        assert_eq!(found.object, SceneId(8));
        assert_eq!(
            found.text(Some("sheets")).split(':').next(),
            Some(&*format!(
                "rays go through about {:.0} surfaces each, most of them of \"sheets\"",
                found.a_ray
            ))
        );
    }

    #[test]
    fn sheets_that_lie_between_a_floor_and_its_lamp_are_counted_too() {
        let floor = sheets(7, 0, 0.0, 1);
        let many = sheets(8, 1, -1.0, 2_000);
        let scene = world(vec![floor, many], &[1.0, 0.0005], Vec3::Z * -5.0);
        // Seen from above, the floor hides the lamp; from below it is seen, and lit, through the sheets.
        assert_eq!(asked(&scene, 4.0), None);
        let found = asked(&scene, -4.0).unwrap();
        assert!((1_990.0..2_010.0).contains(&found.a_ray), "{found:?}");
    }

    #[test]
    fn nothing_is_said_of_few_sheets_of_many_that_hide_each_other_and_of_opaque_ones() {
        for (count, opacity) in [(50, 0.0005), (2_000, 0.9), (2_000, 1.0)] {
            let scene = world(vec![sheets(8, 0, 0.0, count)], &[opacity], Vec3::Z * 3.0);
            assert_eq!(asked(&scene, 4.0), None, "{count} of {opacity}");
        }
        let scene = world(vec![sheets(8, 0, 0.0, 2_000)], &[0.0005], Vec3::Z * 3.0);
        let camera = Camera::looking_at(Vec3::Z * 4.0, Vec3::ZERO, Vec3::Y, 0.2);
        let mut settings = RenderSettings::default();
        settings.features.transparency = false;
        assert_eq!(Crossings::many(&scene, &camera, &settings), None);
    }
}
