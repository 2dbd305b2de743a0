//! No command writes over what it reads, by whatever name.

use super::{files, glassbox, succeeds, texts};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The content of every file in a folder.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = files(folder).into_iter();
    names
        .filter(|name| folder.join(name).is_file())
        .map(|name| (name.clone(), fs::read(folder.join(name)).unwrap()))
        .collect()
}

/// Runs the program, and expects that it refuses in one line, soon, and changes nothing.
fn refuses(folder: &Path, arguments: &str, parts: &[&str]) {
    let before = contents(folder);
    let output = glassbox(folder, &arguments.split(' ').collect::<Vec<_>>());
    let (out, err) = texts(&output);
    let what = format!("{arguments}\nstdout: {out}\nstderr: {err}");
    assert_eq!(output.status.code(), Some(1), "{what}");
    let errors: Vec<&str> = err
        .lines()
        .filter(|line| line.starts_with("error: "))
        .collect();
    assert_eq!(errors.len(), 1, "{what}");
    for part in ["same file"].iter().chain(parts) {
        assert!(errors[0].contains(part), "`{part}` is missing\n{what}");
    }
    let after = contents(folder);
    let changed: Vec<&String> = after
        .iter()
        .filter(|(name, content)| before.get(*name) != Some(content))
        .map(|(name, _)| name)
        .collect();
    assert!(changed.is_empty(), "{changed:?} changed\n{what}");
    assert_eq!(before.len(), after.len(), "{what}");
}

/// A scene whose mesh is an OBJ with an MTL and a texture: `a.scn.ron`, `two.obj`, `two.mtl`, `tex.png`.
fn scene(folder: &Path) {
    let pixels = [[0.5; 3], [1.0; 3]];
    glassbox::io::write_picture(&folder.join("tex.png"), 2, 1, &pixels).unwrap();
    fs::write(folder.join("two.mtl"), "newmtl one\nmap_Kd tex.png\n").unwrap();
    let obj = "mtllib two.mtl\no first\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl one\n\
               f 1/1 2/2 3/3\no second\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 4/1 5/2 6/3\n";
    fs::write(folder.join("two.obj"), obj).unwrap();
    succeeds(folder, &["convert", "two.obj", "a.scn.ron", "--quiet"]);
}

#[test]
fn a_scene_is_not_converted_onto_what_it_reads() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    scene(folder);
    refuses(folder, "convert a.scn.ron two.obj", &["two.obj", "read"]);
    refuses(folder, "convert two.obj two.obj", &["two.obj"]);
    refuses(folder, "convert a.scn.ron a.scn.ron", &["a.scn.ron"]);
    // The materials that would be written beside it.
    fs::rename(folder.join("two.obj"), folder.join("mesh.obj")).unwrap();
    refuses(folder, "convert mesh.obj two.obj", &["two.mtl"]);
    succeeds(folder, &["convert", "mesh.obj", "other.obj", "--quiet"]);
    // What a glTF file brings along.
    succeeds(folder, &["convert", "mesh.obj", "b.glb", "--quiet"]);
    refuses(folder, "convert b.glb b.glb", &["b.glb"]);
}

#[test]
fn a_picture_is_not_rendered_onto_what_the_scene_reads() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    scene(folder);
    let small = "--size 8x8 --spp 1";
    for (outputs, over) in [
        ("-o tex.png", "tex.png"),
        ("-o ./tex.png", "tex.png"),
        ("-o b.png --stats a.scn.ron", "a.scn.ron"),
        ("-o b.png --stats two.obj", "two.obj"),
        ("-o b.png --stats two.mtl", "two.mtl"),
        ("-o b.png --stats b.png", "b.png"),
        ("-o tex.png --view normal", "tex.png"),
        ("--all-cameras -o b.png --stats b.png", "b.png"),
    ] {
        refuses(
            folder,
            &format!("render a.scn.ron {small} {outputs}"),
            &[over],
        );
    }
    refuses(
        folder,
        "inspect a.scn.ron --size 8x8 --picture tex.png",
        &["tex.png"],
    );
    succeeds(
        folder,
        &["render", "a.scn.ron", "--size", "8x8", "-o", "b.png"],
    );
}

#[cfg(unix)]
#[test]
fn links_are_the_file_that_they_lead_to() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    scene(folder);
    symlink("tex.png", folder.join("soft.png")).unwrap();
    fs::hard_link(folder.join("tex.png"), folder.join("hard.png")).unwrap();
    symlink("two.obj", folder.join("mesh.glb")).unwrap();
    symlink("two.obj", folder.join("scene.scn.ron")).unwrap();
    symlink("new.png", folder.join("first.png")).unwrap();
    symlink("new.png", folder.join("second.png")).unwrap();
    for name in ["soft.png", "hard.png"] {
        refuses(
            folder,
            &format!("render a.scn.ron --size 8x8 -o {name}"),
            &["tex.png"],
        );
    }
    refuses(folder, "convert a.scn.ron mesh.glb", &["two.obj"]);
    refuses(folder, "convert a.scn.ron scene.scn.ron", &["two.obj"]);
    refuses(
        folder,
        "render a.scn.ron --size 8x8 -o first.png --stats second.png",
        &["first.png"],
    );
}

#[test]
fn parts_are_not_merged_onto_one_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (samples, file) in [("0..2", "a.exr"), ("2..4", "b.exr")] {
        let how = ["--size", "8x8", "--samples", samples, "-o", file, "--quiet"];
        succeeds(folder, &[&["render", "triangle"][..], &how].concat());
    }
    refuses(folder, "merge a.exr b.exr -o b.exr", &["b.exr"]);
    refuses(folder, "merge a.exr b.exr -o ./a.exr", &["a.exr"]);
    succeeds(folder, &["merge", "a.exr", "b.exr", "-o", "c.exr"]);
}

#[test]
fn a_report_is_not_written_onto_what_it_is_made_from() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    scene(folder);
    let figures = "scene,edit\nknot,mesh swap\n";
    fs::write(folder.join("editing.csv"), figures).unwrap();
    let start = std::time::Instant::now();
    refuses(
        folder,
        "report sampling triangle --quick --editing editing.csv -o .",
        &["editing.csv"],
    );
    let mtl = fs::read_to_string(folder.join("two.mtl")).unwrap();
    let mtl = mtl.replace("tex.png", "sampling-one.png");
    fs::write(folder.join("two.mtl"), mtl).unwrap();
    fs::rename(folder.join("tex.png"), folder.join("sampling-one.png")).unwrap();
    refuses(
        folder,
        "report sampling two.obj --quick -o .",
        &["sampling-one.png"],
    );
    let seconds = start.elapsed().as_secs();
    assert!(seconds < 60, "it was measured for {seconds} s first");
}
