//! Who uses what: meshes, pictures.

use bevy::ecs::entity::{Entity, EntityHashMap};
use bevy::platform::collections::{HashMap, HashSet};
use std::hash::Hash;

/// What each entity uses, and how many uses there are of each: what nobody uses any more is known without
/// asking all.
pub(super) struct Uses<K> {
    of: EntityHashMap<Vec<K>>,
    counts: HashMap<K, u32>,
}

impl<K> Default for Uses<K> {
    fn default() -> Self {
        Self {
            of: EntityHashMap::default(),
            counts: HashMap::default(),
        }
    }
}

impl<K: Copy + Eq + Hash> Uses<K> {
    /// From now on an entity uses these, in place of what it used before. Where they are others, all of both
    /// go into `touched`.
    pub fn set(&mut self, entity: Entity, now: Vec<K>, touched: &mut HashSet<K>) {
        let known = self.of.get(&entity).map_or(&[][..], Vec::as_slice);
        if known == now {
            return;
        }
        for used in &now {
            *self.counts.entry(*used).or_default() += 1;
        }
        touched.extend(&now);
        let before = if now.is_empty() {
            self.of.remove(&entity)
        } else {
            self.of.insert(entity, now)
        };
        for used in before.into_iter().flatten() {
            touched.insert(used);
            if let Some(count) = self.counts.get_mut(&used) {
                *count -= 1;
                if *count == 0 {
                    self.counts.remove(&used);
                }
            }
        }
    }

    /// Whether anybody uses it.
    pub fn is_used(&self, thing: K) -> bool {
        self.counts.contains_key(&thing)
    }

    /// All that is used, each once.
    pub fn things(&self) -> impl Iterator<Item = K> + '_ {
        self.counts.keys().copied()
    }

    /// All who use anything.
    pub fn entities(&self) -> impl Iterator<Item = Entity> + '_ {
        self.of.keys().copied()
    }

    /// Who uses any of these.
    pub fn users_of<'a>(&'a self, things: &'a HashSet<K>) -> impl Iterator<Item = Entity> + 'a {
        let uses = (!things.is_empty()).then(|| self.of.iter());
        let uses = uses
            .into_iter()
            .flatten()
            .filter(|(_, used)| used.iter().any(|thing| things.contains(thing)));
        uses.map(|(entity, _)| *entity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entity(index: u32) -> Entity {
        Entity::from_raw_u32(index).expect("it is no sentinel")
    }

    #[test]
    fn a_thing_is_used_until_the_last_of_its_users_has_others() {
        let [a, b] = [entity(1), entity(2)];
        let mut uses = Uses::default();
        let mut touched = HashSet::default();
        uses.set(a, vec![7, 7, 8], &mut touched);
        uses.set(b, vec![8], &mut touched);
        assert_eq!(touched, HashSet::from_iter([7, 8]));
        touched.clear();
        uses.set(a, vec![7, 7, 8], &mut touched);
        assert!(touched.is_empty(), "{touched:?}: it uses what it used");
        uses.set(a, vec![7], &mut touched);
        assert!(uses.is_used(7) && uses.is_used(8));
        uses.set(b, Vec::new(), &mut touched);
        assert!(uses.is_used(7) && !uses.is_used(8));
        let seven = HashSet::from_iter([7]);
        assert_eq!(uses.users_of(&seven).collect::<Vec<_>>(), [a]);
        uses.set(a, Vec::new(), &mut touched);
        assert_eq!((uses.things().count(), uses.entities().count()), (0, 0));
    }
}
