//! The menu of a right click, in the view and in the list: the commands whose rows ask for it.

use super::menu_bar::item_ui;
use crate::editor::command::{Command, CommandTable, Over};
use crate::editor::pick::to_points;
use crate::editor::pointer::RightClicked;
use crate::editor::viewport::Viewport;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy::math::Vec2;
use bevy_egui::egui::{self, Id, LayerId, Popup, PopupKind, Pos2, SetOpenCommand};
use std::sync::Arc;

/// The menu of a right click.
#[derive(Resource, Default)]
pub(super) struct ContextMenu {
    /// A click that was not answered yet.
    clicked: Option<RightClicked>,
    /// Where it stands, and what was clicked.
    over: Option<(Pos2, Over)>,
    /// The place that the command is about which was chosen from it in this frame, in the window's logical pixels.
    chosen_at: Option<Vec2>,
}

impl ContextMenu {
    /// Where the click was that a command is about; `None` where the command came another way.
    pub fn chosen_at(&self) -> Option<Vec2> {
        self.chosen_at
    }
}

/// A click with the right button that was not answered yet, in the window's logical pixels.
pub(super) fn note_right_click(clicked: On<RightClicked>, mut menu: ResMut<ContextMenu>) {
    menu.clicked = Some(*clicked);
}

pub(super) fn context_menu_ui(context: &egui::Context, world: &mut World, menu: &mut ContextMenu) {
    let id = Id::new("menu of a right click");
    let opens = menu.clicked.take();
    menu.chosen_at = None;
    if let Some(RightClicked { at, over }) = opens {
        menu.over = Some((to_points(context, at), over));
    }
    let Some((at, over)) = menu.over else {
        return;
    };
    let zoom = context.zoom_factor();
    let in_window = Vec2::new(at.x, at.y) * zoom;
    let viewport = world.resource::<Viewport>();
    let is_pixel = [Some(viewport.rect), viewport.twin]
        .iter()
        .flatten()
        .any(|view| view.contains(in_window));
    let table = world.resource::<CommandTable>().rows().iter();
    let rows: Vec<Arc<Command>> = table
        .filter(|row| row.over.contains(&over) || is_pixel && row.over.contains(&Over::Pixel))
        .cloned()
        .collect();
    let mut chosen = false;
    Popup::new(id, context.clone(), at, LayerId::background())
        .kind(PopupKind::Menu)
        .open_memory(opens.map(|_| SetOpenCommand::Bool(true)))
        .show(|ui| {
            ui.set_min_width(190.0);
            for row in &rows {
                chosen |= item_ui(ui, world, row);
            }
        });
    menu.chosen_at = (chosen && is_pixel).then_some(in_window);
    if !Popup::is_id_open(context, id) {
        menu.over = None;
    }
}
