//! The commands of the light mixer.

use super::mix::{Mixer, Strip, bake, lights};
use crate::editor::command::{Command, Over, State, commands, flip};
use crate::editor::edits::scene_entity;
use crate::editor::selection::Selection;
use crate::scene::{DirectionalLamp, ParallelogramLamp, PointLamp, SceneId, SegmentLamp};
use bevy::ecs::world::World;

pub(in crate::editor::panels) fn commands() -> Vec<Command> {
    commands! {
        "lights.mixer" "Light mixer" ["M"] "Shows what each light adds to the picture; solo, mute, gain and colour without a ray traced again"
            => |world| flip(&mut world.resource_mut::<Mixer>().is_open); menu("View", 5); state(|world| State::switch(world.get_resource::<Mixer>().is_some_and(|mixer| mixer.is_open))),
        "lights.bake" "Bake the mix into the lights" [] "Gives the lights the intensities and colours that the light mixer shows, as one step; the picture stays"
            => bake; menu("Edit", 4); state(is_mixed),
        "lights.reset-mix" "Reset the mix" [] "Shows the lights as the scene has them"
            => |world| world.resource_mut::<Mixer>().reset(); state(is_mixed),
        "lights.solo" "Solo in the mix" [] "Shows the selected lights without the others, or with them again"
            => |world| flip_selected(world, |strip| &mut strip.is_solo); over(&[Over::Entity]); state(is_light_selected),
        "lights.mute" "Mute in the mix" [] "Shows the picture without the selected lights, or with them again"
            => |world| flip_selected(world, |strip| &mut strip.is_muted); over(&[Over::Entity]); state(is_light_selected),
    }
}

fn is_mixed(world: &World) -> State {
    let mixer = world.get_resource::<Mixer>();
    let ready = mixer.is_some_and(|mixer| !mixer.is_neutral());
    State::when(ready, "Nothing is set in the light mixer.")
}

fn is_light(world: &World, id: SceneId) -> bool {
    scene_entity(world, id).is_some_and(|entity| {
        let entity = world.entity(entity);
        entity.contains::<PointLamp>()
            || entity.contains::<DirectionalLamp>()
            || entity.contains::<SegmentLamp>()
            || entity.contains::<ParallelogramLamp>()
    })
}

fn is_light_selected(world: &World) -> State {
    let mut selected = world.resource::<Selection>().ids().iter();
    let ready = selected.any(|id| is_light(world, *id));
    State::when(ready, "A light has to be selected.")
}

/// On for all selected lights, or off where it is on for all.
fn flip_selected(world: &mut World, part: fn(&mut Strip) -> &mut bool) {
    let selected = world.resource::<Selection>().ids().to_vec();
    let all = lights(world);
    let chosen = all.iter().filter(|light| selected.contains(&light.id));
    let ids: Vec<SceneId> = chosen.map(|light| light.id).collect();
    let mut mixer = world.resource_mut::<Mixer>();
    let is_on = ids.iter().all(|id| *part(&mut mixer.strip(*id)));
    for id in ids {
        let mut strip = mixer.strip(id);
        *part(&mut strip) = !is_on;
        mixer.set(id, strip);
    }
}
