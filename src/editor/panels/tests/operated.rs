//! What pointer and keys do in fields, menus and dialogs, and over the picture.

use super::super::dialogs::{Dialog, Dialogs};
use super::super::hierarchy::Hierarchy;
use super::super::inspector::{Inspector, Tab};
use super::desk::{Desk, USUAL};
use crate::editor::action::Action;
use crate::editor::document::{Document, Purpose, Question, adopt};
use crate::editor::inspection::DebugRay;
use crate::editor::inspection::debug_ray::Shot;
use crate::editor::notice::Notices;
use crate::editor::render_job::{RenderFrom, RenderJob, RenderRequest, start_render};
use crate::editor::viewport::{Show, Viewport};
use crate::inspect::InspectSettings;
use crate::scene::{PointLamp, RenderSettings, SceneId};
use crate::sync::TracedCameras;
use crate::view::TracedView;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::math::{Rect, UVec2, Vec2};
use bevy::transform::components::Transform;
use bevy_egui::egui::{Event, Id, Key, Modifiers, Pos2, vec2};
use std::time::Instant;

#[test]
fn a_number_that_is_dragged_changes_its_component_and_no_other_as_one_step() {
    let mut desk = Desk::open("cornell-box");
    let mut lamps = desk
        .world()
        .query_filtered::<(Entity, &SceneId), With<PointLamp>>();
    let (lamp, id) = lamps
        .single(desk.app.world())
        .map(|(e, id)| (e, *id))
        .unwrap();
    desk.select([id]);
    let before = desk.world().get::<PointLamp>(lamp).unwrap().clone();
    let steps = desk
        .world()
        .resource::<crate::editor::history::History>()
        .position();
    let at = desk.place_of("Intensity") + vec2(110.0, 0.0);
    desk.drag(at, vec2(60.0, 0.0));
    let after = desk.world().get::<PointLamp>(lamp).unwrap().clone();
    assert!(after.intensity > before.intensity, "{before:?} {after:?}");
    assert_eq!((after.color, after.cone), (before.color, before.cone));
    let history = desk.world().resource::<crate::editor::history::History>();
    assert_eq!(history.position(), steps + 1);
}

#[test]
fn a_number_that_does_not_fit_its_field_loses_digits_before_it_gets_an_exponent() {
    let mut desk = Desk::open("cornell-box");
    let (lamp, id) = desk.named("Lamp");
    desk.select([id]);
    for (x, shown) in [
        (-0.039_72, "-0.04"),
        (0.039_72, "0.0397"),
        (-3.97e-7, "-4e-7"),
    ] {
        let mut place = desk.world().get_mut::<Transform>(lamp).unwrap();
        place.translation.x = x;
        desk.settle();
        let field = desk.place_beside("Position", shown);
        assert!(field.x > 0.0);
    }
}

#[test]
fn a_number_that_is_typed_out_of_range_is_brought_into_it_and_words_are_refused() {
    let mut desk = Desk::open("cornell-box");
    desk.world().resource_mut::<Inspector>().tab = Tab::Render;
    desk.settle();
    let type_into = |desk: &mut Desk, text: &str| {
        let at = desk.place_of("Mirror depth");
        // The number stands at the right end of the slider.
        let at = Pos2::new(desk.size[0] - 40.0, at.y);
        desk.click(at);
        assert!(desk.context.text_edit_focused());
        assert!(!desk.world().resource::<Viewport>().takes_keys);
        desk.frame(vec![Event::Text(text.into())]);
        desk.key(Key::Enter);
        desk.settle();
        desk.world().resource::<RenderSettings>().max_depth
    };
    assert_eq!(type_into(&mut desk, "12"), 12);
    assert_eq!(type_into(&mut desk, "4000"), 50);
    assert_eq!(type_into(&mut desk, "many"), 50);
    assert!(desk.world().resource::<Viewport>().takes_keys);
}

#[test]
fn a_press_that_is_let_go_late_is_still_a_click() {
    let mut desk = Desk::open("triangle");
    let at = desk.place_of("Edit");
    desk.point(at);
    desk.button(at, true, Modifiers::NONE);
    desk.wait(2.0);
    desk.button(at, false, Modifiers::NONE);
    desk.settle();
    assert!(desk.find("History…").is_some(), "the menu is open");
}

#[test]
fn menus_do_what_they_say() {
    let mut desk = Desk::open("triangle");
    desk.click_on("File");
    desk.click_on("Save");
    let question = desk.world().resource::<Document>().question.clone();
    let purpose = Purpose::SaveAs;
    assert!(
        matches!(&question, Some(Question::Path { purpose: asked, .. } | Question::Waiting { purpose: asked }) if *asked == purpose),
        "{question:?}"
    );
}

#[test]
fn a_name_that_is_suggested_is_typed_over_and_one_that_was_refused_is_mended() {
    for (refused, typed) in [
        (None, "room.scn.ron"),
        (Some("no room".to_owned()), "triangle.scn.ronroom"),
    ] {
        let mut desk = Desk::open("triangle");
        desk.world().resource_mut::<Document>().question = Some(Question::Path {
            purpose: Purpose::SaveAs,
            suggestion: "triangle.scn.ron".into(),
            refused,
        });
        desk.settle();
        desk.frame(vec![Event::Text("room".into())]);
        desk.settle();
        desk.place_of(typed);
    }
}

#[test]
fn what_is_done_with_a_path_is_shown_in_a_frame_before_the_others_wait_for_it() {
    let mut desk = Desk::open("triangle");
    desk.world().resource_mut::<Document>().question = Some(Question::Path {
        purpose: Purpose::Open,
        suggestion: "/no/such.obj".into(),
        refused: Some("an older reason".into()),
    });
    desk.settle();
    desk.place_of("an older reason");
    desk.key(Key::Enter);
    desk.frame(Vec::new());
    desk.place_of("Reading /no/such.obj…");
    assert_eq!(desk.find("an older reason"), None);
    desk.settle();
    assert_eq!(desk.find("Reading /no/such.obj…"), None);
    let question = &desk.world().resource::<Document>().question;
    let stands = matches!(question, Some(Question::Path { refused: Some(why), .. }) if why == "an older reason");
    assert!(!stands, "{question:?}");
}

#[test]
fn the_pointer_and_the_keys_are_the_scene_s_only_where_no_panel_wants_them() {
    let mut desk = Desk::open("triangle");
    let hovered = |desk: &mut Desk, at: Pos2| {
        desk.point(at);
        desk.world().resource::<Viewport>().hovered
    };
    let rect = desk.world().resource::<Viewport>().rect;
    assert!(rect.width() > 500.0 && rect.height() > 400.0, "{rect:?}");
    let middle = Pos2::new(rect.center().x, rect.center().y);
    assert!(hovered(&mut desk, middle));
    for at in [
        [20.0, 10.0],
        [100.0, 300.0],
        [1200.0, 300.0],
        [600.0, 714.0],
    ] {
        assert!(!hovered(&mut desk, at.into()), "{at:?}");
    }
    // The divider is the panels', what is beside it the scene's.
    desk.world().resource_mut::<Viewport>().show = Show::Split;
    desk.settle();
    assert!(!hovered(&mut desk, middle));
    assert!(hovered(&mut desk, middle + vec2(30.0, 0.0)));
    desk.drag(middle, vec2(80.0, 0.0));
    let expected = 0.5 + 80.0 / rect.width();
    let divider = desk.world().resource::<Viewport>().divider;
    assert!(
        (divider - expected).abs() < 0.01,
        "{divider}, not {expected}"
    );
    // An open menu has both.
    desk.click_on("View");
    let viewport = desk.world().resource::<Viewport>().clone();
    assert!(!viewport.takes_keys);
    desk.key(Key::Escape);
    desk.settle();
    assert!(desk.world().resource::<Viewport>().takes_keys);
}

#[test]
fn a_dialog_takes_everything_until_escape() {
    let mut desk = Desk::open("triangle");
    desk.world().write_message(Action::run("help.keys"));
    desk.settle();
    assert_eq!(desk.world().resource::<Dialogs>().open, Some(Dialog::Keys));
    assert!(desk.find("Keys and mouse").is_some());
    let viewport = desk.world().resource::<Viewport>().clone();
    assert!(!viewport.takes_keys);
    let middle = Pos2::new(640.0, 360.0);
    desk.point(middle);
    assert!(!desk.world().resource::<Viewport>().hovered);
    desk.key(Key::Escape);
    desk.settle();
    assert_eq!(desk.world().resource::<Dialogs>().open, None);
    assert!(desk.world().resource::<Viewport>().takes_keys);
}

#[test]
fn a_dialog_that_had_less_to_show_grows_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut desk = Desk::open("triangle");
    desk.world().write_message(Action::run("file.render"));
    desk.settle();
    let height = |desk: &Desk| {
        let area = Id::new("Render to file");
        let area = desk.context.memory(|memory| memory.area_rect(area));
        area.map_or(0.0, |area| area.height())
    };
    let form = height(&desk);
    desk.begin_endless_render(folder.path().join("a.png"));
    desk.settle();
    let progress = height(&desk);
    assert!(progress < form, "{progress} {form}");
    desk.world().resource_mut::<RenderJob>().cancel();
    let start = Instant::now();
    while desk.world().resource::<RenderJob>().progress().is_some() {
        assert!(start.elapsed().as_secs() < 60, "it goes on");
        desk.settle();
    }
    desk.settle();
    assert_eq!(height(&desk), form);
}

#[test]
fn the_dialog_tells_what_was_rendered_however_long_ago() {
    let folder = tempfile::tempdir().unwrap();
    let mut desk = Desk::open("triangle");
    let file = folder.path().join("done.png");
    let request = RenderRequest {
        file: file.clone(),
        camera: RenderFrom::FirstCamera,
        settings: RenderSettings {
            size: UVec2::splat(8),
            spp: 1,
            ..RenderSettings::default()
        },
    };
    start_render(desk.world(), request).unwrap();
    let start = Instant::now();
    while desk.world().resource::<RenderJob>().progress().is_some() {
        assert!(start.elapsed().as_secs() < 60, "it goes on");
        desk.settle();
    }
    desk.world().resource_mut::<Notices>().close_all();
    desk.world().write_message(Action::run("file.render"));
    desk.settle();
    let done = desk
        .world()
        .resource::<RenderJob>()
        .done()
        .unwrap()
        .to_owned();
    assert!(done.contains("done.png"), "{done}");
    assert!(desk.find(&done).is_some());
}

#[test]
fn unsaved_changes_are_asked_about_and_cancel_leaves_everything() {
    let mut desk = Desk::open("triangle");
    let ids = desk.ids();
    desk.select([ids[0]]);
    desk.world().write_message(Action::run("edit.duplicate"));
    desk.settle();
    assert_eq!(desk.ids().len(), ids.len() + 1);
    desk.world().write_message(Action::run("file.new"));
    desk.settle();
    assert!(desk.find("Don't save").is_some());
    desk.click_on("Cancel");
    desk.settle();
    assert!(desk.find("Don't save").is_none());
    assert_eq!(desk.ids().len(), ids.len() + 1);
}

#[test]
fn searching_leaves_what_was_searched_for_and_its_keys_go_nowhere_else() {
    let mut desk = Desk::open("cornell-box");
    let all = desk.world().resource::<Hierarchy>().rows_drawn;
    let hint = desk.place_of("Search");
    desk.click(hint);
    desk.frame(vec![Event::Text("camera".into())]);
    desk.settle();
    assert!(!desk.world().resource::<Viewport>().takes_keys);
    let found = desk.world().resource::<Hierarchy>().rows_drawn;
    assert!(found >= 1 && found < all, "{found} of {all}");
}

#[test]
fn the_picture_alone_fills_the_window_until_escape() {
    let mut desk = Desk::open("cornell-box");
    let rect = |desk: &mut Desk| desk.world().resource::<Viewport>().rect;
    let before = rect(&mut desk);
    desk.world().write_message(Action::run("view.only-picture"));
    desk.settle();
    assert_eq!(rect(&mut desk).size(), Vec2::new(USUAL[0], USUAL[1]));
    assert_eq!(desk.find("Object"), None);
    desk.world().write_message(Action::run("select.none"));
    desk.settle();
    assert_eq!(rect(&mut desk), before);
    assert!(desk.find("Object").is_some());
}

#[test]
fn what_was_picked_and_folded_in_a_scene_is_forgotten_with_it() {
    let mut desk = Desk::open("cornell-box");
    let id = desk.ids()[0];
    let camera = desk.world().resource::<TracedCameras>().0[0].camera.clone();
    desk.world().resource_mut::<DebugRay>().shoot(Shot {
        pixel: UVec2::ZERO,
        camera,
        size: UVec2::new(40, 30),
    });
    desk.world().resource_mut::<InspectSettings>().boxes.object = id.0;
    let mut views = desk.world().query::<&mut TracedView>();
    let mut view = views.single_mut(desk.app.world_mut()).unwrap();
    view.region = Some(Rect::new(0.0, 0.0, 0.5, 0.5));
    view.range = Some([1.0, 2.0]);
    let mut panels = desk.world().resource_mut::<Hierarchy>();
    panels.folded.toggle(id);
    panels.anchor = Some(id);
    adopt(desk.world(), "another", None);
    desk.settle();
    assert!(desk.world().resource::<DebugRay>().shot().is_none());
    let boxes = &desk.world().resource::<InspectSettings>().boxes;
    assert_eq!(boxes.object, 0);
    let mut views = desk.world().query::<&TracedView>();
    let view = views.single(desk.app.world()).unwrap();
    assert_eq!((view.region, view.range), (None, None));
    let panels = desk.world().resource::<Hierarchy>();
    assert!(panels.folded.is_empty() && panels.anchor.is_none());
}
