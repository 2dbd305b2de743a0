//! The menu of a right click, in the view and in the list: the commands whose rows ask for it.

use super::menu_bar::item_ui;
use crate::editor::command::{Command, CommandTable, Over};
use crate::editor::pick::to_points;
use crate::editor::pointer::RightClicked;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Id, LayerId, Popup, PopupKind, Pos2, SetOpenCommand};
use std::sync::Arc;

/// The menu of a right click.
#[derive(Resource, Default)]
pub(super) struct ContextMenu {
    /// A click that was not answered yet.
    clicked: Option<RightClicked>,
    /// Where it stands, and what was clicked.
    over: Option<(Pos2, Over)>,
}

/// A click with the right button that was not answered yet, in the window's logical pixels.
pub(super) fn note_right_click(clicked: On<RightClicked>, mut menu: ResMut<ContextMenu>) {
    menu.clicked = Some(*clicked);
}

pub(super) fn context_menu_ui(context: &egui::Context, world: &mut World, menu: &mut ContextMenu) {
    let id = Id::new("menu of a right click");
    let opens = menu.clicked.take();
    if let Some(RightClicked { at, over }) = opens {
        menu.over = Some((to_points(context, at), over));
    }
    let Some((at, over)) = menu.over else {
        return;
    };
    let table = world.resource::<CommandTable>().rows().iter();
    let rows: Vec<Arc<Command>> = table
        .filter(|row| row.over.contains(&over))
        .cloned()
        .collect();
    Popup::new(id, context.clone(), at, LayerId::background())
        .kind(PopupKind::Menu)
        .open_memory(opens.map(|_| SetOpenCommand::Bool(true)))
        .show(|ui| {
            ui.set_min_width(190.0);
            for row in &rows {
                item_ui(ui, world, row);
            }
        });
    if !Popup::is_id_open(context, id) {
        menu.over = None;
    }
}
