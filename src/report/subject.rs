//! What is measured: a scene as the tracer has it.

use crate::inspect::corners;
use crate::scene::RenderSettings;
use crate::trace::{Camera, World};
use glam::Vec3;
use std::sync::Arc;

/// A scene, from one camera.
#[derive(Clone)]
pub struct Subject {
    /// What it is called.
    pub name: String,
    /// What rays read.
    pub world: Arc<World>,
    /// Where they come from.
    pub camera: Camera,
    /// How they are traced.
    pub settings: RenderSettings,
}

impl Subject {
    /// Numbers names that are taken already, or of which files could not be told apart.
    pub fn tell_apart(subjects: &mut [Self]) {
        for at in 1..subjects.len() {
            let (before, rest) = subjects.split_at_mut(at);
            let subject = &mut rest[0];
            let name = subject.name.clone();
            for number in 2.. {
                if before.iter().all(|other| other.file() != subject.file()) {
                    break;
                }
                subject.name = format!("{name} {number}");
            }
        }
    }

    /// Its name as a part of a file's name.
    pub(super) fn file(&self) -> String {
        let fit = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        self.name.chars().map(fit).collect()
    }

    /// Corners of all its triangles that are traced, in world space, as they stand at time 0.
    pub(super) fn triangles(&self) -> Vec<[Vec3; 3]> {
        corners(&self.world)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_of_one_name_have_files_of_their_own() {
        let named = |name: &&str| Subject {
            name: (*name).to_owned(),
            world: Arc::default(),
            camera: Camera::looking_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0),
            settings: RenderSettings::default(),
        };
        let names = ["room.obj", "room-obj", "room.obj", "knot", "room.obj 2"];
        let mut subjects: Vec<Subject> = names.iter().map(named).collect();
        Subject::tell_apart(&mut subjects);
        let files: std::collections::BTreeSet<String> =
            subjects.iter().map(Subject::file).collect();
        assert_eq!(files.len(), names.len(), "{files:?}");
        assert_eq!(
            [&*subjects[0].name, &*subjects[3].name],
            ["room.obj", "knot"]
        );
        assert_eq!(subjects[1].name, "room-obj 2");
    }
}
