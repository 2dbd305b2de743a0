//! `glassbox bvh`: what each builder makes of a scene.

use super::Failure;
use super::output::say;
use super::settings::{BuilderArg, SettingArgs, check_scene};
use super::stage::{SceneArgs, Stage, with_threads};
use crate::bvh;
use crate::inspect::{BuilderFigures, compare_builders, csv, markdown};
use clap::Args;

#[derive(Args)]
pub(super) struct Bvh {
    #[command(flatten)]
    scene: SceneArgs,
    /// Only this builder (default: all four)
    #[arg(long, value_enum)]
    builder: Option<BuilderArg>,
    /// Measure closest hits and occlusion tests a second too, on the rays of the camera's own view,
    /// one thread
    #[arg(long)]
    rays: bool,
    /// Print JSON with the histograms instead of a table
    #[arg(long, conflicts_with_all = ["markdown", "csv"])]
    json: bool,
    /// Print Markdown with the histograms instead of a table
    #[arg(long, conflicts_with = "csv")]
    markdown: bool,
    /// Print comma-separated values with the histograms instead of a table
    #[arg(long)]
    csv: bool,
    /// Camera whose rays are measured, by its name (default: the first)
    #[arg(long, value_name = "NAME", requires = "rays")]
    camera: Option<String>,
    #[command(flatten)]
    settings: SettingArgs,
}

pub(super) fn run(args: Bvh) -> Result<(), Failure> {
    args.settings.check()?;
    let rows = with_threads(args.settings.threads, || rows(&args))?;
    if args.json {
        let text = serde_json::to_string_pretty(&rows)
            .map_err(|error| Failure::System(error.to_string()))?;
        say(text)
    } else if args.markdown {
        say(markdown(&rows).trim_end())
    } else if args.csv {
        say(csv(&rows).trim_end())
    } else {
        say(BuilderFigures::table(&rows).trim_end())
    }
}

/// One tree over all triangles, whatever the scene's own setting is, so that one row can say it all.
fn rows(args: &Bvh) -> Result<Vec<BuilderFigures>, Failure> {
    let mut stage = Stage::open(&args.scene, args.json || args.csv)?;
    args.settings.apply(stage.app.world_mut())?;
    let settings = stage.settings();
    let settings = settings.clone();
    check_scene(&stage.name, &settings)?;
    let world = stage.sync().world.clone();
    let camera = match args.rays {
        true => Some(stage.camera(args.camera.as_deref())?),
        false => None,
    };
    let builders: Vec<bvh::Builder> = match args.builder {
        Some(builder) => vec![builder.of_tree()],
        None => BuilderArg::ALL.map(BuilderArg::of_tree).to_vec(),
    };
    let view = camera.as_ref().map(|camera| (&camera.camera, &settings));
    Ok(compare_builders(&world, &builders, view))
}
