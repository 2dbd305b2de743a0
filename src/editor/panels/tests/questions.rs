//! Questions about a pixel: the click that they wait for, and the card with the answer.

use super::Desk;
use crate::editor::command::Over;
use crate::editor::inspection::debug_ray::Shot;
use crate::editor::inspection::{DebugRay, Which};
use crate::editor::notice::Notices;
use crate::editor::pointer::{Armed, PixelAsked, RightClicked};
use crate::editor::preferences::Preferences;
use crate::editor::selection::Selection;
use crate::editor::viewport::{EditorCamera, Viewport};
use crate::editor::{Action, pick};
use crate::inspect::{InspectPreset, InspectSettings, Names, Question, answer};
use crate::scene::SceneId;
use crate::sync::TracedCameras;
use bevy::camera::{Camera, CameraProjection, PerspectiveProjection, RenderTargetInfo};
use bevy::ecs::query::With;
use bevy::math::{Quat, UVec2, Vec2};
use bevy::transform::components::Transform;
use bevy_egui::egui::accesskit::Role;
use bevy_egui::egui::{CursorIcon, Key, Pos2, Shape, vec2};
use std::time::{Duration, Instant};

#[test]
fn each_question_about_a_pixel_waits_for_a_click_and_is_answered_in_a_sentence_until_another_is_shot()
 {
    for (question, id, waits, preset) in [
        (
            Question::Black,
            "why.black",
            "Click a pixel: why is it black? (Esc: none)",
            InspectPreset::WhyBlack,
        ),
        (
            Question::Noisy,
            "why.noisy",
            "Click a pixel: why is it noisy? (Esc: none)",
            InspectPreset::WhereIsTheNoiseFrom,
        ),
        (
            Question::Color,
            "why.color",
            "Click a pixel: why has it this colour? (Esc: none)",
            InspectPreset::WhyBlack,
        ),
    ] {
        let mut desk = Desk::open("cornell-box-parallelogram-light");
        desk.world().init_resource::<Armed>();
        let at = Vec2::new(600.0, 300.0);
        desk.world().write_message(Action::run(id));
        desk.point(Pos2::new(at.x, at.y));
        desk.settle();
        assert_eq!(*desk.world().resource::<Armed>(), Armed::Why(question));
        desk.place_of(waits);
        let cursor = desk.output.platform_output.cursor_icon;
        assert_eq!(cursor, CursorIcon::Crosshair);
        *desk.world().resource_mut::<Armed>() = Armed::No;

        let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
        let mut ray = desk.world().resource_mut::<DebugRay>();
        ray.which = match question {
            Question::Black => Which::First,
            _ => Which::All,
        };
        ray.shoot(Shot {
            pixel: UVec2::new(300, 400),
            camera,
            size: UVec2::new(600, 480),
        });
        desk.world().trigger(PixelAsked { question, at });
        desk.settle();
        assert_eq!(desk.find(waits), None);
        wait_for_rays(&mut desk);
        let rays = desk.world().resource::<DebugRay>().rays().unwrap().clone();
        let names = &desk.world().resource::<Names>().things;
        let sentence = answer(question, &rays, names);
        desk.place_of(&sentence);
        desk.click_on("Ray inspector");
        assert!(desk.world().resource::<Preferences>().show_rays, "{id}");
        desk.click_on("Show rays");
        let wanted = preset.settings().rays;
        assert_eq!(
            desk.world().resource::<InspectSettings>().rays,
            wanted,
            "{id}"
        );
        desk.click_on("Go there");
        desk.settle();
        let met = rays.rays[0].hit.unwrap().object;
        assert_eq!(desk.world().resource::<Selection>().ids(), [SceneId(met)]);
        assert_eq!(desk.find(&sentence), None);
    }
}

/// Puts the window's camera somewhere, as the renderer would tell it.
fn look_from(desk: &mut Desk, place: Transform) {
    let [width, height, _] = desk.size;
    let mut cameras =
        (desk.world()).query_filtered::<(&mut Camera, &mut Transform), With<EditorCamera>>();
    let (mut camera, mut stands) = cameras.single_mut(desk.world()).unwrap();
    *stands = place;
    let projection = PerspectiveProjection {
        aspect_ratio: width / height,
        ..PerspectiveProjection::default()
    };
    camera.computed.clip_from_view = projection.get_clip_from_view();
    camera.computed.target_info = Some(RenderTargetInfo {
        physical_size: UVec2::new(width as u32, height as u32),
        scale_factor: 1.0,
    });
}

/// Until the rays of the pixel that was asked about are there.
fn wait_for_rays(desk: &mut Desk) {
    let start = Instant::now();
    while desk.world().resource::<DebugRay>().is_busy() {
        assert!(start.elapsed().as_secs() < 60, "no rays came");
        desk.settle();
    }
    desk.settle();
}

/// The middle of the cross that an answer belongs to.
fn cross(desk: &Desk) -> Pos2 {
    let picture = desk.app.world().resource::<Viewport>().rect;
    let arms = (desk.output.shapes.iter()).filter_map(|clipped| match &clipped.shape {
        Shape::LineSegment { points, stroke } if stroke.width == 1.2 => Some(points[0]),
        _ => None,
    });
    // Icons of the list are drawn in lines, too.
    let arms = arms.filter(|arm| picture.contains(Vec2::new(arm.x, arm.y)));
    let arms: Vec<Pos2> = arms.collect();
    assert_eq!(arms.len(), 4, "the arms of one cross: {arms:?}");
    let sum = arms
        .iter()
        .fold(Vec2::ZERO, |sum, arm| sum + Vec2::new(arm.x, arm.y));
    Pos2::new(sum.x / 4.0, sum.y / 4.0)
}

#[test]
fn an_answer_and_its_cross_stay_with_what_they_are_about_when_the_view_moves() {
    let mut desk = Desk::open("cornell-box");
    desk.world().init_resource::<Armed>();
    let before = Transform::from_xyz(0.0, 0.27, 1.08);
    look_from(&mut desk, before);
    let at = Vec2::new(600.0, 300.0);
    let seen_along = pick::ray(desk.world(), at).expect("a view");
    let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
    let mut ray = desk.world().resource_mut::<DebugRay>();
    ray.which = Which::First;
    ray.shoot(Shot {
        pixel: UVec2::new(300, 400),
        camera,
        size: UVec2::new(600, 480),
    });
    let question = Question::Black;
    desk.world().trigger(PixelAsked { question, at });
    desk.settle();
    wait_for_rays(&mut desk);
    let rays = desk.world().resource::<DebugRay>().rays().unwrap().clone();
    let far = rays.rays[0].t * rays.rays[0].direction.length();
    let names = &desk.world().resource::<Names>().things;
    let sentence = answer(question, &rays, names);
    let is_at = |cross: Pos2, wanted: Vec2| cross.distance(Pos2::new(wanted.x, wanted.y)) < 0.1;
    let there = cross(&desk);
    assert!(is_at(there, at), "{there:?}, not {at}");
    let beside = desk.place_of(&sentence) - there;
    let mut moved = Vec::new();
    for place in [
        Transform::from_xyz(0.1, 0.27, 1.08),
        Transform::from_xyz(0.05, 0.2, 1.3).with_rotation(Quat::from_rotation_y(-0.05)),
        before,
    ] {
        look_from(&mut desk, place);
        desk.draw(Vec::new());
        let wanted = pick::to_window(desk.world(), seen_along.get_point(far)).unwrap();
        let there = cross(&desk);
        assert!(is_at(there, wanted), "{there:?}, not {wanted}");
        desk.draw(Vec::new());
        let text = desk.place_of(&sentence) - there;
        // At its right or at its left, where there is room.
        let is_beside = text.x.abs() < 1.2 * beside.x.abs() && (text.y - beside.y).abs() < 1.0;
        assert!(
            is_beside,
            "the sentence lies {text:?} from it, and lay {beside:?} from it"
        );
        moved.push(wanted.distance(at));
    }
    assert!(
        moved[0] > 20.0 && moved[1] > 20.0 && moved[2] < 0.1,
        "{moved:?}"
    );
}

#[test]
fn an_answer_about_a_mirror_shows_what_the_mirror_sees_and_another_does_not() {
    let mut desk = Desk::open("cornell-box");
    desk.context.enable_accesskit();
    desk.world().init_resource::<Armed>();
    let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
    let size = UVec2::new(600, 480);
    // In the mirror block, and on the floor before it.
    for (pixel, is_mirror) in [([225, 220], true), ([300, 450], false)] {
        let mut ray = desk.world().resource_mut::<DebugRay>();
        ray.which = Which::First;
        ray.shoot(Shot {
            pixel: pixel.into(),
            camera: camera.clone(),
            size,
        });
        let at = Vec2::new(600.0, 300.0);
        let question = Question::Black;
        desk.world().trigger(PixelAsked { question, at });
        desk.settle();
        wait_for_rays(&mut desk);
        let rays = desk.world().resource::<DebugRay>().rays().unwrap().clone();
        let names = &desk.world().resource::<Names>().things;
        let sentence = answer(question, &rays, names);
        assert_eq!(sentence.contains("is a mirror"), is_mirror, "{sentence}");
        let pictures = |desk: &Desk| {
            let bounds = desk.bounds(Role::Image).into_iter();
            bounds
                .filter(|bounds| bounds.size() == vec2(240.0, 160.0))
                .count()
        };
        assert_eq!(pictures(&desk), usize::from(is_mirror), "{sentence}");
        let start = Instant::now();
        while is_mirror && !has_texture(&desk, "mirror") {
            assert!(start.elapsed().as_secs() < 60, "no picture came");
            std::thread::sleep(Duration::from_millis(5));
            desk.settle();
        }
        assert_eq!(pictures(&desk), usize::from(is_mirror), "{sentence}");
    }
    assert!(!has_texture(&desk, "mirror"), "it went with its answer");
}

/// Whether egui holds a texture of that name.
fn has_texture(desk: &Desk, name: &str) -> bool {
    let textures = desk.context.tex_manager();
    let textures = textures.read();
    textures.allocated().any(|(_, meta)| meta.name == name)
}

#[test]
fn the_menu_over_a_pixel_answers_for_that_pixel_and_that_over_a_row_asks_nothing() {
    let question = "Why is this pixel black?";
    let mut desk = Desk::open("cornell-box");
    desk.world().init_resource::<Armed>();
    let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
    let (pixel, size) = (UVec2::new(300, 400), UVec2::new(600, 480));
    let row = Vec2::new(60.0, 300.0);
    let over = Over::Entity;
    desk.world().trigger(RightClicked { at: row, over });
    desk.settle();
    desk.place_of("Duplicate");
    assert_eq!(desk.find(question), None, "a row has no pixel");
    desk.key(Key::Escape);
    let at = Vec2::new(640.0, 300.0);
    desk.world().trigger(RightClicked { at, over });
    desk.settle();
    desk.click_on(question);
    desk.settle();
    // Nothing is traced here, which is said instead; no other click is waited for.
    assert_eq!(*desk.world().resource::<Armed>(), Armed::No);
    let told = desk.world().resource_mut::<Notices>().shown().to_vec();
    assert!(
        told.iter().any(|one| one.text.contains("traced view")),
        "{told:?}"
    );
    desk.world().resource_mut::<DebugRay>().shoot(Shot {
        pixel,
        camera,
        size,
    });
    desk.world().write_message(Action::run("why.black"));
    desk.settle();
    let armed = *desk.world().resource::<Armed>();
    assert_eq!(armed, Armed::Why(Question::Black), "from anywhere else");
}

#[test]
fn a_question_of_the_toolbar_waits_for_a_click_though_a_menu_is_open_over_a_pixel() {
    let mut desk = Desk::open("cornell-box");
    desk.world().init_resource::<Armed>();
    let at = Vec2::new(640.0, 300.0);
    let over = Over::Nothing;
    desk.world().trigger(RightClicked { at, over });
    desk.settle();
    desk.place_of("Why is this pixel black?");
    desk.click_on("Why black?");
    desk.settle();
    assert_eq!(desk.find("Why is this pixel black?"), None, "it is closed");
    let armed = *desk.world().resource::<Armed>();
    assert_eq!(armed, Armed::Why(Question::Black));
}
