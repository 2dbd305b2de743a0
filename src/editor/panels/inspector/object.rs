//! The tab Object: name, place and components of what is selected.

use super::super::fields::row;
use super::super::kind_icons::kind_ui;
use super::super::outline::{Kind, Outline};
use super::super::renaming::{Renaming, settle_name};
use super::super::says::Says;
use super::{Inspector, camera, foreign, lamps, material, motion, shape, transform};
use crate::editor::selection::Selection;
use crate::scene::SceneId;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy_egui::egui::{Id, TextEdit, Ui};

pub(super) fn object_ui(ui: &mut Ui, world: &mut World, panel: &mut Inspector) {
    let outline = world.resource::<Outline>();
    let selection = world.resource::<Selection>();
    let Some(active) = selection.active().and_then(|id| outline.find(id)) else {
        ui.weak("Nothing is selected. Click an object in the picture or a row in the list.");
        return;
    };
    let active = active.clone();
    // The active one first: fields show its values.
    let mut entities: Vec<Entity> = selection
        .ids()
        .iter()
        .rev()
        .filter_map(|&id| Some(outline.find(id)?.entity))
        .collect();
    entities.retain(|&entity| world.get_entity(entity).is_ok());
    if entities.is_empty() {
        return;
    }
    let others = entities.len() - 1;
    // A line that is longer than the panel would make all of it wider.
    ui.horizontal_wrapped(|ui| {
        kind_ui(ui, active.kind);
        ui.strong(active.kind.name());
        if others > 0 {
            ui.weak(format!("and {others} more: fields change all of them"));
        }
    });
    row(
        ui,
        "Name",
        "What the list calls it; also kept in files",
        |ui| {
            let mut text = panel
                .naming
                .as_ref()
                .filter(|naming| naming.id == active.id)
                .map_or_else(|| active.name.clone(), |naming| naming.text.clone());
            let field = TextEdit::singleline(&mut text)
                .id(name_field(active.id))
                .char_limit(200)
                .desired_width(ui.available_width());
            let response = ui
                .add(field)
                .says("What the list calls it; also kept in files");
            if response.changed() {
                panel.naming = Some(Renaming {
                    id: active.id,
                    text,
                    focused: true,
                });
            }
            if response.lost_focus() {
                settle_name(ui.ctx(), world, &mut panel.naming, name_field);
            }
        },
    );
    ui.add_space(4.0);
    if active.kind != Kind::Material {
        transform::transform_ui(ui, world, &entities);
    }
    lamps::lamps_ui(ui, world, &entities);
    camera::camera_ui(ui, world, &entities);
    shape::shape_ui(ui, world, &entities);
    material::material_ui(
        ui,
        world,
        &entities,
        &mut panel.thumbnails,
        &mut panel.preset,
    );
    motion::motion_ui(ui, world, &entities);
    foreign::foreign_ui(ui, world, &entities);
}

/// The field for an entity's name.
pub(super) fn name_field(id: SceneId) -> Id {
    Id::new(("name in the inspector", id.0))
}
