//! Unsaved work outlives an editor that does not end as it should.

use super::scene_copy::SceneCopy;
use super::{act, named};
use bevy::app::{App, AppExit};
use glassbox::editor::action::Addition;
use glassbox::editor::document::{Answer, Document, Question, RecoveryFolder, adopt, answer};
use glassbox::editor::{Action, headless_editor_with_recovery};
use glassbox::io::{OpenOptions, SceneSource, open};
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
fn unsaved_work_is_offered_after_a_crash_and_not_after_an_orderly_end() {
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
    // An orderly end leaves nothing.
    next.world_mut().write_message(AppExit::Success);
    next.update();
    drop(next);
    assert_eq!(copies(folder.path()), 0);
    let last = editor(folder.path());
    assert_eq!(last.world().resource::<Document>().question, None);
}
