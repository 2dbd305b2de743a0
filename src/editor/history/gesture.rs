//! What a person is in the middle of: a drag, or typing into a field.

use bevy::ecs::resource::Resource;

/// While one is under way nothing becomes a step; all that it changed becomes one when it ends.
#[derive(Resource, Default)]
pub struct Gesture {
    name: Option<String>,
    active: bool,
}

impl Gesture {
    /// From now on until [`Self::end`]. An empty name leaves it to the change to name the step.
    pub fn begin(&mut self, name: impl Into<String>) {
        let name = name.into();
        if !self.active {
            self.active = true;
            self.name = (!name.is_empty()).then_some(name);
        }
    }

    /// What changed since [`Self::begin`] becomes one step at the end of the frame.
    pub fn end(&mut self) {
        self.active = false;
    }

    /// Whether one is under way.
    pub fn active(&self) -> bool {
        self.active
    }

    /// Of a gesture that has ended.
    pub(super) fn take_name(&mut self) -> Option<String> {
        self.name.take()
    }
}
