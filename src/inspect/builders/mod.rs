//! What each builder makes of a world, in numbers: the panel, the command line and files show these.

mod figures;
mod rates;
mod rebuilt;
mod text;

pub(crate) use figures::corners;
pub use figures::{BuilderFigures, build_time, builder_name};
pub use rates::BuilderRates;
pub use rebuilt::{rebuilt, same_geometry};
pub use text::{csv, markdown};

use crate::bvh::{Aggregate, BuildOptions, Builder, Levels};
use crate::scene::RenderSettings;
use crate::trace::{Camera, World};
use rates::ViewRays;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Told what is begun next, and which part of the whole is done by then, 0 to 1. Breaking ends it.
pub type Tell<'a> = dyn FnMut(&str, f32) -> ControlFlow<()> + 'a;

/// Builds the world's trees with each builder and measures them: the figures on one tree over all
/// triangles, so that one row says it all; with `view` also the speed on that camera's own rays, with
/// the levels that the world has.
pub fn compare_builders(
    world: &World,
    builders: &[Builder],
    view: Option<(&Camera, &RenderSettings)>,
) -> Vec<BuilderFigures> {
    let compared =
        compare_builders_told(world, builders, view, &mut |_, _| ControlFlow::Continue(()));
    match compared {
        ControlFlow::Continue(figures) => figures,
        // Nobody breaks it.
        ControlFlow::Break(()) => Vec::new(),
    }
}

/// The same, telling how far it is: it ends between two trees, or between two rounds of
/// measurements, where it is told to.
pub fn compare_builders_told(
    world: &World,
    builders: &[Builder],
    view: Option<(&Camera, &RenderSettings)>,
    tell: &mut Tell,
) -> ControlFlow<(), Vec<BuilderFigures>> {
    let options = *world.aggregate.options();
    let steps = match view {
        Some(_) => builders.len() * 2 + 2 + rates::STEPS,
        None => builders.len() + 1,
    };
    let mut step = 0;
    let mut next = |what: &str| {
        step += 1;
        tell(what, (step - 1) as f32 / steps as f32)
    };
    // The first tree that is built pays for memory and caches that the others find; it is thrown away.
    next("a first tree")?;
    let levels = Levels::One;
    drop(rebuilt(world, &BuildOptions { levels, ..options }));
    let mut figures = Vec::with_capacity(builders.len());
    for &builder in builders {
        next(&format!("{}: one tree", builder_name(builder)))?;
        let options = BuildOptions {
            builder,
            levels,
            ..options
        };
        figures.push(BuilderFigures::of(&rebuilt(world, &options)));
    }
    let Some((camera, settings)) = view else {
        return ControlFlow::Continue(figures);
    };
    next("the view's rays")?;
    let rays = ViewRays::of(world, camera, settings);
    let mut aggregates: Vec<Arc<Aggregate>> = Vec::with_capacity(builders.len());
    for &builder in builders {
        next(&format!("{}: trees of the scene", builder_name(builder)))?;
        aggregates.push(rebuilt(world, &BuildOptions { builder, ..options }).aggregate);
    }
    let rates = rays.rates(&aggregates, &mut || next("rays a second"))?;
    for (figures, rates) in figures.iter_mut().zip(rates) {
        figures.rates = Some(rates);
    }
    ControlFlow::Continue(figures)
}
