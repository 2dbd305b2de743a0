//! Backs that Bevy culls.

use crate::scene::SceneId;
use crate::sync::LeftOut;
use crate::view::TracedRender;
use bevy::asset::Assets;
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::{Entity, Name, Query, Res, ResMut};
use bevy::render::render_resource::Face;

/// Names, once a view, what it sees from behind and Bevy would not draw: both sides of a surface are
/// traced, which shows only where it is open.
pub(super) fn name_backs(
    views: Query<(Entity, &TracedRender)>,
    objects: Query<(&SceneId, Option<&Name>, &MeshMaterial3d<StandardMaterial>)>,
    materials: Res<Assets<StandardMaterial>>,
    mut left_out: ResMut<LeftOut>,
) {
    for (view, render) in &views {
        let mut notes = Vec::new();
        if !render.backs.is_empty() {
            let is_culled = |worn: &MeshMaterial3d<StandardMaterial>| {
                let material = materials.get(&worn.0);
                material.is_some_and(|material| material.cull_mode == Some(Face::Back))
            };
            let culled = objects
                .iter()
                .filter(|(id, _, worn)| render.backs.binary_search(id).is_ok() && is_culled(worn));
            let mut culled: Vec<_> = culled.map(|(id, name, _)| (id, name)).collect();
            culled.sort_unstable_by_key(|(id, _)| **id);
            notes.extend(note(&culled));
        }
        LeftOut::note(&mut left_out, "picture of view", view, notes);
    }
}

fn note(culled: &[(&SceneId, Option<&Name>)]) -> Option<String> {
    let (id, name) = culled.first()?;
    let first = match name {
        Some(name) => format!("\"{name}\""),
        None => format!("object {}", id.0),
    };
    let others = match culled.len() - 1 {
        0 => String::new(),
        1 => " and of one more".into(),
        others => format!(" and of {others} more"),
    };
    Some(format!(
        "it shows the back of {first}{others}, which Bevy culls: surfaces have two sides"
    ))
}
