//! Noticing that these systems rested: an app may give them a run condition.

use super::traced::Draft;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;

/// Frames, and the last of them in which the systems ran.
#[derive(Resource, Default)]
pub(super) struct Frames {
    now: u64,
    synced: u64,
}

/// Runs in every frame.
pub(super) fn count_frames(mut frames: ResMut<Frames>) {
    frames.now += 1;
}

/// What went while they rested left no word: Bevy forgets removals and events after two frames. So all is
/// looked at again.
pub(super) fn notice_rest(mut frames: ResMut<Frames>, mut draft: ResMut<Draft>) {
    draft.anew = frames.now > frames.synced + 1 && frames.synced > 0;
    frames.synced = frames.now;
}
