//! The editor: a window in which the scene is edited and re-rendered at once. The only room that
//! knows egui.
//!
//! Whatever a person does ends in one of two things: an [`Action`], which menus, keys, buttons and
//! scripts send alike and which mostly names a [`command`], or a change of a component, which panels and handles make directly.
//! [`History`](history::History) watches the components, so every change can be undone however it was made.
//!
//! | module | does |
//! |---|---|
//! | [`command`] | the table of commands: a row says what one is called, its keys, its places and what it does |
//! | [`action`], `dispatch` | what is asked for in messages, and where it is done |
//! | [`document`] | the open scene as a file: open, save, recover |
//! | [`edits`] | what can be done to the scene |
//! | [`history`] | undo and redo |
//! | [`render_job`] | pictures to files while the editing goes on |
//! | [`selection`] | which entities are meant |
//! | [`viewport`] | the part of the window that shows the scene, and how |
//! | `plugins` | what it consists of; [`EditorPlugins`] for an app with a scene of its own |
//! | `embed` | what is different there |
//! | `foreign` | components that the app brings along |
//! | `schedule`, `cameras` | when it works, and what draws it |
//! | `window` | the program: its window and first scene |
//! | `panels` | everything that egui draws |
//! | `inspection` | what the tracer did, drawn over the scene and in numbers; the debug ray, step by step |
//! | `trees` | the builders compared and timed, two trees side by side |
//! | [`navigation`] | moving the view |
//! | [`handles`] | arrows, rings and points that are dragged |
//! | `pointer`, [`keys`], `pick` | what a press means, what a key means, what is under the pointer |
//! | `background` | work on a thread of its own, with progress and an end |
//! | `pace` | how often the window is drawn |
//! | `script` | clicks and keys from a file |
//! | `startup`, `signals` | whether there can be a window at all; being asked to end from outside |

pub mod action;
mod background;
mod cameras;
pub mod command;
mod dispatch;
pub mod document;
pub mod edits;
mod embed;
mod extent;
mod foreign;
pub mod handles;
mod headless;
pub mod history;
mod inspection;
pub mod keys;
pub mod navigation;
pub mod notice;
mod pace;
mod panels;
mod pick;
mod plugins;
mod pointer;
pub mod preferences;
pub mod render_job;
mod schedule;
mod script;
pub mod selection;
#[cfg(unix)]
mod signals;
mod startup;
mod texts;
mod trees;
pub mod viewport;
mod window;

pub use action::Action;
pub use embed::{Editing, in_editor};
pub use headless::{headless_editor, headless_editor_with_recovery};
pub use plugins::EditorPlugins;
pub use schedule::EditorUpdate;
pub use script::{Script, ScriptError};
pub use selection::Selection;
pub use startup::{NoWindow, check};
pub use viewport::Viewport;
pub use window::run;
