//! The examples, which `cargo test` builds: each does what it says, in a window or without one.

use super::{Display, missing, until};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::SystemTime;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat};

/// The latest time at which a file below a folder was written.
fn written(folder: &Path) -> SystemTime {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    let times = entries.map(|entry| match entry.file_type().unwrap().is_dir() {
        true => written(&entry.path()),
        false => entry.metadata().unwrap().modified().unwrap(),
    });
    times.max().unwrap_or(SystemTime::UNIX_EPOCH)
}

/// Where cargo puts them, beside this test. `None`, said loudly, where it was not asked for them, now or since something was
/// written.
fn built(name: &str) -> Option<PathBuf> {
    let test = std::env::current_exe().unwrap();
    let profile = test.parent().and_then(Path::parent).unwrap();
    let example = profile.join("examples").join(name);
    if !example.exists() {
        missing(&format!("the example {name} is not built"));
        return None;
    }
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let own = package.join("examples").join(name).with_extension("rs");
    let own = own.metadata().unwrap().modified().unwrap();
    if example.metadata().unwrap().modified().unwrap() < written(&package.join("src")).max(own) {
        missing(&format!(
            "the example {name} is older than what it is built from"
        ));
        return None;
    }
    Some(example)
}

/// How many colours the screen shows.
fn colors(display: &str) -> usize {
    let (connection, screen) = x11rb::connect(Some(display)).unwrap();
    let screen = &connection.setup().roots[screen];
    let (width, height) = (screen.width_in_pixels, screen.height_in_pixels);
    let all = ImageFormat::Z_PIXMAP;
    let shown = connection.get_image(all, screen.root, 0, 0, width, height, u32::MAX);
    let shown = shown.unwrap().reply().unwrap().data;
    let pixels = shown.as_chunks::<4>().0;
    pixels.iter().collect::<HashSet<_>>().len()
}

#[test]
fn each_example_with_a_window_shows_a_picture() {
    let Some(display) = Display::open() else {
        return;
    };
    for name in [
        "embed",
        "split_screen",
        "reference_picture",
        "own_material",
        "embed_editor",
    ] {
        let Some(example) = built(name) else {
            return;
        };
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new(example);
        command
            .current_dir(folder.path())
            .env("GLASSBOX_CONFIG_DIR", folder.path().join("settings"))
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let mut running = display.show(command).spawn().unwrap();
        until(&format!("a picture of {name}"), || {
            assert_eq!(running.try_wait().unwrap(), None, "{name} has ended");
            // A window without a picture has a handful.
            colors(display.name()) > 200
        });
        // It goes on.
        std::thread::sleep(std::time::Duration::from_secs(1));
        assert_eq!(running.try_wait().unwrap(), None, "{name} has ended");
        running.kill().unwrap();
        running.wait().unwrap();
        until("an empty screen", || colors(display.name()) < 10);
    }
}

#[test]
fn each_example_without_a_window_writes_its_pictures() {
    let written = [
        ("plain_rust", vec!["plain.ppm".to_owned()]),
        (
            "headless_frames",
            (0..8).map(|frame| format!("frame-{frame}.png")).collect(),
        ),
    ];
    for (name, files) in written {
        let Some(example) = built(name) else {
            return;
        };
        let folder = tempfile::tempdir().unwrap();
        let output = Command::new(example).current_dir(folder.path()).output();
        let output = output.unwrap();
        let (_, err) = crate::cli::texts(&output);
        assert!(output.status.success(), "{name}: {err}");
        for file in files {
            assert!(folder.path().join(&file).exists(), "{name} wrote no {file}");
        }
    }
}
