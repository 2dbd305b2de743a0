//! The pictures of a material: which, how they wrap and are filtered, and what becomes of its opacity.

use super::super::fields::section;
use super::super::several::Several;
use super::maps::{Map, Owner, Thumbnails, map_ui};
use crate::scene::{Alpha, Phong, PhongMap, PhongMaps, Property, SceneId};
use bevy::ecs::world::World;
use bevy::reflect::Typed;
use bevy_egui::egui::Ui;
use std::sync::Arc;

/// Those that most materials with pictures have; the others are folded away.
const COMMON: [PhongMap; 2] = [PhongMap::Diffuse, PhongMap::Opacity];

/// All maps of the materials with these numbers; `loaded` are those of the active one.
pub(super) fn maps_ui(
    ui: &mut Ui,
    world: &World,
    thumbnails: &mut Thumbnails,
    several: &mut Several<Phong>,
    loaded: &PhongMaps,
    numbers: &Arc<[SceneId]>,
) {
    let mut one = |ui: &mut Ui, several: &mut Several<Phong>, map: PhongMap| {
        let Some(property) = Property::of(Phong::type_info(), path_of(map)) else {
            return;
        };
        let field = Map {
            label: &property.label,
            says: &property.says,
            loaded: map.loaded(loaded),
            owner: Owner::Materials(numbers.clone(), map),
        };
        several.field(
            &property.path,
            |phong| map.source_mut(phong),
            |value, mixed| map_ui(ui, world, thumbnails, &field, value, mixed),
        );
        if map.source(several.first()).is_some() {
            ui.push_id(&property.label, |ui| {
                let parts = ["wrap_u", "wrap_v", "filter"];
                let parts = parts.map(|part| format!("{}.0.{part}", property.path));
                several.properties(ui, &parts.each_ref().map(String::as_str));
            });
        }
    };
    for map in COMMON {
        one(ui, several, map);
    }
    let others = PhongMap::ALL
        .into_iter()
        .filter(|map| !COMMON.contains(map));
    let is_any_set = (others.clone()).any(|map| map.source(several.first()).is_some());
    section(ui, "More maps", is_any_set, |ui| {
        for map in others {
            one(ui, several, map);
        }
        if several.any(|phong| phong.normal_map.is_some()) {
            several.properties(ui, &["normal_scale"]);
        }
    });
}

/// Where a material has it.
fn path_of(map: PhongMap) -> &'static str {
    match map {
        PhongMap::Diffuse => "diffuse_map",
        PhongMap::Specular => "specular_map",
        PhongMap::Mirror => "mirror_map",
        PhongMap::Emission => "emission_map",
        PhongMap::Opacity => "opacity_map",
        PhongMap::Normal => "normal_map",
    }
}

/// What becomes of the opacity.
pub(super) fn alpha_ui(ui: &mut Ui, several: &mut Several<Phong>) {
    const CUTOFF: f32 = 0.5;
    if let Some(chosen) = several.variant_ui(ui, "alpha") {
        several.change(|phong| {
            phong.alpha = match chosen {
                "Mask" => Alpha::Mask { cutoff: CUTOFF },
                "Opaque" => Alpha::Opaque,
                _ => Alpha::Blend,
            }
        });
    }
    if matches!(several.first().alpha, Alpha::Mask { .. }) {
        several.properties(ui, &["alpha.cutoff"]);
    }
}
