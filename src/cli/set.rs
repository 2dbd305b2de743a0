//! `--set key=value`: any setting by its reflected path.

use super::Failure;
use super::gizmos::gizmo_settings;
use crate::inspect::InspectSettings;
use crate::scene::{RenderSettings, SETTINGS};
use bevy::math::UVec2;
use bevy::reflect::enums::{DynamicEnum, DynamicVariant};
use bevy::reflect::{GetPath, PartialReflect, Reflect, TypeInfo};
use std::str::FromStr;

/// `key=value` as it stands on the command line.
#[derive(Clone, Debug)]
pub(super) struct Assignment {
    key: String,
    value: String,
}

impl FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (key, value) = text
            .split_once('=')
            .ok_or("it is written key=value, for example max_depth=8")?;
        Ok(Self {
            key: key.trim().to_owned(),
            value: value.trim().to_owned(),
        })
    }
}

impl Assignment {
    /// Writes the value into the settings. Ranges are checked afterwards, all together.
    pub fn apply(&self, settings: &mut RenderSettings) -> Result<(), Failure> {
        let paths = SETTINGS.iter().map(|setting| setting.path);
        self.write_into(settings, "--set", paths, "glassbox render --help")
    }

    /// Writes the value into what is drawn.
    pub fn apply_gizmo(&self, settings: &mut InspectSettings) -> Result<(), Failure> {
        let all = gizmo_settings(settings);
        let paths = all.iter().map(|(path, _)| path.as_str());
        self.write_into(settings, "--gizmo", paths, "glassbox inspect --help")
    }

    fn write_into<'a, T: Reflect>(
        &self,
        settings: &mut T,
        flag: &str,
        paths: impl Iterator<Item = &'a str>,
        help: &str,
    ) -> Result<(), Failure> {
        let Self { key, value } = self;
        let Ok(field) = settings.reflect_path_mut(key.as_str()) else {
            return Err(Failure::Usage(unknown(flag, key, paths, help)));
        };
        if let TypeInfo::Struct(info) = type_info(field)?
            && field.try_downcast_ref::<UVec2>().is_none()
        {
            let fields = info.field_names().join(", ");
            let text = format!("{flag} {key}: it is a group; choose one of its settings: {fields}");
            return Err(Failure::Usage(text));
        }
        write(field, value)
            .map_err(|wanted| Failure::Usage(format!("{flag} {key}={value}: wanted {wanted}")))
    }
}

fn type_info(field: &dyn PartialReflect) -> Result<&'static TypeInfo, Failure> {
    field
        .get_represented_type_info()
        .ok_or_else(|| Failure::Usage("--set: this field has no type".into()))
}

/// Parses the value as what the field is; on failure, what would have been right.
fn write(field: &mut dyn PartialReflect, value: &str) -> Result<(), String> {
    fn parsed<T: FromStr>(place: &mut T, value: &str, wanted: &str) -> Result<(), String> {
        *place = value.parse().map_err(|_| wanted.to_owned())?;
        Ok(())
    }
    if let Some(place) = field.try_downcast_mut::<bool>() {
        return parsed(place, value, "true or false");
    }
    if let Some(place) = field.try_downcast_mut::<u32>() {
        return parsed(place, value, "a whole number from 0 to 4294967295");
    }
    if let Some(place) = field.try_downcast_mut::<u64>() {
        return parsed(place, value, "a whole number");
    }
    if let Some(place) = field.try_downcast_mut::<f32>() {
        return parsed(place, value, "a number");
    }
    if let Some(place) = field.try_downcast_mut::<UVec2>() {
        *place = parse_size(value)?;
        return Ok(());
    }
    let Some(TypeInfo::Enum(info)) = field.get_represented_type_info() else {
        return Err("another kind of value than the command line can write".into());
    };
    let names = info.variant_names();
    let name = names
        .iter()
        .find(|name| name.eq_ignore_ascii_case(value))
        .ok_or_else(|| format!("one of {}", names.join(", ")))?;
    field
        .try_apply(&DynamicEnum::new(*name, DynamicVariant::Unit))
        .map_err(|error| error.to_string())
}

/// `WxH`, both whole numbers; whether they are in range is not asked here.
pub(super) fn parse_size(text: &str) -> Result<UVec2, String> {
    let parse = || {
        let (width, height) = text.split_once(['x', 'X', ','])?;
        Some(UVec2::new(
            width.trim().parse().ok()?,
            height.trim().parse().ok()?,
        ))
    };
    parse().ok_or_else(|| "WxH in pixels, for example 800x600".to_owned())
}

/// Says that there is no such setting, and which ones have a similar name.
fn unknown<'a>(flag: &str, key: &str, paths: impl Iterator<Item = &'a str>, help: &str) -> String {
    let distance = |path: &str| {
        let last = path.rsplit('.').next().unwrap_or(path);
        edit_distance(key, path).min(edit_distance(key, last))
    };
    let mut near: Vec<(usize, &str)> = paths.map(|path| (distance(path), path)).collect();
    near.sort_by_key(|(distance, _)| *distance);
    // The nearest in any case, two more where they are mistakes of a few letters.
    let close = |i: usize, distance: usize| i == 0 || (i < 3 && distance <= key.len() / 3);
    let names: Vec<&str> = near
        .iter()
        .enumerate()
        .filter(|(i, (distance, _))| close(*i, *distance))
        .map(|(_, (_, path))| *path)
        .collect();
    format!(
        "{flag} {key}: no such setting; did you mean {}? (all: {help})",
        names.join(" or ")
    )
}

/// Levenshtein's distance: letters to insert, remove or replace.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Builder, SettingRange};

    fn set(text: &str) -> Result<RenderSettings, String> {
        let mut settings = RenderSettings::default();
        let assignment: Assignment = text.parse()?;
        assignment
            .apply(&mut settings)
            .map_err(|failure| failure.to_string())?;
        Ok(settings)
    }

    #[test]
    fn every_row_of_the_table_can_be_set_to_another_value_and_read_back() {
        for setting in SETTINGS {
            let default = setting.value_text(&RenderSettings::default());
            let other = match setting.range {
                SettingRange::Integer(..) => "7".to_owned(),
                SettingRange::Number(..) => "2.5".to_owned(),
                SettingRange::Switch => (default != "true").to_string(),
                SettingRange::Size { .. } => "3x4".to_owned(),
                SettingRange::Choice => {
                    let choices = setting.choices();
                    let other = choices.iter().find(|choice| **choice != default);
                    other.unwrap().to_lowercase()
                }
            };
            let settings = set(&format!("{}={other}", setting.path)).unwrap();
            let value = setting.value_text(&settings);
            assert!(
                value.eq_ignore_ascii_case(&other),
                "{}: {value}",
                setting.path
            );
        }
    }

    #[test]
    fn parts_of_a_vector_have_paths_too() {
        assert_eq!(set("size.x=5").unwrap().size.x, 5);
        assert_eq!(set("tree.builder=SAH").unwrap().tree.builder, Builder::Sah);
    }

    #[test]
    fn what_cannot_be_set_says_what_would_be_right() {
        for (text, part) in [
            ("shadows=false", "features.shadows"),
            ("max_dept=3", "max_depth"),
            ("features.shadow=true", "features.shadows"),
            (
                "features=true",
                "choose one of its settings: shading, mirrors",
            ),
            ("spp=many", "a whole number"),
            ("spp=-1", "a whole number"),
            ("features.shadows=1", "true or false"),
            ("size=0", "WxH"),
            ("tree.builder=fast", "one of None, Median, Sah, Ploc"),
            ("spp", "key=value"),
            ("=3", "choose one of its settings"),
        ] {
            let error = set(text).unwrap_err();
            assert!(error.contains(part), "`{text}` gives `{error}`");
        }
    }

    #[test]
    fn distances_are_levenshteins() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("abc", ""), 3);
    }
}
