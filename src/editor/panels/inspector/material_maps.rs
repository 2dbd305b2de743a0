//! The pictures of a material: which, how they wrap and are filtered, and what becomes of its opacity.

use super::super::fields::{Number, choice, section};
use super::super::several::Several;
use super::super::state::Panels;
use super::maps::{Map, Owner, map_ui};
use crate::scene::{Alpha, MapFilter, Phong, PhongMap, PhongMaps, SceneId, Wrap};
use bevy::ecs::world::World;
use bevy_egui::egui::Ui;
use std::sync::Arc;

/// Those that most materials with pictures have; the others are folded away.
const COMMON: [PhongMap; 2] = [PhongMap::Diffuse, PhongMap::Opacity];

/// All maps of the materials with these numbers; `loaded` are those of the active one.
pub(super) fn maps_ui(
    ui: &mut Ui,
    world: &World,
    panels: &mut Panels,
    several: &mut Several<Phong>,
    loaded: &PhongMaps,
    numbers: &Arc<[SceneId]>,
) {
    let mut one = |ui: &mut Ui, several: &mut Several<Phong>, map: PhongMap| {
        let (label, says) = words(map);
        let field = Map {
            label,
            says,
            loaded: map.loaded(loaded),
            owner: Owner::Materials(numbers.clone(), map),
        };
        several.field(
            |phong| map.source_mut(phong),
            |value, mixed| map_ui(ui, world, panels, &field, value, mixed),
        );
        ui.push_id(label, |ui| reading_ui(ui, several, map));
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
            let says = "How far the normal map bends normals: 1 as it is painted, below 0 inwards";
            let number = Number::free(0.01, "").within(-100.0, 100.0);
            several.number(ui, "Normal scale", says, number, |phong| {
                &mut phong.normal_scale
            });
        }
    });
}

/// What a map's field is called, and what it says.
fn words(map: PhongMap) -> (&'static str, &'static str) {
    match map {
        PhongMap::Diffuse => (
            "Diffuse map",
            "A picture that multiplies the diffuse colour",
        ),
        PhongMap::Specular => (
            "Specular map",
            "A picture that multiplies the highlight's colour",
        ),
        PhongMap::Mirror => ("Mirror map", "A picture that multiplies what is mirrored"),
        PhongMap::Emission => ("Emission map", "A picture that multiplies the emission"),
        PhongMap::Opacity => (
            "Opacity map",
            "A picture whose brightness multiplies the opacity",
        ),
        PhongMap::Normal => (
            "Normal map",
            "A picture of normals: red to its right, green to its upper edge, blue outwards",
        ),
    }
}

const WRAPS: [(Wrap, &str, &str); 3] = [
    (Wrap::Repeat, "Repeat", "The picture again"),
    (Wrap::Clamp, "Clamp", "The picture's outermost pixels"),
    (
        Wrap::Mirror,
        "Mirror",
        "The picture again, every second time reversed",
    ),
];

const FILTERS: [(MapFilter, &str, &str); 3] = [
    (
        MapFilter::Setting,
        "As the render",
        "What the render's texture filter says",
    ),
    (
        MapFilter::Nearest,
        "Nearest",
        "Hard pixels, whatever the render's texture filter is",
    ),
    (
        MapFilter::Linear,
        "Linear",
        "What the render's texture filter says, but never hard pixels",
    ),
];

/// How a map that is set is read. What is chosen reaches the maps of that kind that are set.
fn reading_ui(ui: &mut Ui, several: &mut Several<Phong>, map: PhongMap) {
    let Some(source) = map.source(several.first()).cloned() else {
        return;
    };
    let differs = |several: &Several<Phong>,
                   is_other: &dyn Fn(&crate::scene::TextureSource) -> bool| {
        several.any(|phong| map.source(phong).is_some_and(is_other))
    };
    let mixed = differs(several, &|other| other.wrap_u != source.wrap_u);
    let (mut u, mut v, mut filter) = (source.wrap_u, source.wrap_v, source.filter);
    let says = "What there is beyond the picture's left and right edge";
    if choice(ui, "Wrap u", says, &mut u, &WRAPS, mixed) {
        several.change(|phong| {
            if let Some(source) = map.source_mut(phong) {
                source.wrap_u = u;
            }
        });
    }
    let mixed = differs(several, &|other| other.wrap_v != source.wrap_v);
    let says = "What there is beyond the picture's upper and lower edge";
    if choice(ui, "Wrap v", says, &mut v, &WRAPS, mixed) {
        several.change(|phong| {
            if let Some(source) = map.source_mut(phong) {
                source.wrap_v = v;
            }
        });
    }
    let mixed = differs(several, &|other| other.filter != source.filter);
    let says = "What there is between the picture's pixels";
    if choice(ui, "Filter", says, &mut filter, &FILTERS, mixed) {
        several.change(|phong| {
            if let Some(source) = map.source_mut(phong) {
                source.filter = filter;
            }
        });
    }
}

/// A kind of [`Alpha`], without its cutoff.
#[derive(Clone, Copy, PartialEq)]
enum AlphaKind {
    Blend,
    Mask,
    Opaque,
}

const ALPHAS: [(AlphaKind, &str, &str); 3] = [
    (
        AlphaKind::Blend,
        "Blend",
        "What is not opaque lets light through in part",
    ),
    (
        AlphaKind::Mask,
        "Mask",
        "There where the opacity reaches the cutoff, and nothing elsewhere",
    ),
    (
        AlphaKind::Opaque,
        "Opaque",
        "Opacity and its map mean nothing",
    ),
];

fn kind_of(alpha: Alpha) -> AlphaKind {
    match alpha {
        Alpha::Blend => AlphaKind::Blend,
        Alpha::Mask { .. } => AlphaKind::Mask,
        Alpha::Opaque => AlphaKind::Opaque,
    }
}

/// What becomes of the opacity.
pub(super) fn alpha_ui(ui: &mut Ui, several: &mut Several<Phong>) {
    const CUTOFF: f32 = 0.5;
    let mut kind = kind_of(several.first().alpha);
    let mixed = several.any(|phong| kind_of(phong.alpha) != kind);
    let says = "What becomes of the opacity, its map's and the vertices' included";
    if choice(ui, "Alpha", says, &mut kind, &ALPHAS, mixed) {
        several.change(|phong| {
            phong.alpha = match kind {
                AlphaKind::Blend => Alpha::Blend,
                AlphaKind::Mask => Alpha::Mask { cutoff: CUTOFF },
                AlphaKind::Opaque => Alpha::Opaque,
            }
        });
    }
    let Alpha::Mask { mut cutoff } = several.first().alpha else {
        return;
    };
    let mixed = several.any(|phong| phong.alpha != Alpha::Mask { cutoff });
    let says = "The opacity from which on the surface is there";
    if Number::slider(0.0, 1.0, "").row(ui, "Cutoff", says, &mut cutoff, mixed) {
        several.change(|phong| {
            if let Alpha::Mask { cutoff: own } = &mut phong.alpha {
                *own = cutoff;
            }
        });
    }
}
