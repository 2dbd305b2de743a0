//! An edit of lights and materials while a picture is rendered: what of the picture stays true, and what is rendered again.
//!
//! Another tint of a light that has a plane of its own is no work at all; a light that moved, changed its shape or is new
//! needs that plane again; one that went takes its plane with it. Another material is rendered again in the tiles where some
//! path met it: no sample elsewhere hangs on it, unless it lets light through. Whatever else changes the paths themselves, and
//! lights that are seen are in the way of paths: nothing is kept then, and another render begins.

use super::engine::Engine;
use crate::film::lock;
use crate::film::subject::{MOST_APART, Subject};
use crate::scene::Lighting;
use crate::trace::planes::OWN;
use crate::trace::{
    Gains, Lamp, LightKind, Lights, MaterialSet, World, other_points, samples_per_pixel,
};
use glam::Vec3;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Where the first sample of the planes that are rendered again takes no longer than this, what is seen waits for it; else a
/// coarse picture of everything comes first.
const LONGEST_SAMPLE: Duration = Duration::from_millis(100);
/// Planes are kept where those that are rendered again take no more than this part of a sample of everything: above it a
/// render of its own is as soon complete, and shows what it has tile by tile. Not so where a light is set apart by it from
/// many: once, and what follows is of that light alone.
const LARGEST_PART: f64 = 0.8;

/// What the way to where lights are asked for takes, as a part of what asking for a light takes; and what the rays take that
/// lead there, where they are not known.
const WAY: f64 = 0.5;
const RAYS: f64 = 0.5;

/// What a render shall be of, and of each of its planes the number of the one that has the same light now.
pub(super) struct Edit {
    subject: Subject,
    from: Vec<Option<usize>>,
    /// The materials that are others.
    materials: MaterialSet,
    /// A light gets a plane of its own: the next edit of it is of that plane alone.
    sets_apart: bool,
    /// A coarse picture comes first.
    is_long: bool,
}

impl Edit {
    /// From what is rendered to another world. `None` where nothing of the picture stays true.
    pub fn between(old: &Subject, world: World, gains: &Gains) -> Option<Self> {
        let gained = gains.applied(&world);
        let same_paths = old.stays_apart
            && Arc::ptr_eq(&old.world.aggregate, &world.aggregate)
            && Arc::ptr_eq(&old.world.objects, &world.objects)
            && Arc::ptr_eq(&old.world.textures, &world.textures)
            && old.world.environment.is_same(&world.environment)
            && old.world.needs == gained.needs
            && samples_per_pixel(&old.world, &old.camera, &old.settings)
                == samples_per_pixel(&world, &old.camera, &old.settings);
        let is_shared = old.settings.lighting == Lighting::Classic
            && old.world.lights.count() != world.lights.count();
        if !same_paths || is_shared {
            return None;
        }
        let materials = old.world.changed_materials(&world)?;
        let first = edited_first(old, &gained);
        let sets_apart = first.iter().any(|id| !old.first.contains(id));
        let subject = old.edited(world, first, gains.clone());
        let from = same_planes(old, &subject)?;
        Some(Self {
            subject,
            from,
            materials,
            sets_apart,
            is_long: false,
        })
    }

    /// This edit after another one, from where that began.
    fn after(mut self, before: &Self) -> Self {
        for from in &mut self.from {
            *from = from.and_then(|plane| before.from[plane]);
        }
        self.materials = self.materials.union(before.materials);
        self.sets_apart |= before.sets_apart;
        self
    }

    /// Whether every plane has the light that it had.
    fn leaves_lights(&self, old: &Subject) -> bool {
        let mut planes = self.from.iter().enumerate();
        let stays = planes.all(|(plane, from)| *from == Some(plane));
        stays && self.from.len() == old.planes()
    }

    /// Whether everything stays what it is, and where: only tints are others.
    fn is_of_tints(&self, old: &Subject) -> bool {
        self.leaves_lights(old) && self.materials == MaterialSet::NONE
    }

    /// Whether some plane has to be rendered, or some tile.
    fn needs_rays(&self) -> bool {
        self.from.contains(&None) || self.materials != MaterialSet::NONE
    }

    /// About which part of a whole sample that takes which has to be rendered, where that part of all tiles is emptied: the way
    /// to where lights are asked for, half as much as a light, and those lights. What rays hit there is known.
    fn part_of_sample(&self, emptied: f64) -> f64 {
        let planes = &self.subject.light.planes;
        let lights = self.subject.world.lights.count();
        let stale = (0..lights).filter(|light| self.from[planes.of_light(*light)].is_none());
        let of_others = match stale.count() {
            0 => 0.0,
            stale => (WAY + stale as f64) / (RAYS + WAY + lights as f64),
        };
        emptied + (1.0 - emptied) * of_others
    }
}

/// Who has a plane of its own before others after an edit that leads to this world: a light that is edited, and those that
/// were before. Where more lights change at once than there are planes nobody edits one.
fn edited_first(old: &Subject, world: &World) -> Vec<u64> {
    let mut before: Vec<_> = old.world.lights.all().enumerate().collect();
    let planes = &old.light.planes;
    let mut lights_of = vec![0; planes.count()];
    for (light, _) in &before {
        lights_of[planes.of_light(*light)] += 1;
    }
    before.sort_by_key(|(_, lamp)| lamp.name());
    let is_edited = |lamp: Lamp| {
        let was = before.binary_search_by_key(&lamp.name(), |(_, lamp)| lamp.name());
        let was = was.ok().map(|at| before[at]);
        let velocity = |lights: &Lights| lights.velocity(lamp.id());
        was.is_none_or(|(place, was)| {
            let is_same =
                was.is_same(lamp) && velocity(&old.world.lights) == velocity(&world.lights);
            !is_same && lights_of[planes.of_light(place)] > 1
        })
    };
    let edited = world.lights.all().filter(|lamp| is_edited(*lamp));
    let mut first: Vec<u64> = edited.map(|lamp| lamp.id()).collect();
    if first.len() > MOST_APART {
        first.clear();
    }
    for id in &old.first {
        if !first.contains(id) && world.lights.all().any(|lamp| lamp.id() == *id) {
            first.push(*id);
        }
    }
    first.truncate(MOST_APART);
    first
}

/// A light, and which plane it has.
struct PlacedLight<'a> {
    lamp: Lamp<'a>,
    velocity: Vec3,
    plane: usize,
}

fn placed_lights(subject: &Subject) -> Vec<PlacedLight<'_>> {
    let lights = &subject.light.world.lights;
    (lights.all().enumerate())
        .map(|(number, lamp)| PlacedLight {
            velocity: lights.velocity(lamp.id()),
            plane: subject.light.planes.of_light(number),
            lamp,
        })
        .collect()
}

/// Of each plane of the new subject the number of that which has the same light in the old one. `None` where a light that
/// is seen differs.
fn same_planes(old: &Subject, new: &Subject) -> Option<Vec<Option<usize>>> {
    let (mut before, after) = (placed_lights(old), placed_lights(new));
    before.sort_by_key(|light| light.lamp.name());
    let find = |name: (LightKind, u64)| {
        let found = before.binary_search_by_key(&name, |light| light.lamp.name());
        found.ok().map(|at| &before[at])
    };
    let mut from = vec![None; new.planes()];
    from[OWN] = Some(OWN);
    let mut stale = vec![false; new.planes()];
    for light in &after {
        let same = find(light.lamp.name())
            .filter(|was| was.lamp.is_same(light.lamp) && was.velocity == light.velocity);
        if same.is_none() && light.lamp.is_seen() {
            return None;
        }
        let plane = same.map(|was| was.plane);
        stale[light.plane] |=
            plane.is_none() || from[light.plane].is_some_and(|p| Some(p) != plane);
        from[light.plane] = plane;
    }
    let mut names: Vec<_> = after.iter().map(|light| light.lamp.name()).collect();
    names.sort_unstable();
    for was in &before {
        if names.binary_search(&was.lamp.name()).is_err() {
            if was.lamp.is_seen() {
                return None;
            }
            // Those with whom it shared a plane stand there without it now.
            for (from, stale) in from.iter().zip(&mut stale) {
                *stale |= *from == Some(was.plane);
            }
        }
    }
    let shared =
        |planes: &[PlacedLight], plane| planes.iter().filter(|light| light.plane == plane).count();
    for (plane, (from, stale)) in from.iter_mut().zip(stale).enumerate().skip(OWN + 1) {
        let as_many = from.is_some_and(|from| shared(&before, from) == shared(&after, plane));
        if stale || !as_many {
            *from = None;
        }
    }
    Some(from)
}

impl Engine {
    /// Renders another world from now on, its lights with these gains, and keeps what stays true of the picture. False, and
    /// nothing done, where that is nothing, or hardly anything.
    pub fn edit(&self, world: World, gains: &Gains) -> bool {
        if !self.has_begun() {
            return false;
        }
        let mut waiting = lock(&self.edits);
        let now = self.subject();
        let old = waiting.as_ref().map_or(&*now, |edit| &edit.subject);
        let Some(mut edit) = Edit::between(old, world, gains) else {
            return false;
        };
        if let Some(before) = &*waiting {
            edit = edit.after(before);
        }
        if edit.is_of_tints(&now) {
            // A coarse picture is of the tints with which it began: then the render takes them when it is stopped.
            let preview = lock(&self.preview);
            if preview.is_none() {
                *waiting = None;
                self.edit_waits.store(false, Ordering::Relaxed);
                self.set_subject(edit.subject);
                return true;
            }
        }
        if edit.needs_rays() {
            let part = edit.part_of_sample(self.part_that_shows(edit.materials));
            // Before anybody knows how long it takes, it may be long.
            let seconds = self.seconds_a_sample().map(|whole| whole * part);
            edit.is_long = seconds.is_none_or(|seconds| seconds > LONGEST_SAMPLE.as_secs_f64());
            if edit.is_long && part > LARGEST_PART && !edit.sets_apart {
                return false;
            }
        }
        *waiting = Some(edit);
        self.edit_waits.store(true, Ordering::Relaxed);
        self.reopen();
        true
    }

    /// Which part of the tiles that are rendered may show one of these materials.
    fn part_that_shows(&self, materials: MaterialSet) -> f64 {
        if materials == MaterialSet::NONE {
            return 0.0;
        }
        let shows = |tile: &&u32| lock(&self.tiles[**tile as usize]).may_show(materials);
        self.rendered.iter().filter(shows).count() as f64 / self.rendered.len().max(1) as f64
    }

    /// Becomes what the edit that waits wants, while nothing is traced.
    pub(super) fn take_edit(&self) {
        // Held to the end: another edit that came in between would be compared with what is rendered no longer, and lost.
        let mut waiting = lock(&self.edits);
        let Some(mut edit) = waiting.take() else {
            return;
        };
        self.edit_waits.store(false, Ordering::Relaxed);
        let needs_rays = edit.needs_rays();
        let old = self.subject();
        let moved = other_points(&old.light.world, &edit.subject.light.world, &old.settings);
        let leaves_lights = edit.leaves_lights(&old);
        let arrangement = old.arrangement.wrapping_add(1);
        edit.subject.arrangement = arrangement;
        self.batch.suit(&edit.subject);
        self.set_subject(edit.subject);
        let mut emptied = 0;
        for tile in &self.tiles {
            let mut tile = lock(tile);
            tile.rearrange(&edit.from, arrangement);
            if tile.may_show(edit.materials) {
                emptied += tile.empty();
            }
        }
        self.start_over(emptied, needs_rays);
        let was_coarse = lock(&self.preview).take().is_some();
        if needs_rays || was_coarse {
            // Until it has light everywhere again, what is seen stays, or is coarse.
            self.set_divider(0);
            let begins_coarse = edit.is_long || !needs_rays;
            self.begins_coarse.store(begins_coarse, Ordering::Relaxed);
        }
        drop(waiting);
        // That takes its time, in which others may edit: nothing is traced before it is done.
        self.kept.edit(leaves_lights, moved);
    }
}

#[cfg(test)]
mod many_lights_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod unlit_tests;
