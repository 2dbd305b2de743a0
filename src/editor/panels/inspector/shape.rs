//! The numbers of a generated shape, or the file that a mesh comes from.

use super::super::fields::{Number, integer, pair, point, row, section};
use super::super::says::Says;
use super::super::several::Several;
use crate::editor::action::shapes;
use crate::scene::{MeshSource, Shape};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::reflect::enums::Enum;
use bevy_egui::egui::Ui;

/// Lengths that a shape can have.
const LENGTH: Number = Number::positive(0.01, "m").within(1e-4, 1e6);
const FREE: Number = Number::free(0.01, "");

pub(super) fn shape_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let Some(first) = Several::<MeshSource>::of(world, entities) else {
        return;
    };
    // A number of one shape means nothing to another.
    let first = first.first();
    let alike: Vec<Entity> = entities
        .iter()
        .copied()
        .filter(|&entity| {
            let source = world.get::<MeshSource>(entity);
            source.is_some_and(|source| are_alike(source, first))
        })
        .collect();
    let Some(mut several) = Several::<MeshSource>::of(world, &alike) else {
        return;
    };
    section(ui, "Mesh", true, |ui| match several.first().clone() {
        MeshSource::File { path, name } => {
            let says = "The file that the mesh was read from, and its name there";
            row(ui, "File", says, |ui| {
                ui.label(if name.is_empty() {
                    path
                } else {
                    format!("{path} # {name}")
                })
                .says(says);
            });
        }
        MeshSource::Shape(shape) => {
            kind_ui(ui, &mut several, &shape);
            if several.count() > 1 {
                ui.weak(format!("of {} of that shape", several.count()));
            }
            let mut entered = shape.clone();
            if numbers_ui(ui, &mut entered, false) {
                several.change(|source| {
                    if let MeshSource::Shape(other) = source {
                        take_over(&shape, &entered, other);
                    }
                });
            }
        }
    });
    several.write(world);
}

/// Two of the same shape.
fn are_alike(a: &MeshSource, b: &MeshSource) -> bool {
    let kind = |source: &MeshSource| match source {
        MeshSource::Shape(shape) => Some(std::mem::discriminant(shape)),
        MeshSource::File { .. } => None,
    };
    kind(a) == kind(b)
}

/// Those numbers that were entered, and no others, of one shape to another of its kind.
fn take_over(before: &Shape, after: &Shape, other: &mut Shape) {
    for i in 0..before.field_len() {
        let (Some(old), Some(new)) = (before.field_at(i), after.field_at(i)) else {
            continue;
        };
        if old.reflect_partial_eq(new) != Some(true)
            && let Some(field) = other.field_at_mut(i)
        {
            // It fails only for another type, and these are fields of the same variant.
            let _ = field.try_apply(new);
        }
    }
}

/// Another shape in its place.
fn kind_ui(ui: &mut Ui, several: &mut Several<MeshSource>, shape: &Shape) {
    let says = "The shape that is generated; another one takes its place";
    row(ui, "Shape", says, |ui| {
        let kind = |shape: &Shape| std::mem::discriminant(shape);
        let known = shapes();
        let current = known.iter().find(|(_, other)| kind(other) == kind(shape));
        let name = current.map_or("?", |(name, _)| name);
        ui.menu_button(name, |ui| {
            for (name, other) in &known {
                let is_current = kind(other) == kind(shape);
                let label = ui.selectable_label(is_current, *name);
                if label.says(about_shape(name)).clicked() {
                    if !is_current {
                        several.change(|source| *source = MeshSource::Shape(other.clone()));
                    }
                    ui.close();
                }
            }
        })
        .response
        .says(says);
    });
}

/// What a shape of the list looks like.
pub(super) fn about_shape(name: &str) -> &'static str {
    match name {
        "Cuboid" => "A block with flat sides, its edges along the axes",
        "Sphere" => "Divided by longitude and latitude, its poles on the y axis",
        "Cylinder" => "Around the y axis, with flat caps",
        "Torus" => "A ring around the y axis",
        "Ground" => "A level rectangle, facing up; its texture repeats",
        "Quad" => "A flat parallelogram: a corner and the two edges that leave it",
        "Quadrilateral" => "Two triangles between four corners, which need not lie in one plane",
        "Triangle" => "A single triangle, by its corners",
        "Prism" => "An upright block over a convex polygon",
        "Teapot" => "Newell's teapot, of 32 curved patches",
        "Head" => "A smooth head with a neck, facing +Z",
        "Knot" => "A torus knot around the y axis, its tube with ripples",
        _ => "",
    }
}

fn numbers_ui(ui: &mut Ui, shape: &mut Shape, mixed: bool) -> bool {
    let around = "Divisions around the axis: more is rounder, and more triangles";
    match shape {
        Shape::Triangle { corners } => corners_ui(ui, corners, mixed),
        Shape::Quadrilateral { corners } => corners_ui(ui, corners, mixed),
        Shape::Quad { corner, edges } => {
            let mut changed = point(ui, "Corner", "One corner", corner, FREE, mixed);
            for (edge, name) in edges.iter_mut().zip(["Edge A", "Edge B"]) {
                let says = "From the corner to its neighbour; the front is where A × B points";
                changed |= point(ui, name, says, edge, FREE, mixed);
            }
            changed
        }
        Shape::Ground { size, tile } => {
            let says = "Extent along x and z";
            let changed = pair(ui, "Size", says, size, LENGTH, mixed);
            let says = "Extent of one copy of the texture";
            pair(ui, "Tile", says, tile, LENGTH, mixed) || changed
        }
        Shape::Cuboid { size } => point(ui, "Size", "Edge lengths", size, LENGTH, mixed),
        Shape::Prism { height, .. } => LENGTH.row(ui, "Height", "Extent along y", height, mixed),
        Shape::Sphere {
            radius,
            segments,
            rings,
        } => {
            let mut changed = LENGTH.row(ui, "Radius", "Of every vertex", radius, mixed);
            changed |= integer(ui, "Segments", around, segments, 3..=1024, mixed);
            let says = "Divisions from pole to pole";
            changed | integer(ui, "Rings", says, rings, 2..=512, mixed)
        }
        Shape::Cylinder {
            radius,
            height,
            segments,
        } => {
            let mut changed = LENGTH.row(ui, "Radius", "Of the side", radius, mixed);
            changed |= LENGTH.row(ui, "Height", "Extent along y", height, mixed);
            changed | integer(ui, "Segments", around, segments, 3..=1024, mixed)
        }
        Shape::Torus {
            major_radius,
            minor_radius,
            segments,
            sides,
        } => {
            let says = "From the centre to the middle of the tube";
            let mut changed = LENGTH.row(ui, "Ring radius", says, major_radius, mixed);
            changed |= LENGTH.row(ui, "Tube radius", "Of the tube", minor_radius, mixed);
            changed |= integer(ui, "Segments", around, segments, 3..=1024, mixed);
            let says = "Divisions around the tube";
            changed | integer(ui, "Sides", says, sides, 3..=512, mixed)
        }
        Shape::Teapot { divisions } => {
            let says = "Each of its 32 patches becomes n × n quads";
            integer(ui, "Divisions", says, divisions, 1..=64, mixed)
        }
        Shape::Head { segments, rings } => {
            let changed = integer(ui, "Segments", around, segments, 3..=1024, mixed);
            let says = "Divisions from chin to crown";
            integer(ui, "Rings", says, rings, 2..=512, mixed) || changed
        }
        Shape::Knot {
            p,
            q,
            tube_radius,
            displacement,
            segments,
            sides,
        } => {
            let mut turns = [*p, *q];
            let says = "Turns around the axis, and through the hole; no number divides both";
            let mut changed = integer(ui, "Turns p", says, &mut turns[0], 1..=12, mixed);
            changed |= integer(ui, "Turns q", says, &mut turns[1], 1..=12, mixed);
            // Between two knots lie numbers that make none: those are passed over.
            if coprime(turns[0], turns[1]) {
                [*p, *q] = turns;
            } else {
                changed = false;
            }
            changed |= LENGTH.row(ui, "Tube radius", "Of the rope", tube_radius, mixed);
            let says = "Height of the ripples, as a part of the tube's radius";
            changed |= Number::slider(0.0, 1.0, "").row(ui, "Ripples", says, displacement, mixed);
            let says = "Divisions along the knot";
            changed |= integer(ui, "Segments", says, segments, 3..=4096, mixed);
            let says = "Divisions around the tube";
            changed | integer(ui, "Sides", says, sides, 3..=512, mixed)
        }
    }
}

fn corners_ui(ui: &mut Ui, corners: &mut [Vec3], mixed: bool) -> bool {
    let mut changed = false;
    for (i, corner) in corners.iter_mut().enumerate() {
        let says = "A corner; counter-clockwise seen from the side that the normal points to";
        changed |= point(ui, &format!("Corner {}", i + 1), says, corner, FREE, mixed);
    }
    changed
}

fn coprime(mut a: u32, mut b: u32) -> bool {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_entered_for_one_sphere_reaches_another_and_leaves_its_other_numbers() {
        let sphere = |radius, segments| Shape::Sphere {
            radius,
            segments,
            rings: 9,
        };
        let mut other = sphere(1.0, 64);
        take_over(&sphere(2.0, 12), &sphere(3.0, 12), &mut other);
        assert_eq!(other, sphere(3.0, 64));
    }

    #[test]
    fn a_knot_needs_turns_without_a_common_divisor() {
        assert!(coprime(2, 3) && coprime(1, 1) && coprime(5, 1));
        assert!(!coprime(2, 4) && !coprime(3, 3) && !coprime(0, 2));
    }
}
