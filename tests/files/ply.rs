//! PLY as scanners and MeshLab write it.

use super::app::{opened, write};
use super::models::objects;
use bevy::mesh::{Mesh, Mesh3d, MeshVertexAttribute, VertexAttributeValues};
use bevy::prelude::{App, Assets};
use glassbox::io::save;
use std::path::PathBuf;

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const FACES: &str = "property list uchar int vertex_indices\n";

/// An ASCII file of these elements and numbers.
fn ascii(elements: &str, numbers: &str) -> String {
    format!("ply\nformat ascii 1.0\n{elements}end_header\n{numbers}")
}

/// A square with what its vertices and faces have besides.
fn square(vertex: &str, face: &str, [a, b, c, d]: [&str; 4], faces: &[&str]) -> String {
    let count = faces.len();
    let elements = format!("element vertex 4\n{XYZ}{vertex}element face {count}\n{FACES}{face}");
    let faces = faces.join("\n");
    ascii(
        &elements,
        &format!("0 0 0 {a}\n1 0 0 {b}\n1 1 0 {c}\n0 1 0 {d}\n{faces}\n"),
    )
}

/// The app, and what was said of the file itself.
fn open(content: impl AsRef<[u8]>) -> (App, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let (app, opened) = opened(&write(folder.path(), "scan.ply", content));
    let lines = opened.notes.lines().into_iter();
    (app, lines.filter(|line| !line.contains("added")).collect())
}

fn attribute(app: &mut App, id: MeshVertexAttribute) -> Option<VertexAttributeValues> {
    let world = app.world_mut();
    let handle = world.query::<&Mesh3d>().single(world).unwrap().0.clone();
    let mesh = world.resource::<Assets<Mesh>>().get(&handle).unwrap();
    mesh.attribute(id).cloned()
}

fn corpus(name: &str) -> Vec<u8> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input/corpus");
    std::fs::read(folder.join(name)).unwrap()
}

#[test]
fn faces_in_front_of_their_vertices_are_the_same_faces() {
    let face = format!("element face 1\n{FACES}");
    let vertex = format!("element vertex 4\n{XYZ}");
    let edge = "element edge 1\nproperty int vertex1\n";
    let corners = "0 0 0 1 0 0 1 1 0 0 1 0";
    let (mut behind, _) = open(ascii(
        &format!("{vertex}{face}"),
        &format!("{corners} 4 0 1 2 3"),
    ));
    let wanted = objects(behind.world_mut())[0].2.clone();
    assert_eq!(wanted.len(), 2);
    let text = ascii(&format!("{face}{vertex}"), &format!("4 0 1 2 3 {corners}"));
    let mut binary = text.replace("ascii", "binary_big_endian").into_bytes();
    binary.truncate(binary.len() - "4 0 1 2 3 ".len() - corners.len());
    binary.push(4);
    binary.extend(
        [0_i32, 1, 2, 3]
            .iter()
            .flat_map(|index| index.to_be_bytes()),
    );
    let numbers = corners.split(' ').map(|n| n.parse::<f32>().unwrap());
    binary.extend(numbers.flat_map(f32::to_be_bytes));
    for content in [text.into_bytes(), binary] {
        let (mut app, told) = open(&content);
        assert_eq!(objects(app.world_mut())[0].2, wanted);
        assert!(told.is_empty(), "{told:?}");
    }
    let text = ascii(
        &format!("{face}{edge}{vertex}"),
        &format!("4 0 1 2 3 7 {corners} 9"),
    );
    let (mut app, told) = open(text);
    assert_eq!(objects(app.world_mut())[0].2, wanted);
    assert_eq!(
        told.len(),
        2,
        "edges, and what is behind, once each: {told:?}"
    );
    let cut = ascii(
        &format!("element face 2\n{FACES}{vertex}"),
        "3 0 1 2 3 0 2 3 0 0 0 1 0 0 1 1 0",
    );
    let (mut app, told) = open(cut);
    assert_eq!(objects(app.world_mut())[0].2.len(), 1, "{told:?}");
    assert!(
        told.iter().any(|note| note.contains("ends too early")),
        "{told:?}"
    );
}

#[test]
fn binary_of_both_orders_of_bytes_says_the_same_as_text() {
    let text = "element vertex 4\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\n\
        property float ny\nproperty float nz\nelement face 1\nproperty list uchar ushort vertex_index\n\
        property list uchar float texcoord\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
        element tristrips 1\nproperty list int int vertex_indices\n";
    // Lines mean nothing to what reads number after number.
    let numbers = "0 0 0 0 0 1 1 0 0 0 0 1\n1 1 0 0 0 1 0 1 0 0 0 1 4 0 1 2 3 8 0 0 1 0 1 1 0 1 200 100 50\n\
        7 0 1 3 -1 1 2 3";
    let mut all = Vec::new();
    for content in [
        corpus("little.ply"),
        corpus("big.ply"),
        ascii(text, numbers).into_bytes(),
    ] {
        let (mut app, told) = open(content);
        assert_eq!(told, [""; 0]);
        let triangles = objects(app.world_mut())[0].2.clone();
        assert_eq!(
            triangles.len(),
            4,
            "a square and a strip of one and one triangle"
        );
        let normals = attribute(&mut app, Mesh::ATTRIBUTE_NORMAL);
        let uvs = attribute(&mut app, Mesh::ATTRIBUTE_UV_0);
        all.push(format!("{triangles:?} {normals:?} {uvs:?}"));
        let Some(VertexAttributeValues::Float32x4(colors)) =
            attribute(&mut app, Mesh::ATTRIBUTE_COLOR)
        else {
            panic!("no colours");
        };
        // Files hold them as screens take them: 200 of 255 is 0.578 of the light.
        assert!((colors[0][0] - 0.5776).abs() < 1e-3, "{colors:?}");
    }
    assert_eq!(all[0], all[1]);
    assert_eq!(all[0], all[2]);
}

#[test]
fn polygons_are_triangulated_by_their_shape() {
    let arrow = "0 0 0 4 0 0 4 4 0 2 1 0 0 4 0";
    let elements = format!("element vertex 5\n{XYZ}element face 1\n{FACES}");
    let (mut app, told) = open(ascii(&elements, &format!("{arrow} 5 0 1 2 3 4")));
    assert_eq!(told, [""; 0]);
    let triangles = &objects(app.world_mut())[0].2;
    let area = |&[a, b, c]: &[[f32; 3]; 3]| {
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    };
    assert_eq!(triangles.iter().map(area).sum::<f32>(), 10.0);
}

#[test]
fn strips_turn_every_second_triangle_around() {
    let elements = format!(
        "element vertex 5\n{XYZ}element tristrips 1\nproperty list int int vertex_indices\n"
    );
    let points = "0 0 0 1 0 0 0 1 0 1 1 0 0 2 0";
    let (mut app, told) = open(ascii(&elements, &format!("{points} 6 0 1 2 3 3 4")));
    assert_eq!(told, [""; 0]);
    let triangles = &objects(app.world_mut())[0].2;
    assert_eq!(
        triangles.len(),
        2,
        "a repeated vertex is no triangle: {triangles:?}"
    );
    let faces_up =
        |&[a, b, c]: &[[f32; 3]; 3]| (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
    assert!(triangles.iter().all(faces_up), "{triangles:?}");
}

#[test]
fn strips_have_the_colours_and_texture_coordinates_of_their_own() {
    let vertices = "0 0 0  1 0 0  0 1 0  1 1 0  0 2 0";
    let open = |of_strips: &str, strips: &str| {
        let count = strips.lines().count();
        open(ascii(
            &format!(
                "element vertex 5\n{XYZ}element tristrips {count}\n\
                 property list uchar int vertex_indices\n{of_strips}"
            ),
            &format!("{vertices}\n{strips}\n"),
        ))
    };
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let (mut app, notes) = open(colors, "3 0 1 2 255 0 0\n4 1 2 3 4 0 0 255");
    assert_eq!(notes, [""; 0]);
    let Some(VertexAttributeValues::Float32x4(found)) = attribute(&mut app, Mesh::ATTRIBUTE_COLOR)
    else {
        panic!("no colours");
    };
    let (red, blue) = ([1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]);
    // Two vertices are of both strips.
    assert_eq!(found.iter().filter(|color| **color == red).count(), 3);
    assert_eq!(found.iter().filter(|color| **color == blue).count(), 4);
    assert_eq!(objects(app.world_mut())[0].2.len(), 3);
    let uvs = "property list uchar float texcoord\n";
    let (mut app, notes) = open(uvs, "3 0 1 2 6 0 0 1 0 0.5 0.25");
    assert_eq!(notes, [""; 0]);
    let Some(VertexAttributeValues::Float32x2(found)) = attribute(&mut app, Mesh::ATTRIBUTE_UV_0)
    else {
        panic!("no texture coordinates");
    };
    assert_eq!(found, [[0.0, 1.0], [1.0, 1.0], [0.5, 0.75]]);
}

#[test]
fn faces_and_strips_of_one_file_keep_their_colours_apart() {
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let elements = format!(
        "element vertex 4\n{XYZ}element face 1\n{FACES}{colors}\
         element tristrips 1\nproperty list uchar int vertex_indices\n{colors}"
    );
    let numbers = "0 0 0 1 0 0 0 1 0 1 1 0\n3 0 1 2 255 0 0\n3 1 2 3 0 0 255\n";
    let (mut app, notes) = open(ascii(&elements, numbers));
    assert_eq!(notes, [""; 0]);
    let Some(VertexAttributeValues::Float32x4(found)) = attribute(&mut app, Mesh::ATTRIBUTE_COLOR)
    else {
        panic!("no colours");
    };
    let of = |channel: usize| found.iter().filter(|color| color[channel] == 1.0).count();
    assert_eq!([of(0), of(2)], [3, 3]);
}

#[test]
fn what_there_is_of_a_strip_that_is_cut_short_is_shown() {
    let elements = format!(
        "element vertex 4\n{XYZ}element tristrips 1\nproperty list uchar int vertex_indices\n"
    );
    let (mut app, notes) = open(ascii(&elements, "0 0 0 1 0 0 0 1 0 1 1 0\n9 0 1 2 3"));
    assert_eq!(objects(app.world_mut())[0].2.len(), 2);
    assert!(notes[0].contains("ends too early"), "{notes:?}");
}

#[test]
fn lines_are_counted_whatever_ends_them() {
    let vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0";
    let good = ascii(
        &format!("element vertex 4\n{XYZ}element face 3\n{FACES}"),
        &format!("{vertices}\n3 0 1 2\n\n3 0 1 9\n3 1 2 3\n"),
    );
    let line = good.lines().position(|line| line == "3 0 1 9").unwrap() + 1;
    for end in ["\n", "\r", "\r\n"] {
        let (_, notes) = open(good.replace('\n', end));
        let place = format!("scan.ply:{line}: ");
        assert!(
            notes.iter().any(|note| note.contains(&place)),
            "{end:?}: {notes:?}"
        );
    }
}

#[test]
fn a_picture_is_the_material_and_its_coordinates_count_from_the_bottom() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("Wall.png");
    glassbox::io::write_picture(&picture, 2, 1, &[[0.5; 3], [1.0; 3]]).unwrap();
    let uvs = "property float s\nproperty float t\n";
    let text = square(uvs, "", ["0 0", "1 0", "1 1", "0 1"], &["4 0 1 2 3"]);
    let text = text.replace(
        "format ascii 1.0\n",
        "format ascii 1.0\ncomment TextureFile wall.png\n",
    );
    let (mut app, opened) = opened(&write(folder.path(), "scan.ply", &text));
    let lines = opened.notes.lines();
    assert!(
        lines.iter().any(|line| line.contains("spelt otherwise")),
        "{lines:?}"
    );
    let before = objects(app.world_mut());
    let map = before[0].1.diffuse_map.as_ref();
    assert_eq!(map.map(|map| map.path.as_str()), Some("Wall.png"));
    let expected =
        VertexAttributeValues::Float32x2(vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
    assert_eq!(attribute(&mut app, Mesh::ATTRIBUTE_UV_0), Some(expected));
    let scene = folder.path().join("scene.scn.ron");
    save(app.world_mut(), &scene).unwrap();
    let (mut app, _) = super::app::opened(&scene);
    assert_eq!(objects(app.world_mut()), before);
    let (_, told) = open(&text);
    assert!(
        told[0].contains("there is no picture `wall.png`; shown without"),
        "{told:?}"
    );
}

#[test]
fn faces_that_share_a_vertex_and_disagree_about_it_have_each_their_own() {
    let uvs = "property list uchar float texcoord\n";
    let faces = ["3 0 1 2 6 0 0 1 0 1 1", "3 0 2 3 6 0 0 1 1 0.5 0.5"];
    let (mut app, told) = open(square("", uvs, [""; 4], &faces));
    assert_eq!(told, [""; 0]);
    let Some(VertexAttributeValues::Float32x2(uvs)) = attribute(&mut app, Mesh::ATTRIBUTE_UV_0)
    else {
        panic!("no texture coordinates");
    };
    assert_eq!(uvs.len(), 4, "they agree");
    let faces = ["3 0 1 2 6 0 0 1 0 1 1", "3 0 2 3 6 0.5 0 1 1 0.5 0.5"];
    let (mut app, _) = open(square(
        "",
        "property list uchar float texcoord\n",
        [""; 4],
        &faces,
    ));
    let count = attribute(&mut app, Mesh::ATTRIBUTE_UV_0).map(|uvs| uvs.len());
    assert_eq!(count, Some(5));
}

#[test]
fn what_cannot_be_used_of_a_ply_is_told_and_the_rest_is_shown() {
    let one = "3 0 1 2";
    let plain = |faces: &[&str]| square("", "", [""; 4], faces);
    let more = |text: String| text.replace("element face 2", "element face 3");
    for (content, note) in [
        (plain(&[one, "2 0 1"]), "fewer than 3 corners; left out"),
        (
            plain(&[one, "3 0 1 4"]),
            "a corner that cannot be used; left out",
        ),
        (
            plain(&[one, "3 0 1 -1"]),
            "a corner that cannot be used; left out",
        ),
        (
            plain(&[one, "3 0 1 nan"]),
            "a corner that cannot be used; left out",
        ),
        (
            plain(&[one, "-3 0 1 3"]),
            "a length of -3; what comes before is shown",
        ),
        (
            plain(&[one, "3 0 one 3"]),
            "scan.ply:15: `one` is not a number; what comes before",
        ),
        (more(plain(&[one, "1 0"])), "ends too early"),
        (
            plain(&[one]) + "7\n",
            "something behind its last element; left out",
        ),
        (
            square("property float quality\n", "", ["1"; 4], &[one]),
            "`quality`; left out",
        ),
        (
            square("", "property int flags\n", [""; 4], &["3 0 1 2 7"]),
            "`flags`; left out",
        ),
        (
            plain(&[one]).replace(" 1.0\n", " 2.0\n"),
            "version `2.0` of PLY; read as",
        ),
    ] {
        let (mut app, told) = open(&content);
        assert!(
            told.iter().any(|line| line.contains(note)),
            "{note}: {told:?}"
        );
        assert_eq!(objects(app.world_mut())[0].2.len(), 1, "{note}");
    }
    let hole = plain(&[one, "3 0 2 3"]).replace("0 1 0 \n", "0 nan 0\n");
    let (mut app, told) = open(hole);
    assert!(told[0].contains("a corner that cannot be used"), "{told:?}");
    assert_eq!(objects(app.world_mut())[0].2.len(), 1);
}

#[test]
fn vertices_that_lie_far_off_keep_their_digits_near_the_origin() {
    // Where they are written out, a head that says floats takes none of them away.
    for scalar in ["double", "float"] {
        let vertices = format!("element vertex 3\n{}", XYZ.replace("float", scalar));
        let elements = format!("{vertices}element face 1\n{FACES}");
        let numbers = "500000 4500000 0\n500000.25 4500000 0\n500000 4500000.125 0\n3 0 1 2\n";
        let (mut app, told) = open(ascii(&elements, numbers));
        let triangle = objects(app.world_mut())[0].2[0];
        assert_eq!(
            triangle,
            [[0.0, 0.0, 0.0], [0.25, 0.0, 0.0], [0.0, 0.125, 0.0]],
            "{scalar}"
        );
        assert!(told.len() == 1 && told[0].contains("far off"), "{told:?}");
    }
}

#[test]
fn a_byte_order_mark_and_what_microsoft_writes_for_no_number_do_not_cost_the_file() {
    let whole = square("", "", [""; 4], &["4 0 1 2 3"]);
    let (mut app, told) = open(format!("\u{feff}{whole}"));
    assert_eq!(objects(app.world_mut())[0].2.len(), 2);
    assert!(told.is_empty(), "{told:?}");
    for none in ["-nan(ind)", "nan(snan)", "1.#QNAN", "-1.#IND", "1.#INF"] {
        let broken = square("", "", [""; 4], &["3 0 1 3", "3 1 2 3"]);
        let (mut app, told) = open(broken.replacen("1 1 0", &format!("1 1 {none}"), 1));
        assert_eq!(objects(app.world_mut())[0].2.len(), 1, "{none}");
        assert!(!told.is_empty(), "{none}");
    }
}

#[test]
fn colours_up_to_255_are_those_in_whatever_numbers_they_are_written() {
    let red = ["255 51 0"; 4];
    let names = |kind: &str| {
        let names = ["Red", "green", "blue"];
        names
            .map(|name| format!("property {kind} {name}\n"))
            .concat()
    };
    for (kind, told) in [
        ("uchar", 0),
        ("int", 1),
        ("ushort", 1),
        ("float", 1),
        ("double", 1),
    ] {
        let (mut app, notes) = open(square(&names(kind), "", red, &["4 0 1 2 3"]));
        let (mut of_faces, _) = open(square("", &names(kind), [""; 4], &["4 0 1 2 3 255 51 0"]));
        for app in [&mut app, &mut of_faces] {
            let Some(VertexAttributeValues::Float32x4(colors)) =
                attribute(app, Mesh::ATTRIBUTE_COLOR)
            else {
                panic!("no colours: {notes:?}");
            };
            // 51 of 255 as screens take it is 0.0331.
            let off = colors[0].iter().zip([1.0, 0.0331, 0.0, 1.0]);
            let off = off.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 1e-4, "{kind}: {colors:?}");
        }
        let colours = notes.iter().filter(|note| note.contains("colours"));
        assert_eq!(colours.count(), told, "{kind}: {notes:?}");
    }
    // Those that reach further are what their type says.
    let dark = ["65535 13107 0"; 4];
    let (mut app, notes) = open(square(&names("ushort"), "", dark, &["4 0 1 2 3"]));
    let colors = attribute(&mut app, Mesh::ATTRIBUTE_COLOR);
    let Some(VertexAttributeValues::Float32x4(colors)) = colors else {
        panic!("no colours: {notes:?}");
    };
    assert!(
        (colors[0][1] - 0.0331).abs() < 1e-4 && notes.is_empty(),
        "{colors:?} {notes:?}"
    );
}
