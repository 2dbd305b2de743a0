//! What the fuzz targets and the mutation tests call: one file, read as the program reads it.

use bevy::app::App;
use glassbox::app::headless_app;
use glassbox::io::{Limits, OpenOptions, SceneSource, open};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::RefCell;
use std::fs;
use std::path::Path;

thread_local! {
    /// One for all files, as in the editor: what is opened takes the place of what was open. Making an app
    /// takes longer than reading any file.
    static APP: RefCell<App> = RefCell::new(headless_app());
    /// This thread alone: handing such small work to another takes longer than doing it, where other programs want the
    /// same cores some hundred times as long.
    static POOL: ThreadPool = ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build()
        .expect("a pool without threads of its own");
}

/// The kinds of files that are read, by the names of their targets: the file that is opened, and the one that gets the
/// bytes.
pub const KINDS: [(&str, &str, &str); 8] = [
    ("obj", "a.obj", "a.obj"),
    ("mtl", "a.obj", "a.mtl"),
    ("gltf", "a.gltf", "a.gltf"),
    ("glb", "a.glb", "a.glb"),
    ("stl", "a.stl", "a.stl"),
    ("ply", "a.ply", "a.ply"),
    ("scene", "a.scn.ron", "a.scn.ron"),
    ("picture", "a.obj", "a.picture"),
];

/// An MTL file that uses the picture under test as colours and as numbers.
const WITH_PICTURE: &str = "newmtl a\nmap_Kd a.picture\nmap_d a.picture\n";

/// An OBJ file that reads the MTL file under test.
const WITH_MATERIAL: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";

/// Reads the bytes as a file of that kind in `folder`, and what was opened once through to the tracer's world. Whatever
/// they are, nothing may panic; an error is one line. True where they could be opened.
pub fn read(kind: &str, bytes: &[u8], folder: &Path) -> bool {
    let known = KINDS.iter().find(|(name, ..)| *name == kind);
    let (_, opened, written) = known.expect("one of the kinds");
    if kind == "picture" {
        fs::write(folder.join("a.mtl"), WITH_PICTURE).expect("a folder that can be written to");
    }
    if opened != written {
        fs::write(folder.join(opened), WITH_MATERIAL).expect("a folder that can be written to");
    }
    fs::write(folder.join(written), bytes).expect("a folder that can be written to");
    // So that what is found are faults, and not how large a file may be.
    let options = OpenOptions {
        allow_outside: false,
        limits: Limits {
            vertices: 1 << 16,
            triangles: 1 << 16,
            pixels: 1 << 16,
            entities: 1 << 10,
            ..Limits::default()
        },
        ..OpenOptions::default()
    };
    let source = SceneSource::File(folder.join(opened));
    POOL.with(|pool| pool.install(|| open_in_the_app(&source, options)))
}

fn open_in_the_app(source: &SceneSource, options: OpenOptions) -> bool {
    APP.with_borrow_mut(|app| match open(app.world_mut(), source, options) {
        Ok(_) => {
            app.update();
            true
        }
        Err(error) => {
            let lines = error.to_string().lines().count();
            assert_eq!(lines, 1, "an error of several lines: {error}");
            false
        }
    })
}
