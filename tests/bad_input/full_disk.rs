//! A disk that has no room left.

use super::says;
use crate::cli::{glassbox, texts};
use crate::files::app::app;
use glassbox::io::{OpenOptions, SceneSource, open, save};
use glassbox::scene::PointLamp;
use std::fs;
use std::process::Command;
use tempfile::TempDir;

/// Of 64 kB; gone with this.
struct SmallDisk(TempDir);

impl SmallDisk {
    /// `None` where this user may not have one.
    fn new() -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"]);
        let mounted = mount.arg(folder.path()).output();
        if mounted.is_ok_and(|output| output.status.success()) {
            return Some(Self(folder));
        }
        println!("left out: no disk can be mounted here");
        None
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).status();
    }
}

#[test]
fn a_disk_without_room_is_named_with_what_is_free_and_the_old_files_stay() {
    let Some(disk) = SmallDisk::new() else {
        return;
    };
    let at = |name: &str| disk.0.path().join(name);
    let mut small = app();
    let source = SceneSource::named("triangle");
    open(small.world_mut(), &source, OpenOptions::default()).unwrap();
    for name in ["a.scn.ron", "a.obj", "a.glb"] {
        save(small.world_mut(), &at(name)).unwrap();
    }
    fs::write(at("full"), vec![0; 36 << 10]).unwrap();
    let names = ["a.glb", "a.mtl", "a.obj", "a.scn.ron", "full"];
    let read = || names.map(|name| fs::read(at(name)).unwrap());
    let before = read();
    let mut large = app();
    let source = SceneSource::named("spheres");
    open(large.world_mut(), &source, OpenOptions::default()).unwrap();
    for _ in 0..1000 {
        large.world_mut().spawn(PointLamp::default());
    }
    for (name, parts) in [
        ("a.scn.ron", ["a.scn.ron: needs", "kB are free on its disk"]),
        ("a.glb", ["a.glb: needs", "kB are free on its disk"]),
        // Of its pictures, its materials or its own: how long they become is known when they are written.
        ("a.obj", ["cannot be written", "No space left"]),
    ] {
        let error = save(large.world_mut(), &at(name)).unwrap_err();
        says(&error, &parts);
        assert!(read() == before, "{name}: an old file has changed");
        assert_eq!(crate::cli::files(disk.0.path()), names, "{name}");
    }
}

#[test]
fn a_picture_for_which_the_disk_is_too_full_is_refused_before_a_ray_is_traced_or_its_doubt_is_told()
{
    let Some(disk) = SmallDisk::new() else {
        return;
    };
    // Samples without an end: whoever begins to trace is not done in the time of a test.
    let endless = "render triangle --spp 1048576 --size";
    for command in [
        format!("{endless} 1600x1600 -o a.png"),
        format!("{endless} 1600x1600 -o a.jpg"),
        format!("{endless} 1600x1600 -o a.hdr"),
        format!("{endless} 800x800 -o a.exr"),
        // What fits once does not fit with a layer for each light, for each camera or with exact sums.
        format!("{endless} 250x250 --lights-separately -o a.exr"),
        "render showcase --size 250x250 --spp 1048576 --all-cameras -o a.exr".into(),
        "render triangle --size 250x250 --samples 0..1048576 -o a.exr".into(),
        "report stability -o r".into(),
    ] {
        let words: Vec<&str> = command.split(' ').collect();
        let output = glassbox(disk.0.path(), &words);
        let (_, err) = texts(&output);
        assert_eq!(output.status.code(), Some(1), "{command}: {err}");
        let says = err.contains("may take up to") && err.contains("kB are free on its disk");
        assert!(says, "{command}: {err}");
        let left = crate::cli::files(disk.0.path());
        assert!(left.is_empty(), "{command}: {left:?}");
    }
    let command = [
        "render", "triangle", "--size", "200x200", "--spp", "1", "-o", "a.png",
    ];
    let output = glassbox(disk.0.path(), &command);
    let (_, err) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{err}");
    let says = err.contains("warning: a.png: may take up to 117 kB, and 64 kB are free");
    assert!(says, "{err}");
    let command = [
        "render", "triangle", "--size", "100x100", "--spp", "1", "-o", "b.png",
    ];
    let (_, err) = texts(&glassbox(disk.0.path(), &command));
    assert!(!err.contains("b.png: may take"), "{err}");
}
