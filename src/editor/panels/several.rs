//! One property of several entities at once: a field shows the active one's value, says where the
//! others differ, and what is entered reaches all of them.

use super::fields::{self, Number};
use bevy::color::LinearRgba;
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy_egui::egui::Ui;
use std::ops::RangeInclusive;

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
            if world.get::<C>(entity).is_some_and(|old| *old != value)
                && let Some(mut component) = world.get_mut::<C>(entity)
            {
                *component = value;
            }
        }
    }
}

/// Rows of fields: each shows the active one's property, and sets it for all.
impl<C: Component<Mutability = Mutable> + Clone + PartialEq> Several<C> {
    /// A number.
    pub fn number(
        &mut self,
        ui: &mut Ui,
        label: &str,
        says: &str,
        number: Number,
        property: impl Fn(&mut C) -> &mut f32,
    ) {
        self.field(property, |value, mixed| {
            number.row(ui, label, says, value, mixed)
        });
    }

    /// A whole number.
    pub fn integer(
        &mut self,
        ui: &mut Ui,
        label: &str,
        says: &str,
        range: RangeInclusive<u32>,
        property: impl Fn(&mut C) -> &mut u32,
    ) {
        self.field(property, |value, mixed| {
            fields::integer(ui, label, says, value, range, mixed)
        });
    }

    /// An angle; the range is in degrees.
    pub fn angle(
        &mut self,
        ui: &mut Ui,
        label: &str,
        says: &str,
        degrees: [f32; 2],
        property: impl Fn(&mut C) -> &mut f32,
    ) {
        self.field(property, |value, mixed| {
            fields::angle(ui, label, says, value, degrees, mixed)
        });
    }

    /// A colour in [0, 1].
    pub fn color(
        &mut self,
        ui: &mut Ui,
        label: &str,
        says: &str,
        property: impl Fn(&mut C) -> &mut LinearRgba,
    ) {
        self.field(property, |value, mixed| {
            fields::color(ui, label, says, value, mixed)
        });
    }

    /// Three numbers.
    pub fn point(
        &mut self,
        ui: &mut Ui,
        label: &str,
        says: &str,
        number: Number,
        property: impl Fn(&mut C) -> &mut Vec3,
    ) {
        self.field(property, |value, mixed| {
            fields::point(ui, label, says, value, number, mixed)
        });
    }

    /// A switch.
    pub fn switch(
        &mut self,
        ui: &mut Ui,
        label: &str,
        says: &str,
        property: impl Fn(&mut C) -> &mut bool,
    ) {
        self.field(property, |value, mixed| {
            fields::switch(ui, label, says, value, mixed)
        });
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
