//! Cameras with their lens, and what moves while the shutter is open.

use super::super::fields::{Number, angle, choice, integer, point, row, section};
use super::super::says::Says;
use super::super::several::Several;
use crate::editor::action::Action;
use crate::scene::{Lens, MeshSource, Motion, Projection, SceneCamera, SceneId};
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::mesh::Mesh3d;
use bevy_egui::egui::Ui;

pub(super) fn camera_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let Some(mut several) = Several::<SceneCamera>::of(world, entities) else {
        return;
    };
    section(ui, "Camera", true, |ui| {
        let says = "Shows the scene as this camera sees it";
        if ui.button("Look through").says(says).clicked()
            && let Some(&id) = world.get::<SceneId>(entities[0])
        {
            world.write_message(Action::LookThrough(Some(id)));
        }
        projection_ui(ui, &mut several);
        let says = "The part of the time from 0 to 1 in which light arrives: what moves is smeared";
        several.field(
            |camera| &mut camera.shutter_open,
            |value, mixed| {
                Number::slider(0.0, 1.0, "").row(ui, "Shutter opens", says, value, mixed)
            },
        );
        several.field(
            |camera| &mut camera.shutter_close,
            |value, mixed| {
                Number::slider(0.0, 1.0, "").row(ui, "Shutter closes", says, value, mixed)
            },
        );
        if several.first().shutter_open > several.first().shutter_close {
            // The one that was not entered gives way.
            several.change(|camera| {
                let (open, close) = (camera.shutter_open, camera.shutter_close);
                camera.shutter_open = open.min(close);
                camera.shutter_close = open.max(close);
            });
        }
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
        "Depth of field: what is not at the focus distance is blurred",
        lens_ui,
    );
}

fn projection_ui(ui: &mut Ui, several: &mut Several<SceneCamera>) {
    several.field(
        |camera| &mut camera.projection,
        |value, mixed| {
            let mut perspective = matches!(value, Projection::Perspective { .. });
            let changed = choice(
                ui,
                "Projection",
                "How directions become places in the picture",
                &mut perspective,
                &[
                    (true, "Perspective", "Far things are small"),
                    (false, "Orthographic", "Far things keep their size"),
                ],
                mixed,
            );
            if changed {
                *value = match perspective {
                    true => Projection::default(),
                    false => Projection::Orthographic { height: 2.0 },
                };
            }
            changed
        },
    );
    several.field(
        |camera| &mut camera.projection,
        |value, mixed| match value {
            Projection::Perspective { fov_y } => angle(
                ui,
                "Field of view",
                "The angle from the picture's lower to its upper edge",
                fov_y,
                [1.0, 170.0],
                mixed,
            ),
            Projection::Orthographic { height } => {
                Number::positive(0.01, "m").within(1e-4, 1e6).row(
                    ui,
                    "Height",
                    "What the picture's height shows",
                    height,
                    mixed,
                )
            }
        },
    );
}

fn lens_ui(ui: &mut Ui, several: &mut Several<Lens>) {
    several.field(
        |lens| &mut lens.aperture_radius,
        |value, mixed| {
            let says = "Radius of the opening: larger blurs more; 0 is a pinhole, all sharp";
            Number::positive(0.001, "m").row(ui, "Aperture", says, value, mixed)
        },
    );
    several.field(
        |lens| &mut lens.focus_distance,
        |value, mixed| {
            let says = "Metres along the view axis to the plane that is sharp; inf is far away";
            Number::positive(0.01, "m")
                .within(1e-4, f32::INFINITY)
                .row(ui, "Focus", says, value, mixed)
        },
    );
    several.field(
        |lens| &mut lens.samples,
        |value, mixed| {
            let says =
                "Samples of each pixel that the lens asks for: more makes the blur less noisy";
            integer(ui, "Samples", says, value, 1..=1000, mixed)
        },
    );
}

pub(super) fn motion_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let movable: Vec<Entity> = entities
        .iter()
        .copied()
        .filter(|&entity| {
            let has_mesh =
                world.get::<Mesh3d>(entity).is_some() || world.get::<MeshSource>(entity).is_some();
            has_mesh || world.get::<SceneCamera>(entity).is_some()
        })
        .collect();
    optional_ui::<Motion>(
        ui,
        world,
        &movable,
        "Motion",
        "It moves while the shutter is open, and is smeared along its way",
        |ui, several| {
            several.field(
                |motion| &mut motion.velocity,
                |value, mixed| {
                    let says = "Metres that it covers from time 0 to 1, in its parent's space";
                    point(ui, "Velocity", says, value, Number::free(0.01, ""), mixed)
                },
            );
            several.field(
                |motion| &mut motion.samples,
                |value, mixed| {
                    let says = "Samples of each pixel that the motion asks for";
                    integer(ui, "Samples", says, value, 1..=1000, mixed)
                },
            );
        },
    );
}

/// A component that some have and others do not: buttons add and remove it.
fn optional_ui<C>(
    ui: &mut Ui,
    world: &mut World,
    entities: &[Entity],
    name: &str,
    says: &str,
    body: impl FnOnce(&mut Ui, &mut Several<C>),
) where
    C: Component<Mutability = Mutable> + Clone + PartialEq + Default,
{
    if entities.is_empty() {
        return;
    }
    let Some(mut several) = Several::<C>::of(world, entities) else {
        row(ui, name, says, |ui| {
            if ui.button("Add").says(says).clicked() {
                for &entity in entities {
                    world.entity_mut(entity).insert(C::default());
                }
            }
        });
        return;
    };
    let mut remove = false;
    let mut complete = false;
    section(ui, name, true, |ui| {
        body(ui, &mut several);
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
            world.entity_mut(entity).insert(C::default());
        }
    }
}
