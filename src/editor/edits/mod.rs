//! What can be done to the scene: plain functions on the world. Each leaves it complete, so that
//! the history can make a step of the difference.

mod add;
mod copy;
mod free_place;
mod group;
mod hiding;
mod import;
mod index;
mod material;
mod names;
mod parents;
mod plugin;
mod remove;
mod selecting;

pub use add::{AddAt, add, add_model};
pub use copy::{Clipboard, copy, duplicate, paste};
pub(in crate::editor) use group::is_group;
pub use group::{Ungrouped, group, ungroup};
pub use hiding::set_visible;
pub(in crate::editor) use import::{ModelAdded, import};
pub use index::{SceneIndex, scene_entity};
pub use material::assign_material;
pub(in crate::editor) use material::{is_object, share_material};
pub use names::{name_of, rename, unique_name};
use parents::with_descendants;
pub(in crate::editor) use parents::{all_below, ancestors};
pub use parents::{reparent, roots_of};
pub use plugin::EditsPlugin;
pub(in crate::editor) use plugin::{step, step_add, step_assign, step_rename, step_reparent};
pub use remove::delete;
pub(in crate::editor) use selecting::select;
