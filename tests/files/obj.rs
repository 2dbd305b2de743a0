//! OBJ and MTL as other programs write them: what is meant is read, and what cannot be shown is told.

use super::app::{opened, write};
use super::models::objects;
use bevy::color::LinearRgba;
use bevy::math::Vec3;
use bevy::mesh::{Mesh, Mesh3d, VertexAttributeValues};
use bevy::prelude::{App, Assets};
use glassbox::scene::{Phong, TextureSource, Wrap};
use tempfile::TempDir;

pub(super) const SQUARE: &str =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

/// Files in a folder; the first is opened. What it holds, and what was said.
pub(super) fn open(files: &[(&str, &[u8])]) -> (App, Vec<String>, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files {
        write(folder.path(), name, content);
    }
    let picture = folder.path().join("wall.png");
    glassbox::io::write_picture(&picture, 2, 1, &[[0.5; 3], [1.0; 3]]).unwrap();
    let (app, opened) = opened(&folder.path().join(files[0].0));
    let lines = opened.notes.lines();
    // Those of what is added, which every OBJ has.
    let told = lines.into_iter().filter(|line| !line.contains("added"));
    (app, told.collect(), folder)
}

/// An OBJ of these lines alone.
pub(super) fn obj(lines: &str) -> (App, Vec<String>) {
    let (app, told, _folder) = open(&[("a.obj", lines.as_bytes())]);
    (app, told)
}

pub(super) fn area(app: &mut App) -> f32 {
    let objects = objects(app.world_mut());
    let triangles = objects.iter().flat_map(|object| &object.2);
    let area = |triangle: &[[f32; 3]; 3]| {
        let [a, b, c] = triangle.map(Vec3::from);
        0.5 * (b - a).cross(c - a).length()
    };
    triangles.map(area).sum()
}

/// The material of a square's only object, of an MTL of these lines, and what was said.
fn material(mtl: &str) -> (Phong, Vec<String>) {
    let text = format!("mtllib a.mtl\nusemtl a\n{SQUARE}f 1/1 2/2 3/3 4/4\n");
    let mtl = format!("newmtl a\n{mtl}\n");
    let (mut app, told, _folder) = open(&[("a.obj", text.as_bytes()), ("a.mtl", mtl.as_bytes())]);
    (objects(app.world_mut())[0].1.clone(), told)
}

pub(super) fn attribute(
    app: &mut App,
    id: bevy::mesh::MeshVertexAttribute,
) -> Option<VertexAttributeValues> {
    let world = app.world_mut();
    let mut meshes = world.query::<&Mesh3d>();
    let handle = meshes.iter(world).next().unwrap().0.clone();
    let meshes = world.resource::<Assets<Mesh>>();
    meshes.get(&handle).unwrap().attribute(id).cloned()
}

#[test]
fn a_concave_polygon_keeps_its_area() {
    let plus = "v 1 0 0\nv 2 0 0\nv 2 1 0\nv 3 1 0\nv 3 2 0\nv 2 2 0\nv 2 3 0\nv 1 3 0\nv 1 2 0\n\
                v 0 2 0\nv 0 1 0\nv 1 1 0\nf 1 2 3 4 5 6 7 8 9 10 11 12\n";
    let (mut app, told) = obj(plus);
    assert!((area(&mut app) - 5.0).abs() < 1e-5, "{}", area(&mut app));
    assert!(told.is_empty(), "{told:?}");
}

#[test]
fn a_polygon_that_crosses_itself_or_lies_on_a_line_is_shown_with_a_note() {
    for (face, what) in [("1 3 2 4", "crosses itself"), ("1 2 5 6", "without area")] {
        let (mut app, told) = obj(&format!("{SQUARE}v 2 0 0\nv 3 0 0\nf 1 2 3\nf {face}\n"));
        assert_eq!(objects(app.world_mut())[0].2.len(), 3);
        assert!(
            told[0].contains("a.obj:12") && told[0].contains(what),
            "{told:?}"
        );
    }
}

#[test]
fn lines_and_points_are_no_faces() {
    let (mut app, told) = obj(&format!(
        "{SQUARE}o outline\nl 1 2 3 4\np 1\no face\nf 1 2 3\n"
    ));
    assert_eq!(area(&mut app), 0.5);
    assert!(
        told[0].contains("a.obj:10") && told[0].contains("(2 times)"),
        "{told:?}"
    );
}

#[test]
fn text_is_read_however_it_is_encoded_and_spaced() {
    let plain = format!("# C:\\\n{SQUARE}f 1 2 3 # the face\n");
    let wide: Vec<u8> = plain.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [
        [b"\xef\xbb\xbf", plain.as_bytes()].concat(),
        plain.replace('\n', "\r").into_bytes(),
        plain.replace('\n', "\r\n").into_bytes(),
        plain.replace(' ', "\t").into_bytes(),
        plain.replace("f 1 2 3", "F 1.0 2 \\\n3").into_bytes(),
        [&[0xff, 0xfe], &wide[..]].concat(),
    ] {
        let (mut app, told, _folder) = open(&[("a.obj", &bytes[..])]);
        assert_eq!(area(&mut app), 0.5, "{bytes:?}");
        assert!(told.is_empty(), "{bytes:?}: {told:?}");
    }
}

#[test]
fn materials_are_found_wherever_their_library_is_named_and_however_it_is_spelt() {
    let square = format!("{SQUARE}f 1 2 3\n");
    for (head, tail) in [
        ("mtllib one.mtl two.mtl\nusemtl Red Paint#1", ""),
        ("usemtl Red Paint#1", "mtllib two.mtl"),
        ("mtllib \"two.mtl\"\nusemtl Red Paint#1", ""),
        ("mtllib .\\two.mtl\nusemtl Red Paint#1 # of the wall", ""),
        ("mtllib TWO.mtl\nusemtl red paint#1", ""),
        ("mtllib my lib.mtl\nusemtl Red Paint#1", ""),
        ("mtllib one.mtl my lib.mtl\nusemtl Red Paint#1", ""),
        ("mtllib my lib.mtl  one.mtl\nusemtl Red Paint#1", ""),
    ] {
        let text = format!("{head}\n{square}{tail}\n");
        let red: &[u8] = b"newmtl Red Paint#1\nkd 1 0 0\n";
        let (mut app, told, _folder) = open(&[
            ("a.obj", text.as_bytes()),
            ("one.mtl", &b"newmtl blue\n"[..]),
            ("two.mtl", red),
            ("my lib.mtl", red),
        ]);
        let diffuse = objects(app.world_mut())[0].1.diffuse;
        assert_eq!(diffuse, LinearRgba::RED, "{head}: {told:?}");
        let is_guess = head.contains("TWO");
        assert_eq!(told.len(), if is_guess { 2 } else { 0 }, "{head}: {told:?}");
    }
}

#[test]
fn a_picture_is_found_however_its_name_is_spelt() {
    for (name, is_guess) in [
        ("wall.png", false),
        ("\"wall.png\"", false),
        (".\\wall.png", false),
        ("wall.png # old", false),
        ("WALL.png", true),
        ("C:\\art\\Wall.PNG", true),
        ("'wall.png'", false),
    ] {
        let (phong, told) = material(&format!("map_Kd {name}"));
        let path = phong.diffuse_map.map(|map| map.path).unwrap_or_default();
        assert!(path.ends_with("wall.png"), "{name}: {path}");
        assert_eq!(told.len(), usize::from(is_guess), "{name}: {told:?}");
    }
}

#[test]
fn a_picture_is_placed_by_its_options() {
    let mtl: &[u8] = b"newmtl a\nmap_Kd -s 2 3 1 -o 0.5 0.25 0 -blendu on -bm 1 wall.png\n";
    let text = format!("mtllib a.mtl\nusemtl a\n{SQUARE}f 1/1 2/2 3/3\n");
    let (mut app, told, _folder) = open(&[("a.obj", text.as_bytes()), ("a.mtl", mtl)]);
    assert!(told.is_empty(), "{told:?}");
    let Some(VertexAttributeValues::Float32x2(uvs)) = attribute(&mut app, Mesh::ATTRIBUTE_UV_0)
    else {
        panic!("no texture coordinates");
    };
    // v counts downwards here.
    assert_eq!(uvs, [[0.5, 0.75], [2.5, 0.75], [2.5, -2.25]]);
    let (_, told) = material("map_Kd -clamp on -imfchan r wall.png");
    assert_eq!(told.len(), 1, "{told:?}");
}

#[test]
fn a_factor_and_its_picture_are_multiplied_and_go_together() {
    let (glow, half) = (
        LinearRgba::rgb(3.0, 2.0, 1.0),
        LinearRgba::rgb(0.5, 0.5, 0.5),
    );
    let path = |source: Option<&TextureSource>| source.map(|source| source.path.clone());
    for (lines, emission, picture) in [
        ("Ke 3 2 1\nmap_Ke wall.png", glow, Some("wall.png")),
        ("Ke 3 2 1\nmap_Ke gone.png", LinearRgba::BLACK, None),
        ("Ke 3 2 1", glow, None),
        ("map_Ke wall.png", LinearRgba::WHITE, Some("wall.png")),
    ] {
        let (phong, told) = material(lines);
        assert_eq!(phong.emission, emission, "{lines}");
        assert_eq!(
            path(phong.emission_map.as_ref()).as_deref(),
            picture,
            "{lines}"
        );
        assert_eq!(told.len(), usize::from(lines.contains("gone")), "{told:?}");
    }
    for (lines, specular, mirror, picture) in [
        (
            "Ks .5 .5 .5\nmap_Ks wall.png",
            half,
            LinearRgba::BLACK,
            Some("wall.png"),
        ),
        (
            "illum 3\nKs .5 .5 .5\nmap_Ks wall.png",
            half,
            half,
            Some("wall.png"),
        ),
        (
            "illum 3\nKs .5 .5 .5\nmap_Ks gone.png",
            LinearRgba::BLACK,
            LinearRgba::BLACK,
            None,
        ),
        (
            "illum 1\nKs .5 .5 .5\nmap_Ks wall.png",
            LinearRgba::BLACK,
            LinearRgba::BLACK,
            None,
        ),
    ] {
        let (phong, _) = material(lines);
        assert_eq!(
            (phong.specular, phong.mirror),
            (specular, mirror),
            "{lines}"
        );
        assert_eq!(
            path(phong.specular_map.as_ref()).as_deref(),
            picture,
            "{lines}"
        );
        let mirrored = picture.filter(|_| mirror != LinearRgba::BLACK);
        assert_eq!(
            path(phong.mirror_map.as_ref()).as_deref(),
            mirrored,
            "{lines}"
        );
    }
    for (lines, diffuse) in [
        ("Kd .5 .5 .5\nmap_Kd wall.png", half),
        ("Kd 0 0 0\nmap_Kd wall.png", LinearRgba::WHITE),
        ("map_Kd wall.png", LinearRgba::WHITE),
        ("Kd 0 0 0", LinearRgba::BLACK),
    ] {
        let (phong, _) = material(lines);
        assert_eq!(phong.diffuse, diffuse, "{lines}");
    }
}

#[test]
fn a_normal_map_and_clamped_pictures_are_read() {
    let (phong, told) = material("norm -bm 0.5 wall.png\nmap_Kd -clamp on wall.png");
    assert!(told.is_empty(), "{told:?}");
    assert_eq!(phong.normal_scale, 0.5);
    assert_eq!(phong.normal_map, Some(TextureSource::new("wall.png")));
    let clamped = TextureSource {
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Clamp,
        ..TextureSource::new("wall.png")
    };
    assert_eq!(phong.diffuse_map, Some(clamped));
}

#[test]
fn colours_of_vertices_without_a_material_are_shown_as_they_are() {
    let (mut app, _) = obj("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n");
    assert_eq!(objects(app.world_mut())[0].1.diffuse, LinearRgba::WHITE);
    let (mut app, _) = obj(&format!("{SQUARE}f 1 2 3\n"));
    let default = Phong::default().diffuse;
    assert_eq!(objects(app.world_mut())[0].1.diffuse, default);
}

#[test]
fn an_opacity_picture_in_half_floats_counts_with_its_alpha_where_it_has_any() {
    use exr::prelude::{f16, write_rgba_file};
    for (alpha, expected) in [(0.5, "leaf.exr#alpha"), (1.0, "leaf.exr")] {
        let folder = tempfile::tempdir().unwrap();
        let [r, g, b, a] = [0.25, 0.5, 0.125, alpha].map(f16::from_f32);
        let file = folder.path().join("leaf.exr");
        write_rgba_file(file, 2, 2, |_, _| (r, g, b, a)).unwrap();
        write(folder.path(), "a.mtl", "newmtl a\nmap_d leaf.exr\n");
        let text = format!("mtllib a.mtl\nusemtl a\n{SQUARE}f 1/1 2/2 3/3\n");
        let (mut app, _) = opened(&write(folder.path(), "a.obj", text));
        let map = objects(app.world_mut())[0].1.opacity_map.clone();
        assert_eq!(map.map(|map| map.path).as_deref(), Some(expected));
    }
}

#[test]
fn illum_says_whether_there_is_a_highlight_and_whether_there_is_a_mirror() {
    let highlight = LinearRgba::rgb(0.25, 0.5, 0.75);
    for (illum, specular, mirror) in [
        ("illum 0", LinearRgba::BLACK, LinearRgba::BLACK),
        ("illum 1", LinearRgba::BLACK, LinearRgba::BLACK),
        ("illum 2", highlight, LinearRgba::BLACK),
        ("", highlight, LinearRgba::BLACK),
        ("illum 3", highlight, highlight),
        ("illum 5", highlight, highlight),
        ("illum 8", highlight, highlight),
        ("illum 10", highlight, LinearRgba::BLACK),
    ] {
        let (phong, _) = material(&format!("{illum}\nKs 0.25 0.5 0.75"));
        assert_eq!(
            (phong.specular, phong.mirror),
            (specular, mirror),
            "{illum}"
        );
    }
}

#[test]
fn a_very_wide_highlight_fades_and_the_mirror_does_not() {
    let (phong, _) = material("illum 2\nKs 0.5 0.5 0.5\nNs 0.25");
    assert_eq!(phong.shininess, 1.0);
    assert_eq!(phong.specular, LinearRgba::rgb(0.125, 0.125, 0.125));
    let (phong, _) = material("illum 3\nKs 0.5 0.5 0.5\nNs 0.25");
    assert_eq!(phong.mirror, LinearRgba::rgb(0.5, 0.5, 0.5));
}

#[test]
fn an_opacity_picture_counts_with_its_alpha_where_it_has_any() {
    use image::{Rgba, RgbaImage};
    let folder = tempfile::tempdir().unwrap();
    for (alpha, expected) in [(100, Some("leaf.png#alpha")), (255, Some("leaf.png"))] {
        RgbaImage::from_pixel(2, 2, Rgba([10, 200, 10, alpha]))
            .save(folder.path().join("leaf.png"))
            .unwrap();
        for (others, expected) in [("", expected), ("map_Kd leaf.png\n", expected)] {
            write(
                folder.path(),
                "a.mtl",
                format!("newmtl a\n{others}map_d leaf.png\n"),
            );
            let text = format!("mtllib a.mtl\nusemtl a\n{SQUARE}f 1/1 2/2 3/3\n");
            let file = write(folder.path(), "a.obj", text);
            let (mut app, opened) = opened(&file);
            let phong = objects(app.world_mut())[0].1.clone();
            let path = phong.opacity_map.map(|map| map.path);
            // The colours' own picture, opaque, says nothing about opacity.
            let expected = expected.filter(|_| alpha < 255 || others.is_empty());
            assert_eq!(path.as_deref(), expected, "{:?}", opened.notes.lines());
        }
    }
}

#[test]
fn every_keyword_is_read_or_told() {
    let (_, told) = obj(&format!("{SQUARE}frobnicate 1 2\ncurv 0 1 1 2\nf 1 2 3\n"));
    assert!(
        told[0].contains("a.obj:9") && told[0].contains("`frobnicate`"),
        "{told:?}"
    );
    assert!(told[1].contains("free-form"), "{told:?}");
    let lines =
        "Ka 1 1 1\nTf 0.5 1 1\nPr 0.5\nPm 1\nmap_Pr wall.png\nmap_Bump wall.png\nrefl a.png\nfoo";
    let (_, told) = material(lines);
    let told = told.join("\n");
    for word in ["Ka", "Tf", "Pr", "Pm", "map_Pr", "map_Bump", "refl", "foo"] {
        assert!(told.contains(word), "{word}: {told}");
    }
}

#[test]
fn vertices_may_have_more_numbers_than_three() {
    let vertices =
        "v 0 0 0 1 0 0\nv 2 0 0 1 0 0\nv 0 2 0\nv 0 0 2 1\nv 0 0 0 1 0.5 0 1\nvt 0\nf 1 2 3\n";
    let (mut app, told) = obj(vertices);
    assert_eq!(area(&mut app), 2.0);
    assert_eq!(told.len(), 2, "{told:?}");
    let Some(VertexAttributeValues::Float32x4(colors)) = attribute(&mut app, Mesh::ATTRIBUTE_COLOR)
    else {
        panic!("no colours");
    };
    assert_eq!(
        colors,
        [[1.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0], [1.0; 4]]
    );
}

#[test]
fn smoothing_groups_give_normals_where_the_file_has_none() {
    // Two faces of a roof.
    let roof = "v 0 0 0\nv 0 1 0\nv 1 0 1\nv 1 1 1\nv 2 0 0\nv 2 1 0\n";
    let faces = "f 1 3 4 2\nf 3 5 6 4\n";
    let normals = |group: &str| {
        let (mut app, _) = obj(&format!("{roof}{group}\n{faces}"));
        attribute(&mut app, Mesh::ATTRIBUTE_NORMAL).map(|normals| match normals {
            VertexAttributeValues::Float32x3(normals) => normals,
            _ => panic!("normals of another kind"),
        })
    };
    assert_eq!(normals("s off"), None);
    assert_eq!(normals(""), None);
    let smooth = normals("s 1").unwrap();
    assert_eq!(smooth.len(), 6, "the ridge is shared");
    let ridge = smooth
        .iter()
        .filter(|n| Vec3::from(**n).abs_diff_eq(Vec3::Z, 1e-6));
    assert_eq!(ridge.count(), 2, "{smooth:?}");
}

#[test]
fn a_face_without_texture_coordinates_leaves_those_of_the_others() {
    let mtl: &[u8] = b"newmtl a\nmap_Kd wall.png\n";
    let text = format!("mtllib a.mtl\no wall\nusemtl a\n{SQUARE}f 1/1 2/2 3/3\nf 1 3 4\n");
    let (mut app, told, _folder) = open(&[("a.obj", text.as_bytes()), ("a.mtl", mtl)]);
    assert!(told.is_empty(), "{told:?}");
    let objects = objects(app.world_mut());
    let names: Vec<&str> = objects.iter().map(|object| object.0.as_str()).collect();
    assert_eq!(names, ["wall", "wall without picture"]);
    assert_eq!(area(&mut app), 1.0);
}
