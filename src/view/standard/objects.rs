//! What Bevy's objects have besides mesh and material.

use super::returned::Returned;
use crate::scene::NotTraced;
use crate::sync::LeftOut;
use crate::view::RASTER_LAYER;
use bevy::camera::visibility::RenderLayers;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::mesh::Mesh3d;
use bevy::pbr::Lightmap;
use bevy::prelude::{Changed, Entity, Has, Or, Query, RemovedComponents, ResMut, With, Without};

type Flags = (
    Has<NotShadowCaster>,
    Has<NotShadowReceiver>,
    Has<Lightmap>,
    Option<&'static RenderLayers>,
);

type Edited = Or<(
    Changed<Mesh3d>,
    Changed<NotShadowCaster>,
    Changed<NotShadowReceiver>,
    Changed<Lightmap>,
    Changed<RenderLayers>,
)>;

/// Names what the tracer does not follow.
pub(super) fn name_flags(
    objects: Query<Flags, (With<Mesh3d>, Without<NotTraced>)>,
    edited: Query<Entity, (With<Mesh3d>, Without<NotTraced>, Edited)>,
    mut no_mesh: RemovedComponents<Mesh3d>,
    mut casts: RemovedComponents<NotShadowCaster>,
    mut receives: RemovedComponents<NotShadowReceiver>,
    mut no_lightmap: RemovedComponents<Lightmap>,
    mut no_layers: RemovedComponents<RenderLayers>,
    mut returned: Returned,
    mut left_out: ResMut<LeftOut>,
) {
    let gone = (no_mesh.read())
        .chain(casts.read())
        .chain(receives.read())
        .chain(no_lightmap.read())
        .chain(no_layers.read());
    let others: Vec<Entity> = (returned.no_longer()).chain(&edited).chain(gone).collect();
    for entity in others.into_iter().chain(returned.read()) {
        let what = objects.get(entity).map(names).unwrap_or_default();
        LeftOut::note(&mut left_out, "object", entity, what);
    }
}

fn names(
    (no_caster, no_receiver, lightmap, layers): (bool, bool, bool, Option<&RenderLayers>),
) -> Vec<String> {
    let layered = layers.is_some_and(|layers| {
        // Our own objects lie in a layer that the raster picture alone has.
        *layers != RenderLayers::default() && *layers != RenderLayers::layer(RASTER_LAYER)
    });
    let notes = [
        (
            no_caster,
            "its NotShadowCaster is left out: everything casts shadows",
        ),
        (
            no_receiver,
            "its NotShadowReceiver is left out: shadows fall on everything",
        ),
        (lightmap, "its lightmap is left out"),
        (
            layered,
            "its RenderLayers are left out: every view traces it",
        ),
    ];
    let notes = notes.into_iter().filter(|(is_so, _)| *is_so);
    notes.map(|(_, note)| note.into()).collect()
}
