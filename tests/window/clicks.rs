//! With the clicks and keys of another program, as a person's come: by the display.

use super::pictures::Shot;
use super::{Display, missing, until};
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
fn a_click_selects_a_key_undoes_and_the_window_closes() {
    let Some(display) = Display::open() else {
        return;
    };
    if xdotool(&display, &["version"]).is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    // Waits for the clicks, and then says what came of them.
    let script = r#"[
        Wait(Samples(1)),
        Screenshot("ready.png"),
        Wait(Seconds(20)),
        Selected(["Short block"]),
        Assert(of: Some("Short block"), path: "Visibility", is: "Hidden"),
        Screenshot("hidden.png"),
        Quit,
    ]"#;
    std::fs::write(folder.path().join("script.ron"), script).unwrap();
    let mut child = display
        .command(folder.path())
        .args(["cornell-box", "--script", "script.ron"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    until("the window", || {
        folder.path().join("ready.png").exists() || child.try_wait().unwrap().is_some()
    });
    let windows = xdotool(&display, &["search", "--name", "Glassbox"]).unwrap_or_default();
    let window = windows.lines().next().unwrap_or_default().to_owned();
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
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{err}");
    let [ready, hidden] =
        ["ready.png", "hidden.png"].map(|name| Shot::open(&folder.path().join(name)));
    let area = [0.45, 0.5, 0.6, 0.8];
    let changed = ready.difference(&hidden, area);
    assert!(
        changed > 2.0,
        "hidden, and the picture changed by {changed}"
    );
}
