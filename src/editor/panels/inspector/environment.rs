//! What a ray carries that meets nothing: a colour, or a picture around the scene.

use super::super::fields::{properties_ui, section};
use super::maps::{Map, Owner, Thumbnails, map_ui};
use crate::scene::schema::Property;
use crate::scene::{Environment, EnvironmentMap};
use bevy::ecs::world::World;
use bevy::reflect::Typed;
use bevy_egui::egui::Ui;

pub(super) fn environment_ui(ui: &mut Ui, world: &mut World, thumbnails: &mut Thumbnails) {
    let before = world.resource::<Environment>().clone();
    let mut environment = before.clone();
    let loaded = world.resource::<EnvironmentMap>().0.clone();
    section(ui, "Environment", true, |ui| {
        properties_ui(ui, &mut environment, &["background"]);
        let Some(picture) = Property::of(Environment::type_info(), "map") else {
            return;
        };
        let map = Map {
            label: &picture.label,
            says: &picture.says,
            loaded: loaded.as_ref(),
            owner: Owner::Environment,
        };
        map_ui(ui, world, thumbnails, &map, &mut environment.map, false);
        if environment.map.is_some() {
            properties_ui(ui, &mut environment, &["rotation", "intensity"]);
        }
        properties_ui(ui, &mut environment, &["lights"]);
        if environment.lights {
            properties_ui(ui, &mut environment, &["samples"]);
        }
        properties_ui(ui, &mut environment, &["hidden"]);
    });
    if environment != before {
        *world.resource_mut::<Environment>() = environment;
    }
}
