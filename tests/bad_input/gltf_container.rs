//! glTF's text, and the container that may be around it.

use super::gltf::{bytes, changed, triangle};
use super::{opens_and_says, refused, says};
use crate::files::app::{opened, write};
use glassbox::io::OpenOptions;
use serde_json::json;

#[test]
fn another_version_of_gltf() {
    let (_folder, file) = changed(|d| d["asset"]["version"] = json!("1.0"));
    says(&refused(&file), &["a.gltf", "glTF 1.0"]);
    // That version had objects where there are lists now.
    let (_folder, file) = changed(|d| {
        d["asset"] = json!({});
        d["meshes"] = json!({ "lid": {} });
    });
    says(&refused(&file), &["a.gltf", "glTF 1.0"]);
}

#[test]
fn version_2_without_a_point_is_2() {
    let (_folder, file) = changed(|d| d["asset"]["version"] = json!("2"));
    let (mut app, _) = opened(&file);
    assert_eq!(crate::files::models::objects(app.world_mut()).len(), 1);
}

#[test]
fn numbers_that_json_does_not_have_are_none() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.bin", bytes([0, 1, 2]));
    let text = triangle().to_string();
    for (number, name) in [
        ("NaN", "a.gltf"),
        ("-Infinity", "b.gltf"),
        ("1e400", "c.gltf"),
    ] {
        let text = text.replace(r#""max":[1.0,"#, &format!(r#""max":[{number},"#));
        assert!(text.contains(number));
        let file = write(folder.path(), name, text);
        assert_eq!(opens_and_says(&file, &[name, "JSON does not have"]), 1);
    }
}

#[test]
fn names_in_an_old_encoding_do_not_cost_the_document() {
    let (folder, _) = changed(|_| {});
    let text = triangle().to_string();
    let text = text.replace(r#""nodes":[{"#, r#""nodes":[{"name":"caf_","#);
    let mut text = text.into_bytes();
    for byte in text.iter_mut().filter(|byte| **byte == b'_') {
        *byte = 0xe9;
    }
    let file = write(folder.path(), "b.gltf", text);
    let (mut app, opened) = opened(&file);
    let said = opened.notes.lines();
    assert!(
        said.iter().any(|line| line.contains("no UTF-8")),
        "{said:?}"
    );
    let world = app.world_mut();
    let mut names = world.query::<&bevy::ecs::name::Name>();
    let found = names.iter(world).any(|name| name.as_str() == "caf\u{e9}");
    assert!(found, "no entity has the name");
}

#[test]
fn text_in_utf_16_is_called_so() {
    let folder = tempfile::tempdir().unwrap();
    let text = triangle().to_string();
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let file = write(folder.path(), "a.gltf", [&[0xff, 0xfe], &wide[..]].concat());
    says(&refused(&file), &["a.gltf", "UTF-16"]);
}

#[test]
fn a_document_that_is_not_json() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "a.gltf", "{\n  \"asset\": ]\n}");
    says(&refused(&file), &["a.gltf:2:"]);
    let file = write(folder.path(), "b.gltf", "{ \"asset\": {");
    says(&refused(&file), &["b.gltf", "ends too early"]);
}

#[test]
fn a_glb_that_ends_too_early() {
    let folder = tempfile::tempdir().unwrap();
    let (_keep, file) = changed(|_| {});
    let (mut app, _) = opened(&file);
    let glb = folder.path().join("a.glb");
    glassbox::io::save(app.world_mut(), &glb).unwrap();
    let whole = std::fs::read(&glb).unwrap();
    for length in [3, 11, 19, 40, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&glb, &whole[..length]).unwrap();
        says(&refused(&glb), &["a.glb"]);
    }
}

#[test]
fn a_glb_whose_lengths_are_not_the_files_is_read_as_far_as_it_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = serde_json::to_vec(&triangle()).unwrap();
    let uri = br#","uri":"a.bin""#;
    let at = text.windows(uri.len()).position(|part| part == uri);
    let at = at.expect("the buffer's file");
    text.splice(at..at + uri.len(), []);
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut blob = bytes([0, 1, 2]);
    blob.resize(44, 0);
    let glb = |total: i64, blob_size: usize, tail: &[u8]| {
        let whole = 28 + text.len() + blob.len() + tail.len();
        let total = (whole as i64 + total) as u32;
        let mut out = [*b"glTF", 2_u32.to_le_bytes(), total.to_le_bytes()].concat();
        out.extend((text.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(&text);
        out.extend((blob_size as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(&blob);
        out.extend(tail);
        write(folder.path(), "a.glb", out)
    };
    let whole = glb(0, 44, &[]);
    let (_, opened) = opened(&whole);
    let told = opened.notes.lines();
    assert!(told.iter().all(|note| note.contains("added")), "{told:?}");
    let past_the_json = -8 - blob.len() as i64;
    let nothing = -((28 + text.len() + blob.len()) as i64);
    for (total, blob_size, tail) in [
        (nothing, 44, &[][..]),
        (nothing + 11, 44, &[]),
        (4, 44, &[]),
        (i64::from(u32::MAX >> 1), 44, &[]),
        (past_the_json, 44, &[]),
        (-4, 44, &[]),
        (0, 48, &[]),
        (0, 44, &[0, 0]),
    ] {
        let file = glb(total, blob_size, tail);
        let note = ["a.glb", "lengths of its parts", "what is there is read"];
        assert_eq!(
            opens_and_says(&file, &note),
            1,
            "{total} {blob_size} {tail:?}"
        );
    }
}

#[test]
fn a_glb_that_is_a_header_and_nothing_that_it_could_be_of() {
    let folder = tempfile::tempdir().unwrap();
    for length in [0_u32, 11] {
        let header = [*b"glTF", 2_u32.to_le_bytes(), length.to_le_bytes()].concat();
        let glb = write(folder.path(), "a.glb", [header, vec![0; 28]].concat());
        says(&refused(&glb), &["a.glb", "the header of a part"]);
    }
}

#[test]
fn a_glb_with_any_byte_of_its_head_changed_does_not_panic() {
    let folder = tempfile::tempdir().unwrap();
    let (_keep, file) = changed(|_| {});
    let (mut source, _) = opened(&file);
    let glb = folder.path().join("a.glb");
    glassbox::io::save(source.world_mut(), &glb).unwrap();
    let whole = std::fs::read(&glb).unwrap();
    let mut app = crate::files::app::app();
    let mut refused = 0;
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x15;
        std::fs::write(&glb, &damaged).unwrap();
        let source = glassbox::io::SceneSource::File(glb.clone());
        let result = glassbox::io::open(app.world_mut(), &source, OpenOptions::default());
        refused += usize::from(result.is_err());
    }
    // The header at least, and what positions need; most else is left out with a note.
    assert!(refused > 20, "{refused} of {} were refused", whole.len());
}
