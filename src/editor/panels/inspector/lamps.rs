//! The four kinds of light.

use super::super::fields::{color_ui, row, section, switch};
use super::super::several::Several;
use crate::scene::schema::Property;
use crate::scene::{DirectionalLamp, ParallelogramLamp, PointLamp, SegmentLamp};
use bevy::color::LinearRgba;
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::reflect::{Reflect, Typed};
use bevy_egui::egui::Ui;

pub(super) fn lamps_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    lamp_ui::<PointLamp>(ui, world, entities, "Point light", |ui, several| {
        several.properties(ui, &["color", "intensity"]);
        cone_ui(ui, several);
    });
    lamp_ui::<DirectionalLamp>(ui, world, entities, "Directional light", |ui, several| {
        several.properties(ui, &["color", "intensity", "angular_diameter", "samples"]);
    });
    lamp_ui::<SegmentLamp>(ui, world, entities, "Segment light", |ui, several| {
        several.properties(ui, &["colors", "intensity", "ends", "samples"]);
    });
    lamp_ui::<ParallelogramLamp>(ui, world, entities, "Parallelogram light", |ui, several| {
        colors_ui(ui, several);
        let shape = ["intensity", "corner", "edges"];
        several.properties(ui, &shape);
        several.properties(ui, &["two_sided", "visible", "samples"]);
    });
}

/// The section of one kind of lamp, where any is selected.
fn lamp_ui<L>(
    ui: &mut Ui,
    world: &mut World,
    entities: &[Entity],
    title: &str,
    body: impl FnOnce(&mut Ui, &mut Several<L>),
) where
    L: Component<Mutability = Mutable> + Clone + PartialEq + Reflect + Typed,
{
    if let Some(mut several) = Several::<L>::of(world, entities) {
        section(ui, title, true, |ui| body(ui, &mut several));
        several.write(world);
    }
}

/// Whether they are spots, and the angles of those that are.
fn cone_ui(ui: &mut Ui, several: &mut Several<PointLamp>) {
    let mut is_spot = several.first().cone.is_some();
    let mixed = several.any(|lamp| lamp.cone.is_some() != is_spot);
    if let Some(Property { label, says, .. }) = Property::of(PointLamp::type_info(), "cone")
        && switch(ui, &label, &says, &mut is_spot, mixed)
    {
        several.change(|lamp| lamp.cone = is_spot.then(|| lamp.cone.unwrap_or_default()));
    }
    if several.first().cone.is_some() {
        several.properties(ui, &["cone.0.inner", "cone.0.outer"]);
    }
}

/// All four in a line, and one for all.
fn colors_ui(ui: &mut Ui, several: &mut Several<ParallelogramLamp>) {
    let says = Property::of(ParallelogramLamp::type_info(), "colors")
        .map_or_else(String::new, |property| property.says);
    row(ui, "Colours", &says, |ui| {
        for (i, corner) in ["corner", "corner + edge A", "corner + edge B", "opposite"]
            .into_iter()
            .enumerate()
        {
            several.field(
                |lamp| &mut lamp.colors[i],
                |value, mixed| color_ui(ui, &format!("Colour at: {corner}"), value, mixed),
            );
        }
    });
    row(ui, "All corners", "One colour for all four corners", |ui| {
        let mut one = several.first().colors[0];
        let mixed = several.first().colors.iter().any(|color| *color != one);
        if color_ui(ui, "One colour for all four corners", &mut one, mixed) {
            let all: [LinearRgba; 4] = [one; 4];
            several.change(|lamp| lamp.colors = all);
        }
    });
}
