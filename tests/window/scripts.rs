//! Scripts themselves: what is wrong in one, and a claim that does not hold.

use super::Display;
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
