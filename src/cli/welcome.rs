//! `glassbox` without a command: opens the editor. Where there can be no window it says so, and shows
//! what it can do without one.

use super::Failure;
use super::memory::MemoryArgs;
#[cfg(not(feature = "editor"))]
use super::output::say;
#[cfg(feature = "editor")]
use super::output::tell;
use super::render::{Render, run as render};
use super::settings::SettingArgs;
use super::stage::SceneArgs;
use super::stop::StopArgs;
use super::view::ViewArgs;
#[cfg(feature = "editor")]
use crate::editor::{self, NoWindow, Script};
#[cfg(feature = "editor")]
use crate::io::SceneSource;
use crate::io::builtin::DEFAULT;
use std::path::{Path, PathBuf};
#[cfg(feature = "editor")]
use std::process::ExitCode;

/// Opens the editor, and plays a script in it.
///
/// Without a display the scene is rendered to a file instead. A script, and a display without a
/// graphics adapter, are errors then: someone waits for a window.
#[cfg(feature = "editor")]
pub(super) fn run(
    scene: Option<PathBuf>,
    script: Option<&Path>,
    memory: MemoryArgs,
) -> Result<ExitCode, Failure> {
    let script = script.map(Script::read).transpose();
    let script = script.map_err(|error| Failure::System(error.to_string()))?;
    match editor::check() {
        Ok(()) => {
            let scene = scene.unwrap_or_else(|| PathBuf::from(DEFAULT));
            Ok(editor::run(
                SceneSource::named(scene),
                script,
                memory.limits(),
            ))
        }
        Err(no_window @ (NoWindow::Display(_) | NoWindow::Library(_))) if script.is_none() => {
            let instead = match no_window {
                NoWindow::Display(_) => {
                    "; a display is needed, on Debian xvfb is one without a screen"
                }
                _ => "",
            };
            tell(
                "note",
                format_args!(
                    "{no_window}{instead}. What follows is `glassbox render`, which needs none"
                ),
            );
            show(scene, memory)?;
            Ok(ExitCode::SUCCESS)
        }
        Err(no_window) => Err(Failure::System(no_window.to_string())),
    }
}

/// Says what can be done, and shows it.
#[cfg(not(feature = "editor"))]
pub(super) fn run(scene: Option<PathBuf>, memory: MemoryArgs) -> Result<(), Failure> {
    say(commands())?;
    show(scene, memory)
}

/// What this build can do.
#[cfg(any(test, not(feature = "editor")))]
fn commands() -> String {
    format!(
        "Glassbox {}: a scene editor whose ray tracer you can see into.\n\
         This build has no window; these commands work without one:\n\
         \x20 glassbox render SCENE -o OUT   a scene to a picture (.png, .jpg, .exr, .hdr)\n\
         \x20 glassbox merge PART… -o OUT    parts of a picture's samples to one picture\n\
         \x20 glassbox scenes                the built-in scenes\n\
         \x20 glassbox bvh SCENE             statistics of its trees, builder by builder\n\
         \x20 glassbox inspect SCENE         why a pixel has its colour: every ray of it\n\
         \x20 glassbox bench SCENE           rendering times, builder by builder\n\
         \x20 glassbox report                speed against error, measured on this machine\n\
         \x20 glassbox convert IN OUT        .scn.ron, .obj and .glb from one to the other\n\
         \x20 glassbox check FILE…           what files hold, and what of it cannot be shown\n\
         \x20 glassbox completions SHELL     a script that completes commands in a shell\n\
         \x20 glassbox man [COMMAND]         a manual page\n\
         Each explains itself with --help.",
        env!("CARGO_PKG_VERSION")
    )
}

/// Renders a scene to a picture in the working folder.
fn show(scene: Option<PathBuf>, memory: MemoryArgs) -> Result<(), Failure> {
    let scene = scene.unwrap_or_else(|| PathBuf::from(DEFAULT));
    let output = picture_name(&scene);
    render(Render {
        scene: SceneArgs {
            scene,
            allow_outside: false,
            memory,
        },
        output,
        settings: SettingArgs {
            size: None,
            spp: None,
            seed: None,
            set: Vec::new(),
            threads: None,
        },
        stop: StopArgs::default(),
        view: ViewArgs::default(),
        lights_separately: false,
        camera: Vec::new(),
        all_cameras: false,
        builder: None,
        stats: None,
        quiet: false,
    })
}

/// `dir/room.scn.ron` and the built-in `room` become `room.png` in the working folder.
fn picture_name(scene: &Path) -> PathBuf {
    let name = scene
        .file_name()
        .map_or_else(|| "scene".into(), |name| name.to_string_lossy());
    let stem = name.split('.').find(|part| !part.is_empty());
    PathBuf::from(format!("{}.png", stem.unwrap_or("scene")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use clap::CommandFactory;

    #[test]
    fn a_build_without_a_window_names_every_command() {
        let text = commands();
        for command in Cli::command().get_subcommands() {
            let name = command.get_name();
            let mut named = text.lines().map(|line| line.split_whitespace().nth(1));
            assert!(named.any(|word| word == Some(name)), "`{name}`: {text}");
        }
    }

    #[test]
    fn the_picture_is_called_like_the_scene() {
        for (scene, picture) in [
            ("cornell-box", "cornell-box.png"),
            ("a/b/room.scn.ron", "room.png"),
            ("../x.obj", "x.png"),
            ("..", "scene.png"),
        ] {
            assert_eq!(picture_name(Path::new(scene)), Path::new(picture));
        }
    }
}
