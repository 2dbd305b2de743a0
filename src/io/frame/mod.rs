//! What a model file leaves to whoever shows it: where to look from, and by what light.
//!
//! | what is missing | what is added |
//! |---|---|
//! | a camera | one that sees as much as can be seen at once: [`viewpoint`] |
//! | lights | a key, one from behind and a soft dome around, which is seen behind what is dark: [`lights`] |
//! | light enough | exposure, where the file's own lights leave nearly all of it black, or more of them, where something glows that exposure would wash out: [`exposure`] |
//!
//! All of it are ordinary entities and settings of the scene.

mod exposure;
mod lights;
mod surface;
mod viewpoint;

use super::error::Place;
use super::ids::assign_ids;
use super::notes::Notes;
use super::place::world_from;
use crate::scene::{AnyLamp, Environment, Projection, RenderSettings, SceneCamera};
use bevy::ecs::name::Name;
use bevy::ecs::query::QueryFilter;
use bevy::math::Vec3;
use bevy::prelude::{Bundle, Entity, World};
use bevy::transform::components::Transform;
use std::path::Path;
use surface::Surface;
use viewpoint::framing;

/// Gives a scene what it lacks to be seen. Notes say what; `file` is where it came from.
pub(crate) fn frame(world: &mut World, file: &Path, notes: &mut Notes) {
    let mut note = |what: &str, instead| notes.add(file, Place::Whole, what, instead);
    let has_lamps = count::<AnyLamp>(world) > 0;
    let has_dome = (world.get_resource::<Environment>()).is_some_and(|around| around.lights);
    let surface = Surface::of(world);
    if surface.is_without_area() {
        let what = "triangles, and none of them has an area";
        note(what, "nothing is to be seen of them");
    }
    let mut added = Vec::new();
    let eye = match first_camera(world) {
        Some((eye, projection)) => {
            if viewpoint::looks_past(&surface, &eye, projection) {
                let instead = "its picture is empty; choose another or --eye and --look-at";
                note("has a camera that looks past everything", instead);
            }
            eye
        }
        None => {
            let eye = framing(&surface);
            added.push(spawn(world, "Camera", eye, SceneCamera::default()));
            note("has no camera", "one that shows everything was added");
            eye
        }
    };
    if !has_lamps && !has_dome {
        for (name, transform, lamp) in lights::studio(eye) {
            added.push(spawn(world, name, transform, lamp));
        }
        let is_dark = lights::is_dark(world);
        world.insert_resource(lights::dome(is_dark));
        let instead = if is_dark {
            "a key light, one from behind and a soft grey dome, seen as the background, were added"
        } else {
            "a key light, one from behind and a soft dome around it were added"
        };
        note("has no light", instead);
    } else if has_lamps && let Some(stops) = exposure::missing(world, &surface) {
        let glows = exposure::glows(world);
        let (all, instead) = if glows {
            exposure::brighten(world, stops);
            ("all but what glows", "they shine by as much more")
        } else {
            world.resource_mut::<RenderSettings>().output.exposure = stops;
            ("the picture", "the picture is exposed by as much more")
        };
        let what = format!("lights so weak that {all} would be nearly black, by {stops} stops");
        note(&what, instead);
    }
    assign_ids(world, &added);
}

/// Where the first camera stands, and how it projects.
fn first_camera(world: &mut World) -> Option<(Transform, Projection)> {
    let mut cameras = world.query::<(Entity, &SceneCamera)>();
    let (camera, &SceneCamera { projection, .. }) = cameras.iter(world).next()?;
    let place = world_from(world, camera);
    let (forward, up) = (
        place.transform_vector3(-Vec3::Z),
        place.transform_vector3(Vec3::Y),
    );
    let position = Transform::from_translation(place.translation.into());
    Some((position.looking_to(forward, up), projection))
}

fn spawn(world: &mut World, name: &'static str, transform: Transform, what: impl Bundle) -> Entity {
    world.spawn((Name::new(name), transform, what)).id()
}

fn count<F: QueryFilter>(world: &mut World) -> usize {
    world.query_filtered::<Entity, F>().iter(world).count()
}
