//! Three questions that people come with: what is drawn to answer each is set at once.

use super::{DebugRay, Which};
use crate::editor::command::{Command, commands};
use crate::editor::notice::Notices;
use crate::inspect::{InspectPreset, InspectSettings};
use bevy::ecs::world::World;

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "lines.why-black" "Draw why a pixel is black" [] "Draws the rays of a pixel in the light that they carry: point at it and press R"
            => |world| ask(world, InspectPreset::WhyBlack); menu("View/Rays and trees", 1),
        "lines.is-tree-good" "Is this tree good?" [] "Draws the trees' boxes by what they cost, and what a pixel's rays visit of them"
            => |world| ask(world, InspectPreset::IsTheTreeGood); menu("View/Rays and trees", 1),
        "lines.noise" "Where is my noise from?" [] "Draws what is chosen at random for a pixel: point at it and press R"
            => |world| ask(world, InspectPreset::WhereIsTheNoiseFrom); menu("View/Rays and trees", 1),
    }
}

fn ask(world: &mut World, preset: InspectPreset) {
    show_preset(world, preset);
    world.resource_mut::<Notices>().tell(preset.says());
}

/// Draws what answers a question.
pub(in crate::editor) fn show_preset(world: &mut World, preset: InspectPreset) {
    let mut inspect = world.resource_mut::<InspectSettings>();
    let settings = preset_settings(preset, &inspect);
    *inspect = settings;
    // Noise is what samples differ in.
    if preset == InspectPreset::WhereIsTheNoiseFrom {
        world.resource_mut::<DebugRay>().which = Which::All;
    }
}

/// The settings that answer a question. How many lines a machine can draw is no part of it.
pub(in crate::editor) fn preset_settings(
    preset: InspectPreset,
    before: &InspectSettings,
) -> InspectSettings {
    InspectSettings {
        max_lines: before.max_lines,
        ..preset.settings()
    }
}
