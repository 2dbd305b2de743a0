//! The ray inspector as a person meets it.

use super::super::tests::{Desk, SMALL, USUAL, texts};
use super::RaysPanel;
use crate::editor::action::Action;
use crate::editor::inspection::choice::Side;
use crate::editor::inspection::debug_ray::Shot;
use crate::editor::inspection::{DebugRay, Inspected, Which};
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::editor::viewport::Viewport;
use crate::inspect::InspectSettings;
use crate::scene::{RenderSettings, SceneId};
use crate::sync::TracedCameras;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::math::UVec2;
use bevy_egui::egui::{Event, Rect, vec2};
use std::time::{Duration, Instant};

const SIZE: UVec2 = UVec2::new(600, 480);

fn open(scene: &str) -> Desk {
    let mut desk = Desk::open(scene);
    desk.world().resource_mut::<RenderSettings>().spp = 64;
    desk.world().write_message(Action::run("rays.inspector"));
    desk.settle();
    assert!(desk.world().resource::<Preferences>().show_rays);
    desk
}

fn shoot(desk: &mut Desk, which: Which) {
    let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
    let mut ray = desk.world().resource_mut::<DebugRay>();
    ray.which = which;
    ray.shoot(Shot {
        pixel: UVec2::new(300, 240),
        camera,
        size: SIZE,
    });
    desk.settle();
    let start = Instant::now();
    while desk.world().resource::<DebugRay>().is_busy() {
        assert!(start.elapsed() < Duration::from_secs(60), "no rays came");
        std::thread::sleep(Duration::from_millis(5));
        desk.frame(Vec::new());
    }
    desk.settle();
}

#[test]
fn the_chosen_sample_stays_when_another_pixel_is_picked() {
    let mut desk = open("cornell-box");
    shoot(&mut desk, Which::Number(40));
    let shot = desk.world().resource::<DebugRay>().shot().cloned().unwrap();
    for x in 0..3 {
        let pixel = UVec2::new(100 + x, 240);
        let shot = Shot {
            pixel,
            ..shot.clone()
        };
        desk.world().resource_mut::<DebugRay>().shoot(shot);
        // Drawn before it is traced.
        desk.draw(Vec::new());
        desk.frame(Vec::new());
        let ray = desk.world().resource::<DebugRay>();
        assert_eq!(ray.which, Which::Number(40));
    }
    // There is no such sample.
    shoot(&mut desk, Which::Number(1 << 20));
    let ray = desk.world().resource::<DebugRay>();
    let last = ray.sample_count().unwrap() - 1;
    assert_eq!(ray.which, Which::Number(last));
}

fn rows_drawn(desk: &mut Desk) -> usize {
    desk.world().resource::<RaysPanel>().rows_drawn
}

#[test]
fn before_a_shot_the_inspector_says_how_one_is_made_and_makes_one_at_a_click() {
    let mut desk = open("cornell-box");
    let text = desk.world().resource::<DebugRay>().says().unwrap();
    assert!(desk.find(&text).is_some());
    assert_eq!(rows_drawn(&mut desk), 0);
    // A desk traces no picture, and that is said.
    desk.click_on("Trace the picture's middle");
    assert!(!desk.world().resource::<Notices>().is_empty());
    shoot(&mut desk, Which::First);
    assert!(desk.find("Trace the picture's middle").is_none());
}

#[test]
fn where_a_ray_would_be_shown_and_none_is_chosen_a_click_chooses_one_in_place() {
    for (name, side) in [("Ray", Side::Ray), ("Steps", Side::Steps)] {
        let mut desk = open("cornell-box");
        shoot(&mut desk, Which::First);
        desk.click_on(name);
        desk.click_on("Choose the camera's ray");
        let inspected = desk.world().resource::<Inspected>();
        assert_eq!((inspected.ray(), inspected.side), (Some(0), side));
        assert!(!inspected.stepper.is_empty());
        assert!(desk.find("Choose the camera's ray").is_none());
    }
}

#[test]
fn a_row_that_is_clicked_is_the_chosen_ray_and_one_chosen_in_the_view_is_scrolled_to() {
    let mut desk = open("cornell-box");
    shoot(&mut desk, Which::All);
    desk.click_on("camera 0");
    assert_eq!(desk.world().resource::<Inspected>().ray(), Some(0));
    assert_eq!(desk.world().resource::<Inspected>().side, Side::Ray);
    assert!(desk.find("camera ray 0").is_some(), "its numbers are shown");
    let rays = desk.world().resource::<DebugRay>().rays().unwrap().clone();
    let last = rays.rays.len() as u32 - 1;
    let name = format!("{} {last}", rays.rays[last as usize].kind.name());
    assert!(desk.find(&name).is_none(), "{name} is far below");
    desk.world()
        .resource_mut::<Inspected>()
        .choose_ray(Some(last), true);
    desk.settle();
    assert!(desk.find(&name).is_some(), "{name} was not scrolled to");
    // Chosen again it is chosen no more.
    desk.click_on(&name);
    assert_eq!(desk.world().resource::<Inspected>().ray(), None);
}

#[test]
fn names_that_are_longer_than_a_column_end_in_an_ellipsis() {
    let mut desk = open("cornell-box");
    let long = "A name that is longer than any column of the list is wide";
    let mut names = desk.world().query_filtered::<&mut Name, With<SceneId>>();
    for mut name in names.iter_mut(desk.app.world_mut()) {
        name.set(long);
    }
    shoot(&mut desk, Which::First);
    let texts = texts(&desk);
    let listed = texts.iter().filter(|(text, place, clip)| {
        text.contains(long) && clip.height() < 30.0 && clip.intersects(*place)
    });
    let mut count = 0;
    for (text, place, clip) in listed {
        assert!(
            place.right() < clip.right(),
            "{text:?}: {place:?} in {clip:?}"
        );
        count += 1;
    }
    assert!(count > 1, "{count} names are listed");
}

#[test]
fn of_many_rays_only_the_rows_that_are_seen_are_laid_out_at_any_size() {
    let mut desk = open("cornell-box-parallelogram-light");
    shoot(&mut desk, Which::All);
    let count = desk
        .world()
        .resource::<DebugRay>()
        .rays()
        .unwrap()
        .rays
        .len();
    assert!(count > 100, "{count} rays");
    for size in [SMALL, USUAL] {
        desk.size = size;
        desk.settle();
        let drawn = rows_drawn(&mut desk);
        assert!((2..20).contains(&drawn), "{drawn} rows at {size:?}");
        let picture = desk.world().resource::<Viewport>().rect;
        assert!(picture.height() > 160.0, "{picture:?} at {size:?}");
        for text in ["Pixel", "Filter", "Copy as JSON", "Why", "Steps"] {
            let found = desk.find(text).is_some();
            assert!(found, "{text} is not to be seen at {size:?}");
        }
    }
}

#[test]
fn what_light_a_ray_brings_is_seen_without_scrolling() {
    let mut desk = open("cornell-box");
    shoot(&mut desk, Which::First);
    for (size, seen) in [(SMALL, &["adds"][..]), (USUAL, &["adds", "in", "out"])] {
        desk.size = size;
        desk.settle();
        for heading in ["end", "meets"].iter().chain(seen) {
            let texts = texts(&desk);
            let all_seen = |(text, place, clip): &(String, Rect, Rect)| {
                text == heading && clip.contains_rect(*place)
            };
            assert!(texts.iter().any(all_seen), "{heading} at {size:?}");
        }
    }
}

#[test]
fn neither_panel_nor_window_grows_by_itself_and_the_window_leaves_the_picture_its_size() {
    let mut desk = open("cornell-box");
    shoot(&mut desk, Which::First);
    let below = desk.world().resource::<Viewport>().rect;
    for side in [Side::Why, Side::Ray, Side::Steps] {
        desk.world()
            .resource_mut::<Inspected>()
            .choose_ray(Some(1), false);
        desk.world().resource_mut::<Inspected>().side = side;
        desk.settle();
        let now = desk.world().resource::<Viewport>().rect;
        assert_eq!(now, below, "{side:?}");
    }
    desk.click_on("Float");
    desk.settle();
    let over = desk.world().resource::<Viewport>().rect;
    assert!(over.height() > below.height() + 100.0);
    assert!(desk.find("camera 0").is_some());
    desk.click_on("Dock");
    desk.settle();
    assert_eq!(desk.world().resource::<Viewport>().rect, below);
    // What is above the panel is taken from the panel, and remembered.
    let edge = bevy_egui::egui::pos2(600.0, below.max.y);
    desk.drag(edge, vec2(0.0, -80.0));
    let height = desk.world().resource::<Preferences>().rays_height;
    assert!((height - 320.0).abs() < 12.0, "{height}");
}

#[test]
fn a_heading_sorts_and_the_filter_takes_its_keys_for_itself() {
    let mut desk = open("cornell-box");
    shoot(&mut desk, Which::All);
    desk.click_on("end");
    let sort = desk.world().resource::<Inspected>().arrangement.sort;
    assert!(sort.is_some_and(|(_, descending)| !descending));
    desk.click_on("end ⏶");
    let sort = desk.world().resource::<Inspected>().arrangement.sort;
    assert!(sort.is_some_and(|(_, descending)| descending));
    let all = rows_drawn(&mut desk);
    desk.click_on("Filter");
    desk.frame(vec![Event::Text("nothing is called so".into())]);
    desk.settle();
    assert!(!desk.world().resource::<Viewport>().takes_keys);
    assert!(all > 0 && rows_drawn(&mut desk) == 0);
}

#[test]
fn switches_of_the_head_are_those_of_what_is_drawn() {
    let mut desk = open("cornell-box");
    shoot(&mut desk, Which::First);
    desk.click_on("shadow");
    let settings = desk.world().resource::<InspectSettings>().clone();
    assert!(!settings.rays.shadow && settings.rays.camera);
    desk.click_on("draw");
    assert!(!desk.world().resource::<InspectSettings>().rays.on);
    desk.world().resource_mut::<InspectSettings>().on = false;
    desk.settle();
    desk.click_on("draw");
    let settings = desk.world().resource::<InspectSettings>();
    assert!(
        settings.on && settings.rays.on,
        "the master switch is taken along"
    );
}

#[test]
fn the_rays_are_copied_as_json_and_that_is_said() {
    let mut desk = open("cornell-box");
    shoot(&mut desk, Which::First);
    desk.click_on("Copy as JSON");
    assert!(!desk.world().resource::<Notices>().is_empty());
}

#[test]
fn steps_are_played_by_their_buttons() {
    let mut desk = open("cornell-box");
    shoot(&mut desk, Which::First);
    desk.click_on("camera 0");
    desk.click_on("Steps");
    desk.click_on(">");
    desk.click_on(">");
    desk.click_on("<");
    assert_eq!(desk.world().resource::<Inspected>().stepper.at(), 1);
    desk.click_on(">|");
    let stepper = &desk.world().resource::<Inspected>().stepper;
    assert_eq!(stepper.at(), stepper.len() - 1);
}
