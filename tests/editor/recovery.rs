//! Unsaved work outlives an editor that does not end as it should.

use super::scene_copy::SceneCopy;
use super::{act, named};
use bevy::app::{App, AppExit};
use glassbox::editor::action::Addition;
use glassbox::editor::document::{Answer, Document, Question, RecoveryFolder, adopt, answer};
use glassbox::editor::notice::Notices;
use glassbox::editor::render_job::{RenderFrom, RenderRequest, start_render};
use glassbox::editor::{Action, headless_editor, headless_editor_with_recovery};
use glassbox::io::{OpenOptions, SceneSource, open};
use glassbox::scene::RenderSettings;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

fn editor(folder: &Path) -> App {
    let mut app = headless_editor_with_recovery(folder);
    let source = SceneSource::named("cornell-box");
    open(app.world_mut(), &source, OpenOptions::default()).unwrap();
    adopt(app.world_mut(), "cornell-box", None);
    app.world_mut()
        .resource_mut::<RecoveryFolder>()
        .copy_every(Duration::ZERO);
    app.update();
    app.update();
    app
}

fn copies(folder: &Path) -> usize {
    let files = fs::read_dir(folder).into_iter().flatten().flatten();
    files
        .filter(|file| file.file_name().to_string_lossy().ends_with(".scn.ron"))
        .filter(|file| !file.file_name().to_string_lossy().starts_with('.'))
        .count()
}

fn wait_for_copy(app: &mut App, folder: &Path) {
    let start = Instant::now();
    while copies(folder) == 0 {
        assert!(start.elapsed().as_secs() < 60, "no copy was written");
        app.update();
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn unsaved_work_is_offered_after_a_crash_and_not_where_somebody_gave_it_up() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = editor(folder.path());
    assert_eq!(copies(folder.path()), 0, "nothing was unsaved");
    act(&mut app, Action::Add(Addition::Shape("Sphere".into())));
    app.update();
    wait_for_copy(&mut app, folder.path());
    let scene = SceneCopy::of(&mut app);
    // While it runs, nobody else is offered its work: the file is locked.
    let mut other = editor(folder.path());
    assert_eq!(other.world().resource::<Document>().question, None);
    other.world_mut().write_message(AppExit::Success);
    other.update();
    drop(other);
    // It is gone without having ended.
    drop(app);
    let mut next = editor(folder.path());
    let question = next.world().resource::<Document>().question.clone();
    let Some(Question::Recover(found)) = question else {
        panic!("{question:?}");
    };
    assert_eq!(found.name, "cornell-box");
    answer(next.world_mut(), Answer::Yes);
    next.update();
    next.update();
    SceneCopy::of(&mut next).assert_same(&scene, "recovered");
    named(&mut next, "Sphere");
    assert!(next.world().resource::<Document>().unsaved());
    // Who says that it shall not be kept is believed.
    act(&mut next, Action::run("file.quit"));
    answer(next.world_mut(), Answer::No);
    next.update();
    drop(next);
    assert_eq!(copies(folder.path()), 0);
    let last = editor(folder.path());
    assert_eq!(last.world().resource::<Document>().question, None);
}

/// Of an app whose copies are in `folder`: what the next one offers.
fn offered(folder: &Path) -> Option<String> {
    let next = editor(folder);
    match next.world().resource::<Document>().question.clone() {
        Some(Question::Recover(found)) => Some(found.name),
        _ => None,
    }
}

/// Ends the app as a signal or a script does, without a question.
fn exit(mut app: App, how: AppExit) {
    app.world_mut().write_message(how);
    app.update();
}

#[test]
fn an_exit_alone_is_no_consent_and_the_last_edit_is_in_the_copy_that_stays() {
    // What Bevy makes of Ctrl+C in the terminal, of the last window closed, of an error of the window's system.
    for how in [AppExit::from_code(130), AppExit::Success, AppExit::error()] {
        let folder = tempfile::tempdir().unwrap();
        let mut app = editor(folder.path());
        act(&mut app, Action::Add(Addition::Shape("Sphere".into())));
        app.update();
        wait_for_copy(&mut app, folder.path());
        app.world_mut()
            .resource_mut::<RecoveryFolder>()
            .copy_every(Duration::from_secs(3600));
        app.update();
        // Younger than the last copy.
        act(&mut app, Action::Add(Addition::Shape("Cuboid".into())));
        exit(app, how);
        assert_eq!(offered(folder.path()).as_deref(), Some("cornell-box"));
        let mut next = editor(folder.path());
        answer(next.world_mut(), Answer::Yes);
        next.update();
        named(&mut next, "Sphere");
        named(&mut next, "Cuboid");
    }
}

#[test]
fn work_that_stays_open_is_kept_although_somebody_agreed_to_lose_it() {
    let files = tempfile::tempdir().unwrap();
    let broken = files.path().join("broken.scn.ron");
    fs::write(&broken, "no scene").unwrap();
    // A scene that refers to another folder.
    let model = files.path().join("model.obj");
    fs::write(&model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let outside = elsewhere.path().join("outside.scn.ron");
    let mut app = headless_editor();
    app.update();
    for action in [Action::Import(model, None), Action::SaveAs(outside.clone())] {
        act(&mut app, action);
    }
    for (way, asks) in [
        (Action::Open(broken), false),
        (Action::Open(outside), true),
        (Action::run("file.quit"), true),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let mut app = editor(folder.path());
        act(&mut app, Action::Add(Addition::Shape("Sphere".into())));
        app.update();
        wait_for_copy(&mut app, folder.path());
        if way == Action::run("file.quit") {
            let request = RenderRequest {
                file: files.path().join("never.png"),
                camera: RenderFrom::FirstCamera,
                settings: RenderSettings {
                    spp: 1 << 20,
                    ..RenderSettings::default()
                },
            };
            start_render(app.world_mut(), request).unwrap();
        }
        act(&mut app, way.clone());
        answer(app.world_mut(), Answer::No);
        // May it refer to other folders, may the render be lost: no.
        let asked = app.world().resource::<Document>().question.clone();
        assert_eq!(asked.is_some(), asks, "{way:?}: {asked:?}");
        answer(app.world_mut(), Answer::Cancel);
        app.update();
        named(&mut app, "Sphere");
        exit(app, AppExit::from_code(143));
        let offered = offered(folder.path());
        assert_eq!(offered.as_deref(), Some("cornell-box"), "{way:?}");
    }
}

#[test]
fn what_is_saved_leaves_no_copy() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = editor(folder.path());
    act(&mut app, Action::Add(Addition::Shape("Sphere".into())));
    app.update();
    wait_for_copy(&mut app, folder.path());
    let saved = tempfile::tempdir().unwrap();
    act(&mut app, Action::SaveAs(saved.path().join("a.scn.ron")));
    exit(app, AppExit::from_code(130));
    assert_eq!(offered(folder.path()), None);
}

#[test]
fn a_copy_of_before_goes_as_soon_as_the_work_is_saved_or_undone_and_not_a_minute_later() {
    let saved = tempfile::tempdir().unwrap();
    for way in [
        Action::SaveAs(saved.path().join("a.scn.ron")),
        Action::run("edit.undo"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let mut app = editor(folder.path());
        act(&mut app, Action::Add(Addition::Shape("Sphere".into())));
        app.update();
        wait_for_copy(&mut app, folder.path());
        let mut recovery = app.world_mut().resource_mut::<RecoveryFolder>();
        recovery.copy_every(Duration::from_hours(1));
        app.update();
        act(&mut app, way.clone());
        let start = Instant::now();
        while app.world().resource::<Document>().unsaved() || copies(folder.path()) > 0 {
            assert!(start.elapsed().as_secs() < 60, "{way:?} leaves a copy");
            app.update();
        }
    }
}

#[test]
fn a_copy_that_cannot_be_written_is_told_each_time_and_tried_until_it_can() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("copies");
    // A file where the folder should be.
    fs::write(&place, "").unwrap();
    let mut app = editor(&place);
    act(&mut app, Action::Add(Addition::Shape("Sphere".into())));
    let told = |app: &mut App| {
        let mut notices = app.world_mut().resource_mut::<Notices>();
        let texts = notices.shown().iter().map(|notice| notice.text.clone());
        let texts: Vec<String> = texts.filter(|text| text.contains("not copied")).collect();
        notices.close_all();
        texts.len()
    };
    for attempt in 1..=3 {
        app.update();
        assert_eq!(told(&mut app), 1, "attempt {attempt}");
    }
    fs::remove_file(&place).unwrap();
    app.update();
    wait_for_copy(&mut app, &place);
    // A folder where the copy should be: it fails while it is written, on a thread of its own.
    let copy = fs::read_dir(&place)
        .unwrap()
        .flatten()
        .map(|entry| entry.path());
    let mut copy = copy;
    let copy = copy
        .find(|path| path.to_string_lossy().ends_with(".scn.ron"))
        .unwrap();
    fs::remove_file(&copy).unwrap();
    fs::create_dir(&copy).unwrap();
    act(&mut app, Action::Add(Addition::Shape("Cuboid".into())));
    for attempt in 1..=2 {
        let start = Instant::now();
        while told(&mut app) == 0 {
            assert!(
                start.elapsed().as_secs() < 60,
                "attempt {attempt} was not told"
            );
            app.update();
            std::thread::sleep(Duration::from_millis(5));
        }
    }
    fs::remove_dir(&copy).unwrap();
    let start = Instant::now();
    while !copy.is_file() {
        assert!(start.elapsed().as_secs() < 60, "it was not tried again");
        app.update();
        std::thread::sleep(Duration::from_millis(5));
    }
}
