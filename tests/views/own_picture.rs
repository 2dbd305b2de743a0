//! A view's picture is the view's alone.

use super::{GREEN, Game, RED, SHOWN_RED, SIZE, Seen};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Hdr, RenderTarget};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::post_process::bloom::Bloom;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use glassbox::view::{DrawnLines, Line, TracedView};

fn left() -> URect {
    URect::new(0, 0, SIZE.x / 2, SIZE.y)
}

fn right() -> URect {
    URect::new(SIZE.x / 2, 0, SIZE.x, SIZE.y)
}

#[test]
fn each_half_of_a_split_screen_shows_its_own_picture_and_a_minimap_shows_none() {
    let Some(mut game) = Game::open() else {
        return;
    };
    game.view(RED, Some(left()), 0);
    game.view(GREEN, Some(right()), 1);
    let minimap = URect::new(0, 0, 12, 12);
    game.camera(RED, Some(minimap), 2);
    game.wait_for_pictures();
    let shot = game.shot();
    let places = [(30, 32), (70, 32), (6, 6), (14, 14), (94, 62)];
    let seen = places.map(|(x, y)| shot.seen(x, y));
    let expected = [Seen::Red, Seen::Green, Seen::Blue, Seen::Red, Seen::Green];
    assert_eq!(seen, expected);
}

#[test]
fn cameras_of_the_same_layers_and_another_target_show_no_picture_of_others() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let view = game.view(GREEN, None, 0);
    let layers = RenderLayers::from_layers(&[0, 3]);
    game.app.world_mut().entity_mut(view).insert(layers.clone());
    let first = game.image.clone();
    let other = Image::new_target_texture(SIZE.x, SIZE.y, TextureFormat::Rgba8UnormSrgb, None);
    game.image = game
        .app
        .world_mut()
        .resource_mut::<Assets<Image>>()
        .add(other);
    let orthographic = game.camera(RED, None, 0);
    let projection = Projection::Orthographic(OrthographicProjection::default_3d());
    let mut camera = game.app.world_mut().entity_mut(orthographic);
    camera.insert((layers, projection));
    game.wait_for_pictures();
    assert_eq!(game.shot().seen(48, 32), Seen::Blue);
    game.image = first;
    assert_eq!(game.shot().seen(48, 32), Seen::Green);
}

#[test]
fn a_picture_looks_the_same_whatever_the_camera_does_to_what_it_rasterises() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let view = game.camera(RED, None, 0);
    let mut shown = Vec::new();
    for traced_first in [false, true] {
        for (hdr, msaa) in [
            (false, Msaa::Off),
            (false, Msaa::Sample4),
            (true, Msaa::Off),
            (true, Msaa::Sample4),
        ] {
            let mut camera = game.app.world_mut().entity_mut(view);
            camera.remove::<(TracedView, Hdr, Bloom, Tonemapping)>();
            if traced_first {
                camera.insert(TracedView::default());
            }
            camera.insert((msaa, Tonemapping::TonyMcMapface));
            if hdr {
                camera.insert((Hdr, Bloom::NATURAL));
            }
            camera.insert(TracedView::default());
            game.wait_for_pictures();
            let color = game.shot().pixel(48, 32);
            shown.push((traced_first, hdr, msaa, color));
        }
    }
    for (.., color) in &shown {
        let off = color[0].abs_diff(SHOWN_RED).max(color[1]).max(color[2]);
        // A level is what rounding may take.
        assert!(off <= 1, "{shown:?}");
    }
}

#[test]
fn beside_the_divider_bevys_picture_stands_and_nothing_of_it_lies_over_the_traced_one() {
    let Some(mut game) = Game::open() else {
        return;
    };
    // Drawn in Bevy's passes of what is blended and of what light is transmitted by, after all that is opaque.
    game.blue(AlphaMode::Blend, RED);
    let glass = game.blue(AlphaMode::Opaque, RED);
    let world = game.app.world_mut();
    let glass = world.get::<MeshMaterial3d<StandardMaterial>>(glass);
    let glass = glass.unwrap().0.clone();
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    materials.get_mut(&glass).unwrap().specular_transmission = 0.5;
    let view = game.view(RED, None, 0);
    for (hdr, msaa) in [(false, Msaa::Off), (true, Msaa::Off), (true, Msaa::Sample4)] {
        let mut camera = game.app.world_mut().entity_mut(view);
        camera.insert(msaa);
        if hdr {
            camera.insert((Hdr, Bloom::NATURAL));
        }
        for divider in [0.0, 0.5] {
            let mut seen = game.app.world_mut().get_mut::<TracedView>(view).unwrap();
            seen.divider = divider;
            game.wait_for_pictures();
            let shot = game.shot();
            let left = if divider > 0.0 { Seen::Blue } else { Seen::Red };
            let found = [20, 46, 50, 90].map(|x| shot.seen(x, 32));
            let expected = [left, left, Seen::Red, Seen::Red];
            assert_eq!(found, expected, "hdr {hdr}, {msaa:?}, divider {divider}");
        }
    }
}

#[test]
fn lines_are_seen_over_a_picture_where_nothing_traced_stands_before_them() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let view = game.view(RED, None, 0);
    let line = |metres: f32| DrawnLines {
        lines: vec![Line::new(
            Vec3::new(-50.0, 0.0, -metres),
            Vec3::new(50.0, 0.0, -metres),
            LinearRgba::GREEN,
        )],
        width: 12.0,
        on_top: false,
    };
    let before = game.app.world_mut().spawn(line(8.0)).id();
    for msaa in [Msaa::Off, Msaa::Sample4] {
        game.app.world_mut().entity_mut(view).insert(msaa);
        game.app.world_mut().entity_mut(before).insert(line(8.0));
        game.wait_for_pictures();
        for _ in 0..40 {
            // The depth of a picture comes after it.
            game.app.update();
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        let shot = game.shot();
        assert_eq!(shot.seen(48, 32), Seen::Green, "{msaa:?}");
        assert_eq!(shot.seen(48, 8), Seen::Red, "{msaa:?}");
        // What lies behind shines through faintly.
        game.app.world_mut().entity_mut(before).insert(line(12.0));
        let behind = game.shot().pixel(48, 32);
        assert!(behind[0] > behind[1], "{msaa:?}: {behind:?}");
    }
}

#[test]
fn a_view_draws_into_targets_of_other_formats() {
    let Some(mut game) = Game::open() else {
        return;
    };
    let view = game.view(RED, None, 0);
    for format in [TextureFormat::Bgra8UnormSrgb, TextureFormat::Rgba16Float] {
        let image = Image::new_target_texture(SIZE.x, SIZE.y, format, None);
        let world = game.app.world_mut();
        game.image = world.resource_mut::<Assets<Image>>().add(image);
        let target = RenderTarget::Image(game.image.clone().into());
        world.entity_mut(view).insert(target);
        game.wait_for_pictures();
        let color = game.shot().pixel(48, 32);
        assert!(color[0].abs_diff(SHOWN_RED) <= 1, "{format:?}: {color:?}");
    }
}
