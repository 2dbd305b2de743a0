use super::*;
use crate::editor::action::Action;
use crate::editor::document::adopt;
use crate::editor::panels::compare::even_picture as picture;
use crate::editor::panels::tests::{Desk, SMALL, USUAL, type_nonsense};
use crate::editor::panels::theme::tests::assert_readable;
use crate::editor::viewport::{EditorCamera, Viewport};
use crate::scene::RenderSettings;
use crate::view::TracedViewPlugin;
use bevy::app::Plugin;
use bevy::camera::{Camera, RenderTargetInfo};
use bevy::ecs::query::With;
use bevy_egui::egui::{Event, Key, Modifiers, Rect, Shape, Theme};
use std::thread::sleep;

/// Frames until the window has this text.
fn wait_for(desk: &mut Desk, text: &str) {
    let start = Instant::now();
    while desk.find(text).is_none() {
        assert!(start.elapsed() < Duration::from_secs(60), "never {text:?}");
        sleep(Duration::from_millis(5));
        desk.settle();
    }
}

#[test]
fn two_kept_pictures_are_compared_in_figures_and_another_scene_forgets_them() {
    let mut desk = Desk::open("cornell-box");
    adopt(desk.world(), "cornell-box", None);
    desk.world().write_message(Action::run("compare.open"));
    desk.settle();
    assert!(desk.find("Difference").is_none(), "nothing was kept");
    let mut kept = desk.world().resource_mut::<KeptPictures>();
    kept.add(picture(1.0), 16.5, None);
    kept.add(picture(1.1), 64.0, Some("Change lighting"));
    desk.settle();
    desk.click_on("Compare");
    // A window that appears is measured before it is drawn.
    desk.settle();
    desk.place_of("One of the pictures is not there.");
    let mut kept = desk.world().resource_mut::<KeptPictures>();
    let comparison = kept.comparison.as_mut().unwrap();
    assert_eq!(comparison.sides, [Side::Kept(2), Side::Now]);
    comparison.sides = [Side::Kept(1), Side::Kept(2)];
    desk.settle();
    desk.place_of("1: 16.5 spp");
    desk.place_of("2: 64 spp, Change lighting");
    wait_for(&mut desk, "RMSE 0.10000");
    desk.place_of("10.000 % brighter");
    desk.click_on("Relative");
    let look = |desk: &mut Desk| {
        let kept = desk.world().resource::<KeptPictures>();
        let comparison = kept.comparison.as_ref().unwrap();
        let drawn = comparison.drawn.as_ref().map(|drawn| drawn.look);
        (comparison.look, drawn)
    };
    assert_eq!(look(&mut desk).0.how, How::Relative);
    let start = Instant::now();
    while look(&mut desk).1 != Some(look(&mut desk).0) {
        assert!(start.elapsed() < Duration::from_secs(60), "never drawn");
        sleep(Duration::from_millis(5));
        desk.settle();
    }
    desk.world().write_message(Action::Open("triangle".into()));
    desk.settle();
    assert!(desk.find("Difference").is_none());
    assert!(desk.world().resource::<KeptPictures>().all.is_empty());
}

#[test]
fn the_views_picture_is_looked_at_again_while_it_becomes_another_and_not_once_it_is_done() {
    let mut desk = Desk::open("triangle");
    TracedViewPlugin.build(&mut desk.app);
    let mut cameras = (desk.world()).query_filtered::<&mut Camera, With<EditorCamera>>();
    let mut camera = cameras.single_mut(desk.world()).unwrap();
    camera.computed.target_info = Some(RenderTargetInfo {
        physical_size: UVec2::new(32, 24),
        scale_factor: 1.0,
    });
    let mut kept = desk.world().resource_mut::<KeptPictures>();
    kept.add(picture(1.0), 1.0, None);
    kept.comparison = Some(Comparison::new(1));
    // When it was begun to be compared as the render stands now.
    let begun = |desk: &mut Desk| {
        let start = Instant::now();
        loop {
            sleep(Duration::from_millis(5));
            desk.settle();
            let now = traced_render(desk.world()).and_then(Moment::of);
            let kept = desk.world().resource::<KeptPictures>();
            let comparison = kept.comparison.as_ref().unwrap();
            let drawn = comparison.drawn.as_ref().and_then(|drawn| drawn.of);
            let is_done = now.is_some_and(|now| matches!(now.state, State::Ended(_)));
            if is_done && drawn == now {
                return comparison.begun;
            }
            let is_late = start.elapsed() > Duration::from_secs(60);
            assert!(!is_late, "never compared: {drawn:?}, and there is {now:?}");
        }
    };
    let first = begun(&mut desk);
    sleep(2 * AGAIN);
    assert_eq!(begun(&mut desk), first, "it is the same picture");
    desk.world()
        .resource_mut::<RenderSettings>()
        .output
        .exposure = 1.0;
    desk.settle();
    let second = begun(&mut desk);
    assert!(second > first, "another exposure is another picture");
    desk.world().resource_mut::<RenderSettings>().seed += 1;
    desk.settle();
    assert!(begun(&mut desk) > second, "another render is one, too");
}

#[test]
fn the_window_covers_no_panel_after_the_editors_became_small() {
    let mut desk = Desk::open("cornell-box");
    let mut kept = desk.world().resource_mut::<KeptPictures>();
    kept.add(picture(1.0), 1.0, None);
    kept.comparison = Some(Comparison::new(1));
    let id = egui::Id::new("compare pictures");
    for size in [USUAL, SMALL] {
        desk.size = size;
        desk.settle();
        desk.settle();
        let place = desk.context.memory(|memory| memory.area_rect(id)).unwrap();
        let free = desk.world().resource::<Viewport>().rect;
        let of = egui::Rect::from_x_y_ranges(free.min.x..=free.max.x, free.min.y..=free.max.y);
        assert!(of.expand(1.0).contains_rect(place), "{place} in {of}");
    }
}

#[test]
fn nothing_that_is_typed_makes_a_gain_that_is_none() {
    let kept = KeptPictures::default();
    let mut comparison = Comparison::new(1);
    let fields = type_nonsense(
        &mut comparison,
        |ui, comparison| choices_ui(ui, &kept, comparison),
        |comparison, text| {
            let gain = comparison.look.gain;
            assert!((0.01..=10_000.0).contains(&gain), "`{text}` gives {gain}");
        },
    );
    assert_eq!(fields, 1);
}

#[test]
fn the_names_of_both_pictures_can_be_read_in_both_themes() {
    for (theme, inks) in [Theme::Dark, Theme::Light].into_iter().zip(INKS) {
        for ink in inks {
            assert_readable(theme, ink, "of a picture");
        }
    }
}

#[test]
fn what_is_seen_of_a_comparison_is_written_pixel_by_pixel() {
    let level = |x: usize, y: usize| Color32::from_gray((10 * y + x) as u8);
    let pixels = (0..6 * 4).map(|i| level(i % 6, i / 6)).collect();
    let whole = ColorImage::new([6, 4], pixels);
    let bytes = png_of(&whole, [UVec2::new(1, 2), UVec2::new(4, 3)]).unwrap();
    let read = image::load_from_memory(&bytes).unwrap().to_rgba8();
    assert_eq!(read.dimensions(), (4, 2));
    for (x, y, pixel) in read.enumerate_pixels() {
        let expected = level(x as usize + 1, y as usize + 2);
        assert_eq!(pixel.0, expected.to_array(), "pixel {x}, {y}");
    }
}

#[test]
fn more_than_a_few_kept_pictures_drop_the_oldest() {
    let mut kept = KeptPictures::default();
    for _ in 0..=super::super::MOST {
        kept.add(picture(1.0), 1.0, None);
    }
    assert_eq!(kept.all.len(), super::super::MOST);
    assert!(kept.find(1).is_none() && kept.find(2).is_some());
}

#[test]
fn a_kept_picture_keeps_its_shape_in_a_view_of_another_and_its_name_stands_on_a_ground() {
    let mut desk = Desk::open("cornell-box");
    let held = |desk: &mut Desk| {
        desk.frame(vec![Event::Key {
            key: Key::C,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        }]);
        let shapes = desk.output.shapes.iter().map(|clipped| &clipped.shape);
        let mut picture = None;
        let mut name = None;
        let mut ground = Rect::NOTHING;
        for shape in shapes {
            match shape {
                Shape::Mesh(mesh) if mesh.texture_id != egui::TextureId::default() => {
                    picture = Some(mesh.calc_bounds());
                }
                Shape::Rect(shape) => ground = shape.rect,
                Shape::Text(shape) if shape.galley.text().starts_with("kept picture") => {
                    let rect = Rect::from_min_size(shape.pos, shape.galley.size());
                    name = Some((rect, ground.contains_rect(rect)));
                }
                _ => {}
            }
        }
        (picture.unwrap(), name.unwrap())
    };
    let step = "Set the temperature of the lamp above the table to 2800 K";
    let mut kept = desk.world().resource_mut::<KeptPictures>();
    // Of 8 by 4 pixels.
    kept.add(picture(1.0), 1024.0, Some(step));
    let (picture, (name, on_ground)) = held(&mut desk);
    let free = desk.world().resource::<Viewport>().rect;
    let free = Rect::from_x_y_ranges(free.min.x..=free.max.x, free.min.y..=free.max.y);
    assert!(
        (picture.width() / picture.height() - 2.0).abs() < 0.01,
        "{picture}"
    );
    assert!(
        free.expand(0.1).contains_rect(picture),
        "{picture} in {free}"
    );
    assert!((picture.center() - free.center()).length() < 0.1);
    assert!(on_ground && name.width() > 200.0, "{name}");
}
