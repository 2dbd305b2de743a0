//! From the rules of older scene files to those of today, so that their pictures stay what they were.

use super::FileVersion;
use crate::scene::{Phong, RenderSettings};
use bevy::color::LinearRgba;
use bevy::world_serialization::DynamicWorld;

/// Changes what a file of this version says into what it would say today.
pub(super) fn migrate(content: &mut DynamicWorld, version: FileVersion) {
    if version.0 >= FileVersion::CURRENT.0 {
        return;
    }
    let mut resources = content.resources.iter();
    let settings = resources.find_map(|resource| resource.try_downcast_ref::<RenderSettings>());
    let has_textures = settings.is_none_or(|settings| settings.features.textures);
    let entities = content.entities.iter_mut();
    let components = entities.flat_map(|entity| &mut entity.components);
    for phong in components.filter_map(|component| component.try_downcast_mut::<Phong>()) {
        // There was one colour for both.
        phong.mirror = phong.specular;
        // A picture took the place of the colour, and was seen unless all textures were off.
        if phong.diffuse_map.is_some() && has_textures {
            phong.diffuse = LinearRgba::WHITE;
        }
    }
}
