//! Three questions that people come with, and what is drawn to answer each.

use super::settings::{
    BoxColor, BoxSettings, InspectSettings, MissColor, PatternSettings, RaySettings,
};
use bevy::reflect::Reflect;

/// A ready-made choice that answers a question.
#[derive(
    Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum InspectPreset {
    /// The rays of one pixel, and what was in their lights' way.
    WhyBlack,
    /// The tree's boxes, by what they cost.
    IsTheTreeGood,
    /// Everything that is drawn at random for a pixel.
    WhereIsTheNoiseFrom,
}

impl InspectPreset {
    /// All of them.
    pub const ALL: [Self; 3] = [
        Self::WhyBlack,
        Self::IsTheTreeGood,
        Self::WhereIsTheNoiseFrom,
    ];

    /// As the command line calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::WhyBlack => "black",
            Self::IsTheTreeGood => "tree",
            Self::WhereIsTheNoiseFrom => "noise",
        }
    }

    /// What it does, or the question that it answers.
    pub fn title(self) -> &'static str {
        match self {
            Self::WhyBlack => "Draw why a pixel is black",
            Self::IsTheTreeGood => "Is this tree good?",
            Self::WhereIsTheNoiseFrom => "Where is my noise from?",
        }
    }

    /// What one sees of it, in a sentence.
    pub fn says(self) -> &'static str {
        match self {
            Self::WhyBlack => {
                "Point at the pixel and press R: its rays, each in the light it carries, red where \
                 they meet nothing; a shadow ray ends at what blocks its light, dark beyond."
            }
            Self::IsTheTreeGood => {
                "Boxes of the trees, bright where rays pay most. Point and press R: white boxes are \
                 visited by the pixel's rays, red ones were hit but skipped. A good tree shows few red \
                 boxes."
            }
            Self::WhereIsTheNoiseFrom => {
                "Point and press R: the pixel's rays with every random choice that they took, on lens, \
                 lights, time and blur discs, and where its samples lie. What spreads widest is noisy."
            }
        }
    }

    /// The answer's settings.
    pub fn settings(self) -> InspectSettings {
        let base = InspectSettings::default();
        match self {
            Self::WhyBlack => InspectSettings {
                rays: RaySettings {
                    hit_triangles: true,
                    hit_normals: true,
                    misses: MissColor::Red,
                    ..base.rays
                },
                lights: true,
                ..base
            },
            Self::IsTheTreeGood => InspectSettings {
                boxes: BoxSettings {
                    on: true,
                    to_level: 6,
                    color: BoxColor::Cost,
                    ..base.boxes
                },
                rays: RaySettings {
                    mirror: false,
                    transmission: false,
                    shadow: false,
                    light_samples: false,
                    visited: true,
                    pruned: true,
                    hit_triangles: true,
                    ..base.rays
                },
                ..base
            },
            Self::WhereIsTheNoiseFrom => InspectSettings {
                lights: true,
                lens: true,
                motion: true,
                lobes: true,
                pattern: PatternSettings {
                    on: true,
                    ..base.pattern
                },
                ..base
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_differ_have_names_of_their_own_and_leave_the_master_switch_on() {
        let all = InspectPreset::ALL.map(InspectPreset::settings);
        assert!(all.iter().all(|settings| settings.on));
        assert!(all[0] != all[1] && all[1] != all[2] && all[0] != all[2]);
        let names = InspectPreset::ALL.map(InspectPreset::name);
        assert_eq!(names, ["black", "tree", "noise"]);
    }
}
