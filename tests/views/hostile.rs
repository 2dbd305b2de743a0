//! Apps that take things away while they are traced, and views that nobody would want.

use super::{GREEN, Game, PATIENCE, RED, SIZE, Seen};
use bevy::camera::{RenderTarget, Viewport};
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::window::{WindowRef, WindowResized, WindowResolution};
use glassbox::film::views::View;
use glassbox::prelude::*;
use std::time::{Duration, Instant};

fn problems(game: &mut Game) -> Vec<String> {
    for _ in 0..3 {
        game.app.update();
    }
    let problems = &game.app.world().resource::<Traced>().problems;
    problems.iter().map(ToString::to_string).collect()
}

fn wait_until(game: &mut Game, what: &str, is_so: impl Fn(&mut Game) -> bool) {
    let start = Instant::now();
    while !is_so(game) {
        game.app.update();
        assert!(start.elapsed() < PATIENCE, "{what} did not happen");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn cameras_that_go_while_they_are_rendered_take_nothing_with_them() {
    let Some(mut game) = Game::open() else {
        return;
    };
    game.app.world_mut().resource_mut::<RenderSettings>().spp = 10_000;
    let stays = game.view(GREEN, None, 0);
    for round in 0..12 {
        let goes = game.view(RED, None, 1);
        for _ in 0..round {
            game.app.update();
        }
        game.app.world_mut().entity_mut(goes).despawn();
        game.app.update();
    }
    game.app.world_mut().resource_mut::<RenderSettings>().spp = 2;
    game.wait_for_pictures();
    assert_eq!(game.shot().seen(48, 32), Seen::Green);
    assert!(game.app.world().get::<TracedRender>(stays).is_some());
}

#[test]
fn a_view_of_one_pixel_is_rendered_and_one_of_none_rests() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let tiny = game.view(RED, None, 0);
    let one = Image::new_target_texture(1, 1, TextureFormat::Rgba8UnormSrgb, None);
    let world = game.app.world_mut();
    let whole = game.image.clone();
    game.image = world.resource_mut::<Assets<Image>>().add(one);
    let target = RenderTarget::Image(game.image.clone().into());
    world.entity_mut(tiny).insert(target);
    game.wait_for_pictures();
    assert_eq!(game.shot().seen(0, 0), Seen::Red);
    game.image = whole;
    let view = game.view(GREEN, Some(URect::new(3, 3, 4, 4)), 0);
    game.wait_for_pictures();
    assert_eq!(game.shot().seen(3, 3), Seen::Green);
    let mut camera = game.app.world_mut().get_mut::<Camera>(view).unwrap();
    camera.viewport = Some(Viewport {
        physical_size: UVec2::ZERO,
        ..default()
    });
    // Bevy draws nothing into such a viewport: only what would be rendered for it is asked about.
    camera.is_active = false;
    game.app.update();
    let render = game.app.world().get::<TracedRender>(view).unwrap();
    assert_eq!(render.status(), None, "it renders");
}

#[test]
fn for_a_window_of_no_size_nothing_is_rendered_until_it_has_one() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let resolution = WindowResolution::new(0, 0);
    let window = Window {
        resolution,
        ..default()
    };
    let window = game.app.world_mut().spawn(window).id();
    let view = game.view(GREEN, None, 0);
    let target = RenderTarget::Window(WindowRef::Entity(window));
    game.app.world_mut().entity_mut(view).insert(target);
    let resize = |game: &mut Game, size: UVec2| {
        let world = game.app.world_mut();
        let mut known = world.get_mut::<Window>(window).unwrap();
        known.resolution.set_physical_resolution(size.x, size.y);
        let (width, height) = (size.x as f32, size.y as f32);
        world.write_message(WindowResized {
            window,
            width,
            height,
        });
        for _ in 0..3 {
            game.app.update();
        }
    };
    let rendered = |game: &Game| {
        let render = game.app.world().get::<TracedRender>(view).unwrap();
        render.picture().map(|picture| picture.size())
    };
    for _ in 0..2 {
        resize(&mut game, UVec2::ZERO);
        assert_eq!(rendered(&game), None, "it renders for nobody");
        resize(&mut game, UVec2::new(64, 0));
        assert_eq!(rendered(&game), None, "it renders for nobody");
        for size in [UVec2::ONE, UVec2::new(33, 7)] {
            resize(&mut game, size);
            game.wait_for_pictures();
            assert_eq!(rendered(&game), Some(size));
        }
    }
    game.app.world_mut().entity_mut(window).despawn();
    for _ in 0..3 {
        game.app.update();
    }
}

#[test]
fn assets_that_go_while_they_are_traced_are_named_and_leave_the_rest() {
    let Some(mut game) = Game::open() else {
        return;
    };
    game.view(GREEN, None, 0);
    let mesh = game.wall(30.0);
    let world = game.app.world_mut();
    let picture = Image::new_target_texture(4, 4, TextureFormat::Rgba8UnormSrgb, None);
    let picture = world.resource_mut::<Assets<Image>>().add(picture);
    let material = StandardMaterial {
        unlit: true,
        base_color_texture: Some(picture.clone()),
        ..default()
    };
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(material);
    let object = (
        Mesh3d(mesh.clone()),
        MeshMaterial3d(material.clone()),
        Name::new("Sail"),
        Transform::from_xyz(0.0, 40.0, 0.0),
    );
    world.spawn(object);
    game.wait_for_pictures();
    let world = game.app.world_mut();
    world.resource_mut::<Assets<Image>>().remove(&picture);
    let named = problems(&mut game);
    assert!(named.iter().any(|p| p.contains("Sail")), "{named:#?}");
    let world = game.app.world_mut();
    world
        .resource_mut::<Assets<StandardMaterial>>()
        .remove(&material);
    game.app.update();
    let world = game.app.world_mut();
    world.resource_mut::<Assets<Mesh>>().remove(&mesh);
    let is_named = |problem: &String| problem.contains("\"Sail\": its mesh is not loaded");
    let named = problems(&mut game);
    assert!(named.iter().any(is_named), "{named:#?}");
    game.wait_for_pictures();
    assert_eq!(game.shot().seen(48, 32), Seen::Green);
}

#[test]
fn what_loses_its_place_is_traced_no_more_and_a_camera_that_does_shows_nothing_frozen() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let view = game.view(RED, None, 0);
    game.wait_for_pictures();
    assert_eq!(game.shot().seen(48, 32), Seen::Red);
    let world = game.app.world_mut();
    let mut walls = world.query_filtered::<Entity, (With<Mesh3d>, With<Phong>)>();
    let walls: Vec<Entity> = walls.iter(world).collect();
    for wall in &walls {
        let mut wall = world.entity_mut(*wall);
        wall.remove::<(Transform, GlobalTransform)>();
    }
    game.wait_for_pictures();
    assert_eq!(game.shot().seen(48, 32), Seen::Black);
    for wall in walls {
        let mut wall = game.app.world_mut().entity_mut(wall);
        wall.insert(super::facing_origin(RED, 10.0));
    }
    wait_until(&mut game, "the wall's return", |game| {
        game.shot().seen(48, 32) == Seen::Red
    });
    let mut camera = game.app.world_mut().entity_mut(view);
    camera.remove::<(Transform, GlobalTransform)>();
    game.app.update();
    game.app.update();
    let render = game.app.world().get::<TracedRender>(view);
    let status = render.and_then(TracedRender::status);
    assert_eq!(status, None, "it renders from nowhere");
    let named = problems(&mut game);
    assert!(named.iter().any(|p| p.contains("its place")), "{named:#?}");
    let mut camera = game.app.world_mut().entity_mut(view);
    camera.insert(Transform::IDENTITY.looking_to(RED, Vec3::Y));
    game.wait_for_pictures();
    assert_eq!(game.shot().seen(48, 32), Seen::Red);
    assert_eq!(problems(&mut game), Vec::<String>::new());
}

#[test]
fn a_hundred_views_show_a_hundred_pictures() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let size = SIZE / 10;
    for i in 0..100 {
        let corner = UVec2::new(i % 10, i / 10) * size;
        let part = URect::from_corners(corner, corner + size);
        let direction = if (i % 10 + i / 10) % 2 == 0 {
            RED
        } else {
            GREEN
        };
        game.view(direction, Some(part), i as isize);
    }
    game.wait_for_pictures();
    let shot = game.shot();
    for i in 0..100 {
        let middle = UVec2::new(i % 10, i / 10) * size + size / 2;
        let expected = if (i % 10 + i / 10) % 2 == 0 {
            Seen::Red
        } else {
            Seen::Green
        };
        assert_eq!(shot.seen(middle.x, middle.y), expected, "view {i}");
    }
}

#[test]
fn films_that_no_memory_holds_or_that_have_no_pixels_are_named_and_not_rendered() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let view = game.view(RED, None, 0);
    game.wait_for_pictures();
    for size in [
        UVec2::ZERO,
        UVec2::new(0, 7),
        UVec2::splat(u32::MAX),
        UVec2::splat(1 << 31),
        UVec2::new(1 << 20, 1),
    ] {
        let own = ViewSettings {
            size: Some(size),
            ..default()
        };
        game.app.world_mut().entity_mut(view).insert(own);
        let named = problems(&mut game);
        let is_named = named.iter().any(|p| p.contains("nothing is traced for it"));
        assert!(is_named, "{size}: {named:#?}");
        let render = game.app.world().get::<TracedRender>(view).unwrap();
        assert_eq!(render.status(), None, "{size} is rendered");
        assert_eq!(game.shot().seen(48, 32), Seen::Blue, "a frozen picture");
        game.app
            .world_mut()
            .entity_mut(view)
            .remove::<ViewSettings>();
        game.wait_for_pictures();
        assert_eq!(game.shot().seen(48, 32), Seen::Red, "after {size}");
        assert_eq!(problems(&mut game), Vec::<String>::new());
    }
}

/// What becomes of a view that is told so, and goes back to what it was.
fn survives(game: &mut Game, view: Entity, what: &str, edit: impl Fn(EntityWorldMut)) {
    edit(game.app.world_mut().entity_mut(view));
    for _ in 0..15 {
        game.app.update();
        std::thread::sleep(Duration::from_millis(5));
    }
    let whole = (
        TracedView::default(),
        Transform::IDENTITY.looking_to(RED, Vec3::Y),
        Projection::default(),
    );
    let mut camera = game.app.world_mut().entity_mut(view);
    camera.insert(whole).remove::<ViewSettings>();
    game.wait_for_pictures();
    assert_eq!(game.shot().seen(48, 32), Seen::Red, "after {what}");
}

#[test]
fn numbers_that_no_view_has_any_use_for_take_nothing_with_them() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let view = game.view(RED, None, 0);
    game.wait_for_pictures();
    let numbers = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 1e30];
    for number in numbers {
        let point = Vec2::new(number, 0.5);
        for (what, told) in [
            (
                "divider",
                TracedView {
                    divider: number,
                    ..default()
                },
            ),
            (
                "range",
                TracedView {
                    view: View::Depth,
                    range: Some([number, 1.0]),
                    ..default()
                },
            ),
            (
                "region",
                TracedView {
                    region: Some(Rect {
                        min: point,
                        max: 1.0 - point,
                    }),
                    ..default()
                },
            ),
            (
                "focus",
                TracedView {
                    focus: point,
                    ..default()
                },
            ),
            (
                "pixel size",
                TracedView {
                    pixel_size: number as u32,
                    ..default()
                },
            ),
        ] {
            let what = format!("{what} {number}");
            survives(&mut game, view, &what, |mut view| {
                view.insert(told.clone());
            });
        }
        let sampling = Sampling {
            error: number,
            time: number,
            ..default()
        };
        let own = ViewSettings {
            spp: Some(number as u32),
            sampling: Some(sampling),
            ..default()
        };
        survives(&mut game, view, &format!("spp {number}"), |mut view| {
            view.insert(own.clone());
        });
    }
    for degrees in [0.0, 180.0, 270.0, -40.0] {
        let fov = f32::to_radians(degrees);
        survives(&mut game, view, &format!("{degrees}°"), |mut view| {
            view.insert(Projection::Perspective(PerspectiveProjection {
                fov,
                ..default()
            }));
        });
    }
}
