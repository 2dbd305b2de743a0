//! What a script is made of.

use super::super::action::Action;
use serde::Deserialize;

/// One thing that a script does. Names of entities are those of the hierarchy.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) enum Step {
    // The pointer
    /// Moves it.
    Move(Spot),
    /// Presses and releases the left button there.
    Click(Spot),
    /// Twice, quickly.
    DoubleClick(Spot),
    /// Presses a button where the pointer is.
    Press(Button),
    /// Moves it and presses within one frame, as a person does where frames are slow.
    PressAt(Button, Spot),
    Release(Button),
    /// Presses at the first, moves to the second, releases.
    Drag(Spot, Spot),
    /// The same with another button.
    DragWith(Button, Spot, Spot),
    /// Turns the wheel; up is positive.
    Wheel(f32),
    // The keyboard
    /// Presses and releases, for example `"Ctrl+Shift+Z"`.
    Key(String),
    /// Presses, and keeps pressed until `LetGo`.
    Hold(String),
    LetGo(String),
    /// Types a text.
    Type(String),
    // Without pointer and keyboard
    /// Runs a command by its id.
    Run(String),
    /// What needs a further word: `Open("teapot")`.
    Action(Action),
    /// Selects entities by their names.
    Select(Vec<String>),
    /// Writes a component's field, as a panel does.
    Set {
        /// The entity; without one it is a resource's field.
        #[serde(default)]
        of: Option<String>,
        /// Component or resource and field: `PointLamp.intensity`.
        path: String,
        to: Value,
    },
    /// The window's size in logical pixels.
    Size(u32, u32),
    Wait(Until),
    /// Writes what the window shows to a picture file.
    Screenshot(String),
    Quit,
    // Claims: one that is wrong ends the script and the program with exit code 1
    /// A component's field has this value.
    Assert {
        #[serde(default)]
        of: Option<String>,
        path: String,
        is: Value,
        /// How far numbers may be from it.
        #[serde(default)]
        within: f64,
    },
    /// It does not have it.
    AssertNot {
        #[serde(default)]
        of: Option<String>,
        path: String,
        is: Value,
        #[serde(default)]
        within: f64,
    },
    /// These and no others are selected.
    Selected(Vec<String>),
    /// There is an entity of this name.
    Exists(String),
    /// There is none.
    Gone(String),
    /// What undo would take back.
    Undoes(String),
    /// The text is to be seen in a panel.
    Shows(String),
}

/// A place in the window.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(super) enum Spot {
    /// Logical pixels from the top left.
    Window(f32, f32),
    /// Parts of the scene's view, from (0, 0) at its top left to (1, 1).
    View(f32, f32),
    /// Where this entity's middle is seen.
    On(String),
    /// Where an end of a segment light or a corner of a parallelogram light is seen.
    Grip(String, usize),
    /// The tip of one of the gizmo's handles.
    Handle(Along),
    /// On a text in a panel.
    Text(String),
    /// On the n-th such text, from the top, the first being 0.
    TextAt(String, usize),
    /// Logical pixels to the right of and below another place.
    By(Box<Spot>, f32, f32),
}

/// Which of the gizmo's handles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(super) enum Along {
    X,
    Y,
    Z,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(super) enum Button {
    Left,
    Middle,
    Right,
}

/// What is waited for.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub(super) enum Until {
    Frames(u32),
    Seconds(f32),
    /// So many samples of each pixel of the traced view.
    Samples(f64),
}

/// What a field holds.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub(super) enum Value {
    Switch(bool),
    Number(f64),
    /// A text, or the name of a choice.
    Text(String),
    /// The numbers of a vector or a list.
    Numbers(Vec<f64>),
}
