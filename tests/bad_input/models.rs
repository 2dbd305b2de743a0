use super::{opens_and_says, refused, refused_with, says};
use crate::files::app::{opened, write};
use glassbox::io::{OpenOptions, Problem};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// A folder with an OBJ of three vertices and then these lines.
fn obj(lines: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "model.obj", format!("{TRIANGLE}{lines}"));
    (folder, file)
}

/// A folder with an MTL of these lines behind a triangle.
fn mtl(lines: &str) -> (TempDir, PathBuf) {
    let (folder, file) = obj("mtllib model.mtl\nusemtl a\nf 1 2 3\n");
    write(folder.path(), "model.mtl", lines);
    (folder, file)
}

#[test]
fn a_missing_file() {
    let folder = tempfile::tempdir().unwrap();
    says(
        &refused(&folder.path().join("gone.obj")),
        &["gone.obj", "no such file"],
    );
}

#[test]
fn a_name_that_is_neither_a_file_nor_a_built_in_scene() {
    let error = refused("cornell-bocks".as_ref());
    says(&error, &["cornell-bocks", "built-in", "cornell-box"]);
}

#[test]
fn a_folder_instead_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.obj");
    fs::create_dir(&file).unwrap();
    says(&refused(&file), &["model.obj", "is a folder"]);
}

#[test]
fn an_unknown_extension() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "model.fbx", "x");
    says(&refused(&file), &["model.fbx", "`fbx`", ".obj"]);
}

#[test]
fn an_empty_file() {
    let folder = tempfile::tempdir().unwrap();
    says(
        &refused(&write(folder.path(), "a.obj", "")),
        &["a.obj", "is empty"],
    );
}

#[test]
fn a_packed_file_is_called_so_whatever_its_name_says() {
    let folder = tempfile::tempdir().unwrap();
    let gzip = b"\x1f\x8b\x08\0\0\0\0\0\0\x03".as_slice();
    let zip = b"PK\x03\x04\x14\0\0\0".as_slice();
    for (bytes, format) in [(gzip, "gzip"), (zip, "zip")] {
        for name in ["a.obj", "a.ply", "a.stl", "a.gltf", "a.glb", "a.scn.ron"] {
            let file = write(folder.path(), name, bytes);
            says(&refused(&file), &[name, format, "unpack it"]);
        }
    }
}

#[test]
fn a_web_page_or_a_pointer_in_place_of_a_file_is_called_so() {
    let folder = tempfile::tempdir().unwrap();
    for (text, kind) in [
        ("<!DOCTYPE html>\n<html></html>\n", "web page"),
        ("<HTML><body>404</body></HTML>", "web page"),
        (
            "version https://git-lfs.github.com/spec/v1\noid sha256:0\n",
            "Git LFS",
        ),
    ] {
        for name in ["a.obj", "a.ply", "a.stl", "a.gltf", "a.glb", "a.scn.ron"] {
            let file = write(folder.path(), name, text);
            says(&refused(&file), &[name, kind, "get the file itself"]);
        }
        let (folder, file) = mtl("newmtl a\nmap_Kd a.png\n");
        write(folder.path(), "a.png", text);
        assert_eq!(opens_and_says(&file, &["a.png", kind]), 1);
    }
}

/// Bytes without an order, always the same.
fn noise(count: usize) -> Vec<u8> {
    let mut state = 1_u32;
    let next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    std::iter::repeat_with(next).take(count).collect()
}

#[test]
fn noise_zeros_and_utf_16_are_refused_as_what_they_are_by_their_first_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let noise = noise(1 << 20);
    let zeros = vec![0; 1 << 20];
    let wide: Vec<u8> = "{(ply\n"
        .repeat(99)
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let marked = [&[0xff, 0xfe][..], &wide].concat();
    for (bytes, name, told) in [
        (&noise, "a.glb", "begins neither with `glTF`"),
        (&noise, "a.gltf", "begins neither with `glTF`"),
        (&noise, "a.obj", "is no text"),
        (&noise, "a.ply", "is no text"),
        (&noise, "a.scn.ron", "is no text"),
        (&zeros, "a.glb", "zeros"),
        (&zeros, "a.gltf", "zeros"),
        (&zeros, "a.obj", "zeros"),
        (&zeros, "a.ply", "zeros"),
        (&zeros, "a.stl", "zeros"),
        (&zeros, "a.scn.ron", "zeros"),
        (&wide, "a.glb", "UTF-16"),
        (&wide, "a.gltf", "UTF-16"),
        (&wide, "a.ply", "UTF-16"),
        (&wide, "a.scn.ron", "UTF-16"),
        (&marked, "a.gltf", "UTF-16"),
        (&marked, "a.scn.ron", "UTF-16"),
    ] {
        let file = write(folder.path(), name, bytes);
        says(&refused(&file), &[name, told]);
    }
    for (bytes, told) in [(&noise, "is no text"), (&zeros, "zeros")] {
        let (folder, file) = mtl("");
        write(folder.path(), "model.mtl", bytes);
        assert_eq!(opens_and_says(&file, &["model.mtl", told]), 1);
    }
}

#[test]
fn a_glb_that_holds_json_is_read_whatever_stands_before_it_as_before_other_text() {
    let json = r#"{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"buffers":[{"byteLength":36,"uri":"DATA"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]}"#;
    let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let json = json.replace("DATA", &format!("data:;base64,{data}"));
    let folder = tempfile::tempdir().unwrap();
    for before in ["", "\u{feff}", "\r\n\t ", &" ".repeat(1 << 17)] {
        let file = write(folder.path(), "a.glb", format!("{before}{json}"));
        let (mut app, _) = opened(&file);
        assert_eq!(crate::files::models::objects(app.world_mut()).len(), 1);
    }
}

#[test]
fn an_obj_without_triangles() {
    let (_folder, file) = obj("# nothing else\n");
    says(&refused(&file), &["model.obj", "no triangles"]);
}

#[test]
fn an_obj_that_is_something_else() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "a.obj", [0xff_u8, 0xd8, 0, 10, 1, 2, 3]);
    says(&refused(&file), &["a.obj", "no triangles"]);
}

/// What is wrong with an OBJ whose only face cannot be shown, and the same where another face can.
fn refused_alone_and_noted_beside_others(lines: &str, refusal: &[&str], note: &[&str]) {
    let (_folder, file) = obj(lines);
    says(&refused(&file), refusal);
    let (_folder, file) = obj(&format!("f 3 2 1\n{lines}"));
    assert_eq!(opens_and_says(&file, note), 1, "{lines}");
}

#[test]
fn an_obj_that_ends_inside_a_face() {
    refused_alone_and_noted_beside_others(
        "f 1 2",
        &["model.obj:4", "3 corners and has 2"],
        &["model.obj:5", "fewer than 3 corners; left out"],
    );
}

#[test]
fn an_obj_that_ends_inside_a_vertex() {
    let (_folder, file) = obj("f 1 2 3\nv 0.5 0.");
    let note = ["model.obj:5", "3 numbers and has 2"];
    assert_eq!(opens_and_says(&file, &note), 1);
}

#[test]
fn a_face_index_out_of_range() {
    refused_alone_and_noted_beside_others(
        "f 1 2 4\n",
        &["model.obj:4", "vertex 4", "there are 3"],
        &["model.obj:5", "a vertex that there is not; left out"],
    );
}

#[test]
fn a_face_may_name_vertices_that_come_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "a.obj", format!("f 1 2 3\n{TRIANGLE}"));
    let (mut app, _) = opened(&file);
    let objects = crate::files::models::objects(app.world_mut());
    assert_eq!(objects[0].2.len(), 1);
}

#[test]
fn a_face_corner_that_is_no_index_counts_back_too_far_or_has_too_many_digits() {
    for (corner, problem) in [
        ("0", "vertex 0"),
        ("-4", "vertex -4"),
        ("three", "`three`"),
        ("99999999999999999999", "99999999999999999999 is used"),
        ("-99999999999999999999", "-99999999999999999999 is used"),
        ("1/1/1/1", "`1/1/1/1`"),
    ] {
        refused_alone_and_noted_beside_others(
            &format!("f 1 2 {corner}\n"),
            &["model.obj:4", problem],
            &["model.obj:5", "corner", "left out"],
        );
    }
}

#[test]
fn a_corner_whose_normal_or_texture_coordinate_there_is_not_is_read_without() {
    for (corner, what) in [
        ("3//2", "normal"),
        ("3//-2", "normal"),
        ("3//+6148914691236517206", "normal"),
        ("3/2", "texture coordinate"),
        ("3/-2", "texture coordinate"),
        ("3/-9223372036854775808", "texture coordinate"),
    ] {
        let (_folder, file) = obj(&format!("vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 {corner}\n"));
        let note = ["model.obj:6", &format!("names a {what} that there is not")];
        assert_eq!(opens_and_says(&file, &note), 1, "{corner}");
    }
    let (_folder, file) = obj("l 1 2//-1\nf 1 2 3\n");
    assert_eq!(
        opens_and_says(&file, &["model.obj:4", "lines and points"]),
        1
    );
}

#[test]
fn a_vertex_that_is_not_a_number() {
    for (vertex, problem) in [
        ("NaN 0 0", "`NaN` is not a finite number"),
        ("0 -inf 0", "`-inf` is not a finite number"),
        ("0 zero 0", "`zero` is not a number"),
        ("0 0 0 0", "w = 0"),
    ] {
        refused_alone_and_noted_beside_others(
            &format!("v {vertex}\nf 1 2 4\n"),
            &["model.obj:4", problem],
            &[
                "model.obj:5",
                "a vertex",
                "left out with the faces that use it",
            ],
        );
    }
}

#[test]
fn a_missing_mtl() {
    let (_folder, file) = obj("mtllib gone.mtl\nf 1 2 3\n");
    let note = ["model.obj:4", "no MTL file `gone.mtl`", "default"];
    assert_eq!(opens_and_says(&file, &note), 1);
}

#[test]
fn a_material_that_no_mtl_defines() {
    let (folder, file) = obj("mtllib a.mtl\nusemtl gold\nf 1 2 3\n");
    write(folder.path(), "a.mtl", "newmtl silver\n");
    let note = ["model.obj:5", "`gold`", "the default material is used"];
    assert_eq!(opens_and_says(&file, &note), 1);
}

#[test]
fn a_texture_that_is_missing_no_picture_or_none_that_is_read() {
    let (folder, file) = mtl("newmtl a\nmap_Kd -s 1 1 1 wood.png\n");
    let note = [
        "model.mtl:2",
        "no picture `wood.png`",
        "its material has none",
    ];
    assert_eq!(opens_and_says(&file, &note), 1);
    write(folder.path(), "wood.png", "this is text");
    let note = ["wood.png", "not a picture", "have no picture there"];
    assert_eq!(opens_and_says(&file, &note), 1);
    let (folder, file) = mtl("newmtl a\nmap_Kd wood.tga\n");
    write(folder.path(), "wood.tga", "x");
    assert_eq!(
        opens_and_says(&file, &["wood.tga", "have no picture there"]),
        1
    );
}

#[test]
fn an_mtl_number_that_is_missing_or_none() {
    for (line, what) in [
        ("Kd 0.5 0.5", "`Kd` without three numbers"),
        ("Kd nan nan nan", "`Kd` without three numbers"),
        ("Ns shiny", "`Ns` without a number"),
        ("d", "`d` without a number"),
        ("map_Kd", "`map_Kd` without a picture"),
        ("illum 99", "an `illum` that is none of 0 to 10"),
        ("illum -1", "an `illum` that is none of 0 to 10"),
    ] {
        let (_folder, file) = mtl(&format!("newmtl a\n{line}\n"));
        assert_eq!(opens_and_says(&file, &["model.mtl:2", what, "left out"]), 1);
    }
}

#[test]
fn an_mtl_material_without_a_name() {
    let (_folder, file) = mtl("newmtl\nKd 1 0 0\nnewmtl a\n");
    assert_eq!(opens_and_says(&file, &["model.mtl:1", "without a name"]), 1);
}

#[test]
fn an_mtl_outside_the_folder_is_left_out_unless_it_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.mtl", "newmtl a\nKd 1 0 0\n");
    let text = format!("{TRIANGLE}mtllib ../a.mtl\nusemtl a\nf 1 2 3\n");
    let file = write(folder.path(), "inside/model.obj", text);
    let note = ["model.obj:4", "../a.mtl", "--allow-outside"];
    assert_eq!(opens_and_says(&file, &note), 1);
    let mut app = crate::files::app::app();
    let options = OpenOptions {
        allow_outside: true,
        ..OpenOptions::default()
    };
    let source = glassbox::io::SceneSource::File(file);
    glassbox::io::open(app.world_mut(), &source, options).unwrap_or_else(|e| panic!("{e}"));
    let objects = crate::files::models::objects(app.world_mut());
    assert_eq!(objects[0].1.diffuse, bevy::color::LinearRgba::RED);
}

#[test]
fn a_texture_outside_the_folder_by_an_absolute_path() {
    let (_folder, file) = mtl("newmtl a\nmap_Kd /etc/hostname.png\n");
    let note = ["model.mtl:2", "/etc/hostname.png", "--allow-outside"];
    assert_eq!(opens_and_says(&file, &note), 1);
}

#[cfg(unix)]
#[test]
fn a_texture_outside_the_folder_over_a_symbolic_link() {
    let outside = tempfile::tempdir().unwrap();
    let picture = write(outside.path(), "a.png", "x");
    let (folder, file) = mtl("newmtl a\nmap_Kd link.png\n");
    std::os::unix::fs::symlink(picture, folder.path().join("link.png")).unwrap();
    let note = ["model.mtl:2", "link.png", "--allow-outside"];
    assert_eq!(opens_and_says(&file, &note), 1);
}

#[test]
fn a_line_longer_than_any_mesh_has() {
    let (_folder, file) = obj(&format!("#{}\nf 1 2 3\n", "x".repeat(3 << 20)));
    says(&refused(&file), &["model.obj:4", "bytes in one line"]);
}

#[test]
fn more_triangles_than_the_limit() {
    let (_folder, file) = obj("f 1 2 3\nf 1 2 3\nf 1 2 3\n");
    let mut options = OpenOptions::default();
    options.limits.triangles = 2;
    let error = refused_with(&file, options);
    assert!(matches!(error.problem, Problem::TooMany { .. }), "{error}");
    says(&error, &["model.obj:6", "3 triangles", "limit is 2"]);
}

#[test]
fn a_file_larger_than_the_limit() {
    let (_folder, file) = obj("f 1 2 3\n");
    let mut options = OpenOptions::default();
    options.limits.file_bytes = 10;
    says(
        &refused_with(&file, options),
        &["model.obj", "bytes", "limit is 10"],
    );
}

#[test]
fn what_is_odd_but_can_be_meant_is_read() {
    let (folder, file) = obj("mtllib a.mtl\r\nusemtl a\r\nf 1 2 \\\r\n3\r\n");
    // Latin-1 in a comment, one number for grey, a halo, an option before no picture.
    write(
        folder.path(),
        "a.mtl",
        b"# caf\xe9\nnewmtl a\nKd 0.5\nd -halo 0.5\nillum x\n",
    );
    let (mut app, _) = opened(&file);
    let world = app.world_mut();
    let mut query = world.query::<&glassbox::scene::Phong>();
    let halves = query.iter(world).filter(|phong| phong.opacity == 0.5);
    let reds: Vec<f32> = halves.map(|phong| phong.diffuse.red).collect();
    assert_eq!(reds, [0.5]);
}
