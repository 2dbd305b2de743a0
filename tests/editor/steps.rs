//! What becomes a step, what it is called, and that steps do not pile up.

use super::{act, editor, history, named};
use bevy::app::App;
use bevy::prelude::{Entity, Transform};
use glassbox::editor::Action;
use glassbox::editor::action::Addition;
use glassbox::editor::edits::scene_entity;
use glassbox::editor::history::{Gesture, History, go_to};
use glassbox::scene::{Phong, RenderSettings, SceneId, UsesMaterial};

const BOX: &str = "cornell-box";

fn move_by(app: &mut App, id: SceneId, x: f32) {
    let entity = scene_entity(app.world(), id).unwrap();
    let mut place = app.world_mut().get_mut::<Transform>(entity).unwrap();
    place.translation.x += x;
    app.update();
}

fn names(app: &App) -> Vec<String> {
    history(app).steps().map(str::to_owned).collect()
}

#[test]
fn steps_are_named_after_what_was_done() {
    let mut app = editor(BOX);
    let block = named(&mut app, "Short block");
    move_by(&mut app, block, 0.1);
    act(&mut app, Action::Select(vec![block]));
    act(&mut app, Action::run("edit.hide"));
    act(&mut app, Action::Rename(block, "Crate".into()));
    app.world_mut().resource_mut::<RenderSettings>().max_depth = 2;
    app.update();
    act(&mut app, Action::Add(Addition::PointLamp));
    app.world_mut().resource_mut::<History>().name_next("Dim");
    let entity = scene_entity(app.world(), block).unwrap();
    app.world_mut().get_mut::<Phong>(entity).unwrap().opacity = 0.5;
    app.update();
    assert_eq!(
        names(&app),
        [
            "Move Short block",
            "Hide Short block",
            "Rename Short block to Crate",
            "Change max depth",
            "Add Point light",
            "Dim"
        ]
    );
    assert_eq!(history(&app).undo_text(), Some("Dim"));
    act(&mut app, Action::run("edit.undo"));
    assert_eq!(history(&app).redo_text(), Some("Dim"));
}

#[test]
fn a_value_that_is_written_without_being_changed_is_no_step() {
    let mut app = editor(BOX);
    let block = named(&mut app, "Short block");
    move_by(&mut app, block, 0.0);
    app.world_mut().resource_mut::<RenderSettings>().spp += 0;
    for _ in 0..3 {
        app.update();
    }
    assert_eq!(names(&app), [""; 0]);
}

#[test]
fn a_gesture_is_one_step_and_a_name_that_nothing_followed_is_forgotten() {
    let mut app = editor(BOX);
    let block = named(&mut app, "Short block");
    app.world_mut().resource_mut::<Gesture>().begin("");
    for _ in 0..10 {
        move_by(&mut app, block, 0.1);
    }
    assert_eq!(names(&app), [""; 0]);
    app.world_mut().resource_mut::<Gesture>().end();
    app.update();
    app.world_mut()
        .resource_mut::<History>()
        .name_next("Nothing");
    app.update();
    move_by(&mut app, block, 0.1);
    assert_eq!(names(&app), ["Move Short block", "Move Short block"]);
}

#[test]
fn a_new_step_takes_the_place_of_those_that_were_undone() {
    let mut app = editor(BOX);
    let block = named(&mut app, "Short block");
    for _ in 0..4 {
        move_by(&mut app, block, 0.1);
    }
    let state = history(&app).state();
    go_to(app.world_mut(), 1);
    assert_eq!(history(&app).position(), 1);
    assert_ne!(history(&app).state(), state);
    go_to(app.world_mut(), 4);
    assert_eq!(
        history(&app).state(),
        state,
        "the same state has the same number"
    );
    go_to(app.world_mut(), 2);
    move_by(&mut app, block, 5.0);
    assert_eq!((names(&app).len(), history(&app).position()), (3, 3));
    assert_ne!(history(&app).state(), state);
}

#[test]
fn a_material_that_was_deleted_and_came_back_is_used_again() {
    let mut app = editor(BOX);
    act(&mut app, Action::Add(Addition::Material));
    let material = named(&mut app, "Material");
    let block = named(&mut app, "Short block");
    let uses = |app: &App| {
        let entity = scene_entity(app.world(), block).unwrap();
        app.world().get::<UsesMaterial>(entity).map(|uses| uses.0)
    };
    let entity = |app: &App, id| -> Entity { scene_entity(app.world(), id).unwrap() };
    let (user, used) = (entity(&app, block), entity(&app, material));
    app.world_mut().entity_mut(user).insert(UsesMaterial(used));
    app.update();
    // Behind the back of the edits: they would give the block a material of its own.
    app.world_mut().despawn(used);
    app.update();
    act(&mut app, Action::run("edit.undo"));
    assert_eq!(uses(&app), Some(entity(&app, material)));
    // Through them.
    act(&mut app, Action::Select(vec![material]));
    act(&mut app, Action::run("edit.delete"));
    assert_eq!(uses(&app), None);
    act(&mut app, Action::run("edit.undo"));
    assert_eq!(uses(&app), Some(entity(&app, material)));
}

#[test]
fn steps_take_less_than_their_bound_and_the_oldest_are_forgotten() {
    let mut app = editor(BOX);
    act(&mut app, Action::run("select.all"));
    act(&mut app, Action::run("edit.copy"));
    // Each paste doubles nothing: it adds the same twelve or so entities again.
    for _ in 0..40 {
        act(&mut app, Action::run("edit.paste"));
    }
    let bytes = history(&app).bytes();
    assert!(bytes > 40_000 && bytes < 4 << 20, "{bytes} bytes");
    let per_move = {
        let block = named(&mut app, "Short block");
        let before = history(&app).bytes();
        for _ in 0..100 {
            move_by(&mut app, block, 0.1);
        }
        (history(&app).bytes() - before) / 100
    };
    assert!(per_move < 1_000, "a move takes {per_move} bytes");
}
