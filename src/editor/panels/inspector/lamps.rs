//! The four kinds of light.

use super::super::fields::{Number, angle, color_ui, row, section, switch};
use super::super::several::Several;
use crate::scene::{Cone, DirectionalLamp, ParallelogramLamp, PointLamp, SegmentLamp};
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy_egui::egui::Ui;

const COLOR: &str = "The light's colour; the intensity multiplies it";
const SAMPLES: &str = "Shadow rays to it at the first hit of each pixel, shared by the pixel's samples: more makes its soft shadows less noisy";
const ENDS: &str = "Metres, in the light's own space; its ends have handles in the view too";

pub(super) fn lamps_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    if let Some(mut several) = Several::<PointLamp>::of(world, entities) {
        section(ui, "Point light", true, |ui| point_ui(ui, &mut several));
        several.write(world);
    }
    if let Some(mut several) = Several::<DirectionalLamp>::of(world, entities) {
        section(ui, "Directional light", true, |ui| {
            directional_ui(ui, &mut several);
        });
        several.write(world);
    }
    if let Some(mut several) = Several::<SegmentLamp>::of(world, entities) {
        section(ui, "Segment light", true, |ui| segment_ui(ui, &mut several));
        several.write(world);
    }
    if let Some(mut several) = Several::<ParallelogramLamp>::of(world, entities) {
        section(ui, "Parallelogram light", true, |ui| {
            parallelogram_ui(ui, &mut several);
        });
        several.write(world);
    }
}

fn intensity(unit: &'static str) -> Number {
    Number::positive(0.02, unit)
}

/// A place or an edge in the light's own space.
const POINT: Number = Number::free(0.01, "");

fn point_ui(ui: &mut Ui, several: &mut Several<PointLamp>) {
    several.color(ui, "Colour", COLOR, |lamp| &mut lamp.color);
    let says = "Radiant intensity: what reaches a surface falls with the distance squared";
    several.number(ui, "Intensity", says, intensity("W/sr"), |lamp| {
        &mut lamp.intensity
    });
    cone_ui(ui, several);
}

/// Whether they are spots, and the angles of those that are.
fn cone_ui(ui: &mut Ui, several: &mut Several<PointLamp>) {
    let mut is_spot = several.first().cone.is_some();
    let mixed = several.any(|lamp| lamp.cone.is_some() != is_spot);
    let says = "Only within a cone around the light's -Z axis";
    if switch(ui, "Spot", says, &mut is_spot, mixed) {
        several.change(|lamp| lamp.cone = is_spot.then(|| lamp.cone.unwrap_or_default()));
    }
    let Some(mut cone) = several.first().cone else {
        return;
    };
    let differ = |part: fn(&Cone) -> f32| {
        several.any(|lamp| {
            let other = lamp.cone.as_ref();
            other.is_some_and(|other| part(other) != part(&cone))
        })
    };
    let mixed = [differ(|cone| cone.inner), differ(|cone| cone.outer)];
    let says = "Half-angle of the cone that has full strength";
    if angle(
        ui,
        "Full within",
        says,
        &mut cone.inner,
        [0.0, 90.0],
        mixed[0],
    ) {
        several.change(|lamp| set_inner(lamp, cone.inner));
    }
    let says = "Half-angle outside of which there is no light; between the two it fades";
    if angle(
        ui,
        "None outside",
        says,
        &mut cone.outer,
        [0.0, 90.0],
        mixed[1],
    ) {
        several.change(|lamp| set_outer(lamp, cone.outer));
    }
}

/// The other angle gives way, and stays as it is where it need not.
fn set_inner(lamp: &mut PointLamp, inner: f32) {
    if let Some(cone) = &mut lamp.cone {
        cone.inner = inner;
        cone.outer = cone.outer.max(inner);
    }
}

/// As [`set_inner`].
fn set_outer(lamp: &mut PointLamp, outer: f32) {
    if let Some(cone) = &mut lamp.cone {
        cone.outer = outer;
        cone.inner = cone.inner.min(outer);
    }
}

fn directional_ui(ui: &mut Ui, several: &mut Several<DirectionalLamp>) {
    several.color(ui, "Colour", COLOR, |lamp| &mut lamp.color);
    let says = "Irradiance on a surface that faces it, the same at every distance";
    several.number(ui, "Intensity", says, intensity("W/m²"), |lamp| {
        &mut lamp.intensity
    });
    let says = "Angle under which the source is seen: 0 gives hard shadows, the sun has 0.53°, 180° is half of the sky";
    several.angle(ui, "Angular diameter", says, [0.0, 180.0], |lamp| {
        &mut lamp.angular_diameter
    });
    several.integer(ui, "Samples", SAMPLES, 1..=1000, |lamp| &mut lamp.samples);
}

fn segment_ui(ui: &mut Ui, several: &mut Several<SegmentLamp>) {
    let says = "The colour at this end, linear between";
    for (i, name) in ["Colour A", "Colour B"].into_iter().enumerate() {
        several.color(ui, name, says, |lamp| &mut lamp.colors[i]);
    }
    let says = "Radiant intensity of each metre, the same in all directions";
    several.number(ui, "Intensity", says, intensity("W/(sr·m)"), |lamp| {
        &mut lamp.intensity
    });
    for (i, name) in ["End A", "End B"].into_iter().enumerate() {
        several.point(ui, name, ENDS, POINT, |lamp| &mut lamp.ends[i]);
    }
    several.integer(ui, "Samples", SAMPLES, 1..=1000, |lamp| &mut lamp.samples);
}

fn parallelogram_ui(ui: &mut Ui, several: &mut Several<ParallelogramLamp>) {
    let says = "The colours at the four corners, bilinear between";
    row(ui, "Colours", says, |ui| {
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
    let says = "Radiance: a larger light of the same radiance gives more light";
    several.number(ui, "Intensity", says, intensity("W/(sr·m²)"), |lamp| {
        &mut lamp.intensity
    });
    several.point(ui, "Corner", ENDS, POINT, |lamp| &mut lamp.corner);
    let says = "From the corner to its neighbour; it shines to where A × B points";
    for (i, name) in ["Edge A", "Edge B"].into_iter().enumerate() {
        several.point(ui, name, says, POINT, |lamp| &mut lamp.edges[i]);
    }
    let says = "Whether the back shines too";
    several.switch(ui, "Two-sided", says, |lamp| &mut lamp.two_sided);
    let says = "Whether the camera and mirrors see the light itself";
    several.switch(ui, "Visible to camera", says, |lamp| &mut lamp.visible);
    several.integer(ui, "Samples", SAMPLES, 1..=1000, |lamp| &mut lamp.samples);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_reaches_spots_alone_and_leaves_their_other_angle_where_it_can() {
        let spot = |inner, outer| PointLamp {
            cone: Some(Cone { inner, outer }),
            ..PointLamp::default()
        };
        let no_spot = PointLamp {
            cone: None,
            ..PointLamp::default()
        };
        let mut lamps = [spot(0.1, 0.9), spot(0.2, 0.3), no_spot];
        let cones = |lamps: &[PointLamp; 3]| {
            let cone = |lamp: &PointLamp| lamp.cone.map(|cone| (cone.inner, cone.outer));
            lamps.each_ref().map(cone)
        };
        lamps.iter_mut().for_each(|lamp| set_inner(lamp, 0.5));
        assert_eq!(cones(&lamps), [Some((0.5, 0.9)), Some((0.5, 0.5)), None]);
        lamps.iter_mut().for_each(|lamp| set_outer(lamp, 0.4));
        assert_eq!(cones(&lamps), [Some((0.4, 0.4)), Some((0.4, 0.4)), None]);
    }
}
