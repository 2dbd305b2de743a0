//! The command line: parses, calls, prints; no logic of its own.
//!
//! Results go to standard output. Errors are one line on standard error, `error: …`, with exit
//! code 1, or 2 where the command line itself is wrong; warnings and notes go there too. Nothing
//! that fails leaves a file behind.

mod bench;
mod bvh;
mod check;
mod convert;
mod failure;
mod gizmos;
mod inspect;
mod memory;
mod merge;
mod mix;
mod output;
mod progress;
mod render;
mod report;
mod scenes;
mod set;
mod set_entity;
mod settings;
mod shell;
mod shown;
mod similar;
mod stage;
mod stats;
mod stop;
mod view;
mod welcome;

pub use failure::Failure;

use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// A scene editor whose ray tracer you can see into.
#[derive(Parser)]
#[command(name = "glassbox", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Scene file or built-in scene to open (default: cornell-box)
    scene: Option<PathBuf>,
    /// Play this file's clicks and keys in the window
    #[cfg(feature = "editor")]
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    #[command(flatten)]
    memory: memory::MemoryArgs,
}

#[derive(Subcommand)]
enum Command {
    /// Render a scene to picture files
    Render(render::Render),
    /// Add up parts of a picture that `render --samples A..B` wrote, or mix the lights of one
    Merge(merge::Merge),
    /// Build a scene's tree with each builder and print its statistics
    Bvh(bvh::Bvh),
    /// Evaluate a pixel's samples again and show every ray: as text, JSON, or over the picture
    Inspect(inspect::Inspect),
    /// List the built-in scenes: name, triangles, lights, and what they show
    Scenes(scenes::Scenes),
    /// Convert a scene or a model, a file or a built-in one, to .scn.ron, .obj or .glb
    Convert(convert::Convert),
    /// Open files without rendering them: what they hold, and what of it cannot be shown
    Check(check::Check),
    /// Time a scene with each builder and print a table in Markdown
    Bench(bench::Bench),
    /// Measure speed against error and write a report
    Report(report::Report),
    /// Print a script that completes commands and options in a shell
    Completions(shell::Completions),
    /// Print a manual page, for `man -l -`
    Man(shell::Man),
}

/// Runs the command line of this process.
pub fn run() -> ExitCode {
    match execute(std::env::args_os()) {
        Ok(code) => code,
        Err(failure) => failure.report(),
    }
}

fn execute(arguments: impl IntoIterator<Item = OsString>) -> Result<ExitCode, Failure> {
    let cli = Cli::try_parse_from(arguments)?;
    match cli.command {
        #[cfg(feature = "editor")]
        None => return welcome::run(cli.scene, cli.script.as_deref(), cli.memory),
        #[cfg(not(feature = "editor"))]
        None => welcome::run(cli.scene, cli.memory)?,
        Some(Command::Render(render)) => render::run(render)?,
        Some(Command::Merge(merge)) => merge::run(merge)?,
        Some(Command::Bvh(bvh)) => bvh::run(bvh)?,
        Some(Command::Inspect(inspect)) => inspect::run(inspect)?,
        Some(Command::Scenes(scenes)) => scenes::run(scenes)?,
        Some(Command::Convert(convert)) => convert::run(convert)?,
        Some(Command::Check(check)) => check::run(check)?,
        Some(Command::Bench(bench)) => bench::run(bench)?,
        Some(Command::Report(report)) => report::run(report)?,
        Some(Command::Completions(completions)) => shell::completions(completions)?,
        Some(Command::Man(man)) => shell::man(man)?,
    }
    Ok(ExitCode::SUCCESS)
}
