//! Entities that queries do not meet for a while.

use crate::scene::NotTraced;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::system::SystemParam;
use bevy::prelude::{Added, Entity, Query, RemovedComponents};

/// Notices who was disabled or not traced and is met again: what was edited of it, or of its assets,
/// meanwhile is not known.
#[derive(SystemParam)]
pub(super) struct Returned<'w, 's> {
    enabled: RemovedComponents<'w, 's, Disabled>,
    traced_again: RemovedComponents<'w, 's, NotTraced>,
    no_longer: Query<'w, 's, Entity, Added<NotTraced>>,
}

impl Returned<'_, '_> {
    /// Who may have returned since this was asked last.
    pub fn read(&mut self) -> impl Iterator<Item = Entity> + '_ {
        self.enabled.read().chain(self.traced_again.read())
    }

    /// Who is traced no longer since this was asked last: nothing is left out of it.
    pub fn no_longer(&self) -> impl Iterator<Item = Entity> + '_ {
        self.no_longer.iter()
    }
}
