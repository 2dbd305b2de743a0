//! The traced picture in a Bevy camera, and what is drawn over it. The only room that knows Bevy's
//! renderer.
//!
//! | plugin | does |
//! |---|---|
//! | [`TracedViewPlugin`] | a camera with [`TracedView`] shows what the tracer draws of it |
//! | [`StandardMappingPlugin`] | a scene of Bevy's own materials and lights is traced: the tables in [`standard`] |
//! | [`TracedPickingPlugin`] | pointers pick what the tracer hits |
//! | [`LinesPlugin`] | sets of lines, by Bevy's retained gizmos |
//! | [`RasterPlugin`] | a scene of our components is seen in Bevy's renderer too |
//! | [`SymbolsPlugin`] | lights, cameras and outlines |
//! | [`HandleCameraPlugin`] | Bevy's transform gizmo over the traced picture |
//!
//! [`GlassboxPlugins`] adds the first four to any Bevy app, with what they need. A view says when it is
//! done ([`Converged`]) or cannot render ([`Failed`]), and gives its picture to code
//! ([`TracedRender::picture`]); [`render_reference`] renders one beside a running game.

#![expect(
    clippy::too_many_arguments,
    clippy::type_complexity,
    reason = "a system's parameters are the list of what it reads"
)]

mod adapter;
mod cameras;
mod darkroom;
mod darkroom_threads;
mod film_size;
mod handle_camera;
pub mod lines;
mod pick;
mod presence;
pub mod raster;
mod reference;
mod render;
mod screen;
mod screen_part;
mod screen_pass;
mod shot;
mod sketch;
pub mod standard;
mod surfaces;
mod symbols;
mod traced;

pub use adapter::Adapter;
pub(crate) use adapter::largest_side;
pub use cameras::{interface_camera, picture_camera, twin_camera};
pub(crate) use handle_camera::see_as;
pub use handle_camera::{HandleCameraPlugin, draws_handles};
pub use lines::{DrawnLines, Line, LinesPlugin, OVERLAY_LAYER};
pub use pick::{Picked, TracedPickingPlugin, pick};
pub(crate) use presence::{enter_renderer, leave_renderer};
pub use raster::{RASTER_LAYER, RasterPlugin};
pub use reference::{ReferenceRendered, TracedPicture, render_reference};
pub use render::{PrintInfo, TracedRender};
pub use shot::shoot_window;
pub use standard::{AddTracedMaterial, StandardMappingPlugin, TracedAs};
pub use symbols::{Outlined, SymbolOf, Symbols, SymbolsPlugin, nearest_symbol};
#[cfg(feature = "editor")]
pub(crate) use traced::height_of;
pub use traced::{
    Converged, Failed, ShowsPictureOf, TracedView, TracedViewPlugin, ViewSettings, traced_camera,
};

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
            .add(StandardMappingPlugin)
            .add(SyncPlugin)
            .add(screen_pass::ScreenPlugin)
            .add(TracedViewPlugin)
            .add(reference::ReferencePlugin)
            .add(TracedPickingPlugin)
            .add(LinesPlugin)
    }
}
