//! What is all around a scene of Bevy's, its skybox and its environment map, as our one dome.

use super::lights::ViewExposure;
use crate::scene::{Environment, EnvironmentMap};
use crate::sync::LeftOut;
use crate::view::TracedView;
use bevy::asset::{Assets, Handle, RenderAssetUsages};
use bevy::image::Image;
use bevy::light::{
    AtmosphereEnvironmentMapLight, EnvironmentMapLight, GeneratedEnvironmentMapLight, Skybox,
};
use bevy::math::Quat;
use bevy::prelude::{DetectChangesMut, Entity, Has, Local, Query, Res, ResMut, With};

/// What of [`Environment`] is Bevy's.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sky {
    /// A cube.
    map: Option<Handle<Image>>,
    /// About the vertical axis, in radians.
    rotation: f32,
    intensity: f32,
    lights: bool,
    /// Bevy's card shows the clear colour in its place.
    hidden: bool,
}

/// A cube of pictures around a view, what multiplies it in cd/m², and how it is turned.
#[derive(PartialEq)]
struct Cube<'a> {
    picture: &'a Handle<Image>,
    luminance: f32,
    rotation: Quat,
}

type Around = (
    Option<&'static Skybox>,
    Option<&'static EnvironmentMapLight>,
    Option<&'static GeneratedEnvironmentMapLight>,
    Has<AtmosphereEnvironmentMapLight>,
);

/// The sky of the first view is around all, unless the app has set one of its own.
pub(super) fn map_sky(
    views: Query<(Entity, Around), With<TracedView>>,
    exposure: Res<ViewExposure>,
    mut images: ResMut<Assets<Image>>,
    mut environment: ResMut<Environment>,
    mut map: ResMut<EnvironmentMap>,
    mut last: Local<Sky>,
    mut left_out: ResMut<LeftOut>,
) {
    let first = views.iter().min_by_key(|(view, _)| view.index_u32());
    let (first, wanted) = match first {
        Some((first, around)) => (Some(first), sky(around, exposure.0).0),
        None => (None, Sky::default()),
    };
    let of_app = environment.map.is_some() || map.0 != last.map;
    for (view, around) in &views {
        let (own, mut notes) = sky(around, exposure.0);
        if own.map.is_some() && of_app {
            notes = vec!["its sky is left out: the app's `Environment` has one"];
        } else if Some(view) != first && own != wanted {
            notes = vec!["its sky is left out: that of the first view is around all"];
        }
        let notes = notes.into_iter().map(str::to_owned).collect();
        LeftOut::note(&mut left_out, "sky of view", view, notes);
    }
    if *last == wanted || of_app {
        return;
    }
    if let Some(map) = &wanted.map {
        keep_pixels(images.bypass_change_detection(), map);
    }
    map.set_if_neq(EnvironmentMap(wanted.map.clone()));
    let none = Environment::default();
    let is_there = wanted.map.is_some();
    environment.rotation = if is_there {
        wanted.rotation
    } else {
        none.rotation
    };
    environment.intensity = if is_there {
        wanted.intensity
    } else {
        none.intensity
    };
    environment.lights = wanted.lights;
    environment.hidden = wanted.hidden;
    *last = wanted;
}

/// What a view has around it as one sky, and what is left out of it.
fn sky(
    (skybox, map, generated, of_atmosphere): (
        Option<&Skybox>,
        Option<&EnvironmentMapLight>,
        Option<&GeneratedEnvironmentMapLight>,
        bool,
    ),
    exposure: f32,
) -> (Sky, Vec<&'static str>) {
    let seen = skybox.and_then(|sky| {
        Some(Cube {
            picture: sky.image.as_ref()?,
            luminance: sky.brightness,
            rotation: sky.rotation,
        })
    });
    let generated = generated.map(|light| Cube {
        picture: &light.environment_map,
        luminance: light.intensity,
        rotation: light.rotation,
    });
    // What is generated becomes one of the other kind, too, which the card alone has.
    let light = generated.or(map.map(|light| Cube {
        picture: &light.specular_map,
        luminance: light.intensity,
        rotation: light.rotation,
    }));
    let light = light.filter(|light| light.luminance > 0.0 && !of_atmosphere);
    let mut notes = Vec::new();
    if let (Some(seen), Some(light)) = (&seen, &light)
        && seen != light
    {
        notes.push(
            "its environment map is left out: the skybox lights the scene, as bright as it is seen",
        );
    }
    let (lights, hidden) = (light.is_some(), seen.is_none());
    let Some(cube) = seen.or(light) else {
        return (Sky::default(), notes);
    };
    let [x, y, z, w] = cube.rotation.to_array();
    if x.hypot(z) > 1e-3 {
        notes.push("its sky is turned about the vertical axis alone");
    }
    let sky = Sky {
        map: Some(cube.picture.clone()),
        rotation: 2.0 * y.atan2(w),
        intensity: cube.luminance * exposure,
        lights,
        hidden,
    };
    (sky, notes)
}

/// A picture that is meant for the card alone keeps its pixels here, where they have not gone there yet.
fn keep_pixels(images: &mut Assets<Image>, map: &Handle<Image>) {
    if let Some(image) = images.get_mut_untracked(map)
        && image.data.is_some()
    {
        image.asset_usage |= RenderAssetUsages::MAIN_WORLD;
    }
}
