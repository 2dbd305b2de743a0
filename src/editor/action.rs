//! What can be asked of the editor. Menus, keys, buttons and scripts send the same messages, and
//! one table says what each is called, which keys send it, and what it does.

use crate::inspect::InspectPreset;
use crate::scene::{SceneId, Shape};
use bevy::ecs::message::Message;
use bevy::input::keyboard::KeyCode;
use bevy::math::{Vec2, Vec3};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Something that the user asks for.
#[derive(Message, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the table ACTIONS says what each does")]
pub enum Action {
    // Files
    New,
    /// Asks which file.
    OpenDialog,
    /// A file, or a built-in scene's name.
    Open(PathBuf),
    Save,
    SaveAsDialog,
    SaveAs(PathBuf),
    ImportDialog,
    /// Adds a model file's content to the open scene.
    Import(PathBuf),
    RenderDialog,
    Quit,
    // Edits
    Undo,
    Redo,
    Copy,
    Paste,
    Duplicate,
    Delete,
    Rename(SceneId, String),
    /// Makes the second the parent of the first ones; `None`: they get no parent. Places in the world stay.
    Reparent(Vec<SceneId>, Option<SceneId>),
    ToggleVisible,
    Add(Addition),
    // Selection
    SelectAll,
    SelectNone,
    Select(Vec<SceneId>),
    // The view
    FrameSelected,
    FrameAll,
    LookAlong(Axis),
    ToggleProjection,
    /// Looks through this camera; `None`: freely again.
    LookThrough(Option<SceneId>),
    /// Through the selected camera, or the first one; freely where it is looked through already.
    ToggleCamera,
    /// Whether moving the view moves the camera that it looks through.
    ToggleLock,
    /// A camera entity where the view stands.
    AddBookmark,
    ShowRaster,
    ShowTraced,
    ShowSplit,
    TogglePause,
    Restart,
    ShootRay,
    /// Between the rays of the picked pixel's first sample and those of all.
    ToggleAllSamples,
    /// The panels go and come back.
    TogglePanels,
    // Tools
    Move,
    Turn,
    Scale,
    ToggleLocal,
    ToggleSnap,
    // Help
    ToggleHelp,
    // What is drawn over the picture
    ToggleGizmos,
    /// Draws what answers a question.
    Inspect(InspectPreset),
    PreviousLeaf,
    NextLeaf,
    // Rays
    /// Shows or hides the ray inspector.
    ToggleRays,
    /// A pixel of the traced view, column and row from its top left.
    ShootPixel(u32, u32),
    StepForward,
    StepBack,
    PlaySteps,
}

/// What can be added.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "their names are those of the components")]
pub enum Addition {
    /// By the name of the shape, as in [`shapes`].
    Shape(String),
    /// An empty place that others can be children of.
    Group,
    PointLamp,
    DirectionalLamp,
    SegmentLamp,
    ParallelogramLamp,
    Camera,
    /// A material that objects can share.
    Material,
}

/// Along which axis the view looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "named as in every modeller")]
pub enum Axis {
    Front,
    Back,
    Left,
    Right,
    Top,
    Bottom,
}

/// A key with modifiers. `Ctrl` is the command key on a Mac.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "plain")]
pub struct Keys {
    pub ctrl: bool,
    pub shift: bool,
    pub key: KeyCode,
}

/// What is said about an action without parameters.
#[derive(Clone, Debug)]
pub struct Entry {
    /// What is sent.
    pub action: Action,
    /// As menus call it.
    pub name: &'static str,
    /// What sends it; the first is shown in menus.
    pub keys: &'static [Keys],
    /// What it does, for the tooltip and the page of keys.
    pub says: &'static str,
}

const fn key(key: KeyCode) -> Keys {
    Keys {
        ctrl: false,
        shift: false,
        key,
    }
}

const fn ctrl(key: KeyCode) -> Keys {
    Keys {
        ctrl: true,
        shift: false,
        key,
    }
}

const fn ctrl_shift(key: KeyCode) -> Keys {
    Keys {
        ctrl: true,
        shift: true,
        key,
    }
}

const fn shift(key: KeyCode) -> Keys {
    Keys {
        ctrl: false,
        shift: true,
        key,
    }
}

macro_rules! actions {
    ($($action:ident $(($with:expr))? $name:literal [$($keys:expr),*] $says:literal)*) => {
        /// Every action that needs no further word.
        pub const ACTIONS: &[Entry] = &[$(Entry {
            action: Action::$action $(($with))?,
            name: $name,
            keys: &[$($keys),*],
            says: $says,
        }),*];
    };
}

actions! {
    New "New" [ctrl(KeyCode::KeyN)] "Starts an empty scene with a camera and a light"
    OpenDialog "Open…" [ctrl(KeyCode::KeyO)] "Opens a scene or a model: .scn.ron, .obj, .gltf, .glb, .stl, .ply"
    Save "Save" [ctrl(KeyCode::KeyS)] "Writes the scene to its file"
    SaveAsDialog "Save as…" [ctrl_shift(KeyCode::KeyS)] "Writes the scene to another file: .scn.ron, .obj or .glb"
    ImportDialog "Import…" [ctrl(KeyCode::KeyI)] "Adds a model's meshes, materials, lights and cameras to this scene"
    RenderDialog "Render to file…" [key(KeyCode::F12)] "Renders a picture to a file while you go on editing"
    Quit "Quit" [ctrl(KeyCode::KeyQ)] "Closes the editor; asks where changes would be lost"
    Undo "Undo" [ctrl(KeyCode::KeyZ)] "Takes the last step back"
    Redo "Redo" [ctrl_shift(KeyCode::KeyZ), ctrl(KeyCode::KeyY)] "Does the step again that was taken back"
    Copy "Copy" [ctrl(KeyCode::KeyC)] "Keeps the selected entities for pasting"
    Paste "Paste" [ctrl(KeyCode::KeyV)] "Adds what was copied"
    Duplicate "Duplicate" [ctrl(KeyCode::KeyD)] "Adds a copy of the selected entities where they are"
    Delete "Delete" [key(KeyCode::Delete), key(KeyCode::KeyX)] "Removes the selected entities and their children"
    ToggleVisible "Hide or show" [key(KeyCode::KeyH)] "A hidden entity is not traced"
    SelectAll "Select all" [ctrl(KeyCode::KeyA)] "Selects every entity"
    SelectNone "Select nothing" [key(KeyCode::Escape)] "Selects no entity"
    FrameSelected "Frame selected" [key(KeyCode::KeyF)] "Moves the view so that the selection fills it"
    FrameAll "Frame all" [key(KeyCode::Home)] "Moves the view so that the whole scene fills it"
    ToggleProjection "Perspective or orthographic" [key(KeyCode::Digit5), key(KeyCode::Numpad5)] "Orthographic: far things keep their size"
    LookAlong(Axis::Front) "Front view" [key(KeyCode::Numpad1)] "Looks along -Z, without perspective"
    LookAlong(Axis::Back) "Back view" [ctrl(KeyCode::Numpad1)] "Looks along +Z, without perspective"
    LookAlong(Axis::Right) "Right view" [key(KeyCode::Numpad3)] "Looks along -X, without perspective"
    LookAlong(Axis::Left) "Left view" [ctrl(KeyCode::Numpad3)] "Looks along +X, without perspective"
    LookAlong(Axis::Top) "Top view" [key(KeyCode::Numpad7)] "Looks down, without perspective"
    LookAlong(Axis::Bottom) "Bottom view" [ctrl(KeyCode::Numpad7)] "Looks up, without perspective"
    ToggleCamera "Look through the camera" [key(KeyCode::Digit0), key(KeyCode::Numpad0)] "Through the selected camera, or the first one; again: freely. Moving the view leaves the camera"
    ToggleLock "Lock the camera to the view" [ctrl_shift(KeyCode::KeyL)] "Moving the view moves the camera that it looks through"
    AddBookmark "Keep this view as a camera" [ctrl(KeyCode::KeyB)] "Adds a camera entity where the view stands"
    ShowRaster "Raster view" [key(KeyCode::Digit1)] "Bevy's renderer: quick, and an approximation"
    ShowTraced "Traced view" [key(KeyCode::Digit2)] "The ray tracer's picture"
    ShowSplit "Split view" [key(KeyCode::Digit3)] "Raster on the left, traced on the right; drag the line between"
    TogglePause "Pause or go on" [key(KeyCode::KeyP)] "The traced view stands still, and keeps what it has"
    Restart "Restart" [ctrl(KeyCode::KeyR)] "Renders the traced view from its first sample again"
    ShootRay "Debug ray" [key(KeyCode::KeyR)] "Traces the pixel under the pointer again and draws its rays, as a click with Alt does; beside the picture it takes them away"
    ToggleAllSamples "Rays of all samples" [ctrl_shift(KeyCode::KeyR)] "Draws the debug rays of all samples of the picked pixel, or again those of its first one"
    TogglePanels "Only the picture" [ctrl(KeyCode::Space)] "Takes the panels away, so that the picture fills the window; again, or Escape, brings them back"
    Move "Move" [key(KeyCode::KeyW)] "Drag the arrows to move the selection"
    Turn "Turn" [key(KeyCode::KeyE)] "Drag the rings to turn the selection"
    Scale "Scale" [key(KeyCode::KeyT)] "Drag the cubes to scale the selection"
    ToggleLocal "World or local axes" [key(KeyCode::KeyL)] "Whether handles follow the world's axes or the object's own"
    ToggleSnap "Snap" [key(KeyCode::KeyN)] "Handles move in steps; right click on the button: how large"
    ToggleHelp "Keys and mouse" [key(KeyCode::F1), shift(KeyCode::Slash)] "Shows every key"
    ToggleGizmos "Show the tracer's lines" [key(KeyCode::KeyG)] "All that is drawn of rays and trees, off and on again as it was"
    Inspect(InspectPreset::WhyBlack) "Why is this pixel black?" [] "Draws the rays of a pixel in the light that they carry: point at it and press R"
    Inspect(InspectPreset::IsTheTreeGood) "Is this tree good?" [] "Draws the trees' boxes by what they cost, and what a pixel's rays visit of them"
    Inspect(InspectPreset::WhereIsTheNoiseFrom) "Where is my noise from?" [] "Draws what is chosen at random for a pixel: point at it and press R"
    PreviousLeaf "Previous leaf" [key(KeyCode::KeyA)] "One leaf back, while one leaf of the trees is drawn"
    NextLeaf "Next leaf" [key(KeyCode::KeyS)] "One leaf on, while one leaf of the trees is drawn"
    ToggleRays "Ray inspector" [shift(KeyCode::KeyR)] "The debug ray's rays as a tree with all their numbers, below the picture"
    StepForward "Next step" [key(KeyCode::Period)] "One step of the chosen ray's way through the trees on"
    StepBack "Step before" [key(KeyCode::Comma)] "One step of the chosen ray's way through the trees back"
    PlaySteps "Play steps" [key(KeyCode::Space)] "Plays the chosen ray's way through the trees, or stops"
}

impl Action {
    /// What the table says about it; `None` where it has parameters.
    pub fn entry(&self) -> Option<&'static Entry> {
        ACTIONS.iter().find(|entry| entry.action == *self)
    }
}

impl Keys {
    /// As menus show it: `Ctrl+Shift+S`.
    pub fn text(&self) -> String {
        let ctrl = if self.ctrl { "Ctrl+" } else { "" };
        let shift = if self.shift { "Shift+" } else { "" };
        let name = format!("{:?}", self.key);
        let name = match self.key {
            // Shift is in the character.
            KeyCode::Slash if self.shift => return format!("{ctrl}?"),
            KeyCode::Slash => "/",
            KeyCode::Period => ".",
            KeyCode::Comma => ",",
            _ => ["Key", "Digit"]
                .iter()
                .find_map(|prefix| name.strip_prefix(prefix))
                .unwrap_or(&name),
        };
        match name.strip_prefix("Numpad") {
            Some(number) => format!("{ctrl}{shift}Num {number}"),
            None => format!("{ctrl}{shift}{name}"),
        }
    }
}

/// The shapes that can be added, by name; about a metre in size, but for the ground, the teapot, the head
/// and the knot.
pub fn shapes() -> Vec<(&'static str, Shape)> {
    vec![
        ("Cuboid", Shape::Cuboid { size: Vec3::ONE }),
        (
            "Sphere",
            Shape::Sphere {
                radius: 0.5,
                segments: 64,
                rings: 32,
            },
        ),
        (
            "Cylinder",
            Shape::Cylinder {
                radius: 0.5,
                height: 1.0,
                segments: 64,
            },
        ),
        (
            "Torus",
            Shape::Torus {
                major_radius: 0.4,
                minor_radius: 0.15,
                segments: 64,
                sides: 32,
            },
        ),
        (
            "Ground",
            Shape::Ground {
                size: Vec2::splat(4.0),
                tile: Vec2::ONE,
            },
        ),
        (
            "Quad",
            Shape::Quad {
                corner: Vec3::new(-0.5, -0.5, 0.0),
                edges: [Vec3::X, Vec3::Y],
            },
        ),
        (
            "Quadrilateral",
            Shape::Quadrilateral {
                corners: [
                    Vec3::new(-0.5, -0.5, 0.0),
                    Vec3::new(0.5, -0.5, 0.0),
                    Vec3::new(0.3, 0.5, 0.0),
                    Vec3::new(-0.3, 0.5, 0.0),
                ],
            },
        ),
        (
            "Triangle",
            Shape::Triangle {
                corners: [
                    Vec3::new(-0.5, -0.5, 0.0),
                    Vec3::new(0.5, -0.5, 0.0),
                    Vec3::new(0.0, 0.5, 0.0),
                ],
            },
        ),
        (
            "Prism",
            Shape::Prism {
                base: vec![
                    Vec2::new(-0.5, -0.3),
                    Vec2::new(0.5, -0.3),
                    Vec2::new(0.0, 0.6),
                ],
                height: 1.0,
            },
        ),
        ("Teapot", Shape::Teapot { divisions: 8 }),
        (
            "Head",
            Shape::Head {
                segments: 32,
                rings: 16,
            },
        ),
        (
            "Knot",
            Shape::Knot {
                p: 2,
                q: 3,
                tube_radius: 0.15,
                displacement: 0.2,
                segments: 256,
                sides: 32,
            },
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_actions_have_the_same_key() {
        let keys: Vec<_> = ACTIONS.iter().flat_map(|entry| entry.keys).collect();
        for (i, a) in keys.iter().enumerate() {
            for b in &keys[..i] {
                assert_ne!(a, b, "{}", a.text());
            }
        }
    }

    #[test]
    fn keys_are_written_as_in_menus() {
        assert_eq!(ctrl_shift(KeyCode::KeyS).text(), "Ctrl+Shift+S");
        assert_eq!(key(KeyCode::F12).text(), "F12");
        assert_eq!(key(KeyCode::Digit1).text(), "1");
        assert_eq!(shift(KeyCode::Slash).text(), "?");
        assert_eq!(key(KeyCode::Period).text(), ".");
        assert_eq!(ctrl(KeyCode::Numpad1).text(), "Ctrl+Num 1");
    }
}
