//! What a Bevy app mostly names of Glassbox: `use glassbox::prelude::*;` beside Bevy's own.

#[cfg(feature = "editor")]
pub use crate::editor::{Editing, EditorPlugins, in_editor};
pub use crate::io::KeepInSceneFiles;
pub use crate::scene::{
    DirectionalLamp, Environment, Lens, Motion, NotTraced, ParallelogramLamp, Phong, PhongMaps,
    PointLamp, Quantity, RenderSettings, Sampling, SceneCamera, SceneId, SegmentLamp, UsesMaterial,
};
pub use crate::sync::{Traced, TracedCameras};
#[cfg(feature = "view")]
pub use crate::view::{
    AddTracedMaterial, Converged, Failed, GlassboxPlugins, Picked, ReferenceRendered,
    TracedPicture, TracedRender, TracedView, ViewSettings, render_reference,
};
