//! Which lights stand together: those whose names differ in a number at the end.

use super::mix::LightRow;
use crate::scene::SceneId;
use std::collections::{BTreeMap, BTreeSet};

/// A row of the mixer.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Row {
    /// What shines by itself.
    Own,
    /// The heading of lights that stand together.
    Group {
        name: String,
        lights: Vec<SceneId>,
    },
    Light(LightRow),
}

impl Row {
    /// In points.
    pub fn height(&self) -> f32 {
        match self {
            Self::Own => 62.0,
            Self::Group { .. } => 26.0,
            Self::Light(_) => 84.0,
        }
    }

    /// Tells it from other rows.
    pub fn key(&self) -> (u8, u64, &str) {
        match self {
            Self::Own => (0, 0, ""),
            Self::Group { name, .. } => (1, 0, name),
            Self::Light(light) => (2, light.id.0, ""),
        }
    }
}

/// What a name begins with, without a number at its end: that of `Lamp.002`, `Lamp 7` and `Lamp` is `Lamp`.
fn prefix(name: &str) -> &str {
    let begins = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let begins = begins.trim_end_matches([' ', '.', '_', '-']);
    if begins.is_empty() { name } else { begins }
}

/// The rows: those of folded groups without their lights.
pub(super) fn rows_of(lights: &[LightRow], folded: &BTreeSet<String>) -> Vec<Row> {
    let mut groups: BTreeMap<&str, Vec<&LightRow>> = BTreeMap::new();
    for light in lights {
        groups.entry(prefix(&light.name)).or_default().push(light);
    }
    let mut rows = vec![Row::Own];
    for (name, lights) in groups {
        if lights.len() > 1 {
            rows.push(Row::Group {
                name: name.to_owned(),
                lights: lights.iter().map(|light| light.id).collect(),
            });
            if folded.contains(name) {
                continue;
            }
        }
        rows.extend(lights.into_iter().cloned().map(Row::Light));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec3;

    #[test]
    fn lights_stand_together_whose_names_differ_in_a_number_at_the_end() {
        assert_eq!(prefix("Lamp.002"), "Lamp");
        assert_eq!(prefix("Lamp 7"), "Lamp");
        assert_eq!(prefix("Key light"), "Key light");
        assert_eq!(prefix("42"), "42");
        let lights: Vec<LightRow> = ["Key", "Lamp", "Lamp 2", "Rim"]
            .into_iter()
            .zip(1..)
            .map(|(name, id)| LightRow {
                id: SceneId(id),
                name: name.into(),
                is_shown: true,
                color: Vec3::ONE,
            })
            .collect();
        let count = |folded: &BTreeSet<String>| rows_of(&lights, folded).len();
        let rows = rows_of(&lights, &BTreeSet::new());
        assert_eq!(rows.len(), 6, "{rows:?}");
        let together = Row::Group {
            name: "Lamp".into(),
            lights: vec![SceneId(2), SceneId(3)],
        };
        assert_eq!(rows[2], together);
        assert_eq!(count(&["Lamp".to_owned()].into()), 4);
        assert_eq!(count(&["Key".to_owned()].into()), 6, "one is no group");
    }
}
