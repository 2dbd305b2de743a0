//! A disk that has no room left.

use super::says;
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
