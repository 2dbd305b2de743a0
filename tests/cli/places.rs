//! What stands where a file is written stays what it is.

use super::{PROGRAM, files, succeeds, texts, without_display};
use std::fs;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;

/// A device of the test's own where that can be had: nobody else's shall be at stake.
fn null_device(folder: &Path) -> String {
    let own = folder.join("null");
    let made = Command::new("mknod")
        .arg(&own)
        .args(["c", "1", "3"])
        .output();
    match made.is_ok_and(|made| made.status.success()) {
        true => own.display().to_string(),
        false => "/dev/null".into(),
    }
}

/// Renders eight by eight pixels.
fn render(folder: &Path, more: &[&str]) -> String {
    let what = ["render", "triangle", "--size", "8x8", "--quiet"];
    succeeds(folder, &[&what[..], more].concat())
}

#[test]
fn statistics_go_into_devices_and_pipes_and_these_stay() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let device = null_device(folder);
    render(folder, &["-o", "a.png", "--stats", &device]);
    let kind = fs::symlink_metadata(&device).unwrap().file_type();
    assert!(kind.is_char_device(), "{device} has become {kind:?}");
    let said = render(folder, &["-o", "a.png", "--stats", "/dev/stdout"]);
    assert!(said.contains("\"triangles\""), "{said}");
    let pipe = folder.join("pipe.exr");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let from = pipe.clone();
    let reader = std::thread::spawn(move || fs::read(from).unwrap());
    render(folder, &["-o", "pipe.exr"]);
    let bytes = reader.join().unwrap();
    let picture = image::load_from_memory_with_format(&bytes, image::ImageFormat::OpenExr);
    assert_eq!(picture.unwrap().width(), 8);
    assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
}

#[test]
fn mode_and_links_stay_in_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("there")).unwrap();
    let commands: [(&str, &[&str]); 4] = [
        ("a.png", &["render", "triangle", "--size", "8x8", "-o"]),
        ("a.scn.ron", &["convert", "triangle"]),
        ("a.glb", &["convert", "triangle"]),
        ("a.obj", &["convert", "triangle"]),
    ];
    for (name, command) in commands {
        let (there, link) = (folder.join("there").join(name), folder.join(name));
        fs::write(&there, "old").unwrap();
        fs::set_permissions(&there, fs::Permissions::from_mode(0o600)).unwrap();
        symlink(&there, &link).unwrap();
        let second = folder.join("there").join(format!("second-{name}"));
        for names in 1..=2 {
            succeeds(folder, &[command, &[name]].concat());
            let kind = fs::symlink_metadata(&link).unwrap().file_type();
            assert!(kind.is_symlink(), "{name}: the link has become {kind:?}");
            let now = fs::metadata(&there).unwrap();
            assert_eq!(now.mode() & 0o777, 0o600, "{name}: {:o}", now.mode());
            assert_eq!(now.nlink(), names, "{name}");
            assert_ne!(fs::read(&there).unwrap(), b"old", "{name}");
            if names == 1 {
                fs::write(&there, "old").unwrap();
                fs::hard_link(&there, &second).unwrap();
            } else {
                assert_ne!(fs::read(&second).unwrap(), b"old", "{name}");
            }
        }
    }
}

#[test]
fn a_name_of_255_bytes_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let name = format!("{}.png", "n".repeat(251));
    render(folder.path(), &["-o", &name]);
    assert_eq!(files(folder.path()), [name]);
}

#[test]
fn a_file_that_is_larger_than_the_system_allows_is_told_in_a_line_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("a.glb"), "old").unwrap();
    for command in [
        "convert head a.glb",
        "convert head b.obj",
        "render triangle --size 600x600 --spp 1 -o c.hdr",
        "render triangle --size 600x600 --samples 0..1 -o d.exr",
    ] {
        // Blocks of 512 or of 1024 bytes.
        let limited = format!("ulimit -f 16; exec {PROGRAM} {command}");
        let output = without_display("sh", folder)
            .args(["-c", &limited])
            .output()
            .unwrap();
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(1), "{command}: {err}");
        let line = err.lines().find(|line| line.starts_with("error: "));
        let says = line.is_some_and(|line| line.contains("ulimit -f"));
        assert!(says, "{command}: {err}");
        assert_eq!(files(folder), ["a.glb"], "{command}");
    }
    assert_eq!(fs::read(folder.join("a.glb")).unwrap(), b"old");
}
