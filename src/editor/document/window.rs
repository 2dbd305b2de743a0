//! What a window has to do with the document: its title, closing it, and files dropped on it.

use super::Document;
use crate::editor::action::Action;
use crate::editor::command;
use crate::editor::edits::scene_entity;
use crate::editor::embed::Editing;
use crate::editor::history::{History, within};
use crate::editor::notice::Notices;
use crate::editor::pick;
use crate::editor::schedule::{Dispatch, EditorUpdate};
use crate::editor::selection::Selection;
use crate::editor::texts::{file_name, path_of};
use crate::io::{MODEL_EXTENSIONS, PICTURE_EXTENSIONS, SceneFiles, extension};
use crate::scene::{Environment, Phong, TextureSource, UsesMaterial};
use bevy::app::{App, PreUpdate};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::message::{MessageCursor, Messages};
use bevy::ecs::query::With;
use bevy::ecs::system::{Local, Query, Res};
use bevy::ecs::world::World;
use bevy::prelude::IntoScheduleConfigs;
use bevy::window::{FileDragAndDrop, PrimaryWindow, Window, WindowCloseRequested};
use std::path::Path;

pub(super) fn add_to(app: &mut App, keeps_title: bool) {
    app.add_message::<FileDragAndDrop>()
        .add_message::<WindowCloseRequested>()
        .add_systems(PreUpdate, take_closing)
        .add_systems(
            EditorUpdate,
            (
                take_dropped.before(Dispatch),
                show_title.run_if(move || !keeps_title),
            ),
        );
}

fn show_title(document: Res<Document>, mut windows: Query<&mut Window, With<PrimaryWindow>>) {
    let title = document.title();
    for mut window in &mut windows {
        if window.title != title {
            window.title.clone_from(&title);
        }
    }
}

/// The window's own button asks as the menu's item does, and where an app has switched the editor off too: a question
/// switches it on. `WindowPlugin::close_when_requested` has to be off.
fn take_closing(world: &mut World, mut cursor: Local<MessageCursor<WindowCloseRequested>>) {
    let messages = world.resource::<Messages<WindowCloseRequested>>();
    let mut requests = cursor.read(messages).map(|request| request.window);
    // An app closes windows of its own as it likes.
    if !requests.any(|window| world.get::<PrimaryWindow>(window).is_some()) {
        return;
    }
    within(world, |world| command::run(world, "file.quit"));
    let asks = world.resource::<Document>().question.is_some();
    if asks && let Some(mut editing) = world.get_resource_mut::<Editing>() {
        editing.set_if_neq(Editing(true));
    }
}

fn take_dropped(world: &mut World, mut cursor: Local<MessageCursor<FileDragAndDrop>>) {
    let dropped: Vec<std::path::PathBuf> = cursor
        .read(world.resource::<Messages<FileDragAndDrop>>())
        .filter_map(|message| match message {
            FileDragAndDrop::DroppedFile { path_buf, .. } => Some(path_buf.clone()),
            _ => None,
        })
        .collect();
    for file in dropped {
        drop_file(world, &file);
    }
}

/// A scene is opened, a model added, a picture put on what is selected; a picture with more than a
/// screen's range, or with nothing selected, becomes the environment.
fn drop_file(world: &mut World, file: &Path) {
    match extension(file).as_str() {
        "ron" | "scn.ron" => {
            world.write_message(Action::Open(file.to_path_buf()));
        }
        model if MODEL_EXTENSIONS.contains(&model) => {
            let at = pick::cursor(world);
            world.write_message(Action::Import(file.to_path_buf(), at));
        }
        picture if PICTURE_EXTENSIONS.contains(&picture) => {
            let on_objects = !matches!(picture, "hdr" | "pic" | "exr");
            drop_picture(world, file, on_objects);
        }
        _ => {
            let text = format!(
                "{}: neither a scene (.scn.ron), a model (.{}) nor a picture (.{})",
                file.display(),
                MODEL_EXTENSIONS.join(", ."),
                PICTURE_EXTENSIONS.join(", .")
            );
            world.resource_mut::<Notices>().fault(text);
        }
    }
}

/// A picture that a person chose, as the scene names it, wherever it lies.
pub(in crate::editor) fn picture_at(world: &mut World, file: &Path) -> Option<TextureSource> {
    let name = name_in_scene(world, file)?;
    Some(allowed_picture(world, name))
}

/// A picture that a person named, from the scene's folder or from home: who does so means that file, and allows it.
pub(in crate::editor) fn typed_picture(world: &mut World, path: String) -> TextureSource {
    let from_home = path.starts_with("~/").then(|| path_of(&path));
    match from_home.and_then(|file| name_in_scene(world, &file)) {
        Some(name) => allowed_picture(world, name),
        None => allowed_picture(world, path),
    }
}

/// What the scene calls a file, wherever that lies.
fn name_in_scene(world: &World, file: &Path) -> Option<String> {
    Some(world.get_resource::<SceneFiles>()?.folder.name_of(file))
}

fn allowed_picture(world: &mut World, path: String) -> TextureSource {
    if let Some(mut files) = world.get_resource_mut::<SceneFiles>()
        && files.folder.resolve(&path).is_err()
    {
        files.folder.allow_outside = true;
    }
    TextureSource::new(path)
}

fn drop_picture(world: &mut World, file: &Path, on_objects: bool) {
    let Some(source) = picture_at(world, file) else {
        return;
    };
    let name = file_name(file);
    let selected = world.resource::<Selection>().ids().to_vec();
    let mut materials: Vec<_> = selected
        .into_iter()
        .filter(|_| on_objects)
        .filter_map(|id| scene_entity(world, id))
        .map(|entity| {
            world
                .get::<UsesMaterial>(entity)
                .map_or(entity, |uses| uses.0)
        })
        .filter(|&entity| world.get::<Phong>(entity).is_some())
        .collect();
    materials.sort_unstable();
    materials.dedup();
    if materials.is_empty() {
        world
            .resource_mut::<History>()
            .name_next(format!("Environment {name}"));
        world.resource_mut::<Environment>().map = Some(source);
        return;
    }
    world
        .resource_mut::<History>()
        .name_next(format!("Texture {name}"));
    for material in materials {
        if let Some(mut phong) = world.get_mut::<Phong>(material) {
            phong.diffuse_map = Some(source.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::{FileTask, Question, adopt};
    use crate::editor::edits::rename;
    use crate::editor::headless_editor;
    use crate::editor::history::{OnlyWithin, undo};
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use crate::scene::SceneId;
    use bevy::app::AppExit;
    use bevy::ecs::entity::Entity;
    use bevy::math::Vec2;

    /// The editor over an app's scene, switched on or off, with the app's window and another one.
    fn embedded(is_on: bool) -> (App, [Entity; 2]) {
        let mut app = headless_editor();
        app.init_resource::<OnlyWithin>()
            .insert_resource(Editing(is_on));
        let world = app.world_mut();
        let windows = [
            world.spawn((Window::default(), PrimaryWindow)).id(),
            world.spawn(Window::default()).id(),
        ];
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(world, &source, OpenOptions::default()).unwrap();
        adopt(world, "cornell-box", None);
        for _ in 0..2 {
            app.update();
        }
        (app, windows)
    }

    fn close(app: &mut App, window: Entity) {
        app.world_mut()
            .write_message(WindowCloseRequested { window });
        app.update();
    }

    #[test]
    fn a_picture_typed_from_home_is_named_as_one_chosen_there() {
        let (mut app, _) = embedded(true);
        let world = app.world_mut();
        let typed = typed_picture(world, "~/a.png".into());
        let chosen = picture_at(world, &path_of("~/a.png"));
        assert_eq!(Some(typed), chosen);
        let beside = typed_picture(world, "b/~/a.png".into());
        assert_eq!(beside.path, "b/~/a.png");
    }

    fn drop_on(app: &mut App, window: Entity, file: &str) {
        app.world_mut().write_message(FileDragAndDrop::DroppedFile {
            window,
            path_buf: file.into(),
        });
        app.update();
    }

    #[test]
    fn what_is_dropped_on_an_apps_window_is_a_step_of_the_editor_and_nothing_while_that_is_off() {
        for is_on in [true, false] {
            let (mut app, [window, _]) = embedded(is_on);
            let map = |app: &App| app.world().resource::<Environment>().map.clone();
            let before = map(&app);
            drop_on(&mut app, window, "/no/sky.exr");
            drop_on(&mut app, window, "triangle.scn.ron");
            assert_eq!(map(&app) != before, is_on);
            let history = app.world().resource::<History>();
            let steps: Vec<&str> = history.steps().collect();
            assert_eq!(steps, ["Environment sky.exr"][..usize::from(is_on)]);
            // The scene is asked for only where there is an editor to ask.
            let asked = app.world().resource::<Document>().question.is_some();
            assert_eq!(asked, is_on);
            if is_on {
                assert!(within(app.world_mut(), undo).is_some());
                assert_eq!(map(&app), before);
            }
        }
    }

    #[test]
    fn each_of_two_models_that_are_dropped_at_once_goes_where_it_was_dropped() {
        let (mut app, [window, _]) = embedded(true);
        let at = Vec2::new(40.0, 30.0);
        let world = app.world_mut();
        let mut shown = world.get_mut::<Window>(window).unwrap();
        shown.resolution.set(800.0, 600.0);
        shown.set_cursor_position(Some(at));
        let at = pick::cursor(world);
        assert!(at.is_some());
        for name in ["a.obj", "b.obj"] {
            drop_file(world, Path::new(name));
        }
        let mut messages = world.resource_mut::<Messages<Action>>();
        let sent: Vec<Action> = messages.drain().collect();
        let expected = ["a.obj", "b.obj"].map(|name| Action::Import(name.into(), at));
        assert_eq!(sent, expected);
    }

    fn quits(app: &App) -> bool {
        !app.world().resource::<Messages<AppExit>>().is_empty()
    }

    #[test]
    fn the_windows_button_ends_the_app_or_asks_whether_the_editor_is_on_or_off() {
        for is_on in [true, false] {
            let (mut app, [window, other]) = embedded(is_on);
            close(&mut app, other);
            assert!(!quits(&app), "another window is the app's own");
            close(&mut app, window);
            assert!(quits(&app));

            let (mut app, [window, _]) = embedded(is_on);
            within(app.world_mut(), |world| {
                let id = *world.query::<&SceneId>().iter(world).next().unwrap();
                rename(world, id, "Another");
            });
            close(&mut app, window);
            assert!(!quits(&app));
            let then = FileTask::Quit;
            let asked = &app.world().resource::<Document>().question;
            assert_eq!(*asked, Some(Question::Unsaved { then }));
            assert_eq!(*app.world().resource::<Editing>(), Editing(true));
        }
    }
}
