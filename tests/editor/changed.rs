//! Another program, or another editor, writes the file that is open.

use super::scene_copy::SceneCopy;
use super::{act, editor, named};
use bevy::app::{App, AppExit};
use bevy::ecs::entity::Entity;
use bevy::ecs::message::Messages;
use bevy::window::WindowFocused;
use glassbox::editor::action::Addition;
use glassbox::editor::document::{
    Answer, Document, Purpose, Question, RecoveryFolder, adopt, answer,
};
use glassbox::editor::{Action, headless_editor_with_recovery};
use glassbox::io::{OpenOptions, SceneSource, open};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

fn question(app: &App) -> Option<Question> {
    app.world().resource::<Document>().question.clone()
}

fn changed(file: &Path) -> Option<Question> {
    let file = file.to_path_buf();
    Some(Question::Changed { file })
}

fn add(app: &mut App, shape: &str) {
    act(app, Action::Add(Addition::Shape(shape.into())));
    app.update();
}

/// A scene file that an editor has open with an unsaved change, and that another editor has changed since.
fn changed_twice(file: &Path) -> (App, Vec<u8>) {
    let mut first = editor("triangle");
    act(&mut first, Action::SaveAs(file.to_path_buf()));
    let mut second = editor("cornell-box");
    act(&mut second, Action::Open(file.to_path_buf()));
    second.update();
    add(&mut second, "Cuboid");
    act(&mut second, Action::run("file.save"));
    assert_eq!(question(&second), None, "nobody else has changed it");
    add(&mut first, "Sphere");
    act(&mut first, Action::run("file.save"));
    assert_eq!(question(&first), changed(file));
    (first, fs::read(file).unwrap())
}

#[test]
fn a_change_of_another_program_is_not_saved_over_unless_that_is_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    let (mut app, theirs) = changed_twice(&file);
    let ours = SceneCopy::of(&mut app);
    answer(app.world_mut(), Answer::Cancel);
    assert_eq!(question(&app), None);
    assert_eq!(fs::read(&file).unwrap(), theirs);
    SceneCopy::of(&mut app).assert_same(&ours, "cancelled");
    assert!(app.world().resource::<Document>().unsaved());
    // It is asked again, also where the same file is chosen to save as.
    act(&mut app, Action::SaveAs(file.clone()));
    assert_eq!(question(&app), changed(&file));
    answer(app.world_mut(), Answer::Yes);
    app.update();
    assert_ne!(fs::read(&file).unwrap(), theirs);
    assert!(!app.world().resource::<Document>().unsaved());
    // From then on it is ours.
    add(&mut app, "Sphere");
    act(&mut app, Action::run("file.save"));
    assert_eq!(question(&app), None);
}

#[test]
fn reloading_opens_what_the_other_program_wrote() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    let (mut app, theirs) = changed_twice(&file);
    answer(app.world_mut(), Answer::No);
    app.update();
    app.update();
    assert_eq!(question(&app), None);
    assert_eq!(fs::read(&file).unwrap(), theirs);
    named(&mut app, "Cuboid");
    assert!(!app.world().resource::<Document>().unsaved());
    add(&mut app, "Sphere");
    act(&mut app, Action::run("file.save"));
    assert_eq!(question(&app), None);
}

#[test]
fn saving_under_another_name_keeps_both_and_goes_on_with_what_waited() {
    let folder = tempfile::tempdir().unwrap();
    let (file, other) = (
        folder.path().join("a.scn.ron"),
        folder.path().join("b.scn.ron"),
    );
    let (mut app, theirs) = changed_twice(&file);
    answer(app.world_mut(), Answer::Cancel);
    act(&mut app, Action::run("file.quit"));
    answer(app.world_mut(), Answer::Yes);
    assert_eq!(question(&app), changed(&file));
    answer(app.world_mut(), Answer::Elsewhere);
    let asks = matches!(
        question(&app),
        Some(Question::Path {
            purpose: Purpose::SaveAs,
            ..
        })
    );
    assert!(asks, "{:?}", question(&app));
    answer(app.world_mut(), Answer::Path(other.clone()));
    app.update();
    assert_eq!(fs::read(&file).unwrap(), theirs);
    assert!(other.is_file());
    assert!(!app.world().resource::<Messages<AppExit>>().is_empty());
}

#[test]
fn a_file_that_is_gone_is_written_again_and_one_that_says_the_same_is_not_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    let mut app = editor("triangle");
    act(&mut app, Action::SaveAs(file.clone()));
    let text = fs::read(&file).unwrap();
    // Another time, the same words.
    fs::remove_file(&file).unwrap();
    fs::write(&file, &text).unwrap();
    add(&mut app, "Sphere");
    act(&mut app, Action::run("file.save"));
    assert_eq!(question(&app), None);
    fs::remove_file(&file).unwrap();
    add(&mut app, "Sphere");
    act(&mut app, Action::run("file.save"));
    assert_eq!(question(&app), None);
    assert!(file.is_file());
    // Emptied is changed as well.
    fs::write(&file, "").unwrap();
    act(&mut app, Action::run("file.save"));
    assert_eq!(question(&app), changed(&file));
}

#[test]
fn recovered_work_is_not_saved_over_what_was_changed_since() {
    let folder = tempfile::tempdir().unwrap();
    let (file, copies) = (
        folder.path().join("a.scn.ron"),
        folder.path().join("copies"),
    );
    let mut app = headless_editor_with_recovery(&copies);
    let source = SceneSource::named("triangle");
    open(app.world_mut(), &source, OpenOptions::default()).unwrap();
    adopt(app.world_mut(), "triangle", None);
    app.update();
    act(&mut app, Action::SaveAs(file.clone()));
    let mut recovery = app.world_mut().resource_mut::<RecoveryFolder>();
    recovery.copy_every(Duration::ZERO);
    add(&mut app, "Sphere");
    let is_labelled = || {
        let copies = fs::read_dir(&copies).into_iter().flatten().flatten();
        let mut names = copies.map(|copy| copy.file_name().into_string().unwrap());
        names.any(|name| name.ends_with(".label.ron"))
    };
    let start = Instant::now();
    while !is_labelled() {
        assert!(start.elapsed().as_secs() < 60, "no copy was written");
        app.update();
        std::thread::sleep(Duration::from_millis(5));
    }
    drop(app);
    fs::write(&file, "theirs").unwrap();
    let mut next = headless_editor_with_recovery(&copies);
    next.update();
    let asked = matches!(question(&next), Some(Question::Recover(_)));
    assert!(asked, "{:?}", question(&next));
    answer(next.world_mut(), Answer::Yes);
    next.update();
    act(&mut next, Action::run("file.save"));
    assert_eq!(question(&next), changed(&file));
    assert_eq!(fs::read(&file).unwrap(), b"theirs");
}

#[cfg(unix)]
#[test]
fn a_link_to_the_open_file_is_the_open_file() {
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (
        folder.path().join("a.scn.ron"),
        folder.path().join("b.scn.ron"),
    );
    std::os::unix::fs::symlink("a.scn.ron", &link).unwrap();
    let mut app = editor("triangle");
    act(&mut app, Action::SaveAs(file.clone()));
    fs::write(&file, "theirs").unwrap();
    act(&mut app, Action::SaveAs(link.clone()));
    assert_eq!(question(&app), changed(&link));
}

/// The window is turned to.
fn focus(app: &mut App) {
    let window = Entity::PLACEHOLDER;
    app.world_mut().write_message(WindowFocused {
        window,
        focused: true,
    });
    app.update();
}

#[test]
fn a_change_of_another_program_is_asked_about_when_the_window_is_turned_to_and_once_each() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    let mut app = editor("triangle");
    act(&mut app, Action::SaveAs(file.clone()));
    focus(&mut app);
    assert_eq!(question(&app), None, "nobody has changed it");
    add(&mut app, "Sphere");
    let ours = SceneCopy::of(&mut app);
    let text = fs::read_to_string(&file).unwrap();
    for spaces in ["\n", "\n\n"] {
        fs::write(&file, format!("{text}{spaces}")).unwrap();
        app.update();
        assert_eq!(question(&app), None, "nobody has turned to the window");
        focus(&mut app);
        assert_eq!(question(&app), changed(&file), "{spaces:?}");
        answer(app.world_mut(), Answer::Cancel);
        focus(&mut app);
        assert_eq!(question(&app), None, "it was asked already");
        SceneCopy::of(&mut app).assert_same(&ours, "the edits are still there");
    }
    act(&mut app, Action::run("file.save"));
    assert_eq!(question(&app), changed(&file), "it is not written over");
    answer(app.world_mut(), Answer::Yes);
    focus(&mut app);
    assert_eq!(question(&app), None, "it is ours again");
    assert!(!app.world().resource::<Document>().unsaved());
}
