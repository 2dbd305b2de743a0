//! The four kinds of light, with what can be said of them in other words than their own: a temperature, a size.

use super::super::fields::{color_ui, number_row, number_within, row, section, switch};
use super::super::several::Several;
use super::super::temperature::{self, OF_LIGHTS, luminance};
use super::command_button;
use crate::scene::schema::Property;
use crate::scene::{DirectionalLamp, ParallelogramLamp, PointLamp, Quantity, SegmentLamp};
use bevy::color::{ColorToComponents, LinearRgba};
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::reflect::{Reflect, Typed};
use bevy_egui::egui::Ui;

pub(super) fn lamps_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    lamp_ui::<PointLamp>(ui, world, entities, "Point light", |ui, several| {
        several.properties(ui, &["color"]);
        temperature_ui(ui, several, |lamp| std::slice::from_mut(&mut lamp.color));
        several.properties(ui, &["intensity"]);
        cone_ui(ui, several);
    });
    lamp_ui::<DirectionalLamp>(ui, world, entities, "Directional light", |ui, several| {
        several.properties(ui, &["color"]);
        temperature_ui(ui, several, |lamp| std::slice::from_mut(&mut lamp.color));
        several.properties(ui, &["intensity", "angular_diameter", "samples"]);
    });
    lamp_ui::<SegmentLamp>(ui, world, entities, "Segment light", |ui, several| {
        several.properties(ui, &["colors"]);
        temperature_ui(ui, several, |lamp| &mut lamp.colors);
        several.properties(ui, &["intensity"]);
        length_ui(ui, several);
        several.properties(ui, &["ends", "samples"]);
    });
    lamp_ui::<ParallelogramLamp>(ui, world, entities, "Parallelogram light", |ui, several| {
        colors_ui(ui, several);
        temperature_ui(ui, several, |lamp| &mut lamp.colors);
        several.properties(ui, &["intensity"]);
        size_ui(ui, several);
        let rest = ["corner", "edges", "two_sided", "visible", "samples"];
        several.properties(ui, &rest);
    });
    let is_lamp = |&entity: &Entity| {
        let entity = world.entity(entity);
        let shines_to_a_side =
            entity.contains::<DirectionalLamp>() || entity.contains::<ParallelogramLamp>();
        let lamp = entity.get::<PointLamp>();
        shines_to_a_side || lamp.is_some_and(|lamp| lamp.cone.is_some())
    };
    if entities.iter().any(is_lamp) {
        command_button(ui, world, "tool.aim");
    }
}

/// How hot a body is that glows so: what is entered colours the whole light, and leaves it as bright.
fn temperature_ui<L>(
    ui: &mut Ui,
    several: &mut Several<L>,
    colors: impl Fn(&mut L) -> &mut [LinearRgba],
) where
    L: Component<Mutability = Mutable> + Clone + PartialEq,
{
    let linear = |color: &LinearRgba| Vec3::from_array(color.to_f32_array_no_alpha());
    let mut active = several.first().clone();
    // Of most colours it is a guess: more digits would say what nobody knows.
    let mut kelvin = temperature::nearest(linear(&colors(&mut active)[0])).round();
    let says = "Colours the light as a body of this temperature glows, as bright as it was: a candle has 1900 K, a bulb 2800, noon 5500, white 6504, a blue sky 12000";
    if number_row(ui, "Temperature", says, &mut kelvin, OF_LIGHTS) {
        several.change(|lamp| {
            for color in colors(lamp) {
                let [red, green, blue] = glowing(kelvin, linear(color)).to_array();
                *color = LinearRgba::new(red, green, blue, color.alpha);
            }
        });
    }
}

/// The colour of a body of this temperature, as bright as this colour: white of what was as bright as white, to the bit.
fn glowing(kelvin: f32, as_bright_as: Vec3) -> Vec3 {
    let glow = temperature::color(kelvin);
    glow * (luminance(as_bright_as) / luminance(glow))
}

/// How long a segment is: its middle stays.
fn length_ui(ui: &mut Ui, several: &mut Several<SegmentLamp>) {
    let [a, b] = several.first().ends;
    let mut length = a.distance(b);
    let says = "From end to end, in the light's own space; its middle stays where it is";
    if number_row(ui, "Length", says, &mut length, Quantity::EXTENT) {
        several.change(|lamp| {
            let [a, b] = lamp.ends;
            if let Some(along) = (b - a).try_normalize() {
                let (middle, half) = (0.5 * (a + b), 0.5 * length * along);
                lamp.ends = [middle - half, middle + half];
            }
        });
    }
}

/// How long the edges of a parallelogram are: its middle and their directions stay.
fn size_ui(ui: &mut Ui, several: &mut Several<ParallelogramLamp>) {
    let says =
        "Lengths of edge A and of edge B, in the light's own space; the middle stays where it is";
    let mut sides = several.first().edges.map(Vec3::length);
    let changed = row(ui, "Size", says, |ui| {
        let [a, b] = &mut sides;
        let gap = 12.0 + 2.0 * ui.spacing().item_spacing.x;
        let width = 0.5 * (ui.available_width() - gap);
        let a = number_within(ui, "Length of edge A", a, Quantity::EXTENT, width).then_some(0);
        ui.weak("×");
        let width = ui.available_width();
        let b = number_within(ui, "Length of edge B", b, Quantity::EXTENT, width).then_some(1);
        a.or(b)
    });
    let Some(changed) = changed else {
        return;
    };
    several.change(|lamp| {
        let before = lamp.edges[changed];
        if let Some(along) = before.try_normalize() {
            lamp.edges[changed] = along * sides[changed];
            lamp.corner += 0.5 * (before - lamp.edges[changed]);
        }
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
                &format!("colors.{i}"),
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

#[cfg(test)]
mod tests {
    use super::super::super::temperature::{WHITE, nearest};
    use super::*;

    #[test]
    fn a_white_light_is_called_daylight_and_called_so_again_it_is_white() {
        let warm = glowing(2800.0, Vec3::ONE);
        assert!(warm.x > 1.2 && warm.z < 0.5, "{warm}");
        for brightness in [0.5, 1.0, 40.0] {
            let white = Vec3::splat(brightness);
            assert_eq!(nearest(white).round(), WHITE);
            assert_eq!(glowing(WHITE, white), white);
            let again = glowing(WHITE, brightness * warm);
            assert!((again / white - 1.0).abs().max_element() < 1e-6, "{again}");
        }
    }
}
