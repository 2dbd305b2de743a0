//! Names of files that hold what formats and systems treat specially: what is written can be opened.

use super::app::{opened, write};
use crate::cli::{PROGRAM, glassbox, succeeds, texts, without_display};
use glassbox::io::save;
use glassbox::scene::Phong;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::Path;

fn names() -> Vec<OsString> {
    let mut names: Vec<OsString> = [
        "a#b",
        "#",
        "a#texture0",
        " a",
        "a ",
        "-a",
        "a\nb",
        "100%",
        "a%20b",
        "a\"b",
        "größe",
        "a  b",
    ]
    .map(OsString::from)
    .into();
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        names.extend(["a\\b", "c:d", "builtin:uv", "a\tb"].map(OsString::from));
        names.push(OsStr::from_bytes(b"a\xff").to_owned());
    }
    names
}

fn with(name: &OsStr, extension: &str) -> OsString {
    let mut name = name.to_owned();
    name.push(extension);
    name
}

/// The red part of the colour that the only picture shows on the left.
fn renders_alike(folder: &Path, file: &OsStr, like: &str) {
    let arguments = [
        "render",
        "--size",
        "24x16",
        "--spp",
        "1",
        "--quiet",
        "-o",
        "shown.png",
        // No model file keeps the dome by which a model without lights is shown.
        "--set",
        "features.shading=false",
    ];
    let output = without_display(PROGRAM, folder)
        .args(arguments)
        .arg("--")
        .arg(file)
        .output()
        .unwrap();
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{file:?}: {err}");
    let pixels = |name: &str| image::open(folder.join(name)).unwrap().into_rgb8();
    let same = pixels("shown.png") == pixels(like);
    assert!(same, "{file:?} does not look like {like}: {err}");
}

/// A textured triangle: `plain.obj`, `plain.mtl`, `plain.png`, and how it looks in `plain-shown.png`.
fn plain(folder: &Path) {
    let pixels = [[0.9, 0.1, 0.1], [0.1, 0.1, 0.9]];
    glassbox::io::write_picture(&folder.join("plain.png"), 2, 1, &pixels).unwrap();
    write(folder, "plain.mtl", "newmtl one\nmap_Kd plain.png\n");
    let obj = "mtllib plain.mtl\no one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl one\n\
               f 1/1 2/2 3/3\n";
    write(folder, "plain.obj", obj);
    let small = ["--size", "24x16", "--spp", "1", "--quiet"];
    let how = ["render", "plain.obj", "-o", "plain-shown.png"];
    let unlit = ["--set", "features.shading=false"];
    succeeds(folder, &[&how[..], &small, &unlit].concat());
}

#[test]
fn a_model_of_any_name_is_written_and_opened_again_with_its_picture() {
    for name in names() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        plain(folder);
        let (mut app, _) = opened(&folder.join("plain.obj"));
        let file = with(&name, ".glb");
        save(app.world_mut(), &folder.join(&file)).unwrap_or_else(|error| panic!("{error}"));
        let file = Path::new(".").join(file);
        renders_alike(folder, file.as_os_str(), "plain-shown.png");
        // And named in a scene, in its own folder and from another one.
        let (mut app, _) = opened(&folder.join(&file));
        for scene in ["s.scn.ron", "below/s.scn.ron"] {
            let _ = fs::create_dir(folder.join("below"));
            save(app.world_mut(), &folder.join(scene)).unwrap_or_else(|error| panic!("{error}"));
            let (allowed, scene) = (scene.starts_with("below"), scene);
            if allowed {
                let what = [
                    "render",
                    scene,
                    "--allow-outside",
                    "--size",
                    "24x16",
                    "--spp",
                    "1",
                ];
                succeeds(folder, &[&what[..], &["--quiet", "-o", "b.png"]].concat());
            } else {
                renders_alike(folder, OsStr::new(scene), "plain-shown.png");
            }
        }
    }
}

#[test]
fn a_scene_file_of_any_name_is_written_and_opened_again() {
    for name in names() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        plain(folder);
        let (mut app, _) = opened(&folder.join("plain.obj"));
        let file = Path::new(".").join(with(&name, ".scn.ron"));
        save(app.world_mut(), &folder.join(&file)).unwrap_or_else(|error| panic!("{error}"));
        renders_alike(folder, file.as_os_str(), "plain-shown.png");
    }
}

#[test]
fn a_picture_of_any_name_goes_through_every_format() {
    for name in names() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        plain(folder);
        let picture = with(&name, ".png");
        fs::rename(folder.join("plain.png"), folder.join(&picture)).unwrap();
        glassbox::io::write_picture(&folder.join("plain.png"), 1, 1, &[[0.0; 3]]).unwrap();
        let (mut app, _) = opened(&folder.join("plain.obj"));
        let world = app.world_mut();
        let path =
            glassbox::io::Folder::of(&folder.join("x"), false).name_of(&folder.join(&picture));
        let mut materials = world.query::<&mut Phong>();
        for mut phong in materials.iter_mut(world) {
            phong.diffuse_map = Some(glassbox::scene::TextureSource::new(path.clone()));
        }
        app.update();
        for file in ["s.scn.ron", "s.obj", "s.glb"] {
            let notes = save(app.world_mut(), &folder.join(file));
            notes.unwrap_or_else(|error| panic!("{picture:?} in {file}: {error}"));
            renders_alike(folder, OsStr::new(file), "plain-shown.png");
        }
    }
}

#[test]
fn an_obj_has_a_name_that_it_can_name_its_materials_by_or_is_not_written() {
    for name in names() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        plain(folder);
        let (mut app, _) = opened(&folder.join("plain.obj"));
        let file = with(&name, ".obj");
        let before = crate::cli::files(folder);
        match save(app.world_mut(), &folder.join(&file)) {
            Ok(_) => {
                let file = Path::new(".").join(file);
                renders_alike(folder, file.as_os_str(), "plain-shown.png");
            }
            Err(error) => {
                assert!(error.to_string().contains("another name"), "{error}");
                assert_eq!(crate::cli::files(folder), before, "{error}");
                let ordinary = ["a#b", "#", "a ", "100%", "größe", "a  b"].map(OsString::from);
                assert!(!ordinary.contains(&name), "{error}");
            }
        }
    }
}

#[test]
fn what_old_scenes_and_people_say_still_means_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    plain(folder);
    for picture in ["50%25.png", "a%20b.png"] {
        fs::copy(folder.join("plain.png"), folder.join(picture)).unwrap();
        write(
            folder,
            "plain.mtl",
            format!("newmtl one\nmap_Kd {picture}\n"),
        );
        renders_alike(folder, OsStr::new("plain.obj"), "plain-shown.png");
        succeeds(folder, &["convert", "plain.obj", "s.scn.ron", "--quiet"]);
        let text = fs::read_to_string(folder.join("s.scn.ron")).unwrap();
        assert!(
            text.contains(picture),
            "it was written as it stands: {text}"
        );
        renders_alike(folder, OsStr::new("s.scn.ron"), "plain-shown.png");
    }
    let output = glassbox(folder, &["render", "gone#b.obj", "-o", "a.png"]);
    let (_, err) = texts(&output);
    assert!(err.contains("gone#b.obj"), "{err}");
}
