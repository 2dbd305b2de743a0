//! Rendering to a file while the editing goes on.
//!
//! The job takes the scene as it is when it begins; edits that follow do not reach it. It shares the
//! processor with the traced view, and stops by the rules of its own settings: samples, error, time.

use super::document::SceneOpened;
use super::notice::Notices;
use crate::film::{Ending, Progressive, State, Status};
use crate::io::{
    FileError, check_film, check_not_read, check_picture, picture_notes, write_rendered,
};
use crate::scene::{RangeProblem, RenderSettings, SceneId, range_problems};
use crate::sync::{Traced, TracedCameras};
use crate::trace;
use bevy::app::{App, AppExit, Last, Plugin};
use bevy::ecs::message::MessageReader;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::{Mut, World};
use std::io::Write;
use std::path::PathBuf;
use std::thread::{self, JoinHandle};

/// What is to be rendered.
#[derive(Clone, Debug)]
pub struct RenderRequest {
    /// `.png` or `.jpg` as a screen shows it, `.exr` or `.hdr` as linear light, before bloom,
    /// exposure and view transform.
    pub file: PathBuf,
    /// From where.
    pub camera: RenderFrom,
    /// Size, samples and when to stop.
    pub settings: RenderSettings,
}

/// Where a picture is rendered from.
#[derive(Clone, Debug)]
pub enum RenderFrom {
    /// The scene's first camera.
    FirstCamera,
    /// A camera of the scene.
    Camera(SceneId),
    /// Where the view stands.
    View(Box<trace::Camera>),
}

/// Why a render does not begin.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum RenderRefused {
    #[error("{} is being rendered; wait for it, or cancel it", .0.display())]
    Busy(PathBuf),
    #[error("the scene has no such camera; add one, or render what the view shows")]
    NoCamera,
    #[error("{0}")]
    Setting(RangeProblem),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("the system has no more threads: {0}")]
    Threads(#[from] std::io::Error),
}

/// The render to a file that is under way, if one is.
#[derive(Resource, Default)]
pub struct RenderJob {
    job: Option<Job>,
    /// What became of the last one that was written: its message has gone before somebody comes back to a long one.
    done: Option<String>,
}

/// How far a render to a file is.
#[derive(Clone, Debug)]
pub struct RenderProgress {
    /// What it will write.
    pub file: PathBuf,
    /// The render's numbers; `None` until it has begun, which it does when all trees are built.
    pub status: Option<Status>,
    /// 0 to 1, as far as can be told.
    pub fraction: f32,
    /// It is rendered, and being written.
    pub writing: bool,
}

struct Job {
    request: RenderRequest,
    camera: trace::Camera,
    name: String,
    stage: Stage,
}

enum Stage {
    /// For the trees of meshes that are being built.
    Waiting,
    Rendering(Progressive),
    Writing(JoinHandle<Result<(), FileError>>, Status),
}

impl RenderJob {
    /// How far it is; `None` where nothing is being rendered.
    pub fn progress(&self) -> Option<RenderProgress> {
        let job = self.job.as_ref()?;
        let (status, fraction) = match &job.stage {
            Stage::Waiting => (None, 0.0),
            Stage::Rendering(render) => {
                let status = render.status();
                let fraction = fraction(&status, &job.request.settings);
                (Some(status), fraction)
            }
            Stage::Writing(_, status) => (Some(status.clone()), 1.0),
        };
        Some(RenderProgress {
            file: job.request.file.clone(),
            status,
            fraction,
            writing: matches!(job.stage, Stage::Writing(..)),
        })
    }

    /// What was written last, in how long and how good; `None` until then, and while another one is rendered.
    pub fn done(&self) -> Option<&str> {
        self.done.as_deref().filter(|_| self.job.is_none())
    }

    /// Stops rendering, and writes nothing. What is already being written is written.
    pub fn cancel(&mut self) {
        if !matches!(&self.job, Some(job) if matches!(job.stage, Stage::Writing(..))) {
            self.job = None;
        }
    }
}

/// What has not begun when another scene is opened would be rendered of that one.
fn forget_waiting(_: On<SceneOpened>, mut job: ResMut<RenderJob>, mut notices: ResMut<Notices>) {
    let waits = |job: &mut Job| matches!(job.stage, Stage::Waiting);
    if let Some(waited) = job.job.take_if(waits) {
        notices.fault(format!(
            "{}: not rendered: another scene was opened before the trees of this one were built",
            waited.request.file.display()
        ));
    }
}

/// Of the rule that ends it first.
fn fraction(status: &Status, settings: &RenderSettings) -> f32 {
    let samples = status.samples / status.samples_wanted.max(1.0);
    let time = match settings.sampling.time {
        limit if limit > 0.0 => status.seconds / f64::from(limit),
        _ => 0.0,
    };
    let left = status
        .seconds_left
        .map(|left| status.seconds / (status.seconds + left).max(f64::MIN_POSITIVE));
    samples.max(time).max(left.unwrap_or(0.0)).clamp(0.0, 1.0) as f32
}

/// Begins to render to a file. What can be refused is refused before anything is rendered.
pub fn start_render(world: &mut World, request: RenderRequest) -> Result<(), RenderRefused> {
    if let Some(job) = &world.resource::<RenderJob>().job {
        return Err(RenderRefused::Busy(job.request.file.clone()));
    }
    if let Some(problem) = range_problems(&request.settings).into_iter().next() {
        return Err(RenderRefused::Setting(problem));
    }
    let size = request.settings.size;
    check_not_read(world, &request.file)?;
    check_picture(&request.file, size.x.into(), size.y.into())?;
    check_film(world, &request.file, size)?;
    let cameras = &world.resource::<TracedCameras>().0;
    let (camera, name) = match &request.camera {
        RenderFrom::View(camera) => ((**camera).clone(), "the view".to_owned()),
        RenderFrom::FirstCamera => {
            let camera = cameras.first().ok_or(RenderRefused::NoCamera)?;
            (camera.camera.clone(), camera.name.clone())
        }
        RenderFrom::Camera(id) => {
            let camera = cameras.iter().find(|camera| camera.id == *id);
            let camera = camera.ok_or(RenderRefused::NoCamera)?;
            (camera.camera.clone(), camera.name.clone())
        }
    };
    world.resource_mut::<RenderJob>().job = Some(Job {
        request,
        camera,
        name,
        stage: Stage::Waiting,
    });
    Ok(())
}

/// Carries a [`RenderJob`] on.
pub struct RenderJobPlugin;

impl Plugin for RenderJobPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<RenderJob>()
            .init_resource::<Notices>()
            .add_observer(forget_waiting)
            // Whether the editor is on or not, and when the scene is traced as it is now.
            .add_systems(Last, (carry_on, finish_writing).chain());
    }
}

/// The program ends: what is rendered and being written is written first.
fn finish_writing(mut exits: MessageReader<AppExit>, mut jobs: ResMut<RenderJob>) {
    if exits.read().next().is_none() {
        return;
    }
    let writes = |job: &mut Job| matches!(job.stage, Stage::Writing(..));
    let Some(Job {
        stage: Stage::Writing(writing, _),
        request,
        ..
    }) = jobs.job.take_if(writes)
    else {
        return;
    };
    let why = match writing.join() {
        Ok(Ok(())) => return,
        Ok(Err(error)) => error.to_string(),
        Err(_) => "writing it failed by a bug".into(),
    };
    // The window is gone, and where standard error is closed nobody listens.
    let _ = writeln!(
        std::io::stderr(),
        "error: {}: {why}",
        request.file.display()
    );
}

fn carry_on(world: &mut World) {
    if world.resource::<RenderJob>().job.is_none() {
        return;
    }
    world.resource_scope(|world, mut jobs: Mut<RenderJob>| {
        let Some(job) = jobs.job.take() else { return };
        jobs.done = None;
        jobs.job = step(world, job, &mut jobs.done);
    });
}

/// The job as it goes on; `None` where it has ended, and what was done then.
fn step(world: &mut World, job: Job, done: &mut Option<String>) -> Option<Job> {
    let file = job.request.file.clone();
    let fault = |world: &mut World, why: String| {
        let text = format!("{}: not rendered: {why}", file.display());
        world.resource_mut::<Notices>().fault(text);
        None
    };
    let stage = match job.stage {
        Stage::Waiting => {
            let traced = world.resource::<Traced>();
            if traced.pending > 0 {
                return Some(job);
            }
            let scene = (*traced.world).clone();
            let settings = job.request.settings.clone();
            match Progressive::start_for_file(scene, job.camera.clone(), settings) {
                Ok(render) => Stage::Rendering(render),
                Err(error) => return fault(world, error.to_string()),
            }
        }
        Stage::Rendering(render) => {
            let status = render.status();
            match status.state {
                State::Ended(Ending::Cancelled) => return None,
                State::Ended(_) => {
                    let (file, settings) = (file.clone(), job.request.settings.clone());
                    let mut notes = picture_notes(&job.name, &settings, &status);
                    notes.push(("Seconds", format!("{:.3}", status.seconds)));
                    let write = move || {
                        let picture = render.snapshot().picture;
                        write_rendered(&file, &picture, &settings.output, &notes)
                    };
                    match thread::Builder::new().name("write".into()).spawn(write) {
                        Ok(writing) => Stage::Writing(writing, status),
                        Err(error) => return fault(world, error.to_string()),
                    }
                }
                _ => Stage::Rendering(render),
            }
        }
        Stage::Writing(writing, status) if writing.is_finished() => {
            match writing.join() {
                Ok(Ok(())) => {
                    let text = format!(
                        "Rendered {} in {:.1} s, {:.0} samples a pixel",
                        file.display(),
                        status.seconds,
                        status.samples,
                    );
                    world.resource_mut::<Notices>().tell(text.clone());
                    *done = Some(text);
                }
                Ok(Err(error)) => world.resource_mut::<Notices>().fault(error.to_string()),
                Err(_) => return fault(world, "writing it failed by a bug".into()),
            }
            return None;
        }
        writing @ Stage::Writing(..) => writing,
    };
    Some(Job { stage, ..job })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::{Document, FileTask, request};
    use crate::editor::headless_editor;
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use std::time::Duration;

    #[test]
    fn a_picture_that_is_being_written_is_written_before_the_program_ends() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.png");
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        app.update();
        let world = app.world_mut();
        let settings = RenderSettings::default();
        let (scene, camera) = {
            let scene = (*world.resource::<Traced>().world).clone();
            (scene, world.resource::<TracedCameras>().0[0].camera.clone())
        };
        let render = Progressive::start_for_file(scene, camera.clone(), settings.clone()).unwrap();
        let status = render.status();
        drop(render);
        let written = file.clone();
        let slow = move || {
            thread::sleep(Duration::from_millis(500));
            std::fs::write(&written, "a picture").unwrap();
            Ok(())
        };
        world.resource_mut::<RenderJob>().job = Some(Job {
            request: RenderRequest {
                file: file.clone(),
                camera: RenderFrom::FirstCamera,
                settings,
            },
            camera,
            name: String::new(),
            stage: Stage::Writing(thread::spawn(slow), status),
        });
        crate::editor::document::adopt(world, "cornell-box", None);
        request(world, FileTask::Quit);
        assert_eq!(
            world.resource::<Document>().question,
            None,
            "nothing is lost"
        );
        app.update();
        assert!(file.exists());
    }
}
