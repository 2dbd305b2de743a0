//! Random edits, some of them taken back, and again and again a fresh app with what should be there now.

use super::{Effort, Outcome};
use crate::app::headless_app;
use crate::bvh::Ray;
use crate::bvh::hard_cases::random::Random;
use crate::film::render;
use crate::scene::{MeshSource, Phong, PointLamp, RenderSettings, SceneCamera, SceneId, Shape};
use crate::sync::{Traced, TracedCameras};
use bevy::app::App;
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::math::{Quat, UVec2, Vec3};
use bevy::transform::components::Transform;

/// What an object is, as the edits have left it.
#[derive(Clone)]
struct Thing {
    id: u64,
    shape: Shape,
    phong: Phong,
    transform: Transform,
}

fn shape(random: &mut Random) -> Shape {
    let shapes = [
        Shape::default(),
        Shape::Sphere {
            radius: 0.6,
            segments: 12,
            rings: 8,
        },
        Shape::Torus {
            major_radius: 0.5,
            minor_radius: 0.2,
            segments: 12,
            sides: 6,
        },
    ];
    shapes[random.below(shapes.len())].clone()
}

fn transform(random: &mut Random) -> Transform {
    Transform {
        translation: random.cube() * 2.0,
        rotation: Quat::from_axis_angle(random.direction(), random.between(0.0, 6.0)),
        scale: Vec3::splat(random.between(0.3, 1.2)),
    }
}

fn phong(random: &mut Random) -> Phong {
    let color = random.cube().abs();
    Phong {
        diffuse: LinearRgba::rgb(color.x, color.y, color.z),
        specular: LinearRgba::rgb(0.2, 0.2, 0.2),
        mirror: LinearRgba::rgb(0.2, 0.2, 0.2),
        ..Phong::default()
    }
}

fn bundle(thing: &Thing) -> (SceneId, MeshSource, Phong, Transform) {
    let mesh = MeshSource::Shape(thing.shape.clone());
    (
        SceneId(thing.id),
        mesh,
        thing.phong.clone(),
        thing.transform,
    )
}

/// An app with a camera and a lamp.
fn stage() -> App {
    let mut app = headless_app();
    let world = app.world_mut();
    let camera = Transform::from_xyz(0.0, 1.0, 7.0).looking_at(Vec3::ZERO, Vec3::Y);
    world.spawn((SceneId(1), SceneCamera::default(), camera));
    let lamp = PointLamp {
        intensity: 60.0,
        ..PointLamp::default()
    };
    world.spawn((SceneId(2), lamp, Transform::from_xyz(2.0, 5.0, 3.0)));
    app
}

/// The app under test, what its entities should be, and how it was before each edit.
struct Edited {
    app: App,
    things: Vec<(Entity, Thing)>,
    before: Vec<Vec<Thing>>,
    last_id: u64,
}

impl Edited {
    fn spawn(&mut self, thing: Thing) {
        let entity = self.app.world_mut().spawn(bundle(&thing)).id();
        self.things.push((entity, thing));
    }

    fn now(&self) -> Vec<Thing> {
        self.things.iter().map(|(_, thing)| thing.clone()).collect()
    }

    fn edit(&mut self, random: &mut Random) {
        let kind = random.below(6);
        if kind == 5
            && let Some(before) = self.before.pop()
        {
            return self.restore(before);
        }
        self.before.push(self.now());
        if kind == 0 || self.things.is_empty() {
            self.last_id += 1;
            let thing = Thing {
                id: self.last_id,
                shape: shape(random),
                phong: phong(random),
                transform: transform(random),
            };
            return self.spawn(thing);
        }
        let which = random.below(self.things.len());
        if kind == 1 {
            let (entity, _) = self.things.swap_remove(which);
            self.app.world_mut().despawn(entity);
            return;
        }
        let (entity, thing) = &mut self.things[which];
        let mut entity = self.app.world_mut().entity_mut(*entity);
        match kind {
            2 => {
                thing.transform = transform(random);
                entity.insert(thing.transform);
            }
            3 => {
                thing.phong = phong(random);
                entity.insert(thing.phong.clone());
            }
            _ => {
                thing.shape = shape(random);
                entity.insert(MeshSource::Shape(thing.shape.clone()));
            }
        }
    }

    /// As an undo does: what is another than before is put back, what is gone comes back, what is new goes.
    fn restore(&mut self, before: Vec<Thing>) {
        let world = self.app.world_mut();
        self.things.retain(|(entity, thing)| {
            let stays = before.iter().any(|other| other.id == thing.id);
            if !stays {
                world.despawn(*entity);
            }
            stays
        });
        for thing in before {
            match self
                .things
                .iter_mut()
                .find(|(_, other)| other.id == thing.id)
            {
                Some((entity, other)) => {
                    self.app
                        .world_mut()
                        .entity_mut(*entity)
                        .insert(bundle(&thing));
                    *other = thing;
                }
                None => self.spawn(thing),
            }
        }
    }

    /// Another app with the same things, spawned in another order and all in one frame.
    fn fresh(&self) -> App {
        let mut app = stage();
        for (_, thing) in self.things.iter().rev() {
            app.world_mut().spawn(bundle(thing));
        }
        app.update();
        app
    }
}

/// Hits and pixels that differ between two apps.
fn differences(a: &App, b: &App, rays: usize, random: &mut Random) -> (usize, usize) {
    let world = |app: &App| app.world().resource::<Traced>().world.clone();
    let (first, second) = (world(a), world(b));
    let hits = (0..rays)
        .filter(|_| {
            let origin = random.cube() * 6.0;
            let ray = Ray::new(origin, random.cube() * 2.0 - origin);
            first.aggregate.closest_hit(&ray) != second.aggregate.closest_hit(&ray)
        })
        .count();
    let settings = RenderSettings {
        size: UVec2::splat(24),
        spp: 2,
        ..RenderSettings::default()
    };
    let camera = &a.world().resource::<TracedCameras>().0[0].camera;
    let [one, two] =
        [&first, &second].map(|world| render(world, camera, &settings, &|_, _| {}).picture);
    let pixels = one
        .pixels
        .iter()
        .zip(&two.pixels)
        .filter(|(a, b)| a != b)
        .count();
    (hits, pixels)
}

pub(super) fn edits(effort: &Effort) -> Outcome {
    let mut random = Random::new(effort.seed + 29);
    let mut edited = Edited {
        app: stage(),
        things: Vec::new(),
        before: Vec::new(),
        last_id: 10,
    };
    let rays = 1_000;
    let (mut hits, mut pixels, mut compared) = (0, 0, 0);
    for number in 1..=effort.edits {
        edited.edit(&mut random);
        // Several edits may fall into one frame.
        if number % 3 != 0 {
            edited.app.update();
        }
        if number % 50 == 0 {
            edited.app.update();
            let fresh = edited.fresh();
            let (h, p) = differences(&edited.app, &fresh, rays, &mut random);
            hits += h;
            pixels += p;
            compared += 1;
        }
    }
    Outcome::new(
        effort.edits,
        format!(
            "{compared} comparisons with a fresh build: {hits} hits and {pixels} pixels differ"
        ),
    )
    .require(hits == 0, format!("{hits} hits differ"))
    .require(pixels == 0, format!("{pixels} pixels differ"))
}
