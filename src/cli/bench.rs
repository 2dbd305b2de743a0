//! `glassbox bench`: the original report's performance test, for every builder.

use super::Failure;
use super::output::say;
use super::progress::Progress;
use super::settings::{BuilderArg, SettingArgs, check_scene};
use super::stage::{SceneArgs, Stage, with_threads};
use super::stats::{build_time, mrays_per_second, triangles};
use crate::bvh::Levels;
use crate::film::{Picture, render};
use crate::trace::{World, samples_per_pixel};
use bevy::platform::collections::HashSet;
use clap::Args;
use std::sync::Arc;

/// Triangles above which a scene is not timed without a tree unless that is asked for: a ray tests
/// them all, and a picture of this many at the default size takes minutes.
const MOST_WITHOUT_TREE: u64 = 20_000;

#[derive(Args)]
pub(super) struct Bench {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    settings: SettingArgs,
    /// Renderings with each builder
    #[arg(long, value_name = "N", default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Time scenes of more than 20000 triangles without a tree too
    #[arg(long)]
    with_none: bool,
}

/// One builder's column.
struct Column {
    builder: BuilderArg,
    world: Arc<World>,
    build_ms: f64,
    render_ms: Vec<f64>,
    rays: u64,
}

pub(super) fn run(args: Bench) -> Result<(), Failure> {
    args.settings.check()?;
    let text = with_threads(args.settings.threads, || measure(&args))?;
    say(text.trim_end())
}

fn measure(args: &Bench) -> Result<String, Failure> {
    let mut stage = Stage::open(&args.scene, false)?;
    let settings = stage.settings();
    args.settings.apply(settings)?;
    let settings = settings.clone();
    check_scene(&stage.name, &settings)?;

    let mut columns = Vec::new();
    let mut skipped = None;
    // The trees that are built first also pay for fresh memory: these are thrown away.
    stage.sync();
    for builder in BuilderArg::ALL {
        stage.settings().tree.builder = builder.builder();
        let world = stage.sync().world.clone();
        let count = triangles(&world);
        if builder == BuilderArg::None && count > MOST_WITHOUT_TREE && !args.with_none {
            skipped = Some(count);
            continue;
        }
        columns.push(Column {
            builder,
            build_ms: build_time(&world).as_secs_f64() * 1e3,
            world,
            render_ms: Vec::new(),
            rays: 0,
        });
    }
    let Some(camera) = stage.cameras().0.first().cloned() else {
        return Err(Failure::Scene(format!("{}: has no camera", stage.name)));
    };

    // Builders take turns, so that what else the machine does meets all of them alike.
    let mut picture: Option<Picture> = None;
    for run in 1..=args.runs {
        for column in &mut columns {
            let what = format!("{} {run}/{}", title(column.builder), args.runs);
            let progress = Progress::new(false, &what);
            let rendered = render(&column.world, &camera.camera, &settings, &|done, all| {
                progress.show(done, all);
            });
            column.render_ms.push(rendered.seconds * 1e3);
            column.rays = rendered.rays.total();
            let first = picture.get_or_insert_with(|| rendered.picture.clone());
            if *first != rendered.picture {
                return Err(Failure::Scene(format!(
                    "{}: {} gives another picture; this is a fault of Glassbox, please report it",
                    stage.name,
                    title(column.builder)
                )));
            }
        }
    }
    for column in &mut columns {
        column.render_ms.sort_by(f64::total_cmp);
    }
    let spp = columns.first().map_or(0, |column| {
        samples_per_pixel(&column.world, &camera.camera, &settings)
    });
    let mut text = format!(
        "**{}**: {}x{}, {spp} spp, {} threads, {} renderings a builder, taking turns\n\n",
        stage.name,
        settings.size.x,
        settings.size.y,
        rayon::current_num_threads(),
        args.runs
    );
    text += &table(&columns);
    if let Some(count) = skipped {
        text += &format!(
            "\nWithout a tree: left out, {count} triangles are more than {MOST_WITHOUT_TREE} (--with-none).\n"
        );
    }
    Ok(text)
}

fn title(builder: BuilderArg) -> &'static str {
    match builder {
        BuilderArg::None => "none",
        BuilderArg::Median => "median",
        BuilderArg::Sah => "SAH",
        BuilderArg::Ploc => "PLOC",
    }
}

fn table(columns: &[Column]) -> String {
    let mut text = String::new();
    let mut row = |name: &str, cell: &dyn Fn(&Column) -> String| {
        let cells: Vec<String> = columns.iter().map(cell).collect();
        text += &format!("| {name} | {} |\n", cells.join(" | "));
    };
    row("", &|column| title(column.builder).to_owned());
    row("---", &|_| "---:".to_owned());
    row("Triangles", &|column| triangles(&column.world).to_string());
    row("Time to create", &|column| milliseconds(column.build_ms));
    row("Time to render, least", &|column| {
        milliseconds(column.render_ms[0])
    });
    row("Time to render, median", &|column| {
        milliseconds(middle(&column.render_ms))
    });
    row("Time to render, most", &|column| {
        milliseconds(column.render_ms[column.render_ms.len() - 1])
    });
    row("Million rays/s, median", &|column| {
        let seconds = middle(&column.render_ms) / 1e3;
        format!("{:.3}", mrays_per_second(column.rays, seconds))
    });
    row("BVH levels", &|column| shape(&column.world).0.to_string());
    row("Max triangles per leaf", &|column| {
        shape(&column.world).1.to_string()
    });
    text
}

fn milliseconds(value: f64) -> String {
    format!("{value:.2} ms")
}

/// The middle one of sorted times, or the mean of the middle two.
fn middle(sorted: &[f64]) -> f64 {
    let half = sorted.len() / 2;
    if sorted.len() % 2 == 1 {
        sorted[half]
    } else {
        0.5 * (sorted[half - 1] + sorted[half])
    }
}

/// Levels from the root to the deepest leaf, of the trees that a ray goes through one after the
/// other; and the most triangles in a leaf.
fn shape(world: &World) -> (u32, u32) {
    let top = world.aggregate.stats();
    if world.aggregate.options().levels == Levels::One {
        return (top.levels, top.largest_leaf);
    }
    let mut seen = HashSet::new();
    let meshes = world
        .objects
        .iter()
        .filter(|object| seen.insert(Arc::as_ptr(&object.mesh)))
        .map(|object| object.mesh.tree.stats());
    meshes.fold((top.levels, 0), |(levels, largest), mesh| {
        (
            levels.max(top.levels + mesh.levels),
            largest.max(mesh.largest_leaf),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_an_even_number_of_times_lies_between_two() {
        assert_eq!(middle(&[1.0, 2.0, 9.0]), 2.0);
        assert_eq!(middle(&[1.0, 2.0, 4.0, 9.0]), 3.0);
        assert_eq!(middle(&[5.0]), 5.0);
    }
}
