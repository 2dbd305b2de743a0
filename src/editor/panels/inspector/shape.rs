//! The numbers of a generated shape, or the file that a mesh comes from.

use super::super::fields::{row, section};
use super::super::says::Says;
use super::super::several::Several;
use crate::editor::action::shapes;
use crate::editor::texts::scene_path_text;
use crate::scene::schema::about_choice;
use crate::scene::{MeshSource, Shape};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::reflect::enums::Enum;
use bevy_egui::egui::{Label, Ui};

pub(super) fn shape_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let source = |entity: &Entity| world.get::<MeshSource>(*entity);
    let Some(first) = entities.iter().find_map(source) else {
        return;
    };
    // A number of one shape means nothing to another.
    let is_alike = |entity: &&Entity| source(entity).is_some_and(|one| are_alike(one, first));
    let alike: Vec<Entity> = entities.iter().filter(is_alike).copied().collect();
    let Some(mut several) = Several::<MeshSource>::of(world, &alike) else {
        return;
    };
    section(ui, "Mesh", true, |ui| match several.first().clone() {
        MeshSource::File { path, name } => {
            let path = scene_path_text(world, &path);
            let text = match name.is_empty() {
                true => path,
                false => format!("{path} # {name}"),
            };
            let says = "The file that the mesh was read from, and its name there";
            row(ui, "File", says, |ui| {
                let label = Label::new(&text).truncate();
                ui.add(label).says(&format!("{text}: {says}"));
            });
        }
        MeshSource::Shape(shape) => {
            kind_ui(ui, &mut several, &shape);
            if several.count() > 1 {
                ui.weak(format!("of {} of that shape", several.count()));
            }
            numbers_ui(ui, &mut several, &shape);
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
                if label.says(&about_choice(other)).clicked() {
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

/// Its numbers, in their order. A polygon's corners are not among them.
fn numbers_ui(ui: &mut Ui, several: &mut Several<MeshSource>, shape: &Shape) {
    let before = several.copies();
    for i in 0..shape.field_len() {
        let name = shape.name_at(i).filter(|name| *name != "base");
        if let Some(name) = name {
            several.properties(ui, &[&format!("0.{name}")]);
        }
    }
    // Between two knots lie numbers that make none: those are passed over.
    let is_none = |source: &MeshSource| match *source {
        MeshSource::Shape(Shape::Knot { p, q, .. }) => !coprime(p, q),
        _ => false,
    };
    if several.any(is_none) && !before.iter().any(is_none) {
        several.put_back(before);
    }
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
    fn a_knot_needs_turns_without_a_common_divisor() {
        assert!(coprime(2, 3) && coprime(1, 1) && coprime(5, 1));
        assert!(!coprime(2, 4) && !coprime(3, 3) && !coprime(0, 2));
    }
}
