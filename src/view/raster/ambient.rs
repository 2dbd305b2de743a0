//! What is the same from all around, as the ambient light of the scene's cameras.

use super::exposure;
use crate::scene::Environment;
use bevy::color::{Color, ColorToComponents, LinearRgba};
use bevy::light::AmbientLight;
use bevy::prelude::{Bundle, Component, DetectChanges, Query, Ref, Res};

/// What a white surface shows where no light reaches it. The tracer shows black there; a little more
/// keeps an unlit scene in sight.
const AMBIENT: f32 = 0.1;

/// The light that is everywhere in the raster view, for its camera: the scene's dome from now on.
pub(in crate::view) fn ambient() -> impl Bundle {
    (HasSceneAmbient, ambient_of(&Environment::default()))
}

/// On cameras whose ambient light is the scene's.
#[derive(Component, Clone)]
pub(super) struct HasSceneAmbient;

fn ambient_of(environment: &Environment) -> AmbientLight {
    let is_dome = environment.lights && environment.map.is_none();
    let dome = match is_dome {
        true => environment.background,
        false => LinearRgba::BLACK,
    };
    let [red, green, blue] = dome.to_f32_array_no_alpha().map(|c| c.max(AMBIENT));
    AmbientLight {
        color: Color::linear_rgb(red, green, blue),
        brightness: exposure().exposure().recip(),
        ..AmbientLight::default()
    }
}

/// What is the same from all around lights the raster view too, if without shadows.
pub(super) fn give_ambient(
    environment: Option<Res<Environment>>,
    mut cameras: Query<(Ref<HasSceneAmbient>, &mut AmbientLight)>,
) {
    let Some(environment) = environment else {
        return;
    };
    for (has, mut ambient) in &mut cameras {
        if environment.is_changed() || has.is_added() {
            *ambient = ambient_of(&environment);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::prelude::{App, PostUpdate};

    #[test]
    fn a_dome_of_one_colour_is_the_ambient_light_of_the_scenes_cameras_alone() {
        let mut app = App::new();
        app.insert_resource(Environment {
            background: LinearRgba::rgb(0.5, 0.25, 0.0),
            ..Environment::default()
        })
        .add_systems(PostUpdate, give_ambient);
        let world = app.world_mut();
        let [ours, other] = [
            world.spawn(ambient()).id(),
            world.spawn(AmbientLight::default()).id(),
        ];
        let color = |app: &App, camera| {
            let ambient = app.world().get::<AmbientLight>(camera).unwrap();
            LinearRgba::from(ambient.color).to_f32_array_no_alpha()
        };
        app.update();
        assert_eq!(color(&app, ours), [AMBIENT; 3], "it does not light");
        app.world_mut().resource_mut::<Environment>().lights = true;
        app.update();
        assert_eq!(color(&app, ours), [0.5, 0.25, AMBIENT]);
        assert_eq!(color(&app, other), [1.0; 3], "an app's own");
    }
}
