//! Opening a scene for a command: the app, its notes and warnings, and the threads it runs on.

use super::Failure;
use super::memory::MemoryArgs;
use super::output::tell;
use crate::app::headless_app;
use crate::io::{
    LoadProblems, OpenOptions, SceneFiles, SceneSource, check_film, check_film_of_lights,
    check_outputs, open,
};
use crate::scene::{RenderSettings, SceneId};
use crate::sync::{Traced, TracedCamera, TracedCameras};
use bevy::app::App;
use bevy::ecs::name::Name;
use bevy::math::UVec2;
use clap::Args;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Which scene a command opens, and how.
#[derive(Args)]
pub(super) struct SceneArgs {
    /// Scene file (.scn.ron, .obj, .gltf, .glb, .stl, .ply) or name of a built-in scene
    pub scene: PathBuf,
    /// Let the scene refer to files outside its own folder
    #[arg(long)]
    pub allow_outside: bool,
    #[command(flatten)]
    pub memory: MemoryArgs,
}

/// What is wrong with a scene of which no picture can be made.
pub(super) const NO_CAMERA: &str = "has no camera to render from; add a SceneCamera";

/// A scene that is open.
pub(super) struct Stage {
    pub app: App,
    /// The scene's name.
    pub name: String,
    quiet: bool,
}

impl Stage {
    /// Names of everything that has a number.
    pub fn names(&mut self) -> BTreeMap<u64, String> {
        let world = self.app.world_mut();
        let mut named = world.query::<(&SceneId, &Name)>();
        let named = named.iter(world);
        named.map(|(id, name)| (id.0, name.to_string())).collect()
    }

    /// Opens the scene. What was left out or added is told on standard error, unless `quiet`.
    pub fn open(args: &SceneArgs, quiet: bool) -> Result<Self, Failure> {
        Self::open_with(args, quiet, OpenOptions::default())
    }

    /// The same with options of which the arguments say their part.
    pub fn open_with(args: &SceneArgs, quiet: bool, options: OpenOptions) -> Result<Self, Failure> {
        let mut app = headless_app();
        let options = OpenOptions {
            allow_outside: args.allow_outside,
            limits: args.memory.limits(),
            ..options
        };
        let opened = open(app.world_mut(), &SceneSource::named(&args.scene), options)?;
        if !quiet {
            for note in opened.notes.iter() {
                tell("note", note);
            }
            for problem in &app.world().resource::<LoadProblems>().problems {
                let (what, error) = (problem.what, &problem.error);
                tell("warning", format_args!("{}: {what}: {error}", opened.name));
            }
        }
        Ok(Self {
            app,
            name: opened.name,
            quiet,
        })
    }

    /// Refuses outputs that would replace a file that the scene was read from, or each other.
    pub fn check_outputs<'a>(
        &self,
        outputs: impl IntoIterator<Item = &'a Path>,
    ) -> Result<(), Failure> {
        let files = self.app.world().resource::<SceneFiles>();
        Ok(check_outputs(outputs, files.inputs())?)
    }

    /// The scene's settings; what is written to them counts from the next [`Self::sync`] on.
    pub fn settings(&mut self) -> &mut RenderSettings {
        self.app
            .world_mut()
            .resource_mut::<RenderSettings>()
            .into_inner()
    }

    /// Refuses a film of this size that does not fit into memory beside the scene.
    pub fn check_film(&self, size: UVec2) -> Result<(), Failure> {
        Ok(check_film(self.app.world(), Path::new(&self.name), size)?)
    }

    /// The same of one that keeps the light of so many lights apart.
    pub fn check_film_of_lights(&self, size: UVec2, lights: usize) -> Result<(), Failure> {
        let name = Path::new(&self.name);
        Ok(check_film_of_lights(self.app.world(), name, size, lights)?)
    }

    /// Brings the tracer's world up to date, and warns of what it had to leave out.
    pub fn sync(&mut self) -> &Traced {
        self.app.update();
        let traced = self.app.world().resource::<Traced>();
        if !self.quiet {
            for problem in &traced.problems {
                tell("warning", format_args!("{}: {problem}", self.name));
            }
        }
        traced
    }

    /// The camera of that name, or the first, as the last sync left it.
    pub fn camera(&self, name: Option<&str>) -> Result<TracedCamera, Failure> {
        let cameras = &self.cameras().0;
        let Some(first) = cameras.first() else {
            return Err(Failure::Scene(format!("{}: {NO_CAMERA}", self.name)));
        };
        let Some(name) = name else {
            return Ok(first.clone());
        };
        let camera = cameras.iter().find(|camera| camera.name == *name);
        camera.cloned().ok_or_else(|| {
            let known: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
            Failure::Usage(format!(
                "--camera {name}: {} has no camera `{name}`; it has {}",
                self.name,
                known.join(", ")
            ))
        })
    }

    /// The cameras of the last sync.
    pub fn cameras(&self) -> &TracedCameras {
        self.app.world().resource::<TracedCameras>()
    }
}

/// Runs `work` on that many threads, or on as many as the machine has.
pub(super) fn with_threads<R: Send>(
    threads: Option<u32>,
    work: impl FnOnce() -> Result<R, Failure> + Send,
) -> Result<R, Failure> {
    // The largest task is not deep, but the parsers of files were written for main threads.
    const STACK_BYTES: usize = 8 << 20;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0) as usize)
        .stack_size(STACK_BYTES)
        .build()
        .map_err(|error| Failure::System(format!("threads could not be started: {error}")))?;
    pool.install(work)
}
