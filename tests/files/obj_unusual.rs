//! What few OBJ files hold, and other readers open all the same.

use super::app::{opened, write};
use super::models::objects;
use super::obj::{SQUARE, area, attribute, obj, open};
use bevy::mesh::{Mesh, VertexAttributeValues};
use glassbox::scene::{Phong, Wrap};

#[test]
fn seven_numbers_are_a_colour_with_alpha_or_w_and_a_colour() {
    for (numbers, color) in [
        ("1 0 0 1", [1.0, 0.0, 0.0]),
        ("1 1 0 0", [1.0, 0.0, 0.0]),
        ("0 1 0 1", [0.0, 1.0, 0.0]),
    ] {
        let vertices =
            format!("v 0 0 0 {numbers}\nv 1 0 0 {numbers}\nv 0 1 0 {numbers}\nf 1 2 3\n");
        let (mut app, _) = obj(&vertices);
        let Some(VertexAttributeValues::Float32x4(colors)) =
            attribute(&mut app, Mesh::ATTRIBUTE_COLOR)
        else {
            panic!("no colours");
        };
        let [r, g, b] = color;
        assert_eq!(colors, [[r, g, b, 1.0]; 3], "{numbers}");
    }
}

#[test]
fn colours_of_vertices_are_traced_and_nothing_else_is_said_of_them() {
    let (_, told) = obj("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n");
    assert!(told.is_empty(), "{told:?}");
}

#[test]
fn a_comment_behind_a_number_and_a_name_that_ends_in_a_backslash_hide_nothing() {
    for text in [
        "v 0 0 0#a\nv 1 0 0 # b\nv 0 1 0\nf 1 2 3#c\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\no C:\\art\\\nf 1 2 3\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1.#INF 0 0\nf 1 2 3\n",
    ] {
        let (mut app, _) = obj(text);
        assert_eq!(area(&mut app), 0.5, "{text}");
    }
}

#[test]
fn a_model_that_lies_far_off_keeps_its_digits_near_the_origin() {
    let far = |x: f64, y: f64| format!("v {:?} {:?} 120.5\n", 500_000.0 + x, 4_500_000.0 + y);
    let corners = far(0.0, 0.0) + &far(0.25, 0.0) + &far(0.25, 0.01) + &far(0.0, 0.01);
    let (mut app, told) = obj(&(corners + "f 1 2 3 4\n"));
    let found = area(&mut app);
    // Where it lies, floats tell 0.03 and 0.5 apart.
    assert!((found - 0.0025).abs() < 1e-6, "{found}: {told:?}");
    assert!(
        told.len() == 1 && told[0].contains("500000 4500000 121"),
        "{told:?}"
    );
    // One that is large, and whose first vertex lies outside, is left where it is.
    let (mut app, told) = obj("v 9000 0 0\nv 0 9000.0625 0\nv 0 0 0\nf 1 2 3\n");
    assert!(told.is_empty(), "{told:?}");
    assert_eq!(objects(app.world_mut())[0].2[0][1], [0.0, 9000.0625, 0.0]);
}

#[test]
fn pictures_without_texture_coordinates_and_triangles_without_area_are_told() {
    let text = "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let files = [
        ("a.obj", text.as_bytes()),
        ("a.mtl", &b"newmtl a\nmap_Kd wall.png\n"[..]),
    ];
    let (_, told, _folder) = open(&files);
    assert!(
        told.len() == 1 && told[0].contains("no texture coordinates"),
        "{told:?}"
    );
    let (_, told) = obj("v 1 1 1\nf 1 1 1\n");
    assert!(
        told.iter()
            .any(|line| line.contains("none of them has an area")),
        "{told:?}"
    );
}

#[test]
fn a_bump_map_that_holds_normals_is_a_normal_map_and_heights_are_told() {
    for (color, is_normals) in [
        ([128, 128, 255], true),
        ([128; 3], false),
        ([200, 100, 50], false),
    ] {
        let folder = tempfile::tempdir().unwrap();
        image::RgbImage::from_pixel(2, 2, image::Rgb(color))
            .save(folder.path().join("bump.png"))
            .unwrap();
        write(
            folder.path(),
            "a.mtl",
            "newmtl a\nmap_Bump -bm 0.5 bump.png\n",
        );
        let text = format!("mtllib a.mtl\nusemtl a\n{SQUARE}f 1/1 2/2 3/3\n");
        let (mut app, opened) = opened(&write(folder.path(), "a.obj", text));
        let phong = objects(app.world_mut())[0].1.clone();
        let told = opened.notes.lines().join("\n");
        assert_eq!(phong.normal_map.is_some(), is_normals, "{color:?}: {told}");
        assert_eq!(
            phong.normal_scale,
            if is_normals { 0.5 } else { 1.0 },
            "{color:?}"
        );
        assert!(told.contains("map_Bump"), "{color:?}: {told}");
    }
}

/// What remains of a line of options before the picture `wall.png`: the material, and what was told.
fn with_map(line: &str) -> (Phong, String) {
    let folder = tempfile::tempdir().unwrap();
    image::RgbImage::from_pixel(2, 2, image::Rgb([0, 0, 255]))
        .save(folder.path().join("wall.png"))
        .unwrap();
    write(folder.path(), "a.mtl", format!("newmtl a\n{line}\n"));
    let text = format!("mtllib a.mtl\nusemtl a\n{SQUARE}f 1/1 2/2 3/3\n");
    let (mut app, opened) = opened(&write(folder.path(), "a.obj", text));
    let phong = objects(app.world_mut())[0].1.clone();
    (phong, opened.notes.lines().join("\n"))
}

#[test]
fn options_behind_a_picture_s_name_and_such_as_there_are_none_do_not_cost_the_picture() {
    let (phong, told) = with_map("map_Kd wall.png -clamp on");
    let map = phong.diffuse_map.expect("a picture");
    assert_eq!((map.path.as_str(), map.wrap_u), ("wall.png", Wrap::Clamp));
    assert!(!told.contains("a.mtl"), "{told}");
    let (phong, told) = with_map("map_Kd wall.png -clamp on black");
    assert!(
        phong.diffuse_map.is_some() && told.contains("behind a picture"),
        "{told}"
    );
    for line in [
        "map_Kd -colorspace srgb wall.png",
        "map_Kd -linear wall.png",
        "map_Kd -colorspace srgb -clamp on wall.png",
    ] {
        let (phong, told) = with_map(line);
        assert!(phong.diffuse_map.is_some(), "{line}: {told}");
        assert!(told.contains("which is none"), "{line}: {told}");
    }
    let (phong, told) = with_map("map_Kd -gone and.png");
    assert_eq!(phong.diffuse_map, None);
    assert!(told.contains("`-gone and.png`"), "{told}");
}

#[test]
fn words_behind_the_corners_of_a_face_do_not_cost_the_face() {
    let (mut app, told) = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 front\n");
    assert_eq!(area(&mut app), 0.5);
    assert!(
        told.len() == 1 && told[0].contains("behind the corners"),
        "{told:?}"
    );
}

#[test]
fn words_of_an_mtl_that_are_none_of_the_format_s_are_told() {
    for (line, what) in [
        ("map_Kd -clamp maybe wall.png", "`-clamp`"),
        ("illum 10", "`illum` of 10"),
        ("illum 11", "`illum` that is none"),
    ] {
        let (_, told) = with_map(line);
        assert!(told.contains(what), "{line}: {told}");
    }
    for line in ["map_Kd -clamp off wall.png", "illum 9"] {
        let (_, told) = with_map(line);
        assert!(!told.contains("a.mtl"), "{line}: {told}");
    }
}

#[test]
fn colours_that_zbrush_writes_in_comments_are_those_of_the_vertices() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n#MRGB ffff0000ff00ff00\n#MRGB ff0000ff\nf 1 2 3\n";
    let (mut app, told) = obj(text);
    let colors = attribute(&mut app, Mesh::ATTRIBUTE_COLOR);
    let Some(VertexAttributeValues::Float32x4(colors)) = colors else {
        panic!("no colours: {told:?}");
    };
    let [r, g, b] = [
        [1.0, 0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0, 1.0],
        [0.0, 0.0, 1.0, 1.0],
    ];
    assert_eq!(colors, [r, g, b]);
    assert!(told.is_empty(), "{told:?}");
    let (_, told) = obj(&text.replace("ff0000ff", "ff0000ffff0000ffzz"));
    assert!(
        told.len() == 1 && told[0].contains("of no vertex"),
        "{told:?}"
    );
}

#[test]
fn colours_a_little_above_1_are_no_numbers_up_to_255() {
    let text = "v 0 0 0 1.0001 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n";
    let (mut app, told) = obj(text);
    let colors = attribute(&mut app, Mesh::ATTRIBUTE_COLOR);
    let Some(VertexAttributeValues::Float32x4(colors)) = colors else {
        panic!("no colours: {told:?}");
    };
    assert_eq!(colors, [[1.0, 0.0, 0.0, 1.0]; 3]);
    assert!(told.len() == 1 && told[0].contains("clamped"), "{told:?}");
}

#[test]
fn a_picture_beside_the_obj_is_found_where_the_mtl_lies_elsewhere() {
    let text = format!("mtllib lib/a.mtl\nusemtl a\n{SQUARE}f 1/1 2/2 3/3 4/4\n");
    let mtl = "newmtl a\nmap_Kd wall.png\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("lib")).unwrap();
    write(folder.path(), "lib/a.mtl", mtl);
    glassbox::io::write_picture(&folder.path().join("wall.png"), 1, 1, &[[0.5; 3]]).unwrap();
    let (mut app, opened) = opened(&write(folder.path(), "a.obj", text));
    let map = objects(app.world_mut())[0].1.diffuse_map.clone();
    assert_eq!(map.map(|map| map.path).as_deref(), Some("wall.png"));
    let told = opened.notes.lines();
    assert!(
        told.iter().any(|line| line.contains("folder is another")),
        "{told:?}"
    );
}

#[test]
fn what_cannot_be_seen_is_told() {
    for line in ["d 0", "Tr 1"] {
        let text = format!("mtllib a.mtl\nusemtl a\n{SQUARE}f 1 2 3\n");
        let mtl = format!("newmtl a\n{line}\n");
        let (_, told, _folder) = open(&[("a.obj", text.as_bytes()), ("a.mtl", mtl.as_bytes())]);
        assert!(
            told.iter().any(|line| line.contains("opacity of 0")),
            "{told:?}"
        );
    }
}
