//! What the panels remember between two frames, and forget when the editor is closed.

use super::answer::Asked;
use super::compare::Kept;
use super::dialogs::{Gallery, PathForm, RenderForm};
use super::hierarchy::ListKeys;
use super::inspector::{Builders, ErrorCurve, PerformanceForm, Thumbnails, Trees};
use super::line_legend::LineTexts;
use super::outline_rows::{Filter, Folded, Rows};
use super::palette::Palette;
use super::pattern::PatternOf;
use super::rays::RaysPanel;
use super::status::{Memory, Numbers};
use super::told::Tales;
use crate::editor::command::Over;
use crate::editor::pointer::RightClicked;
use crate::scene::SceneId;
use crate::trace::{Camera, FirstHit};
use bevy::ecs::resource::Resource;
use bevy::math::UVec2;
use bevy_egui::egui::Pos2;

/// The inspector's tabs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Tab {
    #[default]
    Object,
    Render,
    Debug,
    Bvh,
}

/// A pixel of a world's picture; the world by its address.
pub(super) type PixelOf = (usize, UVec2, Camera);

/// What is in front of everything else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialog {
    Keys,
    About,
    Preferences,
    Scenes,
    History,
    Render,
}

/// A name that is being typed.
#[derive(Clone, Debug)]
pub(super) struct Renaming {
    pub id: SceneId,
    pub text: String,
    /// The field has the keys; until then it asks for them.
    pub focused: bool,
}

/// What the panels remember between two frames.
#[derive(Resource, Default)]
pub(super) struct Panels {
    /// Which of the scenes that were opened the rest belongs to.
    pub scene: u64,
    pub tab: Tab,
    /// The picture fills the window, and the panels are not drawn.
    pub only_picture: bool,
    pub dialog: Option<Dialog>,
    /// The one that was open in the frame before.
    pub dialog_before: Option<Dialog>,
    /// A path that is being typed for the document.
    pub typed_path: Option<PathForm>,
    pub render_form: RenderForm,
    pub palette: Option<Palette>,
    /// A pixel that was asked about.
    pub asked: Option<Asked>,
    /// Which of the first steps were tried.
    pub first_steps: [bool; 3],
    /// What is searched for among the keys.
    pub bindings_search: String,
    /// A right click that was not answered yet.
    pub right_click: Option<RightClicked>,
    /// Where the menu of a right click stands, and what was clicked.
    pub menu_over: Option<(Pos2, Over)>,
    pub gallery: Gallery,
    /// What is searched for in the hierarchy.
    pub filter: Filter,
    pub list_keys: ListKeys,
    /// Entities whose descendants the hierarchy does not show.
    pub folded: Folded,
    /// What the hierarchy shows.
    pub rows: Rows,
    /// Where a range of rows begins.
    pub anchor: Option<SceneId>,
    pub renaming: Option<Renaming>,
    /// How many rows the hierarchy laid out in this frame.
    pub rows_drawn: usize,
    /// The next drag over the picture limits the traced view to a region.
    pub drags_region: bool,
    /// Where such a drag began.
    pub region_start: Option<Pos2>,
    /// Only the heading of the lines' legend is shown.
    pub legend_folded: bool,
    /// What there is to say of the lines that are drawn.
    pub line_texts: Option<LineTexts>,
    /// Where the picked pixel's samples lie.
    pub pattern: Option<PatternOf>,
    /// A field is being dragged or typed into, and the gesture that this makes is the panels' own.
    pub in_gesture: bool,
    /// A picture that was kept to compare with.
    pub kept: Option<Kept>,
    /// A name that is being typed in the inspector.
    pub naming: Option<Renaming>,
    pub thumbnails: Thumbnails,
    pub error_curve: ErrorCurve,
    pub trees: Trees,
    pub builders: Builders,
    pub performance: PerformanceForm,
    pub numbers: Numbers,
    pub memory: Memory,
    pub rays: RaysPanel,
    pub tales: Tales,
    /// What the pixel under the pointer shows, and of which world, pixel and camera that is.
    pub under_pointer: Option<(PixelOf, FirstHit)>,
}

impl Panels {
    /// Another scene was opened: the numbers of its entities are those of others.
    pub fn forget_scene(&mut self) {
        self.folded.clear();
        self.anchor = None;
        self.renaming = None;
        self.naming = None;
        self.under_pointer = None;
        self.asked = None;
        self.thumbnails.forget_fields();
    }
}
