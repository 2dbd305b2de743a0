use super::{refused, refused_with, says};
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

#[test]
fn an_obj_that_ends_inside_a_face() {
    let (_folder, file) = obj("f 1 2");
    says(
        &refused(&file),
        &["model.obj:4", "ends too early", "3 corners"],
    );
}

#[test]
fn an_obj_that_ends_inside_a_vertex() {
    let (_folder, file) = obj("f 1 2 3\nv 0.5 0.");
    says(
        &refused(&file),
        &["model.obj:5", "ends too early", "3 numbers and has 2"],
    );
}

#[test]
fn a_face_index_out_of_range() {
    let (_folder, file) = obj("f 1 2 3\nf 1 2 4\n");
    says(&refused(&file), &["model.obj:5", "vertex 4", "there are 3"]);
}

#[test]
fn a_face_index_of_zero() {
    let (_folder, file) = obj("f 0 1 2\n");
    says(&refused(&file), &["model.obj:4", "vertex 0"]);
}

#[test]
fn a_negative_face_index_that_reaches_before_the_first_vertex() {
    let (_folder, file) = obj("f -1 -2 -4\n");
    says(&refused(&file), &["model.obj:4", "vertex -4"]);
}

#[test]
fn a_face_index_that_no_integer_holds() {
    let (_folder, file) = obj("f 1 2 99999999999999999999\n");
    says(
        &refused(&file),
        &["model.obj:4", "vertex 99999999999999999999"],
    );
}

#[test]
fn a_normal_index_and_a_texture_index_out_of_range() {
    let (_folder, file) = obj("vn 0 0 1\nf 1//1 2//1 3//2\n");
    says(&refused(&file), &["model.obj:5", "normal 2", "there are 1"]);
    let (_folder, file) = obj("vt 0 0\nf 1/1 2/1 3/2\n");
    says(&refused(&file), &["model.obj:5", "texture coordinate 2"]);
}

#[test]
fn an_index_that_counts_back_too_far_or_has_too_many_digits() {
    // What a parser that computes with it takes for another one, or for none.
    let lines = "vt 0 0\nvn 0 0 1\n";
    for (corner, what) in [
        ("3/-2", "texture coordinate -2"),
        ("3//-2", "normal -2"),
        (
            "3/9223372036854775808",
            "texture coordinate 9223372036854775808",
        ),
        ("3//+6148914691236517206", "normal +6148914691236517206"),
        (
            "3/-9223372036854775808",
            "texture coordinate -9223372036854775808",
        ),
    ] {
        let (_folder, file) = obj(&format!("{lines}f 1 2 {corner}\n"));
        says(&refused(&file), &["model.obj:6", what, "there are 1"]);
    }
    let (_folder, file) = obj("l 1 2//-1\nf 1 2 3\n");
    says(&refused(&file), &["model.obj:4", "normal -1"]);
    let (_folder, file) = obj(&format!("{lines}f 1/-1/-1 2/1/1 -1/-1/1\n"));
    let (mut app, _) = opened(&file);
    let world = app.world_mut();
    let meshes = world.query::<&bevy::mesh::Mesh3d>().iter(world).count();
    assert_eq!(meshes, 1);
}

#[test]
fn a_face_corner_that_is_no_index() {
    let (_folder, file) = obj("f 1 2 three\n");
    says(&refused(&file), &["model.obj:4", "`three`"]);
}

#[test]
fn a_vertex_that_is_not_a_number() {
    let (_folder, file) = obj("v NaN 0 0\nf 1 2 4\n");
    says(
        &refused(&file),
        &["model.obj:4", "`NaN`", "not a finite number"],
    );
    let (_folder, file) = obj("v 0 -inf 0\nf 1 2 4\n");
    says(&refused(&file), &["model.obj:4", "`-inf`"]);
    let (_folder, file) = obj("v 0 zero 0\nf 1 2 4\n");
    says(&refused(&file), &["model.obj:4", "`zero` is not a number"]);
}

#[test]
fn a_vertex_with_w_zero() {
    let (_folder, file) = obj("v 0 0 0 0\nf 1 2 4\n");
    says(&refused(&file), &["model.obj:4", "w = 0"]);
}

#[test]
fn a_missing_mtl() {
    let (_folder, file) = obj("mtllib gone.mtl\nf 1 2 3\n");
    says(
        &refused(&file),
        &["model.obj:4", "`gone.mtl` does not exist"],
    );
}

#[test]
fn a_material_that_no_mtl_defines() {
    let (folder, file) = obj("mtllib a.mtl\nusemtl gold\nf 1 2 3\n");
    write(folder.path(), "a.mtl", "newmtl silver\n");
    says(&refused(&file), &["model.obj:5", "`gold`"]);
}

#[test]
fn a_missing_texture() {
    let (_folder, file) = mtl("newmtl a\nmap_Kd -s 1 1 1 wood.png\n");
    says(
        &refused(&file),
        &["model.mtl:2", "`wood.png` does not exist"],
    );
}

#[test]
fn a_texture_that_is_no_picture() {
    let (folder, file) = mtl("newmtl a\nmap_Kd wood.png\n");
    write(folder.path(), "wood.png", "this is text");
    says(&refused(&file), &["wood.png", "not a picture"]);
}

#[test]
fn a_texture_that_is_called_tga_and_is_none() {
    let (folder, file) = mtl("newmtl a\nmap_Kd wood.tga\n");
    write(folder.path(), "wood.tga", "x");
    says(&refused(&file), &["wood.tga", "TGA"]);
}

#[test]
fn an_mtl_color_with_too_few_numbers() {
    let (_folder, file) = mtl("newmtl a\nKd 0.5 0.5\n");
    says(
        &refused(&file),
        &["model.mtl:2", "Kd needs 3 numbers and has 2"],
    );
}

#[test]
fn an_mtl_number_that_is_not_one() {
    let (_folder, file) = mtl("newmtl a\nNs shiny\n");
    says(&refused(&file), &["model.mtl:2", "`shiny` is not a number"]);
    let (_folder, file) = mtl("newmtl a\nKd nan nan nan\n");
    says(&refused(&file), &["model.mtl:2", "not a finite number"]);
    let (_folder, file) = mtl("newmtl a\nd\n");
    says(&refused(&file), &["model.mtl:2", "d has no number"]);
}

#[test]
fn an_mtl_material_without_a_name() {
    let (_folder, file) = mtl("newmtl\n");
    says(&refused(&file), &["model.mtl:1", "has no name"]);
}

#[test]
fn an_mtl_outside_the_folder_is_refused_unless_it_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.mtl", "newmtl a\n");
    let text = format!("{TRIANGLE}mtllib ../a.mtl\nusemtl a\nf 1 2 3\n");
    let file = write(folder.path(), "inside/model.obj", text);
    let error = refused(&file);
    says(&error, &["model.obj:4", "../a.mtl", "--allow-outside"]);
    let mut app = crate::files::app::app();
    let options = OpenOptions {
        allow_outside: true,
        ..OpenOptions::default()
    };
    let source = glassbox::io::SceneSource::File(file);
    glassbox::io::open(app.world_mut(), &source, options).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn a_texture_outside_the_folder_by_an_absolute_path() {
    let (_folder, file) = mtl("newmtl a\nmap_Kd /etc/hostname.png\n");
    says(
        &refused(&file),
        &["model.mtl:2", "/etc/hostname.png", "--allow-outside"],
    );
}

#[cfg(unix)]
#[test]
fn a_texture_outside_the_folder_over_a_symbolic_link() {
    let outside = tempfile::tempdir().unwrap();
    let picture = write(outside.path(), "a.png", "x");
    let (folder, file) = mtl("newmtl a\nmap_Kd link.png\n");
    std::os::unix::fs::symlink(picture, folder.path().join("link.png")).unwrap();
    says(
        &refused(&file),
        &["model.mtl:2", "link.png", "--allow-outside"],
    );
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
