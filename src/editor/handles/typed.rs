//! Numbers that are typed while a handle is dragged: how far it goes, to the digit.

use super::Tool;
use super::drag::GizmoDrag;
use super::keyed;
use crate::scene::schema::{FARTHEST, Unit, typed_number};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::{TransformGizmoAxis as Axis, TransformGizmoState};
use bevy::input::keyboard::{Key, KeyCode, KeyboardInput};
use bevy::math::{Quat, Vec3};
use bevy::transform::components::Transform;

/// Said of a number that is typed where there is no one way to go.
const NO_WAY: &str = "Only an arrow's drag takes a number";
/// Letters of a number at most: nobody types more.
const MOST: usize = 24;

/// What was typed since a drag began. Where it is a number, the drag goes so far; else the pointer says it.
#[derive(Resource, Default)]
pub(in super::super) struct TypedDrag {
    text: String,
    /// What is dragged, along which axis.
    label: String,
}

impl TypedDrag {
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Waits for a number, and says for which.
    pub fn ask(&mut self, label: String) {
        *self = Self {
            text: String::new(),
            label,
        };
    }

    pub fn push(&mut self, letters: &str) {
        if self.text.len() + letters.len() <= MOST {
            self.text.push_str(letters);
        }
    }

    /// The same in a drag of a handle.
    fn push_along(&mut self, letters: &str, tool: Tool, axis: Option<Axis>) {
        self.push(letters);
        self.label = match has_one_way(tool, axis) {
            true => label(tool, axis),
            false => NO_WAY.into(),
        };
    }

    pub fn pop(&mut self) {
        self.text.pop();
    }

    /// Whether no letter of a number is there.
    pub fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    /// What to show of it; nothing where nothing was typed nor asked for.
    pub fn shown(&self) -> Option<String> {
        (!self.label.is_empty()).then(|| format!("{}: {}", self.label, self.text))
    }

    /// Why a tool does nothing with it.
    pub fn not_read(&self, tool: Tool) -> String {
        let wanted = match tool {
            Tool::Move => "a length",
            Tool::Turn => "an angle",
            Tool::Scale => "a factor",
        };
        match &*self.text {
            "" => format!("Type {wanted} first; Esc puts all back"),
            text => format!("“{text}” is not {wanted}"),
        }
    }
}

/// What is done along or about which axis.
pub(super) fn label(tool: Tool, axis: Option<Axis>) -> String {
    let verb = tool.verb();
    let along = match tool {
        Tool::Move | Tool::Scale => "along",
        Tool::Turn => "about",
    };
    match axis {
        Some(Axis::X) => format!("{verb} {along} x"),
        Some(Axis::Y) => format!("{verb} {along} y"),
        Some(Axis::Z) => format!("{verb} {along} z"),
        Some(Axis::View) | None => verb.into(),
    }
}

/// Moved in the plane of the view there is no one way that a number could be the length of.
fn has_one_way(tool: Tool, axis: Option<Axis>) -> bool {
    tool != Tool::Move || axis.is_some_and(|axis| axis != Axis::View)
}

/// What a number means to a tool: its unit, and how many of the kept unit a plain one is.
fn unit_of(tool: Tool) -> Unit {
    match tool {
        Tool::Move => Unit::METRE,
        Tool::Turn => Unit::ANGLE,
        Tool::Scale => Unit::TIMES,
    }
}

/// Takes a key that is pressed in the middle of a drag of the gizmo; `false` where there is none, or the key is not for it.
pub(in super::super) fn type_into_drag(world: &mut World, input: &KeyboardInput) -> bool {
    let Some(tool) = world.resource::<GizmoDrag>().tool() else {
        return false;
    };
    if keyed::holds(world) {
        return false;
    }
    let axis = world.resource::<TransformGizmoState>().axis;
    let mut typed = world.resource_mut::<TypedDrag>();
    match (&input.logical_key, input.key_code) {
        (_, KeyCode::Enter | KeyCode::NumpadEnter) if !typed.text.is_empty() => {
            world.resource_mut::<TransformGizmoState>().active = false;
        }
        (_, KeyCode::Backspace) => {
            typed.pop();
            if typed.text.is_empty() {
                typed.clear();
            }
        }
        (Key::Character(letters), _) => {
            typed.push_along(letters, tool, axis);
        }
        _ => return false,
    }
    true
}

/// Where the stand-in is, as typed: from `start`, the handle's direction in the world being `direction`. `None` where nothing
/// that can be read was typed.
pub(super) fn typed_place(
    typed: &TypedDrag,
    tool: Tool,
    axis: Axis,
    start: &Transform,
    direction: Vec3,
) -> Option<Transform> {
    if typed.text.is_empty() || !has_one_way(tool, Some(axis)) {
        return None;
    }
    let unit = unit_of(tool);
    let number = typed_number(&typed.text, unit, unit.kept_per_shown(), 0.0).ok()? as f32;
    if number.abs() > FARTHEST {
        return None;
    }
    let mut place = *start;
    match tool {
        Tool::Move => place.translation += number * direction,
        Tool::Turn => place.rotation = Quat::from_axis_angle(direction, number) * start.rotation,
        Tool::Scale => {
            // Nothing comes back from no size at all.
            let number = if number == 0.0 { return None } else { number };
            place.scale *= match axis {
                Axis::X => Vec3::new(number, 1.0, 1.0),
                Axis::Y => Vec3::new(1.0, number, 1.0),
                Axis::Z => Vec3::new(1.0, 1.0, number),
                Axis::View => Vec3::splat(number),
            };
        }
    }
    place.is_finite().then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(tool: Tool, axis: Axis, text: &str) -> Option<Transform> {
        let typed = TypedDrag {
            text: text.into(),
            label: String::new(),
        };
        typed_place(
            &typed,
            tool,
            axis,
            &Transform::from_xyz(1.0, 2.0, 3.0),
            Vec3::Y,
        )
    }

    #[test]
    fn what_is_typed_is_a_length_an_angle_or_a_factor() {
        let moved = place(Tool::Move, Axis::Y, "-25cm").unwrap();
        assert_eq!(moved.translation, Vec3::new(1.0, 1.75, 3.0));
        let turned = place(Tool::Turn, Axis::Y, "90").unwrap();
        let angle = turned.rotation.angle_between(Quat::IDENTITY).to_degrees();
        assert!((angle - 90.0).abs() < 1e-3, "{angle}°");
        let scaled = place(Tool::Scale, Axis::Y, "1/2").unwrap();
        assert_eq!(scaled.scale, Vec3::new(1.0, 0.5, 1.0));
    }

    #[test]
    fn where_a_number_has_no_way_to_go_it_says_so() {
        for (tool, axis, shown) in [
            (Tool::Move, Axis::X, "Move along x: 2"),
            (
                Tool::Move,
                Axis::View,
                "Only an arrow's drag takes a number: 2",
            ),
            (Tool::Scale, Axis::View, "Scale: 2"),
        ] {
            let mut typed = TypedDrag::default();
            typed.push_along("2", tool, Some(axis));
            assert_eq!(typed.shown().as_deref(), Some(shown));
        }
    }

    #[test]
    fn what_cannot_be_read_leaves_the_drag_to_the_pointer() {
        for (tool, axis, text) in [
            (Tool::Move, Axis::Y, ""),
            (Tool::Move, Axis::Y, "-"),
            (Tool::Move, Axis::Y, "1e99"),
            (Tool::Move, Axis::Y, "two"),
            (Tool::Move, Axis::View, "2"),
            (Tool::Scale, Axis::X, "0"),
        ] {
            assert_eq!(place(tool, axis, text), None, "{text:?}");
        }
    }
}
