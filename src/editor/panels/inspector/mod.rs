//! The properties: of what is selected, of the rendering, of what the gizmos show, of the trees.

mod boxes;
mod builders;
mod bvh;
mod camera;
mod debug;
mod environment;
mod error_plot;
mod figure_table;
mod foreign;
mod gizmos;
mod lamps;
mod maps;
mod material;
mod material_maps;
mod measuring;
mod motion;
mod object;
mod pair;
mod performance;
mod presets;
mod render;
mod shape;
mod still_plot;
mod switches;
mod transform;

use super::number_field::set_owner;
use super::renaming::{Renaming, settle_name};
use super::says::Says;
use crate::editor::action::Action;
use crate::editor::command::{find, tooltip};
use crate::editor::document::SceneOpened;
use crate::editor::selection::Selection;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, ScrollArea, Ui};

pub(super) use builders::Builders;
pub(super) use bvh::Trees;
pub(super) use error_plot::ErrorCurve;
use maps::Thumbnails;
pub(super) use maps::forget_thumbnails;
pub(super) use performance::PerformanceForm;

/// The inspector's tabs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Tab {
    #[default]
    Object,
    Render,
    Debug,
    Bvh,
}

/// What the inspector remembers between two frames.
#[derive(Resource, Default)]
pub(super) struct Inspector {
    pub tab: Tab,
    /// A name that is being typed.
    naming: Option<Renaming>,
    preset: Option<material::ChosenPreset>,
    thumbnails: Thumbnails,
}

/// Another scene was opened: the numbers of its entities are those of others.
pub(super) fn forget_scene(
    _: On<SceneOpened>,
    mut panel: ResMut<Inspector>,
    mut trees: ResMut<Trees>,
) {
    *trees = Trees::default();
    panel.naming = None;
    panel.preset = None;
    panel.thumbnails.forget_fields();
}

/// What was typed into a field that is drawn no more, and what was chosen in a file dialog, reaches
/// those for whom it was meant: another object may be selected by now.
pub(super) fn settle(context: &egui::Context, world: &mut World, panel: &mut Inspector) {
    settle_name(context, world, &mut panel.naming, object::name_field);
    maps::settle_pictures(context, world, &mut panel.thumbnails);
}

pub(super) fn inspector_ui(ui: &mut Ui, world: &mut World, panel: &mut Inspector) {
    ui.horizontal(|ui| {
        for (tab, name, says) in [
            (Tab::Object, "Object", "What is selected"),
            (
                Tab::Render,
                "Render",
                "How the scene is rendered, and its environment",
            ),
            (
                Tab::Debug,
                "Debug",
                "What is drawn over the picture, and how the error falls",
            ),
            (Tab::Bvh, "BVH", "The trees that rays walk"),
        ] {
            ui.selectable_value(&mut panel.tab, tab, name).says(says);
        }
    });
    ui.separator();
    let selected = world.resource::<Selection>().ids();
    set_owner(ui.ctx(), (panel.tab as u8, selected));
    ScrollArea::vertical()
        .id_salt(panel.tab as u8)
        .auto_shrink([false, false])
        .show(ui, |ui| match panel.tab {
            Tab::Object => object::object_ui(ui, world, panel),
            Tab::Render => render::render_ui(ui, world, &mut panel.thumbnails),
            Tab::Debug => debug::debug_ui(ui, world),
            Tab::Bvh => bvh::bvh_ui(ui, world),
        });
}

/// A button that runs a command; faint where that cannot be run.
fn command_button(ui: &mut Ui, world: &mut World, id: &'static str) {
    let Some(command) = find(world, id) else {
        return;
    };
    let ready = command.state_in(world).why_not.is_none();
    let button = ui.add_enabled(ready, egui::Button::new(&*command.name));
    if button.says(&tooltip(world, id)).clicked() {
        world.write_message(Action::run(id));
    }
}
