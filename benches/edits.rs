//! From an edit to what is seen of it: `cargo bench --bench edits [-- --csv FILE]`.
//!
//! Each edit changes one component of a scene that is being rendered at 1280 × 720, as a gesture does:
//! the render before it is under way. Per edit, the median and the 95th percentile of the milliseconds
//! until
//!
//! - frame: the edited world is synced, and the render under way has taken it in or is cancelled and another one started:
//!   what the thread that runs the app's systems is busy with; of several frames the longest;
//! - picture: the first picture of the edited scene is developed, on a thread of its own. A mesh's tree
//!   is built in the background, and the picture before goes on meanwhile;
//! - sample: every pixel has a sample (in every fourth round; the longest in place of the percentile);
//!
//! how many of the edits the render under way took in, and what of the tracer's world was redone. With `--csv` the figures are also written as a table, which
//! `glassbox report --editing FILE` takes in. Times are wall-clock, on all the machine's cores: on a
//! machine that is busy with other things they say little.
//!
//! `cargo bench --bench edits -- lines`: what a hundred thousand lines of gizmos that stand cost in a
//! frame instead. `cargo bench --bench edits -- planes`: what an edit of a light costs beside a frame from scratch.
//! `cargo bench --bench edits -- game`: what our systems add to the frames of a game of four thousand objects.

#[cfg(feature = "view")]
#[path = "shared/game.rs"]
mod game;
#[cfg(feature = "view")]
#[path = "shared/lines.rs"]
mod lines;
#[path = "shared/planes.rs"]
mod planes;

use bevy::app::App;
use bevy::asset::Assets;
use bevy::color::LinearRgba;
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::math::{Quat, UVec2, Vec3};
use bevy::mesh::{Mesh, Mesh3d};
use bevy::transform::components::Transform;
use glassbox::app::headless_app;
use glassbox::film::{Progressive, Snapshot, develop_rgba8};
use glassbox::io::shapes::mesh;
use glassbox::io::{builtin, check_writable};
use glassbox::report::{Cell, Table};
use glassbox::scene::{
    MeshSource, ParallelogramLamp, Phong, PointLamp, RenderSettings, SceneCamera, Shape,
};
use glassbox::sync::{Changes, Traced, TracedCameras, TreeBuilding};
use glassbox::trace::Gains;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

const SIZE: UVec2 = UVec2::new(1280, 720);
/// Of every edit, after one that is not counted.
const ROUNDS: usize = 40;
/// How long a picture is looked at before the next edit: a gesture's edits follow one another.
const BETWEEN: Duration = Duration::from_millis(20);
/// Frames follow one another so soon while something is being built.
const FRAME: Duration = Duration::from_millis(4);

/// What is written: a row for each edit of each scene.
const COLUMNS: [&str; 11] = [
    "scene",
    "objects",
    "edit",
    "frame p50 ms",
    "frame p95 ms",
    "picture p50 ms",
    "picture p95 ms",
    "sample p50 ms",
    "sample most ms",
    "taken in",
    "redone",
];

fn main() {
    let is_asked_for = |part: &str| std::env::args().any(|argument| argument == part);
    #[cfg(feature = "view")]
    if is_asked_for("lines") {
        return lines::main();
    }
    #[cfg(feature = "view")]
    if is_asked_for("game") {
        return game::main();
    }
    #[cfg(not(feature = "view"))]
    for part in ["lines", "game"] {
        assert!(
            !is_asked_for(part),
            "{part} has no figures without the feature `view`"
        );
    }
    if is_asked_for("planes") {
        return planes::main();
    }
    let mut arguments = std::env::args().skip_while(|argument| argument != "--csv");
    let file = arguments.next().map(|_| {
        // Cargo appends a flag of its own.
        let file = arguments.next().filter(|name| !name.starts_with("--"));
        PathBuf::from(file.expect("--csv wants a file"))
    });
    if let Some(file) = &file {
        check_writable(file).unwrap_or_else(|error| panic!("{error}"));
    }
    let mut table = Table::new("editing", "Edits", &COLUMNS);
    println!("{} threads", rayon::current_num_threads());
    for (scene, instances) in [
        ("cornell-box", 0),
        ("knot", 0),
        ("cornell-box", 1000),
        ("cornell-box", 4000),
    ] {
        let mut session = Session::open(scene, instances);
        println!(
            "\n{scene}, {} triangles in {} objects\n{:<18}{:>16}{:>16}{:>16}{:>10}  redone",
            session.triangles(),
            session.traced().world.objects.len(),
            "p50 / p95 ms",
            "frame",
            "picture",
            "sample",
            "taken in"
        );
        session.edits(instances > 0);
        table.rows.append(&mut session.rows);
    }
    if let Some(file) = file {
        // In its place when it is whole: what is there is an hour's work, too.
        let part = file.with_added_extension("part");
        let written =
            std::fs::write(&part, table.csv()).and_then(|()| std::fs::rename(&part, &file));
        written.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    }
}

/// A scene that is edited.
struct Session {
    app: App,
    render: Option<Progressive>,
    snapshot: Snapshot,
    /// Develops pictures: the tracer's threads are busy.
    show: ThreadPool,
    object: Entity,
    light: Entity,
    camera: Entity,
    instances: Vec<Entity>,
    name: String,
    /// The table's.
    rows: Vec<Vec<Cell>>,
}

/// Milliseconds of one round.
struct Times {
    frame: f64,
    picture: f64,
    sample: Option<f64>,
}

impl Session {
    fn open(scene: &str, instances: i32) -> Self {
        let mut app = headless_app();
        (builtin::find(scene).expect("a built-in scene").spawn)(app.world_mut());
        let world = app.world_mut();
        world.resource_mut::<RenderSettings>().size = SIZE;
        let object = last_with::<MeshSource>(&mut app);
        let light = last_with::<ParallelogramLamp>(&mut app)
            .or_else(|| last_with::<PointLamp>(&mut app))
            .expect("a lamp");
        let camera = last_with::<SceneCamera>(&mut app).expect("a camera");
        let ball = MeshSource::Shape(Shape::Sphere {
            radius: 0.01,
            segments: 12,
            rings: 8,
        });
        let instances = (0..instances)
            .map(|i| {
                let at = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32);
                let place = Transform::from_translation(0.05 * at);
                app.world_mut().spawn((ball.clone(), place)).id()
            })
            .collect();
        app.update();
        app.insert_resource(TreeBuilding::InBackground);
        let threads = rayon::current_num_threads().min(4);
        let show = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        Self {
            object: object.expect("an object"),
            light,
            camera,
            instances,
            app,
            render: None,
            name: scene.to_owned(),
            rows: Vec::new(),
            snapshot: Snapshot::black(SIZE),
            show: show.expect("a thread"),
        }
    }

    fn traced(&self) -> &Traced {
        self.app.world().resource::<Traced>()
    }

    fn triangles(&self) -> usize {
        let objects = self.traced().world.objects.iter();
        objects.map(|o| o.mesh.tree.triangles().len()).sum()
    }

    fn edits(&mut self, many: bool) {
        let Self {
            object,
            light,
            camera,
            ..
        } = *self;
        self.row("light move", |app, i| {
            change::<Transform>(app, light, |t| t.translation.x += step(i));
        });
        self.row("light colour", |app, i| {
            let color = LinearRgba::rgb(1.0, 0.9 + step(i), 0.8);
            if app.world().get::<PointLamp>(light).is_some() {
                change::<PointLamp>(app, light, |lamp| lamp.color = color);
            } else {
                change::<ParallelogramLamp>(app, light, |lamp| lamp.colors = [color; 4]);
            }
        });
        self.row("material", |app, i| {
            change::<Phong>(app, object, |phong| {
                phong.shininess = 50.0 + 100.0 * step(i)
            });
        });
        self.row("object move", |app, i| {
            change::<Transform>(app, object, |t| t.translation.x += step(i));
        });
        if many {
            let instances = self.instances.clone();
            self.row("all of them move", |app, i| {
                for &instance in &instances {
                    change::<Transform>(app, instance, |t| t.translation.y += step(i));
                }
            });
        }
        self.row("camera move", |app, i| {
            change::<Transform>(app, camera, |t| {
                t.rotation *= Quat::from_rotation_y(0.1 * step(i));
            });
        });
        if !many {
            let shapes = [0.12, 0.16].map(|displacement| {
                let shape = Shape::Knot {
                    p: 2,
                    q: 3,
                    tube_radius: 0.2,
                    displacement,
                    segments: 1088,
                    sides: 40,
                };
                mesh(&shape).expect("a knot")
            });
            self.row("mesh swap", |app, i| {
                let handle = app.world().get::<Mesh3d>(object).expect("a mesh").0.clone();
                let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
                meshes
                    .insert(handle.id(), shapes[i % 2].clone())
                    .expect("a mesh");
            });
        }
        self.exposure();
    }

    /// Makes the edit again and again, and prints how long it took.
    fn row(&mut self, name: &str, mut edit: impl FnMut(&mut App, usize)) {
        let mut all = Changes::default();
        let (mut rounds, mut taken_in) = (Vec::new(), 0);
        for i in 0..=ROUNDS {
            let start = Instant::now();
            edit(&mut self.app, i);
            self.app.update();
            let mut redone = self.traced().changes;
            let mut frame = ms(start);
            while self.traced().pending > 0 {
                thread::sleep(FRAME);
                let start = Instant::now();
                self.app.update();
                redone = union(redone, self.traced().changes);
                frame = ms(start).max(frame);
            }
            let before = Instant::now();
            let number = self.render.as_ref().map(Progressive::number);
            let is_taken_in = self.show_world(redone);
            frame += ms(before);
            self.wait_for(number, |divider| divider.is_some());
            self.develop();
            let picture = ms(start);
            let sample = i.is_multiple_of(4).then(|| {
                self.wait_for(number, |divider| divider == Some(1));
                ms(start)
            });
            if i > 0 {
                taken_in += usize::from(is_taken_in);
                rounds.push(Times {
                    frame,
                    picture,
                    sample,
                });
            }
            all = union(all, redone);
            thread::sleep(BETWEEN);
        }
        self.note(name, &rounds, taken_in, &names(all));
    }

    /// Prints a row and keeps it for the table.
    fn note(&mut self, name: &str, rounds: &[Times], taken_in: usize, redone: &str) {
        let figures = [
            parts(rounds, |t| Some(t.frame), 95),
            parts(rounds, |t| Some(t.picture), 95),
            parts(rounds, |t| t.sample, 100),
        ];
        let [frame, picture, sample] = figures.map(|figures| {
            figures.map_or(String::new(), |[half, most]| {
                format!("{half:.1} / {most:.1}")
            })
        });
        println!("{name:<18}{frame:>16}{picture:>16}{sample:>16}{taken_in:>10}  {redone}");
        let objects = self.traced().world.objects.len();
        let mut row: Vec<Cell> = vec![self.name.as_str().into(), objects.into(), name.into()];
        for figures in figures {
            row.extend([0, 1].map(|i| Cell::from(figures.map(|figures| figures[i]))));
        }
        row.push(taken_in.into());
        row.push(redone.into());
        self.rows.push(row);
    }

    /// The exposure of a picture that stands: developed again, without a ray.
    fn exposure(&mut self) {
        self.render.as_ref().expect("a render").pause();
        thread::sleep(5 * BETWEEN);
        let rays = |session: &Self| session.render.as_ref().map(|r| r.status().rays.total());
        let before = rays(self);
        let mut rounds = Vec::new();
        for i in 0..=ROUNDS {
            let start = Instant::now();
            let mut settings = self.app.world_mut().resource_mut::<RenderSettings>();
            settings.output.exposure = step(i);
            self.app.update();
            let frame = ms(start);
            self.develop();
            let picture = ms(start);
            if i > 0 {
                rounds.push(Times {
                    frame,
                    picture,
                    sample: None,
                });
            }
        }
        let traced = rays(self)
            .zip(before)
            .map_or(0, |(after, before)| after - before);
        self.note("exposure", &rounds, ROUNDS, &format!("{traced} rays"));
    }

    /// Shows the world as it is now, as views do: the render that is under way takes it in where it can, else another one
    /// begins. Whether it was the former.
    fn show_world(&mut self, redone: Changes) -> bool {
        let world = trace_world(&self.app);
        if let Some(render) = &self.render
            && !redone.cameras
            && render.edit(world.clone(), &Gains::default())
        {
            return true;
        }
        let camera = &self.app.world().resource::<TracedCameras>().0[0];
        let settings = self.app.world().resource::<RenderSettings>().clone();
        let render = Progressive::start(world, camera.camera.clone(), settings);
        self.render = Some(render.expect("a thread"));
        false
    }

    /// Waits until the render of that number, or one after it, has a picture of which this is so.
    fn wait_for(&self, before: Option<u64>, there: impl Fn(Option<u32>) -> bool) {
        let render = self.render.as_ref().expect("a render");
        while Some(render.number()) == before || !there(render.status().divider) {
            thread::sleep(Duration::from_micros(100));
        }
    }

    fn develop(&mut self) {
        let output = self.app.world().resource::<RenderSettings>().output;
        let render = self.render.as_ref().expect("a render");
        let snapshot = &mut self.snapshot;
        self.show.install(|| {
            render.refresh(snapshot);
            std::hint::black_box(develop_rgba8(&snapshot.picture, &output));
        });
    }
}

fn trace_world(app: &App) -> glassbox::trace::World {
    glassbox::trace::World::clone(&app.world().resource::<Traced>().world)
}

/// Back and forth.
fn step(i: usize) -> f32 {
    if i.is_multiple_of(2) { 0.01 } else { -0.01 }
}

fn last_with<C: Component>(app: &mut App) -> Option<Entity> {
    let world = app.world_mut();
    let mut all = world.query_filtered::<Entity, With<C>>();
    all.iter(world).last()
}

fn change<C: Component<Mutability = Mutable>>(
    app: &mut App,
    entity: Entity,
    change: impl FnOnce(&mut C),
) {
    let mut component = app.world_mut().get_mut::<C>(entity).expect("the component");
    change(&mut component);
}

fn ms(start: Instant) -> f64 {
    1e3 * start.elapsed().as_secs_f64()
}

fn union(a: Changes, b: Changes) -> Changes {
    Changes {
        meshes: a.meshes | b.meshes,
        top_level: a.top_level | b.top_level,
        objects: a.objects | b.objects,
        materials: a.materials | b.materials,
        textures: a.textures | b.textures,
        lights: a.lights | b.lights,
        environment: a.environment | b.environment,
        cameras: a.cameras | b.cameras,
    }
}

fn names(changes: Changes) -> String {
    let parts = [
        (changes.meshes, "meshes"),
        (changes.top_level, "top level"),
        (changes.objects, "objects"),
        (changes.materials, "materials"),
        (changes.textures, "textures"),
        (changes.lights, "lights"),
        (changes.environment, "environment"),
        (changes.cameras, "cameras"),
    ];
    let names: Vec<&str> = parts.iter().filter(|p| p.0).map(|p| p.1).collect();
    names.join(", ")
}

/// The median and another percentile; the hundredth is the largest.
fn parts(rounds: &[Times], value: fn(&Times) -> Option<f64>, percent: usize) -> Option<[f64; 2]> {
    let mut values: Vec<f64> = rounds.iter().filter_map(value).collect();
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let at = |part: usize| values[(values.len() * part / 100).min(last)];
    Some([at(50), at(percent)])
}
