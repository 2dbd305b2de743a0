//! `glassbox check`: whether files can be shown, and what of them cannot.

use super::Failure;
use super::memory::MemoryArgs;
use super::output::say;
use super::stage::NO_CAMERA;
use crate::app::headless_app;
use crate::inspect::counted;
use crate::io::place::world_from;
use crate::io::{
    FileNote, LoadProblems, MODEL_EXTENSIONS, OpenOptions, SceneSource, extension, open,
};
use crate::scene::{
    DirectionalLamp, Environment, ParallelogramLamp, Phong, PointLamp, SceneCamera, SegmentLamp,
};
use crate::sync::{Traced, TracedCameras};
use bevy::app::App;
use bevy::asset::Assets;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::mesh::{Mesh, Mesh3d};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(super) struct Check {
    /// Scene files (.scn.ron, .obj, .gltf, .glb, .stl, .ply) or names of built-in scenes
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Print all that is known as JSON
    #[arg(long)]
    json: bool,
    /// End with code 1 where there is anything to note, too
    #[arg(long)]
    strict: bool,
    /// Let the files refer to others outside their own folder
    #[arg(long)]
    allow_outside: bool,
    #[command(flatten)]
    memory: MemoryArgs,
}

/// What a file holds.
#[derive(Serialize)]
struct Checked {
    file: String,
    /// Why it cannot be shown.
    error: Option<String>,
    objects: usize,
    triangles: usize,
    /// Of all triangles, in the world's space.
    area: f64,
    /// The corners of the box around them; none where there is nothing.
    bounds: Option<[[f32; 3]; 2]>,
    materials: usize,
    lights: usize,
    cameras: usize,
    notes: Vec<Noted>,
}

/// What was not taken as the file has it.
#[derive(Serialize)]
struct Noted {
    file: String,
    place: String,
    what: String,
    names: Vec<String>,
    instead: String,
    count: u64,
    #[serde(skip)]
    line: String,
}

pub(super) fn run(args: Check) -> Result<(), Failure> {
    let mut all = Vec::new();
    for file in &args.files {
        // What one file holds would lie beside what the next one needs.
        let mut app = headless_app();
        let mut checked = check(app.world_mut(), file, &args);
        if checked.error.is_none() {
            checked.notes.extend(untraced(&mut app, file));
        }
        if !args.json {
            print(&checked)?;
        }
        all.push(checked);
    }
    if args.json {
        let text = serde_json::to_string_pretty(&all);
        say(text.map_err(|error| Failure::System(error.to_string()))?)?;
    }
    let refused = all.iter().filter(|checked| checked.error.is_some()).count();
    let noted = all
        .iter()
        .filter(|checked| !checked.notes.is_empty())
        .count();
    let count = all.len();
    match (refused, noted) {
        (0, 0) => Ok(()),
        (0, noted) if args.strict => Err(Failure::Scene(format!(
            "{noted} of {count} files cannot be shown as they are"
        ))),
        (0, _) => Ok(()),
        (refused, _) => Err(Failure::Scene(format!(
            "{refused} of {count} files cannot be shown"
        ))),
    }
}

fn check(world: &mut World, file: &Path, args: &Check) -> Checked {
    let options = OpenOptions {
        allow_outside: args.allow_outside,
        limits: args.memory.limits(),
        unframed: true,
        ..OpenOptions::default()
    };
    let opened = open(world, &SceneSource::named(file), options);
    let mut checked = Checked {
        file: file.display().to_string(),
        error: None,
        objects: 0,
        triangles: 0,
        area: 0.0,
        bounds: None,
        materials: 0,
        lights: 0,
        cameras: 0,
        notes: Vec::new(),
    };
    match opened {
        Err(error) => checked.error = Some(error.to_string()),
        Ok(opened) => {
            let mut query = world.query::<(Entity, &Mesh3d)>();
            let objects: Vec<_> = query.iter(world).map(|(e, m)| (e, m.0.id())).collect();
            checked.objects = objects.len();
            let meshes = world.resource::<Assets<Mesh>>();
            for (entity, mesh) in objects {
                let place = world_from(world, entity);
                for corners in meshes.get(mesh).into_iter().flat_map(triangles_of) {
                    checked.count(corners.map(|corner| place.transform_point3(corner)));
                }
            }
            let mut materials = world.query_filtered::<&Phong, bevy::ecs::query::Without<Mesh3d>>();
            checked.materials = materials.iter(world).count();
            checked.lights = count::<PointLamp>(world)
                + count::<DirectionalLamp>(world)
                + count::<SegmentLamp>(world)
                + count::<ParallelogramLamp>(world)
                + usize::from(world.resource::<Environment>().lights);
            checked.cameras = count::<SceneCamera>(world);
            checked.notes = opened.notes.iter().map(noted).collect();
            let problems = &world.resource::<LoadProblems>().problems;
            checked.notes.extend(problems.iter().map(|problem| Noted {
                file: problem.error.file.display().to_string(),
                place: problem.error.place.to_string(),
                what: problem.error.problem.to_string(),
                names: Vec::new(),
                instead: "left out".to_owned(),
                count: 1,
                line: problem.error.to_string(),
            }));
        }
    }
    checked
}

/// What of an open file cannot be traced, as it is told where it is rendered. A model is framed there, if it has no camera.
fn untraced(app: &mut App, file: &Path) -> Vec<Noted> {
    app.update();
    let note = |place: String, what: String| Noted {
        file: file.display().to_string(),
        line: format!("{}: {place}: {what}", file.display()),
        place,
        what,
        names: Vec::new(),
        instead: String::new(),
        count: 1,
    };
    let world = app.world();
    let problems = &world.resource::<Traced>().problems;
    let mut notes: Vec<_> = (problems.iter())
        .map(|problem| note(problem.subject.to_string(), problem.fault.to_string()))
        .collect();
    let is_model = MODEL_EXTENSIONS.contains(&extension(file).as_str());
    if !is_model && world.resource::<TracedCameras>().0.is_empty() {
        notes.push(note("scene".to_owned(), NO_CAMERA.to_owned()));
    }
    notes
}

fn noted(note: &FileNote) -> Noted {
    Noted {
        file: note.file.display().to_string(),
        place: note.place.to_string(),
        what: note.what.clone(),
        names: note.names.clone(),
        instead: note.instead.to_owned(),
        count: note.count,
        line: note.to_string(),
    }
}

fn count<T: Component>(world: &mut World) -> usize {
    world.query_filtered::<(), With<T>>().iter(world).count()
}

/// The corners of a mesh's triangles.
fn triangles_of(mesh: &Mesh) -> impl Iterator<Item = [Vec3; 3]> {
    let triangles = mesh.triangles().into_iter().flatten();
    triangles.map(|triangle| triangle.vertices)
}

impl Checked {
    fn count(&mut self, [a, b, c]: [Vec3; 3]) {
        self.triangles += 1;
        let [u, v] = [b - a, c - a].map(Vec3::as_dvec3);
        self.area += 0.5 * u.cross(v).length();
        let [least, most] = self.bounds.map_or([a; 2], |bounds| bounds.map(Vec3::from));
        let (least, most) = (least.min(a).min(b).min(c), most.max(a).max(b).max(c));
        self.bounds = Some([least.to_array(), most.to_array()]);
    }
}

fn print(checked: &Checked) -> Result<(), Failure> {
    use super::output::one_line;
    let file = &checked.file;
    if let Some(error) = &checked.error {
        return say(one_line(&format!("{file}: cannot be shown: {error}")));
    }
    let notes = match checked.notes.len() as u64 {
        0 => "nothing to note".to_owned(),
        count => counted(count, "note"),
    };
    let holds = [
        (checked.objects, "object"),
        (checked.triangles, "triangle"),
        (checked.materials, "material"),
        (checked.lights, "light"),
        (checked.cameras, "camera"),
    ]
    .map(|(number, what)| counted(number as u64, what));
    say(one_line(&format!("{file}: {}; {notes}", holds.join(", "))))?;
    for note in &checked.notes {
        say(format_args!("  {}", one_line(&note.line)))?;
    }
    Ok(())
}
