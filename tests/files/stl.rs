//! STL as programs write it: ASCII or binary, whatever the first word says.

use super::app::{opened, write};
use super::models::objects;
use bevy::mesh::{Mesh, Mesh3d, VertexAttributeValues};
use bevy::prelude::{App, Assets};
use glassbox::io::save;

type Triangle = [[f32; 3]; 3];

const TETRAHEDRON: [Triangle; 4] = [
    [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
];

fn ascii(triangles: &[Triangle]) -> String {
    let corner = |&[x, y, z]: &[f32; 3]| format!("vertex {x} {y} {z}\n");
    let facet = |triangle: &Triangle| {
        let corners: String = triangle.iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    triangles.iter().map(facet).collect()
}

fn binary(head: &[u8], triangles: &[Triangle], attribute: impl Fn(usize) -> u16) -> Vec<u8> {
    let mut bytes = head.to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for (i, triangle) in triangles.iter().enumerate() {
        bytes.extend([0; 12]);
        let numbers = triangle.as_flattened().iter();
        bytes.extend(numbers.flat_map(|number| number.to_le_bytes()));
        bytes.extend(attribute(i).to_le_bytes());
    }
    bytes
}

/// The app, and what was said of the file itself.
fn open(content: impl AsRef<[u8]>) -> (App, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let (app, opened) = opened(&write(folder.path(), "part.stl", content));
    let lines = opened.notes.lines().into_iter();
    (app, lines.filter(|line| !line.contains("added")).collect())
}

/// Vertices of the only mesh, and their colours.
fn vertices(app: &mut App) -> (usize, Option<Vec<[f32; 4]>>) {
    let world = app.world_mut();
    let handle = world.query::<&Mesh3d>().single(world).unwrap().0.clone();
    let mesh = world.resource::<Assets<Mesh>>().get(&handle).unwrap();
    let colors = match mesh.attribute(Mesh::ATTRIBUTE_COLOR) {
        Some(VertexAttributeValues::Float32x4(colors)) => Some(colors.clone()),
        _ => None,
    };
    (mesh.count_vertices(), colors)
}

#[test]
fn ascii_and_binary_say_the_same_and_share_corners() {
    let text = format!("solid thing\n{}endsolid thing\n", ascii(&TETRAHEDRON));
    let upper = text.to_uppercase().replace('\n', "\r");
    let one_line = text.replace('\n', " ");
    // Half of all programs write `solid` in front of binary data too.
    let misleading = binary(b"solid thing", &TETRAHEDRON, |_| 0);
    let plain = binary(b"", &TETRAHEDRON, |_| 0);
    for (content, name) in [
        (text.into_bytes(), "thing"),
        (upper.into_bytes(), "THING"),
        (one_line.into_bytes(), "thing"),
        (misleading, "part"),
        (plain, "part"),
    ] {
        let shown = String::from_utf8_lossy(&content[..40.min(content.len())]).into_owned();
        let (mut app, told) = open(content);
        assert_eq!(told, [""; 0], "{shown}");
        let objects = objects(app.world_mut());
        assert_eq!(objects.len(), 1, "{shown}");
        assert_eq!(
            (objects[0].0.as_str(), objects[0].2.as_slice()),
            (name, &TETRAHEDRON[..])
        );
        assert_eq!(vertices(&mut app), (4, None), "{shown}");
    }
}

#[test]
fn each_solid_is_an_object_and_goes_through_a_scene_file() {
    let [a, b, ..] = TETRAHEDRON;
    let solids = [("lid", a), ("", b), ("lid", b)];
    let solid = |(name, triangle)| format!("solid {name}\n{}endsolid\n", ascii(&[triangle]));
    let folder = tempfile::tempdir().unwrap();
    let text: String = solids.map(solid).concat();
    let (mut app, _) = opened(&write(folder.path(), "part.stl", text));
    let before = objects(app.world_mut());
    let names: Vec<&str> = before.iter().map(|object| object.0.as_str()).collect();
    assert_eq!(names, ["lid", "lid#2", "part"]);
    let scene = folder.path().join("scene.scn.ron");
    save(app.world_mut(), &scene).unwrap();
    let (mut app, _) = opened(&scene);
    assert_eq!(objects(app.world_mut()), before);
}

#[test]
fn colours_of_facets_are_read_in_both_habits() {
    // 31 of 31 red, and the bit that says in one habit that there is a colour, in the other that there is none.
    let [one, two, ..] = TETRAHEDRON;
    for (head, attributes, expected) in [
        (
            &b""[..],
            [0x8000 | 31 << 10, 0],
            [[1.0, 0.0, 0.0], [1.0; 3]],
        ),
        (
            b"COLOR=\x00\x00\xff\xff",
            [31, 0x8000],
            [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        ),
    ] {
        let (mut app, told) = open(binary(head, &[one, two], |i| attributes[i]));
        assert_eq!(told, [""; 0]);
        let (count, colors) = vertices(&mut app);
        let corner = |[r, g, b]: [f32; 3]| [[r, g, b, 1.0]; 3];
        assert_eq!(colors, Some(expected.map(corner).concat()), "{head:?}");
        assert_eq!(count, 6);
    }
    let (mut app, told) = open(binary(b"", &[one], |_| 7));
    assert!(told[0].contains("no colours; left out"), "{told:?}");
    assert_eq!(vertices(&mut app), (3, None));
}

#[test]
fn what_cannot_be_used_of_an_stl_is_told_and_the_rest_is_shown() {
    let [one, two, ..] = TETRAHEDRON;
    let text = |lines: &str| format!("solid a\n{}{lines}", ascii(&[one])).into_bytes();
    let mut cut = binary(b"", &[one, two], |_| 0);
    cut.truncate(84 + 60);
    let mut long = binary(b"", &[one], |_| 0);
    long.extend([1; 7]);
    let not_finite = binary(b"", &[one, [[f32::NAN; 3]; 3]], |_| 0);
    for (content, note) in [
        (
            text("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 x 0\n"),
            "three corners",
        ),
        (
            text("facet\nouter loop\nvertex 0 0\nvertex 1 1 1\nendloop\n"),
            "three corners",
        ),
        (
            text("color 1 0 0\n"),
            "`color`, which is no keyword of STL; left out",
        ),
        (cut, "it says that it has 2 facets and has 1"),
        (long, "7 bytes behind its facets; left out"),
        (not_finite, "not finite numbers; left out"),
    ] {
        let (mut app, told) = open(content);
        assert_eq!(told.len(), 1, "{note}: {told:?}");
        assert!(told[0].contains(note), "{note}: {told:?}");
        assert_eq!(objects(app.world_mut())[0].2, [one], "{note}");
    }
    let [a, b, c] = one;
    let turned = text("").len();
    let mut against = text("");
    against.splice(
        ..turned,
        format!("solid\n{}", ascii(&[[a, c, b]])).into_bytes(),
    );
    let against = String::from_utf8(against)
        .unwrap()
        .replace("0 0 0\nouter", "0 0 -1\nouter");
    let (_, told) = open(against);
    assert!(told[0].contains("contradicts the order"), "{told:?}");
    let square = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\n";
    let (mut app, told) = open(square);
    assert!(
        told[0].contains("more than 3 corners; read as a polygon"),
        "{told:?}"
    );
    assert_eq!(objects(app.world_mut())[0].2.len(), 2);
}

#[test]
fn a_count_of_0_facets_that_are_there_is_told_and_they_are_shown() {
    let mut bytes = binary(b"", &TETRAHEDRON, |_| 0);
    bytes[80..84].fill(0);
    let folder = tempfile::tempdir().unwrap();
    let (mut app, opened) = opened(&write(folder.path(), "a.stl", bytes));
    assert_eq!(objects(app.world_mut())[0].2.len(), 4);
    let told = opened.notes.lines().join("\n");
    assert!(told.contains("a count of 0 facets"), "{told}");
}

#[test]
fn a_text_that_lies_far_off_keeps_its_digits_near_the_origin() {
    // Corners that 32 bits cannot tell apart, and a polygon of which they could not tell how it bends.
    let corner = |(x, y): &(f64, f64)| format!("vertex {:?} {:?} 7\n", 500_000.0 + x, 4e6 + y);
    let facet = |corners: &[(f64, f64)]| {
        let corners: String = corners.iter().map(corner).collect();
        format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let (a, b, c, d) = ((0.0, 0.0), (0.01, 0.0), (0.01, 0.0625), (0.0, 0.0625));
    let arrow = [(0.0, 0.0), (0.04, 0.0), (0.01, 0.01), (0.0, 0.04)];
    let text = format!(
        "solid one\n{}{}endsolid\nsolid two\n{}endsolid\n",
        facet(&[a, b, c]),
        facet(&[a, c, d]),
        facet(&arrow)
    );
    let (mut app, told) = open(text);
    let is_told = |part: &str| told.iter().filter(|note| note.contains(part)).count();
    assert_eq!(
        (is_told("far off"), is_told("contradicts")),
        (1, 0),
        "{told:?}"
    );
    let objects = objects(app.world_mut());
    let close = |found: &Triangle, corners: [(f64, f64); 3]| {
        let pairs = found.iter().zip(corners);
        pairs.into_iter().all(|(&[x, y, z], (u, v))| {
            let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-6;
            near(x, u) && near(y, v) && z == 0.0
        })
    };
    let one = &objects[0].2;
    assert!(
        close(&one[0], [a, b, c]) && close(&one[1], [a, c, d]),
        "{one:?}"
    );
    let two = &objects[1].2;
    let area = |t: &Triangle| {
        let [u, v] = [1, 2].map(|i| [t[i][0] - t[0][0], t[i][1] - t[0][1]]);
        0.5 * (u[0] * v[1] - u[1] * v[0])
    };
    let areas: Vec<f32> = two.iter().map(area).collect();
    let whole: f32 = areas.iter().sum();
    assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
    assert!((whole - 0.0004).abs() < 1e-6, "{areas:?}");
    // Near the origin nothing is moved.
    let (_, told) = open(format!("solid a\n{}endsolid\n", ascii(&TETRAHEDRON)));
    assert_eq!(told, [""; 0]);
}
