use super::problem::Fault;
use super::reading::Reader;
use super::texture_data::TextureFault;
use super::textures::TracedTextures;
use super::traced::Draft;
use crate::scene::schema::quantity_of;
use crate::scene::{Environment, EnvironmentMap, RenderSettings, SceneId};
use crate::trace;
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::system::{Res, ResMut};
use bevy::math::Vec3;
use std::sync::Arc;

/// Takes over the background and its map.
pub(super) fn sync_environment(
    environment: Res<Environment>,
    map: Res<EnvironmentMap>,
    settings: Res<RenderSettings>,
    textures: Res<TracedTextures>,
    draft: ResMut<Draft>,
) {
    let stale = environment.is_changed()
        || map.is_changed()
        || settings.is_changed()
        || draft.changes.textures;
    if !stale {
        return;
    }
    let draft = draft.into_inner();
    let awaited = map.0.as_ref().filter(|_| settings.features.environment);
    let is_awaited = |id| textures.get(id).is_none() || textures.is_being_prepared(id);
    if awaited.is_some_and(|map| is_awaited(map.id())) {
        // All stays as it was until its map is converted, and has its table where it lights.
        return;
    }
    let has_picture = map.0.is_some() || environment.map.is_some();
    draft.problems.environment.clear();
    draft.reread = true;
    let mut reader = Reader {
        kind: "environment",
        id: SceneId::default(),
        name: None,
        problems: &mut draft.problems.environment,
    };
    let map = if settings.features.environment {
        match (&map.0, &environment.map) {
            (Some(handle), _) => textures.get(handle.id()).transpose(),
            (None, Some(source)) => Err(TextureFault::Unresolved(source.path.clone())),
            (None, None) => Ok(None),
        }
    } else {
        Ok(None)
    };
    let map = map.unwrap_or_else(|fault| {
        reader.note(Fault::Texture {
            field: "map",
            fault,
        });
        None
    });
    let map = map.map(|map| {
        // One note a picture: where a material has it too, that one's.
        let is_noted = (draft.world.textures.iter()).any(|other| Arc::ptr_eq(other, &map.texture));
        if !is_noted {
            reader.note_texels("map", map.replaced);
        }
        map.texture.clone()
    });
    let of = quantity_of::<Environment>;
    let background = reader.color("background", environment.background, of("background"));
    let new = trace::Environment {
        background,
        map,
        rotation: reader
            .number("rotation", environment.rotation, of("rotation"))
            .unwrap_or(0.0),
        intensity: reader
            .number("intensity", environment.intensity, of("intensity"))
            .unwrap_or(1.0),
        lights: environment.lights,
        samples: reader.samples(environment.samples),
        backdrop: environment
            .hidden
            .then_some(if has_picture { background } else { Vec3::ZERO }),
    };
    if !new.is_same(&draft.world.environment) {
        draft.world.environment = new;
        draft.changes.environment = true;
    }
}
