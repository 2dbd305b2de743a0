//! Every render setting in one table: what it may be, and what it does. The command line's help,
//! the editor's fields, and all who check or name a setting read it.

use super::RenderSettings;
use bevy::math::UVec2;
use bevy::reflect::{GetPath, TypeInfo};
use std::fmt;

/// One render setting.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Reflected path from [`RenderSettings`].
    pub path: &'static str,
    /// What it may be.
    pub range: SettingRange,
    /// What it does, without a full stop.
    pub says: &'static str,
}

/// What a setting may be, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SettingRange {
    /// A whole number.
    Integer(u32, u32),
    /// A number.
    Number(f32, f32),
    /// On or off.
    Switch,
    /// One of the names of an enum.
    Choice,
    /// Width and height of a picture: each 1 to `side`, and at most `pixels` together.
    Size {
        /// Most pixels on a side.
        side: u32,
        /// Most pixels together.
        pixels: u64,
    },
}

/// Every field of [`RenderSettings`], in its order.
pub const SETTINGS: &[Setting] = {
    use SettingRange::{Choice, Integer, Number, Size, Switch};
    const fn row(path: &'static str, range: SettingRange, says: &'static str) -> Setting {
        Setting { path, range, says }
    }
    &[
        row(
            "size",
            Size {
                side: 1 << 16,
                pixels: 1 << 28,
            },
            "pixels of the picture",
        ),
        row(
            "spp",
            Integer(1, 1 << 20),
            "samples of each pixel (effects may ask for more); the most with an error or a time to stop at",
        ),
        row(
            "jitter",
            Integer(1, 16),
            "n of n x n jittered samples of each pixel",
        ),
        row("seed", Integer(0, u32::MAX), "chooses the random numbers"),
        row("sequence", Choice, "where the random numbers come from"),
        row(
            "sampling.adaptive",
            Switch,
            "samples go where the error is; used with an error or a time to stop at",
        ),
        row(
            "sampling.error",
            Number(0.0, 1000.0),
            "relative error to stop at; 0: none",
        ),
        row(
            "sampling.time",
            Number(0.0, 1e7),
            "seconds to stop after; 0: none",
        ),
        row("pixel", Choice, "where in the pixel samples lie"),
        row("lighting", Choice, "what a light's colour means"),
        row("max_depth", Integer(0, 50), "mirror bounces"),
        row(
            "features.shading",
            Switch,
            "Phong shading; off: the value is kd",
        ),
        row("features.mirrors", Switch, "ks > 0 reflects"),
        row("features.shadows", Switch, "shadow rays"),
        row(
            "features.soft_shadows",
            Switch,
            "area lights as areas; off: as their middle",
        ),
        row(
            "features.normal_interpolation",
            Switch,
            "smooth normals; off: the triangle's own",
        ),
        row("features.textures", Switch, "diffuse and opacity maps"),
        row(
            "features.environment",
            Switch,
            "the environment map; off: the background colour",
        ),
        row(
            "features.scale_light_samples",
            Switch,
            "light samples grow with the light's size",
        ),
        row("features.glossy", Switch, "mirrors blur by their shininess"),
        row(
            "features.transparency",
            Switch,
            "opacity below 1 lets light through",
        ),
        row(
            "features.translucency",
            Switch,
            "transmitted rays blur by the shininess",
        ),
        row("features.lens", Switch, "the camera's lens; off: a pinhole"),
        row(
            "features.motion",
            Switch,
            "things move while the shutter is open",
        ),
        row(
            "gloss_samples",
            Integer(1, 1000),
            "rays of a glossy reflection at the first hit",
        ),
        row(
            "translucency_samples",
            Integer(1, 1000),
            "rays through a translucent surface at the first hit",
        ),
        row("texture_filter", Choice, "how texels are read"),
        row("tree.builder", Choice, "how the trees are built"),
        row(
            "tree.levels",
            Choice,
            "a tree per mesh and one over them, or one tree for all",
        ),
        row(
            "tree.max_depth",
            Integer(1, 64),
            "levels of Median and Sah trees",
        ),
        row("tree.max_leaf_size", Integer(1, 255), "triangles of a leaf"),
        row("tree.bins", Integer(2, 64), "bins per axis of Sah"),
        row(
            "tree.preset",
            Choice,
            "how much time Ploc takes for a better tree",
        ),
        row(
            "output.bloom.enabled",
            Switch,
            "bright places spill light over their surroundings",
        ),
        row(
            "output.bloom.threshold",
            Number(0.0, 1.0),
            "linear value above which a pixel is bright",
        ),
        row(
            "output.bloom.intensity",
            Number(0.0, 1.0),
            "part of the bright light that is added",
        ),
        row(
            "output.bloom.sigma",
            Number(0.0, 1000.0),
            "width of the blur in pixels",
        ),
        row("output.exposure", Number(-64.0, 64.0), "in stops"),
        row(
            "output.view_transform",
            Choice,
            "from scene values to a screen's",
        ),
    ]
};

impl Setting {
    /// What the setting may be, in words: `1 to 50`, `on or off (true, false)`, `None, Median, …`.
    pub fn range_text(&self) -> String {
        match self.range {
            SettingRange::Integer(least, most) => format!("{least} to {most}"),
            SettingRange::Number(least, most) => format!("{least} to {most}"),
            SettingRange::Switch => "true or false".into(),
            SettingRange::Choice => self.choices().join(", "),
            SettingRange::Size { side, pixels } => {
                format!("WxH, each 1 to {side}, at most {pixels} together")
            }
        }
    }

    /// The names of an enum's variants; empty for other settings.
    pub fn choices(&self) -> Vec<&'static str> {
        let settings = RenderSettings::default();
        let info = settings
            .reflect_path(self.path)
            .ok()
            .and_then(|value| value.get_represented_type_info());
        match info {
            Some(TypeInfo::Enum(info)) => info.variant_names().to_vec(),
            _ => Vec::new(),
        }
    }

    /// The setting's value as the command line writes it.
    pub fn value_text(&self, settings: &RenderSettings) -> String {
        match settings.reflect_path(self.path) {
            Ok(value) => match value.try_downcast_ref::<UVec2>() {
                Some(size) => format!("{}x{}", size.x, size.y),
                None => format!("{value:?}"),
            },
            Err(_) => String::new(),
        }
    }

    fn allows(&self, settings: &RenderSettings) -> bool {
        let path = self.path;
        match self.range {
            SettingRange::Integer(least, most) => settings
                .path::<u32>(path)
                .is_ok_and(|value| (least..=most).contains(value)),
            SettingRange::Number(least, most) => settings
                .path::<f32>(path)
                .is_ok_and(|value| (least..=most).contains(value)),
            SettingRange::Size { side, pixels } => settings.path::<UVec2>(path).is_ok_and(|size| {
                let count = u64::from(size.x) * u64::from(size.y);
                size.min_element() >= 1 && size.max_element() <= side && count <= pixels
            }),
            // The type holds nothing else.
            SettingRange::Switch | SettingRange::Choice => true,
        }
    }
}

/// A setting that is out of range.
#[derive(Clone, Debug, PartialEq)]
pub struct SettingProblem {
    /// Reflected path from [`RenderSettings`].
    pub path: &'static str,
    /// What it is.
    pub value: String,
    /// What it may be.
    pub range: String,
}

impl fmt::Display for SettingProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, value, range } = self;
        write!(f, "{path} is {value}, and must be {range}")
    }
}

impl std::error::Error for SettingProblem {}

/// The settings that are out of range, in the table's order.
pub fn setting_problems(settings: &RenderSettings) -> Vec<SettingProblem> {
    SETTINGS
        .iter()
        .filter(|setting| !setting.allows(settings))
        .map(|setting| SettingProblem {
            path: setting.path,
            value: setting.value_text(settings),
            range: setting.range_text(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::reflect::{PartialReflect, ReflectRef};

    /// Paths of all fields that hold a value: not structs, but vectors are values.
    fn leaves(value: &dyn PartialReflect, path: &str, found: &mut Vec<String>) {
        match value.reflect_ref() {
            ReflectRef::Struct(fields) if value.try_downcast_ref::<UVec2>().is_none() => {
                for i in 0..fields.field_len() {
                    let name = fields.name_at(i).unwrap();
                    let path = match path {
                        "" => name.to_string(),
                        path => format!("{path}.{name}"),
                    };
                    leaves(fields.field_at(i).unwrap(), &path, found);
                }
            }
            _ => found.push(path.to_string()),
        }
    }

    #[test]
    fn the_table_holds_every_field_in_order() {
        let mut fields = Vec::new();
        leaves(&RenderSettings::default(), "", &mut fields);
        let rows: Vec<&str> = SETTINGS.iter().map(|setting| setting.path).collect();
        assert_eq!(rows, fields);
    }

    #[test]
    fn the_rows_fit_the_types_of_their_fields() {
        let settings = RenderSettings::default();
        for setting in SETTINGS {
            let value = settings.reflect_path(setting.path).unwrap();
            let fits = match setting.range {
                SettingRange::Integer(..) => value.try_downcast_ref::<u32>().is_some(),
                SettingRange::Number(..) => value.try_downcast_ref::<f32>().is_some(),
                SettingRange::Switch => value.try_downcast_ref::<bool>().is_some(),
                SettingRange::Choice => setting.choices().len() > 1,
                SettingRange::Size { .. } => value.try_downcast_ref::<UVec2>().is_some(),
            };
            assert!(
                fits,
                "{} is {value:?}, its row says {:?}",
                setting.path, setting.range
            );
        }
    }

    #[test]
    fn the_defaults_are_in_range_and_what_is_not_is_named() {
        let mut settings = RenderSettings::default();
        assert_eq!(setting_problems(&settings), []);
        settings.spp = 0;
        settings.max_depth = 51;
        settings.output.exposure = f32::NAN;
        settings.size = UVec2::new(65_536, 65_536);
        let problems: Vec<String> = setting_problems(&settings)
            .iter()
            .map(|p| p.to_string())
            .collect();
        assert_eq!(problems.len(), 4, "{problems:#?}");
        assert!(
            problems[0].starts_with("size is 65536x65536, and must be"),
            "{}",
            problems[0]
        );
        assert_eq!(problems[1], "spp is 0, and must be 1 to 1048576");
        assert_eq!(problems[2], "max_depth is 51, and must be 0 to 50");
    }
}
