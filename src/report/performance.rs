//! The performance test: the same picture rendered several times with each builder's trees.

mod table;

use super::timing::median;
use crate::bvh::{BuildOptions, Builder, Levels};
use crate::film::{Ending, Picture, render_while};
use crate::inspect::{build_time, builder_name, rebuilt};
use crate::scene::{RenderSettings, Sampling};
use crate::trace::{Camera, World, samples_per_pixel};
use bevy::platform::collections::HashSet;
use glam::UVec2;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};

/// Triangles above which a scene is not timed without a tree unless that is asked for: a ray tests
/// them all, and a picture of this many at the default size takes minutes.
pub const MOST_WITHOUT_TREE: u64 = 20_000;

/// What is measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PerformanceTest {
    /// Of the scene, for the table.
    pub scene: String,
    /// A column each.
    pub builders: Vec<Builder>,
    /// Renderings with each, 1 or more.
    pub runs: u32,
    /// Times scenes of more than [`MOST_WITHOUT_TREE`] triangles without a tree too.
    pub with_none: bool,
}

/// Why there are no figures.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PerformanceError {
    /// It was told to end.
    #[error("the performance test was stopped")]
    Stopped,
    /// Trees must not change a picture.
    #[error("{0} gives another picture; this is a fault of Glassbox, please report it")]
    OtherPicture(&'static str),
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Performance {
    /// As it was asked for.
    pub test: PerformanceTest,
    /// Pixels of the picture.
    pub size: UVec2,
    /// Samples of each pixel.
    pub spp: u32,
    /// Of the rayon pool that it ran on.
    pub threads: usize,
    /// Builder by builder.
    pub columns: Vec<PerformanceColumn>,
    /// Not timed without a tree, because there are so many triangles.
    pub left_out: Option<u64>,
}

/// One builder's figures.
#[derive(Clone, Debug, PartialEq)]
pub struct PerformanceColumn {
    /// Which one.
    pub builder: Builder,
    /// Of all objects: a mesh that two objects share counts twice.
    pub triangles: u64,
    /// Milliseconds spent on all trees.
    pub build_ms: f64,
    /// Milliseconds of each rendering, shortest first.
    pub render_ms: Vec<f64>,
    /// Of one rendering, of every kind.
    pub rays: u64,
    /// Levels from the root to the deepest leaf, of the trees that a ray goes through one after the
    /// other.
    pub levels: u32,
    /// The most triangles in a leaf.
    pub largest_leaf: u32,
}

impl PerformanceColumn {
    /// Milliseconds of a rendering on average.
    pub fn mean(&self) -> f64 {
        self.render_ms.iter().sum::<f64>() / self.render_ms.len() as f64
    }

    /// Their standard deviation, milliseconds: that of the renderings, with n - 1 in the
    /// denominator; 0 for one.
    pub fn sigma(&self) -> f64 {
        let mean = self.mean();
        let squares: f64 = self.render_ms.iter().map(|ms| (ms - mean).powi(2)).sum();
        let others = self.render_ms.len().saturating_sub(1).max(1);
        (squares / others as f64).sqrt()
    }

    /// The shortest.
    pub fn least(&self) -> f64 {
        self.render_ms.first().copied().unwrap_or(f64::NAN)
    }

    /// The longest.
    pub fn most(&self) -> f64 {
        self.render_ms.last().copied().unwrap_or(f64::NAN)
    }

    /// The middle one, or the mean of the middle two.
    pub fn median(&self) -> f64 {
        median(self.render_ms.clone())
    }

    /// Million rays a second in the median rendering.
    pub fn mrays_per_s(&self) -> f64 {
        match self.median() {
            ms if ms > 0.0 => self.rays as f64 / ms / 1e3,
            _ => 0.0,
        }
    }
}

/// Builds the scene's trees with each builder and renders the picture `runs` times with each, taking
/// turns, so that what else the machine does meets all of them alike. All of its samples are rendered, whatever time the
/// scene gives itself. Runs on the current rayon
/// pool. Breaking ends it within the tiles that are being rendered.
pub fn performance(
    test: &PerformanceTest,
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    tell: &mut (dyn FnMut(&str, f32) -> ControlFlow<()> + Send),
) -> Result<Performance, PerformanceError> {
    let triangles: u64 = world
        .objects
        .iter()
        .map(|object| object.mesh.tree.triangles().len() as u64)
        .sum();
    let left_out = (triangles > MOST_WITHOUT_TREE
        && !test.with_none
        && test.builders.contains(&Builder::None))
    .then_some(triangles);
    let builders: Vec<Builder> = (test.builders.iter().copied())
        .filter(|&builder| builder != Builder::None || left_out.is_none())
        .collect();
    let settings = &RenderSettings {
        sampling: Sampling {
            time: 0.0,
            ..settings.sampling
        },
        ..settings.clone()
    };
    let options = *world.aggregate.options();
    let runs = test.runs.max(1);
    let mut worlds = Vec::with_capacity(builders.len());
    let mut columns = Vec::with_capacity(builders.len());
    // The trees that are built first also pay for fresh memory: these are thrown away.
    for &builder in builders.first().into_iter().chain(&builders) {
        said(tell(&format!("{}: trees", title(builder)), 0.0))?;
        let world = rebuilt(world, &BuildOptions { builder, ..options });
        let (levels, largest_leaf) = shape(&world);
        columns.push(PerformanceColumn {
            builder,
            triangles,
            build_ms: build_time(&world).as_secs_f64() * 1e3,
            render_ms: Vec::with_capacity(runs as usize),
            rays: 0,
            levels,
            largest_leaf,
        });
        worlds.push(world);
    }
    if !columns.is_empty() {
        columns.remove(0);
        worlds.remove(0);
    }
    let renders = (columns.len() * runs as usize).max(1) as f32;
    let mut picture: Option<Picture> = None;
    let mut done = 0.0;
    for run in 1..=runs {
        // Each run begins with another.
        for turn in 0..worlds.len() {
            let i = (turn + run as usize - 1) % worlds.len();
            let (column, world) = (&mut columns[i], &worlds[i]);
            let what = format!("{} {run}/{runs}", title(column.builder));
            said(tell(&what, done / renders))?;
            let told = Mutex::new(&mut *tell);
            let rendered = render_while(world, camera, settings, &|status| {
                let part = (status.samples / status.samples_wanted.max(1.0)) as f32;
                let mut tell = told.lock().unwrap_or_else(PoisonError::into_inner);
                tell(&what, (done + part) / renders).is_continue()
            });
            if rendered.ending == Ending::Cancelled {
                return Err(PerformanceError::Stopped);
            }
            done += 1.0;
            column.render_ms.push(rendered.status.seconds * 1e3);
            column.rays = rendered.status.rays.total();
            let first = picture.get_or_insert_with(|| rendered.picture.clone());
            if *first != rendered.picture {
                return Err(PerformanceError::OtherPicture(title(column.builder)));
            }
        }
    }
    for column in &mut columns {
        column.render_ms.sort_by(f64::total_cmp);
    }
    Ok(Performance {
        test: test.clone(),
        size: settings.size,
        spp: samples_per_pixel(world, camera, settings),
        threads: rayon::current_num_threads(),
        columns,
        left_out,
    })
}

fn said(told: ControlFlow<()>) -> Result<(), PerformanceError> {
    match told {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(PerformanceError::Stopped),
    }
}

/// A builder as headings call it.
pub fn title(builder: Builder) -> &'static str {
    match builder {
        Builder::Sah => "SAH",
        Builder::Ploc => "PLOC",
        other => builder_name(other),
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

    fn column(render_ms: Vec<f64>) -> PerformanceColumn {
        PerformanceColumn {
            builder: Builder::Sah,
            triangles: 12,
            build_ms: 0.5,
            render_ms,
            rays: 3_000_000,
            levels: 3,
            largest_leaf: 4,
        }
    }

    #[test]
    fn mean_sigma_median_and_rays_a_second_are_those_of_the_renderings() {
        let four = column(vec![1.0, 2.0, 4.0, 9.0]);
        assert_eq!((four.least(), four.most()), (1.0, 9.0));
        assert_eq!((four.mean(), four.median()), (4.0, 3.0));
        // (9 + 4 + 0 + 25) / 3
        assert!((four.sigma() - (38.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(four.mrays_per_s(), 1000.0);
        assert_eq!(column(vec![5.0]).sigma(), 0.0);
    }

    #[test]
    fn every_builder_renders_all_samples_whatever_time_the_scene_gives_itself() {
        let mut app = crate::app::headless_app();
        let scene = crate::io::builtin::find("cornell-box").unwrap();
        (scene.spawn)(app.world_mut());
        app.update();
        let world = app.world().resource::<crate::sync::Traced>().world.clone();
        let cameras = &app.world().resource::<crate::sync::TracedCameras>().0;
        let settings = RenderSettings {
            size: UVec2::new(64, 64),
            spp: 64,
            sampling: Sampling {
                time: 1e-3,
                ..Sampling::default()
            },
            ..RenderSettings::default()
        };
        let test = PerformanceTest {
            scene: "box".into(),
            builders: vec![Builder::Median, Builder::Sah],
            runs: 1,
            with_none: false,
        };
        let mut tell = |_: &str, _: f32| ControlFlow::Continue(());
        let measured = performance(&test, &world, &cameras[0].camera, &settings, &mut tell);
        let measured = measured.map_err(|error| error.to_string()).unwrap();
        let rays: Vec<u64> = measured.columns.iter().map(|column| column.rays).collect();
        // A camera ray a sample at least.
        assert!(rays[0] >= 64 * 64 * 64 && rays[0] == rays[1], "{rays:?}");
    }

    #[test]
    fn both_files_hold_a_cell_for_every_builder() {
        let performance = Performance {
            test: PerformanceTest {
                scene: "twelve".into(),
                builders: vec![Builder::Sah, Builder::Ploc],
                runs: 2,
                with_none: false,
            },
            size: UVec2::new(20, 10),
            spp: 4,
            threads: 2,
            columns: vec![
                column(vec![1.0, 3.0]),
                PerformanceColumn {
                    builder: Builder::Ploc,
                    ..column(vec![2.0, 2.0])
                },
            ],
            left_out: None,
        };
        let text = performance.markdown();
        assert!(text.starts_with("**twelve**: 20x10, 4 spp, 2 threads, 2 "));
        assert!(text.contains("|  | SAH | PLOC |\n"), "{text}");
        assert!(text.contains("| Time to render, mean | 2.00 ms | 2.00 ms |"));
        let csv = performance.csv();
        let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|line| line.len() == lines[0].len()));
        assert_eq!((lines[1][0], lines[1][15]), ("sah", "1 3"));
    }
}
