//! What goes wrong ends with one line on standard error, the right exit code, and no file.

use super::{PROGRAM, files, glassbox, texts, without_display};
use std::path::Path;

/// Runs the program, expects this exit code and one line that holds every part.
fn fails(folder: &Path, arguments: &[&str], code: i32, parts: &[&str]) {
    let before = files(folder);
    let output = glassbox(folder, arguments);
    let (out, err) = texts(&output);
    // Without a command and without a display, what follows is announced.
    let err: String = err
        .lines()
        .filter(|line| !line.starts_with("note: no window"))
        .map(|line| format!("{line}\n"))
        .collect();
    let what = format!("{arguments:?}\nstdout: {out}\nstderr: {err}");
    assert_eq!(output.status.code(), Some(code), "{what}");
    assert_eq!(err.lines().count(), 1, "{what}");
    assert!(err.starts_with("error: "), "{what}");
    assert!(!err.contains("panicked"), "{what}");
    for part in parts {
        assert!(err.contains(part), "`{part}` is missing\n{what}");
    }
    assert_eq!(files(folder), before, "{what}");
}

#[test]
fn a_wrong_command_line_ends_with_code_2_and_says_what_would_be_right() {
    let folder = tempfile::tempdir().unwrap();
    let render = |more: &[&str], parts: &[&str]| {
        let arguments = [&["render", "triangle", "-o", "a.png"], more].concat();
        fails(folder.path(), &arguments, 2, parts);
    };
    fails(folder.path(), &["render"], 2, &["<SCENE>", "--output"]);
    fails(folder.path(), &["render", "triangle"], 2, &["--output"]);
    fails(folder.path(), &["--no-such-flag"], 2, &["--no-such-flag"]);
    fails(folder.path(), &["convert", "triangle"], 2, &["<OUTPUT>"]);
    fails(
        folder.path(),
        &["bvh", "triangle", "--builder", "quick"],
        2,
        &["quick", "ploc"],
    );
    fails(
        folder.path(),
        &["bench", "triangle", "--runs", "0"],
        2,
        &["--runs", "1..=1000"],
    );
    render(&["--size", "0x0"], &["size is 0x0", "each 1 to 65536"]);
    render(
        &["--size", "70000x1"],
        &["size is 70000x1", "each 1 to 65536"],
    );
    // 2^31 pixels.
    render(&["--size", "65536x32768"], &["size", "at most 268435456"]);
    render(&["--size", "99999999999x1"], &["--size", "800x600"]);
    render(&["--size", "800"], &["--size", "800x600"]);
    render(&["--spp", "0"], &["spp is 0", "1 to 1048576"]);
    render(
        &["--spp", "2147483648"],
        &["spp is 2147483648", "1 to 1048576"],
    );
    render(&["--spp", "-1"], &["-1"]);
    render(&["--threads", "0"], &["--threads", "1..=1024"]);
    render(&["--set", "max_depth=51"], &["max_depth is 51", "0 to 50"]);
    render(
        &["--set", "max_depth=2147483648"],
        &["max_depth", "0 to 50"],
    );
    render(&["--set", "shadow=false"], &["shadow", "features.shadows"]);
    render(
        &["--set", "features.shadows=maybe"],
        &["features.shadows=maybe", "true or false"],
    );
    render(&["--set", "spp"], &["--set", "key=value"]);
    render(
        &["--error", "0.1", "--set", "sampling.error=0.2"],
        &["--error", "--set sampling.error"],
    );
    render(
        &["--builder", "sah", "--set", "tree.builder=Ploc"],
        &["--builder", "--set tree.builder"],
    );
    render(&["--camera", "nobody"], &["triangle", "nobody", "it has "]);
    render(
        &["--set", "output.exposure=NaN"],
        &["output.exposure is NaN", "-64 to 64"],
    );
    render(
        &["--camera", "a", "--all-cameras"],
        &["--camera", "--all-cameras"],
    );
}

#[test]
fn what_is_not_there_or_cannot_be_written_ends_with_code_1_and_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::create_dir(path.join("folder")).unwrap();
    std::fs::create_dir(path.join("folder.png")).unwrap();
    std::fs::write(path.join("empty.obj"), "").unwrap();
    std::fs::write(path.join("scene.xyz"), "x").unwrap();
    let long = format!("{}.png", "x".repeat(300));
    for (arguments, parts) in [
        // It would be told only after tracing.
        (
            &["render", "triangle", "-o", &long, "--spp", "1000000"][..],
            &["xxx", "cannot be written"][..],
        ),
        (
            &["render", "no-such-scene", "-o", "a.png"],
            &["no-such-scene", "cornell-box"],
        ),
        (&["render", "no-such.obj", "-o", "a.png"], &["no-such.obj"]),
        (&["render", "empty.obj", "-o", "a.png"], &["empty.obj"]),
        (&["render", "scene.xyz", "-o", "a.png"], &["scene.xyz"]),
        (&["render", "folder", "-o", "a.png"], &["folder"]),
        (
            &["render", "triangle", "-o", "missing/a.png"],
            &["missing/a.png", "folder"],
        ),
        (&["render", "triangle", "-o", "folder.png"], &["folder.png"]),
        (
            &[
                "render",
                "triangle",
                "-o",
                "a.png",
                "--stats",
                "missing/a.json",
            ],
            &["missing/a.json", "folder"],
        ),
        (&["convert", "no-such.glb", "a.obj"], &["no-such.glb"]),
        (
            &["convert", "triangle", "missing/a.obj"],
            &["missing/a.obj"],
        ),
        (&["bvh", "no-such.obj"], &["no-such.obj"]),
        (&["bench", "no-such.obj"], &["no-such.obj"]),
        (&["no-such.obj"], &["no-such.obj"]),
    ] {
        fails(path, arguments, 1, parts);
    }
}

#[test]
fn what_a_scene_has_nothing_of_that_name_of_is_a_wrong_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let render = ["render", "triangle", "-o", "a.png"];
    for (more, parts) in [
        (["--camera", "nobody"], ["triangle", "nobody", "it has "]),
        (
            ["--set", "nobody/Lens.samples=3"],
            ["--set nobody", "no such entity", "there is Camera"],
        ),
    ] {
        let arguments = [&render[..], &more].concat();
        fails(folder.path(), &arguments, 2, &parts);
    }
}

#[test]
fn an_output_that_its_name_or_its_size_rules_out_is_a_wrong_command_line_and_told_at_once() {
    let folder = tempfile::tempdir().unwrap();
    // Far more samples than a test waits for.
    let endless = ["--spp", "1048576"];
    let wide = ["--size", "65536x2048"];
    let inspect = ["inspect", "triangle", "--picture"];
    for (arguments, parts) in [
        (
            &["render", "triangle", "-o", "a.bmp"][..],
            &["a.bmp", ".png"][..],
        ),
        (&["render", "triangle", "-o", "a"], &["a", ".png"]),
        (
            &["render", "no-such.obj", "-o", "a.webp"],
            &["a.webp", ".png"],
        ),
        (&["merge", "part.exr", "-o", "a.gif"], &["a.gif", ".png"]),
        (&[&inspect[..], &["a.bmp"]].concat(), &["a.bmp", ".png"]),
        (&["convert", "triangle", "a.fbx"], &["a.fbx", ".glb"]),
        (&["convert", "no-such.obj", "a.gltf"], &["a.gltf", ".glb"]),
        (
            &[&["render", "triangle", "-o", "a.jpg"][..], &wide, &endless].concat(),
            &["a.jpg", "65536x2048", "65535", ".png"],
        ),
        (
            &[
                &["render", "triangle", "--all-cameras", "-o", "a.jpeg"][..],
                &wide,
                &endless,
            ]
            .concat(),
            &["a.jpeg", "65535"],
        ),
        (
            &[
                &["render", "triangle", "--view", "nodes", "-o", "a.jpg"][..],
                &wide,
            ]
            .concat(),
            &["a.jpg", "65535"],
        ),
        (
            &[&inspect[..], &["a.jpg"], &wide].concat(),
            &["a.jpg", "65535"],
        ),
    ] {
        fails(folder.path(), arguments, 2, parts);
    }
}

#[test]
fn a_report_that_has_no_place_is_refused_before_it_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    for arguments in [
        &["report", "features", "triangle", "-o", "file/report"][..],
        &["report", "features", "triangle", "--files", "file"],
        &["report", "features", "triangle", "--files", "file/a/b"],
    ] {
        fails(folder.path(), arguments, 1, &["file"]);
    }
}

#[test]
fn a_scene_file_with_a_setting_out_of_range_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    super::succeeds(folder.path(), &["convert", "triangle", "a.scn.ron"]);
    let path = folder.path().join("a.scn.ron");
    let text = std::fs::read_to_string(&path).unwrap();
    let broken = text.replacen("max_depth: ", "max_depth: 9", 1);
    assert_ne!(text, broken, "the scene file names no max_depth");
    std::fs::write(&path, broken).unwrap();
    fails(
        folder.path(),
        &["render", "a.scn.ron", "-o", "a.png"],
        1,
        &["a.scn.ron", "max_depth", "0 to 50"],
    );
}

#[test]
fn a_file_that_is_there_stays_as_it_was_when_rendering_fails() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("a.png");
    std::fs::write(&picture, "precious").unwrap();
    fails(
        folder.path(),
        &["render", "no-such.obj", "-o", "a.png"],
        1,
        &["no-such.obj"],
    );
    assert_eq!(std::fs::read(&picture).unwrap(), b"precious");
}

#[test]
fn a_reader_that_closes_the_pipe_is_no_error_and_a_full_disk_is_one() {
    use std::process::Stdio;
    let folder = tempfile::tempdir().unwrap();
    let run = |stdout: Stdio, close: bool| {
        let mut child = without_display(PROGRAM, folder.path())
            .arg("scenes")
            .stdout(stdout)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        if close {
            drop(child.stdout.take());
        }
        let output = child.wait_with_output().unwrap();
        let (_, err) = texts(&output);
        (output.status.code(), err)
    };
    assert_eq!(run(Stdio::piped(), true), (Some(0), String::new()));
    #[cfg(target_os = "linux")]
    {
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let (code, err) = run(full.into(), false);
        assert_eq!(code, Some(1), "{err}");
        assert!(
            err.starts_with("error: standard output: ") && err.lines().count() == 1,
            "{err}"
        );
    }
}

#[test]
fn what_needs_more_memory_than_it_may_take_is_refused_before_it_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let render = |more: &[&str], code: i32, parts: &[&str]| {
        let arguments = [&["render", "triangle", "-o", "a.png"], more].concat();
        fails(folder, &arguments, code, parts);
    };
    let film = ["--size", "8000x8000", "--memory", "500M"];
    render(&film, 1, &["triangle", "500 MB", "--memory"]);
    render(&["--memory", "6"], 2, &["--memory", "6G"]);
    render(&["--memory", "0G"], 2, &["--memory", "above 0"]);
    let bench = ["bench", "triangle", "--size", "8000x8000", "--memory", "1G"];
    fails(folder, &bench, 1, &["triangle", "--memory"]);
    let part = [
        "render",
        "triangle",
        "--size",
        "200x200",
        "--quiet",
        "--samples",
    ];
    for (samples, file) in [("0..1", "a.exr"), ("1..2", "b.exr")] {
        super::succeeds(folder, &[&part[..], &[samples, "-o", file]].concat());
    }
    // The first fits, and not the second beside it.
    let merge = ["merge", "a.exr", "b.exr", "-o", "c.exr", "--memory"];
    fails(
        folder,
        &[&merge[..], &["8M"]].concat(),
        1,
        &["b.exr", "--memory"],
    );
    super::succeeds(folder, &[&merge[..], &["40M"]].concat());
}

#[cfg(target_os = "linux")]
#[test]
fn a_shells_limit_on_memory_is_kept_to() {
    let folder = tempfile::tempdir().unwrap();
    let sphere = "Shape(Sphere(radius: 1.0, segments: 4400, rings: 2160))";
    let text = format!(
        "(resources: {{\"glassbox::io::FileVersion\": (1)}}, entities: {{\
         1: (components: {{\"glassbox::scene::MeshSource\": {sphere}}})}})"
    );
    std::fs::write(folder.path().join("a.scn.ron"), text).unwrap();
    // Each thread maps a stack of its own, and memory to allocate from.
    let command =
        format!("ulimit -v 4000000; exec {PROGRAM} render a.scn.ron -o a.png --threads 2");
    let output = without_display("sh", folder.path())
        .args(["-c", &command])
        .env("MALLOC_ARENA_MAX", "2")
        .output()
        .unwrap();
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert_eq!(err.lines().count(), 1, "{err}");
    // Three quarters of 3.8 GB without what the program itself has mapped.
    let told = ["2.4", "2.5", "2.6", "2.7", "2.8"];
    let told = told.map(|size| format!("{size} GB that a scene may take"));
    assert!(told.iter().any(|told| err.contains(told)), "{err}");
}
