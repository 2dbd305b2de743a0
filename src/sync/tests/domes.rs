//! Environments that light, as apps have them: whatever their picture is, something is lit or a note says why not.

use super::*;
use crate::scene::{Environment, EnvironmentMap, RenderSettings};
use crate::trace::{DOME, Dome};
use bevy::math::Vec3;

/// A scene below an environment that lights, with that picture of floats.
fn below(width: u32, height: u32, texels: &[[f32; 4]]) -> App {
    let mut app = app();
    app.update();
    let data = texels.as_flattened().iter().flat_map(|c| c.to_ne_bytes());
    let mut image = Image::new_uninit(
        Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        TextureFormat::Rgba32Float,
        RenderAssetUsages::MAIN_WORLD,
    );
    image.data = Some(data.collect());
    let map = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    app.insert_resource(EnvironmentMap(Some(map)));
    app.world_mut().insert_resource(Environment {
        background: LinearRgba::rgb(0.5, 0.5, 0.5),
        lights: true,
        samples: 3,
        ..Environment::default()
    });
    app.update();
    app
}

/// What comes from straight above, where there is a dome.
fn from_above(app: &App) -> Option<f32> {
    let world = world(app);
    let dome = Dome::of(&world.environment, &RenderSettings::default())?;
    Some(dome.radiance(Vec3::Y).x)
}

#[test]
fn a_dome_without_pixels_is_the_background_and_says_so() {
    let app = below(0, 0, &[]);
    let notes = problems(&app);
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].contains("no pixels"), "{}", notes[0]);
    assert_eq!(from_above(&app), Some(0.5));
}

#[test]
fn a_black_dome_is_none_and_needs_no_note() {
    let app = below(2, 2, &[[0.0, 0.0, 0.0, 1.0]; 4]);
    assert_eq!(from_above(&app), None);
    assert!(problems(&app).is_empty());
}

#[test]
fn texels_that_light_cannot_have_are_counted_and_the_dome_stays_finite() {
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    for (texel, most) in [(inf, 1e30), (nan, 0.0), (-3.0, 0.0)] {
        let mut texels = [[0.0, 0.0, 0.0, 1.0]; 8];
        texels[1] = [texel, texel, texel, 1.0];
        texels[6] = [1.0; 4];
        let app = below(4, 2, &texels);
        let notes = problems(&app);
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(notes[0].contains("1 texels"), "{}", notes[0]);
        let found = from_above(&app).unwrap();
        assert!((0.0..=most).contains(&found), "{texel}: {found}");
    }
}

#[test]
fn one_texel_is_a_dome_of_one_colour() {
    let app = below(1, 1, &[[0.25, 0.25, 0.25, 1.0]]);
    assert_eq!(from_above(&app), Some(0.25));
    assert!(problems(&app).is_empty());
    let settings = RenderSettings::default();
    let world = world(&app);
    let dome = world.lamps(&settings).find(|lamp| lamp.id() == DOME);
    assert_eq!(dome.and_then(|dome| dome.samples(&settings)), Some(3));
}

#[test]
fn switching_it_on_is_one_edit_of_the_environment_and_keeps_its_picture() {
    let mut app = below(1, 1, &[[1.0; 4]]);
    let before = world(&app);
    app.world_mut().resource_mut::<Environment>().lights = false;
    let changes = frame(&mut app);
    assert_eq!(
        changes,
        Changes {
            environment: true,
            ..Changes::default()
        }
    );
    assert_eq!(from_above(&app), None);
    let maps = [&before, &world(&app)].map(|world| world.environment.map.clone().unwrap());
    assert!(Arc::ptr_eq(&maps[0], &maps[1]));
    let mut environment = app.world_mut().resource_mut::<Environment>();
    environment.lights = true;
    environment.samples = 0;
    app.update();
    assert_eq!(
        problems(&app),
        ["environment 0: its samples is 0, out of range; 1 is used"]
    );
}
