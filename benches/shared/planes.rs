//! What an edit costs beside a frame from scratch: `cargo bench --bench edits -- planes`.
//!
//! Of a scene with one, three, twelve and a hundred point lights more than it has, at 1280 × 720 and one sample a pixel, the
//! median of some rounds, as a part of the time that a render from scratch takes to its only sample of every pixel:
//!
//! - colour: another colour of a light, until the picture of it is there; and the rays that it took;
//! - move: a light moves, until its light is complete again;
//! - material: another material, until every pixel has a sample;
//!
//! and in milliseconds another exposure, and the 95th percentile from any of these edits to its first picture. The frame from
//! scratch is measured between them, so that what else the machine does weighs on all alike; a `*` marks edits of which some
//! were renders of their own. A first round is not counted.

use bevy::app::App;
use bevy::color::LinearRgba;
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::math::{UVec2, Vec3};
use bevy::transform::components::Transform;
use glassbox::app::headless_app;
use glassbox::film::{Progressive, Snapshot, develop_rgba8};
use glassbox::io::builtin;
use glassbox::scene::{MeshSource, Phong, PointLamp, RenderSettings};
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::{Gains, World};
use std::thread;
use std::time::{Duration, Instant};

const SIZE: UVec2 = UVec2::new(1280, 720);
const ROUNDS: usize = 9;

pub fn main() {
    println!(
        "{:<14}{:>7}{:>12}{:>10}{:>8}{:>8}{:>10}{:>13}{:>18}",
        "scene",
        "lights",
        "scratch ms",
        "colour",
        "rays",
        "move",
        "material",
        "exposure ms",
        "first p95 ms"
    );
    for scene in ["cornell-box", "knot"] {
        for lights in [1, 3, 12, 100] {
            Bench::open(scene, lights).measure(scene);
        }
    }
}

struct Bench {
    app: App,
    lamp: Entity,
    object: Entity,
    render: Option<Progressive>,
    snapshot: Snapshot,
}

/// Milliseconds of an edit.
struct Times {
    /// To its first picture.
    first: f64,
    /// To all of its samples.
    all: f64,
    /// It was a render of its own.
    is_replaced: bool,
}

/// Of one kind of edit, as parts of what a frame from scratch took beside it.
#[derive(Default)]
struct Parts {
    parts: Vec<f64>,
    is_replaced: bool,
}

impl Parts {
    fn push(&mut self, times: &Times, from_scratch: &Times) {
        self.parts.push(times.all / from_scratch.all);
        self.is_replaced |= times.is_replaced;
    }

    fn text(&mut self) -> String {
        let mark = if self.is_replaced { "*" } else { "" };
        format!("{:.3}{mark}", half(&mut self.parts))
    }
}

impl Bench {
    fn open(scene: &str, lights: usize) -> Self {
        let mut app = headless_app();
        (builtin::find(scene).expect("a built-in scene").spawn)(app.world_mut());
        let world = app.world_mut();
        let mut settings = world.resource_mut::<RenderSettings>();
        (settings.size, settings.spp) = (SIZE, 1);
        let mut lamp = None;
        for i in 0..lights {
            let (column, row) = ((i % 12) as f32, (i / 12) as f32);
            let place = Transform::from_xyz(0.06 * column - 0.3, 0.4, 0.2 - 0.05 * row);
            let bulb = PointLamp {
                intensity: 0.1,
                ..PointLamp::default()
            };
            lamp = Some(world.spawn((bulb, place)).id());
        }
        app.update();
        let mut objects = app
            .world_mut()
            .query_filtered::<Entity, (With<MeshSource>, With<Phong>)>();
        Self {
            lamp: lamp.expect("a light"),
            object: objects.iter(app.world()).next().expect("an object"),
            app,
            render: None,
            snapshot: Snapshot::black(SIZE),
        }
    }

    fn measure(&mut self, scene: &str) {
        let (mut scratch, mut rays, mut exposure) = (Vec::new(), Vec::new(), Vec::new());
        let [mut colour, mut movement, mut material] = [(); 3].map(|()| Parts::default());
        let mut first = Vec::new();
        let (lamp, object) = (self.lamp, self.object);
        for round in 0..=ROUNDS {
            let step = if round % 2 == 0 { 0.05 } else { -0.05 };
            self.render = None;
            let from_scratch = self.until_done(|bench| {
                bench.start();
                true
            });
            let before = self.rays();
            let of_colour = self.until_done(|bench| {
                bench.change::<PointLamp>(lamp, |lamp| {
                    lamp.color = LinearRgba::rgb(0.5 + step, 1.0, 0.7)
                });
                bench.edit()
            });
            let of_rays = (self.rays() - before) as f64;
            let of_movement = self.until_done(|bench| {
                bench.change::<Transform>(lamp, |place| place.translation += Vec3::splat(step));
                bench.edit()
            });
            let output = self.app.world().resource::<RenderSettings>().output;
            let start = Instant::now();
            std::hint::black_box(develop_rgba8(&self.snapshot.picture, &output));
            let of_exposure = ms(start);
            let of_material = self.until_done(|bench| {
                bench.change::<Phong>(object, |phong| phong.shininess = 50.0 + 100.0 * step);
                bench.edit()
            });
            if round == 0 {
                continue;
            }
            scratch.push(from_scratch.all);
            rays.push(of_rays);
            exposure.push(of_exposure);
            for (parts, times) in [
                (&mut colour, of_colour),
                (&mut movement, of_movement),
                (&mut material, of_material),
            ] {
                first.push(times.first);
                parts.push(&times, &from_scratch);
            }
        }
        let lights = self.world().lights.count();
        println!(
            "{scene:<14}{lights:>7}{:>12.1}{:>10}{:>8}{:>8}{:>10}{:>13.2}{:>18.1}",
            half(&mut scratch),
            colour.text(),
            half(&mut rays),
            movement.text(),
            material.text(),
            half(&mut exposure),
            part(&mut first, 0.95),
        );
    }

    /// From what `begin` does until the picture of it has all its samples and is drawn. `begin` says whether it is a render
    /// of its own.
    fn until_done(&mut self, begin: impl FnOnce(&mut Self) -> bool) -> Times {
        let before = self.render.as_ref().map(Progressive::number);
        let start = Instant::now();
        let is_replaced = begin(self);
        self.wait(|render| Some(render.number()) != before && render.status().divider.is_some());
        self.draw();
        let first = ms(start);
        self.render.as_ref().expect("a render").wait();
        self.draw();
        Times {
            first,
            all: ms(start),
            is_replaced,
        }
    }

    fn wait(&self, there: impl Fn(&Progressive) -> bool) {
        let render = self.render.as_ref().expect("a render");
        while !there(render) {
            thread::sleep(Duration::from_micros(100));
        }
    }

    fn draw(&mut self) {
        let render = self.render.as_ref().expect("a render");
        render.refresh(&mut self.snapshot);
    }

    fn edit(&mut self) -> bool {
        self.app.update();
        let render = self.render.as_ref().expect("a render");
        let is_replaced = !render.edit(self.world(), &Gains::default());
        if is_replaced {
            self.start();
        }
        is_replaced
    }

    fn start(&mut self) {
        let camera = self.app.world().resource::<TracedCameras>().0[0]
            .camera
            .clone();
        let settings = self.app.world().resource::<RenderSettings>().clone();
        let render = Progressive::start(self.world(), camera, settings);
        self.render = Some(render.expect("a thread"));
    }

    fn rays(&self) -> u64 {
        self.render
            .as_ref()
            .map_or(0, |render| render.status().rays.total())
    }

    fn world(&self) -> World {
        World::clone(&self.app.world().resource::<Traced>().world)
    }

    fn change<C: Component<Mutability = Mutable>>(
        &mut self,
        entity: Entity,
        change: impl FnOnce(&mut C),
    ) {
        let mut component = self
            .app
            .world_mut()
            .get_mut::<C>(entity)
            .expect("the component");
        change(&mut component);
    }
}

fn ms(start: Instant) -> f64 {
    1e3 * start.elapsed().as_secs_f64()
}

fn half(values: &mut [f64]) -> f64 {
    part(values, 0.5)
}

fn part(values: &mut [f64], part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * part).round() as usize]
}
