//! One property of several entities at once: a field shows the active one's value, says where the
//! others differ, and what is entered reaches all of them.
//!
//! There may be ten thousand: they are copied, and compared in each property, once something of theirs changed, and not in
//! every frame.

use super::fields::{chosen_ui, property_ui};
use crate::scene::schema::{Property, keep_order};
use bevy::ecs::change_detection::{DetectChanges, Ref, Tick};
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::platform::collections::HashMap;
use bevy::reflect::{ParsedPath, Reflect, ReflectPath, ReflectRef, Typed};
use bevy_egui::egui::Ui;
use std::sync::{Arc, Mutex, PoisonError};

/// Copies of the same component of several entities, the active one's first.
pub(super) struct Several<C> {
    copies: Copies<C>,
    changed: bool,
}

struct Copies<C> {
    entities: Arc<[Entity]>,
    values: Arc<Vec<C>>,
    /// Whether others differ from the active one, by what was asked for.
    mixed: Arc<Mutex<HashMap<String, bool>>>,
}

impl<C> Clone for Copies<C> {
    fn clone(&self) -> Self {
        Self {
            entities: self.entities.clone(),
            values: self.values.clone(),
            mixed: self.mixed.clone(),
        }
    }
}

/// The copies that were asked for last.
#[derive(Resource)]
struct Known<C: Component> {
    of: Vec<Entity>,
    copies: Copies<C>,
    /// When they were as these are.
    at: Tick,
    /// How many entities of the world carried the component.
    carriers: usize,
}

impl<C: Component> Known<C> {
    /// Whether the entities' components are as they were then. Quickly, where no component of the kind has changed in all
    /// the world.
    fn is_true<'w>(
        &self,
        world: &'w World,
        mut all: impl ExactSizeIterator<Item = Ref<'w, C>>,
        now: Tick,
    ) -> bool {
        let is_new = |one: &Ref<C>| one.last_changed().is_newer_than(self.at, now);
        if all.len() == self.carriers && !all.any(|one| is_new(&one)) {
            return true;
        }
        let of = |entity: &Entity| world.get_entity(*entity).ok()?.get_ref::<C>();
        let mut carrying = 0;
        let mut those = self.of.iter().filter_map(of);
        let any_new = those.any(|one| {
            carrying += 1;
            is_new(&one)
        });
        !any_new && carrying == self.copies.entities.len()
    }
}

impl<C: Component<Mutability = Mutable> + Clone + PartialEq> Copies<C> {
    fn of(world: &mut World, entities: &[Entity]) -> Self {
        // What is changed after this counts as newer, in this frame already.
        let now = world.increment_change_tick();
        let mut all = world.query::<Ref<C>>();
        let carriers = all.iter(world).len();
        if let Some(known) = world.get_resource::<Known<C>>()
            && known.of == entities
            && known.is_true(world, all.iter(world), now)
        {
            let copies = known.copies.clone();
            if let Some(mut known) = world.get_resource_mut::<Known<C>>() {
                (known.at, known.carriers) = (now, carriers);
            }
            return copies;
        }
        let copies = Self::new(world, entities);
        world.insert_resource(Known {
            of: entities.to_vec(),
            copies: copies.clone(),
            at: now,
            carriers,
        });
        copies
    }

    fn new(world: &World, entities: &[Entity]) -> Self {
        let (entities, values): (Vec<Entity>, Vec<C>) = entities
            .iter()
            .filter_map(|&entity| Some((entity, world.get::<C>(entity)?.clone())))
            .unzip();
        Self {
            entities: entities.into(),
            values: Arc::new(values),
            mixed: Arc::default(),
        }
    }

    /// To be made others.
    fn values_mut(&mut self) -> &mut [C] {
        self.mixed = Arc::default();
        Arc::<Vec<C>>::make_mut(&mut self.values)
    }

    /// What `differs` finds out, once for each key.
    fn is_mixed(&self, key: &str, differs: impl FnOnce(&C, &[C]) -> bool) -> bool {
        let known = || self.mixed.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(&mixed) = known().get(key) {
            return mixed;
        }
        let mixed = (self.values.split_first()).is_some_and(|(active, rest)| differs(active, rest));
        known().insert(key.to_owned(), mixed);
        mixed
    }
}

impl<C: Component<Mutability = Mutable> + Clone + PartialEq> Several<C> {
    /// The copies of those entities that carry the component; `None` where none does.
    pub fn of(world: &mut World, entities: &[Entity]) -> Option<Self> {
        let copies = Copies::of(world, entities);
        (!copies.values.is_empty()).then_some(Self {
            copies,
            changed: false,
        })
    }

    /// The active one's.
    pub fn first(&self) -> &C {
        &self.copies.values[0]
    }

    /// All of them, to be [put back](Self::put_back) where what is entered makes no sense together.
    pub fn copies(&self) -> Arc<Vec<C>> {
        self.copies.values.clone()
    }

    /// Takes back what was entered since.
    pub fn put_back(&mut self, copies: Arc<Vec<C>>) {
        self.copies.values = copies;
        self.copies.mixed = Arc::default();
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.copies.values.len()
    }

    /// Whether any of them is so.
    pub fn any(&self, is_so: impl FnMut(&C) -> bool) -> bool {
        self.copies.values.iter().any(is_so)
    }

    /// Lets `draw` show the active one's property, which no other one of the component has this name of, and whether others
    /// differ. Where it returns true all of them get what it left.
    pub fn field<T: Clone + PartialEq>(
        &mut self,
        name: &str,
        property: impl Fn(&mut C) -> &mut T,
        draw: impl FnOnce(&mut T, bool) -> bool,
    ) {
        let mut active = self.first().clone();
        let mut value = property(&mut active).clone();
        let differs = |active: &C, others: &[C]| {
            let mut others = others.iter().filter(|other| *other != active);
            others.any(|other| *property(&mut other.clone()) != value)
        };
        let mixed = self.copies.is_mixed(name, differs);
        if draw(&mut value, mixed) {
            for other in self.copies.values_mut() {
                *property(other) = value.clone();
            }
            self.changed = true;
        }
    }

    /// Changes all of them.
    pub fn change(&mut self, mut change: impl FnMut(&mut C)) {
        self.copies.values_mut().iter_mut().for_each(&mut change);
        self.changed = true;
    }

    /// Writes back those that became others. What was only looked at is not touched.
    pub fn write(self, world: &mut World) {
        if !self.changed {
            return;
        }
        let Copies {
            entities, values, ..
        } = self.copies;
        for (&entity, value) in entities.iter().zip(values.iter()) {
            if let Some(mut component) = world.get_mut::<C>(entity)
                && *component != *value
            {
                *component = value.clone();
            }
        }
    }
}

/// Rows of fields: each shows the active one's property, and sets it for all.
impl<C: Component<Mutability = Mutable> + Clone + PartialEq + Reflect + Typed> Several<C> {
    /// The properties at these paths, in this order. What some of the entities do not have (the angle of a camera
    /// without one) reaches those that have it.
    pub fn properties(&mut self, ui: &mut Ui, paths: &[&str]) {
        for path in paths {
            if let Some(property) = Property::of_value(self.first().as_partial_reflect(), path) {
                self.property(ui, &property);
            }
        }
    }

    /// Which variant of an enum they are, where that is to be chosen; the name of another one that was.
    pub fn variant_ui(&self, ui: &mut Ui, path: &str) -> Option<&'static str> {
        let property = Property::of_value(self.first().as_partial_reflect(), path)?;
        let name = |value: &C| match path.reflect_element(value.as_partial_reflect()) {
            Ok(value) => match value.reflect_ref() {
                ReflectRef::Enum(value) => value.variant_name().to_owned(),
                _ => String::new(),
            },
            Err(_) => String::new(),
        };
        let current = name(self.first());
        let differs = |active: &C, others: &[C]| {
            let mut others = others.iter().filter(|other| *other != active);
            others.any(|other| name(other) != current)
        };
        let mixed = self.copies.is_mixed(&format!("variant of {path}"), differs);
        let (label, says) = (&property.label, &property.says);
        chosen_ui(ui, label, says, &current, &property.choices(), mixed)
    }

    /// One property.
    pub fn property(&mut self, ui: &mut Ui, property: &Property) {
        let mut active = self.first().clone();
        let copies = &self.copies;
        let is_mixed = |path: &str| {
            copies.is_mixed(path, |before, others| {
                // Parsed once, and those that are alike in everything not looked into.
                let Ok(path) = ParsedPath::parse(path) else {
                    return false;
                };
                let of_active = path.reflect_element(before.as_partial_reflect());
                let differs = |other: &C| match (&of_active, path.reflect_element(other)) {
                    (Ok(of_active), Ok(other)) => {
                        of_active.reflect_partial_eq(other) == Some(false)
                    }
                    _ => false,
                };
                others.iter().any(|other| other != before && differs(other))
            })
        };
        let root = active.as_partial_reflect_mut();
        let Some(path) = property_ui(ui, root, property, &is_mixed) else {
            return;
        };
        keep_order(root, &path);
        let Ok(entered) = path.as_str().reflect_element(active.as_partial_reflect()) else {
            return;
        };
        let Some((first, others)) = self.copies.values_mut().split_first_mut() else {
            return;
        };
        for other in others {
            let other = other.as_partial_reflect_mut();
            if let Ok(place) = path.as_str().reflect_element_mut(other) {
                // It fails only for another type, and these are fields of the same one.
                let _ = place.try_apply(entered);
                keep_order(other, &path);
            }
        }
        *first = active;
        self.changed = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::PointLamp;
    use bevy::ecs::change_detection::DetectChanges;

    #[test]
    fn a_property_is_set_for_all_and_others_stay_as_they_were() {
        let mut world = World::new();
        let lamps = [1.0, 2.0].map(|intensity| {
            let color = bevy::color::LinearRgba::rgb(intensity, 0.0, 0.0);
            let lamp = PointLamp {
                intensity,
                color,
                cone: None,
            };
            world.spawn(lamp).id()
        });
        let other = world.spawn_empty().id();
        let mut several =
            Several::<PointLamp>::of(&mut world, &[lamps[1], other, lamps[0]]).unwrap();
        several.field(
            "intensity",
            |lamp| &mut lamp.intensity,
            |value, mixed| {
                assert_eq!((*value, mixed), (2.0, true));
                *value = 5.0;
                true
            },
        );
        several.write(&mut world);
        for (lamp, red) in lamps.into_iter().zip([1.0, 2.0]) {
            let lamp = world.get::<PointLamp>(lamp).unwrap();
            assert_eq!((lamp.intensity, lamp.color.red), (5.0, red));
        }
    }

    #[test]
    fn what_is_only_looked_at_or_set_to_what_it_was_is_not_marked_changed() {
        let mut world = World::new();
        let lamp = world.spawn(PointLamp::default()).id();
        world.clear_trackers();
        for entered in [false, true] {
            let mut several = Several::<PointLamp>::of(&mut world, &[lamp]).unwrap();
            several.field("intensity", |lamp| &mut lamp.intensity, |_, _| entered);
            several.write(&mut world);
            assert!(
                !world
                    .entity(lamp)
                    .get_ref::<PointLamp>()
                    .unwrap()
                    .is_changed()
            );
        }
    }

    #[test]
    fn they_are_copied_and_compared_again_once_one_of_them_changed_and_only_then() {
        let mut world = World::new();
        let lamps = [1.0, 1.0, 2.0].map(|intensity| {
            let lamp = PointLamp {
                intensity,
                ..PointLamp::default()
            };
            world.spawn(lamp).id()
        });
        let look = |world: &mut World, entered: Option<f32>| {
            let mut several = Several::<PointLamp>::of(world, &lamps).unwrap();
            let copies = several.copies();
            let mut seen = (0.0, false);
            let draw = |value: &mut f32, mixed| {
                seen = (*value, mixed);
                *value = entered.unwrap_or(*value);
                entered.is_some()
            };
            several.field("intensity", |lamp| &mut lamp.intensity, draw);
            several.write(world);
            (copies, seen)
        };
        let (first, seen) = look(&mut world, None);
        assert_eq!(seen, (1.0, true));
        let (again, _) = look(&mut world, None);
        assert!(Arc::ptr_eq(&first, &again), "nothing has changed");
        let other = world.spawn(PointLamp::default()).id();
        let (again, _) = look(&mut world, None);
        assert!(Arc::ptr_eq(&first, &again), "another one is there");
        world.get_mut::<PointLamp>(other).unwrap().intensity = 9.0;
        let (again, _) = look(&mut world, None);
        assert!(Arc::ptr_eq(&first, &again), "another one has changed");
        // What is written in one look is seen in the next, though no tick of the clock lies between.
        look(&mut world, Some(3.0));
        let (written, seen) = look(&mut world, None);
        assert_eq!(seen, (3.0, false));
        world.get_mut::<PointLamp>(lamps[2]).unwrap().intensity = 4.0;
        assert_eq!(look(&mut world, None).1, (3.0, true));
        assert!(!Arc::ptr_eq(&written, &look(&mut world, None).0));
        world.entity_mut(lamps[2]).remove::<PointLamp>();
        let (two, seen) = look(&mut world, None);
        assert_eq!((two.len(), seen), (2, (3.0, false)));
        world.despawn(lamps[1]);
        assert_eq!(look(&mut world, None).0.len(), 1);
    }
}
