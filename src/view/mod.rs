//! The traced picture in a Bevy camera. The only room that knows Bevy's renderer.
//!
//! | plugin | does |
//! |---|---|
//! | [`TracedViewPlugin`] | a camera with [`TracedView`] shows what the tracer draws of it |
//!
//! [`GlassboxPlugins`] adds them to any Bevy app, with what they need.

mod darkroom;
mod screen;
mod traced;

pub use traced::{PrintInfo, TracedRender, TracedView, TracedViewPlugin, traced_camera};

use crate::io::IoPlugin;
use crate::scene::ScenePlugin;
use crate::sync::SyncPlugin;
use bevy::app::{PluginGroup, PluginGroupBuilder};

/// Everything that a Bevy app with `DefaultPlugins` needs to see its scene traced: give a camera a
/// [`TracedView`].
pub struct GlassboxPlugins;

impl PluginGroup for GlassboxPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(ScenePlugin)
            .add(IoPlugin)
            .add(SyncPlugin)
            .add(screen::ScreenPlugin)
            .add(TracedViewPlugin)
    }
}
