//! Cameras with their lens.

use super::super::fields::{Number, angle, choice, integer, row, section};
use super::super::says::Says;
use super::super::several::Several;
use crate::editor::action::Action;
use crate::scene::{Lens, Projection, SceneCamera, SceneId};
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy_egui::egui::Ui;

pub(super) fn camera_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let Some(mut several) = Several::<SceneCamera>::of(world, entities) else {
        return;
    };
    section(ui, "Camera", true, |ui| {
        let says = "Shows the scene as this camera sees it";
        if ui.button("Look through").says(says).clicked()
            && let Some(id) = first_camera(world, entities)
        {
            world.write_message(Action::LookThrough(Some(id)));
        }
        projection_ui(ui, &mut several);
        let says = "The part of the time from 0 to 1 in which light arrives: what moves is smeared";
        let (mut opens, mut closes) = (false, false);
        several.field(
            |camera| &mut camera.shutter_open,
            |value, mixed| {
                opens = Number::slider(0.0, 1.0, "").row(ui, "Shutter opens", says, value, mixed);
                opens
            },
        );
        several.field(
            |camera| &mut camera.shutter_close,
            |value, mixed| {
                closes = Number::slider(0.0, 1.0, "").row(ui, "Shutter closes", says, value, mixed);
                closes
            },
        );
        order_shutter(&mut several, opens, closes);
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

/// Of what is selected, the active one first, the first that is a camera.
fn first_camera(world: &World, entities: &[Entity]) -> Option<SceneId> {
    let is_camera = |&&entity: &&Entity| world.get::<SceneCamera>(entity).is_some();
    let camera = entities.iter().find(is_camera)?;
    world.get::<SceneId>(*camera).copied()
}

/// No shutter closes before it opens: the time that was not entered gives way, in every camera.
fn order_shutter(several: &mut Several<SceneCamera>, opens: bool, closes: bool) {
    if opens {
        several.change(|camera| {
            camera.shutter_close = camera.shutter_close.max(camera.shutter_open);
        });
    }
    if closes {
        several.change(|camera| {
            camera.shutter_open = camera.shutter_open.min(camera.shutter_close);
        });
    }
}

fn is_perspective(camera: &SceneCamera) -> bool {
    matches!(camera.projection, Projection::Perspective { .. })
}

/// What is entered of one kind of projection reaches the cameras that have it, and no other becomes
/// one of that kind.
fn projection_ui(ui: &mut Ui, several: &mut Several<SceneCamera>) {
    let mut perspective = is_perspective(several.first());
    let mixed = several.any(|camera| is_perspective(camera) != perspective);
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
        several.change(|camera| {
            if is_perspective(camera) != perspective {
                camera.projection = match perspective {
                    true => Projection::default(),
                    false => Projection::Orthographic { height: 2.0 },
                };
            }
        });
    }
    match several.first().projection {
        Projection::Perspective { fov_y } => {
            let other = |camera: &SceneCamera| match camera.projection {
                Projection::Perspective { fov_y: other } => other != fov_y,
                Projection::Orthographic { .. } => false,
            };
            let mut entered = fov_y;
            let changed = angle(
                ui,
                "Field of view",
                "The angle from the picture's lower to its upper edge",
                &mut entered,
                [1.0, 170.0],
                several.any(other),
            );
            if changed {
                several.change(|camera| set_fov(camera, entered));
            }
        }
        Projection::Orthographic { height } => {
            let other = |camera: &SceneCamera| match camera.projection {
                Projection::Perspective { .. } => false,
                Projection::Orthographic { height: other } => other != height,
            };
            let mut entered = height;
            let changed = Number::positive(0.01, "m").within(1e-4, 1e6).row(
                ui,
                "Height",
                "What the picture's height shows",
                &mut entered,
                several.any(other),
            );
            if changed {
                several.change(|camera| set_height(camera, entered));
            }
        }
    }
}

fn set_fov(camera: &mut SceneCamera, entered: f32) {
    if let Projection::Perspective { fov_y } = &mut camera.projection {
        *fov_y = entered;
    }
}

fn set_height(camera: &mut SceneCamera, entered: f32) {
    if let Projection::Orthographic { height } = &mut camera.projection {
        *height = entered;
    }
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

/// A component that some have and others do not: buttons add and remove it.
pub(super) fn optional_ui<C>(
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

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(open: f32, close: f32) -> SceneCamera {
        SceneCamera {
            shutter_open: open,
            shutter_close: close,
            ..SceneCamera::default()
        }
    }

    #[test]
    fn every_camera_s_shutter_closes_after_it_opens_and_what_was_entered_stays() {
        let mut world = World::new();
        let cameras = [camera(0.8, 0.9), camera(0.8, 0.2)].map(|camera| world.spawn(camera).id());
        for (opens, closes, expected) in [
            (false, false, [[0.8, 0.9], [0.8, 0.2]]),
            (true, false, [[0.8, 0.9], [0.8, 0.8]]),
        ] {
            let mut several = Several::<SceneCamera>::of(&world, &cameras).unwrap();
            order_shutter(&mut several, opens, closes);
            several.write(&mut world);
            let shutters = cameras.map(|entity| {
                let camera = world.get::<SceneCamera>(entity).unwrap();
                [camera.shutter_open, camera.shutter_close]
            });
            assert_eq!(shutters, expected);
        }
        let late = world.spawn(camera(0.8, 0.2)).id();
        let mut several = Several::<SceneCamera>::of(&world, &[late]).unwrap();
        order_shutter(&mut several, false, true);
        several.write(&mut world);
        assert_eq!(world.get::<SceneCamera>(late), Some(&camera(0.2, 0.2)));
    }

    #[test]
    fn an_angle_or_a_height_reaches_the_cameras_that_have_one_and_no_other() {
        let mut cameras = [
            Projection::Perspective { fov_y: 1.0 },
            Projection::Orthographic { height: 3.0 },
        ]
        .map(|projection| SceneCamera {
            projection,
            ..SceneCamera::default()
        });
        for camera in &mut cameras {
            set_fov(camera, 0.5);
            set_height(camera, 7.0);
        }
        assert_eq!(
            cameras.map(|camera| camera.projection),
            [
                Projection::Perspective { fov_y: 0.5 },
                Projection::Orthographic { height: 7.0 },
            ]
        );
    }

    #[test]
    fn the_camera_that_is_looked_through_is_the_first_that_is_one() {
        let mut world = World::new();
        let lamp = world.spawn(SceneId(1)).id();
        let cameras = [2, 3].map(|id| world.spawn((SceneId(id), camera(0.0, 1.0))).id());
        let selected = [lamp, cameras[1], cameras[0]];
        assert_eq!(first_camera(&world, &selected), Some(SceneId(3)));
        assert_eq!(first_camera(&world, &[lamp]), None);
    }
}
