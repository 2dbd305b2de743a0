//! What a view says of its picture, and how it is told to render.

use super::{Game, PATIENCE, RED, SHOWN_RED, SIZE};
use bevy::prelude::*;
use glassbox::film::Ending;
use glassbox::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// What an app is told.
#[derive(Resource, Default)]
struct Told {
    converged: Vec<(Entity, Ending)>,
    failed: Vec<String>,
    reference: Option<Arc<TracedPicture>>,
}

fn listen(game: &mut Game) {
    game.app.init_resource::<Told>();
    game.app
        .add_observer(|done: On<Converged>, mut told: ResMut<Told>| {
            told.converged.push((done.entity, done.ending));
        });
    game.app
        .add_observer(|failed: On<Failed>, mut told: ResMut<Told>| {
            told.failed.push(failed.problem.clone());
        });
    game.app
        .add_observer(|done: On<ReferenceRendered>, mut told: ResMut<Told>| {
            told.reference = Some(done.picture.clone());
        });
}

fn wait_until(game: &mut Game, what: &str, is_so: impl Fn(&Told) -> bool) {
    let start = Instant::now();
    while !is_so(game.app.world().resource::<Told>()) {
        game.app.update();
        assert!(start.elapsed() < PATIENCE, "{what} did not happen");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

fn level(color: f32) -> u8 {
    (color * 255.0).round() as u8
}

#[test]
fn each_view_says_once_that_it_is_done_and_gives_its_picture_in_its_own_settings() {
    let Some(mut game) = Game::open() else {
        return;
    };
    listen(&mut game);
    let view = game.view(RED, None, 0);
    let own = ViewSettings {
        size: Some(UVec2::new(20, 10)),
        spp: Some(4),
        ..default()
    };
    game.app.world_mut().entity_mut(view).insert(own);
    wait_until(&mut game, "convergence", |told| !told.converged.is_empty());
    // The first pictures may be of a scene whose trees are still being built.
    game.wait_for_pictures();
    let count = |game: &Game| game.app.world().resource::<Told>().converged.len();
    let before = count(&game);
    for _ in 0..20 {
        game.app.update();
    }
    assert_eq!(count(&game), before, "it is told once");
    let told = game.app.world().resource::<Told>();
    assert_eq!(told.converged.last(), Some(&(view, Ending::Samples)));
    let render = game.app.world().get::<TracedRender>(view).unwrap();
    assert_eq!(render.status().unwrap().samples, 4.0);
    let picture = render.picture().unwrap();
    assert_eq!(picture.size(), UVec2::new(20, 10));
    assert_eq!(picture.linear.pixel(10, 5).x, 0.5);
    let shown = picture.image().get_color_at(10, 5).unwrap().to_srgba();
    assert!(level(shown.red).abs_diff(SHOWN_RED) <= 1, "{shown:?}");
    // It fills the viewport all the same.
    assert_eq!(game.shot().pixel(SIZE.x - 1, SIZE.y - 1)[1..], [0, 0]);
}

#[test]
fn a_paused_view_keeps_the_picture_of_a_scene_that_goes_on() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let view = game.view(RED, None, 0);
    game.wait_for_pictures();
    let pause = |game: &mut Game, paused| {
        let mut view = game.app.world_mut().get_mut::<TracedView>(view).unwrap();
        view.paused = paused;
    };
    pause(&mut game, true);
    let mut camera = game.app.world_mut().get_mut::<Transform>(view).unwrap();
    camera.rotate_y(std::f32::consts::PI);
    for _ in 0..50 {
        game.app.update();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert_eq!(game.shot().seen(48, 32), super::Seen::Red);
    pause(&mut game, false);
    let start = Instant::now();
    while game.shot().seen(48, 32) != super::Seen::Green {
        assert!(start.elapsed() < PATIENCE, "it does not go on");
    }
}

#[test]
fn a_reference_picture_is_rendered_beside_the_game_and_leaves_nothing_behind() {
    let Some(mut game) = Game::open() else {
        return;
    };
    listen(&mut game);
    let camera = game.camera(RED, None, 0);
    for _ in 0..3 {
        game.app.update();
    }
    let settings = RenderSettings {
        size: UVec2::new(16, 8),
        spp: 2,
        ..default()
    };
    let wanted = settings.clone();
    let mut commands = game.app.world_mut().commands();
    let rendered = render_reference(&mut commands, camera, wanted).id();
    game.app.world_mut().flush();
    wait_until(&mut game, "a picture", |told| told.reference.is_some());
    let told = game.app.world().resource::<Told>();
    let picture = told.reference.as_ref().unwrap();
    assert_eq!(picture.size(), UVec2::new(16, 8));
    assert_eq!(picture.linear.pixel(8, 4).x, 0.5);
    assert!(game.app.world().get_entity(rendered).is_err());
    let mut commands = game.app.world_mut().commands();
    let lost = render_reference(&mut commands, rendered, settings).id();
    game.app.world_mut().flush();
    wait_until(&mut game, "the failure", |told| !told.failed.is_empty());
    let told = game.app.world().resource::<Told>();
    assert_eq!(told.failed, ["the camera is gone"]);
    assert!(game.app.world().get_entity(lost).is_err());
}

#[test]
fn a_reference_picture_of_a_scene_that_never_stands_still_is_of_the_frame_that_asked_for_it() {
    let Some(mut game) = Game::open() else {
        return;
    };
    listen(&mut game);
    let camera = game.camera(RED, None, 0);
    let shape = |i: usize| Sphere::new(1.0 + 0.1 * (i % 3) as f32).mesh().uv(300, 200);
    let world = game.app.world_mut();
    let ball = world.resource_mut::<Assets<Mesh>>().add(shape(0));
    let glow = Phong {
        diffuse: LinearRgba::BLACK,
        emission: LinearRgba::GREEN * 0.5,
        ..default()
    };
    let place = Transform::from_xyz(0.0, 0.0, -4.0);
    let flies = world.spawn((Mesh3d(ball.clone()), glow, place)).id();
    // In each frame its tree is another one, which is not there before the frame ends.
    for i in 0..40 {
        let world = game.app.world_mut();
        let mut meshes = world.resource_mut::<Assets<Mesh>>();
        meshes.insert(ball.id(), shape(i)).unwrap();
        if i == 5 {
            let settings = RenderSettings {
                size: UVec2::new(16, 8),
                spp: 2,
                ..default()
            };
            render_reference(&mut world.commands(), camera, settings);
            world.flush();
        } else if i > 5 {
            // Far away from where it was when the picture was asked for.
            let mut place = world.get_mut::<Transform>(flies).unwrap();
            place.translation.y = 50.0;
        }
        game.app.update();
    }
    wait_until(&mut game, "a picture", |told| told.reference.is_some());
    let told = game.app.world().resource::<Told>();
    let picture = told.reference.as_ref().unwrap();
    let middle = picture.linear.pixel(8, 4);
    assert_eq!([middle.x, middle.y], [0.0, 0.5], "the ball, as it stood");
}
