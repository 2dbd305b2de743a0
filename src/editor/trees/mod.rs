//! Trees under examination: the builders compared, the performance test, two trees side by side,
//! and which boxes are drawn.
//!
//! | module | does |
//! |---|---|
//! | [`measure`] | compares the builders and times pictures |
//! | [`pair`], [`cameras`] | two builders' trees in two views of the scene |
//! | [`commands`] | the commands about lines and boxes |

mod cameras;
mod commands;
pub(super) mod measure;
pub(super) mod pair;

pub(super) use commands::BoxRanges;
pub(super) use pair::LEFT_TREES_LAYER;

use super::command::AddCommands;
use super::schedule::EditorUpdate;
use crate::bvh;
use crate::inspect::InspectSettings;
use crate::scene;
use crate::scene::schema::choice_name;
use crate::sync::SyncSystems;
use crate::view::Adapter;
use bevy::app::{App, Plugin, PostUpdate, Startup};
use bevy::prelude::{IntoScheduleConfigs, ResMut};

/// The part that needs no window: measurements, actions, the trees of a pair.
pub(super) struct TreeStudyPlugin;

impl Plugin for TreeStudyPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<InspectSettings>()
            .init_resource::<super::notice::Notices>()
            .init_resource::<measure::Measurements>()
            .init_resource::<pair::TreePair>()
            .init_resource::<BoxRanges>()
            .add_observer(commands::forget_scene)
            .add_observer(measure::forget_scene)
            .add_commands(commands::commands())
            .add_systems(EditorUpdate, measure::carry_on)
            .add_systems(PostUpdate, pair::build_pair.after(SyncSystems));
    }
}

/// All of it, in a window.
pub(super) struct TreesPlugin;

impl Plugin for TreesPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(TreeStudyPlugin)
            .add_systems(Startup, fit_lines)
            .add_systems(
                PostUpdate,
                (
                    pair::draw_pair.after(pair::build_pair),
                    cameras::fit_twin
                        .after(super::cameras::fit_viewport)
                        .before(bevy::camera::CameraUpdateSystems),
                ),
            );
    }
}

/// Lines of a system at most where a processor draws them too: each frame then takes its time from
/// the tracer. Chosen by eye, at a third of the default; a person may set more.
const LINES_WITHOUT_GPU: u32 = 30_000;

/// No more lines than the machine draws quickly; what is left out is said.
fn fit_lines(adapter: Adapter, mut inspect: ResMut<InspectSettings>) {
    if adapter.is_a_processor() && inspect.max_lines == InspectSettings::default().max_lines {
        inspect.max_lines = LINES_WITHOUT_GPU;
    }
}

/// A setting's builder as trees know it.
pub(super) fn of_setting(builder: scene::Builder) -> bvh::Builder {
    match builder {
        scene::Builder::None => bvh::Builder::None,
        scene::Builder::Median => bvh::Builder::Median,
        scene::Builder::Sah => bvh::Builder::Sah,
        scene::Builder::Ploc => bvh::Builder::Ploc,
    }
}

/// A builder as its setting calls it.
pub(super) fn builder_title(builder: bvh::Builder) -> String {
    choice_name(&setting_of(builder))
}

/// The setting that makes trees with this builder.
pub(super) fn setting_of(builder: bvh::Builder) -> scene::Builder {
    match builder {
        bvh::Builder::None => scene::Builder::None,
        bvh::Builder::Median => scene::Builder::Median,
        bvh::Builder::Sah => scene::Builder::Sah,
        bvh::Builder::Ploc => scene::Builder::Ploc,
    }
}
