//! Trees under examination: the builders compared, the performance test, two trees side by side,
//! and which boxes are drawn.
//!
//! | module | does |
//! |---|---|
//! | [`background`] | work on a thread of its own, with progress and an end |
//! | [`measure`] | compares the builders and times pictures |
//! | [`pair`], [`cameras`] | two builders' trees over the left and the right of the view |
//! | [`obey`] | what the actions about lines and boxes do |

pub(super) mod background;
mod cameras;
pub(super) mod measure;
mod obey;
pub(super) mod pair;

pub(super) use obey::BoxRanges;

use crate::bvh;
use crate::scene;
use crate::sync::SyncSystems;
use bevy::app::{App, Plugin, PostUpdate, Update};
use bevy::prelude::IntoScheduleConfigs;

/// The part that needs no window: measurements, actions, the trees of a pair.
pub(super) struct TreeStudyPlugin;

impl Plugin for TreeStudyPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<super::action::Action>()
            .init_resource::<crate::inspect::InspectSettings>()
            .init_resource::<super::notice::Notices>()
            .init_resource::<measure::Measurements>()
            .init_resource::<pair::TreePair>()
            .init_resource::<BoxRanges>()
            .add_systems(Update, (measure::carry_on, obey::obey))
            .add_systems(PostUpdate, pair::build_pair.after(SyncSystems));
    }
}

/// All of it, in a window.
pub(super) struct TreesPlugin;

impl Plugin for TreesPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(TreeStudyPlugin).add_systems(
            PostUpdate,
            (
                pair::draw_pair.after(pair::build_pair),
                cameras::fit_cameras.before(bevy::camera::CameraUpdateSystems),
            ),
        );
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

/// The setting that makes trees with this builder.
pub(super) fn setting_of(builder: bvh::Builder) -> scene::Builder {
    match builder {
        bvh::Builder::None => scene::Builder::None,
        bvh::Builder::Median => scene::Builder::Median,
        bvh::Builder::Sah => scene::Builder::Sah,
        bvh::Builder::Ploc => scene::Builder::Ploc,
    }
}
