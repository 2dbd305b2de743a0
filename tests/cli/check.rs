//! `glassbox check`, and what a file's notes do to the exit code.

use super::{files, glassbox, succeeds, texts};
use std::fs;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn files_are_told_apart_by_what_cannot_be_shown_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("whole.obj"), TRIANGLE).unwrap();
    fs::write(
        at.join("part.obj"),
        format!("mtllib gone.mtl\n{TRIANGLE}l 1 2\n"),
    )
    .unwrap();
    fs::write(at.join("none.obj"), "v 0 0 0\n").unwrap();
    let before = files(at);
    let out = succeeds(at, &["check", "whole.obj", "part.obj", "cornell-box"]);
    let lines: Vec<&str> = out.lines().collect();
    assert!(
        lines[0].starts_with("whole.obj: 1 object, 1 triangle,"),
        "{out}"
    );
    assert!(lines[0].ends_with("nothing to note"), "{out}");
    assert!(lines[1].ends_with("2 notes"), "{out}");
    for (line, parts) in [
        (lines[2], ["part.obj:6", "lines and points"]),
        (lines[3], ["part.obj:1", "gone.mtl"]),
    ] {
        assert!(parts.iter().all(|part| line.contains(part)), "{out}");
    }
    assert!(lines[4].starts_with("cornell-box: "), "{out}");
    for (arguments, code, says) in [
        (
            &["check", "none.obj", "whole.obj"][..],
            1,
            "1 of 2 files cannot be shown",
        ),
        (&["check", "--strict", "part.obj"][..], 1, "1 of 1 files"),
        (&["check", "--strict", "whole.obj"][..], 0, ""),
        (&["check"][..], 2, "<FILE>"),
    ] {
        let output = glassbox(at, arguments);
        let (out, err) = texts(&output);
        assert_eq!(
            output.status.code(),
            Some(code),
            "{arguments:?}: {out}{err}"
        );
        assert!(err.contains(says), "{arguments:?}: {err}");
    }
    assert_eq!(files(at), before, "check writes nothing");
}

#[test]
fn what_one_file_holds_is_no_weight_on_the_next() {
    let folder = tempfile::tempdir().unwrap();
    // One takes 12 MB while it is read, and 2 MB afterwards.
    const SIDE: usize = 120;
    let mut model = String::new();
    for at in 0..SIDE * SIDE {
        model += &format!("v {} {} 0\n", at / SIDE, at % SIDE);
    }
    for (i, j) in (0..SIDE - 1).flat_map(|i| (0..SIDE - 1).map(move |j| (i, j))) {
        let at = i * SIDE + j + 1;
        model += &format!("f {at} {} {} {}\n", at + 1, at + SIDE + 1, at + SIDE);
    }
    fs::write(folder.path().join("grid.obj"), model).unwrap();
    let files = ["grid.obj"; 12];
    let out = succeeds(
        folder.path(),
        &[&["check", "--memory", "16M"], &files[..]].concat(),
    );
    assert_eq!(out.lines().count(), files.len(), "{out}");
}

#[test]
fn what_could_not_be_traced_of_a_scene_is_told_without_rendering_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let scene = "\u{feff}(resources: {\"glassbox::io::FileVersion\": (2)}, entities: {
1: (components: {
    \"bevy_ecs::name::Name\": \"Lamp\",
    \"glassbox::scene::SegmentLamp\": (ends: ((1.0, 0.0, 0.0), (1.0, 0.0, 0.0))),
}),
})";
    fs::write(at.join("dark.scn.ron"), scene).unwrap();
    let out = succeeds(at, &["check", "dark.scn.ron", "cornell-box"]);
    let lines: Vec<&str> = out.lines().collect();
    assert!(lines[0].ends_with("2 notes"), "{out}");
    for (line, parts) in [
        (lines[1], ["Lamp", "length"]),
        (lines[2], ["dark.scn.ron", "add a SceneCamera"]),
    ] {
        assert!(parts.iter().all(|part| line.contains(part)), "{out}");
    }
    assert!(lines[3].ends_with("nothing to note"), "{out}");
    let strict = glassbox(at, &["check", "--strict", "dark.scn.ron"]);
    assert_eq!(strict.status.code(), Some(1));
    let render = glassbox(at, &["render", "dark.scn.ron", "-o", "x.png"]);
    let (_, err) = texts(&render);
    assert!(
        err.contains(lines[1].trim_start()),
        "{err}: as where it is rendered"
    );
}

#[test]
fn json_says_the_same_of_every_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(
        at.join("part.obj"),
        format!("usemtl a\n{TRIANGLE}l 1 2\nl 2 3\n"),
    )
    .unwrap();
    let output = glassbox(at, &["check", "--json", "part.obj", "gone.glb"]);
    assert_eq!(output.status.code(), Some(1));
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(all[0]["triangles"], 1);
    assert_eq!(all[0]["area"], 0.5);
    assert_eq!(all[0]["bounds"][1][1], 1.0, "{all}");
    assert_eq!(all[0]["error"], serde_json::Value::Null);
    let lines = &all[0]["notes"][0];
    assert_eq!(lines["count"], 2, "{all}");
    assert_eq!(lines["place"], ":6", "{all}");
    let error = all[1]["error"].as_str().unwrap();
    assert!(
        error.contains("gone.glb") && error.contains("no such file"),
        "{error}"
    );
}

#[test]
fn a_value_may_start_with_a_minus() {
    let folder = tempfile::tempdir().unwrap();
    let common = [
        "inspect",
        "triangle",
        "--size",
        "8x8",
        "--spp",
        "1",
        "--picture",
        "a.png",
    ];
    let eye = ["--eye", "-6,1,0", "--target", "-0.5,0,0"];
    succeeds(folder.path(), &[&common[..], &eye].concat());
    let view = [
        "render", "triangle", "--size", "8x8", "--spp", "1", "-o", "b.png",
    ];
    let range = ["--view", "depth", "--range", "-1..5"];
    succeeds(folder.path(), &[&view[..], &range].concat());
    assert_eq!(files(folder.path()), ["a.png", "b.png"]);
    // Where none may, it is the option that is named and not the value.
    for refused in [
        &["render", "triangle", "-o", "c.png", "--spp", "-1"][..],
        &["render", "triangle", "-o", "c.png", "--seed", "-1"],
        &["render", "triangle", "-o", "c.png", "--size", "-1x-1"],
        &["render", "triangle", "-o", "c.png", "--threads", "-1"],
        &["check", "triangle", "--memory", "-1"],
        &["inspect", "triangle", "--pixel", "-1,0"],
    ] {
        let output = glassbox(folder.path(), refused);
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(2), "{refused:?}: {err}");
        let option = refused[refused.len() - 2];
        assert!(
            err.contains(option) && !err.contains("unexpected"),
            "{refused:?}: {err}"
        );
    }
}
