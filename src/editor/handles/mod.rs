//! Handles: arrows, rings and cubes on what is selected, and points on the ends of segments and the
//! corners of parallelograms.
//!
//! The arrows, rings and cubes are Bevy's own gizmo, which moves one transform: that of a
//! stand-in. What the stand-in does, the selection does.

mod aim;
mod arrange;
mod bodies;
mod drag;
mod focus;
mod gizmo;
mod grips;
mod hold;
mod keyed;
mod snap;
mod surface;
mod typed;

pub(super) use aim::aim;
pub(super) use drag::cancel;
pub(super) use focus::{focus, new_lens};
pub(super) use grips::{Grip, GripDrag, grip_at, grips_of_selection};
pub(super) use hold::take_hold;
pub(super) use keyed::{KeyedDrag, forget_keyed, note_command, type_axis_and_number};
pub use snap::SnapTo;
pub(super) use typed::{TypedDrag, type_into_drag};

use super::command::{AddCommands, Command, Over, State, commands, flip};
use super::schedule::{Dispatch, EditorUpdate};
use crate::view::HandleCameraPlugin;
use bevy::app::{App, Plugin, PostUpdate, Startup, TransformGizmoRenderStep};
use bevy::camera::CameraUpdateSystems;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::TransformGizmoSystems;
use bevy::prelude::IntoScheduleConfigs;
use bevy::transform::TransformSystems;
use bevy_egui::EguiPrimaryContextPass;
use std::f32::consts::PI;

/// What dragging the gizmo does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Arrows.
    #[default]
    Move,
    /// Rings.
    Turn,
    /// Cubes.
    Scale,
}

impl Tool {
    /// What is done with it.
    fn verb(self) -> &'static str {
        match self {
            Self::Move => "Move",
            Self::Turn => "Turn",
            Self::Scale => "Scale",
        }
    }
}

/// How handles behave.
#[derive(Resource, Clone, Debug, PartialEq)]
pub struct Tools {
    /// What dragging the gizmo does.
    pub tool: Tool,
    /// The gizmo follows the active object's axes instead of the world's.
    pub local: bool,
    /// Drags go in steps, or to other objects.
    pub snap: bool,
    /// What moves go by then; turning and scaling go in steps.
    pub snap_to: SnapTo,
    /// Metres of a step.
    pub move_step: f32,
    /// Radians of a step.
    pub turn_step: f32,
    /// A step of the factor.
    pub scale_step: f32,
    /// Scaling along one axis scales the others as much.
    pub scale_linked: bool,
    /// The selection turns and scales around the middle of its places, instead of the active one's.
    pub around_middle: bool,
}

impl Default for Tools {
    fn default() -> Self {
        Self {
            tool: Tool::Move,
            local: false,
            snap: false,
            snap_to: SnapTo::Steps,
            move_step: 0.1,
            turn_step: PI / 12.0,
            scale_step: 0.1,
            scale_linked: false,
            around_middle: true,
        }
    }
}

/// The point that the gizmo moves instead of the selected entities.
#[derive(Resource, Default)]
pub(super) struct ActiveGrip(pub Option<Grip>);

/// Draws handles and lets them be dragged.
pub(super) struct HandlesPlugin;

impl Plugin for HandlesPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(HandleCameraPlugin)
            .init_resource::<Tools>()
            .add_commands(commands())
            .add_commands(arrange::commands())
            .init_resource::<ActiveGrip>()
            .init_resource::<drag::GizmoDrag>()
            .init_resource::<TypedDrag>()
            .init_resource::<KeyedDrag>()
            .add_observer(keyed::forget_scene)
            .add_systems(Startup, gizmo::spawn_stand_in)
            .add_systems(
                EditorUpdate,
                (
                    keyed::forget_unheard,
                    grips::forget_grips,
                    drag::carry,
                    gizmo::place_stand_in,
                    gizmo::set_up,
                )
                    .chain()
                    .after(Dispatch),
            )
            .configure_sets(
                PostUpdate,
                TransformGizmoSystems.run_if(gizmo::has_the_pointer),
            )
            .add_systems(
                PostUpdate,
                (
                    gizmo::forget_hover.before(CameraUpdateSystems),
                    hold::hover
                        .run_if(gizmo::has_the_pointer)
                        .after(TransformGizmoSystems)
                        .before(TransformGizmoRenderStep),
                    drag::show_carried
                        .after(TransformSystems::Propagate)
                        .before(TransformGizmoRenderStep),
                ),
            )
            .add_systems(EguiPrimaryContextPass, grips::draw_grips);
    }
}

fn commands() -> Vec<Command> {
    commands! {
        "tool.move" "Move" ["W"] "Drag the arrows to move the selection; a number that is typed meanwhile says how far. Without the pointer: then X, Y or Z, a number, Enter"
            => |world| world.resource_mut::<Tools>().tool = Tool::Move; button("tools", "Move"); state(|world| has(world, Tool::Move)),
        "tool.turn" "Turn" ["E"] "Drag the rings to turn the selection; a number that is typed meanwhile says by how many degrees. Without the pointer: then X, Y or Z, a number, Enter"
            => |world| world.resource_mut::<Tools>().tool = Tool::Turn; button("tools", "Turn"); state(|world| has(world, Tool::Turn)),
        "tool.scale" "Scale" ["T"] "Drag the cubes to scale the selection; a number that is typed meanwhile says how many times. Without the pointer: then X, Y or Z, a number, Enter"
            => |world| world.resource_mut::<Tools>().tool = Tool::Scale; button("tools", "Scale"); state(|world| has(world, Tool::Scale)),
        "tool.local" "World or local axes" ["L"] "Whether handles follow the world's axes or the object's own"
            => |world| flip(&mut world.resource_mut::<Tools>().local); button("tools", "Local"); state(|world| State::switch(world.resource::<Tools>().local)),
        "tool.snap" "Snap" ["N"] "Handles move in steps, or onto other objects; right click on the button: how large, or onto what"
            => |world| flip(&mut world.resource_mut::<Tools>().snap); button("tools", "Snap"); state(|world| State::switch(world.resource::<Tools>().snap)),
        "tool.aim" "Aim at…" [] "The next click in the view turns the selected lights and cameras to what is there"
            => aim::arm; menu("Edit", 2); over(&[Over::Entity]); state(aim::may_aim),
        "tool.focus" "Focus on…" [] "The next click in the view is what the selected cameras see sharp"
            => focus::arm; menu("Edit", 2); over(&[Over::Entity]); state(focus::may_focus),
    }
}

fn has(world: &World, tool: Tool) -> State {
    State::switch(world.resource::<Tools>().tool == tool)
}
