//! Files that belong together: an OBJ with its materials and pictures is complete at any time.

use super::app::{app, opened, write};
use crate::cli::{PROGRAM, files, glassbox, succeeds, texts, without_display};
use glassbox::io::save;
use glassbox::scene::{Phong, TextureSource};
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::Duration;

/// The names that an OBJ and its MTL refer to, and the colour of the first material.
fn library(folder: &Path, obj: &str) -> (String, String) {
    let text = fs::read_to_string(folder.join(obj)).unwrap();
    let mtl = text.lines().find_map(|line| line.strip_prefix("mtllib "));
    let mtl = mtl.unwrap_or_else(|| panic!("no mtllib")).to_owned();
    let library = fs::read_to_string(folder.join(&mtl));
    let library = library.unwrap_or_else(|error| panic!("{mtl}: {error}"));
    for name in library
        .lines()
        .filter_map(|line| line.strip_prefix("map_Kd "))
    {
        assert!(folder.join(name).is_file(), "{name} of {mtl} is not there");
    }
    (mtl, library)
}

/// A scene of one object with a colour and a generated picture, and how high its triangle is.
fn scene(folder: &Path, name: &str, height: f32, red: f32, picture: &str) {
    let mut text = format!("mtllib {name}.mtl\n");
    for i in 0..20_000 {
        text += &format!("v 0 0 {i}\nv 1 0 {i}\nv 0 {height} {i}\n");
    }
    text += "usemtl one\n";
    for i in 0..20_000 {
        text += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    write(
        folder,
        &format!("{name}.mtl"),
        format!("newmtl one\nKd {red} 0 0\n"),
    );
    let (mut app, _) = opened(&write(folder, &format!("{name}.obj"), text));
    let mut materials = app.world_mut().query::<&mut Phong>();
    for mut phong in materials.iter_mut(app.world_mut()) {
        phong.diffuse_map = Some(TextureSource::new(picture));
    }
    app.update();
    save(app.world_mut(), &folder.join(format!("{name}.scn.ron"))).unwrap();
}

/// The parts of what was exported that differ from scene to scene.
fn exported(folder: &Path) -> (String, String) {
    let obj = fs::read_to_string(folder.join("out.obj")).unwrap();
    let mut points = obj.lines().filter(|line| line.starts_with("v 0 "));
    let point = points.nth(1).unwrap_or_default().to_owned();
    let (_, library) = library(folder, "out.obj");
    let colour = library.lines().find(|line| line.starts_with("Kd "));
    (point, colour.unwrap_or_default().to_owned())
}

#[test]
fn an_export_that_is_killed_leaves_the_old_set_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    scene(folder, "a", 1.0, 0.25, "builtin:uv");
    scene(folder, "b", 2.0, 0.75, "builtin:checker");
    let export = |name: &str| {
        let mut command = without_display(PROGRAM, folder);
        command
            .args(["convert", &format!("{name}.scn.ron"), "out.obj", "--quiet"])
            .stderr(Stdio::null());
        command
    };
    let mut sets = Vec::new();
    let mut took = Duration::ZERO;
    for name in ["a", "b"] {
        let start = std::time::Instant::now();
        assert!(export(name).status().unwrap().success());
        took = start.elapsed();
        sets.push(exported(folder));
    }
    assert_ne!(sets[0], sets[1]);
    let mut met = [0, 0];
    for i in 0..24 {
        let name = ["a", "b"][i % 2];
        let mut child = export(name).spawn().unwrap();
        // Around the time at which the files take their places, the last tenth of it.
        thread::sleep(took.mul_f64(0.7 + 0.4 * i as f64 / 24.0));
        child.kill().unwrap();
        child.wait().unwrap();
        let now = exported(folder);
        let set = sets.iter().position(|set| *set == now);
        let set = set.unwrap_or_else(|| panic!("{now:?} is of neither of {sets:?}"));
        met[set] += 1;
    }
    // What the last one left is tidied up by the next, but for a picture that nothing names yet: it may be anyone's.
    assert!(export("a").status().unwrap().success());
    let mut left = files(folder);
    left.retain(|name| name.starts_with("out") && !name.starts_with("out-texture"));
    assert_eq!(left, ["out.mtl", "out.obj"], "met {met:?}");
}

#[test]
fn what_a_killed_export_left_goes_with_the_next_and_what_others_wrote_stays() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    scene(folder, "a", 1.0, 0.25, "builtin:uv");
    let export = || {
        let mut command = without_display(PROGRAM, folder);
        command.args(["convert", "a.scn.ron", "out.obj", "--quiet"]);
        assert!(command.status().unwrap().success());
    };
    export();
    let left = "# In place of out.mtl while that is replaced\nnewmtl a\n";
    fs::write(folder.join("out-new7.mtl"), left).unwrap();
    fs::write(folder.join("out-new8.mtl"), "newmtl mine\n").unwrap();
    fs::write(folder.join("out-newer.mtl"), left).unwrap();
    export();
    let mut materials = files(folder);
    materials.retain(|name| name.starts_with("out") && name.ends_with(".mtl"));
    assert_eq!(materials, ["out-new8.mtl", "out-newer.mtl", "out.mtl"]);
}

#[test]
fn an_export_that_finds_no_room_changes_no_file_of_the_set() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    scene(folder, "a", 1.0, 0.25, "builtin:uv");
    scene(folder, "b", 2.0, 0.75, "builtin:checker");
    succeeds(folder, &["convert", "a.scn.ron", "out.obj", "--quiet"]);
    let before: Vec<_> = files(folder)
        .into_iter()
        .map(|name| (fs::read(folder.join(&name)).unwrap(), name))
        .collect();
    // The materials and pictures fit, the OBJ does not.
    let command = "ulimit -f 200; exec \"$0\" convert b.scn.ron out.obj";
    let output = without_display("sh", folder)
        .args(["-c", command, PROGRAM])
        .output()
        .unwrap();
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{err}");
    let after: Vec<_> = files(folder)
        .into_iter()
        .map(|name| (fs::read(folder.join(&name)).unwrap(), name))
        .collect();
    let names = |set: &[(Vec<u8>, String)]| -> Vec<String> {
        set.iter().map(|(_, name)| name.clone()).collect()
    };
    assert_eq!(names(&before), names(&after));
    let changed = before.iter().zip(&after).filter(|(a, b)| a.0 != b.0);
    let changed: Vec<&String> = changed.map(|(a, _)| &a.1).collect();
    assert!(changed.is_empty(), "{changed:?} changed");
}

#[test]
fn exporting_again_and_again_leaves_no_more_files_than_once() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut app = app();
    let source = glassbox::io::SceneSource::named("triangle");
    glassbox::io::open(app.world_mut(), &source, Default::default()).unwrap();
    for (number, picture) in [
        ("builtin:uv", 0.25),
        ("builtin:uv", 0.25),
        ("builtin:uv", 0.5),
        ("builtin:checker", 0.5),
        ("builtin:uv", 0.25),
    ]
    .into_iter()
    .enumerate()
    {
        let (path, red) = picture;
        let mut materials = app.world_mut().query::<&mut Phong>();
        for mut phong in materials.iter_mut(app.world_mut()) {
            phong.diffuse.red = red;
            phong.diffuse_map = Some(TextureSource::new(path));
        }
        app.update();
        // As long as names may be.
        let stem = "a".repeat(251);
        let obj = format!("{stem}.obj");
        save(app.world_mut(), &folder.join(&obj)).unwrap_or_else(|error| panic!("{error}"));
        let (mtl, library) = library(folder, &obj);
        assert_eq!(mtl, format!("{stem}.mtl"), "export {number}");
        let colour = format!("Kd {red} ");
        assert!(library.contains(&colour), "export {number}: {library}");
        assert_eq!(
            files(folder).len(),
            3,
            "export {number}: {:?}",
            files(folder)
        );
    }
    let obj = format!("{}.obj", "a".repeat(251));
    let said = glassbox(folder, &["render", &obj, "--size", "8x8", "-o", "a.png"]);
    assert_eq!(said.status.code(), Some(0), "{:?}", texts(&said));
}
