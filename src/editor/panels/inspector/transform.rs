//! Where an entity stands.

use super::super::fields::{row, section, switch};
use super::super::says::Says;
use super::super::several::Several;
use super::super::turn::{turn_ui, with_angle};
use crate::editor::handles::Tools;
use crate::scene::{Property, Quantity};
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::reflect::Typed;
use bevy::transform::components::Transform;
use bevy_egui::egui::Ui;

pub(super) fn transform_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let Some(mut several) = Several::<Transform>::of(world, entities) else {
        return;
    };
    section(ui, "Place", true, |ui| {
        visible_ui(ui, world, entities);
        place_ui(
            ui,
            &mut several,
            "translation",
            "Position",
            "Metres, in its parent's space",
            Quantity::COORDINATE,
        );
        rotation_ui(ui, &mut several);
        scale_ui(ui, world, &mut several);
    });
    several.write(world);
}

/// A part of Bevy's own component, of which our schema says nothing: setting one number leaves the others of several
/// entities.
fn place_ui(
    ui: &mut Ui,
    several: &mut Several<Transform>,
    path: &str,
    label: &str,
    says: &str,
    quantity: Quantity,
) {
    if let Some(mut property) = Property::of(Transform::type_info(), path) {
        property.label = label.to_owned();
        property.says = says.to_owned();
        property.quantity = Some(quantity);
        several.property(ui, &property);
    }
}

fn scale_ui(ui: &mut Ui, world: &mut World, several: &mut Several<Transform>) {
    let before = several.copies();
    place_ui(
        ui,
        several,
        "scale",
        "Scale",
        "Size along its own axes; 1 is as it was made, negative mirrors",
        Quantity::COORDINATE.unit(""),
    );
    let mut linked = world
        .get_resource::<Tools>()
        .is_some_and(|all| all.scale_linked);
    if linked && let Some(ratio) = ratio(before[0].scale, several.first().scale) {
        several.put_back(before);
        several.change(|transform| transform.scale *= ratio);
    }
    let says = "Entering one of the three, or dragging a cube, scales the other two as much";
    if switch(ui, "Linked", says, &mut linked, false)
        && let Some(mut tools) = world.get_resource_mut::<Tools>()
    {
        tools.scale_linked = linked;
    }
}

/// How many times as large the axis became that was entered; `None` where none was, or from or to no size at all.
fn ratio(before: Vec3, after: Vec3) -> Option<f32> {
    let axis = (0..3).find(|&axis| before[axis] != after[axis])?;
    let ratio = after[axis] / before[axis];
    (ratio.is_finite() && ratio != 0.0).then_some(ratio)
}

fn rotation_ui(ui: &mut Ui, several: &mut Several<Transform>) {
    let before = several.first().rotation;
    let differs = several.any(|transform| transform.rotation != before);
    let says = "About x, y and z: first about the vertical y, then x, then z";
    let mut rotation = before;
    if let Some((axis, degrees)) = turn_ui(ui, "Turn", says, &mut rotation, differs) {
        several.change(|transform| {
            transform.rotation = match transform.rotation == before {
                true => rotation,
                false => with_angle(transform.rotation, axis, degrees),
            };
        });
    }
}

fn visible_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let Some(mut several) = Several::<Visibility>::of(world, entities) else {
        return;
    };
    let says = "What is hidden is not traced, nor is what is below it in the list";
    row(ui, "Visible", says, |ui| {
        several.field(
            "visibility",
            |visibility| visibility,
            |visibility, mixed| {
                let mut visible = *visibility != Visibility::Hidden;
                let text = if mixed { "mixed" } else { "" };
                let changed = ui.checkbox(&mut visible, text).says(says).changed();
                if changed {
                    *visibility = match visible {
                        true => Visibility::Inherited,
                        false => Visibility::Hidden,
                    };
                }
                changed
            },
        );
    });
    several.write(world);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::panels::tests::Desk;
    use bevy_egui::egui::accesskit::Role;
    use bevy_egui::egui::vec2;

    #[test]
    fn linked_scales_change_together_and_others_one_by_one() {
        let mut desk = Desk::open("cornell-box");
        desk.world().init_resource::<Tools>();
        desk.context.enable_accesskit();
        let (block, id) = desk.named("Short block");
        let uneven = Vec3::new(1.0, 2.0, 4.0);
        for linked in [false, true] {
            desk.world().resource_mut::<Tools>().scale_linked = linked;
            desk.world().get_mut::<Transform>(block).unwrap().scale = uneven;
            desk.select([id]);
            let at = desk.control_beside("Scale", Role::SpinButton);
            desk.drag(at, vec2(40.0, 0.0));
            let after = desk.world().get::<Transform>(block).unwrap().scale / uneven;
            assert!(after.x > 1.1, "{after}");
            let expected = if linked {
                Vec3::splat(after.x)
            } else {
                after.with_y(1.0).with_z(1.0)
            };
            assert!(
                (after - expected).abs().max_element() < 1e-4,
                "linked {linked}: {after}"
            );
        }
        assert_eq!(ratio(Vec3::ZERO, Vec3::X), None);
        assert_eq!(ratio(Vec3::ONE, Vec3::ONE), None);
    }
}
