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
use bevy_egui::egui::containers::menu::menu_style;
use bevy_egui::egui::{self, Align, Id, LayerId, Layout, Popup, PopupKind, Pos2, SetOpenCommand};
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
    let rows =
        table.filter(|row| row.over.contains(&over) || is_pixel && row.over.contains(&Over::Pixel));
    let groups = groups_of(rows);
    let mut chosen = false;
    Popup::new(id, context.clone(), at, LayerId::background())
        .kind(PopupKind::Menu)
        // As the menus above: keys end at one edge.
        .layout(Layout::top_down_justified(Align::Min))
        .style(menu_style)
        .open_memory(opens.map(|_| SetOpenCommand::Bool(true)))
        .show(|ui| {
            ui.set_min_width(190.0);
            for (i, group) in groups.iter().enumerate() {
                if i > 0 {
                    ui.separator();
                }
                for row in group {
                    chosen |= item_ui(ui, world, row);
                }
            }
        });
    menu.chosen_at = (chosen && is_pixel).then_some(in_window);
    if !Popup::is_id_open(context, id) {
        menu.over = None;
    }
}

/// What stands together in the menus above stands together here too, in the order in which groups begin.
fn groups_of<'a>(rows: impl Iterator<Item = &'a Arc<Command>>) -> Vec<Vec<Arc<Command>>> {
    let mut groups: Vec<Vec<Arc<Command>>> = Vec::new();
    for row in rows {
        let is_beside =
            |group: &&mut Vec<Arc<Command>>| group[0].menus.first() == row.menus.first();
        match groups.iter_mut().find(is_beside) {
            Some(group) => group.push(row.clone()),
            None => groups.push(vec![row.clone()]),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::panels::tests::{Desk, texts};
    use crate::editor::selection::Selection;

    #[test]
    fn rows_stand_in_the_groups_of_the_menus_above_and_their_keys_end_at_one_edge() {
        let mut desk = Desk::open("cornell-box");
        let (_, id) = desk.named("Short block");
        desk.world().resource_mut::<Selection>().set([id]);
        let (at, over) = (Vec2::new(640.0, 100.0), Over::Entity);
        desk.world().trigger(RightClicked { at, over });
        desk.settle();
        let all = texts(&desk);
        let edge = |keys: &str| {
            let mut found = all.iter().filter(|(text, place, _)| {
                text == keys && place.left() > at.x && place.top() > at.y
            });
            let (_, place, _) = found
                .next()
                .unwrap_or_else(|| panic!("{keys} is not shown"));
            place.right()
        };
        let right = edge("Ctrl+C");
        for keys in ["Ctrl+D", "Ctrl+G", "F2", "H"] {
            assert!((edge(keys) - right).abs() < 1.0, "{keys}: {}", edge(keys));
        }
        // Editing before asking, though the tables come in another order.
        let height = |text: &str| desk.place_of(text).y;
        assert!(height("Rename") < height("Select what shares its material"));
        let step = height("Paste") - height("Copy");
        let gap = height("Why is this pixel black?") - height("Select what shares its material");
        assert!(gap > step, "a line is between groups: {gap}, {step}");
    }
}
