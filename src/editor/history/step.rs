//! One step of the history, and what it is called.

use super::state::{EntityState, Kept, Kinds};
use crate::scene::{
    DirectionalLamp, Environment, Lens, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp,
    RenderSettings, SETTINGS, SceneCamera, SceneId, SegmentLamp, UsesMaterial,
};
use bevy::camera::visibility::Visibility;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::name::Name;
use bevy::reflect::GetPath;
use bevy::transform::components::Transform;
use std::any::TypeId;

/// What one gesture, one key or one command did to the scene.
#[derive(Debug)]
pub(super) struct Step {
    pub name: String,
    /// Tells states of the scene apart: that of the scene after this step.
    pub serial: u64,
    pub changes: Vec<Change>,
    pub settings: Option<(RenderSettings, RenderSettings)>,
    pub environment: Option<(Environment, Environment)>,
    /// What was selected before, and after.
    pub selection: [Vec<SceneId>; 2],
}

/// What a step did to one entity.
#[derive(Debug)]
pub(super) struct Change {
    pub id: SceneId,
    /// Whether it existed before, and after.
    pub exists: [bool; 2],
    /// By the component's place: what it was before, and after.
    pub values: Vec<(usize, [Option<Kept>; 2])>,
}

/// The side of a step that is to be reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Before = 0,
    After = 1,
}

impl Change {
    /// `None` where nothing changed. An entity that does not exist has an empty state.
    pub fn between(
        id: SceneId,
        before: Option<&EntityState>,
        after: Option<&EntityState>,
    ) -> Option<Self> {
        let exists = [before.is_some(), after.is_some()];
        let at = |state: Option<&EntityState>, place: usize| -> Option<Kept> {
            state.and_then(|state| state.get(place).cloned().flatten())
        };
        let places = before.map_or(0, Vec::len).max(after.map_or(0, Vec::len));
        let values: Vec<_> = (0..places)
            .map(|place| (place, [at(before, place), at(after, place)]))
            .filter(|(_, [before, after])| before != after)
            .collect();
        (exists[0] != exists[1] || !values.is_empty()).then_some(Self { id, exists, values })
    }

    /// The entity's state on one side, from that on the other.
    pub fn state(
        &self,
        other: Option<&EntityState>,
        side: Side,
        kinds: &Kinds,
    ) -> Option<EntityState> {
        if !self.exists[side as usize] {
            return None;
        }
        let mut state = other.cloned().unwrap_or_default();
        state.resize(kinds.len(), None);
        for (place, values) in &self.values {
            if let Some(slot) = state.get_mut(*place) {
                slot.clone_from(&values[side as usize]);
            }
        }
        Some(state)
    }
}

impl Step {
    /// About how much memory it takes.
    pub fn bytes(&self) -> usize {
        let values = |change: &Change| -> usize {
            let kept = change
                .values
                .iter()
                .flat_map(|(_, values)| values.iter().flatten());
            size_of_val(change.values.as_slice()) + kept.map(Kept::bytes).sum::<usize>()
        };
        let changes =
            size_of_val(self.changes.as_slice()) + self.changes.iter().map(values).sum::<usize>();
        let selected = self.selection.iter().map(|ids| size_of_val(ids.as_slice()));
        size_of::<Self>() + self.name.capacity() + changes + selected.sum::<usize>()
    }

    /// What to call it where nobody has said; `name_of` knows entities that exist or existed.
    pub fn describe(&self, kinds: &Kinds, name_of: impl Fn(SceneId) -> String) -> String {
        let those = |exists: [bool; 2]| -> Vec<SceneId> {
            let of_kind = self.changes.iter().filter(|change| change.exists == exists);
            of_kind.map(|change| change.id).collect()
        };
        let call = |ids: &[SceneId]| match ids {
            [one] => name_of(*one),
            ids => format!("{} entities", ids.len()),
        };
        let (added, removed) = (those([false, true]), those([true, false]));
        if !added.is_empty() && removed.is_empty() {
            return format!("Add {}", call(&added));
        }
        if !removed.is_empty() {
            return format!("Delete {}", call(&removed));
        }
        if self.changes.is_empty() {
            return self.describe_scene();
        }
        let ids: Vec<SceneId> = self.changes.iter().map(|change| change.id).collect();
        let mut places = self.changes.iter().flat_map(|change| &change.values);
        let Some((first, values)) = places.next() else {
            return "Change".into();
        };
        let whose = call(&ids);
        if places.any(|(place, _)| place != first) {
            return format!("Change {whose}");
        }
        let kind = kinds.type_at(*first);
        let is = |id: TypeId| kind == Some(id);
        if is(TypeId::of::<Transform>()) {
            return format!("{} {whose}", transform_verb(values));
        }
        if is(TypeId::of::<Name>()) {
            return format!("Rename {whose}");
        }
        if is(TypeId::of::<Visibility>()) {
            let hidden = values[1].as_ref().and_then(Kept::value::<Visibility>);
            let verb = if hidden == Some(&Visibility::Hidden) {
                "Hide"
            } else {
                "Show"
            };
            return format!("{verb} {whose}");
        }
        if is(TypeId::of::<ChildOf>()) {
            return format!("Change the parent of {whose}");
        }
        let what = component_names().into_iter().find(|(id, _)| is(*id));
        let name = kinds.name_at(*first).unwrap_or("a component");
        match (what, values) {
            (Some((_, what)), _) => format!("Change {what} of {whose}"),
            (None, [None, _]) => format!("Add {name} to {whose}"),
            (None, [_, None]) => format!("Remove {name} from {whose}"),
            (None, _) => format!("Change {name} of {whose}"),
        }
    }

    fn describe_scene(&self) -> String {
        if let Some((before, after)) = &self.settings {
            let differs = |path: &str| match (before.reflect_path(path), after.reflect_path(path)) {
                (Ok(a), Ok(b)) => a.reflect_partial_eq(b) != Some(true),
                _ => false,
            };
            let mut changed = SETTINGS.iter().filter(|setting| differs(&setting.path));
            return match (changed.next(), changed.next()) {
                (Some(setting), None) => {
                    let name = setting.path.rsplit('.').next().unwrap_or(&setting.path);
                    format!("Change {}", name.replace('_', " "))
                }
                _ => "Change settings".into(),
            };
        }
        "Change the environment".into()
    }
}

/// As the names of steps call the components.
fn component_names() -> [(TypeId, &'static str); 10] {
    [
        (TypeId::of::<Phong>(), "the material"),
        (TypeId::of::<UsesMaterial>(), "the shared material"),
        (TypeId::of::<MeshSource>(), "the mesh"),
        (TypeId::of::<PointLamp>(), "the light"),
        (TypeId::of::<DirectionalLamp>(), "the light"),
        (TypeId::of::<SegmentLamp>(), "the light"),
        (TypeId::of::<ParallelogramLamp>(), "the light"),
        (TypeId::of::<SceneCamera>(), "the camera"),
        (TypeId::of::<Lens>(), "the lens"),
        (TypeId::of::<Motion>(), "the motion"),
    ]
}

fn transform_verb([before, after]: &[Option<Kept>; 2]) -> &'static str {
    let of = |kept: &Option<Kept>| {
        kept.as_ref()
            .and_then(|kept| kept.value::<Transform>().copied())
    };
    let (Some(before), Some(after)) = (of(before), of(after)) else {
        return "Place";
    };
    match (
        before.rotation == after.rotation,
        before.scale == after.scale,
    ) {
        (true, true) => "Move",
        (false, true) => "Turn",
        (true, false) => "Scale",
        (false, false) => "Place",
    }
}
