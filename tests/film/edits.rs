//! Lamps that are edited while a built-in scene is rendered: entity, snapshot and render together.

use bevy::app::App;
use bevy::color::LinearRgba;
use bevy::ecs::component::{Component, Mutable};
use bevy::math::{UVec2, Vec3};
use bevy::transform::components::Transform;
use glassbox::app::headless_app;
use glassbox::film::Progressive;
use glassbox::io::{OpenOptions, SceneSource, builtin, open};
use glassbox::scene::{DirectionalLamp, ParallelogramLamp, PointLamp, RenderSettings, SegmentLamp};
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::Gains;
use std::path::Path;

/// Changes every lamp of a kind; whether there is one.
fn change<L: Component<Mutability = Mutable>>(app: &mut App, edit: impl Fn(&mut L)) -> bool {
    let mut lamps = app.world_mut().query::<&mut L>();
    let mut found = false;
    for mut lamp in lamps.iter_mut(app.world_mut()) {
        edit(&mut lamp);
        found = true;
    }
    found
}

fn start(app: &App) -> Progressive {
    let world = app.world();
    let settings = RenderSettings {
        size: UVec2::new(48, 36),
        spp: 4,
        ..world.resource::<RenderSettings>().clone()
    };
    let camera = world.resource::<TracedCameras>().0[0].camera.clone();
    let render = Progressive::start(
        (*world.resource::<Traced>().world).clone(),
        camera,
        settings,
    );
    let render = render.unwrap();
    render.wait();
    render
}

fn edit(app: &mut App, render: &Progressive) -> bool {
    app.update();
    let taken = render.edit(
        (*app.world().resource::<Traced>().world).clone(),
        &Gains::default(),
    );
    render.wait();
    taken
}

#[test]
fn another_colour_of_every_lamp_takes_no_ray_in_any_built_in_scene() {
    let mut lit = 0;
    for scene in builtin::SCENES {
        let mut app = headless_app();
        let source = SceneSource::named(Path::new(scene.name));
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        let render = start(&app);
        let rays = render.status().rays;
        let color = LinearRgba::rgb(0.25, 1.0, 0.5);
        let found = [
            change::<PointLamp>(&mut app, |lamp| lamp.color = color),
            change::<DirectionalLamp>(&mut app, |lamp| lamp.color = color),
            // Of a lamp with a gradient a factor that is a power of two leaves the gradient as it is.
            change::<SegmentLamp>(&mut app, |lamp| lamp.intensity *= 0.5),
            change::<ParallelogramLamp>(&mut app, |lamp| lamp.intensity *= 2.0),
        ];
        if !found.contains(&true) {
            continue;
        }
        lit += 1;
        assert!(edit(&mut app, &render), "{}", scene.name);
        assert_eq!(render.status().rays, rays, "{}", scene.name);
        let fresh = start(&app);
        assert_eq!(
            render.snapshot().picture,
            fresh.snapshot().picture,
            "{}",
            scene.name
        );
        assert_eq!(
            render.film().picture(),
            fresh.film().picture(),
            "{}",
            scene.name
        );
    }
    assert!(lit >= 8, "only {lit} scenes have lamps");
}

#[test]
fn a_lamp_that_moves_has_its_own_light_traced_again_and_what_is_seen_or_in_the_way_everything() {
    let mut app = headless_app();
    let source = SceneSource::named(Path::new("showcase"));
    open(app.world_mut(), &source, OpenOptions::default()).unwrap();
    app.update();
    let render = start(&app);
    let whole = render.status().rays.total();
    let mut lamps = app.world_mut().query::<(&mut Transform, &PointLamp)>();
    let (mut transform, _) = lamps
        .iter_mut(app.world_mut())
        .next()
        .expect("a point lamp");
    transform.translation += Vec3::new(0.2, 0.1, -0.1);
    assert!(edit(&mut app, &render));
    let fresh = start(&app);
    assert_eq!(render.snapshot().picture, fresh.snapshot().picture);
    let more = render.status().rays.total() - whole;
    assert!(more < fresh.status().rays.total(), "{more} rays of {whole}");
    // An object that moved is in the way of other paths.
    let mut objects = app
        .world_mut()
        .query::<(&mut Transform, &bevy::mesh::Mesh3d)>();
    let (mut transform, _) = objects.iter_mut(app.world_mut()).next().unwrap();
    transform.translation.x += 0.1;
    assert!(!edit(&mut app, &render));
}
