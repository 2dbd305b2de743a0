//! The table of commands as a person meets it: in menus, on keys, in the palette, by a right click.

use super::super::dialogs::{Dialog, Dialogs};
use super::super::palette::OpenPalette;
use super::{Desk, SMALL, USUAL, texts};
use crate::editor::command::{AddCommands, Command, CommandTable, Over, State};
use crate::editor::inspection::debug_ray::Shot;
use crate::editor::inspection::{DebugRay, Which};
use crate::editor::keys::Keys;
use crate::editor::notice::Notices;
use crate::editor::pick;
use crate::editor::pointer::{Armed, PixelAsked, RightClicked};
use crate::editor::preferences::Preferences;
use crate::editor::selection::Selection;
use crate::editor::viewport::{EditorCamera, Viewport};
use crate::editor::{Action, edits};
use crate::inspect::{InspectPreset, InspectSettings, Names, Question, answer};
use crate::scene::SceneId;
use crate::sync::TracedCameras;
use bevy::camera::{Camera, CameraProjection, PerspectiveProjection, RenderTargetInfo};
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::math::{Quat, UVec2, Vec2};
use bevy::transform::components::Transform;
use bevy_egui::egui::accesskit::Role;
use bevy_egui::egui::{CursorIcon, Event, Key, PointerButton, Pos2, Shape, vec2};
use std::collections::HashSet;
use std::time::{Duration, Instant};

/// How often the command of an app was run.
#[derive(Resource, Default)]
struct Runs(u32);

fn with_row(row: Command) -> Desk {
    let mut desk = Desk::open("triangle");
    desk.app.init_resource::<Runs>().add_commands([row]);
    desk.settle();
    desk
}

fn start() -> Command {
    let run = |world: &mut World| world.resource_mut::<Runs>().0 += 1;
    Command::new(
        "game.start",
        "Start the game",
        "Begins the first level",
        run,
    )
    .keys(&["Ctrl+Shift+G"])
    .menu("Game", 0)
    .over(&[Over::Nothing])
}

fn palette(desk: &mut Desk, text: &str) {
    desk.world().write_message(Action::run("help.palette"));
    desk.settle();
    desk.frame(vec![Event::Text(text.into())]);
    desk.frame(Vec::new());
}

#[test]
fn a_row_that_an_app_adds_stands_in_its_menu_the_palette_the_keys_and_the_menu_of_a_right_click() {
    let mut desk = with_row(start());
    let runs = |desk: &mut Desk| desk.world().resource::<Runs>().0;
    desk.click_on("Game");
    assert!(desk.find("Ctrl+Shift+G").is_some(), "menus show keys");
    desk.click_on("Start the game");
    assert_eq!(runs(&mut desk), 1, "by the menu");

    palette(&mut desk, "sttgm");
    desk.place_of("Start the game");
    desk.key(Key::Enter);
    assert_eq!(runs(&mut desk), 2, "by the palette");
    assert!(desk.world().resource::<OpenPalette>().0.is_none());

    let keys: Keys = "Ctrl+Shift+G".parse().unwrap();
    let table = desk.world().resource::<CommandTable>();
    let bindings = Default::default();
    let row = table.of_keys(keys, &bindings).expect("it has keys");
    assert_eq!(row.id, "game.start");
    desk.world().write_message(Action::run("help.keys"));
    desk.settle();
    desk.world().resource_mut::<Dialogs>().bindings_search = "start the".into();
    desk.settle();
    desk.place_of("Ctrl+Shift+G");
    desk.key(Key::Escape);

    desk.settle();
    let (at, over) = (Vec2::new(640.0, 300.0), Over::Nothing);
    desk.world().trigger(RightClicked { at, over });
    desk.settle();
    desk.click_on("Start the game");
    assert_eq!(runs(&mut desk), 3, "by a right click");
}

#[test]
fn what_cannot_be_run_says_why_and_does_nothing() {
    let mut desk = with_row(start().state(|_| State::when(false, "The level is not built.")));
    palette(&mut desk, "start the game");
    desk.place_of("Start the game");
    desk.place_of("The level is not built.");
    desk.key(Key::Enter);
    assert!(
        desk.world().resource::<OpenPalette>().0.is_some(),
        "it stays"
    );
    desk.key(Key::Escape);
    desk.settle();
    assert!(desk.world().resource::<OpenPalette>().0.is_none());
    desk.world().write_message(Action::run("game.start"));
    desk.settle();
    assert_eq!(desk.world().resource::<Runs>().0, 0);
    let said = |desk: &mut Desk, text: &str| {
        let mut notices = desk.world().resource_mut::<Notices>();
        notices
            .shown()
            .iter()
            .any(|notice| notice.text.contains(text))
    };
    assert!(said(&mut desk, "The level is not built."));
    desk.world().write_message(Action::run("game.stop"));
    desk.settle();
    assert!(said(&mut desk, "game.stop"), "an id that is none is named");
}

#[test]
fn the_palette_finds_by_letters_and_runs_what_is_chosen_with_the_arrows() {
    let mut desk = Desk::open("cornell-box");
    palette(&mut desk, "select");
    desk.place_of("Select all");
    assert_eq!(desk.find("Duplicate"), None);
    for _ in 0..2 {
        desk.key(Key::ArrowDown);
    }
    for _ in 0..2 {
        desk.key(Key::ArrowUp);
    }
    desk.key(Key::Enter);
    desk.settle();
    let all = desk.ids().len();
    assert_eq!(desk.world().resource::<Selection>().ids().len(), all);
    desk.click_on("Edit");
    desk.click_on("Delete");
    assert!(desk.ids().is_empty());
}

#[test]
fn names_and_explanations_of_the_palette_end_in_an_ellipsis_before_its_keys() {
    let long = "which takes more words to say than there is room for in any row of the palette, or in two of them";
    let names = [
        "Start the game".to_owned(),
        format!("Start the game, {long}"),
    ];
    for (name, size) in names.iter().flat_map(|name| [(name, SMALL), (name, USUAL)]) {
        let mut row = start();
        row.name = name.clone().into();
        row.help = format!("Begins the first level, {long}").into();
        let mut desk = with_row(row);
        desk.size = size;
        palette(&mut desk, "Start the game");
        let texts = texts(&desk);
        let place = |wanted: &str| {
            let mut found = texts.iter().filter(|(text, ..)| text == wanted);
            found.next().map(|(_, place, _)| *place)
        };
        let keys = place("Ctrl+Shift+G").expect("its keys");
        let title = place(name).expect("its name");
        assert!(title.right() < keys.left(), "{title:?} beside {keys:?}");
        let says = texts
            .iter()
            .filter(|(text, ..)| text.starts_with("Begins the"));
        let in_row = says.filter(|(_, place, _)| (place.center().y - keys.center().y).abs() < 6.0);
        for (text, place, _) in in_row {
            let fits = place.left() >= title.right() && place.right() < keys.left();
            assert!(
                fits || place.width() < 1.0,
                "{text:?}: {place:?} beside {keys:?}"
            );
        }
    }
}

#[test]
fn every_row_has_an_id_a_name_and_keys_of_its_own() {
    let mut desk = Desk::open("triangle");
    let table = desk.world().resource::<CommandTable>();
    let (mut ids, mut names) = (HashSet::new(), HashSet::new());
    for row in table.rows() {
        assert!(ids.insert(row.id.clone()), "{}", row.id);
        assert!(names.insert(row.name.clone()), "{}", row.name);
        assert!(row.id.contains('.') && !row.help.is_empty(), "{}", row.id);
    }
    let conflicts = table.conflicts(&Default::default());
    let conflicts: Vec<String> = conflicts.iter().map(|(keys, _)| keys.text()).collect();
    assert_eq!(conflicts, [""; 0]);
}

#[test]
fn what_a_panel_asks_for_is_done_in_the_same_frame() {
    let mut desk = Desk::open("cornell-box");
    let all = desk.ids().len();
    desk.world().write_message(Action::run("select.all"));
    desk.draw(Vec::new());
    assert_eq!(desk.world().resource::<Selection>().ids().len(), all);
}

#[test]
fn a_right_click_on_a_row_selects_it_and_offers_what_fits_it() {
    let mut desk = Desk::open("cornell-box");
    let (_, lamp) = desk.named("Lamp");
    let at = desk.place_of("Lamp");
    desk.point(at);
    for pressed in [true, false] {
        desk.frame(vec![Event::PointerButton {
            pos: at,
            button: PointerButton::Secondary,
            pressed,
            modifiers: Default::default(),
        }]);
    }
    desk.settle();
    assert_eq!(desk.world().resource::<Selection>().ids(), [lamp]);
    desk.place_of("Duplicate");
    assert_eq!(desk.find("Select all"), None, "that fits no entity");
    desk.click_on("Rename");
    desk.settle();
    desk.frame(vec![Event::Text("Moon".into())]);
    desk.key(Key::Enter);
    desk.settle();
    assert_eq!(edits::name_of(desk.world(), lamp), "Moon");
}

#[test]
fn keys_that_were_chosen_are_shown_and_kept() {
    let mut desk = Desk::open("triangle");
    let world = desk.world();
    let row = crate::editor::command::find(world, "edit.duplicate").unwrap();
    world.resource_scope(|world, table: bevy::prelude::Mut<CommandTable>| {
        let keys = vec!["Ctrl+J".parse().unwrap()];
        let mut preferences = world.resource_mut::<Preferences>();
        preferences.keys.bind(&table, &row, keys);
    });
    let folder = tempfile::tempdir().unwrap();
    let preferences = desk.world().resource::<Preferences>().clone();
    preferences.save(folder.path()).unwrap();
    assert_eq!(Preferences::load(folder.path()), (preferences, None));
    desk.click_on("Edit");
    desk.place_of("Ctrl+J");
    assert_eq!(desk.find("Ctrl+D"), None);
    desk.key(Key::Escape);
    desk.world().write_message(Action::run("help.keys"));
    desk.settle();
    assert_eq!(desk.world().resource::<Dialogs>().open, Some(Dialog::Keys));
    desk.click_on("Reset all");
    desk.settle();
    let keys = &desk.world().resource::<Preferences>().keys;
    assert!(!keys.is_chosen(&row));
}

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
            "Click a pixel: why this colour? (Esc: none)",
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
        desk.click_on("Ray tree");
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
fn the_card_of_the_first_start_does_each_thing_with_a_click_and_comes_back_only_when_asked() {
    let mut desk = Desk::open("cornell-box");
    let card = "Three things to try";
    assert_eq!(desk.find(card), None);
    desk.world().write_message(Action::run("help.first-steps"));
    desk.settle();
    desk.place_of(card);
    desk.click_on("➡  Drag the lamp");
    let (_, lamp) = desk.named("Lamp");
    assert_eq!(desk.world().resource::<Selection>().ids(), [lamp]);
    desk.click_on("➡  Look at the tree");
    let wanted = InspectPreset::IsTheTreeGood.settings().boxes;
    assert_eq!(desk.world().resource::<InspectSettings>().boxes, wanted);
    desk.place_of("✔  Look at the tree");
    desk.click_on("Close");
    desk.settle();
    assert_eq!(desk.find(card), None);
    assert!(desk.world().resource::<Preferences>().hint_seen);
}
