//! What entities carry besides the scene's: components of the app's own, a section each, and Bevy's, which are shown.

use super::super::fields::section;
use super::super::palette::score;
use super::super::reflected::{Reflected, short_text};
use super::super::says::Says;
use crate::editor::foreign::{Origin, first_value, foreign_kinds, is_same, origin};
use crate::editor::history::Kinds;
use crate::io::keeps;
use crate::scene::schema::{Property, about_type};
use bevy::ecs::entity::Entity;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::ecs::world::{Mut, World};
use bevy::reflect::{PartialReflect, Reflect, ReflectPath, TypeInfo, TypeRegistration};
use bevy_egui::egui::{Id, Label, Popup, PopupCloseBehavior, RichText, ScrollArea, TextEdit, Ui};

pub(super) fn foreign_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    world.resource_scope(|world, kinds: Mut<Kinds>| {
        let mut any = false;
        for (place, kind) in kinds.foreign() {
            any = true;
            component_ui(ui, world, entities, &kinds, (place, kind));
        }
        if any {
            add_ui(ui, world, entities, &kinds);
        }
    });
    shown_ui(ui, world, entities[0]);
}

fn name(info: &TypeInfo) -> &'static str {
    info.type_path_table().short_path()
}

/// The section of a component, where any of the entities has it.
fn component_ui(
    ui: &mut Ui,
    world: &mut World,
    entities: &[Entity],
    kinds: &Kinds,
    (place, kind): (usize, &TypeRegistration),
) {
    let copy = |&entity: &Entity| Some((entity, kinds.clone_at(world, entity, place)?));
    let mut copies: Vec<(Entity, Box<dyn Reflect>)> = entities.iter().filter_map(copy).collect();
    let Some(((_, active), others)) = copies.split_first_mut() else {
        return;
    };
    let before = others
        .iter()
        .map(|(_, other)| other.reflect_clone())
        .collect::<Result<Vec<_>, _>>();
    let of_active = active.reflect_clone();
    let is_mixed = |path: &str| {
        let (Ok(active), Ok(others)) = (&of_active, &before) else {
            return false;
        };
        let active = path.reflect_element(active.as_partial_reflect());
        let differs = |other: &dyn Reflect| {
            let other = path.reflect_element(other.as_partial_reflect());
            match (&active, other) {
                (Ok(active), Ok(other)) => !is_same(*active, other),
                _ => false,
            }
        };
        others.iter().any(|other| differs(&**other))
    };
    let info = kind.type_info();
    let mut changed = None;
    let (mut is_removed, mut is_completed) = (false, false);
    let missing = entities.len() - 1 - others.len();
    section(ui, name(info), true, |ui| {
        let about = about_type(info);
        if !about.is_empty() {
            ui.weak(about);
        }
        let reflected = Reflected {
            registry: kinds.registry(),
            is_mixed: &is_mixed,
        };
        let whole = Property::root(info);
        ui.push_id(info.type_path(), |ui| {
            changed = reflected.parts_ui(ui, active.as_partial_reflect_mut(), &whole, 0);
        });
        ui.horizontal(|ui| {
            is_removed = ui.small_button("Remove").says("Takes it away").clicked();
            if missing > 0 {
                let text = format!("Add to the other {missing}");
                let says = "Gives the others a copy of this one";
                is_completed = ui.small_button(text).says(says).clicked();
            }
            if !keeps(world, kind.type_id()) {
                ui.weak("not in scene files")
                    .says("The app has to ask for it: app.keep_in_scene_files::<…>()");
            }
        });
    });
    if let Some(path) = &changed
        && let Ok(entered) = path.as_str().reflect_element(active.as_partial_reflect())
    {
        for (_, other) in others {
            if let Ok(place) = path
                .as_str()
                .reflect_element_mut(other.as_partial_reflect_mut())
            {
                assign(place, entered);
            }
        }
    }
    let first = is_completed
        .then(|| copies[0].1.reflect_clone().ok())
        .flatten();
    for &entity in entities {
        let Ok(mut entity) = world.get_entity_mut(entity) else {
            continue;
        };
        let own = copies.iter().find(|(of, _)| *of == entity.id());
        match (own, &first) {
            (Some(_), _) if is_removed => kinds.remove(&mut entity, place),
            (Some((_, value)), _) if changed.is_some() => {
                kinds.insert(&mut entity, place, value.as_ref());
            }
            (None, Some(first)) => kinds.insert(&mut entity, place, first.as_ref()),
            _ => {}
        }
    }
}

/// Makes a part what another one is: a list loses what is too many, too.
fn assign(place: &mut dyn PartialReflect, value: &dyn PartialReflect) {
    let set = match (place.try_as_reflect_mut(), value.reflect_clone()) {
        (Some(place), Ok(value)) => place.set(value).is_ok(),
        _ => false,
    };
    if !set {
        // It fails only for another type, and these are parts of the same one.
        let _ = place.try_apply(value);
    }
}

/// The menu of what can be added, with a field to search in.
fn add_ui(ui: &mut Ui, world: &mut World, entities: &[Entity], kinds: &Kinds) {
    let button = ui
        .button("Add component…")
        .says("Gives what is selected a component of the app's own");
    let id = Id::new("search of components");
    let mut chosen = None;
    Popup::menu(&button)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| {
            ui.set_min_width(220.0);
            let mut text: String = ui.data_mut(|data| data.get_temp(id)).unwrap_or_default();
            ui.add(TextEdit::singleline(&mut text).hint_text("Find a component"))
                .request_focus();
            let missing = |(place, kind): (usize, &TypeRegistration)| {
                let is_missing = |&entity| kinds.clone_at(world, entity, place).is_none();
                let score = score(&text, name(kind.type_info()))?;
                let is_wanted = entities.iter().any(is_missing);
                is_wanted.then(|| (score, place, kind.clone()))
            };
            let mut found: Vec<_> = kinds.foreign().filter_map(missing).collect();
            found.sort_by_key(|(score, ..)| -score);
            if found.is_empty() {
                ui.weak("There is no other.");
            }
            ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
                for (_, place, kind) in found {
                    let value = first_value(world, &kind);
                    let info = kind.type_info();
                    let says = match value {
                        Some(_) => info.type_path().to_owned(),
                        None => format!(
                            "{} has no value to begin with: #[reflect(Default)] would say one",
                            info.type_path()
                        ),
                    };
                    let item = bevy_egui::egui::Button::new(name(info));
                    if ui.add_enabled(value.is_some(), item).says(&says).clicked() {
                        chosen = value.map(|value| (place, value));
                        ui.close();
                    }
                }
            });
            ui.data_mut(|data| data.insert_temp(id, text));
        });
    if let Some((place, value)) = chosen {
        ui.data_mut(|data| data.remove::<String>(id));
        for &entity in entities {
            kinds.insert_missing(&mut world.entity_mut(entity), place, value.as_ref());
        }
    }
}

/// What is shown and cannot be edited: what Bevy keeps of the active one, and what no value can be made of.
fn shown_ui(ui: &mut Ui, world: &World, active: Entity) {
    section(ui, "Other components", false, |ui| {
        let (Ok(entity), Some(registry)) = (
            world.get_entity(active),
            world.get_resource::<AppTypeRegistry>(),
        ) else {
            return;
        };
        let registry = registry.read();
        let editable = foreign_kinds(world);
        let is_shown = |kind: &&TypeRegistration| match origin(kind.type_info()) {
            Origin::Engine => true,
            Origin::App => editable
                .iter()
                .all(|other| other.type_id() != kind.type_id()),
            Origin::Glassbox => false,
        };
        let mut shown: Vec<(&str, &str, String)> = registry
            .iter()
            .filter(is_shown)
            .filter_map(|kind| {
                let value = kind.data::<ReflectComponent>()?.reflect(entity)?;
                let value = short_text(value.as_partial_reflect());
                let info = kind.type_info();
                Some((name(info), info.type_path(), value))
            })
            .collect();
        shown.sort_unstable();
        for (name, path, value) in shown {
            ui.add(Label::new(name).truncate()).says(path);
            ui.add(Label::new(RichText::new(&value).weak()).truncate());
        }
    });
}
