use super::{refused, says};
use crate::files::app::{app, write};
use glassbox::io::{OpenOptions, SceneSource, open};
use std::path::PathBuf;
use tempfile::TempDir;

const VERSION: &str = "\"glassbox::io::FileVersion\": (1),";

/// A folder with a scene of one entity with these components.
fn scene(components: &str) -> (TempDir, PathBuf) {
    scene_of(&format!(
        "(resources: {{{VERSION}}}, entities: {{1: (components: {{\n{components}\n}})}})"
    ))
}

fn scene_of(text: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "a.scn.ron", text);
    (folder, file)
}

#[test]
fn a_scene_written_by_hand_with_the_least_in_it_opens() {
    let (_folder, file) = scene("\"glassbox::scene::PointLamp\": ()");
    let mut app = app();
    let source = SceneSource::File(file);
    open(app.world_mut(), &source, OpenOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let world = app.world_mut();
    let mut query = world.query::<(&glassbox::scene::PointLamp, &glassbox::scene::SceneId)>();
    let ids: Vec<_> = query.iter(world).map(|(_, id)| id.0).collect();
    assert_eq!(ids, [1]);
}

#[test]
fn an_unknown_component() {
    let (_folder, file) = scene("\"glassbox::scene::LaserBeam\": (power: 9)");
    says(
        &refused(&file),
        &[
            "a.scn.ron:2:",
            "glassbox::scene::LaserBeam",
            "not a component",
        ],
    );
}

#[test]
fn a_component_of_bevy_that_scenes_do_not_keep() {
    let (_folder, file) = scene("\"bevy_mesh::components::Mesh3d\": ()");
    says(
        &refused(&file),
        &["a.scn.ron:2:", "Mesh3d", "not a component"],
    );
}

#[test]
fn a_value_where_a_component_belongs() {
    let (_folder, file) = scene("\"glam::Vec3\": (1.0, 2.0, 3.0)");
    says(
        &refused(&file),
        &["a.scn.ron: entity 1", "Vec3", "not a component"],
    );
}

#[test]
fn a_newer_version_even_with_components_that_are_unknown() {
    let (_folder, file) = scene_of(
        "(resources: {\"glassbox::io::FileVersion\": (3)}, entities: {1: (components: {\"new\": Some((a: [1, 'x']))})})",
    );
    says(
        &refused(&file),
        &["a.scn.ron", "newer Glassbox", "file version 3", "up to 2"],
    );
}

#[test]
fn a_version_before_the_first() {
    let (_folder, file) =
        scene_of("(resources: {\"glassbox::io::FileVersion\": (0)}, entities: {})");
    says(&refused(&file), &["a.scn.ron", "FileVersion", "first is 1"]);
}

#[test]
fn an_entity_that_is_there_twice() {
    let (_folder, file) = scene_of(
        "(resources: {\"glassbox::io::FileVersion\": (2)}, entities: {7: (components: {}), 7: (components: {})})",
    );
    says(&refused(&file), &["a.scn.ron: entity 7", "twice"]);
}

#[test]
fn a_scene_without_a_version() {
    let (_folder, file) = scene_of("(resources: {}, entities: {})");
    says(&refused(&file), &["a.scn.ron", "FileVersion"]);
}

#[test]
fn a_scene_that_ends_too_early() {
    let (_folder, file) = scene("\"glassbox::scene::PointLamp\": ()");
    let text = std::fs::read_to_string(&file).unwrap();
    for length in [1, 20, text.len() / 2, text.len() - 1] {
        std::fs::write(&file, &text[..length]).unwrap();
        says(&refused(&file), &["a.scn.ron"]);
    }
}

#[test]
fn a_scene_that_is_blank() {
    let (_folder, file) = scene_of("  \n");
    says(&refused(&file), &["a.scn.ron", "is empty"]);
}

#[test]
fn a_scene_that_is_not_text() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "a.scn.ron", b"(\n\xff\xfe)");
    says(&refused(&file), &["a.scn.ron:2", "not UTF-8"]);
}

#[test]
fn a_scene_with_something_after_its_end() {
    let (_folder, file) = scene_of(&format!("(resources: {{{VERSION}}}, entities: {{}}) more"));
    says(&refused(&file), &["a.scn.ron:1:"]);
}

#[test]
fn a_field_of_the_wrong_type() {
    let (_folder, file) = scene("\"glassbox::scene::PointLamp\": (intensity: \"bright\")");
    says(&refused(&file), &["a.scn.ron:2:"]);
}

#[test]
fn a_field_that_does_not_exist() {
    let (_folder, file) = scene("\"glassbox::scene::PointLamp\": (brightness: 1.0)");
    says(&refused(&file), &["a.scn.ron:2:", "brightness"]);
}

#[test]
fn a_choice_that_lacks_a_field() {
    for (source, lacks) in [
        ("File(path: \"a.obj\")", "`File.name`"),
        ("Shape(Sphere(radius: 1.0))", "`Sphere.segments`"),
    ] {
        let (_folder, file) = scene(&format!("\"glassbox::scene::MeshSource\": {source}"));
        says(
            &refused(&file),
            &["a.scn.ron: entity 1", "MeshSource", "lacks", lacks],
        );
    }
}

#[test]
fn a_number_that_could_not_be_written_again() {
    let (_folder, file) = scene("\"glassbox::scene::SceneId\": (4294967296)");
    says(
        &refused(&file),
        &["entity 1", "SceneId", "4294967296", "2^32"],
    );
}

#[test]
fn numbers_outside_their_ranges() {
    for (component, what) in [
        (
            "PointLamp\": (intensity: -1.0)",
            "PointLamp.intensity is -1",
        ),
        (
            "PointLamp\": (intensity: inf)",
            "PointLamp.intensity is inf",
        ),
        (
            "PointLamp\": (cone: Some((inner: 0.5, outer: 0.4)))",
            "cone.inner is 0.5",
        ),
        ("Phong\": (shininess: 0.5)", "Phong.shininess is 0.5"),
        ("Phong\": (opacity: 1.5)", "Phong.opacity is 1.5"),
        (
            "SceneCamera\": (projection: Perspective(fov_y: 3.2))",
            "fov_y is 3.2",
        ),
        (
            "SceneCamera\": (projection: Orthographic(height: 0.0))",
            "height is 0",
        ),
        (
            "SceneCamera\": (shutter_open: 0.9, shutter_close: 0.8)",
            "shutter_open is 0.9",
        ),
        ("Lens\": (samples: 1001)", "Lens.samples is 1001"),
        ("Lens\": (focus_distance: 0.0)", "Lens.focus_distance is 0"),
        ("SegmentLamp\": (samples: 0)", "SegmentLamp.samples is 0"),
    ] {
        let (_folder, file) = scene(&format!("\"glassbox::scene::{component}"));
        says(&refused(&file), &["a.scn.ron: entity 1", what, "must be"]);
    }
    let (_folder, file) = scene(
        "\"bevy_transform::components::transform::Transform\": (translation: (NaN, 0.0, 0.0), rotation: (0.0, 0.0, 0.0, 1.0), scale: (1.0, 1.0, 1.0))",
    );
    says(
        &refused(&file),
        &["a.scn.ron: entity 1", "Transform", "NaN"],
    );
}

#[test]
fn render_settings_that_cannot_be_rendered() {
    for (settings, what) in [
        ("size: (0, 0)", "size is 0x0"),
        ("size: (65536, 65536)", "together"),
        ("size: (2147483648, 1)", "size is 2147483648x1"),
        ("spp: 0", "spp is 0"),
        ("spp: 2147483648", "spp is 2147483648"),
        ("max_depth: 51", "max_depth is 51"),
        ("tree: (bins: 1)", "bins is 1"),
        ("jitter: 17", "jitter is 17"),
    ] {
        let (_folder, file) = scene_of(&format!(
            "(resources: {{{VERSION} \"glassbox::scene::RenderSettings\": ({settings})}}, entities: {{}})"
        ));
        says(&refused(&file), &["a.scn.ron: resources", what]);
    }
}

#[test]
fn two_entities_with_the_same_scene_id() {
    let (_folder, file) = scene_of(&format!(
        "(resources: {{{VERSION}}}, entities: {{
            1: (components: {{\"glassbox::scene::SceneId\": (5)}}),
            2: (components: {{\"glassbox::scene::SceneId\": (5)}}),
        }})"
    ));
    says(&refused(&file), &["a.scn.ron: entity 2", "SceneId 5"]);
}

#[test]
fn a_parent_that_does_not_exist() {
    let (_folder, file) = scene("\"bevy_ecs::hierarchy::ChildOf\": (9)");
    says(&refused(&file), &["a.scn.ron: entity 1", "entity 9"]);
}

#[test]
fn a_material_that_does_not_exist() {
    let (_folder, file) = scene("\"glassbox::scene::UsesMaterial\": (9)");
    says(&refused(&file), &["a.scn.ron: entity 1", "entity 9"]);
}

#[test]
fn an_entity_among_its_own_ancestors() {
    let (_folder, file) = scene_of(&format!(
        "(resources: {{{VERSION}}}, entities: {{
            1: (components: {{\"bevy_ecs::hierarchy::ChildOf\": (2)}}),
            2: (components: {{\"bevy_ecs::hierarchy::ChildOf\": (1)}}),
        }})"
    ));
    says(&refused(&file), &["a.scn.ron: entity", "own ancestors"]);
}

#[test]
fn entities_nested_a_thousand_deep() {
    let child = |id| {
        format!(
            "{id}: (components: {{\"bevy_ecs::hierarchy::ChildOf\": ({})}}),",
            id - 1
        )
    };
    let entities: String = (2..1000).map(child).collect();
    let (_folder, file) = scene_of(&format!(
        "(resources: {{{VERSION}}}, entities: {{1: (components: {{}}), {entities}}})"
    ));
    says(
        &refused(&file),
        &["a.scn.ron: entity", "ancestors", "limit is 256"],
    );
}

#[test]
fn a_shape_with_impossible_numbers() {
    for shape in [
        "Sphere(radius: 1.0, segments: 2147483648, rings: 2147483648)",
        "Sphere(radius: -1.0, segments: 8, rings: 4)",
        "Teapot(divisions: 0)",
    ] {
        let (_folder, file) = scene(&format!("\"glassbox::scene::MeshSource\": Shape({shape})"));
        says(&refused(&file), &["a.scn.ron"]);
    }
}

#[test]
fn a_mesh_file_that_does_not_exist() {
    let (_folder, file) =
        scene("\"glassbox::scene::MeshSource\": File(path: \"gone.obj\", name: \"\")");
    says(
        &refused(&file),
        &["a.scn.ron", "gone.obj", "does not exist"],
    );
}

#[test]
fn a_mesh_that_its_file_does_not_have() {
    let (folder, file) =
        scene("\"glassbox::scene::MeshSource\": File(path: \"b.obj\", name: \"lid\")");
    write(
        folder.path(),
        "b.obj",
        "o pot\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    );
    says(&refused(&file), &["b.obj", "`lid`", "pot"]);
}

#[test]
fn a_mesh_outside_the_folder_of_its_scene() {
    for path in ["../b.obj", "/tmp/b.obj", "a/../../b.obj", "C:\\\\b.obj"] {
        let (_folder, file) = scene(&format!(
            "\"glassbox::scene::MeshSource\": File(path: \"{path}\", name: \"\")"
        ));
        says(&refused(&file), &["a.scn.ron", "b.obj", "--allow-outside"]);
    }
}

#[test]
fn an_environment_map_outside_the_folder_of_its_scene() {
    let (_folder, file) = scene_of(&format!(
        "(resources: {{{VERSION} \"glassbox::scene::Environment\": (map: Some((path: \"../sky.hdr\")))}}, entities: {{}})"
    ));
    says(
        &refused(&file),
        &["a.scn.ron", "../sky.hdr", "--allow-outside"],
    );
}

#[test]
fn a_generated_picture_that_does_not_exist() {
    let (_folder, file) =
        scene("\"glassbox::scene::Phong\": (diffuse_map: Some((path: \"builtin:plaid\")))");
    says(&refused(&file), &["builtin:plaid"]);
}
