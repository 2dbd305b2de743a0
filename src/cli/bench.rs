//! `glassbox bench`: the performance test: the same picture rendered with each builder.

use super::Failure;
use super::output::say;
use super::progress::Progress;
use super::settings::{BuilderArg, SettingArgs, check_scene};
use super::stage::{SceneArgs, Stage, with_threads};
use crate::report::performance::{Performance, PerformanceTest, performance};
use clap::Args;
use std::ops::ControlFlow;

#[derive(Args)]
pub(super) struct Bench {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    settings: SettingArgs,
    /// Renderings with each builder
    #[arg(long, value_name = "N", default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..=1000), allow_negative_numbers = true)]
    runs: u32,
    /// Time scenes of more than 20000 triangles without a tree too
    #[arg(long)]
    with_none: bool,
    /// Print comma-separated values instead of Markdown
    #[arg(long, conflicts_with = "json")]
    csv: bool,
    /// Print JSON instead of Markdown
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: Bench) -> Result<(), Failure> {
    args.settings.check()?;
    let measured = with_threads(args.settings.threads, || measure(&args))?;
    if args.json {
        return say(format_args!("{:#}", measured.json()));
    }
    if args.csv {
        return say(measured.csv().trim_end());
    }
    let mut text = measured.markdown();
    if measured.left_out.is_some() {
        text = format!("{} (--with-none).", text.trim_end().trim_end_matches('.'));
    }
    say(text.trim_end())
}

fn measure(args: &Bench) -> Result<Performance, Failure> {
    let mut stage = Stage::open(&args.scene, args.csv || args.json)?;
    args.settings.apply(stage.app.world_mut())?;
    let settings = stage.settings();
    let settings = settings.clone();
    check_scene(&stage.name, &settings)?;
    stage.check_film(settings.size)?;
    let world = stage.sync().world.clone();
    let camera = stage.camera(None)?;
    let test = PerformanceTest {
        scene: stage.name.clone(),
        builders: BuilderArg::ALL.map(BuilderArg::of_tree).to_vec(),
        runs: args.runs,
        with_none: args.with_none,
    };
    let progress = Progress::new(args.csv || args.json, "");
    let mut tell = |what: &str, part: f32| {
        progress.show_step(what, (part * 1000.0) as u64, 1000);
        ControlFlow::Continue(())
    };
    let measured = performance(&test, &world, &camera.camera, &settings, &mut tell);
    measured.map_err(|problem| Failure::Scene(format!("{}: {problem}", stage.name)))
}
