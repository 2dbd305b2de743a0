//! Rendering to a file while the editing goes on.

use super::{act, editor, named};
use bevy::app::App;
use bevy::math::UVec2;
use glassbox::editor::Action;
use glassbox::editor::render_job::{
    RenderFrom, RenderJob, RenderRefused, RenderRequest, start_render,
};
use glassbox::film::render;
use glassbox::io::{SceneFiles, write_picture};
use glassbox::scene::{Environment, RenderSettings, TextureSource};
use glassbox::sync::{Traced, TracedCameras};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

fn request(app: &App, file: &Path, spp: u32) -> RenderRequest {
    RenderRequest {
        file: file.to_path_buf(),
        camera: RenderFrom::FirstCamera,
        settings: RenderSettings {
            size: UVec2::new(40, 30),
            spp,
            ..app.world().resource::<RenderSettings>().clone()
        },
    }
}

fn wait(app: &mut App) {
    let start = Instant::now();
    while app.world().resource::<RenderJob>().progress().is_some() {
        assert!(start.elapsed().as_secs() < 120, "it does not end");
        app.update();
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn edits_do_not_reach_a_render_that_has_begun_and_it_equals_one_made_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = editor("cornell-box");
    for name in ["a.png", "a.exr"] {
        let file = folder.path().join(name);
        let wanted = request(&app, &file, 8);
        let expected = {
            let traced = app.world().resource::<Traced>().world.clone();
            let camera = app.world().resource::<TracedCameras>().0[0].camera.clone();
            render(&traced, &camera, &wanted.settings, &|_, _| {}).picture
        };
        start_render(app.world_mut(), wanted.clone()).unwrap();
        let busy = start_render(app.world_mut(), wanted.clone());
        assert!(matches!(busy, Err(RenderRefused::Busy(_))), "{busy:?}");
        app.update();
        let block = named(&mut app, "Short block");
        act(&mut app, Action::Select(vec![block]));
        act(&mut app, Action::run("edit.delete"));
        wait(&mut app);
        act(&mut app, Action::run("edit.undo"));
        let plain = folder.path().join(format!("plain-{name}"));
        let pixels = if name.ends_with("exr") {
            expected
                .pixels
                .iter()
                .map(|pixel| pixel.to_array())
                .collect()
        } else {
            glassbox::film::develop(&expected, &wanted.settings.output)
        };
        write_picture(&plain, 40, 30, &pixels).unwrap();
        let read = |path: &Path| image::open(path).unwrap().into_rgb32f();
        assert_eq!(read(&file), read(&plain), "{name}");
        let bytes = fs::read(&file).unwrap();
        let says = |text: &str| {
            bytes
                .windows(text.len())
                .any(|window| window == text.as_bytes())
        };
        assert!(
            says("spp=8") && says("size=40x30") && says("Glassbox"),
            "{name}"
        );
    }
}

#[test]
fn a_cancelled_render_writes_nothing_and_what_cannot_be_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    let mut app = editor("cornell-box");
    let endless = request(&app, &file, 1 << 20);
    start_render(app.world_mut(), endless).unwrap();
    for _ in 0..5 {
        app.update();
    }
    let progress = app.world().resource::<RenderJob>().progress().unwrap();
    assert!(progress.fraction < 1.0 && !progress.writing, "{progress:?}");
    app.world_mut().resource_mut::<RenderJob>().cancel();
    app.update();
    assert!(app.world().resource::<RenderJob>().progress().is_none());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let mut refused = |change: &dyn Fn(&mut RenderRequest)| {
        let mut request = request(&app, &file, 1);
        change(&mut request);
        start_render(app.world_mut(), request)
            .unwrap_err()
            .to_string()
    };
    let no_folder = refused(&|request| request.file = folder.path().join("no/a.png"));
    assert!(no_folder.contains("folder"), "{no_folder}");
    let no_format = refused(&|request| request.file = folder.path().join("a.doc"));
    assert!(no_format.contains("doc"), "{no_format}");
    let too_wide = refused(&|request| {
        request.file = folder.path().join("a.jpg");
        request.settings.size = UVec2::new(65_536, 1);
    });
    assert!(too_wide.contains("65535"), "{too_wide}");
    let too_many = refused(&|request| request.settings.spp = 0);
    assert!(too_many.contains("spp"), "{too_many}");
    let no_camera = refused(&|request| {
        request.camera = RenderFrom::Camera(glassbox::scene::SceneId(999));
    });
    assert!(no_camera.contains("camera"), "{no_camera}");
}

#[test]
fn a_picture_that_the_scene_reads_or_has_read_is_not_rendered_over() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("t.png");
    write_picture(&file, 2, 1, &[[1.0, 0.0, 0.0], [0.0; 3]]).unwrap();
    let before = fs::read(&file).unwrap();
    let mut app = editor("triangle");
    act(&mut app, Action::SaveAs(folder.path().join("a.scn.ron")));
    let map = TextureSource::new(folder.path().join("t.png").display().to_string());
    app.world_mut()
        .resource_mut::<SceneFiles>()
        .folder
        .allow_outside = true;
    app.world_mut().resource_mut::<Environment>().map = Some(map);
    app.update();
    // Undoing brings it back.
    act(&mut app, Action::run("edit.undo"));
    app.update();
    assert_eq!(app.world().resource::<Environment>().map, None);
    let wanted = request(&app, &file, 1);
    let refused = start_render(app.world_mut(), wanted);
    let Err(RenderRefused::File(error)) = refused else {
        panic!("{refused:?}");
    };
    assert!(error.to_string().contains("same file"), "{error}");
    assert_eq!(fs::read(&file).unwrap(), before);
}
