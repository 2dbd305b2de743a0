//! Starting where there is no display, one that does not answer, or nothing to draw with.

use super::{Display, finish};
use crate::cli::{PROGRAM, files, texts, without_display};
use std::process::Command;

fn says_so_and_renders(mut command: Command, folder: &std::path::Path, named: &str) {
    let output = finish({
        command.arg("triangle");
        command
    });
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{err}");
    let first = err.lines().next().unwrap_or_default();
    assert!(first.starts_with("note: no window: "), "{err}");
    assert!(first.contains(named), "{err}");
    assert!(first.contains("glassbox render"), "{err}");
    assert!(!err.contains("panicked"), "{err}");
    assert_eq!(files(folder), ["triangle.png"]);
}

#[test]
fn without_a_display_the_scene_is_rendered_to_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let command = without_display(PROGRAM, folder.path());
    says_so_and_renders(command, folder.path(), "DISPLAY is not set");
}

#[test]
fn a_display_that_does_not_answer_is_none() {
    let folder = tempfile::tempdir().unwrap();
    for display in [":4711", "nonsense", "localhost:4711"] {
        let mut command = without_display(PROGRAM, folder.path());
        command.env("DISPLAY", display);
        says_so_and_renders(command, folder.path(), display);
    }
}

#[test]
fn a_script_needs_a_window_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.ron"), "[Quit]").unwrap();
    let mut command = without_display(PROGRAM, folder.path());
    let output = finish({
        command.args(["--script", "s.ron"]);
        command
    });
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.starts_with("error: no window: "), "{err}");
    assert_eq!(err.lines().count(), 1, "{err}");
}

#[test]
fn a_display_without_a_graphics_adapter_is_an_error_that_names_what_to_install() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let mut command = display.command(folder.path());
    // The loader of Vulkan finds no driver then.
    let output = finish({
        command
            .env("VK_ICD_FILENAMES", "/nonexistent")
            .env("VK_DRIVER_FILES", "/nonexistent");
        command
    });
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert_eq!(err.lines().count(), 1, "{err}");
    assert!(err.starts_with("error: no graphics adapter"), "{err}");
    assert!(err.contains("mesa-vulkan-drivers"), "{err}");
}
