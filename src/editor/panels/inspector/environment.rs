//! What a ray carries that meets nothing: a colour, or a picture around the scene.

use super::super::fields::{Number, angle, integer, radiant, section, switch};
use super::super::state::Panels;
use super::maps::{Map, Owner, map_ui};
use crate::scene::{Environment, EnvironmentMap};
use bevy::ecs::world::World;
use bevy_egui::egui::Ui;

const SAMPLES: &str = "Shadow rays to it at the first hit of each pixel, shared by the pixel's samples: more makes its light less noisy";

pub(super) fn environment_ui(ui: &mut Ui, world: &mut World, panels: &mut Panels) {
    let before = world.resource::<Environment>().clone();
    let mut environment = before.clone();
    let loaded = world.resource::<EnvironmentMap>().0.clone();
    section(ui, "Environment", true, |ui| {
        let says = "What is seen where there is nothing, and no picture";
        radiant(ui, "Background", says, &mut environment.background, false);
        let map = Map {
            label: "Picture",
            says: "A panorama around the scene: background, reflections and, if it is to, light",
            loaded: loaded.as_ref(),
            owner: Owner::Environment,
        };
        map_ui(ui, world, panels, &map, &mut environment.map, false);
        if environment.map.is_some() {
            let says = "Turns the picture about the vertical axis";
            angle(
                ui,
                "Rotation",
                says,
                &mut environment.rotation,
                [-180.0, 180.0],
                false,
            );
            let says = "Multiplies the picture";
            let intensity = &mut environment.intensity;
            Number::positive(0.01, "×").row(ui, "Intensity", says, intensity, false);
        }
        let says = "Light comes from all of it, with shadows: a sky, suns in a picture. Not with Classic lighting";
        switch(ui, "Lights the scene", says, &mut environment.lights, false);
        if environment.lights {
            let samples = &mut environment.samples;
            integer(ui, "Samples", SAMPLES, samples, 1..=1000, false);
        }
    });
    if environment != before {
        *world.resource_mut::<Environment>() = environment;
    }
}
