//! Every render setting in one list: what it may be, and what it does, as the schema says.

use super::RenderSettings;
use super::schema::Property;
use bevy::reflect::Typed;
use std::sync::LazyLock;

/// Every field of [`RenderSettings`], in its order.
pub static SETTINGS: LazyLock<Vec<Property>> =
    LazyLock::new(|| Property::all(RenderSettings::type_info()));

#[cfg(test)]
mod tests {
    use super::super::range_problems;
    use super::*;
    use bevy::math::UVec2;

    #[test]
    fn every_setting_says_what_it_does_and_every_number_has_a_range() {
        for setting in SETTINGS.iter() {
            assert_ne!(setting.says, "", "{}", setting.path);
            assert_ne!(setting.range_text(), "", "{}", setting.path);
            for choice in setting.choices() {
                assert_ne!(choice.says, "", "{}: {}", setting.path, choice.name);
            }
        }
    }

    #[test]
    fn the_defaults_are_in_range_and_what_is_not_is_named() {
        let mut settings = RenderSettings::default();
        assert_eq!(range_problems(&settings), []);
        settings.spp = 0;
        settings.max_depth = 51;
        settings.output.exposure = f32::NAN;
        settings.size = UVec2::new(65_536, 65_536);
        let problems: Vec<String> = range_problems(&settings)
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
