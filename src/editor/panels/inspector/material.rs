//! Materials: an object's own, or one that several objects share.

use super::super::fields::{row, section};
use super::super::outline::{Kind, Outline};
use super::super::says::Says;
use super::super::several::Several;
use super::maps::Thumbnails;
use super::material_maps::{alpha_ui, maps_ui};
use super::presets::{PRESETS, Preset};
use super::switches::switches_ui;
use crate::editor::edits::{is_object, share_material};
use crate::editor::texts::counted;
use crate::scene::{Phong, PhongMaps, SceneId, UsesMaterial};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::platform::collections::HashSet;
use bevy_egui::egui::{ComboBox, Ui};
use std::sync::Arc;

/// The preset that a material was given last.
pub(super) struct ChosenPreset {
    owner: Entity,
    preset: &'static Preset,
}

pub(super) fn material_ui(
    ui: &mut Ui,
    world: &mut World,
    entities: &[Entity],
    thumbnails: &mut Thumbnails,
    chosen: &mut Option<ChosenPreset>,
) {
    let mut seen = HashSet::new();
    let owners: Vec<Entity> = entities
        .iter()
        .map(|&entity| owner_of(world, entity))
        .filter(|&owner| world.get::<Phong>(owner).is_some() && seen.insert(owner))
        .collect();
    let Some(mut several) = Several::<Phong>::of(world, &owners) else {
        return;
    };
    section(ui, "Material", true, |ui| {
        assign_ui(ui, world, entities, owners[0]);
        let says = "Sets all numbers of the material to those of a well-known one; maps stay";
        row(ui, "Preset", says, |ui| {
            ui.menu_button("Choose…", |ui| {
                for preset in PRESETS {
                    if ui.button(preset.name).says(preset.says).clicked() {
                        several.change(|phong| preset.apply(phong));
                        *chosen = Some(ChosenPreset {
                            owner: owners[0],
                            preset,
                        });
                        ui.close();
                    }
                }
            })
            .response
            .says(says);
        });
        if let Some(chosen) = chosen.as_ref().filter(|chosen| chosen.owner == owners[0]) {
            switches_ui(ui, world, chosen.preset.name, chosen.preset.needs);
        }
        fields_ui(ui, &mut several);
        let maps = world
            .get::<PhongMaps>(owners[0])
            .cloned()
            .unwrap_or_default();
        let numbers = owners
            .iter()
            .filter_map(|&owner| world.get::<SceneId>(owner));
        let numbers: Arc<[SceneId]> = numbers.copied().collect();
        maps_ui(ui, world, thumbnails, &mut several, &maps, &numbers);
    });
    several.write(world);
}

fn fields_ui(ui: &mut Ui, several: &mut Several<Phong>) {
    let numbers = ["diffuse", "specular", "mirror", "shininess", "opacity"];
    several.properties(ui, &numbers);
    alpha_ui(ui, several);
    several.properties(ui, &["emission"]);
}

/// Whose material an object shows.
fn owner_of(world: &World, entity: Entity) -> Entity {
    match world.get::<UsesMaterial>(entity) {
        Some(&UsesMaterial(owner)) if world.get::<Phong>(owner).is_some() => owner,
        _ => entity,
    }
}

/// Own or shared: which, with whom, and the way from one to the other.
fn assign_ui(ui: &mut Ui, world: &mut World, entities: &[Entity], owner: Entity) {
    let objects: Vec<Entity> = entities
        .iter()
        .copied()
        .filter(|&entity| is_object(world, entity))
        .collect();
    let count = world.resource::<Outline>().users_of(owner).len();
    if objects.is_empty() {
        ui.weak(match count {
            0 => {
                "No object has it yet: drop it onto one, in the list or in the picture.".to_owned()
            }
            1 => "One object has it.".to_owned(),
            _ => format!("{count} objects have it: a change here reaches all of them."),
        });
        return;
    }
    let is_shared = world
        .get::<UsesMaterial>(objects[0])
        .is_some_and(|uses| uses.0 == owner);
    let outline = world.resource::<Outline>();
    let its = world.get::<SceneId>(owner).filter(|_| is_shared);
    let its = its.and_then(|&id| outline.find(id));
    let current = its.map_or("Its own", |item| item.name.as_str());
    let says = "Its own, or a shared one: a change of a shared material reaches all its objects";
    let mut chosen: Option<Option<Entity>> = None;
    row(ui, "Uses", says, |ui| {
        ComboBox::from_id_salt("uses")
            .selected_text(current)
            .width(ui.available_width().max(60.0))
            .truncate()
            .show_ui(ui, |ui| {
                let own = ui.selectable_label(!is_shared, "Its own");
                if own.says("A material that no other object has").clicked() {
                    chosen = Some(None);
                }
                // Gone through while the list is open, and not in every frame.
                let materials = outline.items.iter();
                for item in materials.filter(|item| item.kind == Kind::Material) {
                    let on = is_shared && item.entity == owner;
                    let says = "A shared material: a change of it reaches all its objects";
                    if ui.selectable_label(on, &item.name).says(says).clicked() {
                        chosen = Some(Some(item.entity));
                    }
                }
            })
            .response
            .says(says);
    });
    if is_shared {
        // In a narrow panel the button is below.
        ui.horizontal_wrapped(|ui| {
            ui.weak(match count {
                1 => "Shared, and used by this object alone.".to_owned(),
                _ => format!("Shared by {}.", counted(count as u64, "object")),
            });
            let says = "Gives the selected objects a copy of their own";
            if ui.small_button("Make single").says(says).clicked() {
                make_single(world, &objects);
            }
        });
    }
    match chosen {
        Some(Some(material)) => share_material(world, &objects, material),
        Some(None) => {
            for &object in &objects {
                world.entity_mut(object).remove::<UsesMaterial>();
            }
        }
        None => {}
    }
}

/// Copies what the objects show into materials of their own.
fn make_single(world: &mut World, objects: &[Entity]) {
    for &object in objects {
        let owner = owner_of(world, object);
        if owner == object {
            continue;
        }
        let copy = world.get::<Phong>(owner).cloned();
        let mut entity = world.entity_mut(object);
        entity.remove::<UsesMaterial>();
        if let Some(copy) = copy {
            entity.insert(copy);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shared_material_made_single_is_a_copy_that_the_others_do_not_see() {
        let mut world = World::new();
        let shared = Phong {
            shininess: 77.0,
            ..Phong::default()
        };
        let material = world.spawn(shared.clone()).id();
        let objects = [0, 1].map(|_| world.spawn(Phong::default()).id());
        share_material(&mut world, &objects, material);
        assert_eq!(owner_of(&world, objects[0]), material);
        make_single(&mut world, &objects[..1]);
        assert_eq!(owner_of(&world, objects[0]), objects[0]);
        assert_eq!(world.get::<Phong>(objects[0]), Some(&shared));
        assert_eq!(owner_of(&world, objects[1]), material);
    }
}
