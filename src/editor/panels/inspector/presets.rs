//! Materials to begin with. A preset sets the numbers and keeps the maps.

use crate::scene::Phong;
use bevy::color::LinearRgba;

/// A material to begin with.
pub(super) struct Preset {
    pub name: &'static str,
    pub says: &'static str,
    diffuse: [f32; 3],
    specular: [f32; 3],
    mirror: [f32; 3],
    shininess: f32,
    opacity: f32,
    emission: [f32; 3],
    /// The switches of the render without which it does not look so.
    pub needs: &'static [&'static str],
}

const MIRRORS: &str = "features.mirrors";
const GLOSSY: &str = "features.glossy";
const TRANSPARENCY: &str = "features.transparency";
const TRANSLUCENCY: &str = "features.translucency";

/// What has neither highlight nor glow, and is opaque.
const PLAIN: Preset = Preset {
    name: "",
    says: "",
    diffuse: [0.8; 3],
    specular: [0.0; 3],
    mirror: [0.0; 3],
    shininess: 10.0,
    opacity: 1.0,
    emission: [0.0; 3],
    needs: &[],
};

/// In the order of the menu.
pub(super) const PRESETS: &[Preset] = &[
    Preset {
        name: "Matte",
        says: "No highlight and no reflection",
        ..PLAIN
    },
    Preset {
        name: "Plastic",
        says: "A coloured body under a weak, white, broad highlight",
        diffuse: [0.55, 0.06, 0.05],
        specular: [0.05; 3],
        shininess: 60.0,
        ..PLAIN
    },
    Preset {
        name: "Glazed",
        says: "Like a porcelain glaze: a sharp highlight and a faint reflection",
        diffuse: [0.62, 0.64, 0.66],
        specular: [0.12; 3],
        mirror: [0.12; 3],
        shininess: 400.0,
        needs: &[MIRRORS],
        ..PLAIN
    },
    Preset {
        name: "Mirror",
        says: "Reflects nearly everything",
        diffuse: [0.0; 3],
        specular: [0.95; 3],
        mirror: [0.95; 3],
        shininess: 10_000.0,
        needs: &[MIRRORS],
        ..PLAIN
    },
    Preset {
        name: "Gold",
        says: "A coloured mirror with a little body",
        diffuse: [0.10, 0.06, 0.01],
        specular: [0.85, 0.60, 0.22],
        mirror: [0.85, 0.60, 0.22],
        shininess: 300.0,
        needs: &[MIRRORS],
        ..PLAIN
    },
    Preset {
        name: "Brushed metal",
        says: "A grey mirror that blurs",
        diffuse: [0.08; 3],
        specular: [0.6, 0.6, 0.62],
        mirror: [0.6, 0.6, 0.62],
        shininess: 25.0,
        needs: &[MIRRORS, GLOSSY],
        ..PLAIN
    },
    Preset {
        name: "Glass-like",
        says: "Lets most light straight through, without bending it, and reflects a little",
        diffuse: [0.9, 0.95, 0.95],
        specular: [0.12; 3],
        mirror: [0.12; 3],
        shininess: 1000.0,
        opacity: 0.15,
        needs: &[MIRRORS, TRANSPARENCY],
        ..PLAIN
    },
    Preset {
        name: "Frosted",
        says: "Lets light through, and blurs what is behind it",
        diffuse: [0.85, 0.9, 0.92],
        specular: [0.04; 3],
        shininess: 12.0,
        opacity: 0.3,
        needs: &[TRANSPARENCY, TRANSLUCENCY],
        ..PLAIN
    },
    Preset {
        name: "Glowing",
        says: "Sends out light that is seen; it does not light other things",
        diffuse: [0.2; 3],
        emission: [4.0, 3.2, 2.0],
        ..PLAIN
    },
];

impl Preset {
    /// The material with the preset's numbers and its own maps.
    pub fn apply(&self, phong: &mut Phong) {
        let color = |[r, g, b]: [f32; 3]| LinearRgba::rgb(r, g, b);
        *phong = Phong {
            diffuse: color(self.diffuse),
            specular: color(self.specular),
            mirror: color(self.mirror),
            shininess: self.shininess,
            opacity: self.opacity,
            emission: color(self.emission),
            ..phong.clone()
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{RenderSettings, TextureSource};
    use bevy::color::ColorToComponents;
    use bevy::reflect::GetPath;

    #[test]
    fn every_preset_is_within_the_ranges_of_a_material_and_keeps_the_maps() {
        for preset in PRESETS {
            let map = Some(TextureSource::new("builtin:uv"));
            let mut phong = Phong {
                diffuse_map: map.clone(),
                ..Phong::default()
            };
            preset.apply(&mut phong);
            assert_eq!(phong.diffuse_map, map, "{}", preset.name);
            let within = |color: LinearRgba| {
                let [r, g, b, _] = color.to_f32_array();
                [r, g, b].iter().all(|part| (0.0..=1.0).contains(part))
            };
            assert!(
                within(phong.diffuse) && within(phong.specular) && within(phong.mirror),
                "{}",
                preset.name
            );
            assert!(phong.shininess >= 1.0, "{}", preset.name);
            assert!((0.0..=1.0).contains(&phong.opacity), "{}", preset.name);
            for switch in preset.needs {
                let settings = RenderSettings::default();
                assert!(
                    settings.path::<bool>(*switch).is_ok(),
                    "{}: {switch}",
                    preset.name
                );
            }
        }
    }
}
