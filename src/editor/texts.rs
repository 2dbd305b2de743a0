//! Numbers and paths as texts: with a narrow space between thousands, with the plural they ask for, from the root or
//! from home.

use crate::inspect::plural;
use crate::io::SceneFiles;
use bevy::ecs::world::World;
use std::env::home_dir;
use std::path::{Component, Path, PathBuf};

/// `1 light`, `12 345 triangles`.
pub(super) fn counted(number: u64, what: &str) -> String {
    format!("{} {}", grouped(number), plural(number, what))
}

/// With a narrow space between thousands.
pub(super) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

/// Where a file lies, as people say it: from the root, or from home as `~/…`, and nowhere with `..`.
pub(super) fn path_text(path: &Path) -> String {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let whole = without_steps_back(&whole);
    match home_dir() {
        Some(home) => from_home(&whole, &home),
        None => whole.display().to_string(),
    }
}

fn from_home(path: &Path, home: &Path) -> String {
    match path.strip_prefix(home) {
        // A home that is the root would be in front of everything.
        Ok(rest) if home.components().count() > 1 => {
            Path::new("~").join(rest).display().to_string()
        }
        _ => path.display().to_string(),
    }
}

fn without_steps_back(path: &Path) -> PathBuf {
    let mut found = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                found.pop();
            }
            Component::CurDir => {}
            part => found.push(part),
        }
    }
    found
}

/// A file's name without its folder.
pub(super) fn file_name(file: &Path) -> String {
    let name = file.file_name().unwrap_or(file.as_os_str());
    name.to_string_lossy().into_owned()
}

/// A file that the scene names: as it does, where that lies below the scene's folder, else where it lies. A recovered
/// scene's folder is one that nobody knows.
pub(super) fn scene_path_text(world: &World, path: &str) -> String {
    let is_below = Path::new(path).is_relative() && !path.starts_with("..");
    match world.get_resource::<SceneFiles>() {
        Some(files) if !is_below => path_text(&files.folder.file_of(path)),
        _ => path.to_owned(),
    }
}

/// The path that a text from [`path_text`] or from a person means: `~/` is home.
pub(super) fn path_of(text: &str) -> PathBuf {
    let text = text.trim();
    match (text.strip_prefix("~/"), home_dir()) {
        (Some(rest), Some(home)) => home.join(rest),
        _ => PathBuf::from(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_spaces_and_their_plural() {
        assert_eq!(grouped(87_040), "87\u{2009}040");
        assert_eq!(grouped(7), "7");
        assert_eq!(counted(1, "object"), "1 object");
        assert_eq!(counted(0, "object"), "0 objects");
        assert_eq!(
            counted(1_234_567, "triangle"),
            "1\u{2009}234\u{2009}567 triangles"
        );
    }

    #[test]
    fn a_file_of_the_scene_is_named_as_there_or_where_it_lies() {
        let mut world = World::new();
        let mut files = SceneFiles::default();
        files.folder.path = "/home/ada/.local/recovery".into();
        world.insert_resource(files);
        assert_eq!(scene_path_text(&world, "meshes/m.obj"), "meshes/m.obj");
        let said = scene_path_text(&world, "../../models/m.obj");
        assert_eq!(said, path_text(Path::new("/home/ada/models/m.obj")));
    }

    #[test]
    fn paths_are_said_from_the_root_or_from_home_and_without_steps_back() {
        assert_eq!(path_text(Path::new("/a/b/../../c/./d.obj")), "/c/d.obj");
        let home = Path::new("/home/ada");
        let said = |path| from_home(Path::new(path), home);
        assert_eq!(
            said("/home/ada/x/m.obj"),
            Path::new("~/x/m.obj").display().to_string()
        );
        assert_eq!(said("/home/adam/m.obj"), "/home/adam/m.obj");
        assert_eq!(from_home(Path::new("/m.obj"), Path::new("/")), "/m.obj");
        assert!(!path_text(Path::new("../x.obj")).contains(".."));
    }
}
