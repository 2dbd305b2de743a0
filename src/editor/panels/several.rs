//! One property of several entities at once: a field shows the active one's value, says where the
//! others differ, and what is entered reaches all of them.

use super::fields::{chosen_ui, property_ui};
use crate::scene::schema::{Property, keep_order};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::reflect::{ParsedPath, Reflect, ReflectPath, ReflectRef, Typed};
use bevy_egui::egui::Ui;

/// Copies of the same component of several entities, the active one's first.
pub(super) struct Several<C> {
    entities: Vec<Entity>,
    values: Vec<C>,
    changed: bool,
}

impl<C: Component<Mutability = Mutable> + Clone + PartialEq> Several<C> {
    /// The copies of those entities that carry the component; `None` where none does.
    pub fn of(world: &World, entities: &[Entity]) -> Option<Self> {
        let (entities, values): (Vec<Entity>, Vec<C>) = entities
            .iter()
            .filter_map(|&entity| Some((entity, world.get::<C>(entity)?.clone())))
            .unzip();
        (!values.is_empty()).then_some(Self {
            entities,
            values,
            changed: false,
        })
    }

    /// The active one's.
    pub fn first(&self) -> &C {
        &self.values[0]
    }

    /// All of them, to be [put back](Self::put_back) where what is entered makes no sense together.
    pub fn copies(&self) -> Vec<C> {
        self.values.clone()
    }

    /// Takes back what was entered since.
    pub fn put_back(&mut self, copies: Vec<C>) {
        self.values = copies;
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.values.len()
    }

    /// Whether any of them is so.
    pub fn any(&self, is_so: impl FnMut(&C) -> bool) -> bool {
        self.values.iter().any(is_so)
    }

    /// Lets `draw` show the active one's property and whether others differ. Where it returns true
    /// all of them get what it left.
    pub fn field<T: Clone + PartialEq>(
        &mut self,
        property: impl Fn(&mut C) -> &mut T,
        draw: impl FnOnce(&mut T, bool) -> bool,
    ) {
        let mut value = property(&mut self.values[0]).clone();
        let mixed = self.values[1..]
            .iter_mut()
            .any(|other| *property(other) != value);
        if draw(&mut value, mixed) {
            for other in &mut self.values {
                *property(other) = value.clone();
            }
            self.changed = true;
        }
    }

    /// Changes all of them.
    pub fn change(&mut self, mut change: impl FnMut(&mut C)) {
        self.values.iter_mut().for_each(&mut change);
        self.changed = true;
    }

    /// Writes back those that became others. What was only looked at is not touched.
    pub fn write(self, world: &mut World) {
        if !self.changed {
            return;
        }
        for (entity, value) in self.entities.into_iter().zip(self.values) {
            if let Some(mut component) = world.get_mut::<C>(entity) {
                component.set_if_neq(value);
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
        let mixed = self.any(|value| value != self.first() && name(value) != current);
        let (label, says) = (&property.label, &property.says);
        chosen_ui(ui, label, says, &current, &property.choices(), mixed)
    }

    /// One property.
    pub fn property(&mut self, ui: &mut Ui, property: &Property) {
        let Some((active, others)) = self.values.split_first_mut() else {
            return;
        };
        let before = active.clone();
        let is_mixed = |path: &str| {
            // Parsed once, and those that are alike in everything not looked into: there may be ten thousand.
            let Ok(path) = ParsedPath::parse(path) else {
                return false;
            };
            let of_active = path.reflect_element(before.as_partial_reflect());
            let differs = |other: &C| match (&of_active, path.reflect_element(other)) {
                (Ok(of_active), Ok(other)) => of_active.reflect_partial_eq(other) == Some(false),
                _ => false,
            };
            others
                .iter()
                .any(|other| *other != before && differs(other))
        };
        let root = active.as_partial_reflect_mut();
        let Some(path) = property_ui(ui, root, property, &is_mixed) else {
            return;
        };
        keep_order(root, &path);
        let Ok(entered) = path.as_str().reflect_element(active.as_partial_reflect()) else {
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
        let mut several = Several::<PointLamp>::of(&world, &[lamps[1], other, lamps[0]]).unwrap();
        several.field(
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
            let mut several = Several::<PointLamp>::of(&world, &[lamp]).unwrap();
            several.field(|lamp| &mut lamp.intensity, |_, _| entered);
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
}
