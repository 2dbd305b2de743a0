//! The table of commands as a person meets it: in menus, on keys, in the palette, by a right click.

use super::super::dialogs::{Dialog, Dialogs};
use super::super::palette::OpenPalette;
use super::{Desk, SMALL, USUAL, texts};
use crate::editor::command::{AddCommands, Command, CommandTable, Over, State};
use crate::editor::document::{Document, FileTask, Question};
use crate::editor::keys::{Keys, Recording};
use crate::editor::notice::Notices;
use crate::editor::pointer::RightClicked;
use crate::editor::preferences::Preferences;
use crate::editor::selection::Selection;
use crate::editor::viewport::Viewport;
use crate::editor::{Action, edits};
use crate::inspect::{InspectPreset, InspectSettings};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::math::Vec2;
use bevy_egui::egui::{Event, Key, PointerButton, pos2};
use std::collections::HashSet;

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
    .keys(&["Ctrl+Shift+J"])
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
    assert!(desk.find("Ctrl+Shift+J").is_some(), "menus show keys");
    desk.click_on("Start the game");
    assert_eq!(runs(&mut desk), 1, "by the menu");

    palette(&mut desk, "sttgm");
    desk.place_of("Start the game");
    desk.key(Key::Enter);
    assert_eq!(runs(&mut desk), 2, "by the palette");
    assert!(desk.world().resource::<OpenPalette>().0.is_none());

    let keys: Keys = "Ctrl+Shift+J".parse().unwrap();
    let table = desk.world().resource::<CommandTable>();
    let bindings = Default::default();
    let row = table.of_keys(keys, &bindings).expect("it has keys");
    assert_eq!(row.id, "game.start");
    desk.world().write_message(Action::run("help.keys"));
    desk.settle();
    desk.world().resource_mut::<Dialogs>().bindings_search = "start the".into();
    desk.settle();
    desk.place_of("Ctrl+Shift+J");
    desk.world().resource_mut::<Dialogs>().bindings_search = "make tea".into();
    desk.settle();
    desk.place_of("No command is called that, nor has such keys.");
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
        let keys = place("Ctrl+Shift+J").expect("its keys");
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

/// An editor in which a command waits for the keys that shall send it.
fn recording() -> Desk {
    let mut desk = Desk::open("triangle");
    desk.app.init_resource::<Recording>();
    desk.world().write_message(Action::run("help.keys"));
    desk.settle();
    desk.world().resource_mut::<Dialogs>().bindings_search = "duplicate".into();
    desk.settle();
    desk.click_on("Ctrl+D");
    assert!(records(&mut desk));
    desk
}

fn records(desk: &mut Desk) -> bool {
    desk.world().resource::<Recording>().0.as_deref() == Some("edit.duplicate")
}

#[test]
fn who_closes_the_list_of_keys_or_turns_to_something_else_gives_a_command_no_keys() {
    let ways: [fn(&mut Desk); 4] = [
        |desk| desk.click(pos2(4.0, 700.0)),
        |desk| {
            desk.world().write_message(Action::run("help.keys"));
        },
        |desk| {
            let then = FileTask::New;
            desk.world().resource_mut::<Document>().question = Some(Question::Unsaved { then });
        },
        |desk| desk.click_on("duplicate"),
    ];
    for (i, way) in ways.into_iter().enumerate() {
        let mut desk = recording();
        way(&mut desk);
        desk.settle();
        assert!(!records(&mut desk), "way {i}");
    }
}

#[test]
fn keys_that_a_command_waited_for_close_no_dialog() {
    for key in [Key::Escape, Key::F1] {
        let mut desk = recording();
        // The command gets them before the frame is drawn.
        desk.world().resource_mut::<Recording>().0 = None;
        desk.key(key);
        desk.settle();
        let open = desk.world().resource::<Dialogs>().open;
        assert_eq!(open, Some(Dialog::Keys), "{key:?}");
        desk.key(key);
        desk.settle();
        assert_eq!(desk.world().resource::<Dialogs>().open, None, "{key:?}");
    }
}

#[test]
fn the_card_of_the_first_start_does_each_thing_with_a_click_and_comes_back_only_when_asked() {
    let mut desk = Desk::open("cornell-box");
    let card = "First steps";
    assert_eq!(desk.find(card), None);
    desk.world().write_message(Action::run("help.first-steps"));
    desk.settle();
    let view = desk.world().resource::<Viewport>().rect;
    let place = desk.place_of(card);
    assert!(
        place.y > view.center().y,
        "it hides lamps: {place} in {view:?}"
    );
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
