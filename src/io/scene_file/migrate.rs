//! From the rules of older scene files to those of today, so that their pictures stay what they were.

use super::FileVersion;
use crate::scene::Phong;
use bevy::world_serialization::DynamicWorld;

/// Changes what a file of this version says into what it would say today.
pub(super) fn migrate(content: &mut DynamicWorld, version: FileVersion) {
    if version.0 >= FileVersion::CURRENT.0 {
        return;
    }
    let entities = content.entities.iter_mut();
    let components = entities.flat_map(|entity| &mut entity.components);
    for phong in components.filter_map(|component| component.try_downcast_mut::<Phong>()) {
        // There was one colour for both.
        phong.mirror = phong.specular;
    }
}
