//! `glassbox convert`: a scene in another format.

use super::Failure;
use super::output::{say, tell};
use super::stage::{SceneArgs, Stage};
use crate::io::{OpenOptions, check_save, extension, save};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Convert {
    #[command(flatten)]
    scene: SceneArgs,
    /// Scene file to write: .scn.ron, .obj (with its .mtl) or .glb
    output: PathBuf,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

pub(super) fn run(args: Convert) -> Result<(), Failure> {
    check_save(&args.output).map_err(Failure::of_output)?;
    let options = OpenOptions {
        // A model stays what it is; a scene is rendered, and has to have a camera.
        unframed: extension(&args.output) != "scn.ron",
        ..OpenOptions::default()
    };
    let mut stage = Stage::open_with(&args.scene, args.quiet, options)?;
    stage.check_outputs([&*args.output])?;
    let notes = save(stage.app.world_mut(), &args.output)?;
    if !args.quiet {
        for note in notes.iter() {
            tell("note", note);
        }
        say(args.output.display())?;
    }
    Ok(())
}
