//! Copies share what the originals share, and have names and numbers of their own.

use super::scene_copy::SceneCopy;
use super::{act, editor, named};
use bevy::app::App;
use bevy::prelude::World;
use glassbox::editor::action::Addition;
use glassbox::editor::edits::{self, Clipboard, scene_entity};
use glassbox::editor::{Action, Selection};
use glassbox::scene::{SceneId, UsesMaterial};

/// The box, with a material that the short block uses.
fn with_shared_material() -> (App, SceneId, SceneId) {
    let mut app = editor("cornell-box");
    act(&mut app, Action::Add(Addition::Material));
    let (material, block) = (named(&mut app, "Material"), named(&mut app, "Short block"));
    let entity = |world: &World, id| scene_entity(world, id).unwrap();
    let (user, used) = (entity(app.world(), block), entity(app.world(), material));
    app.world_mut().entity_mut(user).insert(UsesMaterial(used));
    app.update();
    act(&mut app, Action::Select(vec![block]));
    (app, material, block)
}

fn selected(app: &App) -> Vec<SceneId> {
    app.world().resource::<Selection>().ids().to_vec()
}

#[test]
fn a_duplicate_shares_the_material_and_has_the_next_name() {
    let (mut app, material, block) = with_shared_material();
    let before = SceneCopy::of(&mut app);
    act(&mut app, Action::run("edit.duplicate"));
    act(&mut app, Action::run("edit.duplicate"));
    let after = SceneCopy::of(&mut app);
    assert_eq!(after.entities.len(), before.entities.len() + 2);
    for name in ["Short block 2", "Short block 3"] {
        let copy = named(&mut app, name);
        assert!(copy > block);
        assert_eq!(after.entities[&copy.0].material, Some(material.0), "{name}");
        let mut same = after.entities[&copy.0].clone();
        same.name = before.entities[&block.0].name.clone();
        assert_eq!(same, before.entities[&block.0], "{name}");
    }
}

#[test]
fn what_is_pasted_into_its_own_scene_goes_on_sharing_the_material() {
    let (mut app, material, _) = with_shared_material();
    act(&mut app, Action::run("edit.copy"));
    act(&mut app, Action::run("edit.paste"));
    let [copy] = selected(&app)[..] else {
        panic!("{:?}", selected(&app));
    };
    let scene = SceneCopy::of(&mut app);
    assert_eq!(scene.entities[&copy.0].material, Some(material.0));
    let materials = scene.entities.values().filter(|e| {
        e.name
            .as_ref()
            .is_some_and(|name| name.starts_with("Material"))
    });
    assert_eq!(materials.count(), 1);
}

#[test]
fn what_is_pasted_into_another_scene_brings_its_material_along() {
    let (mut app, _, _) = with_shared_material();
    act(&mut app, Action::run("edit.copy"));
    let clipboard = app.world().resource::<Clipboard>().clone();
    let mut other = editor("triangle");
    let before = SceneCopy::of(&mut other).entities.len();
    let pasted = edits::paste(other.world_mut(), &clipboard).unwrap();
    other.update();
    let scene = SceneCopy::of(&mut other);
    assert_eq!(scene.entities.len(), before + 2);
    let [copy] = pasted[..] else {
        panic!("{pasted:?}")
    };
    let material = scene.entities[&copy.0].material.unwrap();
    assert!(scene.entities[&material].phong.is_some());
}

#[test]
fn a_child_is_copied_to_where_it_stands_in_the_world() {
    let mut app = editor("cornell-box");
    let (tall, short) = (
        named(&mut app, "Mirror block"),
        named(&mut app, "Short block"),
    );
    act(&mut app, Action::Reparent(vec![tall], Some(short)));
    let place = |app: &App, id| {
        let entity = scene_entity(app.world(), id).unwrap();
        app.world()
            .get::<bevy::prelude::GlobalTransform>(entity)
            .unwrap()
            .affine()
    };
    act(&mut app, Action::Select(vec![tall]));
    act(&mut app, Action::run("edit.copy"));
    act(&mut app, Action::run("edit.paste"));
    app.update();
    let copy = selected(&app)[0];
    assert!(place(&app, copy).abs_diff_eq(place(&app, tall), 1e-5));
    // A parent is copied with its children, each once, whichever of them are selected.
    act(&mut app, Action::Select(vec![tall, short]));
    let before = SceneCopy::of(&mut app).entities.len();
    act(&mut app, Action::run("edit.duplicate"));
    assert_eq!(SceneCopy::of(&mut app).entities.len(), before + 2);
}

#[test]
fn broken_text_on_the_clipboard_leaves_the_scene_as_it_was() {
    let mut app = editor("cornell-box");
    let before = SceneCopy::of(&mut app);
    for text in ["(", "", "hello", "(resources: {}, entities: {})"] {
        let clipboard = Clipboard::of_text(app.world(), text);
        let pasted = edits::paste(app.world_mut(), &clipboard);
        assert!(pasted.is_err() || text.is_empty(), "{text}");
        app.update();
        SceneCopy::of(&mut app).assert_same(&before, text);
    }
}
