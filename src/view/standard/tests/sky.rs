//! Skyboxes and environment maps of views, as what is around all.

use super::{add, app, problems};
use crate::scene::{Environment, EnvironmentMap};
use crate::sync::Traced;
use crate::view::TracedView;
use bevy::asset::RenderAssetUsages;
use bevy::camera::Exposure;
use bevy::light::{EnvironmentMapLight, GeneratedEnvironmentMapLight, LightProbe, Skybox};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

/// Red towards +X, black elsewhere.
fn cube(app: &mut App) -> Handle<Image> {
    let size = Extent3d {
        width: 1,
        height: 1,
        depth_or_array_layers: 6,
    };
    let mut data = vec![0; 24];
    data[0] = 255;
    let usage = RenderAssetUsages::default();
    let format = TextureFormat::Rgba8Unorm;
    add(
        app,
        Image::new(size, TextureDimension::D2, data, format, usage),
    )
}

fn red(app: &App, direction: Vec3) -> f32 {
    let traced = app.world().resource::<Traced>();
    traced.world.environment.radiance(direction).x
}

fn lights(app: &App) -> bool {
    app.world().resource::<Traced>().world.environment.lights
}

/// What the camera sees in its place.
fn backdrop(app: &App) -> Option<Vec3> {
    app.world().resource::<Traced>().world.environment.backdrop
}

#[test]
fn a_skybox_is_seen_around_the_scene_as_bright_and_turned_as_bevys_until_it_goes() {
    let mut app = app();
    let image = Some(cube(&mut app));
    let brightness = 100.0;
    let skybox = Skybox {
        image,
        brightness,
        ..default()
    };
    let view = app.world_mut().spawn((TracedView::default(), skybox)).id();
    assert_eq!(problems(&mut app), Vec::<String>::new());
    let wanted = brightness * Exposure::default().exposure();
    let found = red(&app, Vec3::X);
    assert!(
        (found - wanted).abs() < 1e-4 * wanted,
        "{found}, not {wanted}"
    );
    assert_eq!((red(&app, Vec3::NEG_X), lights(&app)), (0.0, false));
    let mut skybox = app.world_mut().get_mut::<Skybox>(view).unwrap();
    // What was to the right is straight ahead then.
    skybox.rotation = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    app.update();
    let found = [red(&app, Vec3::NEG_Z), red(&app, Vec3::X)];
    assert!((found[0] - wanted).abs() < 1e-4 * wanted, "{found:?}");
    assert_eq!(found[1], 0.0);
    let mut skybox = app.world_mut().get_mut::<Skybox>(view).unwrap();
    skybox.rotation = Quat::from_rotation_x(1.0);
    let named = problems(&mut app);
    assert_eq!(named.len(), 1, "{named:#?}");
    assert!(named[0].contains("vertical axis"), "{named:#?}");
    app.world_mut().entity_mut(view).remove::<Skybox>();
    assert_eq!(problems(&mut app), Vec::<String>::new());
    let environment = app.world().resource::<Environment>();
    assert_eq!(*environment, Environment::default());
    assert_eq!(app.world().resource::<EnvironmentMap>().0, None);
}

#[test]
fn an_environment_map_lights_the_scene_and_what_of_it_is_not_bevys_is_named() {
    let mut app = app();
    let environment_map = cube(&mut app);
    let light = GeneratedEnvironmentMapLight {
        environment_map: environment_map.clone(),
        intensity: 100.0,
        ..default()
    };
    let view = app.world_mut().spawn((TracedView::default(), light)).id();
    app.world_mut().resource_mut::<Environment>().background = LinearRgba::GREEN;
    assert_eq!(problems(&mut app), Vec::<String>::new());
    assert!(lights(&app) && red(&app, Vec3::X) > 0.0);
    assert_eq!(
        backdrop(&app),
        Some(Vec3::Y),
        "as Bevy shows the clear colour"
    );
    let skybox = |brightness| Skybox {
        image: Some(environment_map.clone()),
        brightness,
        ..default()
    };
    app.world_mut().entity_mut(view).insert(skybox(100.0));
    assert_eq!(problems(&mut app), Vec::<String>::new());
    assert!(lights(&app));
    assert_eq!(backdrop(&app), None);
    app.world_mut().entity_mut(view).insert(skybox(50.0));
    let named = problems(&mut app);
    assert!(
        named.len() == 1 && named[0].contains("as bright as"),
        "{named:#?}"
    );
}

#[test]
fn a_sky_of_plain_colours_that_is_meant_for_the_card_alone_is_traced_too() {
    let mut app = app();
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let light = EnvironmentMapLight {
        intensity: 200.0,
        ..EnvironmentMapLight::solid_color(&mut images, Color::linear_rgb(0.5, 0.0, 0.0))
    };
    app.world_mut().spawn((TracedView::default(), light));
    app.update();
    let wanted = 100.0 * Exposure::default().exposure();
    let found = red(&app, Vec3::new(0.3, 0.5, -0.7));
    assert!(
        (found - wanted).abs() < 1e-3 * wanted,
        "{found}, not {wanted}"
    );
}

#[test]
fn a_sky_of_another_view_a_probes_and_one_beside_the_apps_own_are_named() {
    let mut app = app();
    let image = Some(cube(&mut app));
    let skybox = Skybox {
        image,
        brightness: 100.0,
        ..default()
    };
    app.world_mut().spawn(TracedView::default());
    let second = app.world_mut().spawn((TracedView::default(), skybox)).id();
    let named = problems(&mut app);
    assert!(
        named.len() == 1 && named[0].contains("first view"),
        "{named:#?}"
    );
    app.world_mut().entity_mut(second).despawn();
    let probe = app.world_mut().spawn(LightProbe::default()).id();
    let named = problems(&mut app);
    assert!(
        named.len() == 1 && named[0].contains("light probe"),
        "{named:#?}"
    );
    app.world_mut().entity_mut(probe).despawn();
    assert_eq!(problems(&mut app), Vec::<String>::new());
    let own = cube(&mut app);
    app.insert_resource(EnvironmentMap(Some(own.clone())));
    let other = Some(cube(&mut app));
    let mut views = app.world_mut().query_filtered::<Entity, With<TracedView>>();
    let view = views.single(app.world()).unwrap();
    let skybox = Skybox {
        image: other,
        brightness: 100.0,
        ..default()
    };
    app.world_mut().entity_mut(view).insert(skybox);
    let named = problems(&mut app);
    assert!(
        named.len() == 1 && named[0].contains("has one"),
        "{named:#?}"
    );
    assert_eq!(app.world().resource::<EnvironmentMap>().0, Some(own));
}
