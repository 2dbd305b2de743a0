//! What the tracer did, as lines: plain data for gizmos, files, pictures and tests.
//!
//! [`lines`] looks at a [`Subject`]: the world that rays read, the camera, the settings, what is to be
//! shown, and the rays of a pixel that [`probe`](crate::trace::probe()) evaluated again. Each
//! [`System`] gives a [`LineSet`]: segments, points, planes and labels with their colours and with
//! what they stand for. Nothing here keeps anything or changes anything, so what is drawn is what is
//! traced, now. [`System::key`] tells when a set has to be made again.
//!
//! | system | shows |
//! |---|---|
//! | boxes | nodes of the trees: levels, a leaf, the way to a triangle; split planes |
//! | visits | nodes that the debug rays entered (white) and those they pruned (red) |
//! | rays | the debug rays, each in the colour that it carries; hit triangles and normals |
//! | lobes | the discs of blurred reflections, and where each ray passed them |
//! | normals | at vertices and between them |
//! | lights | the lights with their gradients |
//! | lens | aperture, focus plane, what the picture holds of it |
//! | motion | where moving things stand when the shutter opens and closes |
//!
//! Beside lines: [`pattern`], where the samples of a pixel lie; [`Traversal`], the way of a ray
//! through the trees step by step, and [`Stepper`], which plays it; [`tell`], what a line stands for in words and numbers;
//! [`answer()`], questions about a pixel in a sentence; [`Column`], rays as a table; [`counted`], a number with its plural; [`Addition`], what they add up to; [`legend()`], what the colours of the lines mean; [`compare_builders`], each builder's tree in numbers; [`TreeCounts`], what a view's rays look at of the trees;
//! [`draw_over`], lines over a picture without a GPU; [`Document`], all of it as one file.

mod addition;
mod answer;
mod box_range;
mod boxes;
mod builders;
mod color;
mod column;
mod count;
mod document;
mod explain;
mod legend;
mod lens;
mod lights;
mod line_set;
mod lobes;
mod mixture;
mod motion;
mod names;
mod noise;
mod normals;
mod overlay;
mod pattern;
mod pattern_inset;
mod presets;
mod rays;
mod settings;
mod stepper;
mod subject;
mod system;
mod table;
mod told;
mod traversal;
mod tree_counts;
mod trees;
mod visits;
mod wide_boxes;

pub use addition::{Addition, Statement};
pub use answer::{Question, answer, mirror_ray};
pub use box_range::BoxRange;
pub(crate) use builders::corners;
pub use builders::{
    BuilderFigures, BuilderRates, Tell, build_time, builder_name, compare_builders,
    compare_builders_told, csv, markdown, rebuilt, same_geometry,
};
pub use column::{COLUMNS, Column, Heading, color_text, metres, vector_text};
pub use count::{cost_text, counted, left_out_text, plural};
pub use document::{Document, RayLine, named};
pub use explain::{Cause, Source, explanation, sources};
pub use legend::{Meaning, legend};
pub use line_set::{CIRCLE_SEGMENTS, Dot, Label, LineSet, Panel, Segment, Stands, Thinned};
pub use names::Names;
pub use overlay::{FAINT, Overlay, draw_over};
pub use pattern::{MOST_POINTS, Pattern, pattern};
pub use pattern_inset::draw_pattern;
pub use presets::InspectPreset;
pub use rays::is_shown;
pub use settings::{
    BoxChoice, BoxColor, BoxSettings, Dimension, InspectSettings, MissColor, NormalSettings,
    PairSettings, PatternSettings, RaySettings, TreeChoice, TreeForm,
};
pub use stepper::{Mark, Stepper};
pub use subject::Subject;
pub use system::{System, lines};
pub use table::aligned;
pub use told::{Told, node_told, tell, tree_name};
pub use traversal::{StackEntry, Step, StepKind, Traversal};
pub use tree_counts::TreeCounts;
pub use trees::{NodeFacts, TreeView, trees, triangle_in_world};
pub use visits::Visits;
