//! The scene as a file: what is asked, what is kept, and what bad files leave alone.

use super::scene_copy::{SceneCopy, traced};
use super::{act, editor, named};
use bevy::app::{App, AppExit};
use bevy::asset::Assets;
use bevy::ecs::message::Messages;
use bevy::image::Image;
use bevy::math::Vec3;
use bevy::prelude::Transform;
use bevy::window::FileDragAndDrop;
use glassbox::editor::action::Addition;
use glassbox::editor::document::{Answer, Document, FileTask, Purpose, Question, answer};
use glassbox::editor::edits::scene_entity;
use glassbox::editor::notice::Notices;
use glassbox::editor::{Action, Selection};
use glassbox::io::write_picture;
use glassbox::scene::{EnvironmentMap, MeshSource, Phong, Shape, TextureSource};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

const BOX: &str = "cornell-box";

fn document(app: &App) -> &Document {
    app.world().resource::<Document>()
}

fn notices(app: &mut App) -> Vec<String> {
    let mut notices = app.world_mut().resource_mut::<Notices>();
    notices
        .shown()
        .iter()
        .map(|notice| notice.text.clone())
        .collect()
}

fn drop_file(app: &mut App, file: &Path) {
    let window = bevy::prelude::Entity::PLACEHOLDER;
    app.world_mut().write_message(FileDragAndDrop::DroppedFile {
        window,
        path_buf: file.to_path_buf(),
    });
    // Dropped, asked for, done, synced.
    for _ in 0..3 {
        app.update();
    }
}

fn wants_to_quit(app: &App) -> bool {
    !app.world().resource::<Messages<AppExit>>().is_empty()
}

fn edit(app: &mut App) {
    act(app, Action::Add(Addition::Shape("Sphere".into())));
    app.update();
}

#[test]
fn what_is_saved_and_opened_again_is_the_same_scene_and_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    let mut app = editor(BOX);
    edit(&mut app);
    assert!(document(&app).unsaved());
    assert_eq!(document(&app).title(), "cornell-box* – Glassbox");
    act(&mut app, Action::SaveAs(file.clone()));
    assert!(!document(&app).unsaved());
    assert_eq!(document(&app).path.as_deref(), Some(&*file));
    assert_eq!(document(&app).title(), "a.scn.ron – Glassbox");
    let (scene, picture) = (SceneCopy::of(&mut app), traced(&app));
    act(&mut app, Action::run("edit.undo"));
    assert!(
        document(&app).unsaved(),
        "what was undone is not what was saved"
    );
    act(&mut app, Action::run("edit.redo"));
    assert!(!document(&app).unsaved(), "what was done again is");
    let mut other = editor("triangle");
    act(&mut other, Action::Open(file));
    other.update();
    SceneCopy::of(&mut other).assert_same(&scene, "opened again");
    assert_eq!(traced(&other), picture);
}

#[test]
fn unsaved_changes_are_asked_for_before_they_are_lost() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    for (action, then) in [
        (Action::run("file.new"), FileTask::New),
        (Action::run("file.quit"), FileTask::Quit),
        (
            Action::Open("triangle".into()),
            FileTask::Open("triangle".into()),
        ),
    ] {
        let mut app = editor(BOX);
        edit(&mut app);
        let scene = SceneCopy::of(&mut app);
        act(&mut app, action.clone());
        assert_eq!(document(&app).question, Some(Question::Unsaved { then }));
        SceneCopy::of(&mut app).assert_same(&scene, "asked");
        assert!(!wants_to_quit(&app));
        answer(app.world_mut(), Answer::Cancel);
        app.update();
        assert_eq!(document(&app).question, None);
        SceneCopy::of(&mut app).assert_same(&scene, "cancelled");
        // Save: there is no path yet, and no native dialog in a test.
        act(&mut app, action.clone());
        answer(app.world_mut(), Answer::Yes);
        let asks = matches!(
            document(&app).question,
            Some(Question::Path {
                purpose: Purpose::SaveAs,
                ..
            })
        );
        assert!(asks, "{:?}", document(&app).question);
        answer(app.world_mut(), Answer::Path(file.with_file_name("a")));
        if file.exists() && document(&app).question.is_some() {
            answer(app.world_mut(), Answer::Yes);
        }
        app.update();
        assert!(file.exists());
        assert_eq!(
            wants_to_quit(&app),
            action == Action::run("file.quit"),
            "{action:?}"
        );
        if action != Action::run("file.quit") {
            assert_ne!(SceneCopy::of(&mut app), scene, "{action:?} was not done");
        }
    }
    let mut app = editor(BOX);
    edit(&mut app);
    act(&mut app, Action::run("file.quit"));
    answer(app.world_mut(), Answer::No);
    assert!(wants_to_quit(&app));
    // Nothing to lose, nothing to ask.
    let mut app = editor(BOX);
    act(&mut app, Action::run("file.quit"));
    assert!(wants_to_quit(&app));
}

#[test]
fn broken_files_say_what_is_wrong_and_leave_the_scene_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let files: [(&str, &[u8]); 6] = [
        ("a.scn.ron", b"(resources: {"),
        ("b.obj", b"f 1 2 3\n"),
        ("c.glb", b"glTF\x02\0\0\0"),
        ("d.scn.ron", b""),
        ("e.gltf", b"{}"),
        ("f.doc", b"?"),
    ];
    let mut app = editor(BOX);
    let scene = SceneCopy::of(&mut app);
    let picture = traced(&app);
    for (name, content) in files {
        let file = folder.path().join(name);
        fs::write(&file, content).unwrap();
        drop_file(&mut app, &file);
        let notices = notices(&mut app);
        assert!(
            notices.iter().any(|notice| notice.contains(name)),
            "{name}: {notices:?}"
        );
        SceneCopy::of(&mut app).assert_same(&scene, name);
        assert_eq!(traced(&app), picture, "{name}");
        assert!(!document(&app).unsaved(), "{name}");
    }
    drop_file(&mut app, &folder.path().join("missing.glb"));
    SceneCopy::of(&mut app).assert_same(&scene, "a file that is not there");
}

#[test]
fn what_was_saved_opens_again_although_something_in_it_cannot_be_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    let mut app = editor(BOX);
    edit(&mut app);
    act(&mut app, Action::SaveAs(file.clone()));
    act(&mut app, Action::Open(file.clone()));
    let (floor, sphere) = (named(&mut app, "Floor"), named(&mut app, "Sphere"));
    let floor = scene_entity(app.world(), floor).unwrap();
    let sphere = scene_entity(app.world(), sphere).unwrap();
    let world = app.world_mut();
    world.get_mut::<Phong>(floor).unwrap().diffuse_map = Some(TextureSource::new("gone.png"));
    *world.get_mut::<MeshSource>(sphere).unwrap() = MeshSource::Shape(Shape::Quadrilateral {
        corners: [Vec3::ZERO; 4],
    });
    app.update();
    act(&mut app, Action::run("file.save"));
    let mut other = editor("triangle");
    act(&mut other, Action::Open(file.clone()));
    other.update();
    let told = notices(&mut other);
    assert_eq!(document(&other).path.as_deref(), Some(&*file), "{told:?}");
    for what in ["gone.png", "shape"] {
        assert!(told.iter().any(|notice| notice.contains(what)), "{told:?}");
    }
    let floor = named(&mut other, "Floor");
    let floor = scene_entity(other.world(), floor).unwrap();
    let map = &other.world().get::<Phong>(floor).unwrap().diffuse_map;
    assert!(map.as_ref().is_some_and(|map| map.path == "gone.png"));
    assert!(!document(&other).unsaved());
}

#[test]
fn a_model_that_the_scene_reads_is_not_exported_over() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.obj");
    fs::write(&file, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let text = fs::read(&file).unwrap();
    let mut app = editor("triangle");
    act(&mut app, Action::Open(file.clone()));
    act(&mut app, Action::SaveAs(file.clone()));
    let told = notices(&mut app);
    let says = |notice: &String| notice.contains("a.obj") && notice.contains("another name");
    assert!(told.iter().any(says), "{told:?}");
    assert_eq!(fs::read(&file).unwrap(), text);
    act(&mut app, Action::SaveAs(folder.path().join("b.obj")));
    assert!(folder.path().join("b.obj").exists());
}

#[test]
fn a_picture_beside_the_saved_scene_can_be_chosen_although_the_scene_was_opened_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("t.png");
    write_picture(&picture, 1, 1, &[[1.0, 0.0, 0.0]]).unwrap();
    let mut app = editor(BOX);
    act(&mut app, Action::SaveAs(folder.path().join("a.scn.ron")));
    drop_file(&mut app, &picture);
    let map = app.world().resource::<EnvironmentMap>();
    let image = map.0.as_ref().map(|handle| handle.id());
    let images = app.world().resource::<Assets<Image>>();
    let size = image.and_then(|image| images.get(image)).map(Image::width);
    assert_eq!(size, Some(1), "{:?}", notices(&mut app));
}

#[test]
fn a_dropped_model_is_added_and_taken_back_in_one_step() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.obj");
    let model = "mtllib m.mtl\no First\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\no Second\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 4 5 6\n";
    fs::write(&file, model).unwrap();
    fs::write(folder.path().join("m.mtl"), "newmtl red\nKd 1 0 0\n").unwrap();
    let mut app = editor(BOX);
    let scene = SceneCopy::of(&mut app);
    drop_file(&mut app, &file);
    let added = SceneCopy::of(&mut app);
    assert!(added.entities.len() > scene.entities.len() + 2);
    let group = named(&mut app, "model");
    assert_eq!(app.world().resource::<Selection>().ids(), [group]);
    let meshes = added
        .entities
        .values()
        .filter(|entity| matches!(entity.mesh, Some(MeshSource::File { .. })) && entity.has_mesh);
    assert_eq!(meshes.count(), 2);
    // Saved elsewhere it still finds its mesh.
    let elsewhere = tempfile::tempdir().unwrap();
    let saved = elsewhere.path().join("a.scn.ron");
    act(&mut app, Action::SaveAs(saved.clone()));
    let picture = traced(&app);
    let mut other = editor("triangle");
    act(&mut other, Action::Open(saved));
    let asks = matches!(document(&other).question, Some(Question::Outside { .. }));
    assert!(asks, "{:?}", document(&other).question);
    answer(other.world_mut(), Answer::Yes);
    other.update();
    assert_eq!(traced(&other), picture);
    act(&mut app, Action::run("edit.undo"));
    SceneCopy::of(&mut app).assert_same(&scene, "undone");
}

#[test]
fn a_file_that_cannot_be_written_is_said_and_the_old_one_stays() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    let mut app = editor(BOX);
    act(&mut app, Action::SaveAs(file.clone()));
    let old = fs::read(&file).unwrap();
    edit(&mut app);
    // A folder in its place, a folder that is not there: neither depends on who runs the test.
    let taken = folder.path().join("taken.scn.ron");
    fs::create_dir(&taken).unwrap();
    for target in [taken, folder.path().join("no/b.scn.ron")] {
        act(&mut app, Action::SaveAs(target));
    }
    let faults = notices(&mut app);
    assert_eq!(
        faults
            .iter()
            .filter(|text| text.contains(".scn.ron: "))
            .count(),
        2,
        "{faults:?}"
    );
    assert!(document(&app).unsaved());
    assert_eq!(document(&app).path.as_deref(), Some(&*file));
    assert_eq!(fs::read(&file).unwrap(), old);
}

#[test]
fn a_texture_that_changes_on_disk_is_loaded_again_and_one_that_goes_stays() {
    let folder = tempfile::tempdir().unwrap();
    let (file, texture) = (folder.path().join("a.scn.ron"), folder.path().join("t.png"));
    let paint = |color: [f32; 3]| write_picture(&texture, 2, 2, &[color; 4]).unwrap();
    paint([1.0, 0.0, 0.0]);
    let mut app = editor(BOX);
    act(&mut app, Action::SaveAs(file.clone()));
    act(&mut app, Action::Open(file));
    let floor = named(&mut app, "Floor");
    let entity = scene_entity(app.world(), floor).unwrap();
    app.world_mut()
        .get_mut::<Phong>(entity)
        .unwrap()
        .diffuse_map = Some(TextureSource::new("t.png"));
    wait(&mut app, Duration::from_millis(1500), |_| false);
    let red = traced(&app);
    paint([0.0, 0.0, 1.0]);
    let changed = wait(&mut app, Duration::from_secs(60), |app| traced(app) != red);
    assert!(changed, "the texture was not loaded again");
    let blue = traced(&app);
    fs::remove_file(&texture).unwrap();
    let told = wait(&mut app, Duration::from_secs(60), |app| {
        notices(app)
            .iter()
            .any(|notice| notice.contains("t.png") && notice.contains("stays"))
    });
    assert!(told, "{:?}", notices(&mut app));
    assert_eq!(traced(&app), blue);
}

/// Frames until something is so, or the time is up; whether it was so.
fn wait(app: &mut App, time: Duration, what: impl Fn(&mut App) -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < time {
        app.update();
        if what(app) {
            return true;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    false
}

#[test]
fn nothing_is_unsaved_after_looking_and_selecting() {
    let mut app = editor(BOX);
    act(&mut app, Action::run("select.all"));
    act(&mut app, Action::run("edit.copy"));
    act(&mut app, Action::run("select.none"));
    assert!(!document(&app).unsaved());
    let block = named(&mut app, "Short block");
    let entity = scene_entity(app.world(), block).unwrap();
    app.world_mut()
        .get_mut::<Transform>(entity)
        .unwrap()
        .translation
        .x += 0.1;
    app.update();
    app.update();
    assert!(document(&app).unsaved());
}
