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
use bevy::ecs::query::With;
use bevy::math::Vec2;
use bevy_egui::egui::accesskit::Role;
use bevy_egui::egui::{Id, Pos2, Rect, Shape, vec2};

/// What is selected one after the other in a tab: only that of the object differs from one to the next.
fn shown_in<T>(tab: Tab, ids: &[T]) -> &[T] {
    match tab {
        Tab::Object => ids,
        _ => &ids[..1],
    }
}

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
fn panels_that_a_small_window_made_narrow_are_as_wide_as_before_once_there_is_room() {
    let mut desk = Desk::open("cornell-box");
    let rect = |desk: &mut Desk| desk.world().resource::<Viewport>().rect;
    let before = rect(&mut desk);
    desk.size = [480.0, 360.0, 1.0];
    desk.settle();
    assert!(rect(&mut desk).min.x < before.min.x, "they gave way");
    desk.size = USUAL;
    desk.settle();
    assert_eq!(rect(&mut desk), before);
    // So is one that a person made wider.
    let edge = Pos2::new(before.min.x, before.center().y);
    desk.drag(edge, vec2(60.0, 0.0));
    desk.settle();
    let wider = rect(&mut desk);
    assert!((wider.min.x - before.min.x - 60.0).abs() < 4.0, "{wider:?}");
    for size in [SMALL, [480.0, 360.0, 1.0], USUAL] {
        desk.size = size;
        desk.settle();
    }
    assert_eq!(rect(&mut desk), wider);
}

#[test]
fn fields_end_at_one_edge_however_wide_the_panel_is() {
    const FIELDS: [Role; 3] = [Role::SpinButton, Role::ComboBox, Role::TextInput];
    let mut desk = Desk::open("showcase");
    desk.context.enable_accesskit();
    let ids = desk.ids();
    for (size, width) in [(SMALL, 300.0), (USUAL, 420.0)] {
        desk.size = [size[0], 1600.0, 1.0];
        desk.world().resource_mut::<Preferences>().inspector_width = width;
        desk.settle();
        for tab in [Tab::Object, Tab::Render] {
            desk.world().resource_mut::<Inspector>().tab = tab;
            for &id in shown_in(tab, &ids) {
                desk.select([id]);
                let panel = desk.world().resource::<Viewport>().rect.max.x;
                // The last field of each row.
                let mut rows: Vec<Rect> = Vec::new();
                for field in FIELDS.iter().flat_map(|&role| desk.bounds(role)) {
                    if field.left() < panel {
                        continue;
                    }
                    let same = |row: &&mut Rect| row.y_range().contains(field.center().y);
                    match rows.iter_mut().find(same) {
                        Some(row) if row.right() < field.right() => *row = field,
                        Some(_) => {}
                        None => rows.push(field),
                    }
                }
                let most = rows.iter().map(Rect::right).fold(0.0, f32::max);
                let is_early = |row: &&Rect| most - row.right() > 1.5;
                let early: Vec<&Rect> = rows.iter().filter(is_early).collect();
                assert!(
                    early.is_empty(),
                    "{tab:?} of {id:?}: of {rows:#?}\n{early:#?} end before {most}"
                );
            }
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
        desk.click_on("3 notes");
        desk.settle();
        for said in [text.as_str(), "house.glb: 2 notes", "two lamps are"] {
            desk.place_of(said);
        }
        assert!(desk.find("It was saved.").is_none(), "that does not matter");
        desk.click_on("Forget what was said");
        desk.settle();
        assert!(desk.find("3 notes").is_none());
    }
}

/// The places of all texts, with what they are cut off at.
pub fn texts(desk: &Desk) -> Vec<(String, Rect, Rect)> {
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
fn no_text_of_any_tab_is_cut_off_at_the_side_and_long_names_end_in_an_ellipsis() {
    let mut desk = Desk::with_trees("showcase");
    desk.context.enable_accesskit();
    let ids = desk.ids();
    let long = "A name that somebody took much time for and that is longer than any panel is wide";
    let mut names = desk.world().query_filtered::<&mut Name, With<SceneId>>();
    for mut name in names.iter_mut(desk.app.world_mut()) {
        name.set(long);
    }
    for size in [SMALL, USUAL] {
        desk.size = size;
        for tab in [Tab::Object, Tab::Render, Tab::Debug, Tab::Bvh] {
            desk.world().resource_mut::<Inspector>().tab = tab;
            // One after the other, then all at once.
            let choices = shown_in(tab, &ids).iter().map(|&id| vec![id]);
            for selected in choices.chain([ids.clone()]) {
                desk.select(selected);
                let rect = desk.world().resource::<Viewport>().rect;
                // What is typed is scrolled in its field.
                let typed = desk.bounds(Role::TextInput);
                let is_typed = |place: Rect| {
                    typed
                        .iter()
                        .any(|field| field.contains(place.left_center()))
                };
                for (text, place, clip) in texts(&desk) {
                    let is_beside = place.left() > rect.max.x || place.left() < rect.min.x;
                    if is_beside && clip.intersects(place) && !is_typed(place) {
                        let beyond = place.right() - clip.right();
                        assert!(beyond < 1.0, "{text:?} by {beyond} at {size:?}, {tab:?}");
                    }
                }
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
