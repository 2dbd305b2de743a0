//! What the mixer sets: factors of lights that the scene does not have until they are baked into it.

use super::super::temperature::{self, WHITE};
use super::sketches::Sketches;
use crate::editor::edits::scene_entity;
use crate::editor::history::{History, commit};
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::editor::viewport::EditorCamera;
use crate::film::LightMix;
use crate::scene::{AnyLamp, DirectionalLamp, ParallelogramLamp, PointLamp, SceneId, SegmentLamp};
use crate::trace::Gains;
use crate::view::ViewSettings;
use bevy::camera::visibility::InheritedVisibility;
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{EntityRef, Mut, World};
use bevy::math::Vec3;
use std::collections::{BTreeSet, HashMap, HashSet};

/// What is set for one light.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Strip {
    /// Multiplies its light.
    pub gain: f32,
    /// Multiplies it too, channel by channel.
    pub color: LinearRgba,
    /// Kelvin that it is given, and those that the scene gives it; `None` leaves it as it is.
    pub kelvin: Option<[f32; 2]>,
    pub is_muted: bool,
    pub is_solo: bool,
}

impl Default for Strip {
    fn default() -> Self {
        Self {
            gain: 1.0,
            color: LinearRgba::WHITE,
            kelvin: None,
            is_muted: false,
            is_solo: false,
        }
    }
}

impl Strip {
    /// What colour and temperature make of a white light.
    fn hue(&self) -> Vec3 {
        let color = Vec3::new(self.color.red, self.color.green, self.color.blue);
        let [to, from] = self.kelvin.unwrap_or([WHITE; 2]).map(temperature::color);
        // Neither has a channel of nothing within the temperatures of lights.
        color * to / from
    }

    /// How hot a body is that glows as it makes of a light.
    pub fn kelvin_of(&self, light: &LightRow) -> f32 {
        match self.kelvin {
            None => light.kelvin(),
            Some([to, from]) if from == light.kelvin() => to,
            // The scene's was changed since.
            Some(kelvin) => {
                let [to, from] = kelvin.map(temperature::color);
                temperature::nearest(light.color * to / from).round()
            }
        }
    }

    /// Has a light glow as a body so hot.
    pub fn set_kelvin(&mut self, light: &LightRow, kelvin: f32) {
        let own = light.kelvin();
        self.kelvin = (kelvin != own).then_some([kelvin, own]);
    }

    /// What its light is multiplied by where it is heard.
    pub fn factor(&self) -> Vec3 {
        self.gain * self.hue()
    }
}

/// More are not remembered: nobody undoes so far for a mix.
const MOST_BAKES: usize = 32;

/// A step that the mix was baked in.
struct Bake {
    /// The history's state after it.
    state: u64,
    is_done: bool,
    /// What was set before it while it is done, and what was set after it while it is undone.
    other: HashMap<SceneId, Strip>,
}

/// The light mixer: what it sets, and what it remembers between two frames.
#[derive(Resource, Default)]
pub(in crate::editor::panels) struct Mixer {
    /// Whether it is shown.
    pub is_open: bool,
    strips: HashMap<SceneId, Strip>,
    /// How many of them are alone.
    solos: usize,
    /// Oldest first.
    bakes: Vec<Bake>,
    /// Groups of which only the heading is shown.
    pub(super) folded: BTreeSet<String>,
    pub(super) sketches: Sketches,
}

impl Mixer {
    /// What is set for a light.
    pub(super) fn strip(&self, id: SceneId) -> Strip {
        self.strips.get(&id).cloned().unwrap_or_default()
    }

    /// Sets it.
    pub(super) fn set(&mut self, id: SceneId, strip: Strip) {
        let is_solo = strip.is_solo;
        let old = match strip == Strip::default() {
            true => self.strips.remove(&id),
            false => self.strips.insert(id, strip),
        };
        let was_solo = old.is_some_and(|old| old.is_solo);
        self.solos = self.solos + usize::from(is_solo) - usize::from(was_solo);
    }

    /// Whether nothing is set.
    pub fn is_neutral(&self) -> bool {
        self.strips.is_empty()
    }

    /// Whether a light is not heard: it is muted, or others are alone.
    pub fn is_silent(&self, id: SceneId) -> bool {
        let strip = self.strips.get(&id);
        strip.is_some_and(|strip| strip.is_muted)
            || self.solos > 0 && !strip.is_some_and(|s| s.is_solo)
    }

    /// What a light is multiplied by.
    pub fn factor(&self, id: SceneId) -> Vec3 {
        match self.is_silent(id) {
            true => Vec3::ZERO,
            false => self.strip(id).factor(),
        }
    }

    /// What is no longer there is not alone, or nobody would be heard; the rest of its strip waits for undo.
    fn only_of(&mut self, lights: &[LightRow]) {
        let there: HashSet<SceneId> = lights.iter().map(|light| light.id).collect();
        for (id, strip) in &mut self.strips {
            strip.is_solo &= there.contains(id);
        }
        self.strips.retain(|_, strip| *strip != Strip::default());
        self.count_solos();
    }

    fn count_solos(&mut self) {
        self.solos = self.strips.values().filter(|strip| strip.is_solo).count();
    }

    /// Lights have become what was set for them; for the others it stays, and none is alone any more.
    fn give_to(&mut self, baked: &HashSet<SceneId>) {
        self.strips.retain(|id, strip| {
            strip.is_solo = false;
            !baked.contains(id) && *strip != Strip::default()
        });
        self.solos = 0;
    }

    /// Where baking was undone or done again, what is set goes with the lights.
    fn follow(&mut self, history: &History) {
        let Self { strips, bakes, .. } = self;
        let mut exchange = |bake: &mut Bake, to: bool| {
            if bake.is_done != to && history.is_done(bake.state) == to {
                bake.is_done = to;
                std::mem::swap(strips, &mut bake.other);
            }
        };
        for bake in bakes.iter_mut().rev() {
            exchange(bake, false);
        }
        for bake in bakes {
            exchange(bake, true);
        }
        self.count_solos();
    }

    /// Nothing is set any more.
    pub fn reset(&mut self) {
        self.strips.clear();
        self.solos = 0;
    }

    /// Another scene is open: its lights are others, whatever their numbers.
    pub fn forget_scene(&mut self) {
        self.reset();
        self.bakes.clear();
        self.folded.clear();
        self.sketches = Sketches::default();
    }
}

/// A light of the scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LightRow {
    pub id: SceneId,
    pub name: String,
    /// It is not hidden.
    pub is_shown: bool,
    /// Linear; of one with a gradient its first.
    pub color: Vec3,
}

impl LightRow {
    /// How hot a body is that glows so, as the light's own field says it.
    pub fn kelvin(&self) -> f32 {
        temperature::nearest(self.color).round()
    }
}

fn color_of(lamp: EntityRef) -> Vec3 {
    let first = |colors: &[LinearRgba]| colors.first().copied();
    let color = (lamp.get::<PointLamp>().map(|lamp| lamp.color))
        .or_else(|| lamp.get::<DirectionalLamp>().map(|lamp| lamp.color))
        .or_else(|| first(&lamp.get::<SegmentLamp>()?.colors))
        .or_else(|| first(&lamp.get::<ParallelogramLamp>()?.colors));
    color.map_or(Vec3::ONE, |color| {
        Vec3::new(color.red, color.green, color.blue)
    })
}

/// All lights of the scene, by their names and numbers.
pub(super) fn lights(world: &mut World) -> Vec<LightRow> {
    let mut query = world.query_filtered::<(
        &SceneId,
        Option<&Name>,
        Option<&InheritedVisibility>,
        EntityRef,
    ), AnyLamp>();
    let rows = query
        .iter(world)
        .map(|(&id, name, visibility, lamp)| LightRow {
            id,
            name: name.map_or_else(|| format!("light {}", id.0), ToString::to_string),
            is_shown: visibility.is_none_or(|visibility| visibility.get()),
            color: color_of(lamp),
        });
    let mut rows: Vec<LightRow> = rows.collect();
    rows.sort_by(|a, b| (&a.name, a.id).cmp(&(&b.name, b.id)));
    rows
}

/// The editor's view shows the mix.
pub(in crate::editor::panels) fn apply(world: &mut World) {
    let apart = world.resource::<Preferences>().lights_apart;
    if !world.resource::<Mixer>().bakes.is_empty() {
        world.resource_scope(|world, mut mixer: Mut<Mixer>| {
            mixer.follow(world.resource::<History>());
        });
    }
    let gains = if world.resource::<Mixer>().is_neutral() {
        Gains::default()
    } else {
        let rows = lights(world);
        world.resource_mut::<Mixer>().only_of(&rows);
        let mixer = world.resource::<Mixer>();
        let gains = rows.iter().map(|row| (row.id.0, mixer.factor(row.id)));
        gains.collect()
    };
    let mix = LightMix { apart, gains };
    let mut views = world.query_filtered::<(Entity, Option<&ViewSettings>), With<EditorCamera>>();
    let other: Vec<Entity> = views
        .iter(world)
        .filter(|(_, own)| own.map_or(mix != LightMix::default(), |own| own.mix != mix))
        .map(|(view, _)| view)
        .collect();
    for view in other {
        let own = world.get::<ViewSettings>(view).cloned();
        world.entity_mut(view).insert(ViewSettings {
            mix: mix.clone(),
            ..own.unwrap_or_default()
        });
    }
}

/// A lamp's intensity, and its colours.
fn strengths(world: &mut World, lamp: Entity, change: impl Fn(&mut f32, &mut [LinearRgba])) {
    if let Some(mut lamp) = world.get_mut::<PointLamp>(lamp) {
        let PointLamp {
            intensity, color, ..
        } = &mut *lamp;
        change(intensity, std::slice::from_mut(color));
    }
    if let Some(mut lamp) = world.get_mut::<DirectionalLamp>(lamp) {
        let DirectionalLamp {
            intensity, color, ..
        } = &mut *lamp;
        change(intensity, std::slice::from_mut(color));
    }
    if let Some(mut lamp) = world.get_mut::<SegmentLamp>(lamp) {
        let SegmentLamp {
            intensity, colors, ..
        } = &mut *lamp;
        change(intensity, colors);
    }
    if let Some(mut lamp) = world.get_mut::<ParallelogramLamp>(lamp) {
        let ParallelogramLamp {
            intensity, colors, ..
        } = &mut *lamp;
        change(intensity, colors);
    }
}

/// The lights that are shown become what the mix makes of them, and nothing is set for them: the picture stays, and undo
/// brings the lights and the mix back. One that is not heard has no intensity, and keeps its colour.
pub(super) fn bake(world: &mut World) {
    // What was changed before is a step of its own.
    commit(world);
    let rows = lights(world);
    let mixer = world.resource::<Mixer>();
    let shown = rows.iter().filter(|row| row.is_shown);
    let mixed: Vec<_> = shown
        .filter(|row| mixer.factor(row.id) != Vec3::ONE)
        .map(|row| (row.id, mixer.is_silent(row.id), mixer.strip(row.id)))
        .collect();
    let count = mixed.len();
    let shown: HashSet<SceneId> = rows
        .iter()
        .filter(|row| row.is_shown)
        .map(|row| row.id)
        .collect();
    for (id, is_silent, strip) in mixed {
        let Some(lamp) = scene_entity(world, id) else {
            continue;
        };
        let gain = if is_silent { 0.0 } else { strip.gain };
        let hue = strip.hue();
        strengths(world, lamp, |intensity, colors| {
            *intensity = (*intensity * gain).min(f32::MAX);
            for color in colors {
                color.red = (color.red * hue.x).min(f32::MAX);
                color.green = (color.green * hue.y).min(f32::MAX);
                color.blue = (color.blue * hue.z).min(f32::MAX);
            }
        });
    }
    let mut history = world.resource_mut::<History>();
    history.name_next("Bake the mix into the lights");
    let is_step = commit(world);
    let state = world.resource::<History>().state();
    let mut mixer = world.resource_mut::<Mixer>();
    if is_step {
        let other = mixer.strips.clone();
        // Those that were undone cannot be done again.
        mixer.bakes.retain(|bake| bake.is_done);
        if mixer.bakes.len() == MOST_BAKES {
            mixer.bakes.remove(0);
        }
        mixer.bakes.push(Bake {
            state,
            is_done: true,
            other,
        });
    }
    mixer.give_to(&shown);
    let said = crate::editor::texts::counted(count as u64, "light");
    let mut notices = world.resource_mut::<Notices>();
    notices.tell(format!("The mix is baked into {said}; undo takes it back."));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    #[test]
    fn what_many_lights_are_multiplied_by_is_known_in_no_time() {
        let row = |id| LightRow {
            id: SceneId(id),
            name: String::new(),
            is_shown: true,
            color: Vec3::ONE,
        };
        let rows: Vec<LightRow> = (1..=30_000).map(row).collect();
        let mut mixer = Mixer::default();
        for row in rows.iter().skip(1) {
            let strip = Strip {
                gain: 2.0,
                ..Strip::default()
            };
            mixer.set(row.id, strip);
        }
        let start = Instant::now();
        mixer.only_of(&rows);
        let sum: Vec3 = rows.iter().map(|row| mixer.factor(row.id)).sum();
        assert_eq!(sum, Vec3::splat(59_999.0));
        assert!(start.elapsed() < Duration::from_secs(3));
    }
}
