//! The part of the window that shows the scene, and how it shows it.

use super::document::SceneOpened;
use crate::view::{TracedRender, TracedView};
use bevy::ecs::component::Component;
use bevy::ecs::observer::On;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::Query;
use bevy::ecs::world::{Mut, World};
use bevy::math::{Rect, Vec2};
use serde::{Deserialize, Serialize};

/// The camera that the editor looks at the scene with. It is no entity of the scene.
#[derive(Component, Default)]
pub struct EditorCamera;

/// What is traced of the view; `None` in an editor without one.
pub(super) fn traced_render(world: &World) -> Option<&TracedRender> {
    let mut renders = world.try_query_filtered::<&TracedRender, With<EditorCamera>>()?;
    renders.single(world).ok()
}

/// How that is shown.
pub(super) fn traced_view(world: &World) -> Option<&TracedView> {
    let mut views = world.try_query_filtered::<&TracedView, With<EditorCamera>>()?;
    views.single(world).ok()
}

/// The same, to be changed.
pub(super) fn traced_view_mut(world: &mut World) -> Option<Mut<'_, TracedView>> {
    let mut views = world.query_filtered::<&mut TracedView, With<EditorCamera>>();
    views.single_mut(world).ok()
}

/// Dragging a frame over the picture: the region that the traced view is limited to.
#[derive(Resource, Default)]
pub(super) struct RegionDrag {
    /// The next drag over the picture is one.
    pub is_armed: bool,
    /// Where it began: (0, 0) is the picture's top left, (1, 1) opposite.
    pub start: Option<Vec2>,
}

impl RegionDrag {
    /// No frame is waited for any more. `false` where none was.
    pub fn cancel(&mut self) -> bool {
        std::mem::take(self).is_armed
    }
}

/// The part of the picture, and the numbers, that one scene was looked at for say nothing about another, which is not
/// kept waiting either.
pub(super) fn forget_scene(
    _: On<SceneOpened>,
    mut views: Query<&mut TracedView, With<EditorCamera>>,
) {
    for mut view in &mut views {
        if view.region.is_some() || view.range.is_some() {
            (view.region, view.range) = (None, None);
        }
        if view.paused {
            view.paused = false;
        }
    }
}

/// Which of the pictures is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Show {
    /// Bevy's renderer.
    Raster,
    /// The tracer.
    #[default]
    Traced,
    /// Both, side by side.
    Split,
}

/// Where the scene is shown.
#[derive(Resource, Clone, Debug)]
pub struct Viewport {
    /// In logical pixels of the window, from its top left.
    pub rect: Rect,
    /// Where the same is shown once more, as large: the right view of two trees side by side.
    pub twin: Option<Rect>,
    /// Which of the pictures is shown.
    pub show: Show,
    /// Where the split view is divided, as a part of the width.
    pub divider: f32,
    /// Whether the pointer is over the scene: not over a panel, a menu or a popup.
    pub hovered: bool,
    /// Whether function keys send commands: no question and no menu is open.
    pub takes_function_keys: bool,
    /// Whether keys are meant for the scene: nothing is being typed into.
    pub takes_keys: bool,
    /// Whether letters and digits are, too: the list of entities does not find names by them.
    pub takes_letters: bool,
}

impl Default for Viewport {
    fn default() -> Self {
        Self {
            rect: Rect::default(),
            twin: None,
            show: Show::default(),
            divider: 0.5,
            hovered: false,
            takes_function_keys: true,
            takes_keys: true,
            takes_letters: true,
        }
    }
}

impl Viewport {
    /// What lies between a place of the window and that of [`rect`](Self::rect) which shows the same: nothing but in the
    /// second view.
    pub fn offset(&self, in_window: Vec2) -> Vec2 {
        let twin = self.twin.filter(|twin| twin.contains(in_window));
        twin.map_or(Vec2::ZERO, |twin| twin.min - self.rect.min)
    }

    /// From a place in the window to one in the viewport, (0, 0) at its top left, (1, 1) opposite.
    pub fn place(&self, in_window: Vec2) -> Vec2 {
        (in_window - self.rect.min) / self.rect.size().max(Vec2::ONE)
    }

    /// What [`TracedView::divider`](crate::view::TracedView::divider) has to be.
    pub fn traced_from(&self) -> f32 {
        match self.show {
            Show::Raster => 1.0,
            Show::Traced => 0.0,
            Show::Split => self.divider.clamp(0.0, 1.0),
        }
    }
}
