//! `--gizmo key=value` and `--preset`: what is drawn over a picture.

use super::Failure;
use super::set::Assignment;
use super::settings::table;
use crate::inspect::{InspectPreset, InspectSettings};
use crate::scene::{Property, range_problems};
use bevy::reflect::Typed;
use clap::ValueEnum;

/// The presets as the command line names them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PresetArg {
    /// Why is this pixel black? Its rays, hit triangles, normals and the lights
    Black,
    /// Is this tree good? Its boxes by their cost; nodes that the camera's rays visited
    Tree,
    /// Where is my noise from? Everything that is drawn at random for the pixel
    Noise,
}

/// What is drawn.
pub(super) struct Gizmos(pub InspectSettings);

impl Gizmos {
    /// The preset, or the debug rays alone; then each assignment in its order.
    pub fn new(preset: Option<PresetArg>, assignments: &[Assignment]) -> Result<Self, Failure> {
        let mut settings = match preset {
            None => InspectSettings::default(),
            Some(PresetArg::Black) => InspectPreset::WhyBlack.settings(),
            Some(PresetArg::Tree) => InspectPreset::IsTheTreeGood.settings(),
            Some(PresetArg::Noise) => InspectPreset::WhereIsTheNoiseFrom.settings(),
        };
        for assignment in assignments {
            assignment.apply_gizmo(&mut settings)?;
        }
        if let Some(problem) = range_problems(&settings).into_iter().next() {
            return Err(Failure::Usage(problem.to_string()));
        }
        Ok(Self(settings))
    }
}

/// The list of all settings for `--help`.
pub(super) fn gizmo_list() -> String {
    let settings = Property::all(InspectSettings::type_info());
    let mut text = String::from("Settings for --gizmo (path, default, range):\n");
    text += &table(&settings, &InspectSettings::default());
    text + "\nSettings for --set: see glassbox render --help\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::BoxChoice;

    #[test]
    fn every_setting_of_the_list_can_be_set_to_its_own_value() {
        let defaults = InspectSettings::default();
        for setting in Property::all(InspectSettings::type_info()) {
            let (path, value) = (&setting.path, setting.value_text(&defaults));
            let assignment: Assignment = format!("{path}={value}").parse().unwrap();
            let gizmos = Gizmos::new(None, &[assignment]).map_err(|e| e.to_string());
            assert_eq!(
                gizmos.map(|g| g.0),
                Ok(InspectSettings::default()),
                "{path}"
            );
        }
        let assignment: Assignment = "boxes.choice=leaf".parse().unwrap();
        let gizmos = Gizmos::new(Some(PresetArg::Tree), &[assignment]).unwrap().0;
        assert!(gizmos.boxes.on && gizmos.boxes.choice == BoxChoice::Leaf);
    }

    #[test]
    fn what_is_no_setting_names_those_there_are() {
        for (text, part) in [
            ("box.on=true", "boxes.on"),
            ("boxes=true", "choose one of its settings: on, form, choice"),
            ("boxes.on=maybe", "true or false"),
            ("boxes.object=-1", "whole number"),
            ("rays.max_depth=1001", "must be 0 to 1000"),
        ] {
            let assignment: Assignment = text.parse().unwrap();
            let error = Gizmos::new(None, &[assignment])
                .map(|_| ())
                .unwrap_err()
                .to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
