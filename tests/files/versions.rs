//! Scene files of earlier versions.

use super::app::{app, opened};
use super::round_trip::by_id;
use bevy::color::LinearRgba;
use glassbox::io::{OpenOptions, SceneSource, open};
use glassbox::scene::*;
use std::fs;

/// The material of a scene file of this version that says this about its only one.
fn material_of_version(version: u32, phong: &str) -> Phong {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    let text = format!(
        "(resources: {{\"glassbox::io::FileVersion\": ({version})}}, entities: {{1: (components: {{\
         \"glassbox::scene::SceneId\": (1), \"glassbox::scene::Phong\": ({phong})}})}})"
    );
    fs::write(&file, text).unwrap();
    let (mut app, _) = opened(&file);
    let material = by_id(app.world_mut(), 1);
    app.world().get::<Phong>(material).cloned().unwrap()
}

#[test]
fn an_environment_that_says_nothing_of_light_gives_none() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.scn.ron");
    let text = |fields: &str| {
        format!(
            "(resources: {{\"glassbox::io::FileVersion\": (2), \"glassbox::scene::Environment\": \
             (background: (red: 0.5, green: 0.5, blue: 0.5, alpha: 1.0){fields})}}, entities: {{}})"
        )
    };
    for (fields, lights, samples) in [("", false, 1), (", lights: true, samples: 9", true, 9)] {
        fs::write(&file, text(fields)).unwrap();
        let (app, _) = opened(&file);
        let environment = app.world().resource::<Environment>();
        assert_eq!((environment.lights, environment.samples), (lights, samples));
    }
    fs::write(&file, text(", lights: true, samples: 0")).unwrap();
    let mut app = app();
    let source = SceneSource::named(&file);
    let refused = open(app.world_mut(), &source, OpenOptions::default()).unwrap_err();
    assert!(
        refused.to_string().contains("Environment.samples"),
        "{refused}"
    );
}

#[test]
fn a_picture_of_the_first_version_takes_the_place_of_the_colour() {
    let text = "diffuse: (red: 0.25, green: 0.5, blue: 0.75, alpha: 1.0), \
                diffuse_map: Some((path: \"builtin:uv\"))";
    let color = LinearRgba::rgb(0.25, 0.5, 0.75);
    let old = material_of_version(1, text);
    assert_eq!(old.diffuse, LinearRgba::WHITE);
    assert_eq!(old.diffuse_map, Some(TextureSource::new("builtin:uv")));
    let new = material_of_version(2, text);
    assert_eq!(new.diffuse, color);
    let without = material_of_version(1, text.split(", diffuse_map").next().unwrap());
    assert_eq!(without.diffuse, color);
}

#[test]
fn a_material_of_the_first_version_mirrors_what_it_highlights() {
    let text = "specular: (red: 0.25, green: 0.5, blue: 0.75, alpha: 1.0)";
    let color = LinearRgba::rgb(0.25, 0.5, 0.75);
    let old = material_of_version(1, text);
    assert_eq!((old.specular, old.mirror), (color, color));
    let new = material_of_version(2, text);
    assert_eq!((new.specular, new.mirror), (color, LinearRgba::BLACK));
}
