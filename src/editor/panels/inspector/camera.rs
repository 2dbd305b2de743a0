//! Cameras with their lens.

use super::super::fields::{row, section};
use super::super::says::Says;
use super::super::several::Several;
use super::command_button;
use super::switches::switches_ui;
use crate::editor::action::Action;
use crate::editor::handles::new_lens;
use crate::scene::schema::about_type;
use crate::scene::{Lens, Projection, SceneCamera, SceneId};
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::reflect::Typed;
use bevy::reflect::enums::Enum;
use bevy_egui::egui::Ui;

pub(super) fn camera_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let Some(mut several) = Several::<SceneCamera>::of(world, entities) else {
        return;
    };
    section(ui, "Camera", true, |ui| {
        ui.horizontal_wrapped(|ui| {
            let says = "Shows the scene as this camera sees it";
            if ui.button("Look through").says(says).clicked()
                && let Some(id) = first_camera(world, entities)
            {
                world.write_message(Action::LookThrough(Some(id)));
            }
            command_button(ui, world, "tool.aim");
            command_button(ui, world, "tool.focus");
        });
        projection_ui(ui, &mut several);
        several.properties(ui, &["shutter_open", "shutter_close"]);
    });
    several.write(world);
    let cameras: Vec<Entity> = entities
        .iter()
        .copied()
        .filter(|&entity| world.get::<SceneCamera>(entity).is_some())
        .collect();
    optional_ui::<Lens>(
        ui,
        world,
        &cameras,
        "Lens",
        new_lens,
        |ui, world, several| {
            switches_ui(ui, world, "Its blur", &["features.lens"]);
            several.properties(ui, &["aperture_radius", "focus_distance", "samples"]);
        },
    );
}

/// Of what is selected, the active one first, the first that is a camera.
fn first_camera(world: &World, entities: &[Entity]) -> Option<SceneId> {
    let is_camera = |&&entity: &&Entity| world.get::<SceneCamera>(entity).is_some();
    let camera = entities.iter().find(is_camera)?;
    world.get::<SceneId>(*camera).copied()
}

/// What is entered of one kind of projection reaches the cameras that have it, and no other becomes one of that kind.
fn projection_ui(ui: &mut Ui, several: &mut Several<SceneCamera>) {
    if let Some(chosen) = several.variant_ui(ui, "projection") {
        several.change(|camera| {
            if camera.projection.variant_name() != chosen {
                camera.projection = match chosen {
                    "Orthographic" => Projection::Orthographic { height: 2.0 },
                    _ => Projection::default(),
                };
            }
        });
    }
    several.properties(
        ui,
        match several.first().projection {
            Projection::Perspective { .. } => &["projection.fov_y"],
            Projection::Orthographic { .. } => &["projection.height"],
        },
    );
}

/// A component that some have and others do not: buttons add it, as `new` makes it, and remove it.
pub(super) fn optional_ui<C>(
    ui: &mut Ui,
    world: &mut World,
    entities: &[Entity],
    name: &str,
    new: impl Fn(&mut World, Entity) -> C,
    body: impl FnOnce(&mut Ui, &mut World, &mut Several<C>),
) where
    C: Component<Mutability = Mutable> + Clone + PartialEq + Typed,
{
    if entities.is_empty() {
        return;
    }
    let says = about_type(C::type_info());
    let says = says.as_str();
    let Some(mut several) = Several::<C>::of(world, entities) else {
        row(ui, name, says, |ui| {
            if ui.button("Add").says(says).clicked() {
                for &entity in entities {
                    let added = new(world, entity);
                    world.entity_mut(entity).insert(added);
                }
            }
        });
        return;
    };
    let mut remove = false;
    let mut complete = false;
    section(ui, name, true, |ui| {
        body(ui, world, &mut several);
        ui.horizontal(|ui| {
            remove = ui.small_button("Remove").says("Takes it away").clicked();
            if several.count() < entities.len() {
                let text = format!("Add to the other {}", entities.len() - several.count());
                complete = ui.small_button(text).says(says).clicked();
            }
        });
    });
    several.write(world);
    for &entity in entities {
        if remove {
            world.entity_mut(entity).remove::<C>();
        } else if complete && world.get::<C>(entity).is_none() {
            let added = new(world, entity);
            world.entity_mut(entity).insert(added);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_camera_that_is_looked_through_is_the_first_that_is_one() {
        let mut world = World::new();
        let lamp = world.spawn(SceneId(1)).id();
        let cameras = [2, 3].map(|id| world.spawn((SceneId(id), SceneCamera::default())).id());
        let selected = [lamp, cameras[1], cameras[0]];
        assert_eq!(first_camera(&world, &selected), Some(SceneId(3)));
        assert_eq!(first_camera(&world, &[lamp]), None);
    }
}
