//! The menus above, made of the table of commands: a row says in which menus it stands. Beside the
//! rows there is only what depends on the scene: recent files, cameras, the field of view.

use super::fields::number_row;
use super::says::Says;
use crate::editor::action::Action;
use crate::editor::command::{Command, CommandTable, shortcut};
use crate::editor::navigation::{LookThrough, field_of_view, set_field_of_view};
use crate::editor::preferences::Preferences;
use crate::editor::texts::{file_name, path_text};
use crate::scene::{Quantity, SceneCamera, SceneId};
use bevy::ecs::name::Name;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Button, Ui};
use std::sync::Arc;

/// Menus that come first; others follow in the order in which rows name them, and Help is last.
const FIRST: [&str; 4] = ["File", "Edit", "Add", "View"];
const LAST: &str = "Help";

pub(super) fn menu_bar_ui(ui: &mut Ui, world: &mut World) {
    let mut menus = FIRST.to_vec();
    for row in world.resource::<CommandTable>().rows() {
        for (path, _) in &row.menus {
            let menu = path.split('/').next().unwrap_or(path);
            if menu != LAST && !menus.contains(&menu) {
                menus.push(menu);
            }
        }
    }
    menus.push(LAST);
    egui::MenuBar::new().ui(ui, |ui| {
        for menu in menus {
            ui.menu_button(menu, |ui| menu_ui(ui, world, menu));
        }
    });
}

/// What stands in a menu.
enum Entry {
    Row(Arc<Command>),
    /// A menu within, by its whole path.
    Menu(String),
}

/// The rows of a menu, lines between groups, and menus within it.
pub(super) fn menu_ui(ui: &mut Ui, world: &mut World, path: &str) {
    let mut entries: Vec<(u8, Entry)> = Vec::new();
    let mut within: Vec<String> = Vec::new();
    for row in world.resource::<CommandTable>().rows() {
        for &(place, group) in &row.menus {
            if place == path {
                entries.push((group, Entry::Row(row.clone())));
            } else if let Some(rest) = place.strip_prefix(path)
                && let Some(name) = rest.strip_prefix('/')
            {
                let name = name.split('/').next().unwrap_or(name);
                let menu = format!("{path}/{name}");
                if !within.contains(&menu) {
                    within.push(menu.clone());
                    entries.push((group, Entry::Menu(menu)));
                }
            }
        }
    }
    entries.sort_by_key(|(group, _)| *group);
    for (i, (group, entry)) in entries.iter().enumerate() {
        match entry {
            Entry::Row(row) => {
                item_ui(ui, world, row);
            }
            Entry::Menu(menu) => {
                let name = menu.rsplit('/').next().unwrap_or(menu);
                ui.menu_button(name, |ui| menu_ui(ui, world, menu));
            }
        }
        let next = entries.get(i + 1).map(|(next, _)| next);
        if next != Some(group) {
            match (path, group) {
                ("File", 0) => recent_ui(ui, world),
                ("View", 3) => {
                    ui.menu_button("Look through", |ui| look_through_ui(ui, world));
                    field_of_view_ui(ui, world);
                }
                _ => {}
            }
            if next.is_some() {
                ui.separator();
            }
        }
    }
}

/// One command: its name, its keys, whether it is on; grey with the reason where it cannot be run. True where it was
/// clicked.
pub(super) fn item_ui(ui: &mut Ui, world: &mut World, command: &Command) -> bool {
    let state = command.state_in(world);
    let mut button = Button::selectable(state.on == Some(true), command.title(&state));
    if let Some(keys) = shortcut(world, command) {
        button = button.shortcut_text(keys);
    }
    let says = state.why_not.as_deref().unwrap_or(&command.help);
    let ready = state.why_not.is_none();
    let clicked = ui.add_enabled(ready, button).says(says).clicked();
    if clicked {
        world.write_message(Action::Run(command.id.clone()));
        ui.close();
    }
    clicked
}

/// What is no row: a file, or a camera, which `is_on` where it is looked through.
fn other_ui(
    ui: &mut Ui,
    world: &mut World,
    (name, is_on): (&str, bool),
    says: &str,
    action: Action,
) {
    let button = Button::selectable(is_on, name);
    if ui.add(button).says(says).clicked() {
        world.write_message(action);
        ui.close();
    }
}

fn recent_ui(ui: &mut Ui, world: &mut World) {
    let recent = world.resource::<Preferences>().recent.clone();
    ui.add_enabled_ui(!recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            for file in recent {
                let (name, says) = (file_name(&file), path_text(&file));
                other_ui(ui, world, (&name, false), &says, Action::Open(file));
            }
        });
    });
}

/// Of the camera that is looked through, else of the view.
fn field_of_view_ui(ui: &mut Ui, world: &mut World) {
    let Some(mut fov) = field_of_view(world) else {
        return;
    };
    let says = "The angle from the picture's lower to its upper edge: the looked-through camera's, or the view's own";
    let angles = Quantity::degrees(1.0, 170.0);
    let row = ui.scope(|ui| {
        ui.set_width(240.0);
        number_row(ui, "Field of view", says, &mut fov, angles)
    });
    if row.inner {
        set_field_of_view(world, fov);
    }
}

/// The scene's cameras.
fn look_through_ui(ui: &mut Ui, world: &mut World) {
    let says = "Leaves the camera: the view moves freely again";
    let now = world.resource::<LookThrough>().camera;
    let free = ("Free view", now.is_none());
    other_ui(ui, world, free, says, Action::LookThrough(None));
    for (id, name) in cameras(world) {
        let says = "Shows the scene as this camera sees it, with its lens and its shutter";
        other_ui(
            ui,
            world,
            (&name, now == Some(id)),
            says,
            Action::LookThrough(Some(id)),
        );
    }
}

/// Numbers and names of the scene's cameras.
pub(super) fn cameras(world: &mut World) -> Vec<(SceneId, String)> {
    let mut query = world.query::<(&SceneId, &SceneCamera, Option<&Name>)>();
    let mut cameras: Vec<(SceneId, String)> = query
        .iter(world)
        .map(|(id, _, name)| {
            let name = name.map_or_else(|| format!("camera {}", id.0), |name| name.to_string());
            (*id, name)
        })
        .collect();
    cameras.sort();
    cameras
}
