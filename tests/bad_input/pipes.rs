//! Pipes and devices where files are expected: nobody waits for what may never come.

use crate::cli::{PROGRAM, texts, without_display};
use crate::files::app::write;
use std::path::Path;
use std::process::{Command, Output};

/// A pipe that nobody writes into.
fn pipe(folder: &Path, name: &str) {
    let made = Command::new("mkfifo").arg(folder.join(name)).status();
    assert!(made.unwrap().success(), "mkfifo failed");
}

/// Runs the program, which is ended after a while.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    without_display("timeout", folder)
        .args(["60", PROGRAM])
        .args(arguments)
        .output()
        .unwrap()
}

/// Expects one line that names the pipe.
fn refuses(folder: &Path, arguments: &[&str], name: &str) {
    let output = run(folder, arguments);
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {err}");
    assert_eq!(err.lines().count(), 1, "{err}");
    for part in ["error: ", name, "pipe"] {
        assert!(err.contains(part), "`{part}` is missing: {err}");
    }
}

#[test]
fn no_reader_waits_for_a_pipe() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for name in [
        "a.scn.ron",
        "a.obj",
        "a.glb",
        "a.exr",
        "s.ron",
        "e.csv",
        "b.mtl",
        "b.bin",
        "b.png",
    ] {
        pipe(folder, name);
    }
    let render = |scene: &str, name: &str| refuses(folder, &["render", scene, "-o", "o.png"], name);
    for name in ["a.scn.ron", "a.obj", "a.glb"] {
        render(name, name);
    }
    write(
        folder,
        "b.obj",
        "mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    );
    // What a model names and is no file is not there.
    let output = run(folder, &["render", "b.obj", "-o", "o.png", "--size", "8x8"]);
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{err}");
    assert!(err.contains("b.mtl"), "{err}");
    let gltf = "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"uri\": \"b.bin\", \"byteLength\": 36}], \
        \"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}], \"nodes\": [{\"mesh\": 0}], \"accessors\": \
        [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}], \
        \"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}]}";
    write(folder, "b.gltf", gltf);
    let output = run(folder, &["render", "b.gltf", "-o", "o.png"]);
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("b.bin"), "{err}");
    let phong = "\"glassbox::scene::Phong\": (diffuse_map: Some((path: \"b.png\")))";
    let text = format!(
        "(resources: {{\"glassbox::io::FileVersion\": (1)}}, entities: {{1: (components: {{{phong}}})}})"
    );
    write(folder, "b.scn.ron", text);
    render("b.scn.ron", "b.png");
    refuses(folder, &["merge", "a.exr", "-o", "o.png"], "a.exr");
    refuses(folder, &["--script", "s.ron"], "s.ron");
    let report = ["report", "triangle", "--quick", "--editing", "e.csv"];
    refuses(folder, &report, "e.csv");
}

#[test]
fn a_device_without_an_end_is_not_read() {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("a.obj")).unwrap();
    let arguments = ["render", "a.obj", "--allow-outside", "-o", "o.png"];
    refuses(folder.path(), &arguments, "a.obj");
}
