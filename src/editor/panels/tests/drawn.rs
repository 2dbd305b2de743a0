//! What is drawn, and that it fits.

use super::super::dialogs::frame_of;
use super::super::dialogs::{Dialog, Dialogs};
use super::super::hierarchy::Hierarchy;
use super::super::inspector::{Inspector, Tab};
use super::super::outline::Outline;
use super::desk::{Desk, LARGE, SMALL, USUAL};
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::editor::selection::Selection;
use crate::editor::viewport::{Show, Viewport};
use crate::io::builtin::SCENES;
use crate::scene::{PointLamp, SceneId};
use bevy::ecs::name::Name;
use bevy::math::Vec2;
use bevy_egui::egui::{Id, Pos2, Rect, Shape, vec2};

#[test]
fn every_scene_is_drawn_in_every_tab_at_every_size_and_nothing_of_it_counts_as_changed() {
    for scene in SCENES {
        let mut desk = Desk::open(scene.name);
        let ids = desk.ids();
        for size in [SMALL, LARGE] {
            desk.size = size;
            desk.settle();
            desk.world().clear_trackers();
            for tab in [Tab::Object, Tab::Render, Tab::Debug, Tab::Bvh] {
                desk.world().resource_mut::<Inspector>().tab = tab;
                // One after the other, then all at once.
                let choices = ids.iter().map(|&id| vec![id]).chain([ids.clone()]);
                let choices = choices.take(if tab == Tab::Object { 60 } else { 1 });
                for selected in choices {
                    desk.world().resource_mut::<Selection>().set(selected);
                    desk.draw(Vec::new());
                    desk.draw(Vec::new());
                }
            }
            for show in [Show::Raster, Show::Split] {
                desk.world().resource_mut::<Viewport>().show = show;
                desk.draw(Vec::new());
            }
            assert_eq!(desk.changed(), [""; 0], "{} at {size:?}", scene.name);
        }
    }
}

#[test]
fn no_panel_grows_by_itself_whatever_it_shows() {
    let mut desk = Desk::open("showcase");
    let ids = desk.ids();
    for size in [SMALL, USUAL] {
        desk.size = size;
        desk.settle();
        let rect = desk.world().resource::<Viewport>().rect;
        for tab in [Tab::Object, Tab::Render, Tab::Debug, Tab::Bvh] {
            desk.world().resource_mut::<Inspector>().tab = tab;
            for &id in &ids {
                desk.world().resource_mut::<Selection>().set([id]);
                desk.draw(Vec::new());
                desk.draw(Vec::new());
                let now = desk.world().resource::<Viewport>().rect;
                assert_eq!(now, rect, "{tab:?} of {id:?}");
            }
        }
    }
}

#[test]
fn of_four_thousand_entities_only_the_rows_that_are_seen_are_laid_out() {
    let mut desk = Desk::empty(SMALL);
    for i in 1..=4000_u64 {
        let name = Name::new(format!("Thing {i}"));
        desk.world().spawn((SceneId(i), PointLamp::default(), name));
    }
    desk.settle();
    let outline = desk.world().resource::<Outline>();
    assert_eq!(outline.items.len(), 4000);
    let versions = outline.versions;
    let drawn = desk.world().resource::<Hierarchy>().rows_drawn;
    assert!((20..40).contains(&drawn), "{drawn} rows of 20 points each");
    assert!(desk.find("Thing 1").is_some() && desk.find("Thing 400").is_none());
    for _ in 0..5 {
        desk.frame(Vec::new());
    }
    assert_eq!(desk.world().resource::<Outline>().versions, versions);
}

#[test]
fn every_dialog_is_drawn_at_every_size() {
    let mut desk = Desk::open("triangle");
    for size in [SMALL, USUAL, LARGE] {
        desk.size = size;
        for dialog in [
            Dialog::Keys,
            Dialog::About,
            Dialog::Preferences,
            Dialog::History,
            Dialog::Render,
        ] {
            desk.world().resource_mut::<Dialogs>().open = Some(dialog);
            desk.settle();
            assert_eq!(desk.world().resource::<Dialogs>().open, Some(dialog));
            let (title, width) = frame_of(dialog);
            let area = desk
                .context
                .memory(|memory| memory.area_rect(Id::new(title)));
            let area = area.unwrap_or_else(|| panic!("{title} is not drawn"));
            // The frame's own margins are beside it.
            assert!(area.width() < width + 20.0, "{title}: {area:?}");
            assert!(area.height() < size[1], "{title}: {area:?}");
        }
    }
}

#[test]
fn a_message_hides_nothing_of_the_picture_and_is_found_again_once_it_is_closed() {
    let text = "the file cannot be written: ".to_owned() + &"very long ".repeat(30);
    for hidden in [false, true] {
        let mut desk = Desk::empty(SMALL);
        desk.world().resource_mut::<Preferences>().show_hierarchy = !hidden;
        let lines = vec![
            "a camera is left out".to_owned(),
            "two lamps are".to_owned(),
        ];
        let mut notices = desk.world().resource_mut::<Notices>();
        notices.notes("house.glb", lines);
        notices.fault(text.clone());
        notices.tell("It was saved.");
        desk.settle();
        let picture = desk.world().resource::<Viewport>().rect;
        for (said, place, _) in texts(&desk) {
            if said == text || said.starts_with("house.glb") || said == "It was saved." {
                let middle = Vec2::new(place.center().x, place.center().y);
                assert!(
                    !picture.contains(middle),
                    "{said:?} at {place:?} in {picture:?}"
                );
                let window = Rect::from_min_size(Pos2::ZERO, vec2(SMALL[0], SMALL[1]));
                assert!(window.contains_rect(place), "{said:?} at {place:?}");
            }
        }
        desk.place_of("It was saved.");
        desk.world().resource_mut::<Notices>().close_all();
        desk.settle();
        assert!(desk.find(&text).is_none());
        desk.click_on("2 notes");
        desk.settle();
        for said in [text.as_str(), "house.glb: 2 notes", "two lamps are"] {
            desk.place_of(said);
        }
        assert!(desk.find("It was saved.").is_none(), "that does not matter");
        desk.click_on("Forget what was said");
        desk.settle();
        assert!(desk.find("2 notes").is_none());
    }
}

/// The places of all texts, with what they are cut off at.
fn texts(desk: &Desk) -> Vec<(String, Rect, Rect)> {
    fn search(shape: &Shape, clip: Rect, found: &mut Vec<(String, Rect, Rect)>) {
        match shape {
            Shape::Text(shape) => {
                let place = Rect::from_min_size(shape.pos, shape.galley.size());
                found.push((shape.galley.text().to_owned(), place, clip));
            }
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| search(shape, clip, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    for clipped in &desk.output.shapes {
        search(&clipped.shape, clipped.clip_rect, &mut found);
    }
    found
}

#[test]
fn no_text_of_the_settings_is_cut_off_at_the_side() {
    let mut desk = Desk::open("showcase");
    desk.world().resource_mut::<Inspector>().tab = Tab::Render;
    for size in [SMALL, USUAL] {
        desk.size = size;
        desk.settle();
        let right_of = desk.world().resource::<Viewport>().rect.max.x;
        for (text, place, clip) in texts(&desk) {
            if place.left() > right_of && clip.intersects(place) {
                let beyond = place.right() - clip.right();
                assert!(beyond < 1.0, "{text:?} by {beyond} at {size:?}");
            }
        }
    }
}

#[test]
fn many_messages_leave_the_picture_free_and_go_all_at_once() {
    let mut desk = Desk::empty(SMALL);
    for i in 0..30 {
        let text = format!("message {i}");
        desk.world().resource_mut::<Notices>().fault(text);
    }
    desk.settle();
    assert!(desk.find("message 29").is_some(), "the newest is shown");
    assert!(desk.find("message 25").is_none());
    let first = desk.place_of("message 26");
    let rect = desk.world().resource::<Viewport>().rect;
    assert!(first.y > rect.center().y, "{first:?} beside {rect:?}");
    desk.click_on("Close all");
    assert!(desk.world().resource::<Notices>().is_empty());
}
