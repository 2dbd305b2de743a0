//! The rows of the list: chosen, renamed, gone through by keys, and ten thousand of them.

use super::super::hierarchy::Hierarchy;
use super::super::outline::Outline;
use super::super::renaming::Renaming;
use super::super::theme::tests::assert_readable;
use super::desk::Desk;
use crate::editor::action::Action;
use crate::editor::edits::name_of;
use crate::editor::history::History;
use crate::editor::preferences::{Preferences, ThemeChoice};
use crate::editor::selection::Selection;
use crate::editor::viewport::Viewport;
use crate::scene::{Phong, PointLamp, SceneId, UsesMaterial};
use bevy::camera::visibility::Visibility;
use bevy::ecs::name::Name;
use bevy_egui::egui::accesskit::Role;
use bevy_egui::egui::{Event, Key, Modifiers, MouseWheelUnit, Shape, Theme, TouchPhase, vec2};
use std::time::Instant;

#[test]
fn a_click_on_a_row_selects_ctrl_adds_and_shift_takes_what_lies_between() {
    let mut desk = Desk::open("cornell-box");
    let names: Vec<String> = {
        let outline = desk.world().resource::<Outline>();
        let items = outline.items.iter();
        items.take(5).map(|item| item.name.clone()).collect()
    };
    let ids: Vec<SceneId> = names.iter().map(|name| desk.named(name).1).collect();
    desk.click_on(&names[1]);
    assert_eq!(desk.world().resource::<Selection>().ids(), [ids[1]]);
    let at = desk.place_of(&names[3]);
    desk.click_with(at, Modifiers::COMMAND | Modifiers::CTRL);
    assert_eq!(desk.world().resource::<Selection>().ids(), [ids[1], ids[3]]);
    desk.click_on(&names[0]);
    let at = desk.place_of(&names[2]);
    desk.click_with(at, Modifiers::SHIFT);
    assert_eq!(desk.world().resource::<Selection>().ids(), &ids[..3]);
}

#[test]
fn the_name_of_what_is_hidden_can_be_read_in_both_themes() {
    let mut desk = Desk::open("cornell-box");
    let (entity, _) = desk.named("Floor");
    desk.world().entity_mut(entity).insert(Visibility::Hidden);
    for (theme, choice) in [
        (Theme::Dark, ThemeChoice::Dark),
        (Theme::Light, ThemeChoice::Light),
    ] {
        desk.world().resource_mut::<Preferences>().theme = choice;
        desk.settle();
        let inks = desk.output.shapes.iter().filter_map(|clipped| {
            let Shape::Text(text) = &clipped.shape else {
                return None;
            };
            let is_row = text.galley.text() == "Floor";
            is_row.then_some(text.override_text_color?)
        });
        let inks: Vec<_> = inks.collect();
        assert_eq!(inks.len(), 1, "{theme:?}");
        assert_readable(theme, inks[0], "of a hidden row");
    }
}

/// The first entities of the list.
fn first_names(desk: &mut Desk) -> Vec<String> {
    let outline = desk.world().resource::<Outline>();
    let items = outline.items.iter();
    items.take(5).map(|item| item.name.clone()).collect()
}

#[test]
fn a_name_typed_in_the_inspector_stays_when_another_row_is_clicked_and_goes_with_escape() {
    let mut desk = Desk::open("cornell-box");
    let names = first_names(&mut desk);
    let (entity, id) = desk.named(&names[0]);
    let name = |desk: &mut Desk| desk.world().get::<Name>(entity).unwrap().to_string();
    desk.select([id]);
    let field = desk.place_of("Name") + vec2(150.0, 0.0);
    desk.click(field);
    desk.frame(vec![Event::Text("qqq".into())]);
    desk.key(Key::Escape);
    desk.settle();
    assert_eq!(name(&mut desk), names[0]);
    desk.click(field);
    desk.frame(vec![Event::Text("zzz".into())]);
    desk.click_on(&names[1]);
    desk.settle();
    let now = name(&mut desk);
    assert!(now.contains("zzz") && !now.contains("qqq"), "{now}");
    let (_, other) = desk.named(&names[1]);
    assert_eq!(desk.world().resource::<Selection>().ids(), [other]);
}

#[test]
fn a_click_on_a_row_below_the_one_that_is_renamed_keeps_the_name_and_selects() {
    let mut desk = Desk::open("cornell-box");
    let names = first_names(&mut desk);
    let (entity, id) = desk.named(&names[1]);
    let (_, below) = desk.named(&names[3]);
    desk.world().resource_mut::<Hierarchy>().renaming = Some(Renaming {
        id,
        text: "Renamed".into(),
        focused: false,
    });
    desk.settle();
    desk.click_on(&names[3]);
    desk.settle();
    let name = desk.world().get::<Name>(entity).unwrap();
    assert_eq!(name.as_str(), "Renamed");
    assert_eq!(desk.world().resource::<Selection>().ids(), [below]);
}

#[test]
fn a_name_that_is_typed_stays_when_its_row_is_seen_no_more_or_another_is_to_be_named() {
    let ways: [fn(&mut Desk); 4] = [
        |desk| {
            let over = desk.place_of("Thing 3");
            desk.point(over);
            let (unit, phase) = (MouseWheelUnit::Line, TouchPhase::Move);
            desk.frame(vec![Event::MouseWheel {
                unit,
                delta: vec2(0.0, -40.0),
                phase,
                modifiers: Modifiers::NONE,
            }]);
            // The list glides.
            for _ in 0..60 {
                desk.frame(Vec::new());
            }
            assert_eq!(desk.find("Thing 3"), None);
        },
        |desk| {
            desk.world().write_message(Action::run("view.hierarchy"));
        },
        |desk| {
            desk.world().write_message(Action::run("view.only-picture"));
        },
        |desk| {
            let other = SceneId(1003);
            desk.world().resource_mut::<Selection>().set([other]);
            desk.world().write_message(Action::run("edit.rename"));
        },
    ];
    for (i, way) in ways.into_iter().enumerate() {
        let mut desk = Desk::open("triangle");
        for i in 0..300 {
            let name = Name::new(format!("Thing {i}"));
            desk.world().spawn((SceneId(1000 + i), name));
        }
        let named = SceneId(1002);
        desk.select([named]);
        for letters in ["Mo", "on"] {
            // Asked for again in the middle.
            desk.world().write_message(Action::run("edit.rename"));
            desk.settle();
            if letters == "on" {
                desk.key(Key::End);
            }
            desk.frame(vec![Event::Text(letters.into())]);
        }
        way(&mut desk);
        desk.settle();
        assert_eq!(name_of(desk.world(), named), "Moon", "way {i}");
    }
}

#[test]
fn arrows_go_through_the_rows_and_fold_them_and_letters_find_names() {
    let mut desk = Desk::open("cornell-box");
    let names = first_names(&mut desk);
    let selected = |desk: &mut Desk| {
        let id = desk.world().resource::<Selection>().active().unwrap();
        name_of(desk.world(), id)
    };
    desk.click_on(&names[0]);
    assert!(desk.world().resource::<Viewport>().takes_letters);
    desk.key(Key::ArrowDown);
    assert_eq!(selected(&mut desk), names[1]);
    desk.key(Key::ArrowUp);
    assert_eq!(selected(&mut desk), names[0]);
    desk.settle();
    let viewport = desk.world().resource::<Viewport>().clone();
    assert!(viewport.takes_keys && !viewport.takes_letters);
    desk.frame(vec![Event::Text("l".into())]);
    desk.frame(vec![Event::Text("a".into())]);
    assert_eq!(selected(&mut desk), "Lamp");
    desk.key(Key::Escape);
    desk.settle();
    assert!(desk.world().resource::<Viewport>().takes_letters);

    let (_, lamp) = desk.named("Lamp");
    let (_, first) = desk.named(&names[0]);
    let parent = Some(first);
    desk.world()
        .write_message(Action::Reparent(vec![lamp], parent));
    desk.select([first]);
    let at = desk.place_of(&names[0]);
    desk.click(at);
    desk.key(Key::ArrowLeft);
    desk.settle();
    assert_eq!(desk.find("Lamp"), None, "it is folded away");
    desk.key(Key::ArrowRight);
    desk.key(Key::ArrowRight);
    assert_eq!(selected(&mut desk), "Lamp");
    desk.key(Key::ArrowLeft);
    assert_eq!(selected(&mut desk), names[0]);
}

#[test]
fn a_list_that_is_not_drawn_gives_the_letters_back_and_takes_them_no_more_when_it_is_drawn_again() {
    let takes_letters = |desk: &mut Desk| {
        desk.settle();
        desk.world().resource::<Viewport>().takes_letters
    };
    for id in ["view.only-picture", "view.hierarchy"] {
        let mut desk = Desk::open("cornell-box");
        let names = first_names(&mut desk);
        desk.click_on(&names[0]);
        desk.key(Key::ArrowDown);
        assert!(!takes_letters(&mut desk));
        for _ in ["away", "back"] {
            desk.world().write_message(Action::run(id));
            assert!(takes_letters(&mut desk), "{id}");
        }
        let selected = desk.world().resource::<Selection>().clone();
        desk.key(Key::ArrowDown);
        assert_eq!(*desk.world().resource::<Selection>(), selected, "{id}");
    }
}

#[test]
fn an_object_dropped_onto_a_material_or_a_material_onto_an_object_gets_it_in_one_step() {
    let mut desk = Desk::open("cornell-box");
    let material = SceneId(500);
    let brick = (material, Name::new("Brick"), Phong::default());
    let brick = desk.world().spawn(brick).id();
    desk.settle();
    let (floor, _) = desk.named("Floor");
    let (short, _) = desk.named("Short block");
    let has = |desk: &mut Desk, object| {
        desk.settle();
        desk.world().get::<UsesMaterial>(object) == Some(&UsesMaterial(brick))
    };
    let steps = |desk: &mut Desk| desk.world().resource::<History>().position();
    desk.settle();
    let first = steps(&mut desk);
    let [from, to] = ["Floor", "Brick"].map(|name| desk.place_of(name));
    desk.drag(from, to - from);
    assert!(has(&mut desk, floor));
    assert_eq!(steps(&mut desk), first + 1);
    let text = desk.world().resource::<History>().undo_text();
    assert_eq!(text, Some("Give Floor the material Brick"));
    let [from, to] = ["Brick", "Short block"].map(|name| desk.place_of(name));
    desk.drag(from, to - from);
    assert!(has(&mut desk, short));
    // A light has no material, and stays where it is.
    let (_, lamp) = desk.named("Lamp");
    let [from, to] = ["Lamp", "Brick"].map(|name| desk.place_of(name));
    desk.drag(from, to - from);
    desk.settle();
    assert_eq!(steps(&mut desk), first + 2);
    assert_eq!(name_of(desk.world(), lamp), "Lamp");
}

#[test]
fn the_eye_does_what_h_does_and_a_material_has_none() {
    let mut desk = Desk::open("cornell-box");
    desk.context.enable_accesskit();
    desk.world()
        .spawn((SceneId(500), Name::new("Brick"), Phong::default()));
    desk.settle();
    let eyes = desk.controls(Role::CheckBox);
    let eye = |desk: &Desk, name: &str| {
        let row = desk.place_of(name);
        let eye = eyes.iter().find(|eye| (eye.y - row.y).abs() < 6.0);
        eye.copied().filter(|eye| eye.x < row.x + 250.0)
    };
    assert_eq!(eye(&desk, "Brick"), None, "nothing of it is to be hidden");
    let (floor, _) = desk.named("Floor");
    desk.world().entity_mut(floor).insert(Visibility::Visible);
    desk.settle();
    let seen = |desk: &mut Desk| *desk.world().get::<Visibility>(floor).unwrap();
    let at = eye(&desk, "Floor").expect("an object has an eye");
    for (expected, step) in [
        (Visibility::Hidden, "Hide Floor"),
        (Visibility::Inherited, "Show Floor"),
    ] {
        desk.click(at);
        desk.settle();
        assert_eq!(seen(&mut desk), expected);
        let history = desk.world().resource::<History>();
        assert_eq!(history.undo_text(), Some(step));
    }
}

#[test]
fn of_ten_thousand_rows_only_those_that_are_seen_are_laid_out_and_the_last_is_reached_by_name() {
    let mut desk = Desk::open("triangle");
    for i in 0..10_000 {
        let id = SceneId(1000 + i);
        let name = Name::new(format!("Thing {i}"));
        desk.world().spawn((id, name));
    }
    desk.settle();
    let drawn = desk.world().resource::<Hierarchy>().rows_drawn;
    assert!((10..60).contains(&drawn), "{drawn} rows");
    let top = desk.world().resource::<Outline>().items[0].name.clone();
    desk.click_on(&top);
    desk.key(Key::ArrowDown);
    for letter in "thing 9999".chars() {
        desk.frame(vec![Event::Text(letter.to_string())]);
    }
    desk.settle();
    desk.place_of("Thing 9999");
    let drawn = desk.world().resource::<Hierarchy>().rows_drawn;
    assert!((10..60).contains(&drawn), "{drawn} rows");
}

/// Prints how long a frame of the panels takes with ten thousand entities, beside ten.
#[test]
#[ignore = "a measurement: run it by itself, with --nocapture"]
fn how_long_a_frame_takes_with_ten_thousand_entities() {
    for count in [10, 10_000] {
        let mut desk = Desk::open("triangle");
        for i in 0..count {
            let (id, name) = (SceneId(1000 + i), Name::new(format!("Thing {i}")));
            desk.world().spawn((id, name, PointLamp::default()));
        }
        desk.settle();
        let time = |desk: &mut Desk, what: &str, before: fn(&mut Desk, u32)| {
            let mut all: Vec<f64> = (0..20)
                .map(|i| {
                    before(desk, i);
                    desk.app.update();
                    let start = Instant::now();
                    desk.draw(Vec::new());
                    start.elapsed().as_secs_f64() * 1e3
                })
                .collect();
            all.sort_by(f64::total_cmp);
            println!(
                "{count} entities, {what}: {:.2} ms, at most {:.2}",
                all[10], all[19]
            );
        };
        time(&mut desk, "at rest", |_, _| {});
        let rename = |desk: &mut Desk, i: u32| {
            let entity = desk.named("Thing 5").0;
            let name = format!("Thing 5{}", " ".repeat(i as usize % 2));
            desk.world()
                .entity_mut(entity)
                .insert(Name::new(name.trim().to_owned()));
        };
        time(&mut desk, "after one was named", rename);
        let all = desk.ids();
        desk.select(all);
        time(&mut desk, "all selected", |_, _| {});
    }
}
