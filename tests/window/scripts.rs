//! Scripts themselves: what is wrong in one, and a claim that does not hold.

use super::Display;
use super::pictures::Shot;
use crate::cli::texts;

#[test]
fn an_unknown_step_is_named_with_its_file_and_line() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let output = display.play(folder.path(), &[], "[\n  Wait(Frames(1)),\n  Jump(3),\n]");
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("script.ron:3: "), "{err}");
    assert!(err.contains("Jump"), "{err}");
}

#[test]
fn a_claim_that_does_not_hold_says_what_was_found() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    // A few frames first: ended in its first, the software driver may still be compiling, and crash.
    let script = r#"[
        Wait(Frames(5)),
        Assert(path: "RenderSettings.spp", is: 16),
        Assert(of: Some("Lamp"), path: "PointLamp.intensity", is: 0.5, within: 0.1),
    ]"#;
    let output = display.play(folder.path(), &["cornell-box"], script);
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(
        err.contains("script.ron:4: Lamp's PointLamp.intensity is 0.25999")
            && err.contains("0.5 ± 0.1"),
        "{err}"
    );
}

#[test]
fn the_scripts_that_come_with_glassbox_are_understood() {
    let mut read = 0;
    let tests = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/window/gizmos");
    let folders = [super::assets(), tests].map(|folder| std::fs::read_dir(folder).unwrap());
    for entry in folders.into_iter().flatten() {
        let path = entry.unwrap().path();
        let name = path.to_string_lossy();
        if !name.ends_with(".ron") || name.ends_with(".scn.ron") {
            continue;
        }
        if let Err(error) = glassbox::editor::Script::read(&path) {
            panic!("{error}");
        }
        read += 1;
    }
    assert!(read >= 5, "there are {read}");
}

/// What is clicked, run, opened and written there has to be there, whatever it looks like.
#[test]
fn the_scripts_of_the_pictures_play_to_their_ends() {
    let Some(display) = Display::open() else {
        return;
    };
    for (name, pictures) in [
        ("readme.ron", &["editor.png", "editor-split.png"][..]),
        (
            "tutorial.ron",
            &[
                "tutorial-black.png",
                "tutorial-tree.png",
                "tutorial-noise.png",
            ],
        ),
    ] {
        let script = std::fs::read_to_string(super::assets().join(name)).unwrap();
        // Whole pictures take minutes of a software driver's machine.
        let quick = script.replace("Wait(Samples(1e9))", "Wait(Samples(1))");
        assert_ne!(script, quick, "{name} waits for no picture");
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("assets")).unwrap();
        display.plays(folder.path(), &["cornell-box"], &quick);
        for picture in pictures {
            let picture = folder.path().join("assets").join(picture);
            assert_eq!(Shot::open(&picture).size(), [1280, 720], "{name}");
        }
    }
}

#[test]
fn a_size_that_no_window_can_have_is_named_with_its_line() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let output = display.play(folder.path(), &[], "[\n  Size(65000, 65000),\n  Quit,\n]");
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert_eq!(err.lines().count(), 1, "{err}");
    assert!(err.contains("script.ron:2: Size(65000, 65000)"), "{err}");
}

#[cfg(unix)]
#[test]
fn who_is_asked_to_end_keeps_unsaved_work_and_a_script_that_quits_leaves_none() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let edit = "Wait(Frames(5)), Set(of: Some(\"Lamp\"), path: \"PointLamp.intensity\", to: 0.5)";
    let copies = || {
        let kept = std::fs::read_dir(folder.join("settings/recovery"));
        let kept = kept.into_iter().flatten().flatten();
        let names = kept.map(|entry| entry.file_name().to_string_lossy().into_owned());
        names.filter(|name| name.ends_with(".scn.ron")).count()
    };
    display.plays(folder, &["cornell-box"], &format!("[{edit}, Quit]"));
    assert_eq!(copies(), 0, "given up by the script");

    let script = folder.join("script.ron");
    std::fs::write(&script, format!("[{edit}, Screenshot(\"done.png\")]")).unwrap();
    let signals = [("INT", 130), ("TERM", 143), ("HUP", 129)];
    for (kept, (signal, code)) in signals.into_iter().enumerate() {
        // What runs in the background of a shell has it ignored, and hands that on.
        let mut command =
            display.command_in(folder, &["env", &format!("--default-signal={signal}")]);
        command.args(["cornell-box", "--script"]).arg(&script);
        let mut editor = command.spawn().unwrap();
        let start = std::time::Instant::now();
        while !folder.join("done.png").exists() {
            assert!(start.elapsed() < super::PATIENCE, "there was no picture");
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        let killed = std::process::Command::new("kill")
            .args([&format!("-{signal}"), &editor.id().to_string()])
            .status();
        assert!(killed.unwrap().success());
        let start = std::time::Instant::now();
        let status = loop {
            if let Some(status) = editor.try_wait().unwrap() {
                break status;
            }
            if start.elapsed() > std::time::Duration::from_secs(60) {
                let _ = editor.kill();
                panic!("SIG{signal} did not end the editor");
            }
            std::thread::sleep(std::time::Duration::from_millis(100));
        };
        assert_eq!(status.code(), Some(code), "SIG{signal}");
        assert_eq!(copies(), kept + 1, "SIG{signal} is nobody's consent");
        std::fs::remove_file(folder.join("done.png")).unwrap();
    }
}
