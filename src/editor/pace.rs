//! How often the window is drawn: as often as it can while a hand moves something, and seldom while
//! there is nothing to see. On a machine without a graphics card each frame takes its time from the
//! tracer.

use super::history::Gesture;
use super::inspection::Inspected;
use super::pointer::PointerUse;
use super::script::is_playing;
use super::viewport::traced_render;
use crate::film::State;
use crate::sync::Traced;
use crate::view::TracedRender;
use bevy::app::{App, Last, Plugin};
use bevy::ecs::world::World;
use bevy::winit::{UpdateMode, WinitSettings};
use std::time::{Duration, Instant};

/// While the tracer has something new to show several times a second.
const RENDERING: Duration = Duration::from_millis(50);
/// While a tree is built: what was edited shows as soon as it is there.
const BUILDING: Duration = Duration::from_millis(15);
/// While nothing changes: what works in the background is looked at this often.
const RESTING: Duration = Duration::from_millis(250);
/// How long a render counts as a new one: its first pictures come quickly.
const FRESH: f64 = 0.5;
/// How long after the start everything is drawn as often as it can be: shaders are compiled, sizes
/// settle.
const START: Duration = Duration::from_secs(2);

/// Sets how often frames are drawn.
pub(super) struct PacePlugin;

impl Plugin for PacePlugin {
    fn build(&self, app: &mut App) {
        let started = Instant::now();
        app.add_systems(Last, move |world: &mut World| set_pace(world, started));
    }
}

fn set_pace(world: &mut World, started: Instant) {
    let busy = world.resource::<Gesture>().active()
        || !matches!(world.resource::<PointerUse>(), PointerUse::Free)
        || is_playing(world)
        || world.resource::<Inspected>().stepper.playing
        || started.elapsed() < START;
    let render = traced_render(world).and_then(TracedRender::status);
    let state = render.map(|status| (status.state, status.seconds));
    let building = world.resource::<Traced>().pending > 0;
    let mode = mode(busy, building, state);
    let mut settings = world.resource_mut::<WinitSettings>();
    if settings.focused_mode != mode {
        settings.focused_mode = mode;
        // A window that is watched but not typed into is drawn alike.
        settings.unfocused_mode = mode;
    }
}

fn mode(busy: bool, building: bool, render: Option<(State, f64)>) -> UpdateMode {
    match render {
        _ if busy => UpdateMode::Continuous,
        Some((State::Running, seconds)) if seconds < FRESH => UpdateMode::Continuous,
        _ if building => UpdateMode::reactive_low_power(BUILDING),
        Some((State::Running, _)) => UpdateMode::reactive_low_power(RENDERING),
        _ => UpdateMode::reactive_low_power(RESTING),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Ending;

    #[test]
    fn a_hand_or_a_new_render_is_shown_at_once_and_rest_costs_little() {
        assert_eq!(mode(true, false, None), UpdateMode::Continuous);
        assert_eq!(
            mode(false, false, Some((State::Running, 0.1))),
            UpdateMode::Continuous
        );
        let calm = mode(false, false, Some((State::Running, 3.0)));
        assert_eq!(calm, UpdateMode::reactive_low_power(RENDERING));
        let ended = mode(false, false, Some((State::Ended(Ending::Samples), 3.0)));
        assert_eq!(ended, UpdateMode::reactive_low_power(RESTING));
        let building = mode(false, true, Some((State::Ended(Ending::Samples), 3.0)));
        assert_eq!(building, UpdateMode::reactive_low_power(BUILDING));
    }
}
