//! File, Edit, Add, View, Help. Entries, keys and explanations are those of the table of actions.

use super::fields::number_row;
use super::says::Says;
use super::state::{Dialog, Panels};
use crate::editor::action::{Action, Addition, Axis, shapes};
use crate::editor::history::History;
use crate::editor::navigation::{field_of_view, set_field_of_view};
use crate::editor::preferences::Preferences;
use crate::editor::selection::Selection;
use crate::editor::texts::path_text;
use crate::inspect::{InspectPreset, InspectSettings};
use crate::scene::{Quantity, SceneCamera, SceneId};
use bevy::ecs::name::Name;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Button, Ui};

pub(super) fn menu_bar_ui(ui: &mut Ui, world: &mut World, panels: &mut Panels) {
    egui::MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file_ui(ui, world, panels));
        ui.menu_button("Edit", |ui| edit_ui(ui, world, panels));
        ui.menu_button("Add", |ui| add_ui(ui, world));
        ui.menu_button("View", |ui| view_ui(ui, world));
        ui.menu_button("Help", |ui| help_ui(ui, world, panels));
    });
}

/// An entry of the table of actions.
pub(super) fn entry_ui(ui: &mut Ui, world: &mut World, action: &Action) {
    entry_if(ui, world, action, true, None);
}

/// The same, grey where it would do nothing, with another name where there is a better one.
fn entry_if(ui: &mut Ui, world: &mut World, action: &Action, enabled: bool, name: Option<String>) {
    let Some(entry) = action.entry() else {
        return;
    };
    let name = name.unwrap_or_else(|| entry.name.to_owned());
    let mut button = Button::new(name);
    if let Some(keys) = entry.keys.first() {
        button = button.shortcut_text(keys.text());
    }
    if ui.add_enabled(enabled, button).says(entry.says).clicked() {
        world.write_message(action.clone());
        ui.close();
    }
}

/// An action with parameters.
fn item_ui(ui: &mut Ui, world: &mut World, name: &str, says: &str, action: Action) {
    if ui.button(name).says(says).clicked() {
        world.write_message(action);
        ui.close();
    }
}

fn file_ui(ui: &mut Ui, world: &mut World, panels: &mut Panels) {
    entry_ui(ui, world, &Action::New);
    entry_ui(ui, world, &Action::OpenDialog);
    let recent = world.resource::<Preferences>().recent.clone();
    ui.add_enabled_ui(!recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            for file in recent {
                let name = file.file_name().map_or_else(
                    || file.display().to_string(),
                    |name| name.to_string_lossy().into_owned(),
                );
                let says = path_text(&file);
                item_ui(ui, world, &name, &says, Action::Open(file));
            }
        });
    });
    if ui
        .button("Built-in scenes…")
        .says("Opens one of the scenes that come with Glassbox")
        .clicked()
    {
        panels.dialog = Some(Dialog::Scenes);
        ui.close();
    }
    entry_ui(ui, world, &Action::ImportDialog);
    ui.separator();
    entry_ui(ui, world, &Action::Save);
    entry_ui(ui, world, &Action::SaveAsDialog);
    ui.separator();
    entry_ui(ui, world, &Action::RenderDialog);
    ui.separator();
    if ui
        .button("Preferences…")
        .says("Theme and size of the panels")
        .clicked()
    {
        panels.dialog = Some(Dialog::Preferences);
        ui.close();
    }
    entry_ui(ui, world, &Action::Quit);
}

fn edit_ui(ui: &mut Ui, world: &mut World, panels: &mut Panels) {
    let selected = !world.resource::<Selection>().is_empty();
    let history = world.resource::<History>();
    let undo = history.undo_text().map(|text| format!("Undo: {text}"));
    let redo = history.redo_text().map(|text| format!("Redo: {text}"));
    entry_if(ui, world, &Action::Undo, undo.is_some(), undo);
    entry_if(ui, world, &Action::Redo, redo.is_some(), redo);
    if ui
        .button("History…")
        .says("All steps, to go back and forth between")
        .clicked()
    {
        panels.dialog = Some(Dialog::History);
        ui.close();
    }
    ui.separator();
    entry_if(ui, world, &Action::Copy, selected, None);
    entry_ui(ui, world, &Action::Paste);
    entry_if(ui, world, &Action::Duplicate, selected, None);
    entry_if(ui, world, &Action::Delete, selected, None);
    entry_if(ui, world, &Action::ToggleVisible, selected, None);
    ui.separator();
    entry_ui(ui, world, &Action::SelectAll);
    entry_if(ui, world, &Action::SelectNone, selected, None);
}

fn add_ui(ui: &mut Ui, world: &mut World) {
    ui.menu_button("Shape", |ui| {
        for (name, _) in shapes() {
            let addition = Addition::Shape(name.into());
            item_ui(
                ui,
                world,
                name,
                "Adds the shape at what the view looks at",
                Action::Add(addition),
            );
        }
    });
    entry_ui(ui, world, &Action::ImportDialog);
    ui.separator();
    for (name, says, addition) in [
        (
            "Point light",
            "Shines in all directions from one point; with a cone it is a spot",
            Addition::PointLamp,
        ),
        (
            "Directional light",
            "Shines from infinitely far, like the sun",
            Addition::DirectionalLamp,
        ),
        (
            "Segment light",
            "A glowing line with a colour at each end: soft shadows",
            Addition::SegmentLamp,
        ),
        (
            "Parallelogram light",
            "A glowing surface with a colour at each corner: soft shadows",
            Addition::ParallelogramLamp,
        ),
    ] {
        item_ui(ui, world, name, says, Action::Add(addition));
    }
    ui.separator();
    for (name, says, addition) in [
        ("Camera", "Adds a camera", Addition::Camera),
        (
            "Shared material",
            "A material that several objects can use: one change reaches all of them",
            Addition::Material,
        ),
        (
            "Group",
            "An empty place: what is dragged onto it in the list moves with it",
            Addition::Group,
        ),
    ] {
        item_ui(ui, world, name, says, Action::Add(addition));
    }
}

fn view_ui(ui: &mut Ui, world: &mut World) {
    for action in [Action::ShowRaster, Action::ShowTraced, Action::ShowSplit] {
        entry_ui(ui, world, &action);
    }
    ui.separator();
    entry_ui(ui, world, &Action::TogglePause);
    entry_ui(ui, world, &Action::Restart);
    ui.separator();
    entry_ui(ui, world, &Action::FrameSelected);
    entry_ui(ui, world, &Action::FrameAll);
    entry_ui(ui, world, &Action::ToggleProjection);
    ui.menu_button("Look along", |ui| {
        for (name, axis) in [
            ("Front", Axis::Front),
            ("Back", Axis::Back),
            ("Left", Axis::Left),
            ("Right", Axis::Right),
            ("Top", Axis::Top),
            ("Bottom", Axis::Bottom),
        ] {
            let says = "Looks at the scene from this side, along an axis";
            item_ui(ui, world, name, says, Action::LookAlong(axis));
        }
    });
    ui.menu_button("Look through", |ui| look_through_ui(ui, world));
    entry_ui(ui, world, &Action::ToggleCamera);
    entry_ui(ui, world, &Action::ToggleLock);
    entry_ui(ui, world, &Action::AddBookmark);
    field_of_view_ui(ui, world);
    ui.separator();
    ui.menu_button("Rays and trees", |ui| lines_ui(ui, world));
    ui.separator();
    let mut preferences = world.resource::<Preferences>().clone();
    let before = preferences.clone();
    ui.checkbox(&mut preferences.show_hierarchy, "Hierarchy")
        .says("Shows the list of entities on the left");
    ui.checkbox(&mut preferences.show_inspector, "Inspector")
        .says("Shows the properties on the right");
    entry_ui(ui, world, &Action::TogglePanels);
    let keys = Action::ToggleRays
        .entry()
        .and_then(|entry| entry.keys.first());
    let name = keys.map_or_else(
        || "Ray inspector".to_owned(),
        |keys| format!("Ray inspector ({})", keys.text()),
    );
    ui.checkbox(&mut preferences.show_rays, name)
        .says("The debug ray's rays as a tree with all their numbers, below the picture");
    if preferences != before {
        *world.resource_mut::<Preferences>() = preferences;
    }
}

/// What is drawn of rays and trees: the questions that have a ready answer, and two trees at once.
pub(super) fn lines_ui(ui: &mut Ui, world: &mut World) {
    let Some(inspect) = world.get_resource::<InspectSettings>().cloned() else {
        return;
    };
    let mut on = inspect.on;
    let entry = Action::ToggleGizmos.entry();
    let keys = entry.and_then(|entry| entry.keys.first());
    let keys = keys.map_or_else(String::new, |keys| format!(" ({})", keys.text()));
    let toggle = ui.checkbox(&mut on, format!("Show the tracer's lines{keys}"));
    if toggle.says(entry.map_or("", |entry| entry.says)).clicked() {
        world.write_message(Action::ToggleGizmos);
    }
    ui.separator();
    for preset in InspectPreset::ALL {
        if let Some(entry) = Action::Inspect(preset).entry() {
            item_ui(
                ui,
                world,
                entry.name,
                preset.says(),
                Action::Inspect(preset),
            );
        }
    }
    ui.separator();
    let mut pair = inspect.pair.on && inspect.on;
    let says = "The boxes of one builder's trees on the left of the view, of another's on the right (tab BVH)";
    if ui
        .checkbox(&mut pair, "Two trees side by side")
        .says(says)
        .clicked()
    {
        let mut inspect = world.resource_mut::<InspectSettings>();
        inspect.pair.on = pair;
        if pair {
            // Nothing would be seen else.
            (inspect.on, inspect.boxes.on) = (true, true);
        }
    }
}

/// Of the camera that is looked through, else of the view.
fn field_of_view_ui(ui: &mut Ui, world: &mut World) {
    let Some(mut fov) = field_of_view(world) else {
        return;
    };
    ui.set_min_width(230.0);
    let says = "The angle from the picture's lower to its upper edge: the looked-through camera's, or the view's own";
    if number_row(
        ui,
        "Field of view",
        says,
        &mut fov,
        Quantity::degrees(1.0, 170.0),
    ) {
        set_field_of_view(world, fov);
    }
}

/// The scene's cameras.
fn look_through_ui(ui: &mut Ui, world: &mut World) {
    let says = "Leaves the camera: the view moves freely again";
    item_ui(ui, world, "Free view", says, Action::LookThrough(None));
    for (id, name) in cameras(world) {
        let says = "Shows the scene as this camera sees it, with its lens and its shutter";
        item_ui(ui, world, &name, says, Action::LookThrough(Some(id)));
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

fn help_ui(ui: &mut Ui, world: &mut World, panels: &mut Panels) {
    entry_ui(ui, world, &Action::ToggleHelp);
    if ui
        .button("About Glassbox")
        .says("Version, licences, and what it is made with")
        .clicked()
    {
        panels.dialog = Some(Dialog::About);
        ui.close();
    }
}
