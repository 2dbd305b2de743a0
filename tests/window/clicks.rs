//! With the clicks and keys of another program, as a person's come: by the display.

use super::{Display, missing, until};
use crate::files::app::opened;
use bevy::camera::visibility::Visibility;
use bevy::ecs::name::Name;
use std::process::{Command, Stdio};

fn xdotool(display: &Display, arguments: &[&str]) -> Option<String> {
    let output = Command::new("xdotool")
        .args(arguments)
        .env("DISPLAY", &display.name)
        .output();
    let Ok(output) = output else {
        missing("xdotool is missing (Debian: xdotool)");
        return None;
    };
    Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

#[test]
fn a_click_selects_and_a_key_hides_what_is_selected() {
    let Some(display) = Display::open() else {
        return;
    };
    if xdotool(&display, &["version"]).is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // The editor stays when it has been played.
    let script = r#"[Wait(Samples(1)), Screenshot("ready.png")]"#;
    std::fs::write(folder.join("script.ron"), script).unwrap();
    let mut child = display
        .command_in(folder, &["env", "--default-signal=TERM"])
        .args(["cornell-box", "--script", "script.ron"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    until("the window", || {
        folder.join("ready.png").exists() || child.try_wait().unwrap().is_some()
    });
    let windows = xdotool(&display, &["search", "--name", "Glassbox"]).unwrap_or_default();
    let window = windows.lines().next().unwrap_or_default().to_owned();
    let title = || xdotool(&display, &["getwindowname", &window]).unwrap_or_default();
    assert!(!title().contains('*'), "{}", title());
    let place = |part: f32, whole: f32| format!("{}", (part * whole) as i32);
    // The short block stands right of the middle, below.
    let (x, y) = (place(0.53, 1280.0), place(0.68, 720.0));
    for arguments in [
        vec!["windowfocus", &window],
        vec!["mousemove", &x, &y],
        vec!["sleep", "1"],
        vec!["click", "1"],
        vec!["sleep", "1"],
        vec!["key", "h"],
    ] {
        xdotool(&display, &arguments);
    }
    until("an edit", || {
        title().contains('*') || child.try_wait().unwrap().is_some()
    });
    let _ = Command::new("kill").arg(child.id().to_string()).status();
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(143), "{err}");
    let copies = std::fs::read_dir(folder.join("settings/recovery")).unwrap();
    let mut copies = copies.map(|entry| entry.unwrap().path());
    let copy = copies.find(|path| path.to_string_lossy().ends_with(".scn.ron"));
    let (mut app, _) = opened(&copy.expect("a copy of the unsaved work"));
    let world = app.world_mut();
    let mut all = world.query::<(&Name, &Visibility)>();
    let hidden = all
        .iter(world)
        .filter(|(_, seen)| **seen == Visibility::Hidden);
    let hidden: Vec<&str> = hidden.map(|(name, _)| name.as_str()).collect();
    assert_eq!(hidden, ["Short block"]);
}
